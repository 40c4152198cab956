// test_lists.c - scenes of one grid among lists, as rooms have walls and lights: in two passes and
// in one, the answers are those of brute force. Lists of odd and even counts, of one triangle, of as
// many as lsbake makes and of more; as they lie, turned, scaled and mirrored; far from the origin of
// their own space; behind masks. And the kernels of devices that bound no loops, batches that take
// several dispatches, and calls that fail while the tables of lists are made.

#include "baked.h"
#include "context.h"
#include "fake_vulkan.h"
#include "gpu.h"
#include "ls_write.h"
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

#define FOLDER LS_BINARY_DIR "/test_scenes"
#define MAX_INPUTS 8u

static LsGpu gpu;
static const char BAKED[] = FOLDER "/lists.lspace";
static const char EDITED[] = FOLDER "/lists-edited.lspace";

static void* allocate(size_t bytes)
{
    void* memory = malloc(bytes);
    assert_non_null(memory);
    return memory;
}

// ---- The scene ----------------------------------------------------------------------------------

// Parallelograms of two triangles each, every other one a square across an axis, of the last maybe
// half, in a box of `size` whose lower corner is at `corner` along each axis.
static LsTestMesh make_list(uint32_t triangle_count, double corner, double size, uint64_t seed)
{
    LsRandom random = {seed};
    LsTestMesh mesh = {
        .positions = allocate(triangle_count * 9 * sizeof(float)),
        .indices = allocate(triangle_count * 3 * sizeof(uint32_t)),
        .vertex_count = triangle_count * 3,
        .triangle_count = triangle_count,
    };
    for (uint32_t i = 0; i < triangle_count; i += 2)
    {
        const uint32_t axis = ls_random_below(&random, 3);
        const bool is_straight = i % 4 == 0;
        for (uint32_t k = 0; k < 3; k++)
        {
            const double from = ls_random_between(&random, 0.0, 0.5 * size);
            const double along = is_straight ? (k == axis ? 0.5 * size : 0.0)
                                             : ls_random_between(&random, 0.0, 0.5 * size);
            const double across = is_straight ? (k == (axis + 1) % 3 ? 0.5 * size : 0.0)
                                              : ls_random_between(&random, 0.0, 0.5 * size);
            float* corners = &mesh.positions[9 * i + k];
            corners[0] = (float)(corner + from);
            corners[3] = (float)(corner + from + along);
            corners[6] = (float)(corner + from + across);
            if (i + 1 < triangle_count) // the other half
            {
                corners[9] = corners[3];
                corners[12] = (float)(corner + from + along + across);
                corners[15] = corners[6];
            }
        }
    }
    for (uint32_t i = 0; i < mesh.vertex_count; i++)
    {
        mesh.indices[i] = i;
    }
    return mesh;
}

typedef struct Inputs
{
    char paths[MAX_INPUTS][512];
    LsBakeInput inputs[MAX_INPUTS];
    uint32_t count;
} Inputs;

static void add_mesh(Inputs* inputs, LsTestMesh mesh, LsBakeInput place)
{
    char* path = inputs->paths[inputs->count];
    snprintf(path, sizeof inputs->paths[0], FOLDER "/lists-%u.ply", inputs->count);
    ls_test_mesh_write_ply(&mesh, path);
    ls_test_mesh_destroy(&mesh);
    place.path = path;
    inputs->inputs[inputs->count++] = place;
}

