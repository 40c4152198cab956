// test_import_gltf_looks.c - glTF files: materials, textures, images, lamps; cut and damaged files.

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

#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}]"
#define SHOWN ONE_NODE "," MESH

// Red, green, blue; half transparent white, black, grey.
static const uint8_t pixels[24] = {255, 0,   0,   255, 0, 255, 0, 255, 0,   0,   255, 255,
                                   255, 255, 255, 128, 0, 0,   0, 255, 128, 128, 128, 255};

// ---- Materials ----------------------------------------------------------------------------------

static void test_materials(void** state)
{
    (void)state;
    gltf_begin_corners(3);
    gltf_write("\"materials\":["
               "{\"name\":\"lamp\",\"emissiveFactor\":[1,0.5,0],\"extensions\":"
               "{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":5000000000}},"
               "\"doubleSided\":true},"
               "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.75,0.5],"
               "\"metallicFactor\":0.125,\"roughnessFactor\":0.375},\"alphaMode\":\"MASK\","
               "\"alphaCutoff\":0.25},"
               "{\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":0.75},"
               "\"KHR_materials_ior\":{\"ior\":1.25}},\"alphaMode\":\"MASK\"},"
               "{\"extensions\":{\"KHR_materials_ior\":{\"ior\":0}},\"alphaMode\":\"OPAQUE\","
               "\"pbrMetallicRoughness\":{\"baseColorFactor\":[2,-1,0.5,0.5]}},"
               "{\"name\":\"veil\",\"alphaMode\":\"BLEND\",\"occlusionTexture\":{\"index\":0}}],"
               "\"textures\":[{}]," SHOWN);
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.material_count, 5);
    const LsInputMaterial* lamp = &input.materials[0];
    assert_string_equal(lamp->name, "lamp");
    // tinygltf would cut the strength to 32 bits.
    assert_true(lamp->core.emission.x == 5e9f && lamp->core.emission.y == 2.5e9f);
    assert_true(lamp->core.emission.z == 0.0f);
    assert_int_equal(lamp->core.flags, LS_MATERIAL_EMISSIVE | LS_MATERIAL_DOUBLE_SIDED);
    assert_true(lamp->core.base_color.x == 1.0f && lamp->core.metallic == 1.0f);
    assert_true(lamp->core.roughness == 1.0f);
    const LsSurface plain = LS_SURFACE_DEFAULT;
    assert_memory_equal(&lamp->surface, &plain, sizeof plain);

    const LsInputMaterial* mask = &input.materials[1];
    assert_null(mask->name);
    assert_true(mask->core.base_color.x == 0.25f && mask->core.base_color.y == 0.5f &&
                mask->core.base_color.z == 0.75f);
    assert_true(mask->core.metallic == 0.125f && mask->core.roughness == 0.375f);
    assert_int_equal(mask->core.flags, 0);
    assert_int_equal(mask->surface.flags, LS_SURFACE_MASK);
    assert_true(mask->surface.alpha == 0.5f && mask->surface.alpha_cutoff == 0.25f);

    const LsSurface* glass = &input.materials[2].surface;
    assert_true(glass->transmission == 0.75f && glass->ior == 1.25f);
    assert_true(glass->alpha == 1.0f && glass->alpha_cutoff == 0.5f);
    const LsInputMaterial* opaque = &input.materials[3];
    assert_true(opaque->surface.ior == 0.0f && opaque->surface.alpha == 1.0f);
    assert_true(opaque->core.base_color.x == 1.0f && opaque->core.base_color.y == 0.0f);
    assert_memory_equal(&input.materials[4].surface, &plain, sizeof plain);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_BLEND, "material 4 (\"veil\")");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_OCCLUSION, "material 4 (\"veil\")");
    assert_int_equal(input.warning_count, 2);
    ls_input_destroy(&input);

    static const struct
    {
        const char* material;
        LsMessage message;
        const char* word;
    } cases[] = {
        {"\"extensions\":{\"KHR_materials_ior\":{\"ior\":0.5}}", LS_MESSAGE_GLTF_MEMBER, "ior"},
        {"\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":-1}}",
         LS_MESSAGE_GLTF_MEMBER, "emissiveStrength"},
        {"\"emissiveFactor\":[1,1,1],\"extensions\":{\"KHR_materials_emissive_strength\":{"
         "\"emissiveStrength\":1e39}}",
         LS_MESSAGE_GLTF_RANGE, "float"},
        {"\"alphaMode\":\"MASK\",\"alphaCutoff\":-1", LS_MESSAGE_GLTF_MEMBER, "alphaCutoff"},
        {"\"normalTexture\":{\"index\":3}", LS_MESSAGE_GLTF_INDEX, "texture 3"},
        {"\"emissiveTexture\":{\"index\":0}", LS_MESSAGE_GLTF_INDEX, "image 7"},
        {"\"emissiveTexture\":{\"index\":1}", LS_MESSAGE_GLTF_INDEX, "sampler 7"},
        {"\"emissiveTexture\":{\"index\":2}", LS_MESSAGE_GLTF_MEMBER, "wrap mode 5"},
        {"\"emissiveTexture\":{\"index\":2,\"index\":-1}", LS_MESSAGE_GLTF_MEMBER, "index"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        char members[1024];
        snprintf(
            members, sizeof members,
            "\"materials\":[{%s}],\"textures\":[{\"source\":7},{\"source\":0,\"sampler\":7},"
            "{\"source\":0,\"sampler\":0}],\"samplers\":[{\"wrapS\":5}],\"images\":[{}]," SHOWN,
            cases[i].material);
        gltf_check_members_refused(members, cases[i].message, cases[i].word);
    }
}

