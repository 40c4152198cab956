// test_scene_trace.c - scene shafts change no answer and save steps: each mesh baked with and
// without them, traced with the rays of the exactness suite and with rays along the borders of
// patches and intervals.

#include "baked.h"
#include "gpu.h"
#include "ray_sets.h"
#include "test_random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define SET_RAYS 12000u
#define BORDER_RAYS 12000u
#define RAYS (SET_RAYS + BORDER_RAYS)

typedef struct Case
{
    LsTestMeshId mesh;
    LsTestPlacement placement;
    uint32_t grid, scene_patches;
} Case;

static const Case CASES[] = {
    {LS_TEST_MESH_BUNNY, LS_TEST_ALONE, 64, 16},
    {LS_TEST_MESH_ELEPHANT, LS_TEST_ALONE, 100, 20},
    {LS_TEST_MESH_TEAPOT, LS_TEST_INSTANCES, 24, 7},
    {LS_TEST_MESH_STADIUM, LS_TEST_ALONE, 9, 8},
    {LS_TEST_MESH_HUB, LS_TEST_ALONE, 8, 4},
    {LS_TEST_MESH_SHELL, LS_TEST_ALONE, 16, 8},
    {LS_TEST_MESH_FAR, LS_TEST_ALONE, 0, 5},
    {LS_TEST_MESH_STRAY, LS_TEST_INSTANCES, 12, 12},
};
#define CASE_COUNT (sizeof CASES / sizeof CASES[0])

static LsGpu gpu;

// ---- Rays ---------------------------------------------------------------------------------------

// A point on a face of the grid's box, in object space; mostly on borders of patches.
static void draw_point(LsRandom* random, const LsObject* object, uint32_t patches, double point[3])
{
    const double lower[3] = {object->grid_lower.x, object->grid_lower.y, object->grid_lower.z};
    const uint32_t face = ls_random_below(random, 6);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        const bool is_border = ls_random_below(random, 4) != 0;
        const double part = is_border ? (double)ls_random_below(random, patches + 1) / patches
                                      : ls_random_unit(random);
        const double share = axis == face >> 1 ? face & 1 : part;
        point[axis] = lower[axis] + object->cells[axis] * share / object->inverse_cell;
    }
}

// A line from face to face of the first grid, begun before it, on it, or at the end of an interval
// inside.
static LsRay make_border_ray(LsRandom* random, const LsObject* object, uint32_t patches)
{
    double from[3], to[3], way[3], origin[3];
    draw_point(random, object, patches, from);
    draw_point(random, object, patches, to);
    const double part =
        (double)ls_random_below(random, LS_SIGNATURE_INTERVALS + 1) / LS_SIGNATURE_INTERVALS;
    static const double before[] = {-0.7, 0.0};
    const uint32_t where = ls_random_below(random, 3);
    for (int axis = 0; axis < 3; axis++)
    {
        // Half of the lines along an axis or in a plane of borders.
        to[axis] = ls_random_below(random, 4) == 0 ? from[axis] : to[axis];
        way[axis] = to[axis] - from[axis];
        origin[axis] = from[axis] + (where < 2 ? before[where] : part) * way[axis];
    }
    const float begin = ls_random_below(random, 2) == 0 ? 0.0f : (float)part;
    return (LsRay){.origin = {(float)origin[0], (float)origin[1], (float)origin[2]},
                   .tmin = begin,
                   .direction = {(float)way[0], (float)way[1], (float)way[2]},
                   .tmax = ls_random_below(random, 4) == 0 ? begin + 0.25f : INFINITY};
}

static LsRay* make_rays(const LsFile* file, uint32_t patches)
{
    LsRay* rays = malloc(RAYS * sizeof *rays);
    assert_non_null(rays);
    LsRaySet set = ls_ray_set_make(file, SET_RAYS, 11);
    memcpy(rays, set.rays, SET_RAYS * sizeof *rays);
    ls_ray_set_destroy(&set);
    uint32_t index = 0;
    while (file->objects[index].kind != LS_OBJECT_GRID)
    {
        index++;
    }
    LsRandom random = {7};
    for (uint32_t i = 0; i < BORDER_RAYS; i++)
    {
        rays[SET_RAYS + i] = make_border_ray(&random, &file->objects[index], patches);
    }
    return rays;
}

