// test_import_obj.c - OBJ and MTL files: what is taken from them, what is warned of, what is refused.

#include "mesh_files.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define POINTS "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define FACE "f 1 2 3\n"

// ---- Images -------------------------------------------------------------------------------------

// A TGA of so many pixels a side, 32 bits each, all of one colour.
static void write_tga(const char* name, uint8_t side, uint8_t red, uint8_t green, uint8_t alpha)
{
    uint8_t bytes[18 + 4 * 16 * 16] = {0};
    bytes[2] = 2;
    bytes[12] = bytes[14] = side;
    bytes[16] = 32;
    bytes[17] = 8;
    for (size_t i = 0; i < (size_t)side * side; i++)
    {
        bytes[18 + 4 * i + 1] = green;
        bytes[18 + 4 * i + 2] = red;
        bytes[18 + 4 * i + 3] = alpha;
    }
    write_mesh_bytes(name, bytes, 18 + 4 * (size_t)side * side);
}

// ---- OBJ ----------------------------------------------------------------------------------------

static void test_corners(void** state)
{
    (void)state;
    LsInput input = import_mesh_text(
        "a.obj", "\xEF\xBB\xBFg walls\no other\n" POINTS "vt 0.25 0.25\nvt 1\nvn 0 0 1\nvn 0 0 2\n"
                 "f 1 2 3\nf 1/1 2/2 3/-1\nf 1//1 2//2 3//-2\nf -3/1/2 \\\n -2/2/1 3/1/1 # end\n");
    assert_int_equal(input.warning_count, 0);
    const LsInputMesh* mesh = &input.meshes[0];
    const uint32_t none = LS_NONE;
    const uint32_t texcoords[12] = {none, none, none, 0, 1, 1, none, none, none, 0, 1, 0};
    const uint32_t normals[12] = {none, none, none, none, none, none, 0, 1, 0, 1, 0, 0};
    assert_string_equal(mesh->name, "walls");
    assert_int_equal(mesh->triangle_count, 4);
    assert_memory_equal(mesh->streams[LS_STREAM_TEXCOORD_0].indices, texcoords, sizeof texcoords);
    assert_memory_equal(mesh->streams[LS_STREAM_NORMAL].indices, normals, sizeof normals);
    const float uv[4] = {0.25f, 0.75f, 1.0f, 1.0f};
    assert_memory_equal(mesh->streams[LS_STREAM_TEXCOORD_0].values, uv, sizeof uv);
    assert_null(mesh->streams[LS_STREAM_COLOR].values);
    ls_input_destroy(&input);

    // A comment ends with its line, though it may end in a backslash.
    input = import_mesh_text("a.obj", " # from C:\\scenes\\\n" POINTS "f 1 2 3\n");
    assert_int_equal(input.meshes[0].vertex_count, 3);
    ls_input_destroy(&input);

    input = import_mesh_text("a.obj", "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0 1 1\n" FACE);
    const float colors[12] = {1, 0, 0, 1, 1, 1, 1, 1, 0, 1, 1, 1};
    assert_memory_equal(input.meshes[0].streams[LS_STREAM_COLOR].values, colors, sizeof colors);
    ls_input_destroy(&input);
}

static void test_refused(void** state)
{
    (void)state;
    check_mesh_text_refused("a.obj", "A letter to nobody.\n", LS_MESSAGE_OBJ_NOTHING, "OBJ file?");
    check_mesh_text_refused("a.obj", POINTS "f 1 2 4\n", LS_MESSAGE_OBJ_CORNER, "line 4");
    check_mesh_text_refused("a.obj", POINTS "f 0 1 2\n", LS_MESSAGE_OBJ_CORNER, "vertex 0");
    check_mesh_text_refused("a.obj", POINTS "f -4 1 2\n", LS_MESSAGE_OBJ_CORNER, "vertex -4");
    check_mesh_text_refused("a.obj", POINTS "f 1/1 2/1 3/1\n", LS_MESSAGE_OBJ_CORNER,
                            "texture coordinate 1");
    check_mesh_text_refused("a.obj", POINTS "f 1//9 2//1 3//1\n", LS_MESSAGE_OBJ_CORNER,
                            "normal 9");
    check_mesh_text_refused("a.obj", POINTS "f 1 2 99999999999999999999\n", LS_MESSAGE_OBJ_CORNER,
                            "line 4");
    check_mesh_text_refused("a.obj", POINTS "f a b c\n", LS_MESSAGE_OBJ_NUMBER, "corner");
    check_mesh_text_refused("a.obj", "vn 0 0 1\nvt 0 0\n" POINTS "f 1/1/1/1 2 3\n",
                            LS_MESSAGE_OBJ_NUMBER, "too many");
    check_mesh_text_refused("a.obj", "v 0 0\n" POINTS FACE, LS_MESSAGE_OBJ_NUMBER, "line 1");
    check_mesh_text_refused("a.obj", "v 0 0 0 x\n" POINTS FACE, LS_MESSAGE_OBJ_NUMBER, "line 1");
    check_mesh_text_refused("a.obj", POINTS "vn 0 0\n" FACE, LS_MESSAGE_OBJ_NUMBER, "normal");
    check_mesh_text_refused("a.obj", POINTS "vt\n" FACE, LS_MESSAGE_OBJ_NUMBER, "texture");
    write_mesh_bytes("a.obj", "v 0 0 0\n\0\n", 10);
    check_mesh_refused("a.obj", LS_MESSAGE_TEXT_ZERO_BYTE, "zero byte");
    check_mesh_text_refused("a.obj", "\xFF\xFEv", LS_MESSAGE_TEXT_ZERO_BYTE, "UTF-16");
}

