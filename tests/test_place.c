// test_place.c - conversion and placement of what a file brought.

#include "compose_fixture.h"
#include "place.h"

#include <math.h>
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

// ---- Matrices -----------------------------------------------------------------------------------

typedef struct Matrix
{
    double rows[3][4];
} Matrix;

static Matrix from_rows(const LsVec4 rows[3])
{
    Matrix matrix;
    for (int i = 0; i < 3; i++)
        memcpy(matrix.rows[i], (const double[]){rows[i].x, rows[i].y, rows[i].z, rows[i].w},
               sizeof matrix.rows[i]);
    return matrix;
}

static Matrix from_instance(const LsInputInstance* instance)
{
    Matrix matrix;
    memcpy(matrix.rows, instance->world_from_object, sizeof matrix.rows);
    return matrix;
}

static Matrix times(Matrix a, Matrix b)
{
    Matrix product;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
        {
            product.rows[i][j] = j == 3 ? a.rows[i][3] : 0.0;
            for (int k = 0; k < 3; k++)
                product.rows[i][j] += a.rows[i][k] * b.rows[k][j];
        }
    return product;
}

static void apply(Matrix matrix, const double p[3], double w, double out[3])
{
    for (int i = 0; i < 3; i++)
    {
        out[i] = matrix.rows[i][3] * w;
        for (int k = 0; k < 3; k++)
            out[i] += matrix.rows[i][k] * p[k];
    }
}

static void check_matrices(Matrix a, Matrix b, double tolerance)
{
    ls_compose_check_close(a.rows[0], b.rows[0], 12, tolerance);
}

// What up and scale do to a point, said once more.
static Matrix convert(const LsBakeInput* how)
{
    const double s = how->scale > 0.0 ? how->scale : 1.0;
    if (how->up == LS_UP_Z)
        return (Matrix){{{s, 0, 0, 0}, {0, 0, s, 0}, {0, -s, 0, 0}}};
    if (how->up == LS_UP_X)
        return (Matrix){{{0, -s, 0, 0}, {s, 0, 0, 0}, {0, 0, s, 0}}};
    return (Matrix){{{s, 0, 0, 0}, {0, s, 0, 0}, {0, 0, s, 0}}};
}

static Matrix invert_conversion(const LsBakeInput* how)
{
    const double s = how->scale > 0.0 ? how->scale : 1.0;
    const Matrix forward = convert(how);
    Matrix back = {0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            back.rows[i][j] = forward.rows[j][i] / (s * s);
    return back;
}

// World matrix of a node from its chain of parents.
static Matrix chain(const LsInput* input, uint32_t node)
{
    Matrix world = from_rows(input->nodes[node].parent_from_node);
    while ((node = input->nodes[node].parent) != LS_NONE)
        world = times(from_rows(input->nodes[node].parent_from_node), world);
    return world;
}

static void check_chains(const LsInput* input)
{
    for (uint32_t i = 0; i < input->node_count; i++)
        assert_true(input->nodes[i].parent == LS_NONE || input->nodes[i].parent < i);
    for (uint32_t i = 0; i < input->instance_count; i++)
        if (input->instances[i].node != LS_NONE)
            check_matrices(chain(input, input->instances[i].node),
                           from_instance(&input->instances[i]), 1e-5);
}

static void world_point(const LsInput* input, uint32_t instance, uint32_t vertex, double out[3])
{
    const LsInputInstance* placed = &input->instances[instance];
    const float* p = input->meshes[placed->mesh].positions + 3 * vertex;
    apply(from_instance(placed), (const double[]){p[0], p[1], p[2]}, 1.0, out);
}

// Around the vertices that triangles use, of the instances from `first` on.
static void find_box(const LsInput* input, uint32_t first, double lower[3], double upper[3])
{
    for (int axis = 0; axis < 3; axis++)
    {
        lower[axis] = INFINITY;
        upper[axis] = -INFINITY;
    }
    for (uint32_t i = first; i < input->instance_count; i++)
        for (uint32_t k = 0; k < 4; k++)
        {
            double p[3];
            world_point(input, i, k, p);
            for (int axis = 0; axis < 3; axis++)
            {
                lower[axis] = fmin(lower[axis], p[axis]);
                upper[axis] = fmax(upper[axis], p[axis]);
            }
        }
}

// ---- Conversion ---------------------------------------------------------------------------------

static void check_same_bytes(const LsInput* a, const LsInput* b)
{
    assert_int_equal(a->mesh_count, b->mesh_count);
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->instance_count, b->instance_count);
    assert_int_equal(a->camera_count, b->camera_count);
    for (uint32_t i = 0; i < a->mesh_count; i++)
    {
        assert_memory_equal(a->meshes[i].positions, b->meshes[i].positions,
                            a->meshes[i].vertex_count * 3 * sizeof(float));
        assert_memory_equal(a->meshes[i].indices, b->meshes[i].indices,
                            a->meshes[i].triangle_count * 3 * sizeof(uint32_t));
    }
    if (a->node_count)
        assert_memory_equal(a->nodes, b->nodes, a->node_count * sizeof *a->nodes);
    assert_memory_equal(a->instances, b->instances, a->instance_count * sizeof *a->instances);
    if (a->camera_count)
        assert_memory_equal(a->cameras, b->cameras, a->camera_count * sizeof *a->cameras);
}

