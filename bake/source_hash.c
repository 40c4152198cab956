// source_hash.c - XXH3 over counts and arrays, in the order of LsInput.

#include "source_hash.h"

#include "ls_format.h"

#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

// Goes up whenever equal inputs give other bytes.
#define BAKE_REVISION 2

// Every array with its size before it, so that nothing can move from one into the next unseen.
static void add_bytes(XXH3_state_t* state, const void* bytes, uint64_t size)
{
    XXH3_128bits_update(state, &size, sizeof size);
    if (size > 0)
    {
        XXH3_128bits_update(state, bytes, size);
    }
}

#define ADD_ARRAY(state, array, count) add_bytes(state, array, sizeof *(array) * (uint64_t)(count))

static void add_options(XXH3_state_t* state, const LsBakeDesc* desc, uint32_t patches)
{
    const uint32_t numbers[] = {
        LS_FORMAT_MAJOR, LS_FORMAT_MINOR, LS_VERSION_MAJOR,      LS_VERSION_MINOR, BAKE_REVISION,
        desc->grid,      patches,         desc->keep_degenerate, desc->normals,    desc->no_weld};
    const double angle = desc->normals == LS_NORMALS_SMOOTH ? desc->smooth_angle : 0.0;
    ADD_ARRAY(state, numbers, sizeof numbers / sizeof *numbers);
    ADD_ARRAY(state, &angle, 1);
}

static void add_mesh(XXH3_state_t* state, const LsInputMesh* mesh)
{
    ADD_ARRAY(state, mesh->positions, 3ull * mesh->vertex_count);
    ADD_ARRAY(state, mesh->indices, 3ull * mesh->triangle_count);
    ADD_ARRAY(state, mesh->materials, mesh->triangle_count);
    for (int kind = 0; kind < LS_STREAM_COUNT; kind++)
    {
        const LsInputStream* stream = &mesh->streams[kind];
        ADD_ARRAY(state, stream->values,
                  (uint64_t)ls_stream_size((LsStreamKind)kind) * stream->count);
        ADD_ARRAY(state, stream->indices,
                  stream->indices != NULL ? 3ull * mesh->triangle_count : 0);
    }
}

void ls_source_hash(const LsInput* input, const LsBakeDesc* desc, uint32_t patches,
                    uint8_t hash[16])
{
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    add_options(&state, desc, patches);
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        add_mesh(&state, &input->meshes[i]);
    }
    for (uint32_t i = 0; i < input->instance_count; i++)
    {
        const LsInputInstance* instance = &input->instances[i];
        const uint32_t links[] = {instance->mesh, instance->node};
        ADD_ARRAY(&state, links, 2);
        ADD_ARRAY(&state, &instance->world_from_object[0][0], 12);
    }
    ADD_ARRAY(&state, input->nodes, input->node_count);
    for (uint32_t i = 0; i < input->material_count; i++)
    {
        ADD_ARRAY(&state, &input->materials[i].core, 1);
        ADD_ARRAY(&state, &input->materials[i].surface, 1);
    }
    ADD_ARRAY(&state, input->textures, input->texture_count);
    for (uint32_t i = 0; i < input->image_count; i++)
    {
        const LsInputImage* image = &input->images[i];
        const uint32_t size[] = {image->width, image->height};
        ADD_ARRAY(&state, size, 2);
        ADD_ARRAY(&state, image->pixels, (uint64_t)image->width * image->height);
    }
    ADD_ARRAY(&state, input->lamps, input->lamp_count);
    ADD_ARRAY(&state, input->animations, input->animation_count);
    ADD_ARRAY(&state, input->channels, input->channel_count);
    ADD_ARRAY(&state, input->keys, input->key_count);
    ADD_ARRAY(&state, input->cameras, input->camera_count);
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&state));
    memcpy(hash, canonical.digest, sizeof canonical.digest);
}
