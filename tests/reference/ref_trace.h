// ref_trace.h - the slow second opinion: rays against every triangle, written from format/SPEC.md
// alone.
//
// ls_reference_trace takes chapter 7 literally: float, every operation rounded, IEEE division, in the
// order of the text. It looks at no grids, voxels or shafts. ref_judge.h judges answers.

#ifndef LS_REF_TRACE_H
#define LS_REF_TRACE_H

#include "ls_format.h"

// A copy of a file's triangles laid out for testing many at a time. The file must stay open.
typedef struct LsReference LsReference;
LsReference* ls_reference_create(const LsFile* file); // NULL when out of memory
void ls_reference_destroy(LsReference* reference);    // NULL is allowed

// A ray as one object sees it (SPEC 7.2), in object space.
typedef struct LsObjectRay
{
    float carried[3];   // origin as the transform gave it
    float origin[3];    // after a far origin has moved
    float direction[3]; // scaled by 2^-exponent
    float s0;           // how far the origin moved, in units of `direction`
    float smin, smax;   // open interval of legal s
    int exponent;       // t = s * 2^-exponent
    bool far;           // the carried origin lies farther than reach outside the box
    bool misses;        // by 7.2, while its origin moved; in float, so devices may differ
} LsObjectRay;

// Carries a world ray to an instance. False: the ray is illegal (7.1), does not share a bit of
// `mask` with the instance, or has no direction there. See also `misses`.
bool ls_reference_carry(const LsReference* reference, uint32_t instance, const LsRay* ray,
                        uint32_t mask, LsObjectRay* carried);

// Traces a batch. masks: ray_count words or NULL; flags: LS_RAY_FLAG_CULL_*. Uses all processors.
void ls_reference_trace(const LsReference* reference, const LsRay* rays, const uint32_t* masks,
                        uint32_t ray_count, uint32_t flags, LsHit* hits);

// The miss of LsHit.
LsHit ls_reference_miss(void);

#endif
