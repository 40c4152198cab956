// sampling_probe.comp.glsl - what sampling.glsl draws, for comparison with the host.

#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require

#include "../tests/sampling_probe.h"
#include "sampling.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform LsPush
{
    LsProbeParams params;
};

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer LsInputs
{
    LsProbeInput at[];
};

layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer LsOutputs
{
    LsProbeOutput at[];
};

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count)
    {
        return;
    }
    LsProbeInput probe = LsInputs(params.inputs).at[index];
    LsProbeOutput result;
    uvec4 bits = ls_random_bits(probe.place[0], probe.place[1], probe.place[2], probe.place[3]);
    result.bits = uint[4](bits.x, bits.y, bits.z, bits.w);
    result.random = ls_unit_floats(bits);
    result.direction = ls_sample_hemisphere(probe.normal, result.random.xy);
    vec2 turn = ls_cos_sin_turn(result.random.y);
    result.cosine = turn.x;
    result.sine = turn.y;
    vec2 weights = ls_sample_triangle(result.random.zw);
    result.weights = float[2](weights.x, weights.y);
    LsHitSurface surface = ls_surface(probe.triangle, probe.instance.world_from_object,
                                   (probe.instance.flags & LS_INSTANCE_MIRRORED) != 0u, weights,
                                   probe.transform_bound);
    result.position = surface.position;
    result.normal = surface.normal;
    result.error = surface.error;
    result.reserved = uint[2](0u, 0u);
    LsOutputs(params.outputs).at[index] = result;
}
