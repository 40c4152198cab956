// cost_model.h - the work that a ray is expected to do in an object's grid, and what it costs.
//
// As in the surface area heuristic of BVHs, rays are taken for lines that cross the grid's box
// uniformly: a convex body in it is met with the probability of their surfaces' ratio. That they
// end at what they hit is left out, which alters all candidates for a grid alike.

#ifndef LS_COST_MODEL_H
#define LS_COST_MODEL_H

#include "voxels.h"

// What a step of the walk and the look-up of a mask cost, in triangle tests: fitted to times of an
// NVIDIA H100 (docs/cost-model.md). Compiled in: a bake never measures the machine, or its bytes
// would depend on it.
#define LS_STEP_COST 1.5
#define LS_LOOKUP_COST 3.0

// What a line that crosses the grid's box is expected to do there.
typedef struct LsWork
{
    // Filled cells, empty ones where a skip begins, entries of sub-grids, boxes of BVHs.
    double steps;
    double lookups; // masks
    double tests;   // triangles
} LsWork;

// How many visits of a line fall on a cell of the grid: the ratio of their surfaces.
double ls_cell_visits(const LsGridFrame* frame);

// Steps of a line, all octants of its direction alike. Too many by up to a fifth where skips are
// long, since lines come to a cell from where skips end (test_choose.c).
double ls_expected_steps(const LsVoxels* voxels);

// Steps of a line in the block of a sub-grid that it visits.
double ls_subgrid_steps(const LsCellBlock* block);

// In triangle tests.
double ls_work_cost(const LsWork* work);

#endif
