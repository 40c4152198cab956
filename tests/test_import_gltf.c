// test_import_gltf.c - glTF files: JSON, GLB, buffers, accessors, meshes, nodes, animation.

#include "gltf_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define ONE_NODE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}]"
#define PRIMITIVE(text) "\"meshes\":[{\"name\":\"thing\",\"primitives\":[{" text "}]}]"
#define POSITION "\"attributes\":{\"POSITION\":0}"
#define PLAIN ONE_NODE "," PRIMITIVE(POSITION)

static const float corners[7][3] = {
    {0, 0, 0},     {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, -1.25f, 0.1f}, {1e-7f, 2.5e6f, -0.3f},
    {2, 0, -0.0f},
};

// Accessor 0: so many of the corners.
static void begin_corners(size_t count)
{
    gltf_begin();
    assert_int_equal(gltf_add_floats(&corners[0][0], count, 3), 0);
}

static void check_refused(const char* members, LsMessage message, const char* word)
{
    gltf_write(members);
    gltf_check_refused("a.gltf", message, word);
}

// ---- Triangles ----------------------------------------------------------------------------------

static void test_modes(void** state)
{
    (void)state;
    // A strip and a fan in the order of the vertices, a list of indices of each width, points.
    begin_corners(7);
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
    assert_memory_equal(mesh->positions, corners, sizeof corners);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_POINTS_LINES,
                      "mesh 0, primitive 4 (POINTS), mesh 0, primitive 5 (LINE_STRIP)");
    ls_input_destroy(&input);

    check_refused(ONE_NODE "," PRIMITIVE(POSITION ",\"mode\":7"), LS_MESSAGE_GLTF_MEMBER, "mode 7");
    check_refused(PLAIN, LS_MESSAGE_GLTF_CORNERS, "multiple of three");
    begin_corners(2);
    check_refused(ONE_NODE "," PRIMITIVE(POSITION ",\"mode\":5"), LS_MESSAGE_GLTF_CORNERS,
                  "2 corners");
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
    begin_corners(3);
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
    begin_corners(3);
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

    begin_corners(3);
    gltf_add_floats(normals, 2, 3);
    check_refused(ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":0,\"NORMAL\":1}"),
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
        check_refused(PLAIN, LS_MESSAGE_GLTF_ACCESSOR_TYPE, "without KHR_mesh_quantization");
    }
}

// ---- Accessors ----------------------------------------------------------------------------------

static void test_accessor_types(void** state)
{
    (void)state;
    begin_corners(3);
    const int view = gltf_add_view(corners, sizeof corners, 0);
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
        check_refused(members, LS_MESSAGE_GLTF_ACCESSOR_TYPE, cases[i].word);
    }
    gltf_write(ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":9}"));
    LsInput input = gltf_import("a.gltf");
    assert_memory_equal(input.meshes[0].positions, corners, 36);
    ls_input_destroy(&input);
}

static void test_interleaved(void** state)
{
    (void)state;
    float mixed[3][8];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 8; k++)
            mixed[i][k] = k < 3 ? corners[i][k] : (float)(10 * i + k);
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
    assert_memory_equal(mesh->positions, corners, 36);
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
    check_refused(PLAIN, LS_MESSAGE_GLTF_ACCESSOR, "12 bytes at a stride of 8");
    gltf_begin();
    gltf_add_accessor(gltf_add_view(mixed, sizeof mixed, 6), 0, F32, 3, "VEC3", "");
    check_refused(PLAIN, LS_MESSAGE_GLTF_JSON, "byteStride");
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
        const int base = gltf_add_view(corners, 36, 0);
        const int indices = gltf_add_view(places, 2 * width, 0);
        const int values = gltf_add_view(&corners[4], 24, 0);
        char more[256];
        snprintf(more, sizeof more,
                 "\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":%d,\"componentType\":%d},"
                 "\"values\":{\"bufferView\":%d}}",
                 indices, components[i / 2], values);
        gltf_add_accessor(has_base ? base : -1, 0, F32, 3, "VEC3", more);
        gltf_write(PLAIN);
        LsInput input = gltf_import("a.gltf");
        assert_memory_equal(input.meshes[0].positions, corners[0], 12);
        assert_memory_equal(input.meshes[0].positions + 3, corners[4], 24);
        ls_input_destroy(&input);
    }
    // Indices themselves, with a base.
    begin_corners(7);
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
        gltf_add_view(corners, 24, 0);
        gltf_add_accessor(-1, 0, F32, 3, "VEC3", wrong[i].sparse);
        check_refused(PLAIN, wrong[i].message, wrong[i].word);
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
    check_refused(PLAIN, LS_MESSAGE_GLTF_COUNT, "no buffer view");
}

// A buffer of three corners and six indices, described by the caller's view and accessors.
static void check_bounds(const char* view, const char* positions, const char* indices,
                         LsMessage message, const char* word)
{
    char text[4096];
    uint8_t bytes[48] = {0};
    memcpy(bytes, corners, 36);
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
    assert_memory_equal(input.meshes[0].positions, corners, 36);
    ls_input_destroy(&input);
}

