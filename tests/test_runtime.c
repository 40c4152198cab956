// The runtime library on the smallest scenes: every hit is known, every failure is provoked.

#include "fake_vulkan.h"
#include "gpu.h"
#include "small_scenes.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/ls_test_runtime_XXXXXX";
static char paths[LS_SMALL_COUNT][64];
static LsGpu gpu;
static LsGpuScene scenes[LS_SMALL_LARGE]; // all but the large ones
static const LsMethod METHODS[] = {LS_TRACE_EXACT, LS_TRACE_BRUTE, LS_TRACE_GRID};

static int set_up(void** state)
{
    (void)state;
    assert_non_null(mkdtemp(folder));
    for (int i = 0; i < LS_SMALL_COUNT; i++)
    {
        snprintf(paths[i], sizeof(paths[i]), "%s/%d.lspace", folder, i);
        ls_small_scene_write((LsSmallScene)i, paths[i]);
    }
    ls_gpu_open(&gpu);
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
    ls_gpu_close(&gpu);
    for (int i = 0; i < LS_SMALL_COUNT; i++)
    {
        unlink(paths[i]);
    }
    return rmdir(folder);
}

static LsRay make_ray(LsVec3 origin, LsVec3 direction)
{
    return (LsRay){.origin = origin, .direction = direction, .tmax = INFINITY};
}

// Down onto (x,y) of the plane z = 0, from z = 1.
static LsRay ray_down(float x, float y)
{
    return make_ray((LsVec3){x, y, 1}, (LsVec3){0, 0, -1});
}

static const LsHit MISS = {
    .t = -1,
    .instance = LS_NONE,
    .object = LS_NONE,
    .primitive = LS_NONE,
    .material = LS_NONE,
};

// All 32 bytes must be equal.
static void check_hit(LsHit hit, LsHit expected)
{
    assert_float_equal(hit.t, expected.t, 0);
    assert_float_equal(hit.u, expected.u, 0);
    assert_float_equal(hit.v, expected.v, 0);
    assert_int_equal(hit.instance, expected.instance);
    assert_int_equal(hit.object, expected.object);
    assert_int_equal(hit.primitive, expected.primitive);
    assert_int_equal(hit.material, expected.material);
    assert_memory_equal(&hit, &expected, sizeof(hit));
}

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
        assert_int_equal(ls_scene_device_bytes(scene->scene), bytes[i]);
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

// ---- Devices as they may be --------------------------------------------------------------------

static LsContextDesc fake_desc(LsFakeVulkan fake)
{
    ls_fake_vulkan = fake;
    LsContextDesc desc = ls_app_context_desc(&gpu.device);
    desc.get_instance_proc_addr = ls_fake_get_instance_proc_addr;
    return desc;
}

// A context through the fake, beside the real one.
static void open_faked(LsGpu* faked, LsFakeVulkan fake)
{
    *faked = gpu;
    LsContextDesc desc = fake_desc(fake);
    LsError error;
    if (ls_context_create(&desc, &faked->context, &error) != LS_OK)
    {
        fail_msg("%s", error.text);
    }
}

static void close_faked(LsGpu* faked)
{
    ls_context_destroy(faked->context);
    assert_int_equal(ls_fake_vulkan.live_objects, 0);
}

static void test_many_dispatches(void** state)
{
    (void)state;
    LsGpu faked;
    open_faked(&faked, (LsFakeVulkan){.max_group_count = 3});
    LsGpuScene scene;
    ls_gpu_scene_open(&faked, &scene, paths[LS_SMALL_INSTANCES]);
    enum
    {
        COUNT = 1000
    };
    LsRay rays[COUNT];
    uint32_t masks[COUNT];
    for (uint32_t i = 0; i < COUNT; i++)
    {
        rays[i] = ray_down((float)(i % 22) + 0.75f, 0.25f);
        masks[i] = i % 5;
    }
    LsHit hits[2][COUNT];
    ls_gpu_trace(&faked, &scene, LS_TRACE_EXACT, 0, rays, masks, COUNT, hits[0]);
    assert_int_equal(ls_fake_vulkan.dispatch_count, 11); // of 96 rays
    ls_gpu_scene_close(&scene);
    close_faked(&faked);

    ls_gpu_trace(&gpu, &scenes[LS_SMALL_INSTANCES], LS_TRACE_EXACT, 0, rays, masks, COUNT, hits[1]);
    for (uint32_t i = 0; i < COUNT; i++)
    {
        check_hit(hits[0][i], hits[1][i]);
        uint32_t cell = i % 22; // the quads cover cells 0, 10, 11 and 20
        uint32_t instance = cell == 0 ? 0 : cell == 10 || cell == 11 ? 1 : cell == 20 ? 2 : LS_NONE;
        bool seen = instance != LS_NONE && (masks[i] & 1u << instance);
        assert_int_equal(hits[0][i].instance, seen ? instance : LS_NONE);
    }
}

