// choose.h - what a bake is to make of every object: cells, and a price of bytes by expected work
// and memory.
//
// One price for the whole scene divides memory where it saves most: each object takes the grid,
// each crowded voxel a sub-grid or a BVH, and each voxel the N, of the least work of a line + price
// * bytes. Lines meet objects with the ratio of their boxes' surfaces.

#ifndef LS_CHOOSE_H
#define LS_CHOOSE_H

#include "survey.h"
#include "tables.h"

// Of one object.
typedef struct LsChoice
{
    uint32_t grid; // cells along the longest side; 0: the object is a list
    // Part of all lines that meet the box of a gridded object, and of those this one's.
    double weight;
    double price; // work of a line through the object that a byte of a table must save
} LsChoice;

// What is to be chosen from.
typedef struct LsChooseDesc
{
    // Bytes that tracing may take on the device, of which fixed_bytes go to what no choice alters.
    // 0: as many as pay; of all prices the one of the least work^8 * bytes, so that a doubling of
    // memory must save a twelfth of the work.
    uint64_t memory;
    uint64_t fixed_bytes;
    uint32_t grid;    // cells along the longest side of all objects; 0: chosen
    uint32_t patches; // the most N, 1..LS_MAX_CHOSEN_PATCHES
    LsDivisionRule rule;
    const LsShaftWeights* weights; // of each N from 1 on, borrowed
    uint32_t threads;              // >= 1
    uint64_t max_memory;           // of this process, as LsBakeDesc.max_memory
    const char* scene;             // a file's name, for errors
} LsChooseDesc;

// What the description asks for, defaults filled in.
LsPatchesChoice ls_patches_choice(const LsBakeDesc* desc);

// The same of voxels.
LsDivisionRule ls_division_rule(const LsBakeDesc* desc);

// choices: input->mesh_count. Errors: LIMIT_BUDGET (even the least that the scene takes is more
// than the memory), LIMIT_MEMORY, and those of ls_voxels_create. Of several grids one that holds
// more records than the format counts is passed over.
LsResult ls_choose(LsChoice* choices, const LsInput* input, const LsMesh* meshes,
                   const LsChooseDesc* desc, const LsStageProgress* progress, LsError* error);

// The same without a choice: `grid` cells, or if 0 by the number of triangles alone, 0.3 of its
// root and 4 to 512, in which a surface of even triangles has its cells three and a third of their
// widths wide. Prices are 0.
void ls_choose_given(LsChoice* choices, const LsInput* input, const LsMesh* meshes, uint32_t grid);

#endif