// ---- Textures and images ------------------------------------------------------------------------

static void check_image(const LsInputImage* image)
{
    assert_int_equal(image->width, 3);
    assert_int_equal(image->height, 2);
    assert_memory_equal(image->pixels, pixels, sizeof pixels);
}

static void test_textures(void** state)
{
    (void)state;
    static uint8_t png[4096];
    const size_t size = gltf_make_png(png, 3, 2, 8, pixels);
    gltf_write_bytes("an image.png", png, size);
    gltf_begin_corners(3);
    gltf_add_view(png, size, 0);
    static char members[16384];
    snprintf(
        members, sizeof members,
        "\"images\":[{\"uri\":\"an%%20image.png\"},{\"uri\":\"%s\"},{\"bufferView\":1,"
        "\"mimeType\":\"image/png\"},{\"uri\":\"no such image, and nobody asks\"}],"
        "\"samplers\":[{\"magFilter\":9728,\"wrapS\":33071,\"wrapT\":33648},{\"magFilter\":9729,"
        "\"minFilter\":9984,\"wrapS\":33648,\"wrapT\":10497}],"
        "\"textures\":[{\"source\":0},{\"source\":1,\"sampler\":0},{\"source\":2,\"sampler\":1},"
        "{\"source\":3}],"
        "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},"
        "\"metallicRoughnessTexture\":{\"index\":1,\"texCoord\":1}},\"normalTexture\":{\"index\":2,"
        "\"scale\":-0.5},\"emissiveTexture\":{\"index\":0},\"extensions\":{"
        "\"KHR_materials_transmission\":{\"transmissionTexture\":{\"index\":0}}}},"
        "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":3,"
        "\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.5,0.25],\"rotation\":"
        "1.5707963267948966,\"scale\":[2,4],\"texCoord\":1}}}},\"emissiveTexture\":{\"index\":0,"
        "\"texCoord\":0,\"extensions\":{\"KHR_texture_transform\":{\"rotation\":0.5}}}}]," SHOWN,
        gltf_print_data_uri("image/png", png, size));
    gltf_write(members);
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.warning_count, 0);
    assert_int_equal(input.image_count, 3);
    for (uint32_t i = 0; i < 3; i++)
        check_image(&input.images[i]);

    // Base colour and emission are one texture; transmission is of the same image, but linear.
    assert_int_equal(input.texture_count, 6);
    const LsSurface* surface = &input.materials[0].surface;
    assert_int_equal(surface->base_color_texture, 0);
    assert_int_equal(surface->metallic_roughness_texture, 1);
    assert_int_equal(surface->normal_texture, 2);
    assert_int_equal(surface->emissive_texture, 0);
    assert_int_equal(surface->transmission_texture, 3);
    assert_true(surface->normal_scale == -0.5f);
    static const struct
    {
        uint32_t image, texcoord, flags;
    } expected[6] = {
        {0, 0, LS_TEXTURE_SRGB},
        {1, 1, LS_TEXTURE_NEAREST | LS_TEXTURE_CLAMP_U | LS_TEXTURE_MIRROR_V},
        {2, 0, LS_TEXTURE_MIRROR_U},
        {0, 0, 0},
        {0, 1, LS_TEXTURE_SRGB},
        {0, 0, LS_TEXTURE_SRGB},
    };
    for (uint32_t i = 0; i < 6; i++)
    {
        const LsTexture* texture = &input.textures[i];
        assert_int_equal(texture->image, expected[i].image);
        assert_int_equal(texture->texcoord, expected[i].texcoord);
        assert_int_equal(texture->flags, expected[i].flags);
        if (i < 4)
        {
            const LsVec4 u = {1, 0, 0, 0}, v = {0, 1, 0, 0};
            assert_memory_equal(&texture->row_u, &u, sizeof u);
            assert_memory_equal(&texture->row_v, &v, sizeof v);
        }
    }
    // A quarter turn, counter-clockwise on an image whose v runs down: u' = 4 v, v' = -2 u, moved.
    const LsTexture* turned = &input.textures[4];
    const LsVec4 row_u = {0, 4, 0.5f, 0}, row_v = {-2, 0, 0.25f, 0};
    assert_memory_equal(&turned->row_u, &row_u, sizeof row_u);
    assert_memory_equal(&turned->row_v, &row_v, sizeof row_v);
    turned = &input.textures[5];
    assert_true(turned->row_u.x == (float)cos(0.5) && turned->row_u.y == (float)sin(0.5));
    assert_true(turned->row_v.x == (float)-sin(0.5) && turned->row_v.y == (float)cos(0.5));
    ls_input_destroy(&input);
}

