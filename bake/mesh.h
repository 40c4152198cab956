// mesh.h - an object's triangles as the later stages want them, and what was found in its mesh.

#ifndef LS_MESH_H
#define LS_MESH_H

#include "looks.h"
#include "progress.h"
#include "topology.h"

// Faces of one object: sides are counted in 32 bits.
#define LS_MAX_FACES 0x7FFFFFFFu

// The triangles of one object, in object space. Owns its arrays.
typedef struct LsMesh
{
    LsTriangle*
        triangles; // in input order; primitive counts the faces of the input, dropped ones too
    uint32_t triangle_count;
    uint32_t face_count;       // of the input, polygons fanned
    uint32_t degenerate_count; // no area
    bool may_have_copies;      // whether two triangles may have the same corners
    float lower[3];            // bounds of the kept triangles; zero without any
    float upper[3];
    LsLooks looks; // of all faces of the input
} LsMesh;

// What a mesh has that its user should know of.
typedef struct LsMeshFindings
{
    LsMeshReport report;
    LsMeshExamples examples;
} LsMeshFindings;

// Checks mesh `index` of the input, welds its vertices, looks for faults and copies its triangles
// and their looks. Of `desc` the options of the mesh stage count. Faces without area are dropped,
// or kept as the points and segments that they are: the middle one of three corners on a line moves
// to the nearer of the others, which proves (SPEC 7.4) that no ray hits the triangle. A mesh whose
// faces all have no area has none kept. The result does not depend on `threads`; `progress` may be
// NULL. Errors: MESH_NOT_FINITE, LIMIT_RECORDS, MESH_FAR, MESH_EXTENT, OUT_OF_MEMORY; under
// --strict those of ls_looks_create.
LsResult ls_mesh_create(LsMesh* mesh, LsInput* input, uint32_t index, const LsBakeDesc* desc,
                        uint32_t threads, const LsStageProgress* progress, LsMeshFindings* findings,
                        LsError* error);
void ls_mesh_destroy(LsMesh* mesh);

#endif
