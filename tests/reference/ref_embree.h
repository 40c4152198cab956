// ref_embree.h - the other second opinion: Embree 3 in robust mode, one object at a time.
//
// Instances are tried in turn with the ray carried into object space as SPEC 7.2 says, so that only
// the search and the triangle test are Embree's.

#ifndef LS_REF_EMBREE_H
#define LS_REF_EMBREE_H

#include "ref_trace.h"

typedef struct LsEmbree LsEmbree;

// Builds over all objects of the file, which must stay open as must the reference. NULL: no device
// or memory.
LsEmbree* ls_embree_create(const LsFile* file, const LsReference* reference);
void ls_embree_destroy(LsEmbree* embree);

// Closest hits, no culling. masks: ray_count words or NULL.
void ls_embree_trace(const LsEmbree* embree, const LsRay* rays, const uint32_t* masks,
                     uint32_t ray_count, LsHit* hits);

#endif
