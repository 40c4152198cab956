// off_mesh.h - what text and binary OFF files have in common: their header and the mesh they become.

#ifndef LS_OFF_MESH_H
#define LS_OFF_MESH_H

#include "import.h"

// An OFF file being read, twice: in the first pass, without a mesh, triangles are counted and the
// largest colours found; the second fills the mesh.
typedef struct LsOff
{
    LsInput* input;
    const char* path;
    LsError* error;
    // From the header: what stands behind positions, in this order.
    bool has_normals, has_colors, has_texcoords;
    uint64_t vertex_count;
    uint64_t face_count;
    // From the first pass. Colours are fractions, or whole numbers up to 255 if one is above 1.
    float largest_color;
    float largest_face_color;
    bool has_face_colors;
    uint64_t small_face_count; // of fewer than three corners
    uint64_t first_small_face;
    bool is_first_done;
    // From either pass.
    uint64_t triangle_count;
    uint32_t fan[2]; // first and last corner of the face so far
    LsInputMesh* mesh;
} LsOff;

// Sets the error to "path: face 3: text".
LsResult ls_off_fail_face(const LsOff* off, LsMessage message, uint64_t face, const char* text);

// Whether a mesh can have so many vertices and faces: to ask behind the header.
LsResult ls_off_check_counts(const LsOff* off);

// Takes a vertex: position, then normal, three or four of colour, and texture coordinate if the
// header has them. `color_count` is 3 or 4.
void ls_off_add_vertex(LsOff* off, uint64_t vertex, const float* numbers, uint32_t color_count);

// Takes a face and then its corners, fanned from the first.
void ls_off_begin_face(LsOff* off, uint64_t face, uint64_t corner_count);
LsResult ls_off_add_corner(LsOff* off, uint64_t face, uint64_t corner, int64_t vertex);

// Takes the colour of the face whose triangles begin at `first_triangle`.
void ls_off_color_face(LsOff* off, uint64_t face, uint64_t first_triangle, const float* color,
                       uint32_t color_count);

// Between the passes: warnings, and the arrays, if there are triangles.
LsResult ls_off_create_mesh(LsOff* off);

#endif
