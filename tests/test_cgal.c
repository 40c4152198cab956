// CGAL's meshes: what a bake reports of each against counts made from the raw file by code that shares
// nothing with the baker. Usage: test_cgal FOLDER, with the meshes of Debian's libcgal-demo.

#include "mesh.h"
#include "reference/ref_topology.h"

#include <dirent.h>
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

// Larger files go through the importer and the mesh stage alone, for the sake of time.
#define MAX_BAKED_BYTES 100000

static const char* folder;

// The golden list: files that are refused, by result; all others must bake.
static const struct
{
    const char* name;
    LsResult result;
} REFUSED[] = {
    {"b9.ply", LS_ERROR_INPUT_NO_TRIANGLES}, // points alone
};

static LsResult expected_result(const char* name)
{
    for (size_t i = 0; i < sizeof REFUSED / sizeof *REFUSED; i++)
    {
        if (strcmp(name, REFUSED[i].name) == 0)
        {
            return REFUSED[i].result;
        }
    }
    return LS_OK;
}

static int compare_names(const void* a, const void* b)
{
    return strcmp(*(char* const*)a, *(char* const*)b);
}

static uint32_t list_files(char** names, uint32_t room)
{
    DIR* directory = opendir(folder);
    if (directory == NULL)
    {
        fail_msg("%s: no folder of CGAL's meshes; install libcgal-demo", folder);
    }
    uint32_t count = 0;
    for (const struct dirent* entry = readdir(directory); entry != NULL; entry = readdir(directory))
    {
        if (entry->d_name[0] != '.' && count < room)
        {
            names[count++] = strdup(entry->d_name);
        }
    }
    closedir(directory);
    qsort(names, count, sizeof *names, compare_names);
    return count;
}

typedef struct Tally
{
    uint32_t compared, baked, refused;
    LsRefTopology sum;
} Tally;

// Reads a file and checks its one mesh, as a bake does.
static LsResult check_mesh(const char* path, LsMeshReport* report, LsError* error)
{
    LsInput input = {0};
    LsMesh mesh = {0};
    LsMeshFindings findings = {0};
    LsResult result = ls_import(&input, path, error);
    if (result == LS_OK && (input.mesh_count == 0 || input.meshes[0].triangle_count == 0))
    {
        result = ls_error_set(error, LS_MESSAGE_SCENE_NO_TRIANGLES, "%s: no triangles", path);
    }
    if (result == LS_OK)
    {
        assert_int_equal(input.mesh_count, 1);
        result = ls_mesh_create(&mesh, &input, 0, &(LsBakeDesc){0}, 1, NULL, &findings, error);
    }
    *report = findings.report;
    ls_mesh_destroy(&mesh);
    ls_input_destroy(&input);
    return result;
}

// The report of a whole bake says the same, and names faults where there are any.
static void check_bake(const char* path, const char* output, const LsMeshReport* expected)
{
    const LsBakeInput input = {.path = path};
    const LsBakeDesc desc = {
        .inputs = &input, .input_count = 1, .output = output, .patches = 1, .force = true};
    LsError error = {0};
    LsBakeReport report = {0};
    if (ls_bake_run(&desc, &report, &error) != LS_OK)
    {
        fail_msg("%s", error.text);
    }
    assert_memory_equal(&report.mesh, expected, sizeof *expected);
    uint32_t kinds = 0;
    for (int fault = 0; fault < LS_MESH_FAULT_COUNT; fault++)
    {
        uint64_t count = ls_mesh_fault_count(expected, (LsMeshFault)fault);
        kinds += (uint32_t)(count < LS_MESH_EXAMPLES ? count : LS_MESH_EXAMPLES);
    }
    assert_int_equal(report.faulty_count, kinds > 0);
    if (kinds > 0)
    {
        assert_int_equal(report.faulty[0].example_count, kinds);
        assert_string_equal(report.faulty[0].input, path);
    }
    ls_bake_report_destroy(&report);
}

