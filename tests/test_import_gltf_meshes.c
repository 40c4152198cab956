// test_import_gltf_meshes.c - glTF files: triangles, streams, accessors of every type.

#include "gltf_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Triangles ----------------------------------------------------------------------------------

static void test_modes(void** state)
{
    (void)state;
    // A strip and a fan in the order of the vertices, a list of indices of each width, points.
    gltf_begin_corners(7);
    const uint8_t narrow[6] = {6, 5, 4, 0, 1, 2};
    const uint16_t middle[6] = {3, 1, 2, 0, 1, 6};
    const uint32_t wide[3] = {2, 1, 0};
    gltf_add_accessor(gltf_add_view(narrow, 6, 0), 0, U8, 6, "SCALAR", "");
    gltf_add_words(middle, 6);
    gltf_add_accessor(gltf_add_view(wide, 12, 0), 0, U32, 3, "SCALAR", "");
    gltf_write(ONE_NODE ",\"meshes\":[{\"primitives\":[{" POSITION ",\"mode\":5},{" POSITION
                        ",\"mode\":6,\"indices\":1},{" POSITION ",\"indices\":2},{" POSITION
                        ",\"indices\":3},{" POSITION ",\"mode\":0},{" POSITION ",\"mode\":3}]}]");
    LsInput input = gltf_import("a.gltf");
    const LsInputMesh* mesh = &input.meshes[0];
    const uint32_t expected[][3] = {
        {0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}, {4, 5, 6}, // strip
        {5, 4, 6}, {4, 0, 6}, {0, 1, 6}, {1, 2, 6},            // fan
        {3, 1, 2}, {0, 1, 6}, {2, 1, 0},
    };
    assert_int_equal(mesh->vertex_count, 7); // shared by the primitives
    assert_int_equal(mesh->triangle_count, sizeof expected / sizeof *expected);
    assert_memory_equal(mesh->indices, expected, sizeof expected);
    assert_memory_equal(mesh->positions, gltf_corners, sizeof gltf_corners);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_POINTS_LINES,
                      "mesh 0, primitive 4 (POINTS), mesh 0, primitive 5 (LINE_STRIP)");
    ls_input_destroy(&input);

    gltf_check_members_refused(ONE_NODE "," PRIMITIVE(POSITION ",\"mode\":7"),
                               LS_MESSAGE_GLTF_MEMBER, "mode 7");
    gltf_check_members_refused(PLAIN, LS_MESSAGE_GLTF_CORNERS, "multiple of three");
    gltf_begin_corners(2);
    gltf_check_members_refused(ONE_NODE "," PRIMITIVE(POSITION ",\"mode\":5"),
                               LS_MESSAGE_GLTF_CORNERS, "2 corners");
    gltf_write(ONE_NODE "," PRIMITIVE("\"attributes\":{\"NORMAL\":0}"));
    input = gltf_import("a.gltf");
    assert_int_equal(input.mesh_count, 0);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_NO_POSITION,
                      "mesh 0 (\"thing\"), primitive 0");
    ls_input_destroy(&input);
}

