// looks.h - what a mesh's corners have beside their place: normals, texture coordinates, colours.

#ifndef LS_LOOKS_H
#define LS_LOOKS_H

#include "import/import.h"
#include "ls_bake.h"

// Records as the file stores them, three per face of the input, dropped ones too; NULL where the
// object has, or needs, none. Owns its arrays.
typedef struct LsLooks
{
    uint32_t* normals;
    LsTexcoord* texcoords[2];
    LsCornerColor* colors;
} LsLooks;

// What the looks of a mesh are made from.
typedef struct LsLooksSource
{
    const uint32_t* corners; // three per face, welded
    const uint8_t* flat;     // per face: no area
    uint32_t vertex_count;   // welded
    uint32_t threads;
} LsLooksSource;

// Makes the looks of mesh `index`. Normals are left out when all equal those of their faces, as far
// as the encoding tells; texture coordinates, when no material of a face uses a texture that reads
// the set; colours, when all are white. Corners without normal have LS_NONE, without coordinates
// (0, 0), without colour white. Warnings: MESH_NORMAL, MESH_TEXCOORD (numbers that are not finite:
// taken for none), MESH_NO_TEXCOORD (textures that cannot show). Errors: OUT_OF_MEMORY, and
// warnings under --strict.
LsResult ls_looks_create(LsLooks* looks, LsInput* input, uint32_t index, const LsBakeDesc* desc,
                         const LsLooksSource* source, LsError* error);
void ls_looks_destroy(LsLooks* looks);

#endif
