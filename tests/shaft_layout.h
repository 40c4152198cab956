// shaft_layout.h - for tests: the same file with its masks laid out otherwise, or with scene shafts.

#ifndef LS_TEST_SHAFT_LAYOUT_H
#define LS_TEST_SHAFT_LAYOUT_H

#include "ls_write.h"

// `desc` with arrays of its own where they differ; the others stay those of the source.
typedef struct LsShaftLayout
{
    LsFileDesc desc;
    LsObject* objects;
    LsVoxel* voxels;
    uint32_t* shafts;
} LsShaftLayout;

// Both take a source without scene shafts, and fail the calling cmocka test when out of memory.

// Masks as wide as their voxel has triangles (format 0.3), or of the smallest of 4, 8, 16 and 32 bits
// that holds them (before it).
LsShaftLayout ls_mask_layout(const LsFileDesc* source, bool exact);

// Each grid gets scene shafts of M = patches, whose words are numbers that describe no geometry, every
// seventh 0.
LsShaftLayout ls_scene_shaft_layout(const LsFileDesc* source, uint32_t patches);

void ls_shaft_layout_destroy(LsShaftLayout* layout);

#endif
