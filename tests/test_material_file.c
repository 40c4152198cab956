// test_material_file.c - overrides of materials from JSON.

#include "compose_fixture.h"
#include "material_file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Materials ----------------------------------------------------------------------------------

static LsInput override(const char* name, const char* materials)
{
    return ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path(name), .materials = materials},
                             1);
}

static void test_every_field(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    // Flat, and as glTF has it: the same.
    static const char* const forms[] = {
        "{\"baseColorFactor\":[0.25,0.5,0.75,0.125],\"metallicFactor\":0.5,\"roughnessFactor\":0."
        "375,"
        "\"emissiveFactor\":[0.5,0,1],\"emissiveStrength\":8,\"alphaMode\":\"MASK\","
        "\"alphaCutoff\":0.625,\"doubleSided\":true,\"ior\":1.25,\"transmissionFactor\":0.875}",
        "  {\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.75,0.125],"
        "\"metallicFactor\":0.5,\"roughnessFactor\":0.375},\"emissiveFactor\":[0.5,0,1],"
        "\"alphaMode\":\"MASK\",\"alphaCutoff\":0.625,\"doubleSided\":true,\"extensions\":{"
        "\"KHR_materials_emissive_strength\":{\"emissiveStrength\":8},"
        "\"KHR_materials_ior\":{\"ior\":1.25},"
        "\"KHR_materials_transmission\":{\"transmissionFactor\":0.875}}}"};
    const LsMaterial core = {.base_color = {0.25f, 0.5f, 0.75f},
                             .flags = LS_MATERIAL_EMISSIVE | LS_MATERIAL_DOUBLE_SIDED,
                             .emission = {4, 0, 8},
                             .metallic = 0.5f,
                             .roughness = 0.375f};
    LsSurface surface = LS_SURFACE_DEFAULT;
    surface.transmission = 0.875f;
    surface.ior = 1.25f;
    surface.alpha = 0.125f;
    surface.alpha_cutoff = 0.625f;
    surface.flags = LS_SURFACE_MASK;
    for (int form = 0; form < 2; form++)
    {
        LsInput input = override("a.gltf", forms[form]);
        assert_int_equal(input.material_count, 2);
        for (int i = 0; i < 2; i++)
        {
            assert_memory_equal(&input.materials[i].core, &core, sizeof core);
            assert_memory_equal(&input.materials[i].surface, &surface, sizeof surface);
        }
        ls_input_destroy(&input);
    }
}

// What is not named stays; what is set to nothing goes.
static void test_fields_alone(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    LsInput plain = override("a.gltf", NULL);
    LsInput none = override("a.gltf", "{}");
    LsInput rough = override("a.gltf", "{\"roughnessFactor\":0.5}");
    LsInput dark = override("a.gltf", "{\"emissiveFactor\":[0,0,0],\"doubleSided\":false,"
                                      "\"alphaMode\":\"OPAQUE\",\"baseColorFactor\":[0,0,1]}");
    for (int i = 0; i < 2; i++)
    {
        assert_memory_equal(&none.materials[i].core, &plain.materials[i].core, sizeof(LsMaterial));
        LsMaterial expected = plain.materials[i].core;
        expected.roughness = 0.5f;
        assert_memory_equal(&rough.materials[i].core, &expected, sizeof expected);
        assert_memory_equal(&rough.materials[i].surface, &plain.materials[i].surface,
                            sizeof(LsSurface));
        assert_int_equal(dark.materials[i].core.flags, 0);
        assert_true(dark.materials[i].core.emission.x == 0.0f);
        assert_true(dark.materials[i].core.base_color.z == 1.0f);
        assert_true(dark.materials[i].surface.alpha == 1.0f);
    }
    assert_int_equal(plain.materials[1].core.flags,
                     LS_MATERIAL_EMISSIVE | LS_MATERIAL_DOUBLE_SIDED);
    ls_input_destroy(&plain);
    ls_input_destroy(&none);
    ls_input_destroy(&rough);
    ls_input_destroy(&dark);
}

