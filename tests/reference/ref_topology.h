// ref_topology.h - the slow second opinion on how the faces of a mesh hang together, and a reader of the
// raw files to go with it. Shares no code with the baker, which it is to judge.

#ifndef LS_REF_TOPOLOGY_H
#define LS_REF_TOPOLOGY_H

#include <stdbool.h>
#include <stdint.h>

// A mesh as a file has it, polygons fanned from their first corner. Owns its arrays.
typedef struct LsRefMesh
{
    float* positions; // xyz per vertex
    uint32_t vertex_count;
    uint32_t* indices; // three per face
    uint32_t face_count;
} LsRefMesh;

// What LsMeshReport counts, by the definitions in ls_bake.h.
typedef struct LsRefTopology
{
    uint64_t vertices, faces, degenerate, duplicate, inverted, unorientable, edges, boundary,
        nonmanifold, holes;
} LsRefTopology;

// Reads OFF in text (a vertex and a face a line), PLY in text, or binary STL, by the ending of `path`.
// False if the file is not so.
bool ls_ref_mesh_read(LsRefMesh* mesh, const char* path);
void ls_ref_mesh_destroy(LsRefMesh* mesh);

// With `weld`, vertices of equal position are one.
LsRefTopology ls_ref_topology(const LsRefMesh* mesh, bool weld);

#endif
