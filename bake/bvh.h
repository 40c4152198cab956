// bvh.h - small bounding volume hierarchies: over instances, and over the triangles of crowded
// voxels.

#ifndef LS_BVH_H
#define LS_BVH_H

#include "ls_layout.h"

// A box in the space of the BVH's user.
typedef struct LsBox
{
    double lower[3];
    double upper[3];
} LsBox;

// Lays out a BVH over boxes[order[i]] depth first with escape indices (SPEC R4.7): median splits
// along the longest axis of the centres. `order` is permuted so that leaves name ranges of it, at
// most leaf_size (1..15) long. Node boxes are rounded outward to float. nodes: room for 2 * count.
// Returns the node count; count >= 1.
uint32_t ls_bvh_build(const LsBox* boxes, uint32_t* order, uint32_t count, uint32_t leaf_size,
                      LsBvhNode* nodes);

// The largest float not above x, the smallest not below; never -0, since compilers differ in the
// sign of zero that fmin and fmax return.
float ls_float_below(double x);
float ls_float_above(double x);

#endif
