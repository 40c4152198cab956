// division.h - which voxels are divided into sub-grids.

#ifndef LS_DIVISION_H
#define LS_DIVISION_H

#include <stdint.h>

typedef struct LsDivisionRule
{
    uint32_t above;      // voxels of more triangles are divided, where that makes them fewer
    uint32_t most_depth; // levels of sub-grids, LS_MAX_DEPTH at most
} LsDivisionRule;

#endif
