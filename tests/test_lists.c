// test_lists.c - scenes of one grid among lists, as rooms have walls and lights: in two passes and
// in one, the answers are those of brute force. Lists of odd and even counts, of one triangle and
// of as many as there can be, as they lie and turned and stretched, far from the origin of their
// own space, one inside another.

#include "baked.h"
#include "gpu.h"
#include "ray_sets.h"
#include "test_random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define RAYS 12000u
#define FOLDER LS_BINARY_DIR "/test_scenes"

static LsGpu gpu;

static int open_device(void** state)
{
    (void)state;
    ls_gpu_open(&gpu);
    return 0;
}

static int close_device(void** state)
{
    (void)state;
    ls_gpu_close(&gpu);
    return 0;
}

// Parallelograms of two triangles each, every other one a square across an axis, of the last maybe
// half, in a box of `size` whose lower corner is at `corner` along each axis.
static LsTestMesh make_list(uint32_t triangle_count, double corner, double size, uint64_t seed)
{
    LsRandom random = {seed};
    LsTestMesh mesh = {
        .positions = malloc(triangle_count * 9 * sizeof(float)),
        .indices = malloc(triangle_count * 3 * sizeof(uint32_t)),
        .vertex_count = triangle_count * 3,
        .triangle_count = triangle_count,
    };
    assert_non_null(mesh.positions);
    assert_non_null(mesh.indices);
    for (uint32_t i = 0; i < triangle_count; i += 2)
    {
        double from[3], along[3], across[3];
        const uint32_t axis = ls_random_below(&random, 3);
        for (uint32_t k = 0; k < 3; k++)
        {
            const bool is_straight = i % 4 == 0;
            from[k] = ls_random_between(&random, 0.0, 0.5 * size);
            along[k] = is_straight ? (k == axis ? 0.5 * size : 0.0)
                                   : ls_random_between(&random, 0.0, 0.5 * size);
            across[k] = is_straight ? (k == (axis + 1) % 3 ? 0.5 * size : 0.0)
                                    : ls_random_between(&random, 0.0, 0.5 * size);
        }
        for (uint32_t k = 0; k < 3; k++)
        {
            float* corners = &mesh.positions[9 * i + k];
            const float a = (float)(corner + from[k]);
            const float b = (float)(corner + from[k] + along[k]);
            const float c = (float)(corner + from[k] + across[k]);
            corners[0] = a;
            corners[3] = b;
            corners[6] = c;
            // The other half.
            if (i + 1 < triangle_count)
            {
                corners[9] = b;
                corners[12] = (float)(corner + from[k] + along[k] + across[k]);
                corners[15] = c;
            }
        }
    }
    for (uint32_t i = 0; i < mesh.vertex_count; i++)
    {
        mesh.indices[i] = i;
    }
    return mesh;
}

typedef struct Scene
{
    char paths[8][512];
    LsBakeInput inputs[8];
    uint32_t input_count;
} Scene;

static void add_mesh(Scene* scene, LsTestMesh mesh, LsBakeInput place)
{
    char* path = scene->paths[scene->input_count];
    snprintf(path, sizeof scene->paths[0], FOLDER "/lists-%u.ply", scene->input_count);
    ls_test_mesh_write_ply(&mesh, path);
    ls_test_mesh_destroy(&mesh);
    place.path = path;
    scene->inputs[scene->input_count++] = place;
}