static void test_streams(void** state)
{
    (void)state;
    gltf_begin_corners(3);
    const float normals[9] = {0, 0, 2, 0, 1, 0, 1, 0, 0};
    const float texcoords[6] = {0.25f, -0.5f, 1, 2, 3, 4};
    const uint8_t bytes[6] = {0, 255, 51, 102, 255, 0};
    const uint16_t rgb[12] = {0, 65535, 13107, 0, 65535, 0, 0, 0, 13107, 0, 0, 0}; // stride 8
    gltf_add_floats(normals, 3, 3);
    gltf_add_floats(texcoords, 3, 2);
    gltf_add_accessor(gltf_add_view(bytes, 6, 0), 0, U8, 3, "VEC2", "\"normalized\":true");
    gltf_add_accessor(gltf_add_view(rgb, 24, 8), 0, U16, 3, "VEC3", "\"normalized\":true");
    // The second primitive has other attributes, so its vertices are its own.
    gltf_write(ONE_NODE
               ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
               "\"TEXCOORD_0\":2,\"TEXCOORD_1\":3,\"COLOR_0\":4}},{" POSITION "}]}]");
    LsInput input = gltf_import("a.gltf");
    const LsInputMesh* mesh = &input.meshes[0];
    assert_int_equal(mesh->vertex_count, 6);
    assert_int_equal(mesh->indices[3], 3);
    for (int k = 0; k < LS_STREAM_COUNT; k++)
    {
        assert_int_equal(mesh->streams[k].count, 6);
        assert_null(mesh->streams[k].indices);
    }
    const float none[9] = {0};
    const float set1[6] = {0, 1, 0.2f, 0.4f, 1, 0};
    const float colors[12] = {0, 1, 0.2f, 1, 1, 0, 0, 1, 0.2f, 0, 0, 1};
    assert_memory_equal(mesh->streams[LS_STREAM_NORMAL].values, normals, sizeof normals);
    assert_memory_equal(mesh->streams[LS_STREAM_NORMAL].values + 9, none, sizeof none);
    assert_memory_equal(mesh->streams[LS_STREAM_TEXCOORD_0].values, texcoords, sizeof texcoords);
    assert_memory_equal(mesh->streams[LS_STREAM_TEXCOORD_1].values, set1, sizeof set1);
    assert_memory_equal(mesh->streams[LS_STREAM_COLOR].values, colors, sizeof colors);
    for (int i = 12; i < 24; i++)
        assert_true(mesh->streams[LS_STREAM_COLOR].values[i] == 1.0f);
    assert_int_equal(input.warning_count, 0);
    ls_input_destroy(&input);

    // Floats that are beyond [0,1] or none, and attributes that are not taken.
    gltf_begin_corners(3);
    const float wild[12] = {-1, 0.5f, 2, NAN, 0, 0, 0, 0, 1, 1, 1, INFINITY};
    const float lost[9] = {NAN, 0, 0, 0, 0, 1, 0, INFINITY, 0};
    gltf_add_floats(wild, 3, 4);
    gltf_add_floats(lost, 3, 3);
    gltf_write(ONE_NODE
               "," PRIMITIVE("\"attributes\":{\"POSITION\":0,\"COLOR_0\":1,\"NORMAL\":2,"
                             "\"TANGENT\":1,\"TEXCOORD_2\":2,\"_HEAT\":1,\"JOINTS_0\":0}"));
    input = gltf_import("a.gltf");
    const float* color = input.meshes[0].streams[LS_STREAM_COLOR].values;
    for (int i = 0; i < 4; i++)
        assert_true(color[i] == 1.0f);
    assert_true(color[4] == 0.0f && color[7] == 0.0f && color[11] == 1.0f);
    const float kept[9] = {0, 0, 0, 0, 0, 1, 0, 0, 0};
    assert_memory_equal(input.meshes[0].streams[LS_STREAM_NORMAL].values, kept, sizeof kept);
    assert_string_equal(input.meshes[0].name, "thing");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_NOT_FINITE,
                      "2 of NORMAL of mesh 0 (\"thing\"), primitive 0, 1 of COLOR_0");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_ATTRIBUTE, "tangents");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_ATTRIBUTE,
                      "TEXCOORD_2 of mesh 0 (\"thing\"), primitive 0, _HEAT of");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_SKIN, "joints");
    ls_input_destroy(&input);

    gltf_begin_corners(3);
    gltf_add_floats(normals, 2, 3);
    gltf_check_members_refused(
        ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":0,\"NORMAL\":1}"),
        LS_MESSAGE_GLTF_ATTRIBUTE_COUNT, "NORMAL has 2 elements for 3 positions");
}

