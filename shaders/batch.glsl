// batch.glsl - the arrays of a batch of rays, for the kernels.

#ifndef LS_BATCH_GLSL
#define LS_BATCH_GLSL

#include "ls_layout.h"

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer RayArray
{
    LsRay at[];
};

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer HitArray
{
    LsHit at[];
};

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MaskArray
{
    uint at[];
};

// Between two passes: the rays that the first leaves to the second.
layout(buffer_reference, std430, buffer_reference_align = 16) buffer Queue
{
    LsTraceQueue head;
    LsGridRay rays[];
};

// The instances that ray `index` may hit.
uint get_mask(uvec2 masks, uint index)
{
    return masks == uvec2(0) ? 255u : MaskArray(masks).at[index];
}

#endif
