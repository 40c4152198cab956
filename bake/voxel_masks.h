// voxel_masks.h - the masks of one voxel's shafts, for one N after the other.

#ifndef LS_VOXEL_MASKS_H
#define LS_VOXEL_MASKS_H

#include "linespace.h"
#include "voxels.h"

// A thread's own. Owns its scratch memory; voxels and mesh are borrowed.
typedef struct LsVoxelMasks
{
    const LsVoxels* voxels;
    const LsMesh* mesh;
    LsShaftScratch* scratch;
    double corners[LS_MASK_TRIANGLES][3][3]; // of the voxel's triangles, in the unit cube
    uint32_t count;
    double bound; // e, in the voxel's own size
} LsVoxelMasks;

// False when out of memory.
bool ls_voxel_masks_create(LsVoxelMasks* masks, const LsVoxels* voxels, const LsMesh* mesh);
void ls_voxel_masks_destroy(LsVoxelMasks* masks);

// Goes to a voxel of kind MASKS.
void ls_voxel_masks_begin(LsVoxelMasks* masks, const LsWorkVoxel* voxel);

// Its masks for N = patches: LS_SHAFT_COUNT(patches) words.
void ls_voxel_masks_mark(LsVoxelMasks* masks, uint32_t patches, uint32_t* words);

// Masks of N = 1 from those of any N: the hull of two faces is the union of the hulls of their
// patches.
void ls_voxel_masks_merge(const uint32_t* words, uint32_t patches, uint32_t merged[15]);

#endif