static void test_bounds(void** state)
{
    (void)state;
#define VIEW "{\"buffer\":0,\"byteLength\":48}"
#define POINTS "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}"
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

// ---- Files --------------------------------------------------------------------------------------

static void test_buffers(void** state)
{
    (void)state;
    // Embedded, under any media type; a name of letters that a URI must escape; a file that is
    // longer than its buffer; a plus that is a plus.
    uint8_t bytes[40] = {0};
    memcpy(bytes, corners, 36);
    begin_corners(3);
    static const char* const uris[] = {"application/octet-stream", "application/gltf-buffer",
                                       "something/else;charset=x", ""};
    for (int i = 0; i < 7; i++)
    {
        const char* uri = i < 4    ? gltf_print_data_uri(uris[i], bytes, 36)
                          : i == 4 ? "b%20%c3%A4.bin"
                          : i == 5
                              ? "./b+c.bin"
                              : "data:,%00%00%00%00%00%00%00%00%00%00%00%00%00%00%80%3f%00%00%00"
                                "%00%00%00%00%00%00%00%00%00%00%00%80%3f%00%00%00%00";
        gltf_write_bytes("b \xc3\xa4.bin", bytes, sizeof bytes);
        gltf_write_bytes("b+c.bin", bytes, 36);
        const char* text = gltf_print(uri, PLAIN);
        gltf_write_bytes("a.gltf", text, strlen(text));
        LsInput input = gltf_import("a.gltf");
        assert_memory_equal(input.meshes[0].positions, corners, 36);
        ls_input_destroy(&input);
    }
    mkfifo(gltf_find_path("pipe"), 0600);
    mkdir(gltf_find_path("sub"), 0700);
    gltf_write_bytes("short.bin", bytes, 35);
    static const struct
    {
        const char* uri;
        const char* word;
    } wrong[] = {
        {"absent.bin", "absent.bin"},
        {"short.bin", "should have 36 bytes, but there are 35"},
        {"pipe", "no regular file"},
        {"sub", "no regular file"},
        {"", "names no file"},
        {"a%00b", "names no file"},
        {"http://localhost/a.bin", "http://localhost/a.bin"},
        {"file:///etc/passwd", "no file beside the scene"},
        {"data:application/octet-stream", "no comma"},
        {"data:;base64,AAA*", "not base64"},
        {"data:;base64,AAAA", "there are 3"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    {
        const char* text = gltf_print(wrong[i].uri, PLAIN);
        gltf_write_bytes("a.gltf", text, strlen(text));
        gltf_check_refused("a.gltf", LS_MESSAGE_GLTF_BUFFER, wrong[i].word);
    }
    rmdir(gltf_find_path("sub"));
    const char* text = gltf_print(NULL, PLAIN);
    gltf_write_bytes("a.gltf", text, strlen(text));
    gltf_check_refused("a.gltf", LS_MESSAGE_GLTF_BUFFER, "has no bytes");
}

static void check_glb(const uint8_t* bytes, size_t size, LsMessage message, const char* word)
{
    gltf_write_bytes("a.glb", bytes, size);
    gltf_check_refused("a.glb", message, word);
}

static void test_glb(void** state)
{
    (void)state;
    static uint8_t bytes[1 << 16];
    begin_corners(3);
    const size_t size = gltf_print_glb(PLAIN, bytes);
    gltf_write_bytes("a.glb", bytes, size);
    LsInput input = gltf_import("a.glb");
    assert_memory_equal(input.meshes[0].positions, corners, 36);
    ls_input_destroy(&input);
    gltf_write_bytes("a.gltf", bytes, size); // what it is counts, not its name
    input = gltf_import("a.gltf");
    assert_int_equal(input.triangle_count, 1);
    ls_input_destroy(&input);

    // The binary chunk one byte longer than the file; its header cut.
    uint32_t json_bytes, word;
    memcpy(&json_bytes, bytes + 12, 4);
    uint8_t* chunk = bytes + 20 + json_bytes;
    word = 40;
    memcpy(chunk, &word, 4);
    check_glb(bytes, size, LS_MESSAGE_GLTF_GLB, "chunk 1");
    word = 36;
    memcpy(chunk, &word, 4);
    word = 28 + json_bytes - 4;
    memcpy(bytes + 8, &word, 4);
    check_glb(bytes, size, LS_MESSAGE_GLTF_GLB, "header of a chunk");
    word = (uint32_t)size + 1;
    memcpy(bytes + 8, &word, 4);
    check_glb(bytes, size, LS_MESSAGE_GLTF_GLB, "but the file has");
    word = (uint32_t)size;
    memcpy(bytes + 8, &word, 4);
    bytes[16] = 'X';
    check_glb(bytes, size, LS_MESSAGE_GLTF_GLB, "not JSON");
    bytes[16] = 'J';
    bytes[4] = 1;
    check_glb(bytes, size, LS_MESSAGE_GLTF_VERSION, "version 1");
    bytes[4] = 2;
    check_glb((const uint8_t*)"glTF\2\0\0\0\14\0\0\0", 12, LS_MESSAGE_GLTF_GLB, "header");
    check_glb((const uint8_t*)"glTF\2\0\0\0\24\0\0\0\0\0\0\0JSON", 20, LS_MESSAGE_GLTF_GLB,
              "no JSON");
    check_glb((const uint8_t*)"some text that is no GLB", 24, LS_MESSAGE_GLTF_GLB, "no GLB");
    // A chunk of a kind that is not known in the binary one's place: no bytes then.
    chunk[4] = 'X';
    check_glb(bytes, size, LS_MESSAGE_GLTF_BUFFER, "no bytes");
    chunk[4] = 'B';
    gltf_write_bytes("a.glb", bytes, size);
    input = gltf_import("a.glb");
    ls_input_destroy(&input);
}

static void check_json(const char* text, LsMessage message, const char* word)
{
    gltf_write_bytes("a.gltf", text, strlen(text));
    gltf_check_refused("a.gltf", message, word);
}

static void test_json(void** state)
{
    (void)state;
    check_json("{", LS_MESSAGE_GLTF_JSON, "line 1, column");
    check_json("a letter", LS_MESSAGE_GLTF_JSON, "malformed");
    check_json("[1,2,3]", LS_MESSAGE_GLTF_JSON, "no object");
    check_json("{\"asset\":{\"version\":\"2.0\"}} x", LS_MESSAGE_GLTF_JSON, "line 1, column 29");
    check_json("{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"name\":\"\xff\"}]}",
               LS_MESSAGE_GLTF_JSON, "UTF-8");
    check_json("{\"nodes\":[]}", LS_MESSAGE_GLTF_VERSION, "no asset");
    check_json("{\"asset\":{\"version\":2}}", LS_MESSAGE_GLTF_VERSION, "no asset");
    check_json("{\"asset\":{\"version\":\"1.0\"},\"nodes\":{}}", LS_MESSAGE_GLTF_VERSION,
               "glTF 1.0");
    check_json("{\"asset\":{\"version\":\"2.1\",\"minVersion\":\"2.1\"}}", LS_MESSAGE_GLTF_VERSION,
               "glTF 2.1");
    // A key that a search for "buffers" in the text would miss.
    check_json("{\"asset\":{\"version\":\"2.0\"},\"b\\u0075ffers\":[{\"byteLength\":4,"
               "\"uri\":\"a.bin\"}]}",
               LS_MESSAGE_GLTF_JSON, "a.bin");

    // Nested so deep that a parser's stack would not do.
    static char deep[200100];
    size_t length = (size_t)sprintf(deep, "{\"asset\":{\"version\":\"2.0\"},\"extras\":");
    memset(deep + length, '[', 200000);
    deep[length + 200000] = '\0';
    check_json(deep, LS_MESSAGE_GLTF_JSON_DEPTH, "128 levels");
    // Brackets in strings do not nest; blanked members may be anywhere and of any spacing.
    sprintf(deep + length, "\"[[[[\\\"[[[\",\"images\" : [],\"buffers\":\n[ ] }");
    gltf_write_bytes("a.gltf", deep, strlen(deep));
    LsInput input = gltf_import("a.gltf");
    ls_input_destroy(&input);
    gltf_write_bytes("a.gltf", "\xef\xbb\xbf{\"asset\":{\"version\":\"2.0\"}}\n \t\r\n\0\0", 35);
    input = gltf_import("a.gltf");
    ls_input_destroy(&input);
}

// Members that tinygltf would take for missing ones, or cut.
static void test_members(void** state)
{
    (void)state;
    static const struct
    {
        const char* members;
        const char* word;
    } cases[] = {
        {"\"nodes\":[{\"scale\":[\"a\",1,1]}]", "nodes[0].scale[0] is no number"},
        {"\"nodes\":[{},{\"scale\":[1,1]}]", "nodes[1].scale has 2 numbers instead of 3"},
        {"\"nodes\":[{\"rotation\":{}}]", "nodes[0].rotation is no array of numbers"},
        {"\"nodes\":[{\"translation\":[1,2,null]}]", "nodes[0].translation[2]"},
        {"\"nodes\":[{\"matrix\":\"unit\"}]", "nodes[0].matrix"},
        {"\"nodes\":[{\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0]}]", "12 numbers instead of 16"},
        {"\"nodes\":[{\"mesh\":4294967296}]", "nodes[0].mesh is no whole number"},
        {"\"nodes\":[{\"mesh\":-1}]", "nodes[0].mesh"},
        {"\"nodes\":[{\"mesh\":0.5}]", "nodes[0].mesh"},
        {"\"nodes\":[{\"mesh\":0,\"mesh\":\"b\"}]", "nodes[0].mesh is no number"},
        {"\"nodes\":[{\"children\":[true]}]", "nodes[0].children[0]"},
        {"\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{}}}]", "light is missing"},
        {"\"nodes\":[3]", "nodes[0] is no object"},
        {"\"nodes\":{}", "nodes is no array of objects"},
        {"\"scene\":\"a\"", "scene is no number"},
        {"\"scenes\":[{\"nodes\":[\"a\"]}]", "scenes[0].nodes[0]"},
        {"\"meshes\":[{}]", "meshes[0].primitives is missing"},
        {"\"meshes\":[{\"primitives\":[{}]}]", "meshes[0].primitives[0].attributes is missing"},
        {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":\"0\"}}]}]",
         "attributes.POSITION is no number"},
        {"\"materials\":[{\"alphaCutoff\":\"0.5\"}]", "materials[0].alphaCutoff"},
        {"\"materials\":[{\"doubleSided\":1}]", "neither true nor false"},
        {"\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1]}}]",
         "3 numbers instead of 4"},
        {"\"materials\":[{\"normalTexture\":{}}]", "materials[0].normalTexture.index is missing"},
        {"\"materials\":[{\"alphaMode\":\"GLASS\"}]", "GLASS"},
        {"\"materials\":[{\"extensions\":{\"KHR_materials_ior\":{\"ior\":[]}}}]",
         "ior is no number"},
        {"\"extensionsUsed\":[7]", "extensionsUsed[0] is no string"},
        {"\"animations\":[{\"channels\":[{\"sampler\":0}],\"samplers\":[]}]",
         "animations[0].channels[0].target is missing"},
        {"\"images\":[{\"uri\":7}]", "images[0].uri is no string"},
        {"\"buffers\":[{\"byteLength\":\"7\"}]", "buffers[0].byteLength"},
        {"\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"znear\":1}}]",
         "yfov is missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        char text[512];
        snprintf(text, sizeof text, "{\"asset\":{\"version\":\"2.0\"},%s}", cases[i].members);
        check_json(text, LS_MESSAGE_GLTF_MEMBER, cases[i].word);
    }
}

static void test_extensions(void** state)
{
    (void)state;
    begin_corners(3);
    static const char* const required[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                           "KHR_texture_basisu", "EXT_mesh_gpu_instancing", "XYZ"};
    for (size_t i = 0; i < sizeof required / sizeof *required; i++)
    {
        char members[512];
        snprintf(members, sizeof members,
                 "\"extensionsUsed\":[\"%s\"],\"extensionsRequired\":[\"%s\"]," PLAIN, required[i],
                 required[i]);
        check_refused(members, LS_MESSAGE_GLTF_EXTENSION, required[i]);
    }
    gltf_write("\"extensionsUsed\":[\"KHR_materials_sheen\",\"ABC_thing\",\"KHR_lights_punctual\","
               "\"KHR_draco_mesh_compression\"],\"extensionsRequired\":[\"KHR_materials_sheen\"],"
               "\"materials\":[{\"name\":\"silk\",\"extensions\":{\"KHR_materials_sheen\":{},"
               "\"KHR_materials_unlit\":{}}}]," PLAIN);
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.warning_count, 3);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_EXTENSION,
                      "KHR_materials_sheen is not supported: material 0 (\"silk\")");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_EXTENSION, "ABC_thing");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_UNDECLARED,
                      "KHR_materials_unlit of material 0");
    ls_input_destroy(&input);

    // A thousand names are no thousand warnings.
    static char many[32768];
    size_t length = (size_t)sprintf(many, "\"extensionsUsed\":[\"a\"");
    for (int i = 0; i < 1000; i++)
        length += (size_t)sprintf(many + length, ",\"EXT_%d\"", i);
    sprintf(many + length, "]," PLAIN);
    gltf_write(many);
    input = gltf_import("a.gltf");
    assert_int_equal(input.warning_count, 33);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_EXTENSION, "and 963 more");
    ls_input_destroy(&input);
}

