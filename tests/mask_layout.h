// mask_layout.h - for tests: the same file with its masks laid out otherwise.

#ifndef LS_TEST_MASK_LAYOUT_H
#define LS_TEST_MASK_LAYOUT_H

#include "ls_write.h"

// `desc` with arrays of its own where they differ.
typedef struct LsMaskLayout
{
    LsFileDesc desc;
    LsObject* objects;
    LsVoxel* voxels;
    uint32_t* shafts;
} LsMaskLayout;

// Masks as wide as their voxel has triangles (format 0.3), or of the smallest of 4, 8, 16 and 32 bits
// that holds them (before it). `source` has no scene shafts. Other arrays stay those of `source`. Fails the calling cmocka test when out
// of memory.
LsMaskLayout ls_mask_layout(const LsFileDesc* source, bool exact);
void ls_mask_layout_destroy(LsMaskLayout* layout);

#endif
