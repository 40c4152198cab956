// polytope.h - slow and exact: does a triangle meet a box, or the hull of two boxes? In double.
//
// The oracle for the shaft masks and the voxel lists. Space is the caller's. A hull is shrunk by
// LS_POLYTOPE_SLACK, far above the rounding of double and far below any bound that files store, so
// that a yes never hangs on the last bit.

#ifndef LS_POLYTOPE_H
#define LS_POLYTOPE_H

#include <stdbool.h>
#include <stdint.h>

#define LS_POLYTOPE_SLACK 1e-11
#define LS_POLYTOPE_MAX_PLANES 64
#define LS_POLYTOPE_MAX_CORNERS (LS_POLYTOPE_MAX_PLANES + 3)

typedef struct LsBox
{
    double lower[3], upper[3];
} LsBox;

// A convex body: all points with dot(normal, p) <= offset for every plane (normal xyz, offset).
typedef struct LsPolytope
{
    double planes[LS_POLYTOPE_MAX_PLANES][4];
    uint32_t plane_count;
} LsPolytope;

// A box grown by `grow` on all sides.
LsPolytope ls_polytope_box(const LsBox* box, double grow);

// The hull of two boxes, neither of them flat: every plane through three of their sixteen corners
// that has all corners on one side.
LsPolytope ls_polytope_hull(const LsBox* a, const LsBox* b);

// The hull of the two patches of a shaft (numbering: SPEC chapter 6), each grown to a box by
// `bound` in all axes; the voxel is [0,1]^3.
LsPolytope ls_polytope_shaft(uint32_t shaft, uint32_t patches, double bound);

// The patches that a shaft joins: faces 2 * axis + side and patch coordinates (i, j). By search
// through the definition, not by a formula.
typedef struct LsShaftEnds
{
    uint32_t face[2], i[2], j[2];
} LsShaftEnds;
LsShaftEnds ls_polytope_shaft_ends(uint32_t shaft, uint32_t patches);

// Cuts the triangle by the body. Writes the corners of what is left and returns their number, 0 for
// nothing.
uint32_t ls_polytope_clip(const LsPolytope* body, const double corners[3][3],
                          double out[LS_POLYTOPE_MAX_CORNERS][3]);

// Whether the triangle meets the body shrunk by the slack.
bool ls_polytope_meets(const LsPolytope* body, const double corners[3][3]);

#endif
