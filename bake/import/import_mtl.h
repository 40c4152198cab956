// import_mtl.h - MTL files: the materials of an OBJ, with their textures.
//
// What becomes of a material (MTL has Phong's model, the scene has glTF's):
//
//   Kd               base colour, clamped to [0,1]; one number stands for three
//   Ke               emission
//   Pr, Pm           roughness, metallic
//   Ks, Ns           without Pr: roughness = (2 / (Ns + 2))^(1/4), whose square is the width of a lobe
//                    like Phong's, if Ks is not black and illum is none or from 2 on; otherwise 1
//   illum 3, 5       a mirror if Ks is brighter than Kd: metallic 1 and base colour Ks, without Pm
//   d, Tr            opacity, d = 1 - Tr
//   illum 4, 6, 7, 9 glass: transmission 1 - d; with d = 1 it is 1 for 6 and 7, which refract. Also
//                    where d < 1 and Tf is given. Tf then is the base colour.
//   d < 1 otherwise  the surface is opaque, and a warning says so: nothing is blended
//   Ni               index of refraction, if above 1
//   map_Kd, map_Ke   textures of colours, which multiply Kd and Ke (Ke is 1 1 1 without its own)
//   norm             normal texture, -bm its scale
//   map_d            holes where its alpha (its luminance, if it has no alpha) is below 0.5
//   -s, -o, -clamp   scale and offset of texture coordinates, and whether they end at the border
//   Ka, illum 0 to 2, sharpness have no meaning for light that is traced, and no warning
//
// Anything else is named in a warning: other statements and options, images that are missing or that
// cannot be decoded, bump maps, which are heights and no normals.

#ifndef LS_IMPORT_MTL_H
#define LS_IMPORT_MTL_H

#include "import.h"
#include "name_table.h"

// The materials of one OBJ. Set the first three, `files` if it is the files that are asked for, zero
// the rest; ls_mtl_destroy frees it.
typedef struct LsMtl
{
    LsInput* input;
    const char* obj_path; // its folder is where libraries and images are looked for
    LsError* error;
    LsNameTable* files;    // all that is looked for is noted here, and no image read; NULL: neither
    LsNameTable materials; // by name: index into LsInput.materials; a later definition counts
    LsNameTable libraries; // those that have been looked for
    LsNameTable images;    // by path: index into LsInput.images, or LS_NONE for those left out
    LsNameTable statements; // those that have been warned of
    uint32_t warning_count;
} LsMtl;

// Reads the libraries that a mtllib line names: one whose name has spaces, or several. Those that
// are not there are warned of, those already read are passed over.
LsResult ls_mtl_read_libraries(LsMtl* mtl, const char* names);
void ls_mtl_destroy(LsMtl* mtl);

// As ls_input_warn, but only so many times.
LsResult ls_mtl_warn(LsMtl* mtl, LsMessage message, const char* format, ...) LS_PRINTF(3, 4);

#endif