// By name, on top of that for all, wherever it stands; from a file.
static void test_materials_by_name(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    // The importer of this test's files may not keep names: they are what it is about.
    LsInput input = override("a.gltf", NULL);
    const LsInputPart part = {0};
    static const char* const names[] = {"red", "lamp"};
    for (int i = 0; i < 2; i++)
    {
        free(input.materials[i].name);
        input.materials[i].name = strdup(names[i]);
        assert_non_null(input.materials[i].name);
    }
    ls_compose_write_text("a.json",
                          "{\"materials\":{\"red\":{\"metallicFactor\":0.25},"
                          "\"*\":{\"metallicFactor\":0.75,\"roughnessFactor\":0.125}}}\n");
    LsError error;
    const LsBakeInput how = {.path = "a.gltf", .materials = ls_compose_path("a.json")};
    assert_int_equal(ls_input_override(&input, &part, &how, &error), LS_OK);
    assert_true(input.materials[0].core.metallic == 0.25f);
    assert_true(input.materials[0].core.roughness == 0.125f);
    assert_true(input.materials[1].core.metallic == 0.75f);
    // Unknown names are told which there are.
    const LsBakeInput wrong = {.path = "a.gltf", .materials = "{\"materials\":{\"gold\":{}}}"};
    assert_int_equal(ls_input_override(&input, &part, &wrong, &error), LS_ERROR_INPUT_FORMAT);
    assert_int_equal(error.message, LS_MESSAGE_MATERIAL_NAME);
    assert_non_null(strstr(error.text, "\"gold\""));
    assert_non_null(strstr(error.text, "\"red\", \"lamp\""));
    const LsBakeInput twice = {.path = "a.gltf",
                               .materials = "{\"materials\":{\"red\":{},\"red\":{}}}"};
    assert_int_equal(ls_input_override(&input, &part, &twice, &error), LS_ERROR_INPUT_FORMAT);
    assert_int_equal(error.message, LS_MESSAGE_MATERIAL_KEY);
    ls_input_destroy(&input);
}

// Files without materials share one; an override gives its file one of its own.
static void test_shared_material(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    const char* path = ls_compose_path("a.ply");
    const char* red = "{\"baseColorFactor\":[1,0,0]}";
    for (uint32_t which = 0; which < 3; which++)
    {
        LsBakeInput inputs[3] = {{.path = path}, {.path = path}, {.path = path}};
        inputs[which].materials = red;
        LsInput input = ls_compose_inputs(inputs, 3);
        assert_int_equal(input.material_count, 2); // and no third that nobody has
        for (uint32_t i = 0; i < 3; i++)
            for (uint32_t k = 0; k < 2; k++)
            {
                const LsVec3 color = input.materials[input.meshes[i].materials[k]].core.base_color;
                assert_true(color.x == (i == which ? 1.0f : 0.8f));
                assert_true(color.y == (i == which ? 0.0f : 0.8f));
            }
        ls_input_destroy(&input);
    }
    // A file with materials of its own does not touch the shared one.
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    const LsBakeInput inputs[2] = {{.path = path},
                                   {.path = ls_compose_path("a.gltf"), .materials = red}};
    LsInput input = ls_compose_inputs(inputs, 2);
    assert_int_equal(input.material_count, 3);
    assert_true(input.materials[0].core.base_color.y == 0.8f);
    assert_true(input.materials[2].core.base_color.y == 0.0f);
    ls_input_destroy(&input);
}

