// test_import_off_stl.c - OFF and STL files: what is taken from them, and what is refused.

#include "import.h"
#include "mesh_writers.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Files in a folder of this run --------------------------------------------------------------

static char folder[] = "/tmp/ls-test-off-stl-XXXXXX";
static const char* const file_names[] = {"a.ply", "a.off", "a.stl", "a.STL"};

static const char* find_path(const char* name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static int make_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void** state)
{
    (void)state;
    for (size_t i = 0; i < sizeof file_names / sizeof *file_names; i++)
        unlink(find_path(file_names[i]));
    return rmdir(folder);
}

static void write_bytes(const char* name, const void* bytes, size_t size)
{
    FILE* file = fopen(find_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static LsInput import_file(const char* name)
{
    LsInput input = {0};
    LsError error;
    if (ls_import(&input, find_path(name), &error) != LS_OK)
        fail_msg("%s", error.text);
    return input;
}

static LsInput import_text(const char* name, const char* text)
{
    write_bytes(name, text, strlen(text));
    return import_file(name);
}

// The file is refused with this result, and the message is one line that names the file and `word`.
static void check_refused(const char* name, const void* bytes, size_t size, LsResult expected,
                          const char* word)
{
    LsInput input = {0};
    LsError error = {0};
    write_bytes(name, bytes, size);
    const LsResult result = ls_import(&input, find_path(name), &error);
    ls_input_destroy(&input);
    if (result != expected || !strstr(error.text, name) || !strstr(error.text, word) ||
        strchr(error.text, '\n'))
        fail_msg("%s: result %d instead of %d, or no \"%s\" in: %s", name, result, expected, word,
                 error.text);
}

static void check_refused_text(const char* name, const char* text, LsResult expected,
                               const char* word)
{
    check_refused(name, text, strlen(text), expected, word);
}

// ---- One mesh in every format -------------------------------------------------------------------

#define MAX_BYTES 4096

static const struct
{
    const char* name;
    LsMeshFormat format;
} forms[] = {{"a.off", LS_MESH_FORMAT_OFF},
             {"a.stl", LS_MESH_FORMAT_STL_TEXT},
             {"a.stl", LS_MESH_FORMAT_STL_BINARY}};
#define FORMS 3

// Puts the bytes of the odd mesh's file into MAX_BYTES and returns how many; without the line end of
// the last line, which may be missing.
static size_t print_mesh(char* bytes, LsMeshFormat format)
{
    size_t size;
    char* made = ls_mesh_bytes(&ls_odd_mesh, format, &size);
    assert_true(size <= MAX_BYTES);
    memcpy(bytes, made, size);
    free(made);
    return size;
}

static void check_same_triangles(const LsInput* input, const LsInput* expected)
{
    assert_int_equal(input->mesh_count, 1);
    assert_int_equal(input->instance_count, 1);
    const LsInputMesh* mesh = &input->meshes[0];
    const LsInputMesh* other = &expected->meshes[0];
    assert_int_equal(mesh->triangle_count, other->triangle_count);
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++)
    {
        assert_true(mesh->indices[i] < mesh->vertex_count);
        assert_memory_equal(&mesh->positions[3 * mesh->indices[i]],
                            &other->positions[3 * other->indices[i]], 12);
        assert_int_equal(mesh->materials[i / 3], 0);
    }
    assert_int_equal(input->material_count, 1);
    assert_memory_equal(&input->materials[0], &expected->materials[0], sizeof(LsMaterial));
    assert_memory_equal(&input->instances[0], &expected->instances[0], sizeof(LsInputInstance));
}

static void test_same_mesh(void** state)
{
    (void)state;
    char bytes[MAX_BYTES];
    write_bytes("a.ply", bytes, print_mesh(bytes, LS_MESH_FORMAT_PLY_TEXT));
    LsInput expected = import_file("a.ply");
    assert_int_equal(expected.meshes[0].triangle_count, LS_ODD_TRIANGLES);
    for (int form = 0; form < FORMS; form++)
    {
        write_bytes(forms[form].name, bytes, print_mesh(bytes, forms[form].format));
        LsInput input = import_file(forms[form].name);
        check_same_triangles(&input, &expected);
        if (form == 0)
        {
            // OFF keeps the vertices of the file, shared as they are there.
            assert_int_equal(input.meshes[0].vertex_count, LS_ODD_VERTICES);
            assert_memory_equal(input.meshes[0].positions, ls_odd_positions,
                                sizeof ls_odd_positions);
            assert_memory_equal(input.meshes[0].indices, ls_odd_indices, sizeof ls_odd_indices);
        }
        else
        {
            assert_int_equal(input.meshes[0].vertex_count, 3 * LS_ODD_TRIANGLES);
            for (uint32_t i = 0; i < 3 * LS_ODD_TRIANGLES; i++)
                assert_int_equal(input.meshes[0].indices[i], i);
        }
        ls_input_destroy(&input);
    }
    ls_input_destroy(&expected);
}

// ---- OFF ----------------------------------------------------------------------------------------

static void test_off_forms(void** state)
{
    (void)state;
    // Each is the triangle (0 0 0), (1 0 0), (0 0.5 0).
    const char* const texts[] = {
        "OFF 3 1 0\n0 0 0\n1 0 0\n0 0.5 0\n3 0 1 2\n",
        "OFF\n3 1\n0 0 0\n1 0 0\n0 0.5 0\n3 0 1 2",
        "OFF\r\n3 1 3\r\n\r\n0 0 0\r\n1 0 0\r\n0 0.5 0\r\n3  0 1 2\r\n",
        "# by hand\nOFF # 8 8 8\n\n# counts:\n3 1 0 # so many\n\n0 0 0 # one\n\t1 0 0\n# two\n"
        "0 5e-1 0\n\n3 0 1 2# a face\n# end\n\n",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 0.5 0\n3 0 1 2 255 0 0\n",
        "OFF\n3 1 0\n0 0 0 9 9 9\n1 0 0 9 9 9\n0 0.5 0 9 9 9\n3 0 1 2 0.1 0.2 0.3 1\n",
        "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 0.5 0 0 0 0 0\n3 0 1 2\n",
        "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 0.5 0 0 0 1\n3 0 1 2 7\n",
        "STOFF\n3 1 0\n0 0 0 0 1\n1 0 0 1 1\n0 0.5 0 0 0\n3 0 1 2\n",
        "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1 0 1\n1 0 0 0 0 1 1 1 1 1 0 1\n"
        "0 0.5 0 0 0 1 1 1 1 1 0 1\n3 0 1 2\n",
    };
    const float expected[9] = {0, 0, 0, 1, 0, 0, 0, 0.5f, 0};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        LsInput input = import_text("a.off", texts[i]);
        assert_int_equal(input.mesh_count, 1);
        assert_int_equal(input.meshes[0].vertex_count, 3);
        assert_int_equal(input.meshes[0].triangle_count, 1);
        assert_memory_equal(input.meshes[0].positions, expected, sizeof expected);
        assert_memory_equal(input.meshes[0].indices, ((uint32_t[3]){0, 1, 2}), 12);
        ls_input_destroy(&input);
    }
    LsInput input = import_text("a.off", "OFF\n1 0 0\n1 2 3\n");
    assert_int_equal(input.mesh_count, 0);
    ls_input_destroy(&input);
}

