// world.h - the scene around the objects: instances with their transforms, the top level over them,
// lights.

#ifndef LS_WORLD_H
#define LS_WORLD_H

#include "mesh.h"

// Owns its arrays.
typedef struct LsWorld
{
    LsInstance* instances;
    uint32_t instance_count;
    LsBvhNode* top_nodes; // none for one object and one instance, the identity
    uint32_t top_node_count;
    LsLight* lights;
    uint32_t light_count;
    float lower[3]; // bounds of everything
    float upper[3];
    float transform_bound; // SPEC 7.3
    double max_condition;  // infinity norm condition number of the worst transform
} LsWorld;

// meshes: one per input mesh, same numbers. Triangles must
// have their final order, since lights name them. Errors: TRANSFORM_SINGULAR,
// TRANSFORM_CONDITION (above 1e6), TRANSFORM_RANGE (numbers beyond 1e18), OUT_OF_MEMORY.
LsResult ls_world_create(LsWorld* world, const LsInput* input, const LsMesh* meshes,
                         LsError* error);
void ls_world_destroy(LsWorld* world);

#endif