static void bake_scene(void)
{
    static Inputs inputs;
    add_mesh(&inputs, make_list(32, -1.0, 2.0, 1), (LsBakeInput){0});
    add_mesh(&inputs, make_list(9, -0.6, 1.4, 2), (LsBakeInput){0});
    add_mesh(&inputs, make_list(1, -0.2, 0.7, 6), (LsBakeInput){0});
    add_mesh(&inputs, ls_test_mesh_make(LS_TEST_MESH_TEAPOT),
             (LsBakeInput){.size = 1.0, .is_at = true, .at = {0.0, -1.0, 0.0}});
    add_mesh(&inputs, make_list(31, 0.0, 1.0, 3),
             (LsBakeInput){.size = 1.7, .turn = 33.0, .is_at = true, .at = {0.2, -0.9, -0.1}});
    add_mesh(&inputs, make_list(12, 0.0, 1.0, 4),
             (LsBakeInput){.turn = 200.0, .is_at = true, .at = {-0.4, -0.2, 0.3}});
    // Coordinates a hundred thousand times as large as the mesh.
    add_mesh(&inputs, make_list(7, 1e5, 1.0, 5),
             (LsBakeInput){.size = 0.8, .is_at = true, .at = {0.5, 0.1, 0.5}});
    const LsBakeDesc desc = {
        .inputs = inputs.inputs,
        .input_count = inputs.count,
        .output = BAKED,
        .grid = 20,
        .patches = 3,
        .force = true,
    };
    LsBakeReport report;
    LsError error;
    ls_require(ls_bake_run(&desc, &report, &error), &error);
    ls_bake_report_destroy(&report);
    for (uint32_t i = 0; i < inputs.count; i++)
    {
        remove(inputs.paths[i]);
    }
}

static int set_up(void** state)
{
    (void)state;
    ls_gpu_open(&gpu);
    bake_scene();
    return 0;
}

static int tear_down(void** state)
{
    (void)state;
    remove(BAKED);
    remove(EDITED);
    ls_gpu_close(&gpu);
    return 0;
}

// The baked file once more, with arrays that a test may change.
typedef struct Edited
{
    LsMapping mapping;
    LsFile file;
    LsFileDesc desc;
    LsInstance* instances;
    LsObject* objects;
    LsTriangle* triangles;
    LsBvhNode* nodes;
} Edited;

static void* copy(const void* records, size_t bytes)
{
    return memcpy(allocate(bytes), records, bytes);
}

static Edited begin_edit(void)
{
    Edited edited = {0};
    LsError error;
    ls_require(ls_mapping_open(&edited.mapping, BAKED, &error), &error);
    ls_require(ls_file_open(&edited.file, edited.mapping.bytes, edited.mapping.size, BAKED, &error),
               &error);
    LsFileDesc* desc = &edited.desc;
    *desc = ls_file_desc(&edited.file);
    edited.instances = copy(desc->instances, desc->INSTANCES_count * sizeof *edited.instances);
    edited.objects = copy(desc->objects, desc->OBJECTS_count * sizeof *edited.objects);
    edited.triangles = copy(desc->triangles, desc->TRIANGLES_count * sizeof *edited.triangles);
    edited.nodes = copy(desc->top_nodes, desc->TOP_NODES_count * sizeof *edited.nodes);
    desc->instances = edited.instances;
    desc->objects = edited.objects;
    desc->triangles = edited.triangles;
    desc->top_nodes = edited.nodes;
    return edited;
}

static void end_edit(Edited* edited)
{
    LsError error;
    ls_require(ls_file_write(&edited->desc, EDITED, &error), &error);
    free(edited->instances);
    free(edited->objects);
    free(edited->triangles);
    free(edited->nodes);
    ls_mapping_close(&edited->mapping);
}

// Every box of the top level holds all of the scene.
static void widen_nodes(Edited* edited, LsVec3 lower, LsVec3 upper)
{
    for (uint32_t i = 0; i < edited->desc.TOP_NODES_count; i++)
    {
        edited->nodes[i].lower = lower;
        edited->nodes[i].upper = upper;
    }
}

// ---- Rays ---------------------------------------------------------------------------------------