static void test_nothing_asked(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    LsInput plain = {0};
    LsError error;
    assert_int_equal(ls_import(&plain, ls_compose_path("a.gltf"), &error), LS_OK);
    LsInput composed =
        ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.gltf"), .scale = 1.0}, 1);
    assert_int_equal(composed.instance_count, 2);
    assert_int_equal(composed.camera_count, 1);
    check_same_bytes(&plain, &composed);
    ls_input_destroy(&plain);
    ls_input_destroy(&composed);
}

static void test_up_is_exact(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    LsInput z =
        ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.ply"), .up = LS_UP_Z}, 1);
    LsInput x =
        ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.ply"), .up = LS_UP_X}, 1);
    for (int i = 0; i < 5; i++)
    {
        const float* p = ls_compose_corners[i];
        const float up_z[3] = {p[0], p[2], 0.0f - p[1]};
        const float up_x[3] = {0.0f - p[1], p[0], p[2]};
        assert_memory_equal(z.meshes[0].positions + 3 * i, up_z, sizeof up_z);
        assert_memory_equal(x.meshes[0].positions + 3 * i, up_x, sizeof up_x);
    }
    // An identity stays an identity, in every bit.
    const double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    assert_memory_equal(z.instances[0].world_from_object, identity, sizeof identity);
    assert_memory_equal(x.instances[0].world_from_object, identity, sizeof identity);
    assert_int_equal(z.instances[0].node, LS_NONE);
    ls_input_destroy(&z);
    ls_input_destroy(&x);
}

// World positions are the converted ones of before, whatever the hierarchy.
static void test_conversion_of_a_tree(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    LsInput plain = ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.gltf")}, 1);
    static const LsBakeInput ways[] = {{.up = LS_UP_Z},
                                       {.up = LS_UP_X, .scale = 2.5},
                                       {.up = LS_UP_Y, .scale = 0.01},
                                       {.up = LS_UP_Z, .scale = 1000.0}};
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++)
    {
        LsBakeInput how = ways[way];
        how.path = ls_compose_path("a.gltf");
        LsInput input = ls_compose_inputs(&how, 1);
        assert_int_equal(input.node_count, plain.node_count);
        check_chains(&input);
        for (uint32_t i = 0; i < input.instance_count; i++)
            for (uint32_t vertex = 0; vertex < 5; vertex++)
            {
                double before[3], expected[3], p[3];
                world_point(&plain, i, vertex, before);
                apply(convert(&how), before, 1.0, expected);
                world_point(&input, i, vertex, p);
                ls_compose_check_close(p, expected, 3, 1e-6);
            }
        // The camera's lens and its own axes stay; where they point turns.
        Matrix expected = times(convert(&how), from_rows(plain.cameras[0].world_from_camera));
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                expected.rows[i][j] /= how.scale > 0.0 ? how.scale : 1.0;
        check_matrices(from_rows(input.cameras[0].world_from_camera), expected, 1e-6);
        assert_true(input.cameras[0].tan_half_y == plain.cameras[0].tan_half_y);
        ls_input_destroy(&input);
    }
    ls_input_destroy(&plain);
}