// Positions, normals and texture coordinates of every integer type, normalized or not.
static void test_quantized(void** state)
{
    (void)state;
    static const int components[] = {I8, U8, I16, U16};
    static const float largest[] = {127, 255, 32767, 65535};
    for (int i = 0; i < 8; i++)
    {
        const bool is_normalized = i & 1;
        const int c = i / 2;
        const size_t width = c < 2 ? 1 : 2;
        uint8_t points[36] = {0}; // at a stride of 12
        for (int v = 0; v < 3; v++)
            for (int k = 0; k < 3; k++)
            {
                // 100 at (v, v); the least of signed types, which means -1, at (2, 1).
                const int value = v == 2 && k == 1 && c % 2 == 0 ? (c == 0 ? -128 : -32768)
                                  : v == k                       ? 100
                                                                 : 0;
                const uint16_t low = (uint16_t)value;
                memcpy(points + 12 * v + k * (int)width, &low, width);
            }
        gltf_begin();
        const int view = gltf_add_view(points, sizeof points, 12);
        const char* more = is_normalized ? "\"normalized\":true" : "";
        gltf_add_accessor(view, 0, components[c], 3, "VEC3", more);
        gltf_add_accessor(view, 0, components[c], 3, "VEC2", more);
        const char* const members =
            "\"extensionsUsed\":[\"KHR_mesh_quantization\"],"
            "\"extensionsRequired\":[\"KHR_mesh_quantization\"]," ONE_NODE "," //
            PRIMITIVE("\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1}");
        gltf_write(members);
        LsInput input = gltf_import("a.gltf");
        const float hundred = is_normalized ? 100.0f / largest[c] : 100.0f;
        const float least = c % 2 ? 0.0f : is_normalized ? -1.0f : c == 0 ? -128.0f : -32768.0f;
        const float expected[9] = {hundred, 0, 0, 0, hundred, 0, 0, least, hundred};
        const float expected_uv[6] = {hundred, 0, 0, hundred, 0, least};
        assert_memory_equal(input.meshes[0].positions, expected, sizeof expected);
        assert_memory_equal(input.meshes[0].streams[LS_STREAM_TEXCOORD_0].values, expected_uv,
                            sizeof expected_uv);
        assert_int_equal(input.warning_count, 0);
        ls_input_destroy(&input);
        // Normals: signed and normalized alone; without the extension no positions at all.
        gltf_write("\"extensionsUsed\":[\"KHR_mesh_quantization\"]," ONE_NODE "," //
                   PRIMITIVE("\"attributes\":{\"POSITION\":0,\"NORMAL\":0}"));
        if (is_normalized && c % 2 == 0)
        {
            input = gltf_import("a.gltf");
            assert_memory_equal(input.meshes[0].streams[LS_STREAM_NORMAL].values, expected,
                                sizeof expected);
            ls_input_destroy(&input);
        }
        else
            gltf_check_refused("a.gltf", LS_MESSAGE_GLTF_ACCESSOR_TYPE, "normals");
        gltf_check_members_refused(PLAIN, LS_MESSAGE_GLTF_ACCESSOR_TYPE,
                                   "without KHR_mesh_quantization");
    }
}

// ---- Accessors ----------------------------------------------------------------------------------

static void test_accessor_types(void** state)
{
    (void)state;
    gltf_begin_corners(3);
    const int view = gltf_add_view(gltf_corners, sizeof gltf_corners, 0);
    gltf_add_accessor(view, 0, U8, 3, "SCALAR", "");                     // 1
    gltf_add_accessor(view, 0, F32, 3, "VEC2", "");                      // 2
    gltf_add_accessor(view, 0, I16, 3, "SCALAR", "");                    // 3
    gltf_add_accessor(view, 0, U16, 3, "SCALAR", "\"normalized\":true"); // 4
    gltf_add_accessor(view, 0, U8, 3, "VEC3", "");                       // 5
    gltf_add_accessor(view, 0, 5124, 3, "VEC3", "\"normalized\":true");  // 6
    gltf_add_accessor(view, 0, 5130, 3, "VEC3", "");                     // 7
    gltf_add_accessor(view, 0, F32, 2, "MAT2", "");                      // 8
    gltf_add_accessor(view, 0, F32, 3, "VEC3", "\"normalized\":true");   // 9: says nothing
    static const struct
    {
        const char* primitive;
        const char* word;
    } cases[] = {
        {"\"attributes\":{\"POSITION\":1}",
         "positions of a type that is not legal: SCALAR of unsigned bytes"},
        {"\"attributes\":{\"POSITION\":2}", "VEC2 of floats"},
        {"\"attributes\":{\"POSITION\":6}", "VEC3 of normalized signed 32 bit"},
        {"\"attributes\":{\"POSITION\":7}", "unknown component type"},
        {"\"attributes\":{\"POSITION\":8}", "a matrix"},
        {POSITION ",\"indices\":0", "indices of a type"},
        {POSITION ",\"indices\":3", "signed shorts"},
        {POSITION ",\"indices\":4", "normalized unsigned shorts"},
        {"\"attributes\":{\"POSITION\":0,\"NORMAL\":2}", "NORMAL, accessor 2"},
        {"\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":0}", "TEXCOORD_0"},
        {"\"attributes\":{\"POSITION\":0,\"TEXCOORD_1\":5}", "TEXCOORD_1"},
        {"\"attributes\":{\"POSITION\":0,\"COLOR_0\":5}", "colours"},
        {"\"attributes\":{\"POSITION\":0,\"COLOR_0\":2}", "colours"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        char members[512];
        snprintf(members, sizeof members, ONE_NODE ",\"meshes\":[{\"primitives\":[{%s}]}]",
                 cases[i].primitive);
        gltf_check_members_refused(members, LS_MESSAGE_GLTF_ACCESSOR_TYPE, cases[i].word);
    }
    gltf_write(ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":9}"));
    LsInput input = gltf_import("a.gltf");
    assert_memory_equal(input.meshes[0].positions, gltf_corners, 36);
    ls_input_destroy(&input);
}

