// shaft_cost.h - how many triangles a ray through a voxel is expected to test.
//
// Rays are taken for lines that cross the voxel uniformly: each equally likely in the measure that
// no motion changes. Shaft s then carries the part A_s F_s / 3 of them, A_s F_s being the exchange
// area of its two patches, a third of the unit cube's six faces' sum over unordered pairs. In units
// of 2^-30, so that sums are whole numbers. Up to LS_MAX_CHOSEN_PATCHES no weight lies near the
// middle between two of them (test_shaft_cost.c), so they do not depend on the last bits of the C
// library's log and atan: only these may decide what is stored.

#ifndef LS_SHAFT_COST_H
#define LS_SHAFT_COST_H

#include "grid_frame.h"

#include <stdbool.h>

// The weights of the shafts of a voxel of N = patches, in the numbering of SPEC chapter 6. Owns its
// array.
typedef struct LsShaftWeights
{
    uint32_t patches;
    uint32_t* shafts; // LS_SHAFT_COUNT(patches), in 2^-30
    uint64_t sum;     // of them: nearly 2^30
} LsShaftWeights;

// False when out of memory.
bool ls_shaft_weights_create(LsShaftWeights* weights, uint32_t patches);
void ls_shaft_weights_destroy(LsShaftWeights* weights);

// Those of N = first to last at weights[N], the others empty. False when out of memory; also then
// all are to be destroyed.
bool ls_shaft_weights_create_all(LsShaftWeights weights[LS_MAX_PATCHES + 1], uint32_t first,
                                 uint32_t last);
void ls_shaft_weights_destroy_all(LsShaftWeights weights[LS_MAX_PATCHES + 1]);

// The weight of a shaft before it is rounded, in 2^-30.
double ls_shaft_weight(uint32_t shaft, uint32_t patches);

// Triangles that a line through a voxel with these masks, one word a shaft, is expected to test.
double ls_shaft_tests(const LsShaftWeights* weights, const uint32_t* masks);

// The tests that N = n + 1 is expected to save where n left `here` and n - 1 left `before`. A
// search for the best N ends where that would not pay.
double ls_expected_saving(uint32_t n, double before, double here);

// The tests in a voxel that is a BVH leaf: `nodes` is its BVH, in grid space. A line meets a box in
// the voxel with the probability of their surfaces' ratio.
double ls_leaf_bvh_tests(const LsBvhNode* nodes, const LsWorkVoxel* voxel);

// And the boxes that it looks at: the first, and the two in each box of inner nodes that it meets.
double ls_leaf_bvh_boxes(const LsBvhNode* nodes, const LsWorkVoxel* voxel);

// How much likelier a ray visits a voxel than one of a whole cell: by its surface.
double ls_voxel_visits(const LsWorkVoxel* voxel);

#endif