// ---- Runs ---------------------------------------------------------------------------------------

static uint64_t sum_cells(const LsHit* work)
{
    uint64_t cells = 0;
    for (uint32_t i = 0; i < RAYS; i++)
    {
        cells += work[i].instance;
    }
    return cells;
}

static void require_same(const LsRay* rays, const LsHit* with, const LsHit* without)
{
    for (uint32_t i = 0; i < RAYS; i++)
    {
        if (memcmp(&with[i], &without[i], sizeof *with) != 0)
        {
            fail_msg(
                "ray %u, o %a %a %a d %a %a %a t %a %a: t %g of %d with scene shafts, %g of %d "
                "without",
                i, rays[i].origin.x, rays[i].origin.y, rays[i].origin.z, rays[i].direction.x,
                rays[i].direction.y, rays[i].direction.z, rays[i].tmin, rays[i].tmax, with[i].t,
                (int)with[i].primitive, without[i].t, (int)without[i].primitive);
        }
    }
}

static void test_answers_alike(void** state)
{
    const Case* c = *state;
    LsTestMesh mesh = ls_test_mesh_make(c->mesh);
    LsBaked baked[2];
    LsGpuScene scenes[2];
    LsHit* hits[2];
    for (int i = 0; i < 2; i++)
    {
        const LsBakeDesc desc = {.grid = c->grid, .scene_patches = i == 0 ? 0 : c->scene_patches};
        ls_baked_open_desc(&baked[i], &mesh, "scene_trace", c->placement, &desc);
        ls_gpu_scene_open(&gpu, &scenes[i], baked[i].path);
        hits[i] = malloc(RAYS * sizeof(LsHit));
        assert_non_null(hits[i]);
    }
    LsRay* rays = make_rays(&baked[1].file, c->scene_patches);
    uint64_t cells[2];
    static const LsMethod methods[] = {LS_TRACE_EXACT, LS_TRACE_GRID};
    for (int k = 0; k < 2; k++)
    {
        for (int i = 0; i < 2; i++)
        {
            ls_gpu_trace(&gpu, &scenes[i], methods[k], 0, rays, NULL, RAYS, hits[i]);
        }
        require_same(rays, hits[1], hits[0]);
    }
    uint32_t hit_count = 0;
    for (uint32_t i = 0; i < RAYS; i++)
    {
        hit_count += hits[0][i].instance != LS_NONE;
    }
    for (int i = 0; i < 2; i++)
    {
        ls_gpu_trace(&gpu, &scenes[i], LS_TRACE_COUNT, 0, rays, NULL, RAYS, hits[i]);
        cells[i] = sum_cells(hits[i]);
    }
    print_message("M = %u: %u of %u rays hit; %.2f cells a ray with, %.2f without\n",
                  c->scene_patches, hit_count, RAYS, (double)cells[1] / RAYS,
                  (double)cells[0] / RAYS);
    assert_true(hit_count > RAYS / 20);
    assert_true(cells[1] <= cells[0] + cells[0] / 100);

    free(rays);
    for (int i = 0; i < 2; i++)
    {
        free(hits[i]);
        ls_gpu_scene_close(&scenes[i]);
        ls_baked_close(&baked[i]);
    }
    ls_test_mesh_destroy(&mesh);
}

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

int main(void)
{
    struct CMUnitTest tests[CASE_COUNT];
    for (size_t i = 0; i < CASE_COUNT; i++)
    {
        tests[i] = (struct CMUnitTest){.name = ls_test_mesh_name(CASES[i].mesh),
                                       .test_func = test_answers_alike,
                                       .initial_state = (void*)&CASES[i]};
    }
    return _cmocka_run_group_tests("scene trace", tests, CASE_COUNT, open_device, close_device);
}
