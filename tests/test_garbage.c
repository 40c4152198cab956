// test_garbage.c - random words inside valid files, hashes made right again: opening and checking
// never crash, and what passes can be walked along every index without a look at a count.

#include "file_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CASES 100000
#define MAX_EDITS 6

// ---- Walking ------------------------------------------------------------------------------------

// Reads what a tracer could reach, trusting the file, in every order that it could. The sum keeps
// the reads from being left out; steps are counted so that a loop without end is a failure.
typedef struct Walk
{
    const LsFile* file;
    uint64_t steps;
    uint64_t sum;
} Walk;

static void take(Walk* walk, const void* bytes, size_t size)
{
    ++walk->steps;
    if (walk->steps > 1000000)
    {
        fail_msg("a walk does not end");
    }
    for (size_t i = 0; i < size; ++i)
    {
        walk->sum += ((const uint8_t*)bytes)[i];
    }
}

static void walk_triangle(Walk* walk, const LsObject* object, uint32_t triangle)
{
    const LsTriangle* record = &walk->file->triangles[object->first_triangle + triangle];
    take(walk, record, sizeof(*record));
    take(walk, &walk->file->materials[record->material], sizeof(LsMaterial));
    assert_true(record->primitive < object->face_count);
}

static void walk_references(Walk* walk, const LsObject* object, uint32_t first, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
    {
        walk_triangle(walk, object, walk->file->references[object->first_reference + first + i]);
    }
}

// Along all nodes, as after hits, or from escape to escape, as after misses.
static void walk_leaf_bvh(Walk* walk, const LsObject* object, const LsVoxel* voxel, bool missing)
{
    const LsBvhNode* nodes = walk->file->leaf_nodes + object->first_leaf_node + voxel->table;
    const uint32_t count = nodes[0].escape;
    for (uint32_t i = 0; i < count;)
    {
        take(walk, &nodes[i], sizeof(nodes[i]));
        const uint32_t leaf = nodes[i].leaf;
        walk_references(walk, object, voxel->first_reference + (leaf >> 4), leaf & 15);
        i = missing || leaf != 0 ? nodes[i].escape : i + 1;
    }
}

static void walk_masks(Walk* walk, const LsObject* object, const LsVoxel* voxel)
{
    const uint32_t patches = voxel->shape >> 8 & 255;
    const uint32_t width = ls_mask_width(voxel);
    const uint32_t shafts = LS_SHAFT_COUNT(patches);
    const uint32_t* table = walk->file->shafts + object->first_shaft_word + voxel->table;
    for (uint32_t shaft = 0; shaft < shafts; shaft += 1 + shafts / 64)
    {
        const uint32_t mask = ls_mask_read(table, shaft, width);
        for (uint32_t k = 0; k < 32; ++k)
        {
            if ((mask >> k & 1) != 0)
            {
                walk_references(walk, object, voxel->first_reference + k, 1);
                assert_true(k < voxel->reference_count);
            }
        }
    }
}

static void walk_block(Walk* walk, const LsObject* object, uint32_t block, uint32_t level);

static void walk_voxel(Walk* walk, const LsObject* object, uint32_t index, uint32_t block,
                       uint32_t level)
{
    const LsVoxel* voxel = &walk->file->voxels[object->first_voxel + index];
    switch (voxel->shape & 255)
    {
    case LS_VOXEL_LIST:
        walk_references(walk, object, voxel->first_reference, voxel->reference_count);
        break;
    case LS_VOXEL_MASKS:
        walk_masks(walk, object, voxel);
        break;
    case LS_VOXEL_BVH:
        walk_leaf_bvh(walk, object, voxel, false);
        walk_leaf_bvh(walk, object, voxel, true);
        break;
    default:
    {
        const uint32_t subgrid = voxel->table - (object->cell_block_count - object->subgrid_count);
        assert_int_equal(walk->file->subgrids[object->first_subgrid + subgrid], block);
        walk_block(walk, object, voxel->table, level + 1);
    }
    }
}

