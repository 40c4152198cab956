// test_layout.c - C and GLSL see the same bytes: every member of every struct of ls_layout.h lies
// where reflection of layout.comp.glsl says. Argument: the reflection, as JSON.

#include "file_fixture.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <string.h>

typedef struct Member
{
    const char* name;
    size_t offset;
    size_t size;
} Member;

typedef struct Layout
{
    const char* name;
    size_t size;
    Member members[32]; // up to the first without name
} Layout;

#define MEMBER(type, member)                                        \
    {                                                               \
#member, offsetof(type, member), sizeof(((type*)0)->member) \
    }

static const Layout layouts[] = {
    {"LsTriangle",
     sizeof(LsTriangle),
     {MEMBER(LsTriangle, v0), MEMBER(LsTriangle, primitive), MEMBER(LsTriangle, v1),
      MEMBER(LsTriangle, material), MEMBER(LsTriangle, v2), MEMBER(LsTriangle, reserved)}},
    {"LsVoxel",
     sizeof(LsVoxel),
     {MEMBER(LsVoxel, first_reference), MEMBER(LsVoxel, reference_count), MEMBER(LsVoxel, shape),
      MEMBER(LsVoxel, table)}},
    {"LsCellBlock", sizeof(LsCellBlock), {MEMBER(LsCellBlock, cells)}},
    {"LsBvhNode",
     sizeof(LsBvhNode),
     {MEMBER(LsBvhNode, lower), MEMBER(LsBvhNode, escape), MEMBER(LsBvhNode, upper),
      MEMBER(LsBvhNode, leaf)}},
    {"LsObject",
     sizeof(LsObject),
     {MEMBER(LsObject, lower),
      MEMBER(LsObject, kind),
      MEMBER(LsObject, upper),
      MEMBER(LsObject, reach),
      MEMBER(LsObject, grid_lower),
      MEMBER(LsObject, inverse_cell),
      MEMBER(LsObject, cells),
      MEMBER(LsObject, bound),
      MEMBER(LsObject, first_triangle),
      MEMBER(LsObject, triangle_count),
      MEMBER(LsObject, first_block),
      MEMBER(LsObject, block_count),
      MEMBER(LsObject, first_cell_block),
      MEMBER(LsObject, cell_block_count),
      MEMBER(LsObject, first_subgrid),
      MEMBER(LsObject, subgrid_count),
      MEMBER(LsObject, first_voxel),
      MEMBER(LsObject, voxel_count),
      MEMBER(LsObject, first_reference),
      MEMBER(LsObject, reference_count),
      MEMBER(LsObject, first_leaf_node),
      MEMBER(LsObject, leaf_node_count),
      MEMBER(LsObject, first_shaft_word),
      MEMBER(LsObject, shaft_word_count),
      MEMBER(LsObject, face_count),
      MEMBER(LsObject, depth),
      MEMBER(LsObject, patches),
      MEMBER(LsObject, scene_patches)}},
    {"LsInstance",
     sizeof(LsInstance),
     {MEMBER(LsInstance, object_from_world), MEMBER(LsInstance, world_from_object),
      MEMBER(LsInstance, object), MEMBER(LsInstance, node), MEMBER(LsInstance, mask),
      MEMBER(LsInstance, flags), MEMBER(LsInstance, reserved)}},
    {"LsSceneNode",
     sizeof(LsSceneNode),
     {MEMBER(LsSceneNode, parent_from_node), MEMBER(LsSceneNode, parent),
      MEMBER(LsSceneNode, reserved)}},
    {"LsMaterial",
     sizeof(LsMaterial),
     {MEMBER(LsMaterial, base_color), MEMBER(LsMaterial, flags), MEMBER(LsMaterial, emission),
      MEMBER(LsMaterial, reserved0), MEMBER(LsMaterial, metallic), MEMBER(LsMaterial, roughness),
      MEMBER(LsMaterial, surface), MEMBER(LsMaterial, reserved1)}},
    {"LsLight",
     sizeof(LsLight),
     {MEMBER(LsLight, instance), MEMBER(LsLight, triangle), MEMBER(LsLight, area),
      MEMBER(LsLight, cumulative)}},
    {"LsCamera",
     sizeof(LsCamera),
     {MEMBER(LsCamera, world_from_camera), MEMBER(LsCamera, tan_half_y), MEMBER(LsCamera, aspect),
      MEMBER(LsCamera, reserved)}},
    {"LsSurface",
     sizeof(LsSurface),
     {MEMBER(LsSurface, transmission), MEMBER(LsSurface, ior), MEMBER(LsSurface, alpha),
      MEMBER(LsSurface, alpha_cutoff), MEMBER(LsSurface, normal_scale), MEMBER(LsSurface, flags),
      MEMBER(LsSurface, base_color_texture), MEMBER(LsSurface, metallic_roughness_texture),
      MEMBER(LsSurface, normal_texture), MEMBER(LsSurface, emissive_texture),
      MEMBER(LsSurface, transmission_texture), MEMBER(LsSurface, reserved)}},
    {"LsTexture",
     sizeof(LsTexture),
     {MEMBER(LsTexture, row_u), MEMBER(LsTexture, row_v), MEMBER(LsTexture, image),
      MEMBER(LsTexture, texcoord), MEMBER(LsTexture, flags), MEMBER(LsTexture, reserved)}},
    {"LsImage",
     sizeof(LsImage),
     {MEMBER(LsImage, width), MEMBER(LsImage, height), MEMBER(LsImage, first_pixel),
      MEMBER(LsImage, reserved)}},
    {"LsAttributes",
     sizeof(LsAttributes),
     {MEMBER(LsAttributes, first_normal), MEMBER(LsAttributes, first_texcoord),
      MEMBER(LsAttributes, first_color)}},
    {"LsTexcoord", sizeof(LsTexcoord), {MEMBER(LsTexcoord, u), MEMBER(LsTexcoord, v)}},
    {"LsCornerColor",
     sizeof(LsCornerColor),
     {MEMBER(LsCornerColor, red_green), MEMBER(LsCornerColor, blue_alpha)}},
    {"LsLamp",
     sizeof(LsLamp),
     {MEMBER(LsLamp, position), MEMBER(LsLamp, kind), MEMBER(LsLamp, direction),
      MEMBER(LsLamp, range), MEMBER(LsLamp, intensity), MEMBER(LsLamp, node),
      MEMBER(LsLamp, cos_inner), MEMBER(LsLamp, cos_outer), MEMBER(LsLamp, reserved)}},
    {"LsAnimation",
     sizeof(LsAnimation),
     {MEMBER(LsAnimation, first_channel), MEMBER(LsAnimation, channel_count),
      MEMBER(LsAnimation, duration), MEMBER(LsAnimation, reserved)}},
    {"LsChannel",
     sizeof(LsChannel),
     {MEMBER(LsChannel, node), MEMBER(LsChannel, path), MEMBER(LsChannel, interpolation),
      MEMBER(LsChannel, key_count), MEMBER(LsChannel, first_time), MEMBER(LsChannel, first_value),
      MEMBER(LsChannel, reserved)}},
    {"LsRay",
     sizeof(LsRay),
     {MEMBER(LsRay, origin), MEMBER(LsRay, tmin), MEMBER(LsRay, direction), MEMBER(LsRay, tmax)}},
    {"LsHit",
     sizeof(LsHit),
     {MEMBER(LsHit, t), MEMBER(LsHit, u), MEMBER(LsHit, v), MEMBER(LsHit, instance),
      MEMBER(LsHit, object), MEMBER(LsHit, primitive), MEMBER(LsHit, material),
      MEMBER(LsHit, flags)}},
    {"LsTraceScene",
     sizeof(LsTraceScene),
     {MEMBER(LsTraceScene, objects), MEMBER(LsTraceScene, instances),
      MEMBER(LsTraceScene, top_nodes), MEMBER(LsTraceScene, triangles),
      MEMBER(LsTraceScene, blocks), MEMBER(LsTraceScene, cell_blocks),
      MEMBER(LsTraceScene, subgrids), MEMBER(LsTraceScene, voxels),
      MEMBER(LsTraceScene, references), MEMBER(LsTraceScene, leaf_nodes),
      MEMBER(LsTraceScene, shafts), MEMBER(LsTraceScene, instance_count),
      MEMBER(LsTraceScene, transform_bound)}},
    {"LsDeviceScene",
     sizeof(LsDeviceScene),
     {MEMBER(LsDeviceScene, trace), MEMBER(LsDeviceScene, materials), MEMBER(LsDeviceScene, lights),
      MEMBER(LsDeviceScene, light_count), MEMBER(LsDeviceScene, reserved)}},
    {"LsTraceParams",
     sizeof(LsTraceParams),
     {MEMBER(LsTraceParams, scene), MEMBER(LsTraceParams, rays), MEMBER(LsTraceParams, hits),
      MEMBER(LsTraceParams, masks), MEMBER(LsTraceParams, ray_count),
      MEMBER(LsTraceParams, flags)}},
    {"LsTraceQueue",
     sizeof(LsTraceQueue),
     {MEMBER(LsTraceQueue, counts), MEMBER(LsTraceQueue, capacity), MEMBER(LsTraceQueue, next),
      MEMBER(LsTraceQueue, reserved)}},
    {"LsGridRay",
     sizeof(LsGridRay),
     {MEMBER(LsGridRay, origin), MEMBER(LsGridRay, smin), MEMBER(LsGridRay, direction),
      MEMBER(LsGridRay, smax), MEMBER(LsGridRay, index), MEMBER(LsGridRay, s0),
      MEMBER(LsGridRay, scales), MEMBER(LsGridRay, reserved)}},
    {"LsPassInstance",
     sizeof(LsPassInstance),
     {MEMBER(LsPassInstance, lower), MEMBER(LsPassInstance, mask), MEMBER(LsPassInstance, upper),
      MEMBER(LsPassInstance, flags), MEMBER(LsPassInstance, object_from_world),
      MEMBER(LsPassInstance, object_lower), MEMBER(LsPassInstance, reach),
      MEMBER(LsPassInstance, object_upper), MEMBER(LsPassInstance, first_box),
      MEMBER(LsPassInstance, instance), MEMBER(LsPassInstance, object),
      MEMBER(LsPassInstance, first_triangle), MEMBER(LsPassInstance, triangle_count)}},
    {"LsPairBox",
     sizeof(LsPairBox),
     {MEMBER(LsPairBox, lower), MEMBER(LsPairBox, reserved_0), MEMBER(LsPairBox, upper),
      MEMBER(LsPairBox, reserved_1)}},
    {"LsListParams",
     sizeof(LsListParams),
     {MEMBER(LsListParams, instances), MEMBER(LsListParams, boxes), MEMBER(LsListParams, triangles),
      MEMBER(LsListParams, rays), MEMBER(LsListParams, hits), MEMBER(LsListParams, masks),
      MEMBER(LsListParams, queue), MEMBER(LsListParams, ray_count), MEMBER(LsListParams, flags),
      MEMBER(LsListParams, list_count), MEMBER(LsListParams, transform_bound),
      MEMBER(LsListParams, begins), MEMBER(LsListParams, reserved)}},
    {"LsGridParams",
     sizeof(LsGridParams),
     {MEMBER(LsGridParams, triangles), MEMBER(LsGridParams, blocks),
      MEMBER(LsGridParams, cell_blocks), MEMBER(LsGridParams, subgrids),
      MEMBER(LsGridParams, voxels), MEMBER(LsGridParams, references),
      MEMBER(LsGridParams, leaf_nodes), MEMBER(LsGridParams, shafts), MEMBER(LsGridParams, hits),
      MEMBER(LsGridParams, queue), MEMBER(LsGridParams, grid_lower),
      MEMBER(LsGridParams, inverse_cell), MEMBER(LsGridParams, cells), MEMBER(LsGridParams, flags),
      MEMBER(LsGridParams, instance), MEMBER(LsGridParams, object),
      MEMBER(LsGridParams, first_triangle), MEMBER(LsGridParams, first_subgrid_block)}},
    {"LsLockstepParams",
     sizeof(LsLockstepParams),
     {MEMBER(LsLockstepParams, grid_lower), MEMBER(LsLockstepParams, inverse_cell),
      MEMBER(LsLockstepParams, cells), MEMBER(LsLockstepParams, flags),
      MEMBER(LsLockstepParams, rays), MEMBER(LsLockstepParams, hits),
      MEMBER(LsLockstepParams, masks), MEMBER(LsLockstepParams, ray_count),
      MEMBER(LsLockstepParams, instance_count), MEMBER(LsLockstepParams, grid_instance),
      MEMBER(LsLockstepParams, grid_object), MEMBER(LsLockstepParams, first_triangle),
      MEMBER(LsLockstepParams, reserved)}},
};

