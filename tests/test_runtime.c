// The runtime library on the smallest scenes: every hit is known, wrong calls and files are refused.

#include "runtime_fixture.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <math.h>
#include <stdlib.h>
#include <string.h>

static LsGpuScene scenes[LS_SMALL_LARGE]; // all but the large ones
static const LsMethod METHODS[] = {LS_TRACE_EXACT, LS_TRACE_BRUTE, LS_TRACE_GRID};

static int set_up(void** state)
{
    (void)state;
    open_fixture();
    for (int i = 0; i < LS_SMALL_LARGE; i++)
    {
        ls_gpu_scene_open(&gpu, &scenes[i], paths[i]);
    }
    return 0;
}

static int tear_down(void** state)
{
    (void)state;
    for (int i = 0; i < LS_SMALL_LARGE; i++)
    {
        ls_gpu_scene_close(&scenes[i]);
    }
    return close_fixture();
}

static const LsHit MISS = {
    .t = -1,
    .instance = LS_NONE,
    .object = LS_NONE,
    .primitive = LS_NONE,
    .material = LS_NONE,
};

static LsHit trace_one(const LsGpuScene* scene, LsMethod method, uint32_t flags, LsRay ray)
{
    LsHit hit;
    memset(&hit, 0xCC, sizeof(hit));
    ls_gpu_trace(&gpu, scene, method, flags, &ray, NULL, 1, &hit);
    return hit;
}

// ---- Answers -----------------------------------------------------------------------------------

// In the quad's first triangle (0,0)(1,0)(1,1) a point is (u+v, v), in the second (0,0)(1,1)(0,1)
// it is (u, u+v).
static void test_known_hits(void** state)
{
    (void)state;
    for (int i = 0; i < 2; i++)
    {
        const LsGpuScene* scene = &scenes[i == 0 ? LS_SMALL_LIST : LS_SMALL_GRID];
        for (int m = 0; m < 3; m++)
        {
            check_hit(trace_one(scene, METHODS[m], 0, ray_down(0.75f, 0.25f)),
                      (LsHit){.t = 1, .u = 0.5f, .v = 0.25f, .primitive = 0, .material = 0});
            check_hit(trace_one(scene, METHODS[m], 0, ray_down(0.25f, 0.75f)),
                      (LsHit){.t = 1, .u = 0.25f, .v = 0.5f, .primitive = 2, .material = 1});
            // t counts in units of the direction as given.
            LsRay fast = make_ray((LsVec3){0.75f, 0.25f, 3}, (LsVec3){0, 0, -12});
            check_hit(trace_one(scene, METHODS[m], 0, fast),
                      (LsHit){.t = 0.25f, .u = 0.5f, .v = 0.25f, .primitive = 0, .material = 0});
            // The shared edge: of equal t the lower primitive.
            assert_int_equal(trace_one(scene, METHODS[m], 0, ray_down(0.5f, 0.5f)).primitive, 0);
        }
    }
}

static void test_hits_from_both_ends_of_a_grid(void** state)
{
    (void)state;
    const LsGpuScene* scene = &scenes[LS_SMALL_GRID];
    for (int m = 0; m < 3; m++)
    {
        LsRay up = make_ray((LsVec3){0.75f, 0.25f, -3}, (LsVec3){0, 0, 1});
        check_hit(trace_one(scene, METHODS[m], 0, up),
                  (LsHit){.t = 2, .u = 0.5f, .v = 0.25f, .primitive = 3, .material = 0});
        LsRay inside = make_ray((LsVec3){0.25f, 0.75f, -0.5f}, (LsVec3){0, 0, -1});
        check_hit(trace_one(scene, METHODS[m], 0, inside),
                  (LsHit){.t = 0.5f, .u = 0.25f, .v = 0.5f, .primitive = 5, .material = 1});
    }
}

static void test_interval_is_open(void** state)
{
    (void)state;
    const LsGpuScene* scene = &scenes[LS_SMALL_LIST];
    for (int m = 0; m < 3; m++)
    {
        LsRay ray = ray_down(0.75f, 0.25f);
        ray.tmin = 1;
        check_hit(trace_one(scene, METHODS[m], 0, ray), MISS);
        ray.tmin = nextafterf(1, 0);
        assert_float_equal(trace_one(scene, METHODS[m], 0, ray).t, 1, 0);
        ray.tmin = 0;
        ray.tmax = 1;
        check_hit(trace_one(scene, METHODS[m], 0, ray), MISS);
        ray.tmax = nextafterf(1, 2);
        assert_float_equal(trace_one(scene, METHODS[m], 0, ray).t, 1, 0);
    }
}