static void walk_block(Walk* walk, const LsObject* object, uint32_t block, uint32_t level)
{
    assert_in_range(level, 0, object->depth);
    const uint32_t* cells = walk->file->cell_blocks[object->first_cell_block + block].cells;
    for (uint32_t i = 0; i < LS_BLOCK_CELLS; ++i)
    {
        take(walk, &cells[i], sizeof(cells[i]));
        if ((cells[i] & 15) == 0)
        {
            walk_voxel(walk, object, cells[i] >> 4, block, level);
        }
    }
}

static void walk_object(Walk* walk, const LsObject* object)
{
    const size_t patches = object->scene_patches;
    if (patches > 0)
    {
        take(walk, walk->file->shafts + object->first_shaft_word,
             LS_SHAFT_COUNT(patches) * sizeof(uint32_t));
    }
    for (uint32_t i = 0; i < object->triangle_count; ++i)
    {
        walk_triangle(walk, object, i);
    }
    for (uint32_t i = 0; i < object->block_count; ++i)
    {
        const uint32_t word = walk->file->blocks[object->first_block + i];
        take(walk, &word, sizeof(word));
        if ((word & 15) == 0)
        {
            walk_block(walk, object, word >> 4, 0);
        }
    }
}

static void walk_instance(Walk* walk, uint32_t index)
{
    const LsInstance* instance = &walk->file->instances[index];
    take(walk, instance, sizeof(*instance));
    take(walk, &walk->file->objects[instance->object], sizeof(LsObject));
    for (uint32_t node = instance->node; node != LS_NONE; node = walk->file->nodes[node].parent)
    {
        take(walk, &walk->file->nodes[node], sizeof(LsSceneNode));
    }
}

static void walk_texture(Walk* walk, uint32_t index)
{
    if (index == LS_NONE)
    {
        return;
    }
    const LsTexture* texture = &walk->file->textures[index];
    take(walk, texture, sizeof(*texture));
    const LsImage* image = &walk->file->images[texture->image];
    take(walk, image, sizeof(*image));
    for (uint32_t y = 0; y < image->height; ++y)
    {
        take(walk, walk->file->pixels + image->first_pixel + (size_t)y * image->width,
             image->width * sizeof(uint32_t));
    }
}

static void walk_surfaces(Walk* walk)
{
    for (uint32_t i = 0; i < ls_file_count(walk->file, LS_CHUNK_MATERIALS); ++i)
    {
        const uint32_t number = walk->file->materials[i].surface;
        if (number == 0)
        {
            continue;
        }
        const LsSurface* surface = &walk->file->surfaces[number - 1];
        take(walk, surface, sizeof(*surface));
        walk_texture(walk, surface->base_color_texture);
        walk_texture(walk, surface->metallic_roughness_texture);
        walk_texture(walk, surface->normal_texture);
        walk_texture(walk, surface->emissive_texture);
        walk_texture(walk, surface->transmission_texture);
    }
}

static void walk_attributes(Walk* walk)
{
    const LsFile* file = walk->file;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_ATTRIBUTES); ++i)
    {
        const LsAttributes* attributes = &file->attributes[i];
        const size_t corners = 3 * (size_t)file->objects[i].triangle_count;
        if (attributes->first_normal != LS_NONE)
        {
            take(walk, file->normals + attributes->first_normal, corners * sizeof(uint32_t));
        }
        for (int set = 0; set < 2; ++set)
        {
            const uint32_t first = attributes->first_texcoord[set];
            if (first != LS_NONE)
            {
                take(walk, file->texcoords + first, corners * sizeof(LsTexcoord));
            }
        }
        if (attributes->first_color != LS_NONE)
        {
            take(walk, file->colors + attributes->first_color, corners * sizeof(LsCornerColor));
        }
    }
}