// A material whose base colour is texture 0, of image 0.
static void write_image(const char* image, const char* info)
{
    static char members[16384];
    snprintf(members, sizeof members,
             "\"images\":[{\"name\":\"wood\",%s}],\"textures\":[{\"source\":0}],\"materials\":[{"
             "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0%s}}}]," SHOWN,
             image, info);
    gltf_write(members);
}

static void check_image_left_out(const char* image, LsMessage message, const char* word)
{
    write_image(image, "");
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.triangle_count, 1);
    assert_int_equal(input.image_count, 0);
    assert_int_equal(input.texture_count, 0);
    assert_int_equal(input.materials[0].surface.base_color_texture, LS_NONE);
    gltf_check_warned(&input, "a.gltf", message, word);
    assert_int_equal(input.warning_count, 1);
    ls_input_destroy(&input);
}

static void test_images(void** state)
{
    (void)state;
    // 16 bits, reduced.
    static uint8_t png[4096];
    size_t size = gltf_make_png(png, 3, 2, 16, pixels);
    gltf_write_bytes("deep.png", png, size);
    gltf_begin_corners(3);
    write_image("\"uri\":\"deep.png\"", "");
    LsInput input = gltf_import("a.gltf");
    check_image(&input.images[0]);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_IMAGE_DEPTH, "image 0 (\"wood\")");
    ls_input_destroy(&input);

    // A JPEG: eight by eight pixels of one grey, the shortest that the standard allows.
    static const uint8_t jpeg[] = {
        0xFF, 0xD8, 0xFF, 0xDB, 0x00, 0x43, 0x00, 1,    1,    1,    1,    1,    1,    1,    1,    1,
        1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,
        1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,
        1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,    1,
        1,    1,    1,    1,    1,    1,    1,    0xFF, 0xC0, 0x00, 0x0B, 8,    0,    8,    0,    8,
        1,    1,    0x11, 0,    0xFF, 0xC4, 0x00, 0x14, 0x00, 1,    0,    0,    0,    0,    0,    0,
        0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0xFF, 0xC4, 0x00, 0x14, 0x10, 1,
        0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,
        0xFF, 0xDA, 0x00, 0x08, 1,    1,    0,    0,    63,   0,    0x3F, 0xFF, 0xD9};
    gltf_write_bytes("grey.jpg", jpeg, sizeof jpeg);
    write_image("\"uri\":\"grey.jpg\"", "");
    input = gltf_import("a.gltf");
    assert_int_equal(input.image_count, 1);
    assert_int_equal(input.images[0].width, 8);
    for (int i = 0; i < 64; i++)
        assert_int_equal(input.images[0].pixels[i], 0xFF808080u);
    ls_input_destroy(&input);

    // What cannot be read or decoded.
    size = gltf_make_png(png, 3, 2, 8, pixels);
    gltf_write_bytes("cut.png", png, size / 2);
    gltf_write_bytes("head.png", png, 12);
    gltf_write_bytes("a.gif", "GIF89a and so on", 16);
    png[18] = 0x40, png[19] = 1; // 16385 wide
    gltf_write_bytes("wide.png", png, size);
    check_image_left_out("\"uri\":\"absent.png\"", LS_MESSAGE_GLTF_WARN_IMAGE, "absent.png");
    check_image_left_out("\"uri\":\"https://localhost/x.png\"", LS_MESSAGE_GLTF_WARN_IMAGE,
                         "https://localhost/x.png");
    check_image_left_out("\"uri\":\"cut.png\"", LS_MESSAGE_GLTF_WARN_IMAGE, "its data is damaged");
    check_image_left_out("\"uri\":\"head.png\"", LS_MESSAGE_GLTF_WARN_IMAGE, "no image of a kind");
    check_image_left_out("\"uri\":\"a.gif\"", LS_MESSAGE_GLTF_WARN_IMAGE, "neither PNG nor JPEG");
    check_image_left_out("\"uri\":\"wide.png\"", LS_MESSAGE_GLTF_WARN_IMAGE,
                         "more than 16384 pixels a side");
    check_image_left_out("\"mimeType\":\"image/png\"", LS_MESSAGE_GLTF_WARN_IMAGE, "neither a URI");
    check_image_left_out("\"uri\":\"data:image/png;base64,AAAA\"", LS_MESSAGE_GLTF_WARN_IMAGE,
                         "image 0 (\"wood\")");
    check_image_left_out("\"bufferView\":0", LS_MESSAGE_GLTF_WARN_IMAGE, "neither PNG nor JPEG");
    write_image("\"bufferView\":9", "");
    gltf_check_refused("a.gltf", LS_MESSAGE_GLTF_INDEX, "buffer view 9");

    // Within the limits of memory.
    size = gltf_make_png(png, 3, 2, 8, pixels);
    gltf_write_bytes("good.png", png, size);
    write_image("\"uri\":\"good.png\"", "");
    input = gltf_import("a.gltf");
    const uint64_t needed = input.memory_bytes;
    assert_true(needed >= 24);
    ls_input_destroy(&input);

    // Textures that are left out for themselves.
    write_image("\"uri\":\"good.png\"", ",\"texCoord\":2");
    input = gltf_import("a.gltf");
    assert_int_equal(input.image_count, 0);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_TEXTURE,
                      "texture 0, baseColorTexture of material 0");
    ls_input_destroy(&input);
    gltf_write(
        "\"extensionsUsed\":[\"KHR_texture_basisu\",\"EXT_texture_webp\"],"
        "\"images\":[{\"uri\":\"good.png\"},{\"uri\":\"x.ktx2\"}],\"textures\":[{\"source\":0,"
        "\"extensions\":{\"EXT_texture_webp\":{\"source\":1}}},{\"extensions\":{"
        "\"KHR_texture_basisu\":{\"source\":1}}}],\"materials\":[{\"pbrMetallicRoughness\":{"
        "\"baseColorTexture\":{\"index\":0}},\"emissiveTexture\":{\"index\":1}}]," SHOWN);
    input = gltf_import("a.gltf");
    assert_int_equal(input.image_count, 1);
    assert_int_equal(input.materials[0].surface.base_color_texture, 0);
    assert_int_equal(input.materials[0].surface.emissive_texture, LS_NONE);
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_EXTENSION,
                      "EXT_texture_webp is not supported: texture 0");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_EXTENSION,
                      "KHR_texture_basisu is not supported: texture 1");
    gltf_check_warned(&input, "a.gltf", LS_MESSAGE_GLTF_WARN_TEXTURE, "without a PNG or JPEG");
    assert_int_equal(input.warning_count, 3);
    ls_input_destroy(&input);
}

