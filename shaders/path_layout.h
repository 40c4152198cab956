// path_layout.h - what the path tracer's shader and the host share: parameters and counters. Never
// stored.

#ifndef LS_PATH_LAYOUT_H
#define LS_PATH_LAYOUT_H

#include "ls_layout.h"

// Push constants: one dispatch adds sample_count samples to every pixel.
LS_STRUCT(LsPathParams)
{
    LsVec4 world_from_camera[3];
    LsAddress scene;    // LsDeviceScene
    LsAddress image;    // vec4[width * height], rows from the top; linear RGB, 1
    LsAddress counters; // LsPathCounters
    uint32_t width;     // pixels
    uint32_t height;
    uint32_t first_sample; // samples the image already holds per pixel
    uint32_t sample_count;
    uint32_t seed;
    uint32_t depth;      // most segments a path may have, the one from the camera included
    float tan_half_y;    // of half the vertical field of view
    float light_density; // 1 / sum over lights of area * luminance; 0 without lights
};
LS_SIZE(LsPathParams, 104);

LS_STRUCT(LsPathCounters)
{
    uint32_t rays_low; // rays traced, all kinds, 64 bits in two words
    uint32_t rays_high;
    uint32_t invalid_samples; // not finite, counted as black
    uint32_t reserved;
};
LS_SIZE(LsPathCounters, 16);

// A work group is a tile of this many pixels in x; in y its size divided by this.
#define LS_PATH_TILE_WIDTH 8u

#endif