// Compressed meshes: plain data beside them is taken, else they are refused by name.
static void test_compressed(void** state)
{
    (void)state;
    begin_corners(3);
    gltf_add_accessor(-1, 0, F32, 3, "VEC3", "");
#define DRACO ",\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0}}"
    gltf_write("\"extensionsUsed\":[\"KHR_draco_mesh_compression\"]," ONE_NODE
               "," PRIMITIVE(POSITION DRACO));
    LsInput input = gltf_import("a.gltf");
    assert_memory_equal(input.meshes[0].positions, corners, 36);
    assert_int_equal(input.warning_count, 0);
    ls_input_destroy(&input);
    check_refused(ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":1}" DRACO),
                  LS_MESSAGE_GLTF_COMPRESSED, "KHR_draco_mesh_compression");

    char text[1024];
    for (int is_there = 0; is_there < 2; is_there++)
    {
        snprintf(text, sizeof text,
                 "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36%s}],"
                 "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36,\"extensions\":{"
                 "\"EXT_meshopt_compression\":{\"buffer\":1}}}],\"accessors\":[" POINTS "]," PLAIN
                 "}",
                 is_there ? ",\"uri\":\"a.bin\"" : "");
        gltf_write_bytes("a.gltf", text, strlen(text));
        if (!is_there)
        {
            gltf_check_refused("a.gltf", LS_MESSAGE_GLTF_COMPRESSED, "EXT_meshopt_compression");
            continue;
        }
        input = gltf_import("a.gltf");
        assert_int_equal(input.triangle_count, 1);
        ls_input_destroy(&input);
    }
}

