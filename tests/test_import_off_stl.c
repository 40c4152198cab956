// test_import_off_stl.c - OFF and STL files: what is taken from them, and what is refused.

#include "mesh_files.h"
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
    write_mesh_bytes("a.ply", bytes, print_mesh(bytes, LS_MESH_FORMAT_PLY_TEXT));
    LsInput expected = import_mesh_file("a.ply");
    assert_int_equal(expected.meshes[0].triangle_count, LS_ODD_TRIANGLES);
    for (int form = 0; form < FORMS; form++)
    {
        write_mesh_bytes(forms[form].name, bytes, print_mesh(bytes, forms[form].format));
        LsInput input = import_mesh_file(forms[form].name);
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

// A triangle with normals, colours and texture coordinates, the same in every format that has them.
static void test_same_streams(void** state)
{
    (void)state;
    const char* const texts[][2] = {
        {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                  "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                  "property float red\nproperty float green\nproperty float blue\n"
                  "property float u\nproperty float v\nelement face 1\n"
                  "property list uchar int vertex_indices\nend_header\n"
                  "0.1 0 0 0 0 1 0.5 0.25 1 0.1 0.3\n1 0 0.3 0 1 0 0 0.7 1 1 0\n"
                  "0 1.7 0 0.6 0 0.8 1 1 0 0 1\n3 0 1 2\n"},
        {"a.off", "STCNOFF\n3 1 0\n0.1 0 0 0 0 1 0.5 0.25 1 0.1 0.3\n1 0 0.3 0 1 0 0 0.7 1 1 0\n"
                  "0 1.7 0 0.6 0 0.8 1 1 0 0 1\n3 0 1 2\n"},
        {"a.obj", "v 0.1 0 0 0.5 0.25 1\nv 1 0 0.3 0 0.7 1\nv 0 1.7 0 1 1 0\nvt 0 1\nvt 0.1 0.3\n"
                  "vt 1 0\nvn 0 0 1\nvn 0 1 0\nvn 0.6 0 0.8\nf 1/2/1 2/3/2 3/1/3\n"},
    };
    float expected[3][LS_STREAM_COUNT + 1][4] = {{{0}}};
    for (size_t form = 0; form < sizeof texts / sizeof *texts; form++)
    {
        LsInput input = import_mesh_text(texts[form][0], texts[form][1]);
        assert_int_equal(input.warning_count, 0);
        const LsInputMesh* mesh = &input.meshes[0];
        assert_int_equal(mesh->triangle_count, 1);
        float found[3][LS_STREAM_COUNT + 1][4] = {{{0}}};
        for (size_t i = 0; i < 3; i++)
        {
            memcpy(found[i][LS_STREAM_COUNT], &mesh->positions[3 * mesh->indices[i]], 12);
            for (int kind = 0; kind < LS_STREAM_COUNT; kind++)
            {
                const LsInputStream* stream = &mesh->streams[kind];
                const uint32_t size = ls_stream_size((LsStreamKind)kind);
                assert_true((kind == LS_STREAM_TEXCOORD_1) == !stream->values);
                if (stream->values)
                    memcpy(found[i][kind],
                           &stream->values[size *
                                           (stream->indices ? stream->indices : mesh->indices)[i]],
                           size * sizeof(float));
            }
        }
        if (form == 0)
            memcpy(expected, found, sizeof found);
        assert_memory_equal(found, expected, sizeof found);
        ls_input_destroy(&input);
    }
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
        LsInput input = import_mesh_text("a.off", texts[i]);
        assert_int_equal(input.mesh_count, 1);
        assert_int_equal(input.meshes[0].vertex_count, 3);
        assert_int_equal(input.meshes[0].triangle_count, 1);
        assert_memory_equal(input.meshes[0].positions, expected, sizeof expected);
        assert_memory_equal(input.meshes[0].indices, ((uint32_t[3]){0, 1, 2}), 12);
        ls_input_destroy(&input);
    }
    LsInput input = import_mesh_text("a.off", "OFF\n1 0 0\n1 2 3\n");
    assert_int_equal(input.mesh_count, 0);
    ls_input_destroy(&input);
}

#define OFF_POINTS "0 0 0\n1 0 0\n0 1 0\n"