static void test_misses(void** state)
{
    (void)state;
    const LsRay rays[] = {
        ray_down(1.5f, 0.5f),
        ray_down(-0.001f, 0.5f),
        make_ray((LsVec3){0.5f, 0.5f, 1}, (LsVec3){0, 0, 1}),
        make_ray((LsVec3){0.5f, 0.5f, 1}, (LsVec3){1, 0, 0}),
        make_ray((LsVec3){-1, 0.5f, 0}, (LsVec3){1, 0, 0}), // within the plane
    };
    enum
    {
        COUNT = sizeof(rays) / sizeof(rays[0])
    };
    const LsGpuScene* scene = &scenes[LS_SMALL_LIST];
    for (int m = 0; m < 3; m++)
    {
        LsHit hits[COUNT];
        ls_gpu_trace(&gpu, scene, METHODS[m], 0, rays, NULL, COUNT, hits);
        for (int i = 0; i < COUNT; i++)
        {
            check_hit(hits[i], MISS);
        }
    }
}

// The ray that would hit, broken in one place at a time. SPEC 7.1.
static void test_illegal_rays_miss(void** state)
{
    (void)state;
    enum
    {
        NAN_COUNT = 8,
        COUNT = NAN_COUNT + 13
    };
    LsRay rays[COUNT];
    for (int i = 0; i < COUNT; i++)
    {
        rays[i] = ray_down(0.75f, 0.25f);
    }
    for (int i = 0; i < NAN_COUNT; i++)
    {
        ((float*)&rays[i])[i] = NAN;
    }
    LsRay* ray = rays + NAN_COUNT;
    (ray++)->direction = (LsVec3){0, 0, 0};
    (ray++)->direction = (LsVec3){0, 0, -0x1p-127f}; // below the smallest normal number: zero
    (ray++)->direction = (LsVec3){0, 0, -INFINITY};
    (ray++)->direction = (LsVec3){INFINITY, 0, -1};
    (ray++)->origin.x = INFINITY;
    (ray++)->origin.z = INFINITY;
    (ray++)->origin.y = -INFINITY;
    (ray++)->tmin = -1;
    (ray++)->tmin = -INFINITY;
    (ray++)->tmin = INFINITY;
    (ray++)->tmax = 0;
    (ray++)->tmax = -INFINITY;
    ray->tmin = 2;
    (ray++)->tmax = 0.5f;
    assert_ptr_equal(ray, rays + COUNT);
    for (int s = 0; s <= LS_SMALL_INSTANCES; s++)
    {
        const LsGpuScene* scene = &scenes[s];
        for (int m = 0; m < 3; m++)
        {
            LsHit hits[COUNT];
            ls_gpu_trace(&gpu, scene, METHODS[m], 0, rays, NULL, COUNT, hits);
            for (int i = 0; i < COUNT; i++)
            {
                check_hit(hits[i], MISS);
            }
        }
    }
}

static void test_any_hit(void** state)
{
    (void)state;
    const LsGpuScene* scene = &scenes[LS_SMALL_GRID];
    for (int m = 0; m < 3; m++)
    {
        LsHit hit = trace_one(scene, METHODS[m], LS_RAY_FLAG_ANY_HIT, ray_down(0.25f, 0.75f));
        assert_true(hit.primitive == 2 || hit.primitive == 5);
        check_hit(hit, (LsHit){.primitive = hit.primitive, .material = 1});
        check_hit(trace_one(scene, METHODS[m], LS_RAY_FLAG_ANY_HIT, ray_down(1.5f, 0.5f)), MISS);
    }
}

