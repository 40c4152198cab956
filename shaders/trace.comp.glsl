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

void main()
{
    uint index = gl_GlobalInvocationID.x;
#ifdef LS_TEXELS
    uint block = params.flags >> LS_TRACE_BLOCK & 0xFFu;
    if (block != 0u)
    {
        uint first = index * block;
        if (first < params.ray_count && get_flags(params.hits, first) == LS_HIT_CUT)
        {
            uint end = min(first + block, params.ray_count);
            for (index = first; index < end; index++)
            {
                if (get_flags(params.hits, index) == LS_HIT_CUT)
                {
                    trace(index);
                }
            }
        }
        return;
    }
#endif
    if (index < params.ray_count)
    {
        trace(index);
    }
}
