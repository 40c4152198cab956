// texels.h - the arrays of a scene as texel buffers, for devices that read those much faster.
//
// llvmpipe loads each word of a buffer lane by lane, with a branch for each (Mesa 22.3: some 300
// cycles for the eight of a subgroup), but gathers texels at once. Kernels compiled with LS_TEXELS
// (shaders/scene.glsl) read the scene so; rays and hits stay where the caller has them.

#ifndef LS_TEXELS_H
#define LS_TEXELS_H

#include "buffer.h"

#define LS_TEXEL_ARRAY_COUNT 11 // of LsTraceScene

// An array as texels.
typedef struct LsTexelArray
{
    const LsBuffer* buffer; // NULL: absent, never read
    bool is_words;          // texels are words, else four words
} LsTexelArray;

// Binding i of the set is array i of LsTraceScene. Zeroed when destroyed.
typedef struct LsTexels
{
    VkDescriptorSetLayout layout;
    VkDescriptorPool pool;
    VkDescriptorSet set; // of the pool
    VkBufferView views[LS_TEXEL_ARRAY_COUNT];
} LsTexels;

// Makes views of the arrays, the first of which must not be absent, and a set of them. On failure
// *texels is zero. Errors: DEVICE_MEMORY, DEVICE, MEMORY.
LsResult ls_texels_create(const LsContext* context, const LsTexelArray arrays[LS_TEXEL_ARRAY_COUNT],
                          LsTexels* texels, LsError* error);
void ls_texels_destroy(const LsContext* context, LsTexels* texels); // zero is allowed

#endif
