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

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.ray_count)
    {
        return;
    }
#ifdef LS_TEXELS
    if ((params.flags & LS_TRACE_CUT_ALONE) != 0u && get_flags(params.hits, index) != LS_HIT_CUT)
    {
        return;
    }
#endif
    uint mask = get_mask(params.masks, index);
    LsRay ray = RayArray(params.rays).at[index];
    LsHit hit = ls_trace_ray(ray, mask, params.flags);
    if (LS_METHOD == LS_METHOD_COUNT)
    {
        hit = LsHit(0.0, 0.0, 0.0, ls_work.x, ls_work.y, ls_work.z, 0u, hit.flags);
    }
    HitArray(params.hits).at[index] = hit;
}
