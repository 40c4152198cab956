// test_compose.c - several files in one bake: what may be asked, limits, progress, bundled scenes.

#include "compose_fixture.h"
#include "memory_limit.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Descs --------------------------------------------------------------------------------------

// What only a caller of the library can ask for; lsbake's own table refuses it before.
static void test_wrong_desc(void** state)
{
    (void)state;
    static const struct
    {
        LsBakeInput how;
        LsMessage message;
    } cases[] = {
        {{.path = NULL}, LS_MESSAGE_USAGE_NO_SCENE},
        {{.path = "a.ply", .up = (LsUpAxis)3}, LS_MESSAGE_USAGE_CHOICE},
        {{.path = "a.ply", .scale = -1}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .scale = NAN}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .size = INFINITY}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .turn = NAN}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .is_at = true, .at = {0, NAN, 0}}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .scene = 1}, LS_MESSAGE_USAGE_NOT_GLTF},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        ls_compose_check_refused(&cases[i].how, cases[i].message, "");
    const LsBakeInput good = {.path = "a.ply"};
    const struct
    {
        LsBakeDesc desc;
        LsMessage message;
    } bakes[] = {
        {{.inputs = &good, .input_count = 0, .output = "x"}, LS_MESSAGE_USAGE_NO_SCENE},
        {{.inputs = &good, .input_count = 1}, LS_MESSAGE_USAGE_NO_OUTPUT},
        {{.inputs = &good, .input_count = 1, .output = "x", .grid = 5000}, LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .patches = 17},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good,
          .input_count = 1,
          .output = "x",
          .choose_patches = true,
          .patches = LS_MAX_CHOSEN_PATCHES + 1},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .divide_above = 2},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .byte_price = -1.0},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .byte_price = NAN},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .smooth_angle = NAN},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .normals = (LsNormalSource)9},
         LS_MESSAGE_USAGE_CHOICE},
    };
    for (size_t i = 0; i < sizeof bakes / sizeof *bakes; i++)
    {
        LsError error = {0};
        assert_int_equal(ls_bake_run(&bakes[i].desc, NULL, &error), LS_ERROR_ARGUMENT);
        assert_int_equal(error.message, bakes[i].message);
    }
}

// ---- Limits --------------------------------------------------------------------------------------

static void test_triangle_limit(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    const LsBakeInput inputs[] = {{.path = ls_compose_path("a.ply")},
                                  {.path = ls_compose_path("a.ply")}};
    LsBakeDesc desc = {.inputs = inputs, .input_count = 2, .max_triangles = 4};
    LsInput input = {0};
    LsError error;
    assert_int_equal(ls_compose(&input, &desc, NULL, NULL, &error), LS_OK);
    ls_input_destroy(&input);
    desc.max_triangles = 3;
    ls_compose_check_refused_desc(&desc, LS_MESSAGE_LIMIT_TRIANGLES, "--max-triangles");
    desc.max_triangles = 1;
    ls_compose_check_refused_desc(&desc, LS_MESSAGE_LIMIT_TRIANGLES, "a.ply");
}

static void test_no_triangles(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", "{\"camera\":0}", "");
    ls_compose_write_ply("a.ply");
    const LsBakeInput inputs[] = {{.path = ls_compose_path("a.gltf")},
                                  {.path = ls_compose_path("a.ply")}};
    ls_compose_check_refused(&inputs[0], LS_MESSAGE_SCENE_NO_TRIANGLES, "a.gltf");
    // Beside one that has some it may stand.
    LsInput input = ls_compose_inputs(inputs, 2);
    ls_input_destroy(&input);
}