// Where the device has memory of its own, or is made to look so, the file goes through the staging
// ring, several times round.
static void test_staging(void** state)
{
    (void)state;
    LsGpu faked;
    open_faked(&faked, (LsFakeVulkan){.separate_memory = gpu.device.is_cpu});
    LsGpuScene scene;
    ls_gpu_scene_open(&faked, &scene, paths[LS_SMALL_LARGE]);
    assert_int_equal(ls_fake_vulkan.copy_count,
                     3 + 4 + 1); // three small arrays, 15.2 MiB of triangles, the table
    assert_int_equal(ls_fake_vulkan.submit_count, ls_fake_vulkan.copy_count);

    // Triangles at the seams of 4 MiB pieces, at both ends and between.
    const uint32_t seam = (4u << 20) / sizeof(LsTriangle);
    const uint32_t last = LS_LARGE_SIDE * LS_LARGE_SIDE - 1;
    const uint32_t picked[] = {0,
                               1,
                               seam - 1,
                               seam,
                               seam + 1,
                               2 * seam - 1,
                               2 * seam,
                               2 * seam + 1,
                               2 * seam + 2,
                               3 * seam - 1,
                               3 * seam,
                               3 * seam + 1,
                               3 * seam + 2,
                               3 * seam + 3,
                               last / 2,
                               last - 1,
                               last};
    enum
    {
        COUNT = sizeof(picked) / sizeof(picked[0])
    };
    LsRay rays[COUNT];
    LsHit hits[COUNT];
    for (int i = 0; i < COUNT; i++)
    {
        float x = (float)(picked[i] % LS_LARGE_SIDE);
        float y = (float)(picked[i] / LS_LARGE_SIDE);
        rays[i] = ray_down(x + 0.25f, y + 0.5f);
    }
    ls_gpu_trace(&faked, &scene, LS_TRACE_BRUTE, 0, rays, NULL, COUNT, hits);
    for (int i = 0; i < COUNT; i++)
    {
        check_hit(
            hits[i],
            (LsHit){
                .t = 1, .u = 0.25f, .v = 0.5f, .primitive = picked[i], .material = picked[i] % 2});
    }
    ls_gpu_scene_close(&scene);
    close_faked(&faked);
}