// The quad's corners go counter-clockwise as seen from z > 0; a mirrored instance turns it round.
static void test_culling(void** state)
{
    (void)state;
    const LsGpuScene* scene = &scenes[LS_SMALL_INSTANCES];
    const float x[3] = {0.75f, 11.5f, 20.25f};
    for (uint32_t i = 0; i < 3; i++)
    {
        LsRay down = ray_down(x[i], 0.25f);
        LsRay up = make_ray((LsVec3){x[i], 0.25f, -1}, (LsVec3){0, 0, 1});
        LsRay front = i == 2 ? up : down;
        LsRay back = i == 2 ? down : up;
        for (int m = 0; m < 3; m++)
        {
            assert_int_equal(trace_one(scene, METHODS[m], 0, front).instance, i);
            assert_int_equal(trace_one(scene, METHODS[m], 0, back).instance, i);
            assert_int_equal(
                trace_one(scene, METHODS[m], LS_RAY_FLAG_CULL_BACK_FACING, front).instance, i);
            check_hit(trace_one(scene, METHODS[m], LS_RAY_FLAG_CULL_BACK_FACING, back), MISS);
            check_hit(trace_one(scene, METHODS[m], LS_RAY_FLAG_CULL_FRONT_FACING, front), MISS);
            assert_int_equal(
                trace_one(scene, METHODS[m], LS_RAY_FLAG_CULL_FRONT_FACING, back).instance, i);
        }
    }
}

static void test_instances_and_masks(void** state)
{
    (void)state;
    const LsGpuScene* scene = &scenes[LS_SMALL_INSTANCES];
    const LsRay targets[3] = {ray_down(0.75f, 0.25f), ray_down(11.5f, 0.5f),
                              ray_down(20.25f, 0.25f)};
    const LsHit expected = {.t = 1, .u = 0.5f, .v = 0.25f};
    LsRay rays[24];
    uint32_t masks[24];
    for (uint32_t i = 0; i < 24; i++)
    {
        rays[i] = targets[i / 8];
        masks[i] = i % 8;
    }
    for (int m = 0; m < 3; m++)
    {
        LsHit hits[24];
        ls_gpu_trace(&gpu, scene, METHODS[m], 0, rays, masks, 24, hits);
        for (uint32_t i = 0; i < 24; i++)
        {
            LsHit hit = expected;
            hit.instance = i / 8;
            check_hit(hits[i], masks[i] & 1u << i / 8 ? hit : MISS);
        }
        // Without the array every ray sees every instance.
        ls_gpu_trace(&gpu, scene, METHODS[m], 0, rays, NULL, 24, hits);
        for (uint32_t i = 0; i < 24; i++)
        {
            assert_int_equal(hits[i].instance, i / 8);
        }
    }
}

static void test_no_rays(void** state)
{
    (void)state;
    const LsGpuScene* scene = &scenes[LS_SMALL_LIST];
    memset(gpu.tracer.output.mapped, 0xCC, sizeof(LsHit));
    uint8_t untouched[sizeof(LsHit)];
    memset(untouched, 0xCC, sizeof(untouched));
    LsAppRun run = {.ray_count = 0};
    LsError error;
    assert_int_equal(ls_app_tracer_run(&gpu.device, &gpu.tracer, scene->scene, &run, NULL, &error),
                     LS_OK);
    assert_memory_equal(gpu.tracer.output.mapped, untouched, sizeof(untouched));
}

static void test_facts_of_a_scene(void** state)
{
    (void)state;
    const uint64_t features[] = {
        LS_FEATURE_LISTS,
        LS_FEATURE_GRIDS | LS_FEATURE_MASKS,
        LS_FEATURE_TOP_LEVEL | LS_FEATURE_LISTS,
    };
    const uint64_t bytes[] = {
        sizeof(LsDeviceScene) + 144 + 128 + 2 * 48 + 2 * 48,
        sizeof(LsDeviceScene) + 144 + 128 + 2 * 48 + 4 * 48 + 4 + 256 + 16 + 4 * 4 + 2 * 4,
        sizeof(LsDeviceScene) + 144 + 3 * 128 + 5 * 32 + 2 * 48 + 2 * 48,
    };
    for (int i = 0; i <= LS_SMALL_INSTANCES; i++)
    {
        const LsGpuScene* scene = &scenes[i];
        assert_int_equal(ls_scene_features(scene->scene), features[i]);
        const bool has_passes = ls_trace_scratch_bytes(scene->scene, 1) != 0;
        assert_int_equal(ls_scene_device_bytes(scene->scene),
                         bytes[i] + (has_passes ? sizeof(LsPassInstance) : 0));
        assert_true(ls_scene_address(scene->scene) != 0);
    }
}