// ---- Lamps --------------------------------------------------------------------------------------

#define LAMPS(lights)                                                                  \
    "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[" lights "]}},\"scenes\":[{" \
    "\"nodes\":[0]}],"
#define LAMP(number) "\"extensions\":{\"KHR_lights_punctual\":{\"light\":" number "}}"

static void check_vector(LsVec3 vector, float x, float y, float z)
{
    assert_true(fabsf(vector.x - x) < 1e-6f && fabsf(vector.y - y) < 1e-6f &&
                fabsf(vector.z - z) < 1e-6f);
}

static void test_lamps(void** state)
{
    (void)state;
    gltf_begin();
    // Under a root that turns -z to -x, moves and scales.
    gltf_write(LAMPS("{\"type\":\"point\",\"intensity\":4,\"color\":[1,0.5,0.25],\"range\":7},"
                     "{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":0.5,\"outerConeAngle\":1}},"
                     "{\"type\":\"spot\",\"spot\":{}},"
                     "{\"type\":\"directional\",\"intensity\":2,\"range\":3}") //
               "\"nodes\":[{\"children\":[1,2,3,4,5],\"translation\":[1,2,3],\"scale\":[2,2,2],"
               "\"rotation\":[0,0.70710678118654752,0,0.70710678118654752]},"
               "{\"translation\":[0,0,1]," LAMP("0") "},{" LAMP("1") "},{" LAMP("2") "},{" LAMP(
                   "3") "},{" LAMP("0") "}]");
    LsInput input = gltf_import("a.gltf");
    assert_int_equal(input.warning_count, 0);
    assert_int_equal(input.lamp_count, 5);
    const LsLamp* lamp = input.lamps;
    assert_int_equal(lamp->kind, LS_LAMP_POINT);
    assert_int_equal(lamp->node, 1);
    check_vector(lamp->position, 3, 2, 3);
    assert_true(lamp->direction.x == 0.0f && lamp->direction.y == 0.0f &&
                lamp->direction.z == -1.0f);
    assert_true(lamp->intensity.x == 4.0f && lamp->intensity.y == 2.0f &&
                lamp->intensity.z == 1.0f);
    assert_true(lamp->range == 7.0f && lamp->cos_inner == 1.0f && lamp->cos_outer == -1.0f);
    lamp = &input.lamps[1];
    assert_int_equal(lamp->kind, LS_LAMP_SPOT);
    check_vector(lamp->position, 1, 2, 3);
    check_vector(lamp->direction, -1, 0, 0);
    assert_true(lamp->intensity.x == 1.0f && lamp->intensity.z == 1.0f && lamp->range == 0.0f);
    assert_true(lamp->cos_inner == (float)cos(0.5) && lamp->cos_outer == (float)cos(1.0));
    assert_true(input.lamps[2].cos_inner == 1.0f);
    assert_true(input.lamps[2].cos_outer == (float)cos(atan(1.0)));
    lamp = &input.lamps[3];
    assert_int_equal(lamp->kind, LS_LAMP_DIRECTIONAL);
    assert_int_equal(lamp->node, 4);
    check_vector(lamp->direction, -1, 0, 0);
    assert_true(lamp->position.x == 0.0f && lamp->position.y == 0.0f && lamp->position.z == 0.0f);
    assert_true(lamp->intensity.y == 2.0f && lamp->range == 0.0f);
    assert_true(lamp->cos_inner == 1.0f && lamp->cos_outer == -1.0f);
    assert_int_equal(input.lamps[4].node, 5);
    ls_input_destroy(&input);

#define NODE0 "\"nodes\":[{" LAMP("0") "}]"
    static const struct
    {
        const char* members;
        LsMessage message;
        const char* word;
    } cases[] = {
        {LAMPS("{\"type\":\"area\"}") NODE0, LS_MESSAGE_GLTF_MEMBER, "area"},
        {LAMPS("{\"type\":\"point\",\"intensity\":-1}") NODE0, LS_MESSAGE_GLTF_MEMBER, "negative"},
        {LAMPS("{\"type\":\"point\",\"color\":[1,-1,1]}") NODE0, LS_MESSAGE_GLTF_MEMBER,
         "negative"},
        {LAMPS("{\"type\":\"point\",\"color\":[1,1]}") NODE0, LS_MESSAGE_GLTF_MEMBER,
         "lights[0].color"},
        {LAMPS("{\"type\":\"point\",\"intensity\":\"1\"}") NODE0, LS_MESSAGE_GLTF_MEMBER,
         "intensity"},
        {LAMPS("{\"type\":\"point\",\"intensity\":1e39}") NODE0, LS_MESSAGE_GLTF_RANGE, "float"},
        {LAMPS("{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":1}}") NODE0, LS_MESSAGE_GLTF_MEMBER,
         "cone"},
        {LAMPS("{\"type\":\"spot\",\"spot\":{\"outerConeAngle\":2}}") NODE0, LS_MESSAGE_GLTF_MEMBER,
         "cone"},
        {LAMPS("{\"type\":\"spot\"}") NODE0, LS_MESSAGE_GLTF_JSON, "Spot"},
        {LAMPS("{\"type\":\"directional\"}") "\"nodes\":[{\"scale\":[0,0,0]," LAMP("0") "}]",
         LS_MESSAGE_GLTF_TRANSFORM, "scaled to nothing"},
        {LAMPS("{}") NODE0, LS_MESSAGE_GLTF_MEMBER, "type is missing"},
        {"\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":4,\"znear\":1}}],"
         "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"camera\":0}]",
         LS_MESSAGE_GLTF_MEMBER, "field of view"},
        {"\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1e-60,\"znear\":1}}],"
         "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"camera\":0}]",
         LS_MESSAGE_GLTF_RANGE, "narrow"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        gltf_check_members_refused(cases[i].members, cases[i].message, cases[i].word);
}

// ---- Cut and damaged files ----------------------------------------------------------------------

// A GLB that has some of all.
static size_t print_everything(uint8_t* bytes)
{
    static uint8_t png[4096];
    const float times[2] = {0, 1};
    const uint16_t places[1] = {2}, indices[3] = {0, 1, 2};
    const uint8_t colors[12] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255};
    gltf_begin_corners(3); // accessor 0, view 0
    const int image = gltf_add_view(png, gltf_make_png(png, 3, 2, 8, pixels), 0);
    char more[256];
    snprintf(more, sizeof more,
             "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":%d,\"componentType\":5123},"
             "\"values\":{\"bufferView\":0}}",
             gltf_add_view(places, 2, 0));
    gltf_add_accessor(0, 0, F32, 3, "VEC3", more);                                            // 1
    gltf_add_words(indices, 3);                                                               // 2
    gltf_add_accessor(gltf_add_view(colors, 12, 0), 0, U8, 3, "VEC4", "\"normalized\":true"); // 3
    gltf_add_floats(times, 2, 1);                                                             // 4
    gltf_add_accessor(0, 0, F32, 2, "VEC3", "");                                              // 5
    char members[4096];
    snprintf(
        members, sizeof members,
        "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\",\"spot\":{}}]}},"
        "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"camera\":0,"
        "\"children\":[1]},{\"translation\":[1,2,3]," LAMP(
            "0") "}],\"cameras\":[{\"type\":"
                 "\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1}}],\"meshes\":[{"
                 "\"primitives\":[{\"attributes\":{\"POSITION\":1,\"NORMAL\":0,\"COLOR_0\":3},"
                 "\"indices\":2,\"material\":0},{\"attributes\":{\"POSITION\":0},\"mode\":5}]}],"
                 "\"images\":[{\"bufferView\":%d}],\"samplers\":[{\"wrapS\":33071}],\"textures\":[{"
                 "\"source\":0,\"sampler\":0}],\"materials\":[{\"alphaMode\":\"MASK\","
                 "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{"
                 "\"KHR_texture_transform\":{\"rotation\":1}}}}}],\"animations\":[{\"channels\":[{"
                 "\"sampler\":0,\"target\":{\"node\":1,\"path\":\"scale\"}}],\"samplers\":[{"
                 "\"input\":4,"
                 "\"output\":5}]}]",
        image);
    return gltf_print_glb(members, bytes);
}

