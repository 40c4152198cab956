// grid_frame.h - where an object's grid lies, and what a voxel of it is.

#ifndef LS_GRID_FRAME_H
#define LS_GRID_FRAME_H

#include "mesh.h"

// Where an object's grid lies.
typedef struct LsGridFrame
{
    float lower[3];     // object space
    float inverse_cell; // cells per object unit
    uint32_t grid;      // cells along the longest side, as asked for
    uint32_t cells[3];
    float bound;    // e, in cells; SPEC 7.5
    uint32_t depth; // deepest sub-grid level that e and float allow
} LsGridFrame;

// A voxel as later stages need it.
typedef struct LsWorkVoxel
{
    uint32_t cell[3]; // counts cells of its level
    uint32_t level;
    uint32_t kind;    // LS_VOXEL_*; MASKS is chosen by count, and may become LIST when N is chosen
    uint32_t patches; // masks: N, once they are made
    uint32_t first_reference;
    uint32_t reference_count;
    uint32_t table; // sub-grid: its cell block; BVH: first leaf node
} LsWorkVoxel;

// Kind of a voxel of so many triangles, LS_MASK_TRIANGLES at most.
static inline uint32_t ls_voxel_kind(uint32_t triangle_count)
{
    return triangle_count <= LS_DIRECT_TRIANGLES ? LS_VOXEL_LIST : LS_VOXEL_MASKS;
}

// The frame of a mesh at `grid` cells along its longest side, with a margin of at least 2 e to
// every border.
LsGridFrame ls_grid_frame(const LsMesh* mesh, uint32_t grid);

// A point of object space in grid space, in double.
void ls_grid_point(const LsGridFrame* frame, LsVec3 point, double out[3]);

#endif