static void test_off_refused(void** state)
{
    (void)state;
    static const struct
    {
        const char* text;
        LsResult result;
        const char* word;
    } cases[] = {
        {"ply\nformat ascii 1.0\n", LS_ERROR_INPUT_FORMAT, "not an OFF file"},
        {"OFFICE\n3 1 0\n", LS_ERROR_INPUT_FORMAT, "not an OFF file"},
        {"# only this\n", LS_ERROR_INPUT_FORMAT, "not an OFF file"},
        {"OFF BINARY\n", LS_ERROR_INPUT_UNSUPPORTED, "binary"},
        {"4OFF\n1 0 0\n0 0 0 1\n", LS_ERROR_INPUT_UNSUPPORTED, "three coordinates"},
        {"nOFF\n2\n1 0 0\n0 0\n", LS_ERROR_INPUT_UNSUPPORTED, "three coordinates"},
        {"OFF\n", LS_ERROR_INPUT_FORMAT, "numbers of vertices"},
        {"OFF\n3\n", LS_ERROR_INPUT_FORMAT, "numbers of vertices"},
        {"OFF\n-3 1 0\n", LS_ERROR_INPUT_FORMAT, "numbers of vertices"},
        {"OFF\n3 1.5 0\n", LS_ERROR_INPUT_FORMAT, "numbers of vertices"},
        {"OFF\n4000000000 1 0\n0 0 0\n", LS_ERROR_INPUT_FORMAT, "4000000000"},
        {"OFF\n3 99999999999999999999999 0\n0 0 0\n", LS_ERROR_INPUT_FORMAT, "do not fit"},
        {"OFF\n3 1 0\n0 0 0.00000\n1 0 0.00000\n0 1 0.00000\n", LS_ERROR_INPUT_FORMAT, "cut short"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", LS_ERROR_INPUT_INDEX, "line 6"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 4294967296\n", LS_ERROR_INPUT_INDEX, "4294967296"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", LS_ERROR_INPUT_INDEX, "vertex -1"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 x\n", LS_ERROR_INPUT_FORMAT, "no number"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1.5 2\n", LS_ERROR_INPUT_FORMAT, "no number"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1    \n", LS_ERROR_INPUT_FORMAT, "fewer corners"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0  1\n", LS_ERROR_INPUT_FORMAT, "no number"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1 255\n", LS_ERROR_INPUT_FORMAT, "three corners"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n18446744073709551615 0 1 2\n", LS_ERROR_INPUT_FORMAT,
         "fewer corners"},
        {"OFF\n3 1 0\n0 0 0\n1 0 a\n0 1 0\n3 0 1 2\n", LS_ERROR_INPUT_FORMAT, "line 4"},
        {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2   # padding\n", LS_ERROR_INPUT_FORMAT, "line 4"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", LS_ERROR_INPUT_FORMAT, "line 7"},
        {"OFF\n3 1 0\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n", LS_ERROR_INPUT_FORMAT, "one a line"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_refused_text("a.off", cases[i].text, cases[i].result, cases[i].word);
    check_refused("a.off", "OFF\n1 0 0\n0 0 \0000\n", 17, LS_ERROR_INPUT_FORMAT, "zero byte");
}

// Kept as they are; the bake says what is wrong with them.
static void test_not_finite(void** state)
{
    (void)state;
    char bytes[MAX_BYTES];
    LsInput input = import_text("a.off", "OFF\n3 1 0\n0 nan 0\n1 0 -inf\n0 1 0\n3 0 1 2\n");
    assert_true(isnan(input.meshes[0].positions[1]));
    assert_true(input.meshes[0].positions[5] == -INFINITY);
    ls_input_destroy(&input);

    input = import_text("a.stl", "solid\nfacet normal nan nan nan\nouter loop\nvertex 0 NaN 0\n"
                                 "vertex 1 0 1e99\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
    assert_true(isnan(input.meshes[0].positions[1]));
    assert_true(input.meshes[0].positions[5] == INFINITY);
    ls_input_destroy(&input);

    const size_t length = print_mesh(bytes, LS_MESH_FORMAT_STL_BINARY);
    const uint32_t odd_nan = 0x7FC12345;
    memcpy(bytes + 84 + 50 + 12, &odd_nan, sizeof odd_nan);
    write_bytes("a.stl", bytes, length);
    input = import_file("a.stl");
    assert_memory_equal(&input.meshes[0].positions[9], &odd_nan, sizeof odd_nan);
    ls_input_destroy(&input);
}

// ---- STL ----------------------------------------------------------------------------------------

static void test_stl_forms(void** state)
{
    (void)state;
    // Capitals, no names, line ends of two bytes, empty lines, two solids.
    LsInput input = import_text(
        "a.STL", "SOLID\r\n\r\nFACET NORMAL 0 0 1\r\nOUTER  LOOP\r\nVERTEX 0 0 0\r\n"
                 "VERTEX 1 0 0\r\nVERTEX 0 1 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID\r\n"
                 "solid two\nfacet\nouter loop\nvertex 2 2 2\nvertex\t2 2 3\nvertex 2 2 2\n"
                 "endloop\nendfacet\nendsolid two\n\n");
    const float expected[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 2, 2, 2, 2, 3, 2, 2, 2};
    assert_int_equal(input.mesh_count, 1);
    assert_int_equal(input.meshes[0].triangle_count, 2);
    assert_int_equal(input.meshes[0].vertex_count, 6);
    assert_memory_equal(input.meshes[0].positions, expected, sizeof expected);
    ls_input_destroy(&input);

    // No facets at all.
    input = import_text("a.stl", "solid\nendsolid\n");
    assert_int_equal(input.mesh_count, 0);
    ls_input_destroy(&input);
    const char header[84] = {0};
    write_bytes("a.stl", header, sizeof header);
    input = import_file("a.stl");
    assert_int_equal(input.mesh_count, 0);
    ls_input_destroy(&input);
}

#define FACET_START "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"

static void test_stl_refused(void** state)
{
    (void)state;
    static const struct
    {
        const char* text;
        const char* word;
    } cases[] = {
        {"OFF\n3 1 0\n", "line 1: \"solid\""},
        {"solid a\n", "no endsolid"},
        {"solid a\nvertex 0 0 0\n", "line 2: \"facet\""},
        {"solidity\n", "\"solid\""},
        {"solid\nfacets\n", "\"facet\""},
        {"solid\nfacet\nouter\n", "line 3: \"outer loop\""},
        {FACET_START "endloop\n", "line 6: \"vertex\""},
        {FACET_START "vertex 0 1\n", "line 6: a vertex needs three numbers"},
        {FACET_START "vertex 0 1 0x\n", "line 6: a vertex needs three numbers"},
        {FACET_START "vertex 0 1 0\nvertex 0 1 1\nendloop\n", "line 7: \"endloop\""},
        {FACET_START "vertex 0 1 0\nendloop\nendsolid\n", "line 8: \"endfacet\""},
        {FACET_START "vertex 0 1 0\nendloop\nendfacet\n", "no endsolid"},
        {FACET_START "vertex 0 1 0\nendloop\nendfacet\nendsolid\nfacet\n", "line 10: \"solid\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_refused_text("a.stl", cases[i].text, LS_ERROR_INPUT_FORMAT, cases[i].word);

    // Binary of another size than its count tells: cut, too long, or with a count beyond all memory.
    char bytes[MAX_BYTES];
    const size_t length = print_mesh(bytes, LS_MESH_FORMAT_STL_BINARY);
    check_refused("a.stl", bytes, length - 1, LS_ERROR_INPUT_FORMAT, "need 534 bytes");
    check_refused("a.stl", bytes, length + 1, LS_ERROR_INPUT_FORMAT, "need 534 bytes");
    memset(bytes + 80, 0xFF, 4);
    check_refused("a.stl", bytes, length, LS_ERROR_INPUT_FORMAT, "need 214748364834 bytes");
    check_refused("a.stl", bytes, 40, LS_ERROR_INPUT_FORMAT, "zero byte");
}

// ---- Cut and damaged files ----------------------------------------------------------------------

static void test_cut(void** state)
{
    (void)state;
    for (int form = 0; form < FORMS; form++)
    {
        char bytes[MAX_BYTES];
        size_t length = print_mesh(bytes, forms[form].format);
        while (length-- > 0)
        {
            LsInput input = {0};
            LsError error = {0};
            write_bytes(forms[form].name, bytes, length);
            if (ls_import(&input, find_path(forms[form].name), &error) == LS_OK)
                fail_msg("%s, cut after %zu bytes, was taken", forms[form].name, length);
            assert_non_null(strstr(error.text, forms[form].name));
            ls_input_destroy(&input);
        }
    }
}

// Random bytes in good files: any result, but within bounds and with a message. Half of them are
// digits and signs, which pass further into the readers.
static void test_damage(void** state)
{
    (void)state;
    static const char likely[] = "0123456789 -\n.#e";
    uint32_t random = 1;
    for (int form = 0; form < FORMS; form++)
    {
        char good[MAX_BYTES];
        const size_t length = print_mesh(good, forms[form].format);
        unsigned refused = 0;
        unsigned taken = 0;
        for (int i = 0; i < 2000; i++)
        {
            char bytes[MAX_BYTES];
            memcpy(bytes, good, length);
            for (int k = 0; k <= i % 3; k++)
            {
                random = random * 1664525u + 1013904223u;
                const size_t place = (random >> 8) % length;
                random = random * 1664525u + 1013904223u;
                bytes[place] = i % 2 ? likely[random >> 28] : (char)(random >> 24);
            }
            write_bytes(forms[form].name, bytes, length);
            LsInput input = {0};
            LsError error = {0};
            if (ls_import(&input, find_path(forms[form].name), &error) == LS_OK)
                taken++;
            else
            {
                assert_non_null(strstr(error.text, forms[form].name));
                refused++;
            }
            for (uint32_t m = 0; error.result == LS_OK && m < input.mesh_count; m++)
                for (uint32_t t = 0; t < 3 * input.meshes[m].triangle_count; t++)
                    assert_true(input.meshes[m].indices[t] < input.meshes[m].vertex_count);
            ls_input_destroy(&input);
        }
        assert_true(refused > 10 && taken > 10);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_mesh),   cmocka_unit_test(test_off_forms),
        cmocka_unit_test(test_off_refused), cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_stl_forms),   cmocka_unit_test(test_stl_refused),
        cmocka_unit_test(test_cut),         cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests_name("import_off_stl", tests, make_folder, remove_folder);
}