static void test_interleaved(void** state)
{
    (void)state;
    float mixed[3][8];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 8; k++)
            mixed[i][k] = k < 3 ? gltf_corners[i][k] : (float)(10 * i + k);
    gltf_begin();
    // The last element ends with its view, though a whole stride would not.
    const int view = gltf_add_view(mixed, sizeof mixed, 32);
    gltf_add_accessor(view, 0, F32, 3, "VEC3", "");
    gltf_add_accessor(view, 12, F32, 3, "VEC3", "");
    gltf_add_accessor(view, 24, F32, 3, "VEC2", "");
    const char* members =
        ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2}");
    gltf_write(members);
    LsInput input = gltf_import("a.gltf");
    const LsInputMesh* mesh = &input.meshes[0];
    assert_memory_equal(mesh->positions, gltf_corners, 36);
    for (int i = 0; i < 3; i++)
    {
        for (int k = 0; k < 3; k++)
            assert_true(mesh->streams[LS_STREAM_NORMAL].values[3 * i + k] ==
                        (float)(10 * i + 3 + k));
        for (int k = 0; k < 2; k++)
            assert_true(mesh->streams[LS_STREAM_TEXCOORD_0].values[2 * i + k] ==
                        (float)(10 * i + 6 + k));
    }
    ls_input_destroy(&input);

    gltf_begin();
    gltf_add_accessor(gltf_add_view(mixed, sizeof mixed, 8), 0, F32, 3, "VEC3", "");
    gltf_check_members_refused(PLAIN, LS_MESSAGE_GLTF_ACCESSOR, "12 bytes at a stride of 8");
    gltf_begin();
    gltf_add_accessor(gltf_add_view(mixed, sizeof mixed, 6), 0, F32, 3, "VEC3", "");
    gltf_check_members_refused(PLAIN, LS_MESSAGE_GLTF_JSON, "byteStride");
}