static void test_flip(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    LsInput input = ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.ply")}, 1);
    const LsInputPart part = {0};
    LsInputMesh* mesh = &input.meshes[0];
    // Normals and texture coordinates by indices of their own, as OBJ has them.
    assert_true(ls_input_stream_create(mesh, LS_STREAM_NORMAL, 2, true));
    assert_true(ls_input_stream_create(mesh, LS_STREAM_TEXCOORD_0, 3, true));
    const float normals[] = {0.0f, 1.0f, -0.5f, 0.25f, 0.0f, 1.0f};
    memcpy(mesh->streams[LS_STREAM_NORMAL].values, normals, sizeof normals);
    memcpy(mesh->streams[LS_STREAM_NORMAL].indices, (const uint32_t[]){0, 1, LS_NONE, 1, 0, 0},
           6 * sizeof(uint32_t));
    memcpy(mesh->streams[LS_STREAM_TEXCOORD_0].indices, (const uint32_t[]){0, 1, 2, 2, 1, 0},
           6 * sizeof(uint32_t));
    LsError error;
    assert_int_equal(
        ls_input_place(&input, &part, &(LsBakeInput){.path = "a", .flip = true}, &error), LS_OK);
    assert_memory_equal(mesh->indices, ((const uint32_t[]){0, 2, 1, 0, 1, 3}),
                        6 * sizeof(uint32_t));
    assert_memory_equal(mesh->streams[LS_STREAM_NORMAL].indices,
                        ((const uint32_t[]){0, LS_NONE, 1, 1, 0, 0}), 6 * sizeof(uint32_t));
    assert_memory_equal(mesh->streams[LS_STREAM_TEXCOORD_0].indices,
                        ((const uint32_t[]){0, 2, 1, 2, 0, 1}), 6 * sizeof(uint32_t));
    const float flipped[] = {0.0f, -1.0f, 0.5f, -0.25f, 0.0f, -1.0f};
    assert_memory_equal(mesh->streams[LS_STREAM_NORMAL].values, flipped, sizeof flipped);
    for (int i = 0; i < 15; i++)
        assert_true(mesh->positions[i] == ls_compose_corners[i / 3][i % 3]);

    // And turned with the axes.
    assert_int_equal(
        ls_input_place(&input, &part, &(LsBakeInput){.path = "a", .up = LS_UP_Z}, &error), LS_OK);
    const float turned[] = {0.0f, 0.5f, 1.0f, -0.25f, -1.0f, 0.0f};
    assert_memory_equal(mesh->streams[LS_STREAM_NORMAL].values, turned, sizeof turned);
    ls_input_destroy(&input);
}

// ---- Lamps and animation ------------------------------------------------------------------------

static const LsLamp lamps[3] = {
    {.position = {1, 2, 3},
     .kind = LS_LAMP_POINT,
     .direction = {0, 0, -1},
     .range = 8,
     .intensity = {5, 6, 7},
     .node = 1,
     .cos_inner = 1,
     .cos_outer = -1},
    {.position = {-1, 0.5f, 0},
     .kind = LS_LAMP_SPOT,
     .direction = {0.6f, 0, 0.8f},
     .range = 0,
     .intensity = {1, 1, 1},
     .node = LS_NONE,
     .cos_inner = 0.9f,
     .cos_outer = 0.5f},
    {.kind = LS_LAMP_DIRECTIONAL,
     .direction = {0, -1, 0},
     .intensity = {2, 2, 2},
     .node = 0,
     .cos_inner = 1,
     .cos_outer = -1},
};

static void add_lamps(LsInput* input)
{
    for (int i = 0; i < 3; i++)
    {
        LsLamp* added = ls_input_add_lamp(input);
        assert_non_null(added);
        *added = lamps[i];
    }
}

static void check_vec3(LsVec3 v, double x, double y, double z, double tolerance)
{
    ls_compose_check_close((const double[]){v.x, v.y, v.z}, (const double[]){x, y, z}, 3,
                           tolerance);
}

