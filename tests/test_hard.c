// Geometry that grids fear: the answers of brute force.

#include "baked.h"
#include "gpu.h"
#include "hard_meshes.h"
#include "test_random.h"

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
// clang-format on

#include "ls_bake.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIANGLES 2000
#define RAYS 512

static LsGpu gpu;

static int set_up(void** state)
{
    (void)state;
    ls_gpu_open(&gpu);
    return 0;
}

static int tear_down(void** state)
{
    (void)state;
    ls_gpu_close(&gpu);
    return 0;
}

// From a shell around the mesh to points of it, and from such points in any direction.
static void make_rays(const LsTestMesh* mesh, LsRay* rays)
{
    LsRandom random = {7};
    float lower[3], upper[3];
    ls_test_mesh_bounds(mesh, lower, upper);
    for (uint32_t i = 0; i < RAYS; i++)
    {
        const uint32_t face = ls_random_below(&random, mesh->triangle_count);
        double point[3] = {0}, way[3], origin[3], weights[3], sum = 0.0;
        for (int corner = 0; corner < 3; corner++)
        {
            weights[corner] = ls_random_unit(&random);
            sum += weights[corner];
        }
        for (int axis = 0; axis < 3; axis++)
        {
            for (int corner = 0; corner < 3; corner++)
            {
                const uint32_t vertex = mesh->indices[3 * face + corner];
                point[axis] += weights[corner] / sum * mesh->positions[3 * vertex + axis];
            }
            const double size = upper[axis] - lower[axis];
            way[axis] = ls_random_between(&random, -1.0, 1.0);
            origin[axis] = i % 2 == 0 ? point[axis] : point[axis] - (size + 0.1) * way[axis];
        }
        rays[i] = (LsRay){
            .origin = {(float)origin[0], (float)origin[1], (float)origin[2]},
            .direction = {(float)way[0], (float)way[1], (float)way[2]},
            .tmax = INFINITY,
        };
    }
}

static void check_mesh(LsHardMeshId id, uint32_t grid)
{
    LsTestMesh mesh = ls_hard_mesh_make(id, TRIANGLES);
    static const char SOURCE[] = LS_BINARY_DIR "/hard.ply", BAKED[] = LS_BINARY_DIR "/hard.lspace";
    ls_test_mesh_write_ply(&mesh, SOURCE);
    const LsBakeInput input = {.path = SOURCE};
    const LsBakeDesc desc = {
        .inputs = &input, .input_count = 1, .output = BAKED, .grid = grid, .force = true};
    LsBakeReport report;
    LsError error;
    if (ls_bake_run(&desc, &report, &error) != LS_OK)
    {
        fail_msg("%s: %s", ls_hard_mesh_name(id), error.text);
    }
    LsGpuScene scene;
    ls_gpu_scene_open(&gpu, &scene, BAKED);
    static LsRay rays[RAYS];
    static LsHit exact[RAYS], brute[RAYS];
    make_rays(&mesh, rays);
    ls_gpu_trace(&gpu, &scene, LS_TRACE_EXACT, 0, rays, NULL, RAYS, exact);
    ls_gpu_trace(&gpu, &scene, LS_TRACE_BRUTE, 0, rays, NULL, RAYS, brute);
    uint32_t hits = 0, differing = 0;
    for (uint32_t i = 0; i < RAYS; i++)
    {
        hits += brute[i].instance != LS_NONE;
        differing += memcmp(&exact[i], &brute[i], sizeof exact[i]) != 0;
    }
    const double per_triangle = (double)report.reference_count / (double)report.triangle_count;
    const double per_voxel = (double)report.reference_count / (double)report.voxel_count;
    printf("%-8s grid %3u: %7.2f references a triangle, %6.2f a voxel, %llu crowded, %u hits, "
           "%u differ\n",
           ls_hard_mesh_name(id), grid, per_triangle, per_voxel,
           (unsigned long long)report.crowded_object_count, hits, differing);
    assert_true(hits > RAYS / 8);
    assert_int_equal(differing, 0);
    ls_gpu_scene_close(&scene);
    ls_bake_report_destroy(&report);
    ls_test_mesh_destroy(&mesh);
}

