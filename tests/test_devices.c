// The runtime library on devices as they may be: small, slow to reach, lacking something, failing.

#include "fake_vulkan.h"
#include "runtime_fixture.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int set_up(void** state)
{
    (void)state;
    open_fixture();
    return 0;
}

static int tear_down(void** state)
{
    (void)state;
    return close_fixture();
}

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

    ls_gpu_scene_open(&gpu, &scene, paths[LS_SMALL_INSTANCES]);
    ls_gpu_trace(&gpu, &scene, LS_TRACE_EXACT, 0, rays, masks, COUNT, hits[1]);
    ls_gpu_scene_close(&scene);
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
    open_small_file(LS_SMALL_LIST, "small.lspace", &mapping, &file);
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

// Two passes take a group of so many lanes for one subgroup, which only devices can promise whose
// subgroups are all of one size.
static uint64_t count_scratch_bytes(LsFakeVulkan fake)
{
    LsGpu faked = gpu;
    LsContextDesc desc = fake_desc(fake);
    desc.measures = true; // CPUs have the kernels of two passes only then
    assert_int_equal(ls_context_create(&desc, &faked.context, NULL), LS_OK);
    LsGpuScene scene;
    ls_gpu_scene_open(&faked, &scene, paths[LS_SMALL_GRID]);
    const uint64_t bytes = ls_trace_scratch_bytes(scene.scene, 1);
    ls_gpu_scene_close(&scene);
    close_faked(&faked);
    return bytes;
}

static void test_subgroups_of_several_sizes(void** state)
{
    (void)state;
    assert_true(count_scratch_bytes((LsFakeVulkan){.least_lanes = 8, .lanes = 8, .most_lanes = 8}) >
                0);
    assert_int_equal(
        count_scratch_bytes((LsFakeVulkan){.least_lanes = 4, .lanes = 8, .most_lanes = 8}), 0);
    assert_int_equal(
        count_scratch_bytes((LsFakeVulkan){.least_lanes = 8, .lanes = 8, .most_lanes = 16}), 0);
    assert_int_equal(
        count_scratch_bytes((LsFakeVulkan){.least_lanes = 64, .lanes = 64, .most_lanes = 64}), 0);
    // A device of Vulkan 1.2 does not tell.
    assert_int_equal(count_scratch_bytes((LsFakeVulkan){.api_version = VK_API_VERSION_1_2}), 0);
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
    open_small_file(LS_SMALL_LARGE, "large.lspace", &mapping, &file);
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
    check_scene_refused((LsFakeVulkan){.max_allocation_bytes = 100}, LS_MESSAGE_DEVICE_BUFFER_LIMIT,
                        "large.lspace: OBJECTS takes 0.0 MiB, but the device's largest buffer is "
                        "0.0 MiB");
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
    open_small_file(LS_SMALL_LARGE, "large.lspace", &mapping, &file);
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
static uint32_t fail_each_call(LsSmallScene id, uint64_t segment_bytes, bool separate_memory)
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
    open_small_file(id, "small.lspace", &mapping, &file);
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
        desc.segment_bytes = segment_bytes;
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
    // llvmpipe: a layout, a pool and a set of texel buffers, and a view for each of three arrays.
    const uint32_t texels = gpu.device.is_cpu ? 3 + 3 : 0;
    if (gpu.device.is_cpu)
    {
        assert_int_equal(fail_each_call(LS_SMALL_LIST, 0, false), 1 + texels + 2 * 2 + 5 * 4);
        // Traced in lockstep: a kernel more. Ten buffers, of which eight are read as texels.
        assert_int_equal(fail_each_call(LS_SMALL_GRID, 0, false), 1 + 3 + 8 + 3 * 2 + 10 * 4);
        // One of the arrays is cut into six segments and has a table.
        assert_int_equal(fail_each_call(LS_SMALL_LARGE, 4 << 20, false),
                         1 + 2 * 2 + (4 + 6 + 1) * 4);
    }
    // Nothing is mapped but the ring (four calls, pool, commands, three fences); each array is
    // begun, ended, submitted; five waits and resets, for the ring has three slots.
    assert_int_equal(fail_each_call(LS_SMALL_LIST, 0, gpu.device.is_cpu),
                     1 + texels + 2 * 2 + 5 * 3 + 4 + 1 + 1 + 3 + 5 * 3 + 5 * 2);
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
        cmocka_unit_test(test_many_dispatches),
        cmocka_unit_test(test_staging),
        cmocka_unit_test(test_devices_that_lack_something),
        cmocka_unit_test(test_subgroups_of_several_sizes),
        cmocka_unit_test(test_array_larger_than_a_buffer),
        cmocka_unit_test(test_brute_force_beyond_the_loops),
        cmocka_unit_test(test_programs_without_a_fit_device),
        cmocka_unit_test(test_no_kind_of_memory),
        cmocka_unit_test(test_looks_stay_in_the_file),
        cmocka_unit_test(test_each_call_fails_once),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