// What tracing and shading do not read stays in the file: not a byte more is uploaded.
static void test_looks_stay_in_the_file(void** state)
{
    (void)state;
    LsMapping mapping;
    LsFile file;
    LsError error;
    assert_int_equal(ls_mapping_open(&mapping, paths[LS_SMALL_LIST], &error), LS_OK);
    assert_int_equal(ls_file_open(&file, mapping.bytes, mapping.size, "small.lspace", &error),
                     LS_OK);
    LsFileDesc desc = ls_file_desc(&file);
    const LsSurface surface = {.ior = 1.5f,
                               .alpha = 1,
                               .metallic_roughness_texture = LS_NONE,
                               .normal_texture = LS_NONE,
                               .emissive_texture = LS_NONE,
                               .transmission_texture = LS_NONE};
    const LsTexture texture = {.row_u = {1, 0, 0, 0}, .row_v = {0, 1, 0, 0}};
    const LsImage image = {.width = 64, .height = 32};
    const uint32_t pixels[64 * 32] = {0xFFFFFFFF};
    const LsAttributes attributes = {0, {0, LS_NONE}, 0};
    const uint32_t normals[6] = {0};
    const LsTexcoord texcoords[6] = {{0, 0}};
    const LsCornerColor colors[6] = {{0, 0}};
    const LsLamp lamp = {.kind = LS_LAMP_DIRECTIONAL,
                         .direction = {0, 0, -1},
                         .node = LS_NONE,
                         .cos_inner = 1,
                         .cos_outer = -1};
    const LsSceneNode node = {.parent_from_node = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                              .parent = LS_NONE};
    const LsAnimation animation = {.channel_count = 3};
    const LsChannel channels[3] = {
        {.path = LS_PATH_TRANSLATION, .key_count = 1, .first_value = 1},
        {.path = LS_PATH_ROTATION, .key_count = 1, .first_value = 4},
        {.path = LS_PATH_SCALE, .key_count = 1, .first_value = 8},
    };
    const float keys[11] = {0, /**/ 0, 0, 0, /**/ 0, 0, 0, 1, /**/ 1, 1, 1};
    const LsFileDesc plain = desc;
    LsMaterial materials[2] = {desc.materials[0], desc.materials[1]};
    materials[1].surface = 1;
    desc.materials = materials;
    assert_int_equal(desc.MATERIALS_count, 2);
    assert_int_equal(desc.TRIANGLES_count, 2);
#define ADD_CHUNK(NAME, field, bytes) \
    desc.field = bytes;               \
    desc.NAME##_count = sizeof(bytes) / sizeof(*desc.field);
#define ADD_RECORD(NAME, field, record) \
    desc.field = &record;               \
    desc.NAME##_count = 1;
    ADD_RECORD(NODES, nodes, node)
    ADD_RECORD(SURFACES, surfaces, surface)
    ADD_RECORD(TEXTURES, textures, texture)
    ADD_RECORD(IMAGES, images, image)
    ADD_CHUNK(PIXELS, pixels, pixels)
    ADD_RECORD(ATTRIBUTES, attributes, attributes)
    ADD_CHUNK(NORMALS, normals, normals)
    ADD_CHUNK(TEXCOORDS, texcoords, texcoords)
    ADD_CHUNK(COLORS, colors, colors)
    ADD_RECORD(LAMPS, lamps, lamp)
    ADD_RECORD(ANIMATIONS, animations, animation)
    ADD_CHUNK(CHANNELS, channels, channels)
    ADD_CHUNK(KEYS, keys, keys)
#undef ADD_RECORD
#undef ADD_CHUNK
    char path[64];
    snprintf(path, sizeof(path), "%s/looks.lspace", folder);
    const LsFileDesc* const descs[2] = {&plain, &desc};
    uint64_t device_bytes[2], copied_bytes[2];
    for (int i = 0; i < 2; i++)
    {
        assert_int_equal(ls_file_write(descs[i], path, &error), LS_OK);
        LsGpu faked;
        open_faked(&faked, (LsFakeVulkan){.separate_memory = gpu.device.is_cpu});
        LsGpuScene scene;
        ls_gpu_scene_open(&faked, &scene, path);
        assert_int_equal(ls_file_count(&scene.file, LS_CHUNK_PIXELS), i * 64 * 32);
        device_bytes[i] = ls_scene_device_bytes(scene.scene);
        copied_bytes[i] = ls_fake_vulkan.copied_bytes;
        LsHit hit;
        LsRay ray = ray_down(0.75f, 0.25f);
        ls_gpu_trace(&faked, &scene, LS_TRACE_EXACT, 0, &ray, NULL, 1, &hit);
        check_hit(hit, (LsHit){.t = 1, .u = 0.5f, .v = 0.25f, .primitive = 0, .material = 0});
        ls_gpu_scene_close(&scene);
        close_faked(&faked);
    }
    assert_int_equal(copied_bytes[0], device_bytes[0]);
    assert_int_equal(device_bytes[1], device_bytes[0]);
    assert_int_equal(copied_bytes[1], copied_bytes[0]);
    ls_mapping_close(&mapping);
    unlink(path);
}

