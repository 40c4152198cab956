// choose.h - cells and a price of bytes for every object of a scene, by expected work and memory.
//
// One price for the whole scene divides memory where it saves most: each object takes the grid, and each voxel
// the N, of the least work of a line + price * bytes. Lines meet objects with the ratio of their boxes' surfaces.

#ifndef LS_CHOOSE_H
#define LS_CHOOSE_H

#include "survey.h"

// What is to be chosen from. Zero means default.
typedef struct LsChooseDesc
{
    // Bytes that all gridded objects together may take for tracing. 0: as many as pay; of all prices the one of the
    // least work^8 * bytes, so that a doubling of memory must save a twelfth of the work.
    uint64_t memory;
    uint32_t grid;    // cells along the longest side of all objects; 0: chosen
    uint32_t patches; // the most N
    uint32_t threads;
    uint64_t max_memory; // of this process, as LsBakeDesc.max_memory
    const char* scene;   // a file's name, for errors
} LsChooseDesc;

// Of one object.
typedef struct LsChoice
{
    uint32_t grid; // 0: the object is a list
    double price;  // work of a line through the object that a byte of a table must save
} LsChoice;

// Cells along the longest side by the number of triangles alone, where grids are not chosen: 0.3 of its root, in which a surface of
// even triangles has its cells three and a third of their widths wide; 4 to 512.
uint32_t ls_grid_by_triangles(uint32_t triangle_count);

// choices: input->mesh_count. Errors: LIMIT_BUDGET (the least memory that the objects take is more), and those of
// ls_voxels_create.
LsResult ls_choose(LsChoice* choices, const LsInput* input, const LsMesh* meshes,
                   const LsChooseDesc* desc, const LsStageProgress* progress, LsError* error);

#endif