static void test_hard_meshes(void** state)
{
    (void)state;
    for (LsHardMeshId id = 0; id < LS_HARD_MESH_COUNT; id++)
    {
        check_mesh(id, 0);
    }
}

// Asked for far more cells than such triangles bear.
static void test_fine_grids(void** state)
{
    (void)state;
    check_mesh(LS_HARD_MESH_EDGE, 128);
    check_mesh(LS_HARD_MESH_EQUAL, 128);
    check_mesh(LS_HARD_MESH_HUB, 128);
    check_mesh(LS_HARD_MESH_NEEDLES, 64);
}

// Specks in even disorder, of which a line meets none or one, though cells and masks of N = 1 ask
// for many.
static LsTestMesh make_specks(uint32_t side)
{
    const uint32_t count = side * side * side;
    LsTestMesh mesh = {.positions = malloc(9ull * count * sizeof(float)),
                       .vertex_count = 3 * count,
                       .indices = malloc(3ull * count * sizeof(uint32_t)),
                       .triangle_count = count};
    assert_non_null(mesh.positions);
    assert_non_null(mesh.indices);
    LsRandom random = {3};
    for (uint32_t i = 0; i < count; i++)
    {
        const uint32_t cell[3] = {i % side, i / side % side, i / (side * side)};
        double middle[3];
        for (int axis = 0; axis < 3; axis++)
        {
            middle[axis] = (cell[axis] + ls_random_between(&random, 0.2, 0.8)) / side;
        }
        for (uint32_t corner = 0; corner < 3; corner++)
        {
            for (uint32_t axis = 0; axis < 3; axis++)
            {
                mesh.positions[9 * i + 3 * corner + axis] =
                    (float)(middle[axis] + ls_random_between(&random, -0.0015, 0.0015));
            }
            mesh.indices[3 * i + corner] = 3 * i + corner;
        }
    }
    return mesh;
}

// Rays whose tests are more than a kernel that traces many of them a lane has rounds for, which
// llvmpipe's has (LS_LOCKSTEP_ROUNDS), are traced all the same.
static void test_many_tests(void** state)
{
    (void)state;
    LsTestMesh mesh = make_specks(48);
    LsBaked baked;
    ls_baked_open(&baked, &mesh, "specks", LS_TEST_ALONE, 16, 1, 0);
    LsGpuScene scene;
    ls_gpu_scene_open(&gpu, &scene, baked.path);
    enum
    {
        COUNT = 4096
    };
    static LsRay rays[COUNT];
    static LsHit exact[COUNT], grid[COUNT];
    LsRandom random = {11};
    for (uint32_t i = 0; i < COUNT; i++)
    {
        float numbers[6];
        for (int axis = 0; axis < 3; axis++)
        {
            numbers[axis] = (float)ls_random_between(&random, -0.05, 0.05);
            numbers[3 + axis] = (float)ls_random_between(&random, 0.98, 1.02);
        }
        rays[i] = (LsRay){.origin = {numbers[0], numbers[1], numbers[2]},
                          .direction = {numbers[3], numbers[4], numbers[5]},
                          .tmax = INFINITY};
    }
    ls_gpu_trace(&gpu, &scene, LS_TRACE_EXACT, 0, rays, NULL, COUNT, exact);
    ls_gpu_trace(&gpu, &scene, LS_TRACE_GRID, 0, rays, NULL, COUNT, grid);
    uint32_t hits = 0;
    for (uint32_t i = 0; i < COUNT; i++)
    {
        hits += grid[i].instance != LS_NONE;
        assert_memory_equal(&exact[i], &grid[i], sizeof exact[i]);
    }
    printf("specks: %u of %d rays hit\n", hits, COUNT);
    assert_true(hits > 100 && hits < COUNT / 2);
    ls_gpu_scene_close(&scene);
    ls_baked_close(&baked);
    ls_test_mesh_destroy(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hard_meshes),
        cmocka_unit_test(test_fine_grids),
        cmocka_unit_test(test_many_tests),
    };
    return cmocka_run_group_tests_name("hard", tests, set_up, tear_down);
}