static void test_warned(void** state)
{
    (void)state;
    check_mesh_text_warned("a.obj", POINTS "curv 0 1 1 2 3\n" FACE, LS_MESSAGE_OBJ_STATEMENT,
                           "line 4: \"curv\"");
    check_mesh_text_warned("a.obj", POINTS "l 1 2\n" FACE, LS_MESSAGE_OBJ_STATEMENT, "\"l\"");
    check_mesh_text_warned("a.obj", "v 0 0 0 2\n" POINTS FACE, LS_MESSAGE_OBJ_VERTEX_REST,
                           "weight");
    check_mesh_text_warned("a.obj", "v 0 0 0 2 3\n" POINTS FACE, LS_MESSAGE_OBJ_VERTEX_REST,
                           "no colour");
    check_mesh_text_warned("a.obj", "v 0 0 0 1 .1 .2 .3\n" POINTS FACE, LS_MESSAGE_OBJ_VERTEX_REST,
                           "no colour");
    LsInput rest = import_mesh_text("a.obj", "v 0 0 0 1 .1 .2 .3\n" POINTS FACE);
    assert_null(rest.meshes[0].streams[LS_STREAM_COLOR].values);
    ls_input_destroy(&rest);
    check_mesh_text_warned("a.obj", POINTS "s 1\n" FACE, LS_MESSAGE_OBJ_SMOOTHING, "line 4");
    check_mesh_text_warned("a.obj", POINTS "f 1 2\n" FACE, LS_MESSAGE_OBJ_SMALL_FACES, "line 4");
    check_mesh_text_warned("a.obj", POINTS, LS_MESSAGE_OBJ_POINTS, "3 vertices");
    check_mesh_text_warned("a.obj", "mtllib no where.mtl\n" POINTS FACE, LS_MESSAGE_OBJ_LIBRARY,
                           "\"no where.mtl\"");
    check_mesh_text_warned("a.obj", POINTS "usemtl red brick\n" FACE, LS_MESSAGE_OBJ_MATERIAL,
                           "\"red brick\"");
    LsInput input = import_mesh_text("a.obj", POINTS "s off\n" FACE);
    assert_int_equal(input.warning_count, 0);
    ls_input_destroy(&input);
}

// ---- MTL ----------------------------------------------------------------------------------------

// The material of the only face of an OBJ whose library is `text`.
static LsInput import_material(const char* text, LsInputMaterial* material)
{
    write_mesh_text("a b.mtl", text);
    LsInput input = import_mesh_text("a.obj", "mtllib a b.mtl\n" POINTS "usemtl m 1\n" FACE);
    *material = input.materials[input.meshes[0].materials[0]];
    return input;
}