static void walk_animations(Walk* walk)
{
    const LsFile* file = walk->file;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_ANIMATIONS); ++i)
    {
        const LsAnimation* animation = &file->animations[i];
        for (uint32_t k = 0; k < animation->channel_count; ++k)
        {
            const LsChannel* channel = &file->channels[animation->first_channel + k];
            const size_t size = (channel->path == LS_PATH_ROTATION ? 4 : 3) *
                                (channel->interpolation == LS_INTERPOLATION_CUBIC ? 3 : 1);
            take(walk, &file->nodes[channel->node], sizeof(LsSceneNode));
            take(walk, file->keys + channel->first_time, channel->key_count * sizeof(float));
            take(walk, file->keys + channel->first_value,
                 channel->key_count * size * sizeof(float));
        }
    }
}

static void walk_file(Walk* walk)
{
    const LsFile* file = walk->file;
    walk_surfaces(walk);
    walk_attributes(walk);
    walk_animations(walk);
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_LAMPS); ++i)
    {
        take(walk, &file->lamps[i], sizeof(LsLamp));
        if (file->lamps[i].node != LS_NONE)
        {
            take(walk, &file->nodes[file->lamps[i].node], sizeof(LsSceneNode));
        }
    }
    const uint32_t node_count = ls_file_count(file, LS_CHUNK_TOP_NODES);
    for (uint32_t i = 0; i < node_count;)
    {
        const LsBvhNode* node = &file->top_nodes[i];
        take(walk, node, sizeof(*node));
        if (node->leaf != 0)
        {
            walk_instance(walk, node->leaf >> 4);
        }
        i = node->leaf != 0 ? node->escape : i + 1;
    }
    for (uint32_t i = 0; i < node_count; i = file->top_nodes[i].escape)
    {
        take(walk, &file->top_nodes[i], sizeof(LsBvhNode));
    }
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_OBJECTS); ++i)
    {
        walk_object(walk, &file->objects[i]);
    }
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_LIGHTS); ++i)
    {
        const LsLight* light = &file->lights[i];
        const LsObject* object = &file->objects[file->instances[light->instance].object];
        walk_triangle(walk, object, light->triangle);
    }
}

// ---- Garbage ------------------------------------------------------------------------------------

// A word as mistakes and malice make it: an extreme, a neighbour of the old one, one from
// elsewhere.
static uint32_t make_word(const LsFixtureBytes* bytes, uint32_t old, uint64_t* state)
{
    static const uint32_t extremes[] = {0,          1,          15,         16,
                                        UINT32_MAX, 0x7FFFFFFF, 0x80000000, 0xFFFFFFF0,
                                        0x7FC00000, 0x7F800000, 0x3F800000, 0x11111111};
    const uint64_t random = ls_random_next(state);
    switch (random % 6)
    {
    case 0:
        return extremes[random / 8 % (sizeof(extremes) / sizeof(extremes[0]))];
    case 1:
        return old + 1;
    case 2:
        return old - 1;
    case 3:
        return old ^ 1u << random / 8 % 32;
    case 4:
    {
        uint32_t word;
        memcpy(&word, bytes->bytes + random / 8 % (bytes->size / 4) * 4, sizeof(word));
        return word;
    }
    default:
        return (uint32_t)(random >> 32);
    }
}

// The place of a word to change: mostly in a chunk, every chunk as often, now and then in what
// leads there.
static uint64_t choose_place(const LsFixtureBytes* legal, uint64_t* state)
{
    const LsEntry* entries = (const LsEntry*)(const void*)(legal->bytes + LS_HEADER_BYTES);
    const uint64_t random = ls_random_next(state);
    if (random % 16 == 0)
    {
        const uint64_t head = LS_HEADER_BYTES + LS_CHUNK_COUNT * LS_ENTRY_BYTES;
        return random / 16 % (head / 4) * 4;
    }
    const LsEntry* entry = &entries[random / 16 % LS_CHUNK_COUNT];
    return entry->offset + (random >> 32) % (entry->stored_bytes / 4) * 4;
}

