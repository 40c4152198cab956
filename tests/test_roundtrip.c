// test_roundtrip.c - what is written is read, and written again it has equal bytes (SPEC 2.6);
// every field of every chunk survives at its limits.

#include "baked.h"
#include "file_fixture.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GOLDEN LS_SOURCE_DIR "/tests/golden/format_0_"

static void expect_equal(const LsFixtureBytes* left, const LsFixtureBytes* right)
{
    assert_int_equal(left->size, right->size);
    assert_memory_equal(left->bytes, right->bytes, left->size);
}

static void open_file(LsFile* file, const LsFixtureBytes* bytes)
{
    LsError error = {0};
    const LsResult result = ls_file_open(file, bytes->bytes, bytes->size, "written", &error);
    assert_string_equal(error.text, "");
    assert_int_equal(result, LS_OK);
}

static void expect_legal(const LsFixtureBytes* bytes)
{
    LsFile file;
    open_file(&file, bytes);
    LsError error = {0};
    ls_file_check(&file, "written", &error);
    assert_string_equal(error.text, "");
    ls_file_check_hashes(&file, "written", &error);
    assert_string_equal(error.text, "");
}

// Reads and writes again.
static void expect_round_trip(const LsFixtureBytes* bytes)
{
    LsFile file;
    open_file(&file, bytes);
    const LsFileDesc desc = ls_file_desc(&file);
    assert_int_equal(ls_file_desc_bytes(&desc), bytes->size);
    LsFixtureBytes again = ls_fixture_bytes(&desc);
    expect_equal(&again, bytes);
    ls_fixture_free(&again);
}

