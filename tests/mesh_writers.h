// mesh_writers.h - one mesh in every format that is imported, as files of other programs have it.
//
// Text has nine digits, which give every float back. Formats of triangles alone have polygons fanned
// from their first corner, as the importers fan them. Failures fail the calling cmocka test.

#ifndef LS_TEST_MESH_WRITERS_H
#define LS_TEST_MESH_WRITERS_H

#include "meshes.h"

#include <stddef.h>
#include <stdint.h>

// The name of a format, and the ending of its files.
#define LS_MESH_FORMAT_LIST(X)                                                  \
    X(OBJ, "obj")                                                               \
    X(PLY_TEXT, "ply")                                                          \
    X(PLY_LITTLE, "ply") /* binary, little-endian; corners counted by a byte */ \
    X(PLY_BIG, "ply")    /* binary, big-endian */                               \
    X(OFF, "off")                                                               \
    X(STL_TEXT, "stl")                                                          \
    X(STL_BINARY, "stl") /* its header begins with the word of the text form */ \
    X(GLTF, "gltf")      /* the buffer in the JSON, as base64 */                \
    X(GLB, "glb")

typedef enum LsMeshFormat
{
#define LS_MESH_FORMAT_ENUMERATOR(name, ending) LS_MESH_FORMAT_##name,
    LS_MESH_FORMAT_LIST(LS_MESH_FORMAT_ENUMERATOR)
#undef LS_MESH_FORMAT_ENUMERATOR
        LS_MESH_FORMAT_COUNT
} LsMeshFormat;

const char* ls_mesh_format_name(LsMeshFormat format); // "PLY_TEXT"
const char* ls_mesh_format_ending(LsMeshFormat format);

// A mesh of polygons. Borrows its arrays.
typedef struct LsPolygonMesh
{
    const float* positions; // xyz per vertex
    uint32_t vertex_count;
    const uint32_t* face_sizes; // corners per face, 3 to 255
    uint32_t face_count;
    const uint32_t* corners; // of all faces, one after another
} LsPolygonMesh;

// A small mesh with odd faces: a third one on an edge, one twice, one with equal corners, a pentagon;
// and with a last vertex that lies where the first does, but for the sign of a zero.
#define LS_ODD_VERTICES 7
#define LS_ODD_FACES 7
#define LS_ODD_TRIANGLES 9
extern const float ls_odd_positions[LS_ODD_VERTICES][3];
extern const uint32_t ls_odd_indices[LS_ODD_TRIANGLES][3]; // of the fanned triangles
extern const LsPolygonMesh ls_odd_mesh;

// The triangles of a mesh as polygons, its vertices borrowed; the caller frees what `face_sizes`
// points to.
LsPolygonMesh ls_polygons_of(const LsTestMesh* mesh);

// The bytes of a file, malloc'ed; they end with the last character of the last line of a text, its
// line end left out.
char* ls_mesh_bytes(const LsPolygonMesh* mesh, LsMeshFormat format, size_t* size);

#endif