static void test_off_refused(void** state)
{
    (void)state;
    static const struct
    {
        const char* text;
        LsMessage message;
        const char* word;
    } cases[] = {
        {"ply\nformat ascii 1.0\n", LS_MESSAGE_OFF_HEADER, "not an OFF file"},
        {"OFFICE\n3 1 0\n", LS_MESSAGE_OFF_HEADER, "not an OFF file"},
        {"# only this\n", LS_MESSAGE_OFF_HEADER, "not an OFF file"},
        {"OFF BINARY\n", LS_MESSAGE_OFF_CUT, "cut short"},
        {"4OFF\n1 0 0\n0 0 0 1\n", LS_MESSAGE_OFF_DIMENSION, "three coordinates"},
        {"nOFF\n2\n1 0 0\n0 0\n", LS_MESSAGE_OFF_DIMENSION, "three coordinates"},
        {"OFF\n", LS_MESSAGE_OFF_HEADER, "numbers of vertices"},
        {"OFF\n3\n", LS_MESSAGE_OFF_HEADER, "numbers of vertices"},
        {"OFF\n-3 1 0\n", LS_MESSAGE_OFF_HEADER, "numbers of vertices"},
        {"OFF\n3 1.5 0\n", LS_MESSAGE_OFF_HEADER, "numbers of vertices"},
        {"OFF\n4000000000 1 0\n0 0 0\n", LS_MESSAGE_LIMIT_MESH, "2147483647"},
        {"OFF\n3 999999999 0\n0 0 0\n", LS_MESSAGE_OFF_CUT, "do not fit"},
        {"OFF\n3 1 0\n0 0 0.00000\n1 0 0.00000\n0 1 0.00000\n", LS_MESSAGE_OFF_CUT, "cut short"},
        {"OFF\n3 1 0\n" OFF_POINTS "3 0 1 3\n", LS_MESSAGE_OFF_CORNER, "face 0"},
        {"OFF\n3 1 0\n" OFF_POINTS "3 0 1 4294967296\n", LS_MESSAGE_OFF_CORNER, "4294967296"},
        {"OFF\n3 1 0\n" OFF_POINTS "3 0 -1 2\n", LS_MESSAGE_OFF_CORNER, "vertex -1"},
        {"OFF\n3 1 0\n" OFF_POINTS "3 0 1 x\n", LS_MESSAGE_OFF_NUMBER, "line 6"},
        {"OFF\n3 1 0\n" OFF_POINTS "3 0 1.5 2\n", LS_MESSAGE_OFF_NUMBER, "whole"},
        {"OFF\n3 1 0\n" OFF_POINTS "3 0 1\n", LS_MESSAGE_OFF_NUMBER, "fewer corners"},
        {"OFF\n3 1 0\n" OFF_POINTS "-3 0 1 2\n", LS_MESSAGE_OFF_NUMBER, "number of corners"},
        {"OFF\n3 1 0\n0 0 0\n1 0 a\n0 1 0\n3 0 1 2\n", LS_MESSAGE_OFF_NUMBER, "line 4"},
        {"COFF\n3 1 0\n0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 0 1 2\n", LS_MESSAGE_OFF_NUMBER,
         "lacks a number"},
        {"OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2 255 0 0\n", LS_MESSAGE_OFF_LAYOUT, "more stands"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_mesh_text_refused("a.off", cases[i].text, cases[i].message, cases[i].word);
    write_mesh_bytes("a.off", "OFF\n1 0 0\n0 0 \0000\n", 17);
    check_mesh_refused("a.off", LS_MESSAGE_TEXT_ZERO_BYTE, "zero byte");
}

static void test_off_warned(void** state)
{
    (void)state;
    check_mesh_text_warned("a.off", "OFF\n3 1 0\n0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2\n",
                           LS_MESSAGE_OFF_REST, "behind positions");
    check_mesh_text_warned("a.off", "OFF\n3 1 0\n" OFF_POINTS "3 0 1 2 7\n", LS_MESSAGE_OFF_REST,
                           "behind faces");
    check_mesh_text_warned("a.off", "OFF\n3 2 0\n" OFF_POINTS "2 0 1\n3 0 1 2\n",
                           LS_MESSAGE_OFF_SMALL_FACES, "face 0");
    check_mesh_text_warned("a.off",
                           "COFF\n3 1 0\n0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2 1 0 0\n",
                           LS_MESSAGE_OFF_FACE_COLORS, "colours");
    check_mesh_text_warned("a.off", "OFF\n3 0 0\n" OFF_POINTS, LS_MESSAGE_OFF_POINTS, "3 vertices");
    check_mesh_text_warned("a.off", "OFF\n3 1 0\n" OFF_POINTS "3 0 1 2\n3 0 1 2\n",
                           LS_MESSAGE_OFF_TRAILING, "line 7");
}

// What stands behind positions, in text and in binary, and records that share lines.
static void test_off_streams(void** state)
{
    (void)state;
    char bytes[MAX_BYTES];
    const float numbers[3][12] = {{0, 0, 0, 0, 0, 1, 1, 0, 0, 0.25f, 0.25f, 0.25f},
                                  {1, 0, 0, 0, 0, 2, 0, 1, 0, 1, 1, 1},
                                  {0, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1}};
    size_t length = (size_t)sprintf(bytes, "STCNOFF BINARY\n");
    const uint32_t counts[3] = {3, 1, 0};
    const uint32_t face[5] = {3, 0, 1, 2, 0};
    uint32_t words[3 + 36 + 5];
    memcpy(words, counts, sizeof counts);
    memcpy(words + 3, numbers, sizeof numbers);
    memcpy(words + 39, face, sizeof face);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        for (int k = 0; k < 4; k++)
            bytes[length++] = (char)(words[i] >> (24 - 8 * k));
    for (int form = 0; form < 3; form++)
    {
        if (form == 0)
            write_mesh_bytes("a.off", bytes, length);
        else
        {
            char text[1024];
            size_t end = (size_t)sprintf(text, "STCNOFF\n3 1 0\n");
            for (int i = 0; i < 36; i++)
                end += (size_t)sprintf(text + end, "%.9g%c", (double)numbers[i / 12][i % 12],
                                       form == 1 && i % 12 == 11 ? '\n' : ' ');
            sprintf(text + end, "3 0 1 2\n");
            write_mesh_text("a.off", text);
        }
        LsInput input = import_mesh_file("a.off");
        const LsInputMesh* mesh = &input.meshes[0];
        assert_int_equal(input.warning_count, 0);
        assert_int_equal(mesh->triangle_count, 1);
        assert_true(mesh->positions[3] == 1.0f && mesh->positions[7] == 1.0f);
        assert_true(mesh->streams[LS_STREAM_NORMAL].values[5] == 2.0f);
        assert_true(mesh->streams[LS_STREAM_COLOR].values[0] == 1.0f);
        assert_true(mesh->streams[LS_STREAM_COLOR].values[3] == 0.25f);
        assert_true(mesh->streams[LS_STREAM_TEXCOORD_0].values[0] == 0.25f);
        assert_true(mesh->streams[LS_STREAM_TEXCOORD_0].values[1] == 0.75f);
        ls_input_destroy(&input);
    }
    check_mesh_cut("a.off", bytes, length, 0);
    check_mesh_damage("a.off", bytes, length, 500);

    // Colours of faces in bytes; the second face has none.
    LsInput input =
        import_mesh_text("a.off", "OFF\n3 2 0\n" OFF_POINTS "3 0 1 2 255 0 51\n3 2 1 0\n");
    const LsInputStream* stream = &input.meshes[0].streams[LS_STREAM_COLOR];
    const uint32_t faces[6] = {0, 0, 0, LS_NONE, LS_NONE, LS_NONE};
    assert_memory_equal(stream->indices, faces, sizeof faces);
    assert_true(stream->values[0] == 1.0f && stream->values[1] == 0.0f &&
                stream->values[3] == 1.0f);
    ls_input_destroy(&input);
}

// Kept as they are; the bake says what is wrong with them.
static void test_not_finite(void** state)
{
    (void)state;
    char bytes[MAX_BYTES];
    LsInput input = import_mesh_text("a.off", "OFF\n3 1 0\n0 nan 0\n1 0 -inf\n0 1 0\n3 0 1 2\n");
    assert_true(isnan(input.meshes[0].positions[1]));
    assert_true(input.meshes[0].positions[5] == -INFINITY);
    ls_input_destroy(&input);

    input =
        import_mesh_text("a.stl", "solid\nfacet normal nan nan nan\nouter loop\nvertex 0 NaN 0\n"
                                  "vertex 1 0 1e99\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
    assert_true(isnan(input.meshes[0].positions[1]));
    assert_true(input.meshes[0].positions[5] == INFINITY);
    ls_input_destroy(&input);

    const size_t length = print_mesh(bytes, LS_MESH_FORMAT_STL_BINARY);
    const uint32_t odd_nan = 0x7FC12345;
    memcpy(bytes + 84 + 50 + 12, &odd_nan, sizeof odd_nan);
    write_mesh_bytes("a.stl", bytes, length);
    input = import_mesh_file("a.stl");
    assert_memory_equal(&input.meshes[0].positions[9], &odd_nan, sizeof odd_nan);
    ls_input_destroy(&input);
}

// ---- STL ----------------------------------------------------------------------------------------

static void test_stl_forms(void** state)
{
    (void)state;
    // Capitals, no names, line ends of two bytes, empty lines, two solids.
    LsInput input = import_mesh_text(
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
    input = import_mesh_text("a.stl", "solid\nendsolid\n");
    assert_int_equal(input.mesh_count, 0);
    ls_input_destroy(&input);
    const char header[84] = {0};
    write_mesh_bytes("a.stl", header, sizeof header);
    input = import_mesh_file("a.stl");
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
        LsMessage message;
        const char* word;
    } cases[] = {
        {"OFF\n3 1 0\n", LS_MESSAGE_STL_LINE, "line 1: \"solid\""},
        {"solid a\n", LS_MESSAGE_STL_CUT, "no endsolid"},
        {"solid a\nvertex 0 0 0\n", LS_MESSAGE_STL_LINE, "line 2: \"facet\""},
        {"solidity\n", LS_MESSAGE_STL_LINE, "\"solid\""},
        {"solid\nfacets\n", LS_MESSAGE_STL_LINE, "\"facet\""},
        {"solid\nfacet\nouter\n", LS_MESSAGE_STL_LINE, "line 3: \"outer loop\""},
        {FACET_START "endloop\n", LS_MESSAGE_STL_LINE, "line 6: \"vertex\""},
        {FACET_START "vertex 0 1\n", LS_MESSAGE_STL_NUMBER, "line 6"},
        {FACET_START "vertex 0 1 0x\n", LS_MESSAGE_STL_NUMBER, "line 6"},
        {FACET_START "vertex 0 1 0\nvertex 0 1 1\nendloop\n", LS_MESSAGE_STL_LINE, "line 7"},
        {FACET_START "vertex 0 1 0\nendloop\nendsolid\n", LS_MESSAGE_STL_LINE, "line 8"},
        {FACET_START "vertex 0 1 0\nendloop\nendfacet\n", LS_MESSAGE_STL_CUT, "no endsolid"},
        {FACET_START "vertex 0 1 0\nendloop\nendfacet\nendsolid\nfacet\n", LS_MESSAGE_STL_LINE,
         "line 10"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_mesh_text_refused("a.stl", cases[i].text, cases[i].message, cases[i].word);

    // Binary too short for its count, or with a count beyond all memory.
    char bytes[MAX_BYTES];
    const size_t length = print_mesh(bytes, LS_MESH_FORMAT_STL_BINARY);
    write_mesh_bytes("a.stl", bytes, length - 1);
    check_mesh_refused("a.stl", LS_MESSAGE_STL_SIZE, "need 534 bytes");
    memset(bytes + 80, 0xFF, 4);
    write_mesh_bytes("a.stl", bytes, length);
    check_mesh_refused("a.stl", LS_MESSAGE_STL_SIZE, "need 214748364834 bytes");
    write_mesh_bytes("a.stl", bytes, 40);
    check_mesh_refused("a.stl", LS_MESSAGE_TEXT_ZERO_BYTE, "zero byte");

    // A file with holes in it, so that it takes no room: more facets than a mesh may have.
    const uint32_t facets = 715827883;
    memcpy(bytes + 80, &facets, sizeof facets);
    write_mesh_bytes("a.stl", bytes, 84);
    assert_int_equal(truncate(find_mesh_path("a.stl"), 84 + (off_t)facets * 50), 0);
    check_mesh_refused("a.stl", LS_MESSAGE_LIMIT_MESH, "split");
}

// Bytes behind the facets, and attributes: taken with a warning.
static void test_stl_warned(void** state)
{
    (void)state;
    char bytes[MAX_BYTES];
    const size_t length = print_mesh(bytes, LS_MESH_FORMAT_STL_BINARY);
    write_mesh_bytes("a.stl", bytes, length + 1);
    LsInput input = import_mesh_file("a.stl");
    assert_int_equal(input.meshes[0].triangle_count, LS_ODD_TRIANGLES);
    assert_int_equal(input.warning_count, 1);
    assert_int_equal(input.warnings[0].message, LS_MESSAGE_STL_TRAILING);
    assert_non_null(strstr(input.warnings[0].text, "1 bytes"));
    ls_input_destroy(&input);
    bytes[84 + 49] = (char)0x80;
    write_mesh_bytes("a.stl", bytes, length);
    input = import_mesh_file("a.stl");
    assert_int_equal(input.warning_count, 1);
    assert_int_equal(input.warnings[0].message, LS_MESSAGE_STL_COLORS);
    ls_input_destroy(&input);
}

// ---- Cut and damaged files ----------------------------------------------------------------------

static void test_cut_and_damaged(void** state)
{
    (void)state;
    for (int form = 0; form < FORMS; form++)
    {
        char bytes[MAX_BYTES];
        const size_t length = print_mesh(bytes, forms[form].format);
        check_mesh_cut(forms[form].name, bytes, length, 0);
        check_mesh_damage(forms[form].name, bytes, length, 1000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_mesh),       cmocka_unit_test(test_same_streams),
        cmocka_unit_test(test_off_forms),       cmocka_unit_test(test_off_refused),
        cmocka_unit_test(test_off_warned),      cmocka_unit_test(test_off_streams),
        cmocka_unit_test(test_not_finite),      cmocka_unit_test(test_stl_forms),
        cmocka_unit_test(test_stl_refused),     cmocka_unit_test(test_stl_warned),
        cmocka_unit_test(test_cut_and_damaged),
    };
    return cmocka_run_group_tests_name("import_off_stl", tests, make_mesh_folder,
                                       remove_mesh_folder);
}
