// ref_layout.h - how the second opinions lay out a file's triangles; behind ref_trace.h and ref_judge.h.

#ifndef LS_REF_LAYOUT_H
#define LS_REF_LAYOUT_H

#include "ref_trace.h"

#define LANES 256  // triangles tested in one go; corners of so many stay in the first-level cache
#define CLUSTER 32 // triangles under one bounding sphere; divides LANES

typedef struct LsReferenceSphere
{
    double center[3];
    double radius;
} LsReferenceSphere;

// Triangles in an order that keeps neighbours together, padded to a multiple of LANES with
// triangles that are a point.
typedef struct LsReferenceObject
{
    uint32_t slot_count;
    float* corners[3][3]; // [corner][axis][slot]
    uint32_t* triangles;  // of each slot: index in the object's part of TRIANGLES, or LS_NONE
    LsReferenceSphere* spheres;
    uint32_t* slot_of_primitive; // face_count
} LsReferenceObject;

struct LsReference
{
    const LsFile* file;
    LsReferenceObject* objects;
    uint32_t object_count;
    bool top_level;
};

static inline float component(LsVec3 v, uint32_t axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

#endif