static void test_materials(void** state)
{
    (void)state;
    LsInputMaterial found;
    LsInput input = import_material("newmtl other\nKd 1 1 1\nnewmtl m 1\nKd 0.5 2 0.25\nKe 3 0 0\n"
                                    "Ka 1 1 1\nillum 2\nKs 0.5\nNs 30\nNi 1.25\n",
                                    &found);
    assert_int_equal(input.warning_count, 0);
    assert_string_equal(found.name, "m 1");
    assert_true(found.core.base_color.x == 0.5f && found.core.base_color.y == 1.0f);
    assert_true(found.core.emission.x == 3.0f);
    assert_int_equal(found.core.flags, LS_MATERIAL_EMISSIVE);
    assert_true(found.core.roughness == 0.5f && found.core.metallic == 0.0f);
    assert_true(found.surface.ior == 1.25f && found.surface.transmission == 0.0f);
    ls_input_destroy(&input);

    input = import_material("newmtl m 1\nPr 0.25\nPm 0.75\nKs 1 1 1\nNs 5\n", &found);
    assert_true(found.core.roughness == 0.25f && found.core.metallic == 0.75f);
    ls_input_destroy(&input);
    input = import_material("newmtl m 1\nKd 0 0 0\nKs 1 0.5 0.25\nNs 30\nillum 5\n", &found);
    assert_true(found.core.metallic == 1.0f && found.core.base_color.y == 0.5f);
    ls_input_destroy(&input);
    input = import_material("newmtl m 1\nillum 7\nTf 0.5 1 1\nNi 1.5\n", &found);
    assert_true(found.surface.transmission == 1.0f && found.core.base_color.x == 0.5f);
    ls_input_destroy(&input);
    input = import_material("newmtl m 1\nillum 4\nTr 0.75\n", &found);
    assert_true(found.surface.transmission == 0.75f);
    ls_input_destroy(&input);
}

