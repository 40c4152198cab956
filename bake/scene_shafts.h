// scene_shafts.h - the scene Line Space: along every shaft of a whole grid, which stretches may be
// filled.
//
// After F.-L. Schröder's thesis (2017), section 13.1, where it is only proposed: one Line Space
// over the scene whose shafts hold a signature of filled and empty intervals, so that rays pass
// long empty stretches in one step. Here there is one for each object with a grid. The six faces of
// the grid's box are cut into M x M patches, and shafts are numbered as those of voxels are (SPEC
// chapter 6).

#ifndef LS_SCENE_SHAFTS_H
#define LS_SCENE_SHAFTS_H

#include "voxels.h"

// The signatures of an object. Owns its array.
typedef struct LsSceneShafts
{
    uint32_t patches; // M, 0: none
    uint32_t* words;  // LS_SHAFT_COUNT(patches); bit k: the k-th of LS_SIGNATURE_INTERVALS
    uint32_t word_count;
    uint64_t filled_count; // of shafts whose word is not 0
} LsSceneShafts;

// Makes the signatures of all shafts of M = patches, 1..LS_MAX_SCENE_PATCHES. Bit k of a word is
// set wherever a point that lies between k and k + 1 of LS_SIGNATURE_INTERVALS parts of the way
// from a point of the first patch to one of the second, the patches grown to boxes by 2 bounds, is
// in a filled cell grown by as much; and more bits. The result does not depend on `threads`.
// Errors: OUT_OF_MEMORY.
LsResult ls_scene_shafts_create(LsSceneShafts* shafts, const LsVoxels* voxels, uint32_t patches,
                                uint32_t threads, LsError* error);
void ls_scene_shafts_destroy(LsSceneShafts* shafts);

// Bytes that ls_scene_shafts_create works with, its result included.
uint64_t ls_scene_shafts_need(const LsGridFrame* frame, uint32_t patches);

#endif
