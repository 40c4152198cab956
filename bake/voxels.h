// voxels.h - conservative voxelization of an object: a sparse grid of cells in blocks, crowded
// voxels divided again, empty cells with octant distances. design: thesis 6.1 (conservative, two
// passes: count, fill).

#ifndef LS_VOXELS_H
#define LS_VOXELS_H

#include "mesh.h"

// Where an object's grid lies.
typedef struct LsGridFrame
{
    float lower[3];     // object space
    float inverse_cell; // cells per object unit
    uint32_t cells[3];
    float bound;    // e, in cells; SPEC 7.5
    uint32_t depth; // deepest sub-grid level that e and float allow
} LsGridFrame;

// A voxel as later stages need it.
typedef struct LsWorkVoxel
{
    uint32_t cell[3]; // counts cells of its level
    uint32_t level;
    uint32_t kind; // LS_VOXEL_*; MASKS is chosen here, by count, the masks are made later
    uint32_t first_reference;
    uint32_t reference_count;
    uint32_t table; // sub-grid: its cell block; BVH: first leaf node
} LsWorkVoxel;

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
    uint32_t depth; // deepest level in use
} LsVoxels;

// The frame of a mesh at `grid` cells along its longest side, with a margin of at least 2 e to
// every border.
LsGridFrame ls_grid_frame(const LsMesh* mesh, uint32_t grid);

// A point of object space in grid space, in double.
void ls_grid_point(const LsGridFrame* frame, LsVec3 point, double out[3]);

// Voxelizes and puts the mesh's triangles into the order in which voxels first name them. The
// result does not depend on `threads`. Errors: MEMORY, INPUT_LIMIT (more voxels or references than
// the format counts).
LsResult ls_voxels_create(LsVoxels* voxels, LsMesh* mesh, const LsGridFrame* frame,
                          uint32_t threads, LsError* error);
void ls_voxels_destroy(LsVoxels* voxels);

#endif