// Traces a scene's rays by `device`, where ls_gpu_trace compares one pass with two, and by the true
// one through brute force.
static void check_rays(LsGpu* device, const char* path, uint32_t count, uint32_t flags,
                       bool has_masks)
{
    LsGpuScene scene, brute;
    ls_gpu_scene_open(device, &scene, path);
    ls_gpu_scene_open(&gpu, &brute, path);
    // Two passes wherever subgroups allow it.
    assert_int_equal(ls_trace_scratch_bytes(scene.scene, 1) != 0,
                     device->context->shared_lanes != 0);
    LsRaySet set = ls_ray_set_make(&scene.file, count, 7 + flags);
    LsHit* expected = allocate(count * sizeof *expected);
    LsHit* hits = allocate(count * sizeof *hits);
    uint32_t* masks = has_masks ? allocate(count * sizeof *masks) : NULL;
    LsRandom random = {9};
    for (uint32_t i = 0; masks && i < count; i++)
    {
        masks[i] = ls_random_below(&random, 16);
    }
    ls_gpu_trace(&gpu, &brute, LS_TRACE_BRUTE, flags, set.rays, masks, count, expected);
    ls_gpu_trace(device, &scene, LS_TRACE_EXACT, flags, set.rays, masks, count, hits);
    uint32_t list_hits = 0;
    uint32_t grid_hits = 0;
    for (uint32_t i = 0; i < count; i++)
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
        const bool is_grid =
            is_hit && scene.file.objects[expected[i].object].kind == LS_OBJECT_GRID;
        grid_hits += is_grid;
        list_hits += is_hit && !is_grid;
    }
    print_message("flags %u: %u rays, %u hits of lists, %u of the grid\n", flags, count, list_hits,
                  grid_hits);
    assert_true(list_hits > count / 10 && grid_hits > count / 100);
    free(masks);
    free(hits);
    free(expected);
    ls_ray_set_destroy(&set);
    ls_gpu_scene_close(&brute);
    ls_gpu_scene_close(&scene);
}

static void check_flags(const char* path, bool has_masks)
{
    check_rays(&gpu, path, 8000, 0, has_masks);
    check_rays(&gpu, path, 8000, LS_RAY_FLAG_ANY_HIT, has_masks);
    check_rays(&gpu, path, 8000, LS_RAY_FLAG_CULL_BACK_FACING, has_masks);
}

static void test_lists_about_a_grid(void** state)
{
    (void)state;
    check_flags(BAKED, false);
}

static void test_masks(void** state)
{
    (void)state;
    Edited edited = begin_edit();
    for (uint32_t i = 0; i < edited.desc.INSTANCES_count; i++)
    {
        edited.instances[i].mask = 1u << i % 4;
    }
    end_edit(&edited);
    check_flags(EDITED, true);
}

// The world in a mirror, x for -x.
static void test_mirrored(void** state)
{
    (void)state;
    Edited edited = begin_edit();
    for (uint32_t i = 0; i < edited.desc.INSTANCES_count; i++)
    {
        LsInstance* instance = &edited.instances[i];
        for (uint32_t row = 0; row < 3; row++)
        {
            instance->object_from_world[row].x = -instance->object_from_world[row].x;
        }
        LsVec4* x = &instance->world_from_object[0];
        *x = (LsVec4){-x->x, -x->y, -x->z, -x->w};
        instance->flags = LS_INSTANCE_MIRRORED;
    }
    for (uint32_t i = 0; i < edited.desc.TOP_NODES_count; i++)
    {
        LsBvhNode* node = &edited.nodes[i];
        const float lower = node->lower.x;
        node->lower.x = -node->upper.x;
        node->upper.x = -lower;
    }
    const float lower = edited.desc.lower[0];
    edited.desc.lower[0] = -edited.desc.upper[0];
    edited.desc.upper[0] = -lower;
    end_edit(&edited);
    check_flags(EDITED, false);
}

