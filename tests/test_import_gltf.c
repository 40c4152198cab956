// test_import_gltf.c - glTF files: JSON, GLB, buffers, members, extensions, limits.

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

// ---- Files --------------------------------------------------------------------------------------

static void test_buffers(void** state)
{
    (void)state;
    // Embedded, under any media type; a name of letters that a URI must escape; a file that is
    // longer than its buffer; a plus that is a plus.
    uint8_t bytes[40] = {0};
    memcpy(bytes, gltf_corners, 36);
    gltf_begin_corners(3);
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
        assert_memory_equal(input.meshes[0].positions, gltf_corners, 36);
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
    gltf_begin_corners(3);
    const size_t size = gltf_print_glb(PLAIN, bytes);
    gltf_write_bytes("a.glb", bytes, size);
    LsInput input = gltf_import("a.glb");
    assert_memory_equal(input.meshes[0].positions, gltf_corners, 36);
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
    check_json("{\"asset\":{\"version\":\"2.0\"},\"materials\\u0000x\":[{}]}", LS_MESSAGE_GLTF_JSON,
               "zero byte");
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
        {"\"nodes\":[{\"mesh\":0,\"mesh\":\"b\"}]", "nodes[0].mesh comes twice"},
        {"\"materials\":[{}],\"materials\":[{},{}]", "materials comes twice"},
        {"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"POSITION\":1}}]}]",
         "attributes.POSITION comes twice"},
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
    gltf_begin_corners(3);
    static const char* const required[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                           "KHR_texture_basisu", "EXT_mesh_gpu_instancing", "XYZ"};
    for (size_t i = 0; i < sizeof required / sizeof *required; i++)
    {
        char members[512];
        snprintf(members, sizeof members,
                 "\"extensionsUsed\":[\"%s\"],\"extensionsRequired\":[\"%s\"]," PLAIN, required[i],
                 required[i]);
        gltf_check_members_refused(members, LS_MESSAGE_GLTF_EXTENSION, required[i]);
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
    gltf_begin_corners(3);
    gltf_add_accessor(-1, 0, F32, 3, "VEC3", "");
#define DRACO ",\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0}}"
    gltf_write("\"extensionsUsed\":[\"KHR_draco_mesh_compression\"]," ONE_NODE
               "," PRIMITIVE(POSITION DRACO));
    LsInput input = gltf_import("a.gltf");
    assert_memory_equal(input.meshes[0].positions, gltf_corners, 36);
    assert_int_equal(input.warning_count, 0);
    ls_input_destroy(&input);
    gltf_check_members_refused(ONE_NODE "," PRIMITIVE("\"attributes\":{\"POSITION\":1}" DRACO),
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
    gltf_begin_corners(6);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_buffers),    cmocka_unit_test(test_glb),
        cmocka_unit_test(test_json),       cmocka_unit_test(test_members),
        cmocka_unit_test(test_extensions), cmocka_unit_test(test_compressed),
        cmocka_unit_test(test_limits),
    };
    return cmocka_run_group_tests_name("import_gltf", tests, gltf_make_folder, gltf_remove_folder);
}
