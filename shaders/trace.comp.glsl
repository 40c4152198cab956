// trace.comp.glsl - the batch kernel: one thread carries one ray of LsTraceParams.rays to its hit.

#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "ls_layout.h"

layout(local_size_x_id = LS_CONSTANT_GROUP_SIZE) in;

layout(push_constant, std430) uniform Push
{
    LsTraceParams params;
};

#define ls_scene params.scene
#include "batch.glsl"
#include "linespace.glsl"

void trace(uint index)
{
    uint mask = get_mask(params.masks, index);
    LsRay ray = RayArray(params.rays).at[index];
    LsHit hit = ls_trace_ray(ray, mask, params.flags);
    if (LS_METHOD == LS_METHOD_COUNT)
    {
        hit = LsHit(0.0, 0.0, 0.0, ls_work.x, ls_work.y, ls_work.z, 0u, hit.flags);
    }
    HitArray(params.hits).at[index] = hit;
}

#ifdef LS_TEXELS

// A ray, or those of a block that are marked. One loop for both, so that the code is there once.
void main()
{
    uint block = params.flags >> LS_TRACE_BLOCK & 0xFFu;
    uint first = gl_GlobalInvocationID.x * max(block, 1u);
    bool is_wanted = first < params.ray_count &&
                     (block == 0u || get_flags(params.hits, first) == LS_HIT_CUT);
    uint end = is_wanted ? min(first + max(block, 1u), params.ray_count) : first;
    for (uint index = first; index < end; index++)
    {
        if (block == 0u || get_flags(params.hits, index) == LS_HIT_CUT)
        {
            trace(index);
        }
    }
}

#else

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index < params.ray_count)
    {
        trace(index);
    }
}

#endif
