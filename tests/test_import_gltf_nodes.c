// test_import_gltf_nodes.c - glTF files: scenes, nodes, cameras, animation, what is left out.

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

// ---- Nodes --------------------------------------------------------------------------------------

static void test_nodes(void** state)
{
    (void)state;
    // A root turned by a quarter about z, scaled and moved; a mirrored child by matrix; two meshes,
    // one twice.
    gltf_begin_corners(3);
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
    gltf_begin_corners(3);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        gltf_check_members_refused(cases[i].members, cases[i].message, cases[i].word);

    // 65 levels of nodes.
    char members[8192];
    size_t length = (size_t)sprintf(members, SCENE "\"nodes\":[");
    for (int i = 1; i <= 64; i++)
        length += (size_t)sprintf(members + length, "{\"children\":[%d]},", i);
    sprintf(members + length, "{}]");
    gltf_check_members_refused(members, LS_MESSAGE_GLTF_NODE_DEPTH, "64 levels");
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
    gltf_begin_corners(3); // 0
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
    gltf_begin_corners(3);
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
    gltf_begin_corners(3);
    const float times[4] = {0, 1, -1, NAN}, values[8] = {0, 0, 0, 0, 1, NAN, 0, 0};
    gltf_add_floats(times, 2, 1);               // 1
    gltf_add_floats(times + 2, 1, 1);           // 2
    gltf_add_floats(times + 3, 1, 1);           // 3
    gltf_add_floats(&gltf_corners[0][0], 2, 3); // 4
    gltf_add_floats(values, 2, 4);              // 5
    gltf_add_floats(values + 3, 2, 2);          // 6: no legal type
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
        gltf_check_members_refused(members, cases[i].message, cases[i].word);
    }
    // A quaternion of zeros.
    gltf_begin_corners(3);
    gltf_add_floats(times, 2, 1);
    gltf_add_floats((const float[8]){0, 0, 0, 1}, 2, 4);
    gltf_check_members_refused("\"animations\":[{\"channels\":[" CHANNEL("0", "0", "rotation") //
                               "],\"samplers\":[{\"input\":1,\"output\":2}]}]," ANIMATED,
                               LS_MESSAGE_GLTF_ANIMATION, "length zero");
}

static void test_left_out(void** state)
{
    (void)state;
    gltf_begin_corners(3);
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
        cmocka_unit_test(test_nodes),     cmocka_unit_test(test_nodes_refused),
        cmocka_unit_test(test_animation), cmocka_unit_test(test_animation_refused),
        cmocka_unit_test(test_left_out),
    };
    return cmocka_run_group_tests_name("import_gltf_nodes", tests, gltf_make_folder,
                                       gltf_remove_folder);
}