static void test_lamps(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    const char* path = ls_compose_path("a.gltf");
    LsInput input = ls_compose_inputs(&(LsBakeInput){.path = path}, 1);
    add_lamps(&input);
    const LsInputPart part = {0};
    LsError error;
    assert_int_equal(ls_input_place(&input, &part,
                                    &(LsBakeInput){.path = path, .up = LS_UP_Z, .scale = 2},
                                    &error),
                     LS_OK);
    check_vec3(input.lamps[0].position, 2, 6, -4, 0);
    check_vec3(input.lamps[0].direction, 0, 0, -1, 0); // as the format wants it of points
    assert_true(input.lamps[0].range == 16.0f && input.lamps[1].range == 0.0f);
    check_vec3(input.lamps[0].intensity, 5, 6, 7, 0);
    check_vec3(input.lamps[1].position, -2, 0, -1, 0);
    check_vec3(input.lamps[1].direction, 0.6, 0.8, 0, 1e-7);
    check_vec3(input.lamps[2].position, 0, 0, 0, 0); // as the format wants it of these
    check_vec3(input.lamps[2].direction, 0, 0, 1, 0);
    assert_int_equal(input.lamps[0].node, 1);

    // A quarter turn takes x to -z.
    double lower[3], upper[3];
    find_box(&input, 0, lower, upper);
    const LsBakeInput how = {.path = path, .turn = 90, .is_at = true, .at = {0, 5, 0}};
    assert_int_equal(ls_input_place(&input, &part, &how, &error), LS_OK);
    const double middle[3] = {0.5 * (lower[0] + upper[0]), lower[1], 0.5 * (lower[2] + upper[2])};
    check_vec3(input.lamps[0].position, -4 - middle[2], 6 - middle[1] + 5, -(2 - middle[0]), 1e-6);
    check_vec3(input.lamps[1].direction, 0, 0.8, -0.6, 1e-6);
    check_vec3(input.lamps[2].direction, 1, 0, 0, 1e-6);
    check_vec3(input.lamps[2].position, 0, 0, 0, 0);
    assert_int_equal(input.lamps[0].node, 2); // one more: the node above came before
    assert_int_equal(input.lamps[1].node, 0); // it had none
    assert_int_equal(input.lamps[2].node, 1);
    check_chains(&input);
    ls_input_destroy(&input);
}

// T * R * S of three channels' first values.
static Matrix from_keys(const LsInput* input, const LsChannel* channels)
{
    const float* t = input->keys + channels[0].first_value;
    const float* q = input->keys + channels[1].first_value;
    const float* s = input->keys + channels[2].first_value;
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    Matrix matrix = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t[0]},
                      {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t[1]},
                      {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t[2]}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix.rows[i][j] *= s[j];
    return matrix;
}

static void add_channel(LsInput* input, uint32_t path, uint32_t first_value)
{
    LsChannel* channel = ls_input_add_channel(input);
    assert_non_null(channel);
    *channel = (LsChannel){.node = 1,
                           .path = path,
                           .interpolation = LS_INTERPOLATION_LINEAR,
                           .key_count = 1,
                           .first_time = 0,
                           .first_value = first_value};
}

