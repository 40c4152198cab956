// mesh.h - an object's triangles as the later stages want them.

#ifndef LS_MESH_H
#define LS_MESH_H

#include "import/import.h"

// The triangles of one object that a ray can hit, in object space. Owns its arrays.
typedef struct LsMesh
{
    LsTriangle*
        triangles; // in input order; primitive counts the faces of the input, dropped ones too
    uint32_t triangle_count;
    uint32_t face_count;       // of the input, polygons fanned
    uint32_t degenerate_count; // dropped: no area
    float lower[3];            // bounds of the kept triangles; zero without any
    float upper[3];
} LsMesh;

// Checks and copies. `name` is the input file, for messages. Errors: INPUT_NOT_FINITE, INPUT_RANGE
// (the largest coordinate exceeds the extent by more than 2^20, or the extent is outside [1e-9,
// 1e12]), MEMORY.
LsResult ls_mesh_create(LsMesh* mesh, const LsInputMesh* input, const char* name, LsError* error);
void ls_mesh_destroy(LsMesh* mesh);

#endif
