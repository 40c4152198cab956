// ref_judge.h - knows answers in double, and says of that of any tracer whether the contract of SPEC 7.6 allows
// it, and why. Looks at no grids, voxels or shafts, but for ls_reference_explain, which needs the end of a cell.

#ifndef LS_REF_JUDGE_H
#define LS_REF_JUDGE_H

#include "ref_trace.h"

// What the contract between devices says of an answer. Only the last is a defect.
#define LS_VERDICT_LIST(X)                                                                        \
    X(RIGHT, "right")     /* the answer of double precision, t within its bound */                \
    X(EDGE, "edge")       /* another answer, allowed: an edge passes closer than 16 u L */        \
    X(T_ERROR, "t error") /* another answer, allowed: the bounds of t overlap */                  \
    X(EDGE_ON, "edge-on") /* a hit beside a triangle whose three edge lines pass within 16 u L */ \
    X(DEFECT, "defect")

typedef enum LsVerdict
{
#define LS_VERDICT_ENUMERATOR(name, text) LS_VERDICT_##name,
    LS_VERDICT_LIST(LS_VERDICT_ENUMERATOR)
#undef LS_VERDICT_ENUMERATOR
        LS_VERDICT_COUNT
} LsVerdict;
const char* ls_verdict_text(LsVerdict verdict);

// Judges answer_count answers to each ray of a batch (closest hit, no culling). answers[a] points
// at ray_count hits, verdicts[a] at room for as many.
void ls_reference_judge(const LsReference* reference, const LsRay* rays, const uint32_t* masks,
                        uint32_t ray_count, uint32_t answer_count, const LsHit* const* answers,
                        LsVerdict* const* verdicts);

// As ls_reference_judge for one answer, but looks at every triangle instead of those near the ray.
LsVerdict ls_reference_judge_all(const LsReference* reference, const LsRay* ray, uint32_t mask,
                                 const LsHit* answer);

// What is known in double of one triangle and a ray. Distances in object units, t in those of the
// ray.
typedef struct LsReferenceMargin
{
    double t;             // where the ray meets the plane; NaN for a ray in the plane
    double t_bound;       // 16 u (|t| + L |n| / |n.d|)
    double edge_distance; // from the ray's line to the closest edge
    double edge_bound;    // 16 u L
    double cosine;        // |n.d| / (|n| |d|): 0 is edge-on
    bool inside;          // the line passes through the triangle
} LsReferenceMargin;

// False: no such triangle, or the ray does not reach its object.
bool ls_reference_margin(const LsReference* reference, const LsRay* ray, uint32_t mask,
                         uint32_t instance, uint32_t primitive, LsReferenceMargin* margin);

// Why an answer through the Line Space may differ from that of testing all triangles on the same
// device.
#define LS_EXCEPTION_LIST(X)                                                  \
    X(NONE, "none")           /* no reason: a defect */                       \
    X(OTHER_HIT, "other hit") /* the error of t reaches past the other hit */ \
    X(TMAX, "tmax")           /* ... past tmax */                             \
    X(CELL_END, "cell end")   /* ... past the end of the cell that the hit lies in */

typedef enum LsException
{
#define LS_EXCEPTION_ENUMERATOR(name, text) LS_EXCEPTION_##name,
    LS_EXCEPTION_LIST(LS_EXCEPTION_ENUMERATOR)
#undef LS_EXCEPTION_ENUMERATOR
        LS_EXCEPTION_COUNT
} LsException;
const char* ls_exception_text(LsException exception);

// Largest cosine at which a triangle counts as nearly edge-on.
#define LS_EDGE_ON_COSINE 0.1

// The exception of SPEC 7.6, established in double for one ray: the triangle of `all` (the answer
// of testing all triangles) was overtaken by `exact`, is nearly edge-on, and its own error of t is
// the reason.
LsException ls_reference_explain(const LsReference* reference, const LsRay* ray, uint32_t mask,
                                 const LsHit* all, const LsHit* exact, double* cosine);

#endif
