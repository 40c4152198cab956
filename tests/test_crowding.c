// Geometry that grids fear: how many references an object may hold at most, whatever grid is asked
// for.

#include "baked.h"
#include "hard_meshes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define TRIANGLES 20000

typedef struct LsCrowdCase
{
    LsHardMeshId mesh;
    uint32_t grid; // 0: the baker's choice
    bool crowded;  // a coarser grid is taken
} LsCrowdCase;

static const LsCrowdCase CASES[] = {
    {LS_HARD_MESH_STADIUM, 0, false}, {LS_HARD_MESH_SPAN, 0, false},
    {LS_HARD_MESH_CLUSTER, 0, false}, {LS_HARD_MESH_HUB, 0, true},
    {LS_HARD_MESH_EDGE, 0, true},     {LS_HARD_MESH_FLAT, 0, false},
    {LS_HARD_MESH_LAYERS, 0, false},  {LS_HARD_MESH_EQUAL, 0, false},
    {LS_HARD_MESH_NEEDLES, 0, true},  {LS_HARD_MESH_STADIUM, 200, false},
    {LS_HARD_MESH_HUB, 8, false},     {LS_HARD_MESH_EDGE, 5, false},
    {LS_HARD_MESH_EDGE, 4096, true},  {LS_HARD_MESH_NEEDLES, 4, false},
    {LS_HARD_MESH_SIZES, 0, false},
};

// Filled cells of the grid itself.
static uint64_t count_filled(const LsFile* file)
{
    const LsObject* object = &file->objects[0];
    uint64_t filled = 0;
    for (uint32_t i = 0; i < object->cell_block_count - object->subgrid_count; i++)
    {
        const LsCellBlock* block = &file->cell_blocks[object->first_cell_block + i];
        for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
        {
            filled += (block->cells[c] & 15u) == 0;
        }
    }
    return filled;
}

static void references_are_bounded(void** state)
{
    (void)state;
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++)
    {
        const char* name = ls_hard_mesh_name(CASES[i].mesh);
        LsTestMesh mesh = ls_hard_mesh_make(CASES[i].mesh, TRIANGLES);
        LsBaked baked;
        ls_baked_open(&baked, &mesh, name, LS_TEST_ALONE, CASES[i].grid, 2, 0);
        const LsBakeReport* report = &baked.report;
        const uint32_t* cells = baked.file.objects[0].cells;
        const uint64_t x = cells[0], y = cells[1], z = cells[2];
        const uint64_t filled = count_filled(&baked.file), faces = 2 * (x * y + y * z + z * x);
        const uint64_t by_triangles = 16 * report->triangle_count;
        const uint64_t by_cells = 8 * (filled < 4 * faces ? filled : 4 * faces);
        const uint64_t most = by_triangles > by_cells ? by_triangles : by_cells;
        print_message("%s, grid %u: %u cells along x, %llu filled, %.2f references a triangle, "
                      "%.2f of what is allowed\n",
                      name, CASES[i].grid, cells[0], (unsigned long long)filled,
                      (double)report->reference_count / (double)report->triangle_count,
                      (double)report->reference_count / (2.0 * (double)most));
        assert_true(report->reference_count <= 2 * most);
        assert_int_equal(report->crowded_object_count, CASES[i].crowded);
        ls_baked_close(&baked);
        ls_test_mesh_destroy(&mesh);
    }
}

// Of copies in order and bit for bit the first alone is listed; of others all are.
static void copies_are_listed_once(void** state)
{
    (void)state;
    LsTestMesh mesh = ls_hard_mesh_make(LS_HARD_MESH_EQUAL, TRIANGLES);
    for (uint32_t i = 0; i < mesh.triangle_count; i++)
    {
        // The three rotations of both windings.
        uint32_t* corners = mesh.indices + 3 * i;
        const uint32_t a = corners[0], b = corners[1], c = corners[2];
        const uint32_t order[6][3] = {{a, b, c}, {b, c, a}, {c, a, b},
                                      {a, c, b}, {c, b, a}, {b, a, c}};
        for (int k = 0; k < 3; k++)
        {
            corners[k] = order[i % 6][k];
        }
    }
    LsBaked baked;
    ls_baked_open(&baked, &mesh, "copies", LS_TEST_ALONE, 16, 2, 0);
    assert_int_equal(baked.report.triangle_count, mesh.triangle_count);
    assert_int_equal(baked.report.reference_count, 6 * baked.report.voxel_count);
    ls_baked_close(&baked);
    ls_test_mesh_destroy(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(references_are_bounded),
        cmocka_unit_test(copies_are_listed_once),
    };
    return cmocka_run_group_tests_name("crowding", tests, NULL, NULL);
}