static void compare_file(const char* name, const char* path, const char* output, Tally* tally)
{
    LsError error = {0};
    LsMeshReport report;
    LsResult result = check_mesh(path, &report, &error);
    if (result != expected_result(name))
    {
        fail_msg("%s: result %d, expected %d; %s", name, (int)result, (int)expected_result(name),
                 error.text);
    }
    if (result != LS_OK)
    {
        print_message("%s is refused: %s\n", name, error.text);
        tally->refused++;
        return;
    }
    LsRefMesh mesh;
    assert_true(ls_ref_mesh_read(&mesh, path));
    LsRefTopology expected = ls_ref_topology(&mesh, true);
    ls_ref_mesh_destroy(&mesh);
    const struct
    {
        const char* what;
        uint64_t found, expected;
        uint64_t* sum;
    } rows[] = {
        {"vertices", report.vertex_count, expected.vertices, &tally->sum.vertices},
        {"faces", report.face_count, expected.faces, &tally->sum.faces},
        {"degenerate", report.degenerate_count, expected.degenerate, &tally->sum.degenerate},
        {"duplicate", report.duplicate_count, expected.duplicate, &tally->sum.duplicate},
        {"inverted", report.inverted_count, expected.inverted, &tally->sum.inverted},
        {"unorientable", report.unorientable_count, expected.unorientable,
         &tally->sum.unorientable},
        {"edges", report.edge_count, expected.edges, &tally->sum.edges},
        {"boundary edges", report.boundary_edge_count, expected.boundary, &tally->sum.boundary},
        {"non-manifold edges", report.nonmanifold_edge_count, expected.nonmanifold,
         &tally->sum.nonmanifold},
        {"holes", report.hole_count, expected.holes, &tally->sum.holes},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    {
        if (rows[i].found != rows[i].expected)
        {
            fail_msg("%s: %s %llu, counted from the raw file %llu", name, rows[i].what,
                     (unsigned long long)rows[i].found, (unsigned long long)rows[i].expected);
        }
        *rows[i].sum += rows[i].expected;
    }
    tally->compared++;
    struct stat status;
    if (stat(path, &status) == 0 && status.st_size <= MAX_BAKED_BYTES)
    {
        check_bake(path, output, &report);
        tally->baked++;
    }
}

static void counts_of_raw_files(void** state)
{
    (void)state;
    static char* names[1000];
    uint32_t count = list_files(names, 1000);
    Tally tally = {0};
    char output[256];
    snprintf(output, sizeof output, LS_BINARY_DIR "/test_cgal-%d.lspace", (int)getpid());
    for (uint32_t i = 0; i < count; i++)
    {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        compare_file(names[i], path, output, &tally);
        free(names[i]);
    }
    remove(output);
    print_message(
        "%u files: %u compared, %u of them baked, %u refused; faces %llu, degenerate %llu, "
        "duplicate %llu, inverted %llu, unorientable parts %llu, boundary edges %llu, "
        "non-manifold edges %llu, holes %llu\n",
        count, tally.compared, tally.baked, tally.refused, (unsigned long long)tally.sum.faces,
        (unsigned long long)tally.sum.degenerate, (unsigned long long)tally.sum.duplicate,
        (unsigned long long)tally.sum.inverted, (unsigned long long)tally.sum.unorientable,
        (unsigned long long)tally.sum.boundary, (unsigned long long)tally.sum.nonmanifold,
        (unsigned long long)tally.sum.holes);
    // All of the golden list was there, and the meshes do have faults.
    assert_int_equal(tally.refused, sizeof REFUSED / sizeof *REFUSED);
    assert_true(tally.compared > 100);
    assert_true(tally.sum.holes > 0 && tally.sum.nonmanifold > 0 && tally.sum.inverted > 0);
}

int main(int argc, char** argv)
{
    if (argc != 2)
    {
        fprintf(stderr, "usage: test_cgal FOLDER\n");
        return 1;
    }
    folder = argv[1];
    const struct CMUnitTest tests[] = {cmocka_unit_test(counts_of_raw_files)};
    return cmocka_run_group_tests_name("cgal", tests, NULL, NULL);
}
