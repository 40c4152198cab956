// division.h - which voxels are divided into sub-grids, and what each division is worth.
//
// A voxel of too many triangles for masks is whole, with a BVH, or has a sub-grid, whose voxels are
// decided on likewise: of all ways the one of the least work of a line + price * bytes. What masks
// will leave of the tests is not known before they are made, so parts that are usual are taken.

#ifndef LS_DIVISION_H
#define LS_DIVISION_H

#include <stdbool.h>
#include <stdint.h>

typedef struct LsDivisionRule
{
    uint32_t above;      // voxels of more triangles are divided, where that makes them fewer
    uint32_t most_depth; // levels of sub-grids, LS_MAX_DEPTH at most
    bool is_weighed;     // of them only those that are worth their bytes at `price`
    double price; // work of a line through the object that a byte must save; if weighed 0: all
                  // are divided, and LsVoxels.divisions tells of each
} LsDivisionRule;

// A sub-grid, or the BVH that its voxel has without it. Work is that of a line that visits a voxel
// of a whole cell once, in triangle tests.
typedef struct LsDivision
{
    uint32_t parent; // the sub-grid that its voxel lies in, which comes before it; or LS_NONE
    double whole_work, divided_work;     // divided: without sub-grids in it and voxels with masks
    uint64_t whole_bytes, divided_bytes; // divided: without sub-grids in it and tables
    double mask_visits, mask_tests;      // of voxels of it that may have masks, if none has any
    uint64_t mask_references;            // in them
} LsDivision;

// Which of the divisions are kept at a price, in work of a line as above for a byte; those of the
// rest that lie in none or in one that is kept are whole. costs: `count`, to work with.
void ls_divisions_choose(const LsDivision* divisions, uint32_t count, double price, double* costs,
                         bool* kept);

#endif
