// test_scene_shafts.c - signatures of baked files against their definition (SPEC chapter 6): no bit
// is missing where a way from patch to patch lies in a filled cell, and the same bytes for any
// number of threads.

#include "baked.h"
#include "file_fixture.h"
#include "test_random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LINES 20000u // of each case

typedef struct Case
{
    LsTestMeshId mesh;
    LsTestPlacement placement;
    uint32_t grid, scene_patches;
} Case;

static const Case CASES[] = {
    {LS_TEST_MESH_ELEPHANT, LS_TEST_ALONE, 40, 8}, {LS_TEST_MESH_TEAPOT, LS_TEST_INSTANCES, 13, 16},
    {LS_TEST_MESH_STADIUM, LS_TEST_ALONE, 300, 8}, {LS_TEST_MESH_ELEPHANT, LS_TEST_ALONE, 90, 30},
    {LS_TEST_MESH_SLIVERS, LS_TEST_ALONE, 5, 4},   {LS_TEST_MESH_HUB, LS_TEST_ALONE, 1, 2},
};
#define CASE_COUNT (sizeof CASES / sizeof CASES[0])

static bool is_filled(const LsFile* file, const LsObject* object, const uint32_t cell[3])
{
    const uint32_t blocks_x = (object->cells[0] + 3) / 4, blocks_y = (object->cells[1] + 3) / 4;
    const uint32_t index = cell[0] / 4 + blocks_x * (cell[1] / 4 + blocks_y * (cell[2] / 4));
    const uint32_t word = file->blocks[object->first_block + index];
    if ((word & 15) != 0)
    {
        return false;
    }
    const LsCellBlock* block = &file->cell_blocks[object->first_cell_block + (word >> 4)];
    return (block->cells[cell[0] % 4 + 4 * (cell[1] % 4) + 16 * (cell[2] % 4)] & 15) == 0;
}

// Whether a point lies in a filled cell grown by `grow`.
static bool is_near_filled(const LsFile* file, const LsObject* object, const double point[3],
                           double grow)
{
    uint32_t low[3], high[3];
    for (int axis = 0; axis < 3; axis++)
    {
        const double last = object->cells[axis] - 1.0;
        low[axis] = (uint32_t)fmin(fmax(ceil(point[axis] - grow) - 1.0, 0.0), last);
        high[axis] = (uint32_t)fmin(fmax(floor(point[axis] + grow), 0.0), last);
    }
    bool filled = false;
    for (uint32_t z = low[2]; z <= high[2]; z++)
    {
        for (uint32_t y = low[1]; y <= high[1]; y++)
        {
            for (uint32_t x = low[0]; x <= high[0]; x++)
            {
                filled = filled || is_filled(file, object, (uint32_t[3]){x, y, z});
            }
        }
    }
    return filled;
}

// An end of a line: a point of a patch grown by `grow`, often on its border.
typedef struct End
{
    double point[3];
    uint32_t places[3], corners[3]; // by axis, of those in the face: of the patch, and where in it
    uint32_t patch;
} End;

// Half of the coordinates are those of `other`, so that many lines run along an axis.
static End draw_end(LsRandom* random, const LsObject* object, uint32_t face, double grow,
                    const End* other)
{
    const uint32_t patches = object->scene_patches;
    End end = {.patch = 0};
    for (uint32_t k = 0; k < 2; k++)
    {
        const uint32_t axis = ((face >> 1) + 1 + k) % 3;
        const bool is_like = other != NULL && ls_random_below(random, 2) == 0;
        end.places[axis] = is_like ? other->places[axis] : ls_random_below(random, patches);
        end.corners[axis] = is_like ? other->corners[axis] : ls_random_below(random, 4);
        const double side = (double)object->cells[axis] / patches;
        const double low = end.places[axis] * side - grow;
        const double high = (end.places[axis] + 1.0) * side + grow;
        end.point[axis] = end.corners[axis] == 0   ? low
                          : end.corners[axis] == 1 ? high
                                                   : ls_random_between(random, low, high);
        end.patch = end.patch * patches + end.places[axis];
    }
    const double plane = face & 1 ? object->cells[face >> 1] : 0.0;
    end.point[face >> 1] = plane + grow * (ls_random_below(random, 3) - 1.0);
    return end;
}