static void test_animation(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    const char* path = ls_compose_path("a.gltf");
    LsInput plain = ls_compose_inputs(&(LsBakeInput){.path = path}, 1);
    // A time; translation; rotation; scale. Then channels that share: a second of the same
    // translation, and a scale by the same numbers as the translation.
    const float keys[] = {0.0f,        1.0f,        2.0f,  3.0f, 0.18257419f, 0.36514837f,
                          0.54772256f, 0.73029674f, 0.25f, 4.0f, 1.5f};
    float* added = ls_input_add_keys(&plain, 11);
    assert_non_null(added);
    memcpy(added, keys, sizeof keys);
    static const uint32_t values[] = {1, 4, 8};
    for (uint32_t kind = 0; kind < 3; kind++)
        add_channel(&plain, kind, values[kind]);
    add_channel(&plain, LS_PATH_TRANSLATION, 1);
    add_channel(&plain, LS_PATH_ROTATION, 4);
    add_channel(&plain, LS_PATH_SCALE, 1);
    const Matrix before = from_keys(&plain, plain.channels);
    const Matrix shared_before = from_keys(&plain, plain.channels + 3);

    const LsInputPart part = {0};
    const LsBakeInput how = {.path = path, .up = LS_UP_X, .scale = 3.0};
    LsError error;
    assert_int_equal(ls_input_place(&plain, &part, &how, &error), LS_OK);
    const Matrix forward = convert(&how), back = invert_conversion(&how);
    check_matrices(from_keys(&plain, plain.channels), times(times(forward, before), back), 1e-6);
    check_matrices(from_keys(&plain, plain.channels + 3),
                   times(times(forward, shared_before), back), 1e-6);
    assert_int_equal(plain.channels[3].first_value, plain.channels[0].first_value);
    assert_int_not_equal(plain.channels[5].first_value, plain.channels[0].first_value);
    assert_true(plain.keys[0] == 0.0f);

    // The node above moves the numbers of nodes.
    assert_int_equal(ls_input_place(&plain, &part, &(LsBakeInput){.path = path, .size = 1}, &error),
                     LS_OK);
    assert_int_equal(plain.channels[0].node, 2);
    ls_input_destroy(&plain);
}

// A cubic spline's tangents are vectors: all three values of a key are converted alike.
static void test_animation_cubic(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    const char* path = ls_compose_path("a.ply");
    LsInput input = ls_compose_inputs(&(LsBakeInput){.path = path}, 1);
    float* keys = ls_input_add_keys(&input, 20);
    assert_non_null(keys);
    for (int i = 0; i < 20; i++)
        keys[i] = (float)i;
    add_channel(&input, LS_PATH_TRANSLATION, 2);
    input.channels[0].interpolation = LS_INTERPOLATION_CUBIC;
    input.channels[0].key_count = 2;
    const LsInputPart part = {0};
    LsError error;
    assert_int_equal(ls_input_place(&input, &part,
                                    &(LsBakeInput){.path = path, .up = LS_UP_Z, .scale = 2},
                                    &error),
                     LS_OK);
    for (int i = 0; i < 6; i++)
    {
        const float x = (float)(3 * i + 2);
        const float expected[3] = {2 * x, 2 * (x + 2), -2 * (x + 1)};
        assert_memory_equal(input.keys + 2 + 3 * i, expected, sizeof expected);
    }
    ls_input_destroy(&input);
}

// ---- Placement ----------------------------------------------------------------------------------

static void test_size_and_at(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", LS_COMPOSE_TREE, LS_COMPOSE_MATERIALS);
    ls_compose_write_ply("b.ply");
    const LsBakeInput inputs[] = {
        {.path = ls_compose_path("b.ply")},
        {.path = ls_compose_path("a.gltf"), .size = 1.5, .is_at = true, .at = {10, -1, 4}},
        {.path = ls_compose_path("b.ply"), .is_at = true}};
    LsInput input = ls_compose_inputs(inputs, 3);
    assert_int_equal(input.instance_count, 4);
    // The first and its place are as they were.
    const double identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    assert_memory_equal(input.instances[0].world_from_object, identity, sizeof identity);
    assert_int_equal(input.instances[0].node, LS_NONE);
    // The second's nodes hang below one, and so does the third's instance, which had none.
    assert_int_equal(input.node_count, 7);
    assert_int_equal(input.nodes[0].parent, LS_NONE);
    assert_int_equal(input.nodes[1].parent, 0);
    assert_int_equal(input.nodes[2].parent, 1);
    assert_int_equal(input.instances[1].node, 2);
    assert_int_equal(input.instances[3].node, 6);
    check_chains(&input);
    LsInput second = input;
    second.instance_count = 3;
    double lower[3], upper[3];
    find_box(&second, 1, lower, upper);
    double longest = 0.0;
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, upper[i] - lower[i]);
    ls_compose_check_close(&longest, (const double[]){1.5}, 1, 1e-12);
    ls_compose_check_close(
        (const double[]){0.5 * (lower[0] + upper[0]), lower[1], 0.5 * (lower[2] + upper[2])},
        (const double[]){10, -1, 4}, 3, 1e-12);
    find_box(&input, 3, lower, upper);
    ls_compose_check_close(
        (const double[]){0.5 * (lower[0] + upper[0]), lower[1], 0.5 * (lower[2] + upper[2])},
        (const double[]){0, 0, 0}, 3, 1e-12);
    // The camera moved with its file: it sees the same of it.
    LsInput plain = ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.gltf")}, 1);
    double p[3], seen[3], seen_before[3];
    for (uint32_t vertex = 0; vertex < 4; vertex++)
    {
        for (int k = 0; k < 2; k++)
        {
            const LsInput* scene = k ? &input : &plain;
            world_point(scene, k ? 2 : 1, vertex, p);
            const Matrix camera = from_rows(scene->cameras[0].world_from_camera);
            for (int axis = 0; axis < 3; axis++)
            {
                (k ? seen : seen_before)[axis] = 0.0;
                for (int i = 0; i < 3; i++)
                    (k ? seen : seen_before)[axis] +=
                        camera.rows[i][axis] * (p[i] - camera.rows[i][3]);
            }
        }
        for (int axis = 0; axis < 2; axis++)
            assert_true(fabs(seen[axis] / seen[2] - seen_before[axis] / seen_before[2]) < 1e-5);
    }
    ls_input_destroy(&plain);
    ls_input_destroy(&input);
}