static void check_context_refused(LsFakeVulkan fake, LsMessage message, const char* named)
{
    LsContextDesc desc = fake_desc(fake);
    LsContext* context = (LsContext*)&desc;
    LsError error;
    assert_int_equal(ls_context_create(&desc, &context, &error), message / 100);
    assert_int_equal(error.message, message);
    assert_null(context);
    assert_non_null(strstr(error.text, named));
    assert_null(strchr(error.text, '\n'));
    assert_int_equal(ls_fake_vulkan.live_objects, 0);
}

static void test_devices_that_lack_something(void** state)
{
    (void)state;
    check_context_refused((LsFakeVulkan){.no_buffer_address = true},
                          LS_MESSAGE_DEVICE_BUFFER_ADDRESS, "bufferDeviceAddress");
    check_context_refused((LsFakeVulkan){.no_buffer_address = true},
                          LS_MESSAGE_DEVICE_BUFFER_ADDRESS, gpu.device.name);
    check_context_refused((LsFakeVulkan){.no_compute = true}, LS_MESSAGE_DEVICE_COMPUTE,
                          "cannot compute");
    check_context_refused((LsFakeVulkan){.api_version = VK_API_VERSION_1_1},
                          LS_MESSAGE_DEVICE_VERSION, "1.1");
    check_context_refused((LsFakeVulkan){.missing_function = "vkGetDeviceProcAddr"},
                          LS_MESSAGE_VULKAN_FUNCTION, "vkGetDeviceProcAddr");
    check_context_refused((LsFakeVulkan){.missing_function = "vkCmdDispatch"},
                          LS_MESSAGE_VULKAN_FUNCTION, "vkCmdDispatch");
}

// The programs ask the loader's own functions before they create a device.
static void check_program_refused(LsFakeVulkan fake, LsMessage message, const char* named)
{
    ls_fake_vulkan = fake;
    LsAppDevice device;
    LsAppDeviceDesc desc = {0};
    LsError error;
    assert_int_equal(ls_app_device_create(&device, &desc, &error), message / 100);
    assert_int_equal(error.message, message);
    assert_null(device.instance);
    assert_non_null(strstr(error.text, named));
    assert_null(strchr(error.text, '\n'));
}

static void test_programs_without_a_fit_device(void** state)
{
    (void)state;
    check_program_refused((LsFakeVulkan){.no_devices = true}, LS_MESSAGE_DEVICE_NONE,
                          "no Vulkan device was found");
    check_program_refused((LsFakeVulkan){.api_version = VK_API_VERSION_1_1},
                          LS_MESSAGE_DEVICE_VERSION, "lacks Vulkan 1.2");
    check_program_refused((LsFakeVulkan){.no_buffer_address = true},
                          LS_MESSAGE_DEVICE_BUFFER_ADDRESS, "lacks bufferDeviceAddress");
    check_program_refused((LsFakeVulkan){.no_compute = true}, LS_MESSAGE_DEVICE_COMPUTE,
                          "lacks a compute queue");
    ls_fake_vulkan = (LsFakeVulkan){0};
    LsAppDevice device;
    LsAppDeviceDesc desc = {0};
    LsError error;
    assert_int_equal(ls_app_device_create(&device, &desc, &error), LS_OK);
    ls_app_device_destroy(&device);
}

static void check_scene_refused(LsFakeVulkan fake, LsMessage message, const char* named)
{
    LsGpu faked;
    open_faked(&faked, fake);
    LsMapping mapping;
    LsFile file;
    LsError error;
    assert_int_equal(ls_mapping_open(&mapping, paths[LS_SMALL_LARGE], &error), LS_OK);
    assert_int_equal(ls_file_open(&file, mapping.bytes, mapping.size, "large.lspace", &error),
                     LS_OK);
    LsScene* scene;
    assert_int_equal(ls_scene_create(faked.context, &file, "large.lspace", &scene, &error),
                     message / 100);
    assert_int_equal(error.message, message);
    assert_null(scene);
    assert_non_null(strstr(error.text, named));
    ls_mapping_close(&mapping);
    close_faked(&faked);
}

static void test_no_kind_of_memory(void** state)
{
    (void)state;
    check_scene_refused((LsFakeVulkan){.no_memory = true}, LS_MESSAGE_DEVICE_MEMORY_KIND,
                        "large.lspace: the device has no kind of memory");
}

