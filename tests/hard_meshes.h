// hard_meshes.h - geometry that grids fear, of any size: for tests at small ones, for measuring at large ones
// (tools/hard_geometry.sh).

#ifndef LS_HARD_MESHES_H
#define LS_HARD_MESHES_H

#include "meshes.h"

#define LS_HARD_MESH_LIST(X)                                                                 \
    X(STADIUM, "stadium") /* a ball of `count` triangles on a floor 10,000 times its size */ \
    X(SPAN, "span")       /* dust, and a triangle that spans all voxels */                   \
    X(CLUSTER, "cluster") /* all but two triangles in a thousandth of the box: one cell */   \
    X(HUB, "hub")         /* all share one vertex */                                         \
    X(EDGE, "edge")       /* all share one edge */                                           \
    X(FLAT, "flat")       /* a flat scene */                                                 \
    X(LAYERS, "layers")   /* the flat scene ten times over: coplanar duplicates */           \
    X(EQUAL, "equal")     /* one triangle, as often */                                       \
    X(NEEDLES, "needles") /* needles across the whole box */                                 \
    X(SIZES, "sizes")     /* twelve balls, each of 0.6 times the size of the one before */

typedef enum LsHardMeshId
{
#define LS_HARD_MESH_ENUMERATOR(name, text) LS_HARD_MESH_##name,
    LS_HARD_MESH_LIST(LS_HARD_MESH_ENUMERATOR)
#undef LS_HARD_MESH_ENUMERATOR
        LS_HARD_MESH_COUNT
} LsHardMeshId;

const char* ls_hard_mesh_name(LsHardMeshId id);

// About `count` >= 200 triangles; ls_test_mesh_destroy frees them. Fails the calling cmocka test when out of
// memory.
LsTestMesh ls_hard_mesh_make(LsHardMeshId id, uint32_t count);

#endif