static void test_sparse(void** state)
{
    (void)state;
    static const int components[] = {U8, U16, U32};
    for (int i = 0; i < 6; i++)
    {
        const bool has_base = i & 1;
        uint8_t places[8] = {0};
        const uint32_t numbers[2] = {1, 2};
        const size_t width = i < 2 ? 1 : i < 4 ? 2 : 4;
        for (size_t k = 0; k < 2; k++)
            memcpy(places + k * width, &numbers[k], width);
        gltf_begin();
        const int base = gltf_add_view(gltf_corners, 36, 0);
        const int indices = gltf_add_view(places, 2 * width, 0);
        const int values = gltf_add_view(&gltf_corners[4], 24, 0);
        char more[256];
        snprintf(more, sizeof more,
                 "\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":%d,\"componentType\":%d},"
                 "\"values\":{\"bufferView\":%d}}",
                 indices, components[i / 2], values);
        gltf_add_accessor(has_base ? base : -1, 0, F32, 3, "VEC3", more);
        gltf_write(PLAIN);
        LsInput input = gltf_import("a.gltf");
        assert_memory_equal(input.meshes[0].positions, gltf_corners[0], 12);
        assert_memory_equal(input.meshes[0].positions + 3, gltf_corners[4], 24);
        ls_input_destroy(&input);
    }
    // Indices themselves, with a base.
    gltf_begin_corners(7);
    const uint16_t flat[3] = {0, 0, 0}, places[2] = {1, 2}, fresh[2] = {5, 6};
    const int base = gltf_add_view(flat, 6, 0);
    char more[256];
    snprintf(more, sizeof more,
             "\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":%d,\"componentType\":5123},"
             "\"values\":{\"bufferView\":%d}}",
             gltf_add_view(places, 4, 0), gltf_add_view(fresh, 4, 0));
    gltf_add_accessor(base, 0, U16, 3, "SCALAR", more);
    gltf_write(ONE_NODE "," PRIMITIVE(POSITION ",\"indices\":1"));
    LsInput input = gltf_import("a.gltf");
    const uint32_t expected[3] = {0, 5, 6};
    assert_memory_equal(input.meshes[0].indices, expected, sizeof expected);
    ls_input_destroy(&input);

#define SPARSE(count, component, offset)                                                         \
    "\"sparse\":{\"count\":" count ",\"indices\":{\"bufferView\":0,\"componentType\":" component \
    ",\"byteOffset\":" offset "},\"values\":{\"bufferView\":1}}"
    static const struct
    {
        const char* sparse;
        uint16_t places[2];
        LsMessage message;
        const char* word;
    } wrong[] = {
        {SPARSE("2", "5123", "0"), {2, 1}, LS_MESSAGE_GLTF_ACCESSOR, "do not rise"},
        {SPARSE("2", "5123", "0"), {1, 1}, LS_MESSAGE_GLTF_ACCESSOR, "do not rise"},
        {SPARSE("2", "5123", "0"), {1, 3}, LS_MESSAGE_GLTF_VERTEX_INDEX, "sparse index 3"},
        {SPARSE("4", "5123", "0"), {1, 2}, LS_MESSAGE_GLTF_ACCESSOR, "replaces 4 of its 3"},
        {SPARSE("2", "5122", "0"), {1, 2}, LS_MESSAGE_GLTF_ACCESSOR_TYPE, "sparse indices"},
        {SPARSE("2", "5123", "2"), {1, 2}, LS_MESSAGE_GLTF_BOUNDS, "sparse indices"},
        {SPARSE("3", "5121", "0"), {1, 2}, LS_MESSAGE_GLTF_BOUNDS, "sparse values"},
        {SPARSE("-1", "5123", "0"), {1, 2}, LS_MESSAGE_GLTF_MEMBER, "accessors[0].sparse.count"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    {
        gltf_begin();
        gltf_add_view(wrong[i].places, 4, 0);
        gltf_add_view(gltf_corners, 24, 0);
        gltf_add_accessor(-1, 0, F32, 3, "VEC3", wrong[i].sparse);
        gltf_check_members_refused(PLAIN, wrong[i].message, wrong[i].word);
    }
    // No bytes at all: zero, but not any number of zeros.
    gltf_begin();
    gltf_add_accessor(-1, 0, F32, 3, "VEC3", "");
    gltf_write(PLAIN);
    input = gltf_import("a.gltf");
    const float zeros[9] = {0};
    assert_memory_equal(input.meshes[0].positions, zeros, sizeof zeros);
    ls_input_destroy(&input);
    gltf_begin();
    gltf_add_accessor(-1, 0, F32, 4000000000u, "VEC3", "");
    gltf_check_members_refused(PLAIN, LS_MESSAGE_GLTF_COUNT, "no buffer view");
}

// A buffer of three corners and six indices, described by the caller's view and accessors.
static void check_bounds(const char* view, const char* positions, const char* indices,
                         LsMessage message, const char* word)
{
    char text[4096];
    uint8_t bytes[48] = {0};
    memcpy(bytes, gltf_corners, 36);
    memcpy(bytes + 36, (uint16_t[6]){0, 1, 2, 0, 1, 3}, 12);
    gltf_write_bytes("a.bin", bytes, sizeof bytes);
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":48,\"uri\":\"a.bin\"}],"
             "\"bufferViews\":[%s],\"accessors\":[%s,%s]," ONE_NODE
             "," PRIMITIVE(POSITION ",\"indices\":1") "}",
             view, positions, indices);
    gltf_write_bytes("a.gltf", text, strlen(text));
    if (message)
    {
        gltf_check_refused("a.gltf", message, word);
        return;
    }
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.meshes[0].triangle_count, 1);
    assert_memory_equal(input.meshes[0].positions, gltf_corners, 36);
    ls_input_destroy(&input);
}

