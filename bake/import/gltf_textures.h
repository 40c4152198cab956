// gltf_textures.h - textures as materials use them.

#ifndef GLTF_TEXTURES_H
#define GLTF_TEXTURES_H

#include "gltf_import.h"

// What is known of textures while the materials are read.
struct GltfTextures
{
    std::map<std::string, uint32_t> numbers; // by the bytes of an LsTexture, of this file's
    std::map<size_t, uint32_t> images;       // of the glTF: index in the LsInput, or LS_NONE
};

extern "C"
{
    // Index into the LsInput's textures of a texture info (member `name` of a material's object), or
    // LS_NONE if there is none or it cannot be had. Equal ones are one.
    void ls_gltf_find_texture(GltfImport& import, GltfTextures& textures, const cJSON* object,
                              const char* name, bool is_srgb, const std::string& owner,
                              uint32_t* texture);
}

#endif