// ---- Nodes --------------------------------------------------------------------------------------

static void test_nodes(void** state)
{
    (void)state;
    // A root turned by a quarter about z, scaled and moved; a mirrored child by matrix; two meshes,
    // one twice.
    begin_corners(3);
    gltf_write("\"scenes\":[{\"nodes\":[3],\"name\":\"other\"},{\"nodes\":[1,4]}],\"scene\":1,"
               "\"nodes\":["
               "{\"mesh\":0,\"matrix\":[-1,0,0,0,0,1,0,0,0,0,1,0,10,20,30,1]},"
               "{\"children\":[0,2],\"translation\":[1,2,3],"
               "\"rotation\":[0,0,0.70710678118654752,0.70710678118654752],\"scale\":[2,3,4]},"
               "{\"mesh\":1,\"camera\":0},{\"mesh\":2},{\"mesh\":0}],"
               "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1.0,\"znear\":0.1,"
               "\"aspectRatio\":1.5}}],"
               "\"meshes\":[{\"primitives\":[{" POSITION "}]},{\"primitives\":[{" POSITION
               ",\"mode\":5}]},{\"primitives\":[{" POSITION ",\"mode\":6}]}]");
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.mesh_count, 2); // the third is in another scene
    assert_int_equal(input.node_count, 4);
    assert_int_equal(input.nodes[0].parent, LS_NONE);
    assert_int_equal(input.nodes[1].parent, 0);
    assert_int_equal(input.nodes[2].parent, 0);
    assert_int_equal(input.nodes[3].parent, LS_NONE);
    assert_true(input.nodes[1].parent_from_node[0].x == -1.0f);
    assert_true(input.nodes[1].parent_from_node[2].w == 30.0f);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_SCENES,
                      "only scene 1 is taken, not: scene 0 (\"other\")");

    assert_int_equal(input.instance_count, 3);
    const uint32_t meshes[3] = {0, 1, 0}, nodes[3] = {1, 2, 3};
    for (int i = 0; i < 3; i++)
    {
        assert_int_equal(input.instances[i].mesh, meshes[i]);
        assert_int_equal(input.instances[i].node, nodes[i]);
    }
    // Root: x -> 2y, y -> -3x, z -> 4z, then (1,2,3). Child: x mirrored, then (10,20,30).
    const double world[3][4] = {{0, -3, 0, -59}, {-2, 0, 0, 22}, {0, 0, 4, 123}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            assert_true(fabs(input.instances[0].world_from_object[i][j] - world[i][j]) < 1e-13);

    // The camera stands where its node stands, without the node's scale.
    assert_int_equal(input.camera_count, 1);
    assert_true(input.cameras[0].tan_half_y == (float)tan(0.5));
    assert_true(input.cameras[0].aspect == 1.5f);
    const LsVec4* rows = input.cameras[0].world_from_camera;
    assert_true(fabsf(rows[0].y + 1.0f) < 1e-6f && fabsf(rows[1].x - 1.0f) < 1e-6f);
    assert_true(fabsf(rows[2].z - 1.0f) < 1e-6f && rows[0].w == 1.0f && rows[2].w == 3.0f);
    ls_input_destroy(&input);

    // The other scene, asked for, and so without a warning; one that is not there.
    LsError error;
    input.options.scene = 1;
    assert_int_equal(ls_import(&input, gltf_find_path("a.gltf"), &error), LS_OK);
    assert_int_equal(input.node_count, 1);
    assert_int_equal(input.warning_count, 0);
    ls_input_destroy(&input);
    input.options.scene = 3;
    assert_int_equal(ls_import(&input, gltf_find_path("a.gltf"), &error), LS_ERROR_INPUT_INDEX);
    assert_int_equal(error.message, LS_MESSAGE_GLTF_SCENE);
    ls_input_destroy(&input);

    // Without scenes, all roots.
    gltf_write("\"nodes\":[{\"mesh\":0},{\"children\":[0]},{\"mesh\":0}]," PRIMITIVE(POSITION));
    input = gltf_import("a.gltf");
    assert_int_equal(input.node_count, 3);
    assert_int_equal(input.instance_count, 2);
    assert_int_equal(input.nodes[1].parent, 0);
    ls_input_destroy(&input);
}

