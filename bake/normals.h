// normals.h - shading normals from the faces around a vertex.

#ifndef LS_NORMALS_H
#define LS_NORMALS_H

#include <stdbool.h>
#include <stdint.h>

// A vertex with more faces round it than this is no point of a smooth surface: corners there keep
// their faces' own normals, and time stays bounded.
#define LS_SMOOTH_FACES 1024

// What normals are made from.
typedef struct LsSmoothFaces
{
    const float* positions;  // xyz per vertex of the input
    const uint32_t* indices; // three per face, of the input
    const uint32_t* corners; // three per face, welded
    const uint8_t* flat;     // per face: without area, it neither gives nor gets a normal
    uint32_t face_count;
    uint32_t vertex_count; // welded
} LsSmoothFaces;

// Makes a word of NORMALS for each corner: the sum, weighted by their angles there, of the normals
// of those faces round its vertex that differ from its own face's by at most `degrees`. LS_NONE at
// corners of flat faces and where the sum is zero. `words` has room for three per face. The result
// does not depend on `threads`. False when out of memory.
bool ls_normals_smooth(const LsSmoothFaces* faces, double degrees, uint32_t threads,
                       uint32_t* words);

// The normal of a face with area, counter-clockwise from the front, of length 1.
void ls_face_normal(const float* positions, const uint32_t indices[3], double normal[3]);

#endif
