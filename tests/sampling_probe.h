// sampling_probe.h - what test_sampling sends to the device and gets back.

#ifndef LS_SAMPLING_PROBE_H
#define LS_SAMPLING_PROBE_H

#include "ls_layout.h"

LS_STRUCT(LsProbeInput)
{
    LsTriangle triangle;
    LsInstance instance;
    uint32_t place[4]; // pixel, sample, dimension, seed
    LsVec3 normal;     // unit
    float transform_bound;
};
LS_SIZE(LsProbeInput, 208);

LS_STRUCT(LsProbeOutput)
{
    uint32_t bits[4];
    LsVec4 random;
    LsVec3 direction;
    float cosine;
    LsVec3 position;
    float sine;
    LsVec3 normal;
    float error;
    float weights[2];
    uint32_t reserved[2];
};
LS_SIZE(LsProbeOutput, 96);

LS_STRUCT(LsProbeParams)
{
    LsAddress inputs;
    LsAddress outputs;
    uint32_t count;
};

#endif
