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
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

LsGpu gpu;
char folder[] = "/tmp/ls_test_runtime_XXXXXX";
char paths[LS_SMALL_COUNT][64];

void open_fixture(void)
{
    assert_non_null(mkdtemp(folder));
    for (int i = 0; i < LS_SMALL_COUNT; i++)
    {
        snprintf(paths[i], sizeof(paths[i]), "%s/%d.lspace", folder, i);
        ls_small_scene_write((LsSmallScene)i, paths[i]);
    }
    ls_gpu_open(&gpu);
}

int close_fixture(void)
{
    ls_gpu_close(&gpu);
    for (int i = 0; i < LS_SMALL_COUNT; i++)
    {
        unlink(paths[i]);
    }
    return rmdir(folder);
}

void open_small_file(LsSmallScene id, const char* name, LsMapping* mapping, LsFile* file)
{
    assert_int_equal(ls_mapping_open(mapping, paths[id], NULL), LS_OK);
    assert_int_equal(ls_file_open(file, mapping->bytes, mapping->size, name, NULL), LS_OK);
}

LsRay make_ray(LsVec3 origin, LsVec3 direction)
{
    return (LsRay){.origin = origin, .direction = direction, .tmax = INFINITY};
}

LsRay ray_down(float x, float y)
{
    return make_ray((LsVec3){x, y, 1}, (LsVec3){0, 0, -1});
}

void check_hit(LsHit hit, LsHit expected)
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
