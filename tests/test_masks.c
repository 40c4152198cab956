// test_masks.c - masks answer alike in every layout: a baked file, whose masks are of exact width, and
// the same with masks of 4, 8, 16 and 32 bits, as before format 0.3.

#include "baked.h"
#include "file_fixture.h"
#include "gpu.h"
#include "ray_sets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RAYS 20000u

static LsGpu gpu;

// Voxels of a file by the log2 of their masks' width.
static void count_widths(const LsFile* file, uint32_t counts[6])
{
    memset(counts, 0, 6 * sizeof(*counts));
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_VOXELS); i++)
    {
        const uint32_t shape = file->voxels[i].shape;
        counts[shape >> 16 & 7] += (shape & 255) == LS_VOXEL_MASKS;
    }
}

static LsHit* trace_file(const char* path, const LsRaySet* set)
{
    LsGpuScene scene;
    ls_gpu_scene_open(&gpu, &scene, path);
    LsHit* hits = calloc(set->count, sizeof(LsHit));
    assert_non_null(hits);
    ls_gpu_trace(&gpu, &scene, LS_TRACE_EXACT, 0, set->rays, NULL, set->count, hits);
    ls_gpu_scene_close(&scene);
    return hits;
}

static void test_layouts_answer_alike(void** state)
{
    (void)state;
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_TEAPOT);
    LsBaked baked;
    ls_baked_open(&baked, &mesh, "masks", LS_TEST_INSTANCES, 12, 3, 0);
    uint32_t exact_counts[6], padded_counts[6];
    count_widths(&baked.file, exact_counts);
    assert_true((baked.file.header->required_features & LS_FEATURE_EXACT_MASKS) != 0);

    const LsFileDesc desc = ls_file_desc(&baked.file);
    LsShaftLayout padded = ls_mask_layout(&desc, false);
    char directory[LS_SCRATCH_PATH], path[LS_SCRATCH_PATH + 32];
    ls_scratch_create(directory);
    snprintf(path, sizeof path, "%s/padded.lspace", directory);
    assert_int_equal(ls_file_write(&padded.desc, path, NULL), LS_OK);
    LsFixtureBytes bytes = ls_fixture_read(path);
    LsFile file;
    assert_int_equal(ls_file_open(&file, bytes.bytes, bytes.size, path, NULL), LS_OK);
    assert_int_equal(file.header->version_minor, 1);
    count_widths(&file, padded_counts);
    for (int width = 2; width <= 5; width++)
    {
        assert_true(padded_counts[width] > 10);
        assert_int_equal(exact_counts[width], 0);
    }
    ls_fixture_free(&bytes);

    LsRaySet set = ls_ray_set_make(&baked.file, RAYS, 3);
    LsHit* exact_hits = trace_file(baked.path, &set);
    LsHit* padded_hits = trace_file(path, &set);
    assert_memory_equal(exact_hits, padded_hits, RAYS * sizeof(LsHit));
    uint32_t hit_count = 0;
    for (uint32_t i = 0; i < RAYS; i++)
    {
        hit_count += exact_hits[i].instance != LS_NONE;
    }
    assert_true(hit_count > RAYS / 10);
    free(exact_hits);
    free(padded_hits);
    ls_ray_set_destroy(&set);
    ls_shaft_layout_destroy(&padded);
    ls_scratch_remove(directory);
    ls_baked_close(&baked);
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
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_layouts_answer_alike)};
    return cmocka_run_group_tests_name("masks", tests, open_device, close_device);
}