static void test_array_larger_than_a_buffer(void** state)
{
    (void)state;
    check_scene_refused(
        (LsFakeVulkan){.max_allocation_bytes = 14 << 20}, LS_MESSAGE_DEVICE_BUFFER_LIMIT,
        "large.lspace: TRIANGLES takes 15.2 MiB, but the device's largest buffer is "
        "14.0 MiB");
    // The programs' own buffers have the same limit.
    LsAppDevice small = gpu.device;
    small.max_buffer_bytes = 1 << 20;
    LsAppTracer tracer;
    LsError error;
    assert_int_equal(ls_app_tracer_create(&small, 1 << 20, &tracer, &error),
                     LS_ERROR_DEVICE_MEMORY);
    assert_int_equal(error.message, LS_MESSAGE_DEVICE_BUFFER_LIMIT);
}

// Two instances of the large list are more than llvmpipe can loop over.
static void test_brute_force_beyond_the_loops(void** state)
{
    (void)state;
    LsMapping mapping;
    LsFile file;
    LsError error;
    assert_int_equal(ls_mapping_open(&mapping, paths[LS_SMALL_LARGE], &error), LS_OK);
    assert_int_equal(ls_file_open(&file, mapping.bytes, mapping.size, "large.lspace", &error),
                     LS_OK);
    LsFileDesc desc = ls_file_desc(&file);
    const LsInstance instances[2] = {file.instances[0], file.instances[0]};
    const float side = LS_LARGE_SIDE;
    const LsBvhNode nodes[3] = {
        {.upper = {side, side, 0}, .escape = 3},
        {.upper = {side, side, 0}, .escape = 2, .leaf = 0 << 4 | 1},
        {.upper = {side, side, 0}, .escape = 3, .leaf = 1 << 4 | 1},
    };
    desc.instances = instances;
    desc.INSTANCES_count = 2;
    desc.top_nodes = nodes;
    desc.TOP_NODES_count = 3;
    char path[64];
    snprintf(path, sizeof(path), "%s/twice.lspace", folder);
    assert_int_equal(ls_file_write(&desc, path, &error), LS_OK);
    ls_mapping_close(&mapping);

    for (int i = 0; i < 2; i++)
    {
        LsGpu faked;
        open_faked(&faked, (LsFakeVulkan){.driver = i == 0 ? VK_DRIVER_ID_MESA_LLVMPIPE
                                                           : VK_DRIVER_ID_MESA_RADV});
        LsGpuScene scene;
        ls_gpu_scene_open(&faked, &scene, path);
        LsAppRun run = {.ray_count = 1, .method = LS_TRACE_BRUTE};
        gpu.tracer.rays[0] = ray_down(0.25f, 0.5f);
        LsResult result =
            ls_app_tracer_run(&gpu.device, &gpu.tracer, scene.scene, &run, NULL, &error);
        // llvmpipe is refused beforehand; if it goes by another name, its answer is.
        if (i == 0 || result != LS_OK)
        {
            assert_int_equal(result, LS_ERROR_DEVICE_FEATURE);
            assert_int_equal(error.message, LS_MESSAGE_DEVICE_LOOPS);
            assert_non_null(strstr(error.text, i == 0 ? "choose a GPU" : "ended the loops"));
            assert_true(i == 0 || gpu.device.is_cpu);
        }
        ls_gpu_scene_close(&scene);
        close_faked(&faked);
    }
    unlink(path);
}

// Creates and destroys a context and a scene. Whatever fails, nothing may be left.
static LsResult run_once(const LsContextDesc* desc, const LsFile* file, LsError* error)
{
    LsContext* context;
    LsResult result = ls_context_create(desc, &context, error);
    if (result != LS_OK)
    {
        assert_null(context);
        return result;
    }
    LsScene* scene;
    result = ls_scene_create(context, file, "small.lspace", &scene, error);
    if (result != LS_OK)
    {
        assert_null(scene);
    }
    ls_scene_destroy(scene);
    ls_context_destroy(context);
    return result;
}