// Without `at` the middle of the bottom stays.
static void test_turn_stays_in_place(void** state)
{
    (void)state;
    ls_compose_write_ply("a.ply");
    double lower[3], upper[3];
    LsInput plain = ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.ply")}, 1);
    find_box(&plain, 0, lower, upper);
    const double middle[2] = {0.5 * (lower[0] + upper[0]), 0.5 * (lower[2] + upper[2])};
    static const double turns[] = {90, -90, 180, 270, 30, -200.5, 360};
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++)
    {
        LsInput input = ls_compose_inputs(
            &(LsBakeInput){.path = ls_compose_path("a.ply"), .turn = turns[i]}, 1);
        const double angle = turns[i] * 3.14159265358979323846 / 180.0;
        for (uint32_t vertex = 0; vertex < 4; vertex++)
        {
            const double x = ls_compose_corners[vertex][0] - middle[0],
                         z = ls_compose_corners[vertex][2] - middle[1];
            double p[3];
            world_point(&input, 0, vertex, p);
            // Seen from above x is to the right and z downwards: counter-clockwise is x to -z.
            ls_compose_check_close(p,
                                   (const double[]){cos(angle) * x + sin(angle) * z + middle[0],
                                                    ls_compose_corners[vertex][1],
                                                    cos(angle) * z - sin(angle) * x + middle[1]},
                                   3, 1e-14);
        }
        if (turns[i] == 90) // in every bit
            assert_true(input.instances[0].world_from_object[0][0] == 0.0 &&
                        input.instances[0].world_from_object[0][2] == 1.0 &&
                        input.instances[0].world_from_object[2][0] == -1.0);
        ls_input_destroy(&input);
    }
    ls_input_destroy(&plain);
}

// Instances that lie within the box of others are not looked at one by one; the box is the same.
static void test_box_of_many_instances(void** state)
{
    (void)state;
    char nodes[4000] = "", roots[400] = "";
    for (int i = 0; i < 40; i++)
    {
        const size_t length = strlen(nodes), root_length = strlen(roots);
        snprintf(nodes + length, sizeof nodes - length,
                 "%s{\"mesh\":0,\"translation\":[%d,%d,%d],\"rotation\":[0,0.6,0,0.8]}",
                 i ? "," : "", i * 7 % 11, i * 5 % 7, i * 3 % 5);
        snprintf(roots + root_length, sizeof roots - root_length, "%s%d", i ? "," : "", i);
    }
    ls_compose_write_gltf("b.gltf", roots, nodes, "");
    LsInput plain = ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("b.gltf")}, 1);
    double lower[3], upper[3];
    find_box(&plain, 0, lower, upper);
    LsInput input =
        ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("b.gltf"), .size = 2.0}, 1);
    double placed_lower[3], placed_upper[3];
    find_box(&input, 0, placed_lower, placed_upper);
    double longest = 0.0, placed_longest = 0.0;
    for (int i = 0; i < 3; i++)
    {
        longest = fmax(longest, upper[i] - lower[i]);
        placed_longest = fmax(placed_longest, placed_upper[i] - placed_lower[i]);
    }
    ls_compose_check_close(&placed_longest, (const double[]){2.0}, 1, 1e-12);
    ls_compose_check_close(placed_lower + 1, lower + 1, 1, 1e-12);
    assert_true(longest > 10.0);
    ls_input_destroy(&plain);
    ls_input_destroy(&input);
}