static const size_t layout_count = sizeof(layouts) / sizeof(layouts[0]);
static const char* reflection_path;
static cJSON* types;

static const char* find_text(const cJSON* object, const char* key)
{
    const cJSON* item = cJSON_GetObjectItemCaseSensitive(object, key);
    assert_true(cJSON_IsString(item));
    return item->valuestring;
}

static size_t find_size(const cJSON* object, const char* key)
{
    const cJSON* item = cJSON_GetObjectItemCaseSensitive(object, key);
    assert_true(cJSON_IsNumber(item));
    return (size_t)item->valuedouble;
}

// The reflected struct of a name, or NULL.
static const cJSON* find_type(const char* prefix, const char* name)
{
    char full[64];
    snprintf(full, sizeof(full), "%s%s", prefix, name);
    const cJSON* type;
    cJSON_ArrayForEach(type, types)
    {
        if (strcmp(find_text(type, "name"), full) == 0)
        {
            return cJSON_GetObjectItemCaseSensitive(type, "members");
        }
    }
    fail_msg("%s is not in the reflection", full);
    return NULL;
}

// Bytes that a reflected member takes.
static size_t measure_member(const cJSON* member)
{
    const cJSON* lengths = cJSON_GetObjectItemCaseSensitive(member, "array");
    if (lengths != NULL)
    {
        assert_int_equal(cJSON_GetArraySize(lengths), 1);
        return (size_t)cJSON_GetArrayItem(lengths, 0)->valuedouble *
               find_size(member, "array_stride");
    }
    static const struct
    {
        const char* name;
        size_t size;
    } plain[] = {{"uint", 4}, {"float", 4}, {"uvec2", 8}, {"vec3", 12}, {"vec4", 16}};
    for (size_t i = 0; i < sizeof(plain) / sizeof(plain[0]); ++i)
    {
        if (strcmp(find_text(member, "type"), plain[i].name) == 0)
        {
            return plain[i].size;
        }
    }
    // A struct of this header, by its key among the reflected types.
    const cJSON* nested = cJSON_GetObjectItemCaseSensitive(types, find_text(member, "type"));
    for (size_t i = 0; nested != NULL && i < layout_count; ++i)
    {
        if (strcmp(find_text(nested, "name"), layouts[i].name) == 0)
        {
            return layouts[i].size;
        }
    }
    fail_msg("type %s is not known here", find_text(member, "type"));
    return 0;
}