// Whatever is taken is within bounds.
static void check_input(const LsInput* input)
{
    for (uint32_t m = 0; m < input->mesh_count; m++)
    {
        const LsInputMesh* mesh = &input->meshes[m];
        for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++)
            assert_true(mesh->indices[i] < mesh->vertex_count);
        for (uint32_t i = 0; i < mesh->triangle_count; i++)
            assert_true(mesh->materials[i] < input->material_count);
        for (int k = 0; k < LS_STREAM_COUNT; k++)
            assert_true(!mesh->streams[k].values || mesh->streams[k].count == mesh->vertex_count);
    }
    for (uint32_t i = 0; i < input->instance_count; i++)
        assert_true(input->instances[i].mesh < input->mesh_count &&
                    input->instances[i].node < input->node_count);
    for (uint32_t i = 0; i < input->texture_count; i++)
        assert_true(input->textures[i].image < input->image_count &&
                    input->textures[i].texcoord < 2);
    for (uint32_t i = 0; i < input->material_count; i++)
    {
        const uint32_t texture = input->materials[i].surface.base_color_texture;
        assert_true(texture == LS_NONE || texture < input->texture_count);
    }
    for (uint32_t i = 0; i < input->channel_count; i++)
        assert_true(input->channels[i].node < input->node_count &&
                    input->channels[i].first_value < input->key_count &&
                    input->channels[i].key_count >= 1);
    for (uint32_t i = 0; i < input->key_count; i++)
        assert_true(isfinite(input->keys[i]));
}