static void test_placement_refused(void** state)
{
    (void)state;
    ls_compose_write_gltf("a.gltf", "0", "{\"camera\":0}", "");
    const char* path = ls_compose_path("a.gltf");
    ls_compose_check_refused(&(LsBakeInput){.path = path, .size = 1}, LS_MESSAGE_PLACE_NO_BOX,
                             "a.gltf");
    ls_compose_check_refused(&(LsBakeInput){.path = path, .turn = 1}, LS_MESSAGE_PLACE_NO_BOX,
                             "a.gltf");
    ls_compose_check_refused(&(LsBakeInput){.path = path, .is_at = true}, LS_MESSAGE_PLACE_NO_BOX,
                             "a.gltf");
    ls_compose_write_text("b.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                   "property float y\nproperty float z\nelement face 1\n"
                                   "property list uchar int vertex_indices\nend_header\n"
                                   "1 2 3\n1 2 3\n1 2 3\n3 0 1 2\n");
    ls_compose_check_refused(&(LsBakeInput){.path = ls_compose_path("b.ply"), .size = 1},
                             LS_MESSAGE_PLACE_NO_BOX, "point");
    ls_compose_write_triangle("a.ply", "1e10");
    ls_compose_check_refused(&(LsBakeInput){.path = ls_compose_path("a.ply"), .scale = 1e30},
                             LS_MESSAGE_PLACE_RANGE, "scale");
    ls_compose_write_triangle("a.ply", "1e-20");
    ls_compose_check_refused(&(LsBakeInput){.path = ls_compose_path("a.ply"), .size = 1e30},
                             LS_MESSAGE_PLACE_RANGE, "--size");
}

// Levels of nodes, all but the last with one child.
static void write_chain(const char* name, int levels)
{
    char nodes[8000] = "";
    for (int i = 0; i < levels; i++)
    {
        const size_t length = strlen(nodes);
        if (i + 1 < levels)
            snprintf(nodes + length, sizeof nodes - length, "{\"children\":[%d]},", i + 1);
        else
            snprintf(nodes + length, sizeof nodes - length, "{\"mesh\":0}");
    }
    ls_compose_write_gltf(name, "0", nodes, "");
}

static void test_depth(void** state)
{
    (void)state;
    write_chain("a.gltf", LS_MAX_NODE_DEPTH);
    write_chain("b.gltf", LS_MAX_NODE_DEPTH - 1);
    ls_compose_check_refused(&(LsBakeInput){.path = ls_compose_path("a.gltf"), .size = 1},
                             LS_MESSAGE_PLACE_DEPTH, "64");
    LsInput deep =
        ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("a.gltf"), .scale = 2}, 1);
    LsInput input =
        ls_compose_inputs(&(LsBakeInput){.path = ls_compose_path("b.gltf"), .size = 1}, 1);
    assert_int_equal(input.node_count, LS_MAX_NODE_DEPTH);
    check_chains(&input);
    ls_input_destroy(&deep);
    ls_input_destroy(&input);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing_asked),
        cmocka_unit_test(test_up_is_exact),
        cmocka_unit_test(test_conversion_of_a_tree),
        cmocka_unit_test(test_flip),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_animation),
        cmocka_unit_test(test_animation_cubic),
        cmocka_unit_test(test_size_and_at),
        cmocka_unit_test(test_turn_stays_in_place),
        cmocka_unit_test(test_box_of_many_instances),
        cmocka_unit_test(test_placement_refused),
        cmocka_unit_test(test_depth),
    };
    return cmocka_run_group_tests(tests, ls_compose_make_folder, ls_compose_remove_folder);
}
