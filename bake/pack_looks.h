// pack_looks.h - how surfaces look, into the arrays of a file; what no triangle uses is left out.

#ifndef LS_PACK_LOOKS_H
#define LS_PACK_LOOKS_H

#include "ls_write.h"
#include "mesh.h"

// Owns its arrays.
typedef struct LsPackLooks
{
    LsSurface* surfaces;
    LsTexture* textures;
    LsImage* images;
    uint32_t* pixels;
    LsAttributes* attributes;
    uint32_t* normals;
    LsTexcoord* texcoords;
    LsCornerColor* colors;
} LsPackLooks;

// Numbers the surfaces that differ from LS_SURFACE_DEFAULT in materials of triangles, in the order
// of materials, and stores 1 + the number in `surface` of `materials` (input->material_count);
// keeps the textures of those surfaces and the images of those textures, each in the input's order;
// and lays out the corners' records of all meshes in the order of their triangles, which must be
// the final one. Images and looks are freed as they are packed. Fills the fields of `desc` for all
// that. Errors: OUT_OF_MEMORY, LIMIT_RECORDS.
LsResult ls_pack_looks_create(LsPackLooks* looks, LsFileDesc* desc, LsMaterial* materials,
                              LsInput* input, LsMesh* meshes, LsError* error);
void ls_pack_looks_destroy(LsPackLooks* looks);

#endif
