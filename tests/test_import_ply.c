// test_import_ply.c - PLY files: what is taken from them, what is warned of, what is refused.

#include "mesh_files.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define ASCII "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define VERTICES ASCII "element vertex 3\n" XYZ
#define FACES "element face 1\nproperty list uchar int vertex_indices\n"
#define END "end_header\n"
#define POINTS "0 0 0\n1 0 0\n0 1 0\n"
#define GOOD VERTICES FACES END POINTS "3 0 1 2\n"

static void test_refused(void** state)
{
    (void)state;
    static const struct
    {
        const char* text;
        LsMessage message;
        const char* word;
    } cases[] = {
        {"not a mesh at all", LS_MESSAGE_PLY_HEADER, "not a PLY file"},
        {"ply\nelement vertex 3\n", LS_MESSAGE_PLY_HEADER, "line 2"},
        {"ply\nformat ascii 2.0\n", LS_MESSAGE_PLY_HEADER, "1.0"},
        {"ply\nformat text 1.0\n", LS_MESSAGE_PLY_HEADER, "neither"},
        {ASCII "property float x\n", LS_MESSAGE_PLY_HEADER, "before any element"},
        {ASCII "element vertex\n", LS_MESSAGE_PLY_HEADER, "count"},
        {ASCII "element vertex -1\n", LS_MESSAGE_PLY_HEADER, "count"},
        {ASCII "element vertex 1\nelement vertex 1\n", LS_MESSAGE_PLY_HEADER, "already there"},
        {ASCII "element vertex 1\nproperty float\n", LS_MESSAGE_PLY_HEADER, "its type and a name"},
        {VERTICES, LS_MESSAGE_PLY_HEADER_CUT, "no end"},
        {ASCII "element vertex 3\nproperty float x\nproperty float y\n" FACES END,
         LS_MESSAGE_PLY_NO_POSITIONS, "x, y and z"},
        {VERTICES "element face 1\nproperty uchar quality\n" END POINTS "7\n",
         LS_MESSAGE_PLY_NO_CORNERS, "face"},
        {VERTICES FACES END POINTS "3 0 1\n", LS_MESSAGE_PLY_CUT, "face 0 of 1"},
        {VERTICES FACES END "0 0 0\n1 0", LS_MESSAGE_PLY_CUT, "vertex 1 of 3"},
        {VERTICES FACES END POINTS "4000000000 0 1 2\n", LS_MESSAGE_PLY_CUT, "cut short"},
        {VERTICES FACES END POINTS "3 0 x 2\n", LS_MESSAGE_PLY_NUMBER, "line 13"},
        {VERTICES FACES END POINTS "3 0 1.5 2\n", LS_MESSAGE_PLY_NUMBER, "whole"},
        {VERTICES FACES END POINTS "-3 0 1 2\n", LS_MESSAGE_PLY_NUMBER, "count"},
        {VERTICES FACES END POINTS "3 0 nan 2\n", LS_MESSAGE_PLY_NUMBER, "corner"},
        {VERTICES FACES END POINTS "3 0 1 3\n", LS_MESSAGE_PLY_CORNER, "vertex 3"},
        {VERTICES FACES END POINTS "3 0 -1 2\n", LS_MESSAGE_PLY_CORNER, "vertex -1"},
        {VERTICES "property int128 w\n" FACES END, LS_MESSAGE_PLY_TYPE, "int128"},
        {VERTICES "element face 1\nproperty list float int vertex_indices\n" END,
         LS_MESSAGE_PLY_TYPE, "float"},
        {ASCII "element vertex 99999999999\n" XYZ FACES END POINTS, LS_MESSAGE_LIMIT_MESH,
         "2147483647"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_mesh_text_refused("a.ply", cases[i].text, cases[i].message, cases[i].word);

    // What a terminal should not be sent is not in the message.
    check_mesh_text_warned("a.ply",
                           VERTICES "property float a\033b\n" FACES END
                                    "0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n",
                           LS_MESSAGE_PLY_PROPERTIES_LEFT, "a?b");

    // Zero bytes are no numbers, at the beginning of a word or within.
    static const char zero[] = VERTICES FACES END "0 0 0\n1 \0 0\n0 1 0\n3 0 1 2\n";
    static const char within[] = VERTICES FACES END "0 0 0\n1 0\0x 0\n0 1 0\n3 0 1 2\n";
    write_mesh_bytes("a.ply", zero, sizeof zero - 1);
    check_mesh_refused("a.ply", LS_MESSAGE_PLY_NUMBER, "no number");
    write_mesh_bytes("a.ply", within, sizeof within - 1);
    check_mesh_refused("a.ply", LS_MESSAGE_PLY_NUMBER, "no number");

    // More properties, and more elements, than a header may have.
    static char text[65536];
    size_t length = (size_t)sprintf(text, VERTICES);
    for (int i = 0; i < 1022; i++)
        length += (size_t)sprintf(text + length, "property float p%d\n", i);
    check_mesh_text_refused("a.ply", text, LS_MESSAGE_PLY_HEADER_LIMIT, "1024");
    length = (size_t)sprintf(text, VERTICES);
    for (int i = 0; i < 64; i++)
        length += (size_t)sprintf(text + length, "element e%d 0\n", i);
    check_mesh_text_refused("a.ply", text, LS_MESSAGE_PLY_HEADER_LIMIT, "64");
}

static void test_warned(void** state)
{
    (void)state;
    check_mesh_text_warned("a.ply",
                           VERTICES
                           "property float confidence\nproperty list uchar int w\n" FACES END
                           "0 0 0 1 0\n1 0 0 1 2 7 8\n0 1 0 1 0\n3 0 1 2\n",
                           LS_MESSAGE_PLY_PROPERTIES_LEFT, "\"confidence\", \"w\"");
    check_mesh_text_warned("a.ply",
                           "ply\nformat ascii 1.0\nelement edge 1\nproperty int a\n"
                           "property list uchar int more\nelement vertex 3\n" XYZ FACES END
                           "9 2 1 1\n" POINTS "3 0 1 2\n",
                           LS_MESSAGE_PLY_ELEMENT_LEFT, "\"edge\"");
    check_mesh_text_warned(
        "a.ply", ASCII "made by hand\nelement vertex 3\n" XYZ FACES END POINTS "3 0 1 2\n",
        LS_MESSAGE_PLY_HEADER_LINE, "\"made\"");
    check_mesh_text_warned(
        "a.ply",
        ASCII "comment TextureFile wall.png\nelement vertex 3\n" XYZ FACES END POINTS "3 0 1 2\n",
        LS_MESSAGE_PLY_TEXTURE, "wall.png");
    check_mesh_text_warned("a.ply",
                           VERTICES
                           "element face 2\nproperty list uchar int vertex_indices\n" END POINTS
                           "2 0 1\n3 0 1 2\n",
                           LS_MESSAGE_PLY_SMALL_FACES, "face 0");
    check_mesh_text_warned("a.ply", GOOD "1 2 3\n", LS_MESSAGE_PLY_TRAILING, "behind the last");
    check_mesh_text_warned("a.ply", VERTICES END POINTS, LS_MESSAGE_PLY_POINTS, "3 vertices");
}

// Every stream, strips, an order of elements the other way round, types by both names of theirs.
static void test_streams(void** state)
{
    (void)state;
    LsInput input = import_mesh_text(
        "a.ply",
        "ply\r\nformat ascii 1.0\r\nelement tristrips 1\r\nproperty list int32 int32 "
        "vertex_indices\r\n"
        "element face 1\r\nproperty list ushort uint8 vertex_index\r\nelement vertex 4\r\n"
        "property uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\nproperty uchar "
        "alpha\r\n"
        "property float64 x\r\nproperty float32 y\r\nproperty int16 z\r\nproperty float nx\r\n"
        "property float ny\r\nproperty float nz\r\nproperty float s\r\nproperty float t\r\n"
        "end_header\r\n8 0 1 2 3 -1 3 2 1\r\n4 0 1 2 3\r\n255 0 188 51 0.1 0 0 0 0 1 0.25 0.25\r\n"
        "0 0 0 255 1 0 0 0 0 1 1 0\r\n0 0 0 255 0 1 0 0 0 1 0 1\r\n0 0 0 255 1 1 -2 0 0 2 1 1\r\n");
    assert_int_equal(input.warning_count, 0);
    const LsInputMesh* mesh = &input.meshes[0];
    const uint32_t indices[15] = {0, 1, 2, 1, 3, 2, 3, 2, 1, 0, 1, 2, 0, 2, 3};
    assert_int_equal(mesh->vertex_count, 4);
    assert_int_equal(mesh->triangle_count, 5);
    assert_memory_equal(mesh->indices, indices, sizeof indices);
    assert_true(mesh->positions[0] == 0.1f && mesh->positions[11] == -2.0f);
    assert_true(mesh->streams[LS_STREAM_NORMAL].values[11] == 2.0f);
    assert_null(mesh->streams[LS_STREAM_NORMAL].indices);
    assert_true(mesh->streams[LS_STREAM_TEXCOORD_0].values[0] == 0.25f);
    assert_true(mesh->streams[LS_STREAM_TEXCOORD_0].values[1] == 0.75f);
    const float* color = mesh->streams[LS_STREAM_COLOR].values;
    assert_true(color[0] == 1.0f && color[1] == 0.0f && color[3] == 0.2f);
    assert_true(fabsf(color[2] - 0.5029f) < 1e-4f); // sRGB 188 is half the light
    ls_input_destroy(&input);

    // Colours of faces, as fractions.
    input = import_mesh_text(
        "a.ply", VERTICES "element face 2\nproperty float red\nproperty float green\n"
                          "property float blue\nproperty list uchar int vertex_indices\n" END POINTS
                          "1 0 0 3 0 1 2\n0 1 0 3 2 1 0\n");
    assert_int_equal(input.warning_count, 0);
    const LsInputStream* stream = &input.meshes[0].streams[LS_STREAM_COLOR];
    const uint32_t faces[6] = {0, 0, 0, 1, 1, 1};
    assert_int_equal(stream->count, 2);
    assert_memory_equal(stream->indices, faces, sizeof faces);
    assert_true(stream->values[0] == 1.0f && stream->values[5] == 1.0f &&
                stream->values[7] == 1.0f);
    ls_input_destroy(&input);

    // Not a number stays what it is; the bake says what is wrong with it.
    input = import_mesh_text("a.ply", VERTICES FACES END "0 nan 0\n1 -inf 0\n0 1 0\n3 0 1 2\n");
    assert_true(isnan(input.meshes[0].positions[1]) && isinf(input.meshes[0].positions[4]));
    ls_input_destroy(&input);
}

// A binary grid of triangles; returns its bytes.
static size_t print_grid(char* bytes, int side)
{
    size_t length = (size_t)sprintf(bytes,
                                    "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" XYZ
                                    "element face %d\nproperty list uchar int vertex_indices\n" END,
                                    side * side, 2 * (side - 1) * (side - 1));
    for (int i = 0; i < side * side; i++)
    {
        const float point[3] = {(float)(i % side), (float)(i / side), 0.0f};
        memcpy(bytes + length, point, sizeof point);
        length += sizeof point;
    }
    for (int i = 0; i < 2 * (side - 1) * (side - 1); i++)
    {
        const int32_t a = i / 2 / (side - 1) * side + i / 2 % (side - 1);
        const int32_t corners[2][3] = {{a, a + 1, a + side}, {a + 1, a + side + 1, a + side}};
        bytes[length++] = 3;
        memcpy(bytes + length, corners[i % 2], sizeof *corners);
        length += sizeof *corners;
    }
    return length;
}

static void count_progress(void* user, double fraction)
{
    double* last = user;
    assert_true(fraction >= *last && fraction <= 1.0);
    *last = fraction;
}

// What is granted is what the arrays hold, and no more; limits hold before anything is allocated.
static void test_limits(void** state)
{
    (void)state;
    static char bytes[4 << 20];
    double last = 0.0;
    const size_t length = print_grid(bytes, 300);
    write_mesh_bytes("a.ply", bytes, length);
    LsInput input = {.options = {.progress = count_progress, .progress_user = &last}};
    LsError error = {0};
    assert_int_equal(ls_import(&input, find_mesh_path("a.ply"), &error), LS_OK);
    const LsInputMesh* mesh = &input.meshes[0];
    assert_int_equal(mesh->triangle_count, 2 * 299 * 299);
    const uint64_t arrays = 12 * (uint64_t)mesh->vertex_count + 16 * (uint64_t)mesh->triangle_count;
    assert_int_equal(input.memory_bytes, arrays);
    assert_int_equal(input.triangle_count, mesh->triangle_count);
    assert_true(last > 0.5);
    ls_input_destroy(&input);

    LsInput small = {.options = {.max_memory = arrays - 1}};
    assert_int_equal(ls_import(&small, find_mesh_path("a.ply"), &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    assert_int_equal(small.mesh_count, 0);
    ls_input_destroy(&small);
    LsInput few = {.options = {.max_triangles = 178801}};
    assert_int_equal(ls_import(&few, find_mesh_path("a.ply"), &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_TRIANGLES);
    ls_input_destroy(&few);
    LsInput enough = {.options = {.max_triangles = 178802, .max_memory = arrays}};
    assert_int_equal(ls_import(&enough, find_mesh_path("a.ply"), &error), LS_OK);
    ls_input_destroy(&enough);
}

static void test_cut_and_damaged(void** state)
{
    (void)state;
    char bytes[4096];
    const size_t length = print_grid(bytes, 3);
    check_mesh_cut("a.ply", bytes, length, 0);
    check_mesh_damage("a.ply", bytes, length, 1000);
    const char text[] =
        VERTICES "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "element tristrips 1\nproperty list int int vertex_indices\n" FACES END
                 "0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n4 0 1 2 1\n3 0 1 2";
    check_mesh_cut("a.ply", text, sizeof text - 1, 0);
    check_mesh_damage("a.ply", text, sizeof text - 1, 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refused),         cmocka_unit_test(test_warned),
        cmocka_unit_test(test_streams),         cmocka_unit_test(test_limits),
        cmocka_unit_test(test_cut_and_damaged),
    };
    return cmocka_run_group_tests_name("import_ply", tests, make_mesh_folder, remove_mesh_folder);
}
