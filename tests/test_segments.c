// test_segments.c - arrays cut into segments give the answers of whole ones, bit for bit: hits of
// every method and pictures. Segments of 1 KiB, the smallest there are, so that small scenes have
// many of each array.

#include "baked.h"
#include "gpu.h"
#include "ray_sets.h"
#include "render.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <stdlib.h>
#include <string.h>

#define SEGMENT_LOG2 10u
#define RAYS 4000u

// Whole arrays, and the same device with a context that cuts them.
static LsGpu whole, cut;

static int open_device(void** state)
{
    (void)state;
    ls_gpu_open(&whole);
    cut = whole;
    LsContextDesc desc = ls_app_context_desc(&whole.device);
    desc.measures = true;
    desc.segment_bytes = (2u << SEGMENT_LOG2) - 1; // rounded down
    LsError error;
    ls_require(ls_context_create(&desc, &cut.context, &error), &error);
    return 0;
}

static int close_device(void** state)
{
    (void)state;
    ls_context_destroy(cut.context);
    ls_gpu_close(&whole);
    return 0;
}

static void compare_hits(const LsGpuScene* whole_scene, const LsGpuScene* cut_scene)
{
    LsRaySet set = ls_ray_set_make(&whole_scene->file, RAYS, 5);
    LsHit* expected = calloc(RAYS, sizeof(LsHit));
    LsHit* hits = calloc(RAYS, sizeof(LsHit));
    assert_non_null(expected);
    assert_non_null(hits);
    static const LsMethod METHODS[] = {LS_TRACE_EXACT, LS_TRACE_GRID, LS_TRACE_COUNT,
                                       LS_TRACE_BRUTE};
    for (int m = 0; m < 4; m++)
    {
        // Brute force over the larger scenes takes too long for all rays.
        const uint32_t count = METHODS[m] == LS_TRACE_BRUTE ? RAYS / 10 : RAYS;
        ls_gpu_trace(&whole, whole_scene, METHODS[m], 0, set.rays, NULL, count, expected);
        ls_gpu_trace(&cut, cut_scene, METHODS[m], 0, set.rays, NULL, count, hits);
        assert_memory_equal(hits, expected, count * sizeof(LsHit));
    }
    ls_gpu_trace(&whole, whole_scene, LS_TRACE_EXACT, 0, set.rays, NULL, RAYS, expected);
    uint32_t hit_count = 0;
    for (uint32_t i = 0; i < RAYS; i++)
    {
        hit_count += expected[i].instance != LS_NONE;
    }
    assert_true(hit_count > RAYS / 20);
    free(expected);
    free(hits);
    ls_ray_set_destroy(&set);
}

static float* render_picture(LsGpu* gpu, const LsGpuScene* scene, size_t* bytes)
{
    const uint32_t width = 32, height = 24;
    LsError error = {0};
    LsRender* render;
    ls_require(ls_render_create(&gpu->device, scene->scene, &scene->file, &render, &error), &error);
    const LsRenderSettings settings = {
        .camera = ls_render_camera(&scene->file, (double)width / height),
        .width = width,
        .height = height,
        .depth = 3,
    };
    ls_require(ls_render_set(render, &settings, NULL, &error), &error);
    ls_require(ls_render_step(render, 2, &error), &error);
    *bytes = sizeof(LsVec4) * width * height;
    float* rgba = malloc(*bytes);
    assert_non_null(rgba);
    ls_require(ls_render_read(render, rgba, &error), &error);
    ls_render_destroy(render);
    return rgba;
}

static void compare_pictures(const LsGpuScene* whole_scene, const LsGpuScene* cut_scene)
{
    size_t bytes;
    float* expected = render_picture(&whole, whole_scene, &bytes);
    float* picture = render_picture(&cut, cut_scene, &bytes);
    assert_memory_equal(picture, expected, bytes);
    free(expected);
    free(picture);
}

// Segments of an array of this file.
static uint64_t count_segments(const LsFile* file, LsChunk chunk)
{
    uint64_t records = 1;
    while (2 * records * ls_chunk_info(chunk).stride <= 1u << SEGMENT_LOG2)
    {
        records *= 2;
    }
    return (ls_file_count(file, chunk) + records - 1) / records;
}

// Compares all answers, and notes the most segments that any file so far has had of each array.
static void compare_scene(LsTestMeshId id, LsTestPlacement placement, uint32_t grid,
                          uint32_t scene_patches, uint64_t most[LS_CHUNK_COUNT])
{
    LsTestMesh mesh = ls_test_mesh_make(id);
    LsBaked baked;
    const LsBakeDesc desc = {.grid = grid, .patches = 2, .scene_patches = scene_patches};
    ls_baked_open_desc(&baked, &mesh, "segments", placement, &desc);
    for (LsChunk chunk = 0; chunk < LS_CHUNK_COUNT; chunk++)
    {
        const uint64_t count = count_segments(&baked.file, chunk);
        most[chunk] = count > most[chunk] ? count : most[chunk];
    }
    LsGpuScene whole_scene, cut_scene;
    ls_gpu_scene_open(&whole, &whole_scene, baked.path);
    ls_gpu_scene_open(&cut, &cut_scene, baked.path);
    assert_int_equal(ls_scene_segment_log2(whole_scene.scene), 0);
    assert_int_equal(ls_scene_segment_log2(cut_scene.scene), SEGMENT_LOG2);
    assert_true(ls_scene_device_bytes(cut_scene.scene) >
                ls_scene_device_bytes(whole_scene.scene)); // by the tables
    compare_hits(&whole_scene, &cut_scene);
    compare_pictures(&whole_scene, &cut_scene);
    ls_gpu_scene_close(&cut_scene);
    ls_gpu_scene_close(&whole_scene);
    ls_baked_close(&baked);
    ls_test_mesh_destroy(&mesh);
}

static void test_segments_answer_alike(void** state)
{
    (void)state;
    uint64_t most[LS_CHUNK_COUNT] = {0};
    compare_scene(LS_TEST_MESH_TEAPOT, LS_TEST_INSTANCES, 56, 5, most);
    compare_scene(LS_TEST_MESH_BUNNY, LS_TEST_ALONE, 10, 0, most); // hundreds of sub-grids
    compare_scene(LS_TEST_MESH_HUB, LS_TEST_ALONE, 8, 3, most);    // BVHs in voxels
    static const LsChunk LARGE[] = {LS_CHUNK_TRIANGLES,  LS_CHUNK_BLOCKS, LS_CHUNK_CELL_BLOCKS,
                                    LS_CHUNK_SUBGRIDS,   LS_CHUNK_VOXELS, LS_CHUNK_REFERENCES,
                                    LS_CHUNK_LEAF_NODES, LS_CHUNK_SHAFTS};
    for (size_t i = 0; i < sizeof LARGE / sizeof *LARGE; i++)
    {
        if (most[LARGE[i]] < 3)
        {
            fail_msg("%s: %u segments at most", ls_chunk_info(LARGE[i]).name,
                     (unsigned)most[LARGE[i]]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_segments_answer_alike)};
    return cmocka_run_group_tests_name("segments", tests, open_device, close_device);
}
