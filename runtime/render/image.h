// image.h - pictures of linear floats to files.

#ifndef LS_IMAGE_H
#define LS_IMAGE_H

#include "ls_base.h"

// `rgba`: width * height linear pixels, rows from the top. Files appear whole or not at all.
// Errors: OUTPUT, OUTPUT_FULL, MEMORY.

// 8 bits, opaque, clipped to [0,1], with the sRGB transfer curve.
LsResult ls_image_write_png(const float* rgba, uint32_t width, uint32_t height, const char* path,
                            LsError* error);

// Linear 32-bit floats, RGB, compressed without loss.
LsResult ls_image_write_exr(const float* rgba, uint32_t width, uint32_t height, const char* path,
                            LsError* error);

#endif