static bool import_damaged(const char* name, const uint8_t* bytes, size_t size)
{
    gltf_write_bytes(name, bytes, size);
    LsInput input = {.options.max_memory = 64 << 20};
    LsError error = {0};
    const LsResult result = ls_import(&input, gltf_find_path(name), &error);
    if (result == LS_OK)
        check_input(&input);
    else
    {
        assert_non_null(strstr(error.text, name));
        assert_null(strchr(error.text, '\n'));
        assert_int_equal(error.message / 100, result);
    }
    ls_input_destroy(&input);
    return result == LS_OK;
}

static void test_cut(void** state)
{
    (void)state;
    static uint8_t bytes[1 << 16];
    const size_t size = print_everything(bytes);
    assert_true(import_damaged("a.glb", bytes, size));
    LsInput input = gltf_import("a.glb");
    assert_int_equal(input.warning_count, 0);
    assert_int_equal(input.triangle_count, 2);
    assert_int_equal(input.lamp_count + input.camera_count + input.texture_count, 3);
    assert_int_equal(input.channel_count, 3);
    ls_input_destroy(&input);
    for (size_t length = 1; length < size; length++)
        if (import_damaged("a.glb", bytes, length))
            fail_msg("cut after %zu bytes it was taken", length);
    // The JSON alone, cut, with the buffer elsewhere.
    uint32_t json_bytes;
    memcpy(&json_bytes, bytes + 12, 4);
    for (size_t length = 1; length < json_bytes - 4; length += 3)
        assert_false(import_damaged("a.gltf", bytes + 20, length));
}

