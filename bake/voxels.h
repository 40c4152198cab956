// voxels.h - conservative voxelization of an object: a sparse grid of cells in blocks, crowded
// voxels divided again, empty cells with octant distances. design: thesis 6.1 (conservative, two
// passes: count, fill).

#ifndef LS_VOXELS_H
#define LS_VOXELS_H

#include "division.h"
#include "grid_frame.h"
#include "progress.h"

// An object's voxels, in the order and with the words of SPEC chapter 5. Owns its arrays.
typedef struct LsVoxels
{
    LsGridFrame frame;
    uint32_t* blocks;
    uint32_t block_count;
    LsCellBlock* cell_blocks;
    uint32_t cell_block_count;
    uint32_t* subgrids;
    uint32_t subgrid_count;
    LsWorkVoxel* voxels;
    uint32_t voxel_count;
    uint32_t* references;
    uint32_t reference_count;
    LsBvhNode* leaf_nodes;
    uint32_t leaf_node_count;
    LsDivision* divisions; // of the sub-grids, if they are weighed at no price; else NULL
    uint32_t depth;        // deepest level in use
} LsVoxels;

// Voxelizes at `grid` cells along the mesh's longest side, or fewer where the triangles crowd: see
// voxels->frame. Copies (ls_find_copies) are named by no voxel. What is not divided and has too
// many triangles for masks is a BVH. The result does not depend on `threads`. `progress` may be
// NULL. Errors: OUT_OF_MEMORY, LIMIT_RECORDS (more voxels or references than the format counts).
LsResult ls_voxels_create(LsVoxels* voxels, const LsMesh* mesh, uint32_t grid,
                          const LsDivisionRule* rule, uint32_t threads,
                          const LsStageProgress* progress, LsError* error);
void ls_voxels_destroy(LsVoxels* voxels);

// Of its records in a file, without shaft tables and triangles.
uint64_t ls_voxels_bytes(const LsVoxels* voxels);

// Puts the mesh's triangles into the order in which its voxels first name them, so that what is
// tested together lies together; copies come last. Errors: OUT_OF_MEMORY.
LsResult ls_voxels_order_triangles(LsVoxels* voxels, LsMesh* mesh, uint32_t threads,
                                   LsError* error);

#endif