static void test_bounds(void** state)
{
    (void)state;
#define VIEW "{\"buffer\":0,\"byteLength\":48}"
#define INDICES(offset, count)                                                            \
    "{\"bufferView\":0,\"byteOffset\":" offset ",\"componentType\":5123,\"count\":" count \
    ",\"type\":\"SCALAR\"}"
    check_bounds(VIEW, POINTS, INDICES("36", "3"), 0, "");
    check_bounds(VIEW, POINTS, INDICES("36", "6"), LS_MESSAGE_GLTF_VERTEX_INDEX, "index 3");
    check_bounds(VIEW, POINTS, INDICES("44", "3"), LS_MESSAGE_GLTF_BOUNDS, "beyond its buffer");
    check_bounds(VIEW, POINTS, INDICES("49", "3"), LS_MESSAGE_GLTF_BOUNDS, "beyond its buffer");
    check_bounds(VIEW, POINTS, INDICES("36", "4294967298"), LS_MESSAGE_GLTF_COUNT, "4294967298");
    check_bounds(VIEW, POINTS, INDICES("36", "4000000000"), LS_MESSAGE_GLTF_BOUNDS, "beyond");
    check_bounds(VIEW, POINTS, INDICES("9007199254740992", "3"), LS_MESSAGE_GLTF_BOUNDS, "beyond");
    check_bounds(VIEW, POINTS, INDICES("18446744073709551612", "3"), LS_MESSAGE_GLTF_MEMBER,
                 "accessors[1].byteOffset");
    check_bounds(VIEW, POINTS, INDICES("1.5", "3"), LS_MESSAGE_GLTF_MEMBER, "byteOffset");
    check_bounds(VIEW, POINTS, INDICES("36", "-3"), LS_MESSAGE_GLTF_MEMBER, "count");
    check_bounds(VIEW, POINTS, INDICES("36", "1e400"), LS_MESSAGE_GLTF_MEMBER, "larger than any");
    check_bounds("{\"buffer\":0,\"byteLength\":49}", POINTS, INDICES("36", "3"),
                 LS_MESSAGE_GLTF_BOUNDS, "beyond its buffer");
    check_bounds("{\"buffer\":0,\"byteOffset\":9007199254740000,\"byteLength\":48}", POINTS,
                 INDICES("36", "3"), LS_MESSAGE_GLTF_BOUNDS, "beyond its buffer");
    check_bounds("{\"buffer\":2,\"byteLength\":48}", POINTS, INDICES("36", "3"),
                 LS_MESSAGE_GLTF_INDEX, "buffer 2");
    // tinygltf would make 0 of it.
    check_bounds("{\"buffer\":4294967296,\"byteLength\":48}", POINTS, INDICES("36", "3"),
                 LS_MESSAGE_GLTF_MEMBER, "bufferViews[0].buffer");
    check_bounds(VIEW, POINTS, "{\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}",
                 LS_MESSAGE_GLTF_ACCESSOR, "no buffer view");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_modes),       cmocka_unit_test(test_streams),
        cmocka_unit_test(test_quantized),   cmocka_unit_test(test_accessor_types),
        cmocka_unit_test(test_interleaved), cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_bounds),
    };
    return cmocka_run_group_tests_name("import_gltf_meshes", tests, gltf_make_folder,
                                       gltf_remove_folder);
}