static void check_line(const LsFile* file, const LsObject* object, LsRandom* random,
                       uint64_t* filled_count, uint64_t* set_count)
{
    const uint32_t first = ls_random_below(random, 5);
    const uint32_t face[2] = {first, first + 1 + ls_random_below(random, 5 - first)};
    const double grow = 2.0 * object->bound;
    const End from = draw_end(random, object, face[0], grow, NULL);
    const End to = draw_end(random, object, face[1], grow, &from);
    const uint32_t count = object->scene_patches * object->scene_patches;
    const uint32_t pair = face[0] * 5 - face[0] * (face[0] - 1) / 2 + face[1] - face[0] - 1;
    const uint32_t shaft = (pair * count + from.patch) * count + to.patch;
    const uint32_t word = file->shafts[object->first_shaft_word + shaft];
    for (uint32_t k = 0; k < LS_SIGNATURE_INTERVALS; k++)
    {
        for (uint32_t step = 0; step <= 8; step++)
        {
            const double f = (k + step / 8.0) / LS_SIGNATURE_INTERVALS;
            double point[3];
            for (int axis = 0; axis < 3; axis++)
            {
                point[axis] = from.point[axis] + f * (to.point[axis] - from.point[axis]);
            }
            if (is_near_filled(file, object, point, grow))
            {
                ++*filled_count;
                assert_int_equal(word >> k & 1, 1);
                break;
            }
        }
        *set_count += word >> k & 1;
    }
}

// Bakes with a number of threads.
static void bake_case(const Case* c, uint32_t threads, LsBaked* baked)
{
    LsTestMesh mesh = ls_test_mesh_make(c->mesh);
    ls_baked_open_desc(
        baked, &mesh, "scene_shafts", c->placement,
        &(LsBakeDesc){.grid = c->grid, .scene_patches = c->scene_patches, .threads = threads});
    ls_test_mesh_destroy(&mesh);
}

static void test_no_bit_is_missing(void** state)
{
    const Case* c = *state;
    LsBaked baked;
    bake_case(c, 0, &baked);
    const LsFile* file = &baked.file;
    LsRandom random = {5};
    uint64_t filled = 0, set = 0;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_OBJECTS); i++)
    {
        const LsObject* object = &file->objects[i];
        assert_int_equal(object->scene_patches,
                         object->kind == LS_OBJECT_GRID ? c->scene_patches : 0);
        for (uint32_t k = 0; k < LINES && object->kind == LS_OBJECT_GRID; k++)
        {
            check_line(file, object, &random, &filled, &set);
        }
    }
    print_message("M = %u: %.1f %% of the intervals of %u lines filled, %.1f %% marked\n",
                  c->scene_patches, 100.0 * (double)filled / (32.0 * LINES), LINES,
                  100.0 * (double)set / (32.0 * LINES));
    assert_true(filled > LINES / 10);
    ls_baked_close(&baked);
}

static void test_threads_and_default(void** state)
{
    (void)state;
    LsFixtureBytes bytes[3];
    static const uint32_t threads[3] = {1, 2, 8};
    LsBaked baked;
    for (int i = 0; i < 3; i++)
    {
        bake_case(&CASES[1], threads[i], &baked);
        bytes[i] = ls_fixture_read(baked.path);
        ls_baked_close(&baked);
        assert_int_equal(bytes[i].size, bytes[0].size);
        assert_memory_equal(bytes[i].bytes, bytes[0].bytes, bytes[0].size);
    }
    for (int i = 0; i < 3; i++)
    {
        ls_fixture_free(&bytes[i]);
    }
    // Without the option there is nothing of them, and the file is one of 0.3.
    Case none = CASES[1];
    none.scene_patches = 0;
    bake_case(&none, 0, &baked);
    assert_int_equal(baked.file.header->required_features & LS_FEATURE_SCENE_SHAFTS, 0);
    assert_int_equal(baked.file.header->version_minor, 3);
    assert_int_equal(baked.report.scene_shaft_count, 0);
    ls_baked_close(&baked);
}

int main(void)
{
    struct CMUnitTest tests[CASE_COUNT + 1];
    for (size_t i = 0; i < CASE_COUNT; i++)
    {
        tests[i] = (struct CMUnitTest){.name = ls_test_mesh_name(CASES[i].mesh),
                                       .test_func = test_no_bit_is_missing,
                                       .initial_state = (void*)&CASES[i]};
    }
    tests[CASE_COUNT] = (struct CMUnitTest)cmocka_unit_test(test_threads_and_default);
    return cmocka_run_group_tests_name("scene shafts", tests, NULL, NULL);
}
