// material_file.h - overrides of materials, from JSON.

#ifndef LS_MATERIAL_FILE_H
#define LS_MATERIAL_FILE_H

#include "convert.h"

// Sets what `how->materials` names in the materials of the part, the last of the input. It is JSON
// itself if it begins with '{', else the name of a file of at most LS_MATERIAL_FILE_BYTES:
//
//     {"baseColorFactor": [0.8, 0.1, 0.1], "roughnessFactor": 0.3}            every material
//     {"materials": {"*": {...}, "gold": {...}}}    every one first, then each by its file's name
//
// Each object is a glTF 2.0 material or its fields laid flat: pbrMetallicRoughness with
// baseColorFactor (3 or 4 numbers), metallicFactor, roughnessFactor; emissiveFactor and beside it
// emissiveStrength (KHR_materials_emissive_strength); alphaMode OPAQUE or MASK, alphaCutoff,
// doubleSided; ior (KHR_materials_ior); transmissionFactor (KHR_materials_transmission). What it
// does not name stays as the file has it, textures too: they cannot be set here. A part that has
// triangles of the material that files without share gets one of its own, if "*" or a bare object
// is given. Errors, each naming the key: FILE_*, MATERIAL_* (no JSON; unknown keys, values out of
// range, names that no material has), OUT_OF_MEMORY.
LsResult ls_input_override(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                           LsError* error);

// Whether LsBakeInput.materials is the JSON itself.
bool ls_materials_are_inline(const char* materials);

#define LS_MATERIAL_FILE_BYTES (256u << 10)

#endif