// Every array of `desc` stands in the file as it was given.
static void expect_arrays(const LsFixtureBytes* bytes, const LsFileDesc* desc)
{
    LsFile file;
    open_file(&file, bytes);
#define EXPECT_ARRAY(NAME, array, type, code)                                            \
    assert_int_equal(ls_file_count(&file, LS_CHUNK_##NAME), desc->NAME##_count);         \
    if (desc->NAME##_count > 0)                                                          \
    {                                                                                    \
        assert_memory_equal(file.array, desc->array, desc->NAME##_count * sizeof(type)); \
        assert_int_equal((uintptr_t)file.array % 4096, 0);                               \
    }                                                                                    \
    else                                                                                 \
    {                                                                                    \
        assert_null(file.array);                                                         \
    }
    LS_CHUNK_LIST(EXPECT_ARRAY)
#undef EXPECT_ARRAY
    assert_memory_equal(file.header->lower, desc->lower, sizeof(desc->lower));
    assert_memory_equal(file.header->upper, desc->upper, sizeof(desc->upper));
    assert_memory_equal(&file.header->transform_bound, &desc->transform_bound, sizeof(float));
    assert_memory_equal(file.header->source_hash, desc->source_hash, sizeof(desc->source_hash));
}

static void test_fixture(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    expect_legal(&bytes);
    expect_arrays(&bytes, &fixture.desc);
    expect_round_trip(&bytes);
    ls_fixture_free(&bytes);
}

// Each chunk alone left out: what is absent has no entry, and nothing else moves its meaning.
static void test_each_chunk_absent(void** state)
{
    (void)state;
    for (int absent = 0; absent < LS_CHUNK_COUNT; ++absent)
    {
        LsFixture fixture;
        ls_fixture_fill(&fixture);
#define LEAVE_OUT(NAME, array, type, code) \
    if (absent == LS_CHUNK_##NAME)         \
    {                                      \
        fixture.desc.array = NULL;         \
        fixture.desc.NAME##_count = 0;     \
    }
        LS_CHUNK_LIST(LEAVE_OUT)
#undef LEAVE_OUT
        LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
        LsFile file;
        open_file(&file, &bytes);
        assert_int_equal(file.header->chunk_count, LS_CHUNK_COUNT - 1);
        expect_arrays(&bytes, &fixture.desc);
        expect_round_trip(&bytes);
        ls_fixture_free(&bytes);
    }
}

// Every byte of every record takes all kinds of values; reading and writing do not mind what they
// mean.
static void test_any_bytes_survive(void** state)
{
    (void)state;
    uint64_t random = 99;
    for (int round = 0; round < 4; ++round)
    {
        LsFixture fixture;
        ls_fixture_fill(&fixture);
#define FILL_ARRAY(NAME, array, type, code)                                                 \
    for (size_t i = 0; i < sizeof(fixture.array); ++i)                                      \
    {                                                                                       \
        const uint64_t byte = ls_random_next(&random) >> 32;                                \
        ((uint8_t*)fixture.array)[i] = (uint8_t)(round == 0 ? 0 : round == 1 ? 255 : byte); \
    }
        LS_CHUNK_LIST(FILL_ARRAY)
#undef FILL_ARRAY
        for (int i = 0; i < 3; ++i)
        {
            fixture.objects[i].depth = LS_MAX_DEPTH - (uint32_t)i; // the header takes the greatest
        }
        memset(fixture.desc.source_hash, 255, sizeof(fixture.desc.source_hash));
        fixture.desc.transform_bound = FLT_MAX;
        LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
        LsFile file;
        open_file(&file, &bytes);
        assert_int_equal(file.header->depth, LS_MAX_DEPTH);
        expect_arrays(&bytes, &fixture.desc);
        expect_round_trip(&bytes);
        ls_fixture_free(&bytes);
    }
}

// ---- Legal limits -------------------------------------------------------------------------------

static void expect_legal_trip(const LsFileDesc* desc)
{
    LsFixtureBytes bytes = ls_fixture_bytes(desc);
    expect_legal(&bytes);
    expect_arrays(&bytes, desc);
    expect_round_trip(&bytes);
    ls_fixture_free(&bytes);
}

static void test_scene_limits(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    for (int axis = 0; axis < 3; ++axis)
    {
        fixture.desc.lower[axis] = -FLT_MAX;
        fixture.desc.upper[axis] = FLT_MAX;
    }
    fixture.desc.transform_bound = FLT_MAX;
    LsObject* list = &fixture.objects[0];
    list->lower = (LsVec3){-FLT_MAX, -FLT_MAX, -FLT_MAX};
    list->upper = (LsVec3){FLT_MAX, FLT_MAX, FLT_MAX};
    list->reach = FLT_MAX;
    list->face_count = UINT32_MAX;
    fixture.triangles[0].v0 = (LsVec3){-FLT_MAX, FLT_MAX, FLT_TRUE_MIN};
    fixture.triangles[0].v1 = (LsVec3){-0.0f, -FLT_TRUE_MIN, FLT_MIN};
    fixture.triangles[0].primitive = UINT32_MAX - 1;
    LsInstance* instance = &fixture.instances[1];
    instance->object_from_world[0] = (LsVec4){FLT_MAX, -FLT_MAX, FLT_TRUE_MIN, -0.0f};
    instance->world_from_object[2] = (LsVec4){-0.0f, FLT_MAX, -FLT_MAX, FLT_TRUE_MIN};
    instance->mask = 0;
    instance->node = LS_NONE;
    instance->flags = LS_INSTANCE_MIRRORED;
    fixture.instances[0].flags = LS_INSTANCE_IDENTITY | LS_INSTANCE_MIRRORED;
    fixture.top_nodes[0].lower = list->lower;
    fixture.top_nodes[0].upper = list->upper;
    fixture.nodes[2].parent_from_node[1] = (LsVec4){FLT_MAX, -FLT_MAX, -0.0f, FLT_TRUE_MIN};
    fixture.materials[0].base_color = (LsVec3){0, -0.0f, 1};
    fixture.materials[0].metallic = 1;
    fixture.materials[1].emission = (LsVec3){FLT_TRUE_MIN, 0, FLT_MAX};
    fixture.lights[0].area = FLT_MAX;
    fixture.lights[0].cumulative = FLT_TRUE_MIN;
    fixture.lights[1].area = FLT_TRUE_MIN;
    fixture.cameras[0].tan_half_y = FLT_TRUE_MIN;
    fixture.cameras[0].aspect = 0;
    expect_legal_trip(&fixture.desc);
    fixture.materials[0].surface = 1;
    fixture.cameras[0].tan_half_y = FLT_MAX;
    fixture.cameras[0].aspect = FLT_MAX;
    fixture.lights[0].cumulative = 1;
    expect_legal_trip(&fixture.desc);
}

static void test_looks_limits(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsSurface* surface = &fixture.surfaces[0];
    surface->transmission = 1;
    surface->ior = 0; // infinite
    surface->alpha = -0.0f;
    surface->alpha_cutoff = FLT_MAX;
    surface->normal_scale = -FLT_MAX;
    surface->transmission_texture = 1;
    fixture.textures[0].row_u = (LsVec4){FLT_MAX, -FLT_MAX, FLT_TRUE_MIN, -0.0f};
    fixture.textures[0].flags = LS_TEXTURE_MIRROR_U | LS_TEXTURE_CLAMP_V | LS_TEXTURE_NEAREST;
    fixture.normals[0] = 0x7FFF8001;
    fixture.normals[1] = 0x80017FFF;
    fixture.texcoords[0] = (LsTexcoord){FLT_MAX, -FLT_MAX};
    fixture.colors[0] = (LsCornerColor){UINT32_MAX, 0x80008000};
    fixture.lamps[0].position = (LsVec3){FLT_MAX, -FLT_MAX, FLT_TRUE_MIN};
    fixture.lamps[0].direction = (LsVec3){-0.0f, 0, -1};
    fixture.lamps[0].range = FLT_MAX;
    fixture.lamps[0].intensity = (LsVec3){FLT_MAX, 0, FLT_TRUE_MIN};
    fixture.lamps[1].direction = (LsVec3){0, 0x1.001p0f, 0};
    fixture.lamps[1].cos_inner = fixture.lamps[1].cos_outer = 1;
    fixture.lamps[2].position = (LsVec3){-0.0f, 0, 0};
    expect_legal_trip(&fixture.desc);
    surface->ior = 1;
    fixture.lamps[1].direction = (LsVec3){0, 0, 0x1.fffp-1f};
    fixture.lamps[1].cos_inner = fixture.lamps[1].cos_outer = -1;
    expect_legal_trip(&fixture.desc);
    surface->ior = FLT_MAX;
    // The largest image behind a small one.
    const uint32_t side = LS_MAX_IMAGE_SIDE;
    uint32_t* pixels = calloc(2 + side * (size_t)side, sizeof(uint32_t));
    assert_non_null(pixels);
    fixture.images[1].width = fixture.images[1].height = side;
    fixture.desc.pixels = pixels;
    fixture.desc.PIXELS_count = 2 + side * side;
    LsError error = {0};
    assert_int_equal(ls_file_desc_check(&fixture.desc, "largest", &error), LS_OK);
    --fixture.desc.PIXELS_count;
    assert_int_equal(ls_file_desc_check(&fixture.desc, "cut", &error), LS_ERROR_RULE);
    free(pixels);
}

static void test_animation_limits(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    fixture.keys[1] = FLT_TRUE_MIN;
    fixture.keys[2] = FLT_MAX;
    fixture.keys[3] = -FLT_MAX;
    fixture.animations[0].duration = FLT_MAX;
    fixture.keys[12] = 0x1p-6f; // adds 2^-12 to a squared length
    fixture.keys[53] = FLT_MAX;
    expect_legal_trip(&fixture.desc);
    fixture.keys[12] = 0x1p-5f; // 2^-10: no more
    expect_legal_trip(&fixture.desc);
    // A cubic rotation: its tangents may be anything.
    float keys[64];
    memcpy(keys, fixture.keys, sizeof(fixture.keys));
    const float rotation[13] = {7, 9, 9, 9, 9, 0, 1, 0, 0, -9, -9, -9, -9};
    const float grow[3] = {1, 1, 1};
    memcpy(keys + 48, rotation, sizeof(rotation));
    memcpy(keys + 61, grow, sizeof(grow));
    fixture.channels[4].interpolation = LS_INTERPOLATION_CUBIC;
    fixture.channels[5].first_value = 61;
    fixture.animations[1].duration = 7;
    fixture.desc.keys = keys;
    fixture.desc.KEYS_count = 64;
    expect_legal_trip(&fixture.desc);
    keys[54] = 2;
    LsError error = {0};
    assert_int_equal(ls_file_desc_check(&fixture.desc, "long", &error), LS_ERROR_RULE);
    assert_non_null(strstr(error.text, "R4.21: KEYS record 53"));
}

// Corners without normals, colours alone, a set of texture coordinates alone: each without the others.
static void test_attributes_apart(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    const LsFileDesc whole = fixture.desc;
    for (int kind = 0; kind < 4; ++kind)
    {
        for (uint32_t i = 0; i < 3; ++i)
        {
            fixture.attributes[i] = (LsAttributes){LS_NONE, {LS_NONE, LS_NONE}, LS_NONE};
        }
        LsAttributes* own = &fixture.attributes[0];
        uint32_t* const places[4] = {&own->first_normal, &own->first_texcoord[0],
                                     &own->first_texcoord[1], &own->first_color};
        *places[kind] = 0;
        fixture.desc = whole;
        fixture.desc.NORMALS_count = kind == 0 ? 6 : 0;
        fixture.desc.TEXCOORDS_count = kind == 1 || kind == 2 ? 6 : 0;
        fixture.desc.COLORS_count = kind == 3 ? 6 : 0;
        expect_legal_trip(&fixture.desc);
    }
}

// The longest grid, and the greatest bound that is legal in it.
static void test_grid_limits(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    uint32_t blocks[4 + LS_MAX_CELLS / LS_BLOCK_SIDE];
    memcpy(blocks, fixture.blocks, sizeof(fixture.blocks));
    for (uint32_t i = 4; i < 4 + LS_MAX_CELLS / LS_BLOCK_SIDE; ++i)
    {
        blocks[i] = 0xFFFFFFFF;
    }
    blocks[4 + LS_MAX_CELLS / LS_BLOCK_SIDE - 1] = 0 << 4;
    LsObject* grid = &fixture.objects[2];
    grid->cells[1] = LS_MAX_CELLS;
    grid->block_count = LS_MAX_CELLS / LS_BLOCK_SIDE;
    grid->bound = 0x1.fffffep-3f;
    grid->inverse_cell = FLT_TRUE_MIN;
    grid->patches = LS_MAX_PATCHES;
    fixture.desc.blocks = blocks;
    fixture.desc.BLOCKS_count = sizeof(blocks) / sizeof(blocks[0]);
    expect_legal_trip(&fixture.desc);
    grid->inverse_cell = FLT_MAX;
    grid->grid_lower = (LsVec3){FLT_MAX, -FLT_MAX, FLT_TRUE_MIN};
    grid->bound = FLT_TRUE_MIN;
    expect_legal_trip(&fixture.desc);
}

// An object alone with as many sub-grids in each other as is legal, and a voxel at the end of them.
static void test_depth_limit(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsCellBlock cell_blocks[1 + LS_MAX_DEPTH];
    uint32_t subgrids[LS_MAX_DEPTH];
    LsVoxel voxels[1 + LS_MAX_DEPTH];
    memset(cell_blocks, 0x11, sizeof(cell_blocks));
    for (uint32_t i = 0; i <= LS_MAX_DEPTH; ++i)
    {
        cell_blocks[i].cells[i == 0 ? 0 : 63] = i << 4;
        voxels[i] = (LsVoxel){.shape = LS_VOXEL_SUBGRID, .table = i + 1};
        subgrids[i % LS_MAX_DEPTH] = i % LS_MAX_DEPTH;
    }
    voxels[LS_MAX_DEPTH] = fixture.voxels[12];
    LsFileDesc desc = fixture.desc;
    LsObject object = fixture.objects[2];
    object.first_triangle = object.first_block = object.first_cell_block = 0;
    object.first_subgrid = object.first_voxel = object.first_reference = 0;
    object.first_leaf_node = object.first_shaft_word = 0;
    object.cell_block_count = object.voxel_count = 1 + LS_MAX_DEPTH;
    object.subgrid_count = object.depth = LS_MAX_DEPTH;
    object.bound = 0x1.fffffep-19f;
    desc.objects = &object;
    desc.OBJECTS_count = desc.INSTANCES_count = desc.TRIANGLES_count = 1;
    desc.BLOCKS_count = desc.REFERENCES_count = 1;
    desc.cell_blocks = cell_blocks;
    desc.CELL_BLOCKS_count = 1 + LS_MAX_DEPTH;
    desc.subgrids = subgrids;
    desc.SUBGRIDS_count = LS_MAX_DEPTH;
    desc.voxels = voxels;
    desc.VOXELS_count = 1 + LS_MAX_DEPTH;
    desc.TOP_NODES_count = desc.LIGHTS_count = desc.LEAF_NODES_count = desc.SHAFTS_count = 0;
    desc.ATTRIBUTES_count = desc.NORMALS_count = desc.TEXCOORDS_count = desc.COLORS_count = 0;
    expect_legal_trip(&desc);
}

// The largest table there is; five of them make a chunk of the larger alignment.
static void test_largest_tables(void** state)
{
    (void)state;
    enum
    {
        TABLES = 5,
        WORDS = 15 * 16 * 16 * 16 * 16
    };
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsObject* grid = &fixture.objects[2];
    LsVoxel voxels[LS_FIXTURE_VOXELS + TABLES];
    uint32_t references[LS_FIXTURE_REFERENCES + TABLES];
    memcpy(voxels, fixture.voxels, sizeof(fixture.voxels));
    memcpy(references, fixture.references, sizeof(fixture.references));
    for (uint32_t i = 0; i < TABLES; ++i)
    {
        const uint32_t shape = LS_VOXEL_MASKS | LS_MAX_PATCHES << 8 | 5 << 16;
        voxels[LS_FIXTURE_VOXELS + i] = (LsVoxel){1 + i, 1, shape, i * WORDS};
        references[LS_FIXTURE_REFERENCES + i] = 0;
        fixture.cell_blocks[5].cells[1 + i / 3 * 4 + i % 3] = (1 + i) << 4;
    }
    grid->cells[0] = grid->cells[1] = grid->cells[2] = 4;
    grid->voxel_count += TABLES;
    grid->reference_count += TABLES;
    grid->shaft_word_count = TABLES * WORDS;
    uint32_t* shafts = calloc(LS_FIXTURE_SHAFT_WORDS + TABLES * WORDS, sizeof(uint32_t));
    assert_non_null(shafts);
    memcpy(shafts, fixture.shafts, sizeof(fixture.shafts));
    shafts[LS_FIXTURE_SHAFT_WORDS + TABLES * WORDS - 1] = 1;
    LsFileDesc desc = fixture.desc;
    desc.voxels = voxels;
    desc.VOXELS_count += TABLES;
    desc.references = references;
    desc.REFERENCES_count += TABLES;
    desc.shafts = shafts;
    desc.SHAFTS_count += TABLES * WORDS;
    LsFixtureBytes bytes = ls_fixture_bytes(&desc);
    LsFile file;
    open_file(&file, &bytes);
    assert_int_equal(file.chunk_entries[LS_CHUNK_SHAFTS]->offset % LS_LARGE_CHUNK_ALIGNMENT, 0);
    assert_true(file.chunk_entries[LS_CHUNK_SHAFTS]->stored_bytes >= LS_LARGE_CHUNK_BYTES);
    ls_fixture_free(&bytes);
    expect_legal_trip(&desc);
    free(shafts);
}

// ---- Golden file --------------------------------------------------------------------------------

static void expect_version(const LsFixtureBytes* bytes, uint32_t minor, uint32_t reader_minor)
{
    LsFile file;
    open_file(&file, bytes);
    assert_int_equal(file.header->version_major, 0);
    assert_int_equal(file.header->version_minor, minor);
    assert_int_equal(file.header->reader_minor, reader_minor);
}

// The scene of a golden file, written today, has its bytes.
static void expect_golden(const char* path, const LsFileDesc* desc, uint32_t minor)
{
    LsFixtureBytes golden = ls_fixture_read(path);
    expect_legal(&golden);
    expect_version(&golden, minor, minor);
    expect_round_trip(&golden);
    LsFixtureBytes bytes = ls_fixture_bytes(desc);
    expect_equal(&bytes, &golden);
    ls_fixture_free(&bytes);
    ls_fixture_free(&golden);
}

// Leaves out what 0.2 added.
static void strip_fixture(LsFixture* fixture)
{
    fixture->materials[1].surface = 0;
#define STRIP_CHUNK(NAME, array, type, code) \
    fixture->desc.NAME##_count =             \
        LS_CHUNK_##NAME >= LS_CHUNK_SURFACES ? 0 : fixture->desc.NAME##_count;
    LS_CHUNK_LIST(STRIP_CHUNK)
#undef STRIP_CHUNK
}

// Each written once by the first writer of its version, and kept.
static void test_golden_files(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsShaftLayout exact = ls_mask_layout(&fixture.desc, true);
    LsShaftLayout scene = ls_scene_shaft_layout(&exact.desc, 2);
    expect_golden(GOLDEN "4.lspace", &scene.desc, 4);
    ls_shaft_layout_destroy(&scene);
    expect_golden(GOLDEN "3.lspace", &exact.desc, 3);
    ls_shaft_layout_destroy(&exact);
    expect_golden(GOLDEN "2.lspace", &fixture.desc, 2);
    strip_fixture(&fixture);
    expect_golden(GOLDEN "1.lspace", &fixture.desc, 1);
}

// What readers of 0.1 can skip does not keep them out; masks of exact width and scene shafts do.
static void test_versions(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    const LsFileDesc whole = fixture.desc;
    strip_fixture(&fixture);
    const LsFileDesc plain = fixture.desc;
    LsFileDesc descs[3] = {plain, plain, plain};
    descs[0].LAMPS_count = whole.LAMPS_count;
    descs[1].ANIMATIONS_count = whole.ANIMATIONS_count;
    descs[1].CHANNELS_count = whole.CHANNELS_count;
    descs[1].KEYS_count = whole.KEYS_count;
    descs[2].ATTRIBUTES_count = whole.ATTRIBUTES_count;
    descs[2].NORMALS_count = whole.NORMALS_count;
    descs[2].TEXCOORDS_count = whole.TEXCOORDS_count;
    descs[2].COLORS_count = whole.COLORS_count;
    for (int i = 0; i < 3; ++i)
    {
        LsFixtureBytes bytes = ls_fixture_bytes(&descs[i]);
        expect_version(&bytes, 2, 1);
        ls_fixture_free(&bytes);
        expect_legal_trip(&descs[i]);
    }
    LsShaftLayout exact = ls_mask_layout(&plain, true);
    LsFixtureBytes bytes = ls_fixture_bytes(&exact.desc);
    expect_version(&bytes, 3, 3);
    ls_fixture_free(&bytes);
    expect_legal_trip(&exact.desc);
    ls_shaft_layout_destroy(&exact);
    LsShaftLayout scene = ls_scene_shaft_layout(&plain, 3);
    bytes = ls_fixture_bytes(&scene.desc);
    expect_version(&bytes, 4, 4);
    ls_fixture_free(&bytes);
    expect_legal_trip(&scene.desc);
    ls_shaft_layout_destroy(&scene);
}

// The most scene shafts there are, of a grid without tables: the file has no masks then.
static void test_most_scene_shafts(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    for (uint32_t i = 0; i < LS_FIXTURE_VOXELS; ++i)
    {
        LsVoxel* voxel = &fixture.voxels[i];
        if ((voxel->shape & 255) == LS_VOXEL_MASKS)
        {
            voxel->shape = LS_VOXEL_LIST;
            voxel->table = 0;
        }
    }
    fixture.objects[1].shaft_word_count = fixture.objects[2].first_shaft_word = 0;
    fixture.desc.SHAFTS_count = 0;
    LsShaftLayout scene = ls_scene_shaft_layout(&fixture.desc, LS_MAX_SCENE_PATCHES);
    LsFixtureBytes bytes = ls_fixture_bytes(&scene.desc);
    LsFile file;
    open_file(&file, &bytes);
    assert_int_equal(file.header->required_features & LS_FEATURE_SCENE_SHAFTS,
                     LS_FEATURE_SCENE_SHAFTS);
    assert_int_equal(file.header->required_features & LS_FEATURE_MASKS, 0);
    ls_fixture_free(&bytes);
    expect_legal_trip(&scene.desc);
    ls_shaft_layout_destroy(&scene);
}

// ---- Baked files --------------------------------------------------------------------------------

typedef struct LsBakedCase
{
    LsTestMeshId mesh;
    LsTestPlacement placement;
    uint32_t grid, patches;
} LsBakedCase;

// Every kind of voxel and object, alone and under a top level.
static const LsBakedCase BAKED_CASES[] = {
    {LS_TEST_MESH_TEAPOT, LS_TEST_INSTANCES, 0, 0}, {LS_TEST_MESH_ELEPHANT, LS_TEST_ALONE, 20, 5},
    {LS_TEST_MESH_STADIUM, LS_TEST_ALONE, 9, 3},    {LS_TEST_MESH_HUB, LS_TEST_INSTANCES, 8, 2},
    {LS_TEST_MESH_SLIVERS, LS_TEST_ALONE, 13, 2},   {LS_TEST_MESH_FLAT, LS_TEST_INSTANCES, 20, 1},
    {LS_TEST_MESH_ONE, LS_TEST_ALONE, 0, 0},
};
#define BAKED_CASE_COUNT (sizeof(BAKED_CASES) / sizeof(BAKED_CASES[0]))

static uint64_t kind_count[4], list_object_count;

// Opening a baked file checks it by every rule.
static void bake_and_write_again(void** state)
{
    const LsBakedCase* c = *state;
    LsTestMesh mesh = ls_test_mesh_make(c->mesh);
    LsBaked baked;
    ls_baked_open(&baked, &mesh, ls_test_mesh_name(c->mesh), c->placement, c->grid, c->patches, 0);
    LsFixtureBytes bytes = ls_fixture_read(baked.path);
    assert_int_equal(bytes.size, baked.report.file_bytes);
    expect_round_trip(&bytes);
    for (int kind = 0; kind < 4; ++kind)
    {
        kind_count[kind] += baked.report.voxel_kind_count[kind];
    }
    list_object_count += baked.report.list_object_count;
    ls_fixture_free(&bytes);
    ls_baked_close(&baked);
    ls_test_mesh_destroy(&mesh);
}

static void baked_files_hold_every_kind(void** state)
{
    (void)state;
    for (int kind = 0; kind < 4; ++kind)
    {
        assert_true(kind_count[kind] > 0);
    }
    assert_true(list_object_count > 0);
}

static int run_baked_group(void)
{
    struct CMUnitTest tests[BAKED_CASE_COUNT + 1];
    for (size_t i = 0; i < BAKED_CASE_COUNT; ++i)
    {
        tests[i] = (struct CMUnitTest){.name = ls_test_mesh_name(BAKED_CASES[i].mesh),
                                       .test_func = bake_and_write_again,
                                       .initial_state = (void*)&BAKED_CASES[i]};
    }
    tests[BAKED_CASE_COUNT] = (struct CMUnitTest)cmocka_unit_test(baked_files_hold_every_kind);
    return cmocka_run_group_tests_name("roundtrip of baked files", tests, NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fixture),           cmocka_unit_test(test_each_chunk_absent),
        cmocka_unit_test(test_any_bytes_survive), cmocka_unit_test(test_scene_limits),
        cmocka_unit_test(test_grid_limits),       cmocka_unit_test(test_depth_limit),
        cmocka_unit_test(test_largest_tables),    cmocka_unit_test(test_golden_files),
        cmocka_unit_test(test_looks_limits),      cmocka_unit_test(test_animation_limits),
        cmocka_unit_test(test_attributes_apart),  cmocka_unit_test(test_versions),
        cmocka_unit_test(test_most_scene_shafts),
    };
    const int failed = cmocka_run_group_tests_name("roundtrip", tests, NULL, NULL);
    return failed + run_baked_group();
}