static void test_memory_limit(void** state)
{
    (void)state;
    LsError error = {0};
    const uint64_t in_use = ls_memory_in_use();
    assert_true(in_use > 0);
    assert_int_equal(ls_memory_check(0, UINT64_MAX, "a", "b", &error), LS_OK);
    assert_int_equal(ls_memory_check(UINT64_MAX, 1, "a", "b", &error), LS_OK);
    assert_int_equal(ls_memory_check(1, 0, "a.ply", "work", &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    assert_non_null(strstr(error.text, "a.ply: work takes"));
    assert_int_equal(ls_memory_check(UINT64_MAX, UINT64_MAX, "a", "b", &error),
                     LS_ERROR_INPUT_LIMIT);

    // What is in use follows what is used.
    const size_t bytes = 64u << 20;
    char* memory = malloc(bytes);
    assert_non_null(memory);
    memset(memory, 1, bytes);
    assert_true(ls_memory_in_use() >= in_use + bytes / 2);
    free(memory);

    const LsGridFrame frame = {.cells = {4096, 4096, 5}};
    assert_int_equal(ls_grid_need(&frame, 10), 1024 * 1024 * 2 * 4 + 10 * 52);
    LsWorkVoxel voxels[] = {{.kind = LS_VOXEL_MASKS, .reference_count = 9},
                            {.kind = LS_VOXEL_LIST, .reference_count = 9},
                            {.kind = LS_VOXEL_MASKS, .reference_count = 32}};
    const LsBakedObject object = {.voxels = {.voxels = voxels, .voxel_count = 3}};
    // 240 masks of 9 bits take 67.5 words.
    const LsPatchesChoice fixed = {.patches = 2}, chosen = {.patches = 2, .chosen = true};
    const uint64_t working = ls_tables_work_bytes(&fixed);
    assert_true(working > 4 * 240);
    assert_int_equal(ls_tables_work_bytes(&chosen), working + 2 * 4 * 240);
    assert_int_equal(ls_tables_need(&object, 1, &fixed, 0),
                     4 * (68 + 240) * 33 / 16 + 3 * 16); // to pack
    assert_int_equal(ls_tables_need(&object, 1, &fixed, 2), 4 * (68 + 240) + 2 * working);
    assert_int_equal(ls_tables_need(&object, 1, &chosen, 2),
                     2 * (working + 2 * 4 * 240 + 4 * (68 + 240)));
    LsTableBlock blocks[] = {{.word_count = 68}, {.word_count = 252}};
    const LsBakedObject made = {.voxels = {.voxel_count = 300},
                                .tables = {.blocks = blocks, .block_count = 2}};
    assert_int_equal(ls_pack_need(&made, 1), 300 * 16 + 4 * (68 + 252) / 16 + 4 * 252);
    LsInputMesh meshes[] = {{.triangle_count = 7}, {.triangle_count = 100}};
    const LsInput input = {.meshes = meshes, .mesh_count = 2};
    assert_int_equal(ls_mesh_need(&input), 100 * (48 + 12 + 1));
}

// Before a stage begins that is known not to fit; nothing is left at the output's name.
static void test_bake_within_memory(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    char output[256];
    snprintf(output, sizeof output, "%s", ls_compose_path("out.lspace"));
    const LsBakeInput how = {.path = ls_compose_path("a.ply")};
    const LsBakeInput bunny = {.path = LS_SOURCE_DIR "/scenes/bunny.ply"};
    LsBakeDesc desc = {.inputs = &how, .input_count = 1, .output = output, .max_memory = 1000};
    LsError error = {0};
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    assert_int_equal(access(output, F_OK), -1);
    // Tables of 15 * 16^4 shafts for each of thousands of voxels.
    desc.inputs = &bunny;
    desc.patches = 16;
    desc.max_memory = 4ull << 30;
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    assert_non_null(strstr(error.text, "the table of shafts"));
    assert_int_equal(access(output, F_OK), -1);
    desc.inputs = &how;
    desc.patches = 0;
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_OK);
    assert_int_equal(access(output, F_OK), 0);
}

// Whatever is done to an input, the file is another, and up to date when it is done again.
static void test_bake_knows_its_inputs(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    char output[256], path[256];
    snprintf(output, sizeof output, "%s", ls_compose_path("out.lspace"));
    snprintf(path, sizeof path, "%s", ls_compose_path("a.gltf"));
    const LsBakeInput ways[] = {{.path = path},
                                {.path = path, .up = LS_UP_X},
                                {.path = path, .scale = 2},
                                {.path = path, .flip = true},
                                {.path = path, .size = 2},
                                {.path = path, .turn = 5},
                                {.path = path, .is_at = true},
                                {.path = path, .materials = "{\"roughnessFactor\":0.5}"}};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
    {
        const LsBakeDesc desc = {.inputs = &ways[i], .input_count = 1, .output = output};
        LsBakeReport report;
        LsError error = {0};
        assert_int_equal(ls_bake_run(&desc, &report, &error), LS_OK);
        assert_false(report.up_to_date);
        ls_bake_report_destroy(&report);
        assert_int_equal(ls_bake_run(&desc, &report, &error), LS_OK);
        assert_true(report.up_to_date);
        ls_bake_report_destroy(&report);
    }
}

// ---- Bundled scenes -----------------------------------------------------------------------------

static uint32_t count_triangles(const LsInput* input)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < input->mesh_count; i++)
        sum += input->meshes[i].triangle_count;
    return sum;
}