// ---- Wrong calls and wrong files ---------------------------------------------------------------

static void test_wrong_arguments(void** state)
{
    (void)state;
    const LsGpuScene* scene = &scenes[LS_SMALL_LIST];
    const LsTraceDesc good = {
        .rays = gpu.tracer.input.address,
        .hits = gpu.tracer.output.address,
        .ray_count = 1,
    };
    static const LsMessage MESSAGES[9] = {
        LS_MESSAGE_TRACE_TIMES,   LS_MESSAGE_TRACE_FLAGS,   LS_MESSAGE_TRACE_METHOD,
        LS_MESSAGE_TRACE_ADDRESS, LS_MESSAGE_TRACE_ADDRESS, LS_MESSAGE_TRACE_ADDRESS,
        LS_MESSAGE_TRACE_ADDRESS, LS_MESSAGE_TRACE_ADDRESS, LS_MESSAGE_TRACE_COUNT,
    };
    LsTraceDesc wrong[9];
    for (int i = 0; i < 9; i++)
    {
        wrong[i] = good;
    }
    wrong[0].times = 16;
    wrong[1].flags = 8;
    wrong[2].method = (LsMethod)4;
    wrong[3].rays = 0;
    wrong[4].hits = 0;
    wrong[5].rays += 8;
    wrong[6].hits += 8;
    wrong[7].masks = 2;
    wrong[8].ray_count = (1u << 31) + 1;
    LsError error;
    VkCommandBuffer commands;
    assert_int_equal(ls_app_commands_begin(&gpu.device, &commands, &error), LS_OK);
    for (int i = 0; i < 9; i++)
    {
        assert_int_equal(ls_trace_record(scene->scene, commands, &wrong[i], &error),
                         LS_ERROR_ARGUMENT);
        assert_int_equal(error.message, MESSAGES[i]);
        assert_int_equal(ls_trace_record(scene->scene, commands, &wrong[i], NULL),
                         LS_ERROR_ARGUMENT);
    }
    assert_int_equal(ls_trace_record(scene->scene, commands, &good, &error), LS_OK);
    assert_int_equal(ls_app_commands_submit(&gpu.device, commands, &error), LS_OK);
}

// A file whose header is right and whose contents break a rule is refused before anything is
// uploaded.
static void test_broken_rule(void** state)
{
    (void)state;
    LsMapping mapping;
    LsError error;
    assert_int_equal(ls_mapping_open(&mapping, paths[LS_SMALL_LIST], &error), LS_OK);
    uint8_t* bytes = aligned_alloc(4096, (mapping.size + 4095) / 4096 * 4096);
    assert_non_null(bytes);
    memcpy(bytes, mapping.bytes, mapping.size);
    LsFile file;
    assert_int_equal(ls_file_open(&file, bytes, mapping.size, "broken.lspace", &error), LS_OK);
    ((LsTriangle*)(bytes + file.chunk_entries[LS_CHUNK_TRIANGLES]->offset))->material = 2;
    LsScene* scene = (LsScene*)bytes;
    assert_int_equal(ls_scene_create(gpu.context, &file, "broken.lspace", &scene, &error),
                     LS_ERROR_RULE);
    assert_null(scene);
    assert_int_equal(error.message, LS_MESSAGE_LSPACE_RULE);
    assert_non_null(strstr(error.text, "broken.lspace"));
    assert_non_null(strstr(error.text, "R4.4"));
    free(bytes);
    ls_mapping_close(&mapping);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_hits),
        cmocka_unit_test(test_hits_from_both_ends_of_a_grid),
        cmocka_unit_test(test_interval_is_open),
        cmocka_unit_test(test_misses),
        cmocka_unit_test(test_illegal_rays_miss),
        cmocka_unit_test(test_any_hit),
        cmocka_unit_test(test_culling),
        cmocka_unit_test(test_instances_and_masks),
        cmocka_unit_test(test_no_rays),
        cmocka_unit_test(test_facts_of_a_scene),
        cmocka_unit_test(test_wrong_arguments),
        cmocka_unit_test(test_broken_rule),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