// The first two lists, which are not moved, joined to one of 41 triangles.
static void test_long_list(void** state)
{
    (void)state;
    Edited edited = begin_edit();
    LsObject* first = &edited.objects[0];
    LsObject* second = &edited.objects[1];
    assert_int_equal(first->triangle_count, 32);
    assert_int_equal(second->triangle_count, 9);
    assert_int_equal(second->first_triangle, first->first_triangle + 32);
    for (uint32_t i = 0; i < 9; i++)
    {
        edited.triangles[second->first_triangle + i].primitive += first->face_count;
    }
    first->triangle_count = 41;
    first->face_count += second->face_count;
    second->first_triangle += 9;
    second->triangle_count = 0;
    // The first list's box holds the second's.
    LsVec3 lower = edited.nodes[0].lower;
    LsVec3 upper = edited.nodes[0].upper;
    widen_nodes(&edited, lower, upper);
    end_edit(&edited);
    check_flags(EDITED, false);
}

// ---- Devices ------------------------------------------------------------------------------------

static LsContextDesc fake_desc(LsFakeVulkan fake)
{
    ls_fake_vulkan = fake;
    LsContextDesc desc = ls_app_context_desc(&gpu.device);
    desc.measures = true;
    desc.get_instance_proc_addr = ls_fake_get_instance_proc_addr;
    return desc;
}

// A device whose loops are not bounded takes its kernels, in which lanes refill: few rays, since
// llvmpipe bounds them all the same. And dispatches of few groups.
static void test_refilling_lanes_and_slices(void** state)
{
    (void)state;
    LsGpu faked = gpu;
    const LsContextDesc desc =
        fake_desc((LsFakeVulkan){.driver = VK_DRIVER_ID_NVIDIA_PROPRIETARY, .max_group_count = 40});
    LsError error;
    ls_require(ls_context_create(&desc, &faked.context, &error), &error);
    check_rays(&faked, BAKED, 800, 0, false);
    check_rays(&faked, BAKED, 800, LS_RAY_FLAG_ANY_HIT, false);
    check_rays(&faked, BAKED, 800, LS_RAY_FLAG_CULL_BACK_FACING, false);
    ls_context_destroy(faked.context);
    assert_int_equal(ls_fake_vulkan.live_objects, 0);
}

// Each call up to the first kernel fails once, those for the tables of lists among them.
static void test_calls_that_fail(void** state)
{
    (void)state;
    LsMapping mapping;
    LsFile file;
    LsError error;
    ls_require(ls_mapping_open(&mapping, BAKED, &error), &error);
    ls_require(ls_file_open(&file, mapping.bytes, mapping.size, BAKED, &error), &error);
    uint32_t lists = 0;
    bool is_kernel = false;
    for (uint32_t n = 0; !is_kernel; n++)
    {
        const LsContextDesc desc = fake_desc((LsFakeVulkan){
            .count_down = true, .remaining_calls = n, .failure = VK_ERROR_OUT_OF_DEVICE_MEMORY});
        LsContext* context;
        LsScene* scene;
        ls_require(ls_context_create(&desc, &context, &error), &error);
        assert_int_not_equal(ls_scene_create(context, &file, BAKED, &scene, &error), LS_OK);
        assert_null(scene);
        ls_context_destroy(context);
        assert_int_equal(ls_fake_vulkan.live_objects, 0);
        is_kernel = strcmp(ls_fake_vulkan.failed_call, "vkCreateShaderModule") == 0;
        lists += strstr(error.text, "the table of lists") != NULL;
    }
    assert_true(lists > 0 || gpu.context->shared_lanes == 0);
    ls_mapping_close(&mapping);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lists_about_a_grid),
        cmocka_unit_test(test_masks),
        cmocka_unit_test(test_mirrored),
        cmocka_unit_test(test_long_list),
        cmocka_unit_test(test_refilling_lanes_and_slices),
        cmocka_unit_test(test_calls_that_fail),
    };
    return cmocka_run_group_tests_name("lists", tests, set_up, tear_down);
}