// Positive for a closed mesh whose faces look outward.
static double find_volume(const LsInputMesh* mesh)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        const float* p[3];
        for (int k = 0; k < 3; k++)
            p[k] = mesh->positions + 3 * mesh->indices[3 * i + (uint32_t)k];
        for (int axis = 0; axis < 3; axis++)
        {
            const int j = (axis + 1) % 3, k = (axis + 2) % 3;
            sum += p[0][axis] * ((double)p[1][j] * p[2][k] - (double)p[1][k] * p[2][j]) / 6.0;
        }
    }
    return sum;
}

static void test_bundled_scenes(void** state)
{
    (void)state;
    LsInput box =
        ls_compose_inputs(&(LsBakeInput){.path = LS_SOURCE_DIR "/scenes/cornell.gltf"}, 1);
    LsInput blocks =
        ls_compose_inputs(&(LsBakeInput){.path = LS_SOURCE_DIR "/scenes/cornell_blocks.gltf"}, 1);
    assert_int_equal(count_triangles(&box), 12);
    assert_int_equal(count_triangles(&blocks), 36);
    // The box is the same, and the blocks stand in it and on its floor.
    for (uint32_t i = 0; i < 2; i++)
        assert_memory_equal(blocks.meshes[i].positions, box.meshes[i].positions,
                            box.meshes[i].vertex_count * 3 * sizeof(float));
    assert_int_equal(blocks.mesh_count, 4);
    static const double volumes[] = {0.6 * 0.6 * 0.6, 0.6 * 0.6 * 1.2};
    for (uint32_t i = 0; i < 2; i++)
    {
        const LsInputMesh* block = &blocks.meshes[2 + i];
        ls_compose_check_close((const double[]){find_volume(block)}, &volumes[i], 1, 1e-6);
        for (uint32_t k = 0; k < 3 * block->vertex_count; k++)
            assert_true(fabsf(block->positions[k]) <= 1.0f);
    }
    const LsMaterial* mirror = &blocks.materials[blocks.meshes[3].materials[0]].core;
    assert_true(mirror->metallic == 1.0f && mirror->roughness == 0.0f);
    assert_true(blocks.materials[blocks.meshes[2].materials[0]].core.metallic == 0.0f);
    assert_int_equal(blocks.camera_count, 1);

    const LsBakeInput inputs[] = {{.path = LS_SOURCE_DIR "/scenes/stage.gltf"},
                                  {.path = LS_SOURCE_DIR "/scenes/bunny.ply",
                                   .materials = LS_SOURCE_DIR "/scenes/glossy.json"}};
    LsInput stage = ls_compose_inputs(inputs, 2);
    assert_int_equal(count_triangles(&stage), 8 + 69666);
    assert_int_equal(stage.camera_count, 1);
    uint32_t lights = 0;
    for (uint32_t i = 0; i < 2; i++)
        for (uint32_t k = 0; k < stage.meshes[i].triangle_count; k++)
            lights +=
                stage.materials[stage.meshes[i].materials[k]].core.flags & LS_MATERIAL_EMISSIVE;
    assert_int_equal(lights, 6); // two triangles each
    const LsInputMaterial* glossy = &stage.materials[stage.meshes[2].materials[0]];
    assert_true(glossy->core.roughness == 0.443f && glossy->surface.ior == 1.925f);
    ls_input_destroy(&box);
    ls_input_destroy(&blocks);
    ls_input_destroy(&stage);
}

// ---- Progress -----------------------------------------------------------------------------------

typedef struct Heard
{
    double last;
    unsigned count;
    bool is_rising;
} Heard;

static void hear(void* user, double fraction)
{
    Heard* heard = user;
    heard->is_rising = heard->is_rising && fraction >= heard->last && fraction <= 1.0;
    heard->last = fraction;
    heard->count++;
}

// The second of two files begins where the first one's share of the bytes ends.
static void test_progress(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    const LsBakeInput inputs[] = {{.path = ls_compose_path("a.ply")},
                                  {.path = ls_compose_path("a.ply")}};
    const LsBakeDesc desc = {.inputs = inputs, .input_count = 2};
    LsInput input = {0};
    LsError error;
    Heard heard = {.is_rising = true};
    assert_int_equal(ls_compose(&input, &desc, hear, &heard, &error), LS_OK);
    assert_true(heard.is_rising && heard.count >= 2 && heard.last >= 0.5);
    ls_input_destroy(&input);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_wrong_desc),         cmocka_unit_test(test_triangle_limit),
        cmocka_unit_test(test_no_triangles),       cmocka_unit_test(test_memory_limit),
        cmocka_unit_test(test_bake_within_memory), cmocka_unit_test(test_bake_knows_its_inputs),
        cmocka_unit_test(test_bundled_scenes),     cmocka_unit_test(test_progress),
    };
    return cmocka_run_group_tests(tests, ls_compose_make_folder, ls_compose_remove_folder);
}