static void test_nodes_refused(void** state)
{
    (void)state;
#define MESH "," PRIMITIVE(POSITION)
#define SCENE "\"scenes\":[{\"nodes\":[0]}],"
    static const struct
    {
        const char* members;
        LsMessage message;
        const char* word;
    } cases[] = {
        {SCENE "\"nodes\":[{\"mesh\":7}]" MESH, LS_MESSAGE_GLTF_INDEX, "node 0 names mesh 7"},
        {"\"scenes\":[{\"nodes\":[5]}],\"nodes\":[{\"mesh\":0}]" MESH, LS_MESSAGE_GLTF_INDEX,
         "node 5"},
        {"\"scene\":2," ONE_NODE MESH, LS_MESSAGE_GLTF_INDEX, "scene 2"},
        {SCENE "\"nodes\":[{\"camera\":3}]", LS_MESSAGE_GLTF_INDEX, "camera 3"},
        {SCENE "\"nodes\":[{\"skin\":3}]", LS_MESSAGE_GLTF_INDEX, "skin 3"},
        {SCENE "\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{\"light\":3}}}]",
         LS_MESSAGE_GLTF_INDEX, "light 3"},
        {SCENE "\"nodes\":[{\"children\":[1]},{\"children\":[0]}]", LS_MESSAGE_GLTF_NODE_PARENTS,
         "two parents"},
        {"\"scenes\":[{\"nodes\":[0,0]}],\"nodes\":[{\"name\":\"a\\nb\"}]",
         LS_MESSAGE_GLTF_NODE_PARENTS, "node 0 (\"a?b\") has two parents"},
        {SCENE "\"nodes\":[{\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}]",
         LS_MESSAGE_GLTF_TRANSFORM, "last row"},
        {SCENE "\"nodes\":[{\"rotation\":[0,0,0,0]}]", LS_MESSAGE_GLTF_TRANSFORM, "rotation"},
        {SCENE "\"nodes\":[{\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],\"scale\":[1,1,1]}]",
         LS_MESSAGE_GLTF_TRANSFORM, "matrix and also"},
        {SCENE "\"nodes\":[{\"scale\":[1e39,1,1]}]", LS_MESSAGE_GLTF_RANGE, "float cannot hold"},
        {SCENE "\"nodes\":[{\"scale\":[1e30,1,1],\"children\":[1]},{\"scale\":[1e30,1,1]}]",
         LS_MESSAGE_GLTF_RANGE, "node 1"},
        {ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":9}"), LS_MESSAGE_GLTF_INDEX,
         "accessor 9"},
        {ONE_NODE "," PRIMITIVE(POSITION ",\"material\":4"), LS_MESSAGE_GLTF_INDEX, "material 4"},
        {ONE_NODE "," PRIMITIVE(POSITION ",\"indices\":4"), LS_MESSAGE_GLTF_INDEX,
         "mesh 0 (\"thing\"), primitive 0 names accessor 4"},
    };
    begin_corners(3);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_refused(cases[i].members, cases[i].message, cases[i].word);

    // 65 levels of nodes.
    char members[8192];
    size_t length = (size_t)sprintf(members, SCENE "\"nodes\":[");
    for (int i = 1; i <= 64; i++)
        length += (size_t)sprintf(members + length, "{\"children\":[%d]},", i);
    sprintf(members + length, "{}]");
    check_refused(members, LS_MESSAGE_GLTF_NODE_DEPTH, "64 levels");
}