static void test_members(void** state)
{
    (void)state;
    for (size_t i = 0; i < layout_count; ++i)
    {
        const cJSON* members = find_type("", layouts[i].name);
        const Member* expected = layouts[i].members;
        size_t end = 0; // without padding each member begins where the one before ends
        const cJSON* member;
        cJSON_ArrayForEach(member, members)
        {
            assert_non_null(expected->name);
            assert_string_equal(find_text(member, "name"), expected->name);
            assert_int_equal(find_size(member, "offset"), expected->offset);
            assert_int_equal(measure_member(member), expected->size);
            assert_int_equal(expected->offset, end);
            end += expected->size;
            ++expected;
        }
        assert_null(expected->name);
        assert_int_equal(end, layouts[i].size);
    }
}

static void test_strides(void** state)
{
    (void)state;
    for (size_t i = 0; i < layout_count; ++i)
    {
        const cJSON* members = find_type("Buffer", layouts[i].name);
        assert_int_equal(cJSON_GetArraySize(members), 1);
        assert_int_equal(find_size(cJSON_GetArrayItem(members, 0), "array_stride"),
                         layouts[i].size);
    }
}

// No struct of the header is forgotten, neither here nor in the shader.
static void test_every_struct_is_compared(void** state)
{
    (void)state;
    LsFixtureBytes header = ls_fixture_read(LS_SOURCE_DIR "/format/include/ls_layout.h");
    header.bytes[header.size] = '\0'; // ls_fixture_read leaves room for it
    size_t found = 0;
    const char* at = (const char*)header.bytes;
    while ((at = strstr(at, "\nLS_STRUCT(")) != NULL)
    {
        at += strlen("\nLS_STRUCT(");
        const size_t length = strcspn(at, ")");
        bool known = false;
        for (size_t i = 0; i < layout_count; ++i)
        {
            known = known || (strlen(layouts[i].name) == length &&
                              strncmp(layouts[i].name, at, length) == 0);
        }
        if (!known)
        {
            fail_msg("%.*s is not compared", (int)length, at);
        }
        ++found;
    }
    assert_int_equal(found, layout_count);
    ls_fixture_free(&header);
}

int main(int argument_count, char** arguments)
{
    if (argument_count < 2)
    {
        fprintf(stderr, "usage: test_layout REFLECTION.json\n");
        return 1;
    }
    reflection_path = arguments[1];
    LsFixtureBytes text = ls_fixture_read(reflection_path);
    cJSON* root = cJSON_ParseWithLength((const char*)text.bytes, text.size);
    ls_fixture_free(&text);
    types = cJSON_GetObjectItemCaseSensitive(root, "types");
    if (types == NULL)
    {
        fprintf(stderr, "test_layout: %s: no reflection\n", reflection_path);
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_members),
        cmocka_unit_test(test_strides),
        cmocka_unit_test(test_every_struct_is_compared),
    };
    const int failures = cmocka_run_group_tests_name("layout", tests, NULL, NULL);
    cJSON_Delete(root);
    return failures;
}