// Lets the first call fail, then the second, and so on until none is left to fail.
static uint32_t fail_each_call(bool separate_memory)
{
    static const struct
    {
        VkResult code;
        LsMessage message;
    } FAILURES[] = {
        {VK_ERROR_OUT_OF_DEVICE_MEMORY, LS_MESSAGE_DEVICE_MEMORY_FULL},
        {VK_ERROR_OUT_OF_HOST_MEMORY, LS_MESSAGE_OUT_OF_MEMORY},
        {VK_ERROR_DEVICE_LOST, LS_MESSAGE_DEVICE_LOST},
        {VK_ERROR_INITIALIZATION_FAILED, LS_MESSAGE_VULKAN_CALL},
    };
    LsMapping mapping;
    LsFile file;
    LsError error;
    assert_int_equal(ls_mapping_open(&mapping, paths[LS_SMALL_LIST], &error), LS_OK);
    assert_int_equal(ls_file_open(&file, mapping.bytes, mapping.size, "small.lspace", &error),
                     LS_OK);
    uint32_t n = 0;
    for (;; n++)
    {
        LsFakeVulkan fake = {
            .count_down = true,
            .remaining_calls = n,
            .failure = FAILURES[n % 4].code,
            .separate_memory = separate_memory,
        };
        LsContextDesc desc = fake_desc(fake);
        LsResult result = run_once(&desc, &file, &error);
        assert_int_equal(ls_fake_vulkan.live_objects, 0);
        if (!ls_fake_vulkan.failed_call)
        {
            assert_int_equal(result, LS_OK);
            break;
        }
        assert_int_equal(error.message, FAILURES[n % 4].message);
        assert_int_equal(result, error.message / 100);
        assert_int_equal(error.result, result);
        assert_non_null(strstr(error.text, ls_fake_vulkan.failed_call));
        assert_null(strchr(error.text, '\n'));
    }
    ls_mapping_close(&mapping);
    return n;
}

static void test_each_call_fails_once(void** state)
{
    (void)state;
    // A layout; a module and a pipeline for each of two methods; five buffers of four calls each.
    if (gpu.device.is_cpu)
    {
        assert_int_equal(fail_each_call(false), 1 + 2 * 2 + 5 * 4);
    }
    // Nothing is mapped but the ring (four calls, pool, commands, three fences); each array is
    // begun, ended, submitted; five waits and resets, for the ring has three slots.
    assert_int_equal(fail_each_call(gpu.device.is_cpu),
                     1 + 2 * 2 + 5 * 3 + 4 + 1 + 1 + 3 + 5 * 3 + 5 * 2);
}

// A device that ends loops early says so, and no wrong answer gets through; others answer.
static void test_more_rounds_than_a_device_has(void** state)
{
    (void)state;
    LsGpuScene scene;
    ls_gpu_scene_open(&gpu, &scene, paths[LS_SMALL_MANY]);
    gpu.tracer.rays[0] = ray_down(0.25f, 0.75f);
    LsAppRun run = {.ray_count = 1, .method = LS_TRACE_EXACT};
    double seconds;
    LsError error;
    LsResult result =
        ls_app_tracer_run(&gpu.device, &gpu.tracer, scene.scene, &run, &seconds, &error);
    if (result == LS_OK)
    {
        assert_int_equal(gpu.tracer.hits[0].instance, LS_MANY_INSTANCES - 1);
        assert_int_equal(gpu.tracer.hits[0].flags, 0);
    }
    else
    {
        assert_int_equal(result, LS_ERROR_DEVICE_FEATURE);
        assert_int_equal(error.message, LS_MESSAGE_DEVICE_LOOPS);
        assert_true(gpu.device.is_cpu);
        assert_int_equal(gpu.tracer.hits[0].flags, LS_HIT_CUT);
    }
    ls_gpu_scene_close(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_more_rounds_than_a_device_has),
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
        cmocka_unit_test(test_many_dispatches),
        cmocka_unit_test(test_staging),
        cmocka_unit_test(test_devices_that_lack_something),
        cmocka_unit_test(test_array_larger_than_a_buffer),
        cmocka_unit_test(test_brute_force_beyond_the_loops),
        cmocka_unit_test(test_programs_without_a_fit_device),
        cmocka_unit_test(test_no_kind_of_memory),
        cmocka_unit_test(test_looks_stay_in_the_file),
        cmocka_unit_test(test_each_call_fails_once),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