// ---- Limits and progress ------------------------------------------------------------------------

static double last_fraction;
static unsigned progress_calls;

static void take_progress(void* user, double fraction)
{
    assert_ptr_equal(user, &last_fraction);
    assert_true(fraction >= last_fraction && fraction <= 1.0);
    last_fraction = fraction;
    progress_calls++;
}

static void test_limits(void** state)
{
    (void)state;
    begin_corners(6);
    gltf_write(PLAIN);
    LsInput input = {.options = {.progress = take_progress,
                                 .progress_user = &last_fraction,
                                 .max_triangles = 2}};
    LsError error = {0};
    assert_int_equal(ls_import(&input, gltf_find_path("a.gltf"), &error), LS_OK);
    assert_true(last_fraction == 1.0 && progress_calls > 4);
    assert_int_equal(input.triangle_count, 2);
    // What is free again is not counted: 6 vertices, 2 triangles, 1 node and its instance.
    const uint64_t kept = input.memory_bytes;
    assert_int_equal(kept, 72 + 2 * 16 + sizeof(LsSceneNode) + sizeof(LsInputInstance));
    ls_input_destroy(&input);

    input.options.max_triangles = 1;
    assert_int_equal(ls_import(&input, gltf_find_path("a.gltf"), &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_TRIANGLES);
    ls_input_destroy(&input);
    // Every grant is refused in its turn, none is missed.
    unsigned refused = 0;
    for (uint64_t limit = 1;; limit += limit / 4 + 1, refused++)
    {
        input.options.max_memory = limit;
        const LsResult result = ls_import(&input, gltf_find_path("a.gltf"), &error);
        ls_input_destroy(&input);
        if (result == LS_OK)
            break;
        assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    }
    assert_true(refused > 10);
}

// ---- Animation ----------------------------------------------------------------------------------

#define CHANNEL(sampler, node, path) \
    "{\"sampler\":" sampler ",\"target\":{\"node\":" node ",\"path\":\"" path "\"}}"

static void check_channel(const LsInput* input, uint32_t index, uint32_t node, uint32_t path,
                          uint32_t interpolation, uint32_t count)
{
    const LsChannel* channel = &input->channels[index];
    assert_int_equal(channel->node, node);
    assert_int_equal(channel->path, path);
    assert_int_equal(channel->interpolation, interpolation);
    assert_int_equal(channel->key_count, count);
}

static void test_animation(void** state)
{
    (void)state;
    begin_corners(3); // 0
    const float times[3] = {0, 0.5f, 2}, moves[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    const float spline[2][3][4] = {{{0, 0, 0, 8}, {0, 0, 0, 2}, {4, 0, 0, 0}},
                                   {{0, 2, 0, 0}, {3, 0, 0, 4}, {0, 0, 5, 0}}};
    const int16_t turns[12] = {0, 0, 0, 32767, 0, 0, -32768, 0, 32767, 0, 0, 32767};
    gltf_add_floats(times, 3, 1);                                                             // 1
    gltf_add_floats(moves, 3, 3);                                                             // 2
    gltf_add_floats(&spline[0][0][0], 6, 4);                                                  // 3
    gltf_add_accessor(gltf_add_view(turns, 24, 0), 0, I16, 3, "VEC4", "\"normalized\":true"); // 4
    gltf_add_floats(times + 1, 2, 1);                                                         // 5
#define ANIMATED                                                                                   \
    "\"scenes\":[{\"nodes\":[1,0]}],\"nodes\":[{\"mesh\":0,\"name\":\"a\",\"scale\":[1,2,3]},"     \
    "{\"children\":[3],\"rotation\":[0,0,2,0],\"translation\":[7,8,9]},{},{\"matrix\":[1,0,0,0,0," \
    "1,0,"                                                                                         \
    "0,0,0,1,0,0,0,0,1]}]," PRIMITIVE(POSITION)
    gltf_write(
        "\"animations\":[{\"channels\":[" CHANNEL("0", "0", "translation") "," //
        CHANNEL("1", "0", "rotation") "," CHANNEL("2", "1", "rotation") ","    //
        CHANNEL("0", "2",
                "scale") "],\"samplers\":[{\"input\":1,\"output\":2},{\"input\":1,"
                         "\"output\":4,\"interpolation\":\"STEP\"},{\"input\":5,\"output\":3,"
                         "\"interpolation\":\"CUBICSPLINE\"}]},{\"channels\":[" CHANNEL("0", "2",
                                                                                        "scale") //
        "],\"samplers\":[{\"input\":1,\"output\":2}]},{\"channels\":["                           //
        CHANNEL("0", "1", "scale") "],\"samplers\":[{\"input\":1,\"output\":2}]}]," ANIMATED);
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.warning_count, 0);
    assert_int_equal(input.animation_count, 2); // the second moves a node that is not shown
    assert_int_equal(input.channel_count, 9);
    assert_int_equal(input.animations[0].first_channel, 0);
    assert_int_equal(input.animations[0].channel_count, 6);
    assert_true(input.animations[0].duration == 2.0f);
    assert_int_equal(input.animations[1].first_channel, 6);
    assert_int_equal(input.animations[1].channel_count, 3);
    // Nodes in the order of the scene: glTF's 1 is 0, its 0 is 2.
    check_channel(&input, 0, 0, LS_PATH_TRANSLATION, LS_INTERPOLATION_STEP, 1);
    check_channel(&input, 1, 0, LS_PATH_ROTATION, LS_INTERPOLATION_CUBIC, 2);
    check_channel(&input, 2, 0, LS_PATH_SCALE, LS_INTERPOLATION_STEP, 1);
    check_channel(&input, 3, 2, LS_PATH_TRANSLATION, LS_INTERPOLATION_LINEAR, 3);
    check_channel(&input, 4, 2, LS_PATH_ROTATION, LS_INTERPOLATION_STEP, 3);
    check_channel(&input, 5, 2, LS_PATH_SCALE, LS_INTERPOLATION_STEP, 1);
    check_channel(&input, 6, 0, LS_PATH_TRANSLATION, LS_INTERPOLATION_STEP, 1);
    check_channel(&input, 7, 0, LS_PATH_ROTATION, LS_INTERPOLATION_STEP, 1);
    check_channel(&input, 8, 0, LS_PATH_SCALE, LS_INTERPOLATION_LINEAR, 3);

    const LsChannel* channels = input.channels;
    const float* keys = input.keys;
    const float still[3] = {7, 8, 9}, upright[4] = {0, 0, 1, 0}, scale[3] = {1, 2, 3};
    assert_memory_equal(keys + channels[0].first_value, still, sizeof still);
    assert_memory_equal(keys + channels[7].first_value, upright, sizeof upright);
    assert_memory_equal(keys + channels[5].first_value, scale, sizeof scale);
    assert_memory_equal(keys + channels[1].first_time, times + 1, 8);
    // Values of unit length, tangents scaled with them.
    const float unit[2][3][4] = {{{0, 0, 0, 4}, {0, 0, 0, 1}, {2, 0, 0, 0}},
                                 {{0, 0.4f, 0, 0}, {0.6f, 0, 0, 0.8f}, {0, 0, 1, 0}}};
    assert_memory_equal(keys + channels[1].first_value, unit, sizeof unit);
    assert_memory_equal(keys + channels[3].first_time, times, sizeof times);
    assert_memory_equal(keys + channels[3].first_value, moves, sizeof moves);
    assert_int_equal(channels[4].first_time, channels[3].first_time); // shared
    const float* turn = keys + channels[4].first_value;
    const float half = (float)sqrt(0.5);
    assert_true(turn[3] == 1.0f && turn[6] == -1.0f && turn[8] == half && turn[11] == half);

    // The channels partition the keys in their order.
    uint32_t used = 0;
    for (uint32_t i = 0; i < input.channel_count; i++)
    {
        const uint32_t width = channels[i].path == LS_PATH_ROTATION ? 4 : 3;
        const bool is_shared = i > 0 && channels[i].first_time == channels[i - 1].first_time;
        assert_int_equal(channels[i].first_time, is_shared ? channels[i - 1].first_time : used);
        used += is_shared ? 0 : channels[i].key_count;
        assert_int_equal(channels[i].first_value, used);
        used += channels[i].key_count * width *
                (channels[i].interpolation == LS_INTERPOLATION_CUBIC ? 3 : 1);
    }
    assert_int_equal(input.key_count, used);
    ls_input_destroy(&input);

    // What is not kept, and keys whose times do not rise.
    begin_corners(3);
    const float falling[4] = {1, 1, 0.5f, 3}, four[12] = {1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4};
    gltf_add_floats(falling, 4, 1);
    gltf_add_floats(four, 4, 3);
    gltf_write(
        "\"animations\":[{\"name\":\"walk\",\"channels\":[" CHANNEL("0", "0", "translation") "," //
        CHANNEL("0", "0", "weights") ",{\"sampler\":0,\"target\":{\"path\":\"pointer\"}},"       //
        CHANNEL("0", "0", "colour") "],\"samplers\":[{\"input\":1,\"output\":2}]}]," ANIMATED);
    input = gltf_import("a.gltf");
    assert_int_equal(input.channel_count, 3);
    assert_int_equal(input.channels[0].key_count, 2);
    const float kept_times[2] = {1, 3}, kept[6] = {1, 1, 1, 4, 4, 4};
    assert_memory_equal(input.keys + input.channels[0].first_time, kept_times, sizeof kept_times);
    assert_memory_equal(input.keys + input.channels[0].first_value, kept, sizeof kept);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_KEYS,
                      "2 of animation 0 (\"walk\"), translation of node 0 (\"a\")");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_MORPH, "(weights)");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_CHANNEL, "channel 2");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_CHANNEL, "(colour)");
    ls_input_destroy(&input);
}