static void expect_garbage_is_safe(const LsFileDesc* desc)
{
    LsFixtureBytes legal = ls_fixture_bytes(desc);
    // Memory of exactly the file's size, so that a sanitizer sees a read behind its end.
    LsFixtureBytes bytes = {.size = legal.size};
    assert_int_equal(posix_memalign((void**)&bytes.bytes, 4096, legal.size), 0);
    memcpy(bytes.bytes, legal.bytes, legal.size);

    uint64_t random = 0x9E3779B97F4A7C15u;
    uint32_t opened = 0, passed = 0;
    for (uint32_t i = 0; i < CASES; ++i)
    {
        uint64_t places[MAX_EDITS];
        const uint32_t edit_count = 1 + (uint32_t)(ls_random_next(&random) % MAX_EDITS);
        for (uint32_t k = 0; k < edit_count; ++k)
        {
            places[k] = choose_place(&legal, &random);
            uint32_t word;
            memcpy(&word, bytes.bytes + places[k], sizeof(word));
            word = make_word(&legal, word, &random);
            memcpy(bytes.bytes + places[k], &word, sizeof(word));
        }
        ls_fixture_rehash(&bytes);
        LsFile file;
        LsError error;
        if (ls_file_open(&file, bytes.bytes, bytes.size, "garbage", &error) == LS_OK)
        {
            ++opened;
            if (ls_file_check(&file, "garbage", &error) == LS_OK)
            {
                ++passed;
                Walk walk = {.file = &file};
                walk_file(&walk);
                assert_true(walk.sum > 0);
            }
        }
        for (uint32_t k = 0; k < edit_count; ++k)
        {
            memcpy(bytes.bytes + places[k], legal.bytes + places[k], sizeof(uint32_t));
        }
        memcpy(bytes.bytes, legal.bytes, LS_HEADER_BYTES + LS_CHUNK_COUNT * LS_ENTRY_BYTES);
    }
    print_message("%u files: %u opened, %u passed the check\n", CASES, opened, passed);
    assert_in_range(opened, CASES / 2, CASES);
    assert_in_range(passed, CASES / 50, opened);
    free(bytes.bytes);
    ls_fixture_free(&legal);
}

static void test_garbage(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    expect_garbage_is_safe(&fixture.desc);
    LsShaftLayout exact = ls_mask_layout(&fixture.desc, true);
    expect_garbage_is_safe(&exact.desc);
    LsShaftLayout scene = ls_scene_shaft_layout(&exact.desc, 2);
    expect_garbage_is_safe(&scene.desc);
    ls_shaft_layout_destroy(&scene);
    ls_shaft_layout_destroy(&exact);
}

// Random bytes alone, and behind a true magic.
static void test_noise(void** state)
{
    (void)state;
    uint64_t random = 12345;
    LsFixtureBytes bytes = {aligned_alloc(4096, 4096), 4096};
    for (uint32_t i = 0; i < CASES / 10; ++i)
    {
        for (uint32_t k = 0; k < bytes.size / 8; ++k)
        {
            const uint64_t word = ls_random_next(&random);
            memcpy(bytes.bytes + 8 * k, &word, sizeof(word));
        }
        LsFile file;
        assert_int_equal(ls_file_open(&file, bytes.bytes, bytes.size, "noise", NULL),
                         LS_ERROR_NOT_LSPACE);
        memcpy(bytes.bytes, "\xABlspace 01\xBB\r\n\x1A\n", LS_MAGIC_BYTES);
        memset(bytes.bytes + LS_MAGIC_BYTES, 0, i % 64);
        assert_int_not_equal(ls_file_open(&file, bytes.bytes, bytes.size, "noise", NULL), LS_OK);
    }
    ls_fixture_free(&bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_garbage),
        cmocka_unit_test(test_noise),
    };
    return cmocka_run_group_tests_name("garbage", tests, NULL, NULL);
}