static void test_materials_refused(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    char path[256];
    snprintf(path, sizeof path, "%s", ls_compose_path("a.gltf"));
    static const struct
    {
        const char* json;
        LsMessage message;
        const char* word;
    } cases[] = {
        {"{", LS_MESSAGE_MATERIAL_JSON, "--material"},
        {"{} x", LS_MESSAGE_MATERIAL_JSON, "byte 3"},
        {"{\"ior\":}", LS_MESSAGE_MATERIAL_JSON, "byte 7"},
        {"{\"gloss\":1}", LS_MESSAGE_MATERIAL_KEY, "gloss"},
        {"{\"a\\nb\":1}", LS_MESSAGE_MATERIAL_KEY, "a?b"},
        {"{\"name\":\"x\"}", LS_MESSAGE_MATERIAL_KEY, "name"},
        {"{\"ior\":1.5,\"ior\":1.5}", LS_MESSAGE_MATERIAL_KEY, "twice"},
        {"{\"ior\":1.5,\"extensions\":{\"KHR_materials_ior\":{\"ior\":2}}}",
         LS_MESSAGE_MATERIAL_KEY, "twice"},
        {"{\"emissiveTexture\":{\"index\":0}}", LS_MESSAGE_MATERIAL_KEY, "textures"},
        {"{\"pbrMetallicRoughness\":{\"baseColorTexture\":{}}}", LS_MESSAGE_MATERIAL_KEY,
         "textures"},
        {"{\"pbrMetallicRoughness\":{\"ior\":1.5}}", LS_MESSAGE_MATERIAL_KEY, "ior"},
        {"{\"extensions\":{\"KHR_materials_sheen\":{}}}", LS_MESSAGE_MATERIAL_KEY, "sheen"},
        {"{\"extensions\":{\"pbrMetallicRoughness\":{}}}", LS_MESSAGE_MATERIAL_KEY, "pbr"},
        {"{\"materials\":{},\"ior\":1}", LS_MESSAGE_MATERIAL_KEY, "materials"},
        {"{\"ior\":1,\"materials\":{}}", LS_MESSAGE_MATERIAL_KEY, "materials"},
        {"{\"materials\":[]}", LS_MESSAGE_MATERIAL_VALUE, "object"},
        {"{\"materials\":{\"*\":3}}", LS_MESSAGE_MATERIAL_VALUE, "\"*\""},
        {"{\"pbrMetallicRoughness\":1}", LS_MESSAGE_MATERIAL_VALUE, "object"},
        {"{\"extensions\":null}", LS_MESSAGE_MATERIAL_VALUE, "object"},
        {"{\"extensions\":{\"KHR_materials_ior\":[]}}", LS_MESSAGE_MATERIAL_VALUE, "object"},
        {"{\"baseColorFactor\":[1,1]}", LS_MESSAGE_MATERIAL_VALUE, "baseColorFactor"},
        {"{\"baseColorFactor\":[1,1,1,1,1]}", LS_MESSAGE_MATERIAL_VALUE, "3 or 4"},
        {"{\"baseColorFactor\":[1,1,\"1\"]}", LS_MESSAGE_MATERIAL_VALUE, "3 or 4"},
        {"{\"baseColorFactor\":[1,1,2]}", LS_MESSAGE_MATERIAL_VALUE, "3 or 4"},
        {"{\"baseColorFactor\":{\"r\":1,\"g\":1,\"b\":1}}", LS_MESSAGE_MATERIAL_VALUE, "3 or 4"},
        {"{\"emissiveFactor\":[1,1,18]}", LS_MESSAGE_MATERIAL_VALUE, "emissiveStrength"},
        {"{\"emissiveFactor\":[1,1,1,1]}", LS_MESSAGE_MATERIAL_VALUE, "array of 3 "},
        {"{\"emissiveStrength\":2}", LS_MESSAGE_MATERIAL_VALUE, "emissiveFactor"},
        {"{\"emissiveFactor\":[1,1,1],\"emissiveStrength\":1e40}", LS_MESSAGE_MATERIAL_VALUE,
         "emissiveStrength"},
        {"{\"metallicFactor\":-0.1}", LS_MESSAGE_MATERIAL_VALUE, "metallicFactor"},
        {"{\"roughnessFactor\":1.5}", LS_MESSAGE_MATERIAL_VALUE, "from 0 to 1"},
        {"{\"roughnessFactor\":1e999}", LS_MESSAGE_MATERIAL_VALUE, "from 0 to 1"},
        {"{\"transmissionFactor\":true}", LS_MESSAGE_MATERIAL_VALUE, "transmissionFactor"},
        {"{\"alphaMode\":\"BLEND\"}", LS_MESSAGE_MATERIAL_VALUE, "MASK"},
        {"{\"alphaMode\":1}", LS_MESSAGE_MATERIAL_VALUE, "MASK"},
        {"{\"alphaCutoff\":-1}", LS_MESSAGE_MATERIAL_VALUE, "alphaCutoff"},
        {"{\"doubleSided\":1}", LS_MESSAGE_MATERIAL_VALUE, "true or false"},
        {"{\"ior\":0.5}", LS_MESSAGE_MATERIAL_VALUE, "ior"},
        {"{\"materials\":{\"*\":{\"ior\":\"glass\"}}}", LS_MESSAGE_MATERIAL_VALUE, "\"*\": ior"},
        {"{\"materials\":{\"gold\":{}}}", LS_MESSAGE_MATERIAL_NAME, "gold"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        ls_compose_check_refused(&(LsBakeInput){.path = path, .materials = cases[i].json},
                                 cases[i].message, cases[i].word);

    // From files.
    ls_compose_write_text("a.json", "[1, 2]\n");
    ls_compose_write_text("empty.json", "");
    static char large[LS_MATERIAL_FILE_BYTES + 1];
    memset(large, ' ', sizeof large);
    large[0] = '{';
    large[sizeof large - 1] = '}';
    ls_compose_write_bytes("large.json", large, sizeof large);
    const struct
    {
        const char* file;
        LsMessage message;
    } files[] = {{"a.json", LS_MESSAGE_MATERIAL_JSON},
                 {"empty.json", LS_MESSAGE_FILE_EMPTY},
                 {"large.json", LS_MESSAGE_MATERIAL_JSON},
                 {"missing.json", LS_MESSAGE_FILE_MISSING},
                 {".", LS_MESSAGE_FILE_IS_FOLDER}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        ls_compose_check_refused(
            &(LsBakeInput){.path = path, .materials = ls_compose_path(files[i].file)},
            files[i].message, files[i].file);
    ls_compose_check_refused(&(LsBakeInput){.path = path, .materials = "/dev/null"},
                             LS_MESSAGE_FILE_NOT_REGULAR, "/dev/null");
    ls_compose_write_bytes("a.json", "{}\0{}", 5);
    ls_compose_check_refused(&(LsBakeInput){.path = path, .materials = ls_compose_path("a.json")},
                             LS_MESSAGE_MATERIAL_JSON, "zero");
    // As deep as JSON goes: refused, not followed.
    memset(large, '[', sizeof large - 1);
    memcpy(large, "{\"ior\":", 7);
    large[sizeof large - 1] = '\0';
    ls_compose_check_refused(&(LsBakeInput){.path = path, .materials = large},
                             LS_MESSAGE_MATERIAL_JSON, "--material");
    // The largest file that is taken.
    memset(large, ' ', sizeof large);
    large[0] = '{';
    large[LS_MATERIAL_FILE_BYTES - 1] = '}';
    ls_compose_write_bytes("large.json", large, LS_MATERIAL_FILE_BYTES);
    LsInput input = override("a.gltf", ls_compose_path("large.json"));
    ls_input_destroy(&input);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field),       cmocka_unit_test(test_fields_alone),
        cmocka_unit_test(test_materials_by_name), cmocka_unit_test(test_shared_material),
        cmocka_unit_test(test_materials_refused),
    };
    return cmocka_run_group_tests(tests, ls_compose_make_folder, ls_compose_remove_folder);
}
