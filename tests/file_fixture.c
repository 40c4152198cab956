// file_fixture.c - the made-up scene and its file in memory.

#define _XOPEN_SOURCE 700 // mkdtemp

#include "file_fixture.h"

#include "../format/hash.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

uint64_t ls_random_next(uint64_t* state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

// ---- Scene --------------------------------------------------------------------------------------

static float make_coordinate(uint64_t* state)
{
    return (float)(ls_random_next(state) >> 40) * 0x1p-23f - 1; // [-1, 1)
}

static LsVec3 make_point(uint64_t* state)
{
    return (LsVec3){make_coordinate(state), make_coordinate(state), make_coordinate(state)};
}

static void set_rows(LsVec4 rows[3], float scale_x, float shift)
{
    rows[0] = (LsVec4){scale_x, 0, 0, shift};
    rows[1] = (LsVec4){0, 1, 0, 0};
    rows[2] = (LsVec4){0, 0, 1, 0};
}

static void fill_scene(LsFixture* fixture)
{
    fixture->materials[0] = (LsMaterial){.base_color = {0.8f, 0.5f, 0.25f}, .roughness = 1};
    fixture->materials[1] = (LsMaterial){
        .base_color = {1, 1, 1},
        .flags = LS_MATERIAL_EMISSIVE | LS_MATERIAL_DOUBLE_SIDED,
        .emission = {4, 3, 2},
        .metallic = 0.5f,
    };
    for (uint32_t i = 0; i < 3; ++i)
    {
        set_rows(fixture->nodes[i].parent_from_node, 1, (float)i);
        fixture->nodes[i].parent = i == 0 ? LS_NONE : i - 1;
    }
    static const uint32_t objects[4] = {0, 1, 2, 1};
    for (uint32_t i = 0; i < 4; ++i)
    {
        LsInstance* instance = &fixture->instances[i];
        const float scale = i == 3 ? -1 : 1;
        set_rows(instance->object_from_world, scale, -2 * scale * (float)i);
        set_rows(instance->world_from_object, scale, 2 * (float)i);
        instance->object_from_world[0].w += 0.0f; // no negative zero in the identity
        instance->object = objects[i];
        instance->node = i < 3 ? i : LS_NONE;
        instance->mask = 255 >> i;
        instance->flags = i == 0 ? LS_INSTANCE_IDENTITY : i == 3 ? LS_INSTANCE_MIRRORED : 0;
    }
    static const uint32_t escapes[7] = {7, 4, 3, 4, 7, 6, 7};
    static const uint32_t leaves[7] = {0, 0, 2 << 4 | 1, 0 << 4 | 1, 0, 3 << 4 | 1, 1 << 4 | 1};
    for (uint32_t i = 0; i < 7; ++i)
    {
        fixture->top_nodes[i] = (LsBvhNode){
            .lower = {-1, -1, -1}, .escape = escapes[i], .upper = {7, 1, 1}, .leaf = leaves[i]};
    }
    fixture->lights[0] = (LsLight){.instance = 0, .triangle = 1, .area = 0.5f, .cumulative = 0.25f};
    fixture->lights[1] = (LsLight){.instance = 2, .triangle = 0, .area = 1.5f, .cumulative = 1};
    set_rows(fixture->cameras[0].world_from_camera, 1, 3);
    fixture->cameras[0].tan_half_y = 0.4f;
    fixture->cameras[0].aspect = 1.75f;
}

static void fill_triangles(LsFixture* fixture)
{
    uint64_t state = 7;
    for (uint32_t i = 0; i < LS_FIXTURE_TRIANGLES; ++i)
    {
        fixture->triangles[i] = (LsTriangle){
            .v0 = make_point(&state), .v1 = make_point(&state), .v2 = make_point(&state)};
        const uint32_t first = i < 2 ? 0 : i < 42 ? 2 : 42;
        fixture->triangles[i].primitive = 2 * (i - first); // half of the faces were dropped
        fixture->triangles[i].material = i == 1 || i == 42;
    }
}

// ---- Grids --------------------------------------------------------------------------------------

static void set_voxel(LsFixture* fixture, uint32_t voxel, uint32_t shape, uint32_t count,
                      uint32_t table)
{
    uint32_t first = 0;
    for (uint32_t i = 0; i < voxel; ++i)
    {
        first += fixture->voxels[i].reference_count;
    }
    fixture->voxels[voxel] = (LsVoxel){first, count, shape, table};
    for (uint32_t i = 0; i < count; ++i)
    {
        fixture->references[first + i] = i + (count < 20 ? voxel : 0);
    }
}

// Appends a mask table with all legal bits set in a third of its words, and returns the voxel's
// shape.
static uint32_t add_table(LsFixture* fixture, uint32_t patches, uint32_t log2_width, uint32_t count,
                          uint32_t* word)
{
    const uint32_t width = 1u << log2_width;
    const uint32_t bits = LS_SHAFT_COUNT(patches) * width;
    for (uint32_t bit = 0; bit < bits; ++bit)
    {
        if (bit / 32 % 3 == 0 && bit % width < count)
        {
            fixture->shafts[*word + bit / 32] |= 1u << bit % 32;
        }
    }
    *word += (bits + 31) / 32;
    return LS_VOXEL_MASKS | patches << 8 | log2_width << 16;
}

// Two levels of sub-grids: cell blocks 0 and 1 are the grid's; 2 and 3 hang on block 0, 4 on block
// 2.
static void fill_grid(LsFixture* fixture)
{
    static const struct
    {
        uint32_t block, cell;
    } links[12] = {{0, 0}, {0, 5},  {0, 21}, {0, 63}, {1, 0}, {1, 17},
                   {2, 3}, {2, 60}, {3, 31}, {4, 0},  {4, 1}, {4, 63}};
    for (uint32_t block = 0; block < 6; ++block)
    {
        for (uint32_t cell = 0; cell < LS_BLOCK_CELLS; ++cell)
        {
            fixture->cell_blocks[block].cells[cell] = 0x11111111u * (1 + cell % 15);
        }
    }
    for (uint32_t voxel = 0; voxel < 12; ++voxel)
    {
        fixture->cell_blocks[links[voxel].block].cells[links[voxel].cell] = voxel << 4;
    }
    fixture->cell_blocks[5].cells[0] = 0 << 4;
    const uint32_t blocks[5] = {0 << 4, 0xFFFFFFFFu, 0x12345678u, 1 << 4, 0 << 4};
    memcpy(fixture->blocks, blocks, sizeof(blocks));
    const uint32_t subgrids[3] = {0, 0, 2};
    memcpy(fixture->subgrids, subgrids, sizeof(subgrids));

    uint32_t word = 0, table = 0;
    set_voxel(fixture, 0, LS_VOXEL_LIST, 2, 0);
    set_voxel(fixture, 1, add_table(fixture, 1, 2, 3, &word), 3, table);
    set_voxel(fixture, 2, LS_VOXEL_SUBGRID, 0, 3);
    set_voxel(fixture, 3, LS_VOXEL_SUBGRID, 0, 2);
    table = word;
    set_voxel(fixture, 4, add_table(fixture, 2, 3, 6, &word), 6, table);
    set_voxel(fixture, 5, LS_VOXEL_BVH, 35, 0);
    table = word;
    set_voxel(fixture, 6, add_table(fixture, 1, 4, 12, &word), 12, table);
    set_voxel(fixture, 7, LS_VOXEL_SUBGRID, 0, 4);
    set_voxel(fixture, 8, LS_VOXEL_LIST, 4, 0);
    table = word;
    set_voxel(fixture, 9, add_table(fixture, 1, 5, 32, &word), 32, table);
    table = word;
    set_voxel(fixture, 10, add_table(fixture, 3, 2, 4, &word), 4, table);
    set_voxel(fixture, 11, LS_VOXEL_BVH, 3, 5);
    assert_int_equal(word, LS_FIXTURE_SHAFT_WORDS);
    // The last voxel is another object's, so its part of REFERENCES begins anew.
    fixture->voxels[12] = (LsVoxel){0, 1, LS_VOXEL_LIST, 0};

    static const uint32_t escapes[6] = {5, 2, 5, 4, 5, 1};
    static const uint32_t leaves[6] = {0, 0 << 4 | 15, 0, 15 << 4 | 15, 30 << 4 | 5, 0 << 4 | 3};
    for (uint32_t i = 0; i < 6; ++i)
    {
        fixture->leaf_nodes[i] = (LsBvhNode){
            .lower = {0, 0, 0}, .escape = escapes[i], .upper = {6, 5, 4}, .leaf = leaves[i]};
    }
}

static void fill_objects(LsFixture* fixture)
{
    for (uint32_t i = 0; i < 3; ++i)
    {
        fixture->objects[i].lower = (LsVec3){-1, -1, -1};
        fixture->objects[i].upper = (LsVec3){1, 1, 1};
        fixture->objects[i].reach = 4;
    }
    LsObject* list = &fixture->objects[0];
    list->kind = LS_OBJECT_LIST;
    list->triangle_count = 2;
    list->face_count = 4;

    LsObject* grid = &fixture->objects[1];
    grid->kind = LS_OBJECT_GRID;
    grid->grid_lower = (LsVec3){-1, -1, -1};
    grid->inverse_cell = 3;
    grid->cells[0] = 6;
    grid->cells[1] = 5;
    grid->cells[2] = 4;
    grid->bound = 6 * 0x1p-18f;
    grid->first_triangle = 2;
    grid->triangle_count = 40;
    grid->block_count = 4;
    grid->cell_block_count = 5;
    grid->subgrid_count = 3;
    grid->voxel_count = 12;
    grid->reference_count = 101;
    grid->leaf_node_count = 6;
    grid->shaft_word_count = LS_FIXTURE_SHAFT_WORDS;
    grid->face_count = 80;
    grid->depth = 2;
    grid->patches = 3;

    fixture->objects[2] = (LsObject){
        .lower = {-1, -1, -1},
        .kind = LS_OBJECT_GRID,
        .upper = {1, 1, 1},
        .reach = 4,
        .grid_lower = {-1, -1, -1},
        .inverse_cell = 0.5f,
        .cells = {1, 1, 1},
        .bound = 0x1p-18f,
        .first_triangle = 42,
        .triangle_count = 1,
        .first_block = 4,
        .block_count = 1,
        .first_cell_block = 5,
        .cell_block_count = 1,
        .first_subgrid = 3,
        .first_voxel = 12,
        .voxel_count = 1,
        .first_reference = 101,
        .reference_count = 1,
        .first_leaf_node = 6,
        .first_shaft_word = LS_FIXTURE_SHAFT_WORDS,
        .face_count = 1,
        .patches = 1,
    };
}

static void fill_looks(LsFixture* fixture)
{
    fixture->materials[1].surface = 1;
    fixture->surfaces[0] = (LsSurface){.transmission = 0.5f,
                                       .ior = 1.5f,
                                       .alpha = 1,
                                       .alpha_cutoff = 0.25f,
                                       .normal_scale = 1,
                                       .flags = LS_SURFACE_MASK,
                                       .base_color_texture = 0,
                                       .metallic_roughness_texture = LS_NONE,
                                       .normal_texture = 1,
                                       .emissive_texture = LS_NONE,
                                       .transmission_texture = LS_NONE};
    fixture->textures[0] =
        (LsTexture){.row_u = {1, 0, 0, 0}, .row_v = {0, 1, 0, 0}, .flags = LS_TEXTURE_SRGB};
    fixture->textures[1] = (LsTexture){.row_u = {2, 0, 0.5f, 0},
                                       .row_v = {0, 2, 0, 0},
                                       .image = 1,
                                       .texcoord = 1,
                                       .flags = LS_TEXTURE_CLAMP_U | LS_TEXTURE_MIRROR_V};
    fixture->images[0] = (LsImage){.width = 2, .height = 1};
    fixture->images[1] = (LsImage){.width = 1, .height = 3, .first_pixel = 2};
    for (uint32_t i = 0; i < 5; ++i)
    {
        fixture->pixels[i] = 0xFF000000u + 0x101010u * i;
    }
    fixture->attributes[0] = (LsAttributes){0, {0, 6}, 0};
    fixture->attributes[1] = (LsAttributes){LS_NONE, {LS_NONE, LS_NONE}, LS_NONE};
    fixture->attributes[2] = (LsAttributes){LS_NONE, {LS_NONE, LS_NONE}, 6};
    for (uint32_t i = 0; i < 6; ++i)
    {
        fixture->normals[i] = i == 5 ? LS_NONE : 1000 * i;
    }
    for (uint32_t i = 0; i < 12; ++i)
    {
        fixture->texcoords[i] = (LsTexcoord){0.25f * (float)i, 1 - (float)i};
    }
    for (uint32_t i = 0; i < 9; ++i)
    {
        fixture->colors[i] = (LsCornerColor){0x10002000 + i, 0xFFFF3000};
    }
    fixture->lamps[0] = (LsLamp){.position = {1, 2, 3},
                                 .kind = LS_LAMP_POINT,
                                 .direction = {0, 0, -1},
                                 .range = 9,
                                 .intensity = {1, 2, 3},
                                 .node = 1,
                                 .cos_inner = 1,
                                 .cos_outer = -1};
    fixture->lamps[1] = (LsLamp){.kind = LS_LAMP_SPOT,
                                 .direction = {0, 1, 0},
                                 .intensity = {5, 5, 5},
                                 .node = LS_NONE,
                                 .cos_inner = 0.75f,
                                 .cos_outer = 0.5f};
    fixture->lamps[2] = (LsLamp){.kind = LS_LAMP_DIRECTIONAL,
                                 .direction = {1, 0, 0},
                                 .intensity = {1, 1, 1},
                                 .node = LS_NONE,
                                 .cos_inner = 1,
                                 .cos_outer = -1};
}

// Appends a channel whose keys begin at *key: their times, unless it shares those of the channel
// before, then its values.
static void add_channel(LsFixture* fixture, uint32_t index, LsChannel channel, bool shares,
                        const float* numbers, uint32_t count, uint32_t* key)
{
    channel.first_time = shares ? fixture->channels[index - 1].first_time : *key;
    channel.first_value = shares ? *key : *key + channel.key_count;
    fixture->channels[index] = channel;
    memcpy(fixture->keys + *key, numbers, count * sizeof(float));
    *key += count;
}

// Node 2 moves and turns at the same times; node 0 swings smoothly, jumps round and grows.
static void fill_animations(LsFixture* fixture)
{
    static const float move[12] = {0, 1, 2, /**/ 0, 0, 0, /**/ 1, 0, 0, /**/ 1, 2, 3};
    static const float turn[12] = {0, 0, 0, 1, /**/ 0, 1, 0, 0, /**/ 0.6f, 0, 0, -0.8f};
    static const float rest[4] = {0, /**/ 1, 1, 1};
    static const float swing[20] = {0.5f,   4, /**/ 9, 9, 9, 0, 0, 0, 1, 1, 1, //
                                    /**/ 2, 2, 2,      5, 5, 5, 9, 9, 9};
    static const float jump[5] = {0, /**/ 1, 0, 0, 0};
    static const float grow[3] = {2, 2, 2};
    uint32_t key = 0;
    add_channel(fixture, 0,
                (LsChannel){.node = 2,
                            .path = LS_PATH_TRANSLATION,
                            .interpolation = LS_INTERPOLATION_LINEAR,
                            .key_count = 3},
                false, move, 12, &key);
    add_channel(fixture, 1,
                (LsChannel){.node = 2,
                            .path = LS_PATH_ROTATION,
                            .interpolation = LS_INTERPOLATION_LINEAR,
                            .key_count = 3},
                true, turn, 12, &key);
    add_channel(fixture, 2, (LsChannel){.node = 2, .path = LS_PATH_SCALE, .key_count = 1}, false,
                rest, 4, &key);
    add_channel(fixture, 3,
                (LsChannel){.path = LS_PATH_TRANSLATION,
                            .interpolation = LS_INTERPOLATION_CUBIC,
                            .key_count = 2},
                false, swing, 20, &key);
    add_channel(fixture, 4, (LsChannel){.path = LS_PATH_ROTATION, .key_count = 1}, false, jump, 5,
                &key);
    add_channel(fixture, 5, (LsChannel){.path = LS_PATH_SCALE, .key_count = 1}, true, grow, 3,
                &key);
    assert_int_equal(key, sizeof(fixture->keys) / sizeof(float));
    fixture->animations[0] = (LsAnimation){.channel_count = 3, .duration = 2};
    fixture->animations[1] = (LsAnimation){.first_channel = 3, .channel_count = 3, .duration = 4};
}

void ls_fixture_fill(LsFixture* fixture)
{
    *fixture = (LsFixture){0};
    fill_scene(fixture);
    fill_triangles(fixture);
    fill_grid(fixture);
    fill_objects(fixture);
    fill_looks(fixture);
    fill_animations(fixture);
    LsFileDesc* desc = &fixture->desc;
#define FILL_CHUNK(NAME, array, type, code) \
    desc->array = fixture->array;           \
    desc->NAME##_count = sizeof(fixture->array) / sizeof(fixture->array[0]);
    LS_CHUNK_LIST(FILL_CHUNK)
#undef FILL_CHUNK
    for (int axis = 0; axis < 3; ++axis)
    {
        desc->lower[axis] = -1;
        desc->upper[axis] = axis == 0 ? 7 : 1;
    }
    desc->transform_bound = 0x1p-20f;
    memcpy(desc->source_hash, "source of fixture", sizeof(desc->source_hash));
}

// ---- Files --------------------------------------------------------------------------------------

LsFixtureBytes ls_fixture_read(const char* path)
{
    LsFixtureBytes result = {0};
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    result.size = (uint64_t)ftell(file);
    rewind(file);
    result.bytes = aligned_alloc(4096, (result.size + 4096) / 4096 * 4096);
    assert_non_null(result.bytes);
    assert_int_equal(fread(result.bytes, 1, result.size, file), result.size);
    fclose(file);
    return result;
}

LsFixtureBytes ls_fixture_bytes(const LsFileDesc* desc)
{
    char directory[LS_SCRATCH_PATH];
    ls_scratch_create(directory);
    char path[LS_SCRATCH_PATH + 32];
    snprintf(path, sizeof(path), "%s/fixture.lspace", directory);
    LsError error;
    assert_int_equal(ls_file_write(desc, path, &error), LS_OK);
    LsFixtureBytes result = ls_fixture_read(path);
    ls_scratch_remove(directory);
    return result;
}

void ls_fixture_free(LsFixtureBytes* bytes)
{
    free(bytes->bytes);
    *bytes = (LsFixtureBytes){0};
}

void ls_fixture_rehash(const LsFixtureBytes* bytes)
{
    LsHeader* header = (LsHeader*)(void*)bytes->bytes;
    LsEntry* entries = (LsEntry*)(void*)(bytes->bytes + LS_HEADER_BYTES);
    if (header->chunk_count > (bytes->size - LS_HEADER_BYTES) / LS_ENTRY_BYTES)
    {
        return;
    }
    for (uint32_t i = 0; i < header->chunk_count; ++i)
    {
        if (entries[i].offset <= bytes->size &&
            entries[i].stored_bytes <= bytes->size - entries[i].offset)
        {
            ls_hash_bytes(bytes->bytes + entries[i].offset, entries[i].stored_bytes,
                          entries[i].hash);
        }
    }
    ls_hash_header(header, entries, header->hash);
}

void ls_scratch_create(char directory[LS_SCRATCH_PATH])
{
    const int length = snprintf(directory, LS_SCRATCH_PATH, LS_BINARY_DIR "/scratch-XXXXXX");
    assert_in_range(length, 1, LS_SCRATCH_PATH - 1);
    assert_non_null(mkdtemp(directory));
}

// Counts the entries, and removes them when asked to.
static uint32_t visit_scratch(const char* directory, bool removing)
{
    DIR* stream = opendir(directory);
    assert_non_null(stream);
    uint32_t count = 0;
    for (struct dirent* entry = readdir(stream); entry != NULL; entry = readdir(stream))
    {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
        {
            continue;
        }
        ++count;
        char path[LS_SCRATCH_PATH + 300];
        snprintf(path, sizeof(path), "%s/%s", directory, entry->d_name);
        if (removing)
        {
            assert_int_equal(remove(path), 0);
        }
    }
    closedir(stream);
    return count;
}

uint32_t ls_scratch_count(const char* directory)
{
    return visit_scratch(directory, false);
}

void ls_scratch_remove(const char* directory)
{
    visit_scratch(directory, true);
    assert_int_equal(rmdir(directory), 0);
}
