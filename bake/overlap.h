// overlap.h - whether a triangle touches a box: the separating axis test, in double.
//
// T. Akenine-Möller, "Fast 3D Triangle-Box Overlap Testing", 2001, with what depends on the
// triangle alone computed once.

#ifndef LS_OVERLAP_H
#define LS_OVERLAP_H

#include <stdbool.h>

// A triangle prepared for many boxes; the space is the user's, the same for both.
typedef struct LsOverlap
{
    double lower[3], upper[3]; // bounds
    double normal[3];
    double plane; // normal . corner
    // Nine axes, the cross products of an edge k with a coordinate axis i: the axis has components
    // u along (i+1)%3 and v along (i+2)%3, and the triangle spans [low, high] on it.
    double u[9], v[9], low[9], high[9];
} LsOverlap;

LsOverlap ls_overlap_prepare(const double corners[3][3]);

// Touching counts. `half`: half the box's size along each axis.
bool ls_overlap_box(const LsOverlap* triangle, const double centre[3], const double half[3]);

#endif
