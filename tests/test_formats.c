// test_formats.c - the same mesh in every format bakes to the same geometry, byte by byte.

#include "ls_bake.h"
#include "ls_format.h"
#include "mesh_writers.h"
#include "meshes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define FOLDER LS_BINARY_DIR "/test_formats"

// What a file says about the geometry. The rest is what formats differ in: nodes, materials, what
// is at corners.
static const LsChunk geometry[] = {
    LS_CHUNK_OBJECTS,     LS_CHUNK_TOP_NODES, LS_CHUNK_TRIANGLES, LS_CHUNK_BLOCKS,
    LS_CHUNK_CELL_BLOCKS, LS_CHUNK_SUBGRIDS,  LS_CHUNK_VOXELS,    LS_CHUNK_REFERENCES,
    LS_CHUNK_LEAF_NODES,  LS_CHUNK_SHAFTS,
};

typedef struct Baked
{
    LsMapping mapping;
    LsFile file;
    char path[512];
} Baked;

static void require(LsResult result, LsMeshFormat format, const LsError* error)
{
    if (result != LS_OK)
        fail_msg("%s: %s", ls_mesh_format_name(format), error->text);
}

static Baked bake(const LsPolygonMesh* mesh, LsMeshFormat format, uint32_t grid, bool no_weld)
{
    Baked baked = {.path = ""};
    char source[512];
    // The process id keeps test programs that run side by side apart.
    snprintf(source, sizeof source, "%s/%d-%s.%s", FOLDER, (int)getpid(),
             ls_mesh_format_name(format), ls_mesh_format_ending(format));
    snprintf(baked.path, sizeof baked.path, "%s/%d-%s.lspace", FOLDER, (int)getpid(),
             ls_mesh_format_name(format));
    size_t size;
    char* bytes = ls_mesh_bytes(mesh, format, &size);
    FILE* file = fopen(source, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    free(bytes);

    LsError error = {.result = LS_OK};
    const LsBakeInput input = {.path = source};
    const LsBakeDesc desc = {
        .inputs = &input,
        .input_count = 1,
        .output = baked.path,
        .grid = grid,
        .patches = 1, // the geometry depends on the mesh alone, however many there are
        .force = true,
        .no_weld = no_weld,
    };
    require(ls_bake_run(&desc, NULL, &error), format, &error);
    remove(source);
    require(ls_mapping_open(&baked.mapping, baked.path, &error), format, &error);
    require(ls_file_open(&baked.file, baked.mapping.bytes, baked.mapping.size, baked.path, &error),
            format, &error);
    require(ls_file_check(&baked.file, baked.path, &error), format, &error);
    return baked;
}

static void close_baked(Baked* baked)
{
    ls_mapping_close(&baked->mapping);
    remove(baked->path);
}

// The first triangle that differs is named, since it tells most.
static void compare_triangles(const LsFile* file, const LsFile* expected, const char* name)
{
    const uint32_t count = ls_file_count(expected, LS_CHUNK_TRIANGLES);
    if (ls_file_count(file, LS_CHUNK_TRIANGLES) != count)
        fail_msg("%s: %u triangles instead of %u", name, ls_file_count(file, LS_CHUNK_TRIANGLES),
                 count);
    for (uint32_t i = 0; i < count; i++)
        if (memcmp(&file->triangles[i], &expected->triangles[i], sizeof(LsTriangle)) != 0)
            fail_msg("%s: triangle %u differs", name, i);
}

static void compare_geometry(const LsFile* file, const LsFile* expected, const char* name)
{
    compare_triangles(file, expected, name);
    for (size_t i = 0; i < sizeof geometry / sizeof *geometry; i++)
    {
        const LsEntry* entry = file->chunk_entries[geometry[i]];
        const LsEntry* other = expected->chunk_entries[geometry[i]];
        if ((entry == NULL) != (other == NULL) ||
            (entry != NULL && (entry->stored_bytes != other->stored_bytes ||
                               memcmp(file->bytes + entry->offset, expected->bytes + other->offset,
                                      entry->stored_bytes) != 0)))
            fail_msg("%s: %s differ", name, ls_chunk_info(geometry[i]).name);
    }
    assert_memory_equal(file->header->lower, expected->header->lower, 12);
    assert_memory_equal(file->header->upper, expected->header->upper, 12);
}

// Returns how many chunks of geometry the file has.
static int check_formats(const LsPolygonMesh* mesh, uint32_t grid, bool no_weld)
{
    Baked expected = bake(mesh, 0, grid, no_weld);
    int chunk_count = 0;
    for (size_t i = 0; i < sizeof geometry / sizeof *geometry; i++)
        chunk_count += expected.file.chunk_entries[geometry[i]] != NULL;
    for (LsMeshFormat format = 1; format < LS_MESH_FORMAT_COUNT; format++)
    {
        Baked baked = bake(mesh, format, grid, no_weld);
        compare_geometry(&baked.file, &expected.file, ls_mesh_format_name(format));
        close_baked(&baked);
    }
    close_baked(&expected);
    return chunk_count;
}

static void check_mesh(LsTestMeshId id, uint32_t grid)
{
    LsTestMesh mesh = ls_test_mesh_make(id);
    const LsPolygonMesh polygons = ls_polygons_of(&mesh);
    // Objects, triangles, blocks, cells, voxels, references, shafts at least: else this compares
    // little.
    assert_true(check_formats(&polygons, grid, false) >= 7);
    free((uint32_t*)polygons.face_sizes);
    ls_test_mesh_destroy(&mesh);
}

static void test_bunny(void** state)
{
    (void)state;
    check_mesh(LS_TEST_MESH_BUNNY, 32);
}

static void test_slivers(void** state)
{
    (void)state;
    check_mesh(LS_TEST_MESH_SLIVERS, 9);
}

static void test_teapot(void** state)
{
    (void)state;
    check_mesh(LS_TEST_MESH_TEAPOT, 12);
}

// Faces that are no triangles, and those that other importers drop; welded, and as they come.
static void test_odd_faces(void** state)
{
    (void)state;
    for (int i = 0; i < 4; i++)
        assert_true(check_formats(&ls_odd_mesh, i < 2 ? 0 : 4, i % 2 == 1) >= 2);
}

// A wavy sheet of quads, every third one a pentagon with a corner far away.
static void test_polygons(void** state)
{
    (void)state;
    enum
    {
        SIDE = 24,
    };
    float positions[(SIDE + 1) * (SIDE + 1)][3];
    for (int i = 0; i < (SIDE + 1) * (SIDE + 1); i++)
    {
        const int x = i % (SIDE + 1);
        const int y = i / (SIDE + 1);
        positions[i][0] = 0.1f * (float)x;
        positions[i][1] = 0.3f * (float)((x * x + 3 * y) % 7);
        positions[i][2] = 0.1f * (float)y;
    }
    uint32_t sizes[SIDE * SIDE];
    uint32_t corners[5 * SIDE * SIDE];
    uint32_t count = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
    {
        const uint32_t a = i / SIDE * (SIDE + 1) + i % SIDE;
        sizes[i] = i % 3 == 2 ? 5 : 4;
        corners[count++] = a;
        corners[count++] = a + 1;
        if (sizes[i] == 5)
            corners[count++] = (a + 2 * SIDE) % ((SIDE + 1) * (SIDE + 1));
        corners[count++] = a + SIDE + 2;
        corners[count++] = a + SIDE + 1;
    }
    const LsPolygonMesh mesh = {
        .positions = positions[0],
        .vertex_count = (SIDE + 1) * (SIDE + 1),
        .face_sizes = sizes,
        .face_count = SIDE * SIDE,
        .corners = corners,
    };
    assert_true(check_formats(&mesh, 10, false) >= 7);
}

// The comparison must see a difference of one bit.
static void test_difference_is_seen(void** state)
{
    (void)state;
    float positions[LS_ODD_VERTICES][3];
    memcpy(positions, ls_odd_positions, sizeof positions);
    Baked expected = bake(&ls_odd_mesh, LS_MESH_FORMAT_OFF, 0, false);
    LsPolygonMesh mesh = ls_odd_mesh;
    mesh.positions = positions[0];
    positions[4][2] = nextafterf(positions[4][2], 1.0f);
    Baked baked = bake(&mesh, LS_MESH_FORMAT_GLB, 0, false);
    const LsTriangle* triangles[2] = {expected.file.triangles, baked.file.triangles};
    const uint32_t count = ls_file_count(&expected.file, LS_CHUNK_TRIANGLES);
    assert_int_equal(ls_file_count(&baked.file, LS_CHUNK_TRIANGLES), count);
    assert_memory_not_equal(triangles[0], triangles[1], count * sizeof(LsTriangle));
    close_baked(&baked);
    close_baked(&expected);
}

static int make_folder(void** state)
{
    (void)state;
    mkdir(FOLDER, 0777);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bunny),    cmocka_unit_test(test_slivers),
        cmocka_unit_test(test_teapot),   cmocka_unit_test(test_odd_faces),
        cmocka_unit_test(test_polygons), cmocka_unit_test(test_difference_is_seen),
    };
    return cmocka_run_group_tests_name("formats", tests, make_folder, NULL);
}
