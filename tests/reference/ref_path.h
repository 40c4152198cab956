// ref_path.h - the path tracer of docs/rendering.md once more, in double on one thread, its hits
// from Embree.

#ifndef LS_REF_PATH_H
#define LS_REF_PATH_H

#include "ls_format.h"

typedef struct LsRefPath LsRefPath;

// Builds Embree scenes for the objects of `file`, which is borrowed. NULL when Embree fails.
LsRefPath* ls_ref_path_create(const LsFile* file);
void ls_ref_path_destroy(LsRefPath* path);

// Renders width * height linear RGBA pixels, rows from the top: the mean of samples 0 to
// sample_count - 1. Returns the number of rays traced.
uint64_t ls_ref_path_render(const LsRefPath* path, const LsCamera* camera, uint32_t width,
                            uint32_t height, uint32_t sample_count, uint32_t depth, uint32_t seed,
                            float* rgba);

#endif
