// linespace.h - which triangles can be met along a shaft: the heart of the bake.
//
// A voxel's faces are cut into N x N patches; a shaft is the hull of two patches on different faces
// (numbering: SPEC chapter 6). After T. Keul, S. Müller et al.'s Line Space and F.-L. Schröder's
// thesis (2017), section 4, with exact candidates instead of middle rays.

#ifndef LS_LINESPACE_H
#define LS_LINESPACE_H

#include "ls_format.h"

// Working memory of ls_shafts_mark for one thread; about 500 KiB. Contents are its own.
typedef struct LsShaftScratch LsShaftScratch;
LsShaftScratch* ls_shaft_scratch_create(void); // NULL when out of memory
void ls_shaft_scratch_destroy(LsShaftScratch* scratch);
uint64_t ls_shaft_scratch_bytes(void);

// Sets bit k of the word of every shaft that triangle k may meet: each shaft whose hull, its two
// patches grown to boxes by `bound` in all three axes, meets the triangle, and a few more; all
// other bits to 0. `corners` of up to 32 triangles in voxel space, where the voxel is [0,1]^3;
// `bound` in voxel widths, below 0.25; patches 1..LS_MAX_PATCHES; words: LS_SHAFT_COUNT(patches).
// The bits of a triangle do not depend on the others.
void ls_shafts_mark(const double (*corners)[3][3], uint32_t count, double bound, uint32_t patches,
                    uint32_t* words, LsShaftScratch* scratch);

#endif
