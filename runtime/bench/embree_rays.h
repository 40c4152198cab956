// embree_rays.h - the same rays through Embree on the CPU, for lsbench to compare with: fast mode, one ray at a
// time, as many threads as asked for. I. Wald et al., "Embree: A Kernel Framework for Efficient CPU Ray Tracing", 2014.

#ifndef EMBREE_RAYS_H
#define EMBREE_RAYS_H

#include "ls_format.h"

#include <stdbool.h>

// All instances of a file as one Embree scene.
typedef struct LsEmbreeRays LsEmbreeRays;

// Whether lsbench was built with Embree; without it none can be created.
bool ls_embree_rays_are_built(void);

// NULL when out of memory.
LsEmbreeRays* ls_embree_rays_create(const LsFile* file, uint32_t threads);
void ls_embree_rays_destroy(LsEmbreeRays* embree); // NULL is allowed

// Traces rays[count], for any hit or the closest. Returns the seconds it took by the wall clock;
// *hit_count are those that hit.
double ls_embree_rays_trace(const LsEmbreeRays* embree, const LsRay* rays, uint32_t count, bool any,
                            uint32_t* hit_count);

#endif
