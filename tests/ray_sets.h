// ray_sets.h - the rays of the exactness tests: ordinary ones, and those that find faults.
//
// Deterministic: the same file, count and seed give the same rays everywhere.

#ifndef LS_TEST_RAY_SETS_H
#define LS_TEST_RAY_SETS_H

#include "ls_format.h"

// The first four classes are what a renderer traces: the "ordinary" set of the contract.
#define LS_RAY_CLASS_LIST(X)                                                                     \
    X(CAMERA, "camera")   /* a few eyes outside, towards points of the scene's box */            \
    X(SHADOW, "shadow")   /* from surfaces to points of a light, tmax there */                   \
    X(DIFFUSE, "diffuse") /* from surfaces, cosine-distributed */                                \
    X(RANDOM, "random")   /* any origin in and about the scene, any direction */                 \
    X(AXIS, "axis")       /* one or two components zero, of either sign */                       \
    X(CELL, "cell")       /* through corners of cells, along their faces, edges and diagonals */ \
    X(CORNER, "corner")   /* at vertices and edges, and along edges */                           \
    X(ORIGIN, "origin")   /* origins on vertices, edges, triangles and borders of cells */       \
    X(FAR, "far")         /* origins 1e3 to 1e7 scene sizes away */                              \
    X(SCALED, "scaled")   /* directions of length 1e-37 to 1e37 */                               \
    X(CUT, "cut")         /* tmin or tmax at, just before or just behind a surface */            \
    X(ILLEGAL, "illegal") /* NaN, infinite, zero and reversed intervals */

typedef enum LsRayClass
{
#define LS_RAY_CLASS_ENUMERATOR(name, text) LS_RAY_CLASS_##name,
    LS_RAY_CLASS_LIST(LS_RAY_CLASS_ENUMERATOR)
#undef LS_RAY_CLASS_ENUMERATOR
        LS_RAY_CLASS_COUNT
} LsRayClass;

#define LS_ORDINARY_CLASS_COUNT 4u

const char* ls_ray_class_name(LsRayClass ray_class);

typedef struct LsRaySet
{
    LsRay* rays;
    uint8_t* classes; // LsRayClass of each
    uint32_t count;
} LsRaySet;

// Rays for a scene, all classes mixed. Failing memory fails the calling cmocka test.
LsRaySet ls_ray_set_make(const LsFile* file, uint32_t count, uint64_t seed);
void ls_ray_set_destroy(LsRaySet* set);

#endif
