// meshes.h - the meshes of the exactness tests: a few real ones and many unkind ones, made or
// loaded by code.
//
// The same triangles on every machine. A failure to read or write fails the calling cmocka test.

#ifndef LS_TEST_MESHES_H
#define LS_TEST_MESHES_H

#include <stdbool.h>
#include <stdint.h>

#define LS_TEST_MESH_LIST(X)                                                                       \
    X(BUNNY, "bunny")       /* scenes/bunny.ply, 69,666 triangles */                               \
    X(TEAPOT, "teapot")     /* Newell's patches, 2,304 triangles, some without area */             \
    X(ELEPHANT, "elephant") /* from CGAL's data, 5,558 triangles */                                \
    X(SHELL, "shell")       /* a box with walls of 1e-4 of its side, on the borders of cells */    \
    X(SHEETS, "sheets")     /* two wavy sheets 1e-5 apart */                                       \
    X(SLIVERS, "slivers") /* needles up to 1e6 times as long as wide, duplicates, coplanar ones */ \
    X(HUB, "hub")         /* 3,000 triangles that share one corner: leaves of a BVH */             \
    X(FAN, "fan")         /* 100 triangles of tiny angles round one corner */                      \
    X(ONE, "one")         /* a single triangle */                                                  \
    X(FLAT, "flat")       /* a flat scene: 800 triangles of a plane */                             \
    X(STADIUM, "stadium") /* a tiny teapot in a bowl 400 times as large: sub-grids */              \
    X(MICRO, "micro")     /* the teapot at a scale of 1e-6 */                                      \
    X(MEGA, "mega")       /* the teapot at a scale of 1e6 */                                       \
    X(FAR, "far")         /* the teapot ten thousand sizes away from the origin */                 \
    X(STRAY, "stray")     /* triangles among kept points and segments */

typedef enum LsTestMeshId
{
#define LS_TEST_MESH_ENUMERATOR(name, text) LS_TEST_MESH_##name,
    LS_TEST_MESH_LIST(LS_TEST_MESH_ENUMERATOR)
#undef LS_TEST_MESH_ENUMERATOR
        LS_TEST_MESH_COUNT
} LsTestMeshId;

// Triangles by index, owned by the caller.
typedef struct LsTestMesh
{
    float* positions; // xyz per vertex
    uint32_t vertex_count;
    uint32_t* indices; // three per triangle
    uint32_t triangle_count;
    bool keep_degenerate; // bake it so
} LsTestMesh;

const char* ls_test_mesh_name(LsTestMeshId id);
LsTestMesh ls_test_mesh_make(LsTestMeshId id);
void ls_test_mesh_destroy(LsTestMesh* mesh);

// Every edge borders exactly two triangles, once in each direction.
bool ls_test_mesh_is_closed(const LsTestMesh* mesh);

// Bounds of the vertices.
void ls_test_mesh_bounds(const LsTestMesh* mesh, float lower[3], float upper[3]);

// Whether a point lies inside a closed mesh, by the parity of crossings along several lines, in
// double; false where they do not agree.
bool ls_test_mesh_contains(const LsTestMesh* mesh, const double point[3]);

// Writes binary little-endian PLY.
void ls_test_mesh_write_ply(const LsTestMesh* mesh, const char* path);

// Writes glTF (and a .bin beside it) with four instances that overlap a little: as it is, turned,
// turned and stretched by three factors, turned and mirrored.
void ls_test_mesh_write_gltf(const LsTestMesh* mesh, const char* path);

#endif