static void test_animation_refused(void** state)
{
    (void)state;
    begin_corners(3);
    const float times[4] = {0, 1, -1, NAN}, values[8] = {0, 0, 0, 0, 1, NAN, 0, 0};
    gltf_add_floats(times, 2, 1);          // 1
    gltf_add_floats(times + 2, 1, 1);      // 2
    gltf_add_floats(times + 3, 1, 1);      // 3
    gltf_add_floats(&corners[0][0], 2, 3); // 4
    gltf_add_floats(values, 2, 4);         // 5
    gltf_add_floats(values + 3, 2, 2);     // 6: no legal type
    const float lost[6] = {0, 0, 0, 0, NAN, 0};
    gltf_add_floats(lost, 2, 3);                   // 7
    gltf_add_accessor(0, 0, F32, 0, "SCALAR", ""); // 8
    static const struct
    {
        const char* channels;
        const char* sampler;
        LsMessage message;
        const char* word;
    } cases[] = {
        {CHANNEL("0", "9", "scale"), "\"input\":1,\"output\":4", LS_MESSAGE_GLTF_INDEX, "node 9"},
        {CHANNEL("3", "0", "scale"), "\"input\":1,\"output\":4", LS_MESSAGE_GLTF_INDEX,
         "sampler 3"},
        {CHANNEL("0", "0", "scale"), "\"input\":99,\"output\":4", LS_MESSAGE_GLTF_INDEX,
         "accessor 99"},
        {CHANNEL("0", "3", "scale"), "\"input\":1,\"output\":4", LS_MESSAGE_GLTF_ANIMATION,
         "node 3 is animated, but has a matrix"},
        {CHANNEL("0", "0", "scale") "," CHANNEL("0", "0", "scale"), "\"input\":1,\"output\":4",
         LS_MESSAGE_GLTF_ANIMATION, "twice in its scale"},
        {CHANNEL("0", "0", "scale"), "\"input\":2,\"output\":4", LS_MESSAGE_GLTF_ANIMATION,
         "negative"},
        {CHANNEL("0", "0", "scale"), "\"input\":3,\"output\":4", LS_MESSAGE_GLTF_ANIMATION,
         "negative or no number"},
        {CHANNEL("0", "0", "scale"), "\"input\":8,\"output\":4", LS_MESSAGE_GLTF_ANIMATION,
         "no keys"},
        {CHANNEL("0", "0", "scale"), "\"input\":1,\"output\":0", LS_MESSAGE_GLTF_ANIMATION,
         "3 values for 2 keys"},
        {CHANNEL("0", "0", "scale"), "\"input\":1,\"output\":4,\"interpolation\":\"CUBICSPLINE\"",
         LS_MESSAGE_GLTF_ANIMATION, "2 values for 2 keys"},
        {CHANNEL("0", "0", "scale"), "\"input\":1,\"output\":4,\"interpolation\":\"SMOOTH\"",
         LS_MESSAGE_GLTF_MEMBER, "SMOOTH"},
        {CHANNEL("0", "0", "rotation"), "\"input\":1,\"output\":5", LS_MESSAGE_GLTF_NOT_FINITE,
         "rotation of node 0"},
        {CHANNEL("0", "0", "scale"), "\"input\":1,\"output\":7", LS_MESSAGE_GLTF_NOT_FINITE,
         "scale of node 0"},
        {CHANNEL("0", "0", "scale"), "\"input\":1,\"output\":6", LS_MESSAGE_GLTF_ACCESSOR_TYPE,
         "VEC2"},
        {CHANNEL("0", "0", "rotation"), "\"input\":1,\"output\":4", LS_MESSAGE_GLTF_ACCESSOR_TYPE,
         "keys of a rotation"},
        {CHANNEL("0", "0", "scale"), "\"input\":4,\"output\":4", LS_MESSAGE_GLTF_ACCESSOR_TYPE,
         "key times"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        char members[2048];
        snprintf(members, sizeof members,
                 "\"animations\":[{\"channels\":[%s],\"samplers\":[{%s}]}]," ANIMATED,
                 cases[i].channels, cases[i].sampler);
        check_refused(members, cases[i].message, cases[i].word);
    }
    // A quaternion of zeros.
    begin_corners(3);
    gltf_add_floats(times, 2, 1);
    gltf_add_floats((const float[8]){0, 0, 0, 1}, 2, 4);
    check_refused("\"animations\":[{\"channels\":[" CHANNEL("0", "0", "rotation") //
                  "],\"samplers\":[{\"input\":1,\"output\":2}]}]," ANIMATED,
                  LS_MESSAGE_GLTF_ANIMATION, "length zero");
}

static void test_left_out(void** state)
{
    (void)state;
    begin_corners(3);
    gltf_write("\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"skin\":0,\"camera\":0}],"
               "\"skins\":[{\"joints\":[0],\"name\":\"bones\"}],\"cameras\":[{\"name\":\"plan\","
               "\"type\":\"orthographic\",\"orthographic\":{\"xmag\":1,\"ymag\":1,\"zfar\":1,"
               "\"znear\":0}}]," //
               PRIMITIVE(POSITION ",\"targets\":[{\"POSITION\":0}]"));
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.triangle_count, 1);
    assert_int_equal(input.camera_count, 0);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_SKIN,
                      "node 0 with skin 0 (\"bones\")");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_CAMERA, "camera 0 (\"plan\")");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_MORPH,
                      "mesh 0 (\"thing\"), primitive 0");
    ls_input_destroy(&input);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_modes),         cmocka_unit_test(test_streams),
        cmocka_unit_test(test_quantized),     cmocka_unit_test(test_accessor_types),
        cmocka_unit_test(test_interleaved),   cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_bounds),        cmocka_unit_test(test_buffers),
        cmocka_unit_test(test_glb),           cmocka_unit_test(test_json),
        cmocka_unit_test(test_members),       cmocka_unit_test(test_extensions),
        cmocka_unit_test(test_compressed),    cmocka_unit_test(test_nodes),
        cmocka_unit_test(test_nodes_refused), cmocka_unit_test(test_limits),
        cmocka_unit_test(test_animation),     cmocka_unit_test(test_animation_refused),
        cmocka_unit_test(test_left_out),
    };
    return cmocka_run_group_tests_name("import_gltf", tests, gltf_make_folder, gltf_remove_folder);
}