// Random bytes, digits and pieces moved: any result, but within bounds and with a message.
static void test_damage(void** state)
{
    (void)state;
    static uint8_t good[1 << 16], bytes[1 << 16];
    const size_t size = print_everything(good);
    uint32_t random = 1;
    unsigned taken = 0, refused = 0;
    for (int i = 0; i < 6000; i++)
    {
        memcpy(bytes, good, size);
        for (int k = 0; k <= i % 4; k++)
        {
            random = random * 1664525u + 1013904223u;
            const size_t place = (random >> 8) % size;
            random = random * 1664525u + 1013904223u;
            const size_t other = (random >> 8) % (size - 16);
            if (i % 3 == 0)
                bytes[place] = (uint8_t)(random >> 24);
            else if (i % 3 == 1 && bytes[place] >= '0' && bytes[place] <= '9')
                bytes[place] = (uint8_t)('0' + random % 10);
            else if (place + 16 < size)
                memcpy(bytes + place, good + other, random % 8);
        }
        if (import_damaged("a.glb", bytes, size))
            taken++;
        else
            refused++;
    }
    assert_true(taken > 100 && refused > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_materials), cmocka_unit_test(test_textures),
        cmocka_unit_test(test_images),    cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_cut),       cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests_name("import_gltf_looks", tests, gltf_make_folder,
                                       gltf_remove_folder);
}