static void test_textures(void** state)
{
    (void)state;
    write_tga("a b.tga", 2, 200, 100, 255);
    write_tga("alpha.tga", 2, 0, 255, 255);
    LsInputMaterial found;
    LsInput input = import_material("newmtl m 1\nmap_Kd -s 2 3 -o 0.5 0.25 -clamp on a b.tga\n"
                                    "map_Ke a b.tga\nnorm -bm 0.5 a b.tga\n",
                                    &found);
    assert_int_equal(input.warning_count, 0);
    assert_int_equal(input.image_count, 1);
    assert_int_equal(input.texture_count, 3);
    assert_int_equal(input.images[0].width, 2);
    assert_int_equal(input.images[0].pixels[3], 0xFF0064C8);
    const LsTexture* texture = &input.textures[found.surface.base_color_texture];
    assert_true(texture->row_u.x == 2.0f && texture->row_u.z == 0.5f);
    assert_true(texture->row_v.y == 3.0f && texture->row_v.z == -2.25f);
    assert_int_equal(texture->flags, LS_TEXTURE_SRGB | LS_TEXTURE_CLAMP_U | LS_TEXTURE_CLAMP_V);
    assert_int_equal(input.textures[found.surface.normal_texture].flags, 0);
    assert_true(found.surface.normal_scale == 0.5f && found.core.emission.y == 1.0f);
    ls_input_destroy(&input);

    // Holes by the brightness of another image.
    input = import_material("newmtl m 1\nmap_Kd a b.tga\nmap_d alpha.tga\n", &found);
    assert_int_equal(found.surface.flags, LS_SURFACE_MASK);
    const uint32_t image = input.textures[found.surface.base_color_texture].image;
    assert_int_equal(input.images[image].pixels[0], 0xB60064C8);
    ls_input_destroy(&input);

    // The limit of memory counts images.
    LsInput small = {.options.max_memory = 80};
    LsError error = {0};
    assert_int_equal(ls_import(&small, find_mesh_path("a.obj"), &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    ls_input_destroy(&small);
}

static void check_mtl_warned(const char* text, LsMessage message, const char* word)
{
    write_mesh_text("a.mtl", text);
    check_mesh_text_warned("a.obj", "mtllib a.mtl\n" POINTS "usemtl m\n" FACE, message, word);
}

static void test_mtl_warned(void** state)
{
    (void)state;
    write_tga("a.tga", 2, 1, 2, 3);
    write_tga("large.tga", 4, 1, 2, 3);
    write_mesh_text("broken.png", "\x89PNG");
    check_mtl_warned("newmtl m\nmap_bump h.png\n", LS_MESSAGE_MTL_STATEMENT, "heights");
    check_mtl_warned("newmtl m\nglow 7\n", LS_MESSAGE_MTL_STATEMENT, "line 2: \"glow\"");
    check_mtl_warned("newmtl m\nKd spectral a.rfl\n", LS_MESSAGE_MTL_STATEMENT, "\"Kd\"");
    check_mtl_warned("newmtl m\nmap_Kd -boost 2 a.tga\n", LS_MESSAGE_MTL_OPTION, "-boost");
    check_mtl_warned("newmtl m\nmap_Kd nowhere.png\n", LS_MESSAGE_MTL_IMAGE, "nowhere.png");
    check_mtl_warned("newmtl m\nmap_Kd broken.png\n", LS_MESSAGE_MTL_IMAGE, "no image");
    check_mtl_warned("newmtl m\nmap_Kd -clamp on\n", LS_MESSAGE_MTL_IMAGE, "no file");
    check_mtl_warned("newmtl m\nd 0.5\n", LS_MESSAGE_MTL_BLEND, "\"m\"");
    check_mtl_warned("newmtl m\nmap_Kd a.tga\nmap_d large.tga\n", LS_MESSAGE_MTL_ALPHA_MAP,
                     "large.tga");
}

// However many there are: so many warnings and no more.
static void test_many_warnings(void** state)
{
    (void)state;
    static char text[1 << 20];
    size_t length = 0;
    for (int i = 0; i < 20000; i++)
        length += (size_t)sprintf(text + length, "newmtl m%d\nd 0.5\nk%d 1\n", i, i);
    write_mesh_text("a.mtl", text);
    LsInput input = import_mesh_text("a.obj", "mtllib a.mtl\n" POINTS FACE);
    assert_int_equal(input.material_count, 20001);
    assert_int_equal(input.warning_count, 257);
    ls_input_destroy(&input);
}

static void test_mtl_refused(void** state)
{
    (void)state;
    static const struct
    {
        const char* text;
        const char* word;
    } cases[] = {{"newmtl a\nKd 1 x 1\n", "a.mtl: line 2"},
                 {"newmtl a\nKd inf 0 0\n", "finite"},
                 {"newmtl a\nNs many\n", "line 2"},
                 {"Kd 1 1 1\n", "before any newmtl"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        write_mesh_text("a.mtl", cases[i].text);
        LsInput input = {0};
        LsError error = {0};
        write_mesh_text("a.obj", "mtllib a.mtl\n" POINTS FACE);
        assert_int_equal(ls_import(&input, find_mesh_path("a.obj"), &error), LS_ERROR_INPUT_FORMAT);
        assert_int_equal(error.message, LS_MESSAGE_MTL_NUMBER);
        assert_non_null(strstr(error.text, cases[i].word));
        ls_input_destroy(&input);
    }
}

// ---- Damaged files ------------------------------------------------------------------------------

static void test_damaged(void** state)
{
    (void)state;
    write_tga("a.tga", 2, 1, 2, 3);
    const char mtl[] = "newmtl m\nKd 1 0 0\nmap_Kd -s 1 1 a.tga\nd 0.5\nillum 7\nmap_d a.tga\n";
    const char obj[] = "mtllib a.mtl\nusemtl m\nv 0 0 0 1 1 1\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
                       "f 1/1/1 2//1 3/1\nf 1 2 3 1\n";
    write_mesh_text("a.mtl", mtl);
    check_mesh_damage("a.obj", obj, sizeof obj - 1, 1000);
    write_mesh_text("a.obj", obj);
    // As bytes of the library and the image, imported through the OBJ.
    uint32_t random = 7;
    for (int i = 0; i < 600; i++)
    {
        char bytes[sizeof mtl];
        memcpy(bytes, mtl, sizeof mtl);
        random = random * 1664525u + 1013904223u;
        bytes[(random >> 8) % (sizeof mtl - 1)] = (char)(random >> 24 & 127);
        write_mesh_bytes("a.mtl", bytes, sizeof mtl - 1);
        uint8_t image[18 + 16] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 32, 8};
        image[(random >> 4) % sizeof image] = (uint8_t)(random >> 16);
        write_mesh_bytes("a.tga", image, sizeof image);
        LsInput input = {0};
        LsError error = {0};
        if (ls_import(&input, find_mesh_path("a.obj"), &error) != LS_OK)
            assert_true(error.message >= 2000);
        ls_input_destroy(&input);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_corners),       cmocka_unit_test(test_refused),
        cmocka_unit_test(test_warned),        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_textures),      cmocka_unit_test(test_mtl_warned),
        cmocka_unit_test(test_many_warnings), cmocka_unit_test(test_mtl_refused),
        cmocka_unit_test(test_damaged),
    };
    return cmocka_run_group_tests_name("import_obj", tests, make_mesh_folder, remove_mesh_folder);
}
