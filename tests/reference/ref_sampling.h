// ref_sampling.h - the random numbers of docs/rendering.md and what is drawn with them, in C.

#ifndef LS_REF_SAMPLING_H
#define LS_REF_SAMPLING_H

#include "ls_layout.h"

#include <stdbool.h>

// Chapter 1: four words for a place in a render, and the four multiples of 2^-24 in [0,1) made of
// them.
void ls_ref_random_bits(uint32_t pixel, uint32_t sample, uint32_t dimension, uint32_t seed,
                        uint32_t bits[4]);
void ls_ref_random(uint32_t pixel, uint32_t sample, uint32_t dimension, uint32_t seed,
                   float random[4]);

// Chapter 2: cosine and sine of whole turns by the series in float; `turn` in [0,1].
void ls_ref_cos_sin_turn(float turn, float cos_sin[2]);

// A unit direction about the unit `normal` with density cos / pi, in double but for the random
// numbers.
void ls_ref_sample_hemisphere(const double normal[3], const float random[2], double direction[3]);

// Weights of the second and third corner, uniform over a triangle.
void ls_ref_sample_triangle(const float random[2], float weights[2]);

// A point on a placed triangle. `error`: how far along the normal a ray must start to be free of
// it.
typedef struct LsRefSurface
{
    double position[3];
    double normal[3]; // unit, to where the corners run counter-clockwise in object space
    double error;
} LsRefSurface;

// Chapter 3, in double.
LsRefSurface ls_ref_surface(const LsTriangle* triangle, const LsInstance* instance,
                            const double weights[2], double transform_bound);

#endif