// Traces a scene's rays; ls_gpu_trace compares one pass with two.
static void check_rays(const LsGpuScene* scene, uint32_t flags)
{
    LsRaySet set = ls_ray_set_make(&scene->file, RAYS, 7 + flags);
    LsHit* expected = malloc(RAYS * sizeof *expected);
    LsHit* hits = malloc(RAYS * sizeof *hits);
    assert_non_null(expected);
    assert_non_null(hits);
    ls_gpu_trace(&gpu, scene, LS_TRACE_BRUTE, flags, set.rays, NULL, RAYS, expected);
    ls_gpu_trace(&gpu, scene, LS_TRACE_EXACT, flags, set.rays, NULL, RAYS, hits);
    uint32_t list_hits = 0;
    uint32_t grid_hits = 0;
    for (uint32_t i = 0; i < RAYS; i++)
    {
        const bool is_hit = expected[i].instance != LS_NONE;
        if ((flags & LS_RAY_FLAG_ANY_HIT) != 0)
        {
            assert_int_equal(hits[i].instance != LS_NONE, is_hit);
        }
        else
        {
            assert_memory_equal(&hits[i], &expected[i], sizeof hits[i]);
        }
        const uint32_t kind = is_hit ? scene->file.objects[expected[i].object].kind : 0;
        list_hits += is_hit && kind == LS_OBJECT_LIST;
        grid_hits += is_hit && kind == LS_OBJECT_GRID;
    }
    print_message("flags %u: %u hits of lists, %u of the grid\n", flags, list_hits, grid_hits);
    assert_true(list_hits > RAYS / 10 && grid_hits > RAYS / 50);
    free(hits);
    free(expected);
    ls_ray_set_destroy(&set);
}

static void test_lists_about_a_grid(void** state)
{
    (void)state;
    static Scene scene;
    add_mesh(&scene, make_list(12, -1.0, 2.0, 1), (LsBakeInput){0});
    add_mesh(&scene, make_list(1, -0.2, 0.7, 2), (LsBakeInput){0});
    add_mesh(&scene, ls_test_mesh_make(LS_TEST_MESH_TEAPOT),
             (LsBakeInput){.size = 1.0, .is_at = true, .at = {0.0, -1.0, 0.0}});
    add_mesh(&scene, make_list(31, 0.0, 1.0, 3),
             (LsBakeInput){.size = 1.7, .turn = 33.0, .is_at = true, .at = {0.2, -0.9, -0.1}});
    add_mesh(&scene, make_list(32, 0.0, 1.0, 4),
             (LsBakeInput){.turn = 200.0, .is_at = true, .at = {-0.4, -0.2, 0.3}});
    // Coordinates a hundred thousand times as large as the mesh.
    add_mesh(&scene, make_list(7, 1e5, 1.0, 5),
             (LsBakeInput){.size = 0.8, .is_at = true, .at = {0.5, 0.1, 0.5}});
    const LsBakeDesc desc = {
        .inputs = scene.inputs,
        .input_count = scene.input_count,
        .output = FOLDER "/lists.lspace",
        .grid = 20,
        .patches = 3,
        .force = true,
    };
    LsBakeReport report;
    LsError error;
    assert_int_equal(ls_bake_run(&desc, &report, &error), LS_OK);
    ls_bake_report_destroy(&report);

    LsGpuScene opened;
    ls_gpu_scene_open(&gpu, &opened, desc.output);
    assert_true(ls_trace_scratch_bytes(opened.scene, 1) != 0); // two passes
    uint32_t identities = 0;
    const uint32_t instance_count = ls_file_count(&opened.file, LS_CHUNK_INSTANCES);
    for (uint32_t i = 0; i < instance_count; i++)
    {
        identities += (opened.file.instances[i].flags & LS_INSTANCE_IDENTITY) != 0;
    }
    assert_true(identities >= 2 && instance_count - identities >= 4);
    check_rays(&opened, 0);
    check_rays(&opened, LS_RAY_FLAG_ANY_HIT);
    check_rays(&opened, LS_RAY_FLAG_CULL_BACK_FACING);
    ls_gpu_scene_close(&opened);
    for (uint32_t i = 0; i < scene.input_count; i++)
    {
        remove(scene.paths[i]);
    }
    remove(desc.output);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lists_about_a_grid)};
    return cmocka_run_group_tests_name("lists", tests, open_device, close_device);
}
