// test_compose.c - several files in one bake: conversion, placement, materials, limits.

#include "compose.h"
#include "ls_messages.h"
#include "material_file.h"
#include "memory_limit.h"
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
#include <sys/stat.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Files in a folder of this run --------------------------------------------------------------

static char folder[] = "/tmp/ls-test-compose-XXXXXX";

static const char* const file_names[] = {"a.gltf", "b.gltf",     "a.ply",      "b.ply",
                                         "a.json", "empty.json", "out.lspace", "large.json"};

static const char* find_path(const char* name)
{
    static char paths[4][256];
    static unsigned next;
    char* path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static int make_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void** state)
{
    (void)state;
    for (size_t i = 0; i < sizeof file_names / sizeof *file_names; i++)
        unlink(find_path(file_names[i]));
    return rmdir(folder);
}

static void write_bytes(const char* name, const void* bytes, size_t size)
{
    FILE* file = fopen(find_path(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void write_text(const char* name, const char* text)
{
    write_bytes(name, text, strlen(text));
}

// Four vertices and two triangles; the fifth vertex is used by none.
static const float corners[5][3] = {
    {0.0f, 0.0f, 0.0f}, {2.0f, 0.0f, -0.5f}, {0.0f, 1.0f, 0.25f}, {0.125f, 0.5f, 3.0f}, {9, 9, 9}};

static void write_ply(const char* name)
{
    char text[1000];
    int length = snprintf(text, sizeof text,
                          "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
                          "property float y\nproperty float z\nelement face 2\n"
                          "property list uchar int vertex_indices\nend_header\n");
    for (int i = 0; i < 5; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, "%.9g %.9g %.9g\n",
                           corners[i][0], corners[i][1], corners[i][2]);
    snprintf(text + length, sizeof text - (size_t)length, "3 0 1 2\n3 0 3 1\n");
    write_text(name, text);
}

// (0,0,0), (x,0,0), (0,x,0).
static void write_triangle(const char* name, const char* x)
{
    char text[500];
    snprintf(text, sizeof text,
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 0\n%s 0 0\n0 %s 0\n3 0 1 2\n",
             x, x);
    write_text(name, text);
}

// The bytes of `corners` and of the indices 0 1 2 0 3 1.
#define GLTF_BUFFER                                                \
    "AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAC/AAAAAAAAgD8AAIA+AAAAPgAAAD8A" \
    "AEBAAAAQQQAAEEEAABBBAAABAAIAAAADAAEA"

// `nodes` and `materials` are JSON lists' content; the mesh's triangles have the materials 0 and 1,
// if there are any.
static void write_gltf(const char* name, const char* roots, const char* nodes,
                       const char* materials)
{
    char text[8000];
    const bool has_materials = materials[0] != '\0';
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[%s]}],\"nodes\":[%s],"
             "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7,\"znear\":1}}],"
             "\"materials\":[%s],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1%s},"
             "{\"attributes\":{\"POSITION\":0},\"indices\":2%s}]}],"
             "\"buffers\":[{\"byteLength\":72,\"uri\":\"data:application/octet-stream;base64," //
             GLTF_BUFFER "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":72}],"
             "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":"
             "\"VEC3\",\"min\":[0,0,-0.5],\"max\":[9,9,9]},"
             "{\"bufferView\":0,\"byteOffset\":60,\"componentType\":5123,\"count\":3,\"type\":"
             "\"SCALAR\"},"
             "{\"bufferView\":0,\"byteOffset\":66,\"componentType\":5123,\"count\":3,\"type\":"
             "\"SCALAR\"}]}",
             roots, nodes, materials, has_materials ? ",\"material\":0" : "",
             has_materials ? ",\"material\":1" : "");
    if (!has_materials)
    {
        // An empty list is no legal glTF.
        char* list = strstr(text, "\"materials\":[],");
        assert_non_null(list);
        memset(list, ' ', strlen("\"materials\":[],"));
    }
    write_text(name, text);
}

// A hierarchy with a rotation, scales of three kinds, two instances of the mesh and a camera.
#define TREE                                                                                 \
    "{\"children\":[1,2],\"translation\":[0.5,-2,0.75],\"rotation\":[0.18257419,0.36514837," \
    "0.54772256,0.73029674]},"                                                               \
    "{\"mesh\":0,\"scale\":[1,2,0.5],\"translation\":[1,0,0]},"                              \
    "{\"children\":[3,4],\"rotation\":[0,0.6,0,0.8]},"                                       \
    "{\"mesh\":0,\"translation\":[3,1,-1]},"                                                 \
    "{\"camera\":0,\"translation\":[0,0,4],\"scale\":[2,2,2]}"

static const char TWO_MATERIALS[] =
    "{\"name\":\"red\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0,0,1],"
    "\"metallicFactor\":0,\"roughnessFactor\":0.75}},"
    "{\"name\":\"lamp\",\"emissiveFactor\":[1,1,1],\"doubleSided\":true}";

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

static void check_close(const double* a, const double* b, int count, double tolerance)
{
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance * fmax(1.0, fabs(b[i]))))
            fail_msg("number %d is %.17g instead of %.17g", i, a[i], b[i]);
}

static void check_matrices(Matrix a, Matrix b, double tolerance)
{
    check_close(a.rows[0], b.rows[0], 12, tolerance);
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

// ---- Composing ----------------------------------------------------------------------------------

static LsInput compose(const LsBakeInput* inputs, uint32_t count)
{
    const LsBakeDesc desc = {.inputs = inputs, .input_count = count};
    LsInput input = {0};
    LsError error = {0};
    if (ls_compose_check(&desc, &error) != LS_OK ||
        ls_compose(&input, &desc, NULL, NULL, &error) != LS_OK)
        fail_msg("%s", error.text);
    return input;
}

// Refused with this message, and the text has `word`.
static void check_refused_desc(const LsBakeDesc* desc, LsMessage expected, const char* word)
{
    LsInput input = {0};
    LsError error = {0};
    LsResult result = ls_compose_check(desc, &error);
    if (result == LS_OK)
        result = ls_compose(&input, desc, NULL, NULL, &error);
    ls_input_destroy(&input);
    assert_int_equal(error.message, expected);
    assert_int_equal(result, expected / 100);
    if (!strstr(error.text, word) || strchr(error.text, '\n'))
        fail_msg("no \"%s\", or more than a line: %s", word, error.text);
}

static void check_refused(const LsBakeInput* how, LsMessage expected, const char* word)
{
    const LsBakeDesc desc = {.inputs = how, .input_count = 1};
    check_refused_desc(&desc, expected, word);
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
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    LsInput plain = {0};
    LsError error;
    assert_int_equal(ls_import(&plain, find_path("a.gltf"), &error), LS_OK);
    LsInput composed = compose(&(LsBakeInput){.path = find_path("a.gltf"), .scale = 1.0}, 1);
    assert_int_equal(composed.instance_count, 2);
    assert_int_equal(composed.camera_count, 1);
    check_same_bytes(&plain, &composed);
    ls_input_destroy(&plain);
    ls_input_destroy(&composed);
}

static void test_up_is_exact(void** state)
{
    (void)state;
    write_ply("a.ply");
    LsInput z = compose(&(LsBakeInput){.path = find_path("a.ply"), .up = LS_UP_Z}, 1);
    LsInput x = compose(&(LsBakeInput){.path = find_path("a.ply"), .up = LS_UP_X}, 1);
    for (int i = 0; i < 5; i++)
    {
        const float* p = corners[i];
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
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    LsInput plain = compose(&(LsBakeInput){.path = find_path("a.gltf")}, 1);
    static const LsBakeInput ways[] = {{.up = LS_UP_Z},
                                       {.up = LS_UP_X, .scale = 2.5},
                                       {.up = LS_UP_Y, .scale = 0.01},
                                       {.up = LS_UP_Z, .scale = 1000.0}};
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++)
    {
        LsBakeInput how = ways[way];
        how.path = find_path("a.gltf");
        LsInput input = compose(&how, 1);
        assert_int_equal(input.node_count, plain.node_count);
        check_chains(&input);
        for (uint32_t i = 0; i < input.instance_count; i++)
            for (uint32_t vertex = 0; vertex < 5; vertex++)
            {
                double before[3], expected[3], p[3];
                world_point(&plain, i, vertex, before);
                apply(convert(&how), before, 1.0, expected);
                world_point(&input, i, vertex, p);
                check_close(p, expected, 3, 1e-6);
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
    write_ply("a.ply");
    LsInput input = compose(&(LsBakeInput){.path = find_path("a.ply")}, 1);
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
        assert_true(mesh->positions[i] == corners[i / 3][i % 3]);

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
    check_close((const double[]){v.x, v.y, v.z}, (const double[]){x, y, z}, 3, tolerance);
}

static void test_lamps(void** state)
{
    (void)state;
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    const char* path = find_path("a.gltf");
    LsInput input = compose(&(LsBakeInput){.path = path}, 1);
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
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    const char* path = find_path("a.gltf");
    LsInput plain = compose(&(LsBakeInput){.path = path}, 1);
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
    write_ply("a.ply");
    const char* path = find_path("a.ply");
    LsInput input = compose(&(LsBakeInput){.path = path}, 1);
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
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    write_ply("b.ply");
    const LsBakeInput inputs[] = {
        {.path = find_path("b.ply")},
        {.path = find_path("a.gltf"), .size = 1.5, .is_at = true, .at = {10, -1, 4}},
        {.path = find_path("b.ply"), .is_at = true}};
    LsInput input = compose(inputs, 3);
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
    check_close(&longest, (const double[]){1.5}, 1, 1e-12);
    check_close(
        (const double[]){0.5 * (lower[0] + upper[0]), lower[1], 0.5 * (lower[2] + upper[2])},
        (const double[]){10, -1, 4}, 3, 1e-12);
    find_box(&input, 3, lower, upper);
    check_close(
        (const double[]){0.5 * (lower[0] + upper[0]), lower[1], 0.5 * (lower[2] + upper[2])},
        (const double[]){0, 0, 0}, 3, 1e-12);
    // The camera moved with its file: it sees the same of it.
    LsInput plain = compose(&(LsBakeInput){.path = find_path("a.gltf")}, 1);
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
    write_ply("a.ply");
    double lower[3], upper[3];
    LsInput plain = compose(&(LsBakeInput){.path = find_path("a.ply")}, 1);
    find_box(&plain, 0, lower, upper);
    const double middle[2] = {0.5 * (lower[0] + upper[0]), 0.5 * (lower[2] + upper[2])};
    static const double turns[] = {90, -90, 180, 270, 30, -200.5, 360};
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++)
    {
        LsInput input = compose(&(LsBakeInput){.path = find_path("a.ply"), .turn = turns[i]}, 1);
        const double angle = turns[i] * 3.14159265358979323846 / 180.0;
        for (uint32_t vertex = 0; vertex < 4; vertex++)
        {
            const double x = corners[vertex][0] - middle[0], z = corners[vertex][2] - middle[1];
            double p[3];
            world_point(&input, 0, vertex, p);
            // Seen from above x is to the right and z downwards: counter-clockwise is x to -z.
            check_close(p,
                        (const double[]){cos(angle) * x + sin(angle) * z + middle[0],
                                         corners[vertex][1],
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
    write_gltf("b.gltf", roots, nodes, "");
    LsInput plain = compose(&(LsBakeInput){.path = find_path("b.gltf")}, 1);
    double lower[3], upper[3];
    find_box(&plain, 0, lower, upper);
    LsInput input = compose(&(LsBakeInput){.path = find_path("b.gltf"), .size = 2.0}, 1);
    double placed_lower[3], placed_upper[3];
    find_box(&input, 0, placed_lower, placed_upper);
    double longest = 0.0, placed_longest = 0.0;
    for (int i = 0; i < 3; i++)
    {
        longest = fmax(longest, upper[i] - lower[i]);
        placed_longest = fmax(placed_longest, placed_upper[i] - placed_lower[i]);
    }
    check_close(&placed_longest, (const double[]){2.0}, 1, 1e-12);
    check_close(placed_lower + 1, lower + 1, 1, 1e-12);
    assert_true(longest > 10.0);
    ls_input_destroy(&plain);
    ls_input_destroy(&input);
}

static void test_placement_refused(void** state)
{
    (void)state;
    write_gltf("a.gltf", "0", "{\"camera\":0}", "");
    const char* path = find_path("a.gltf");
    check_refused(&(LsBakeInput){.path = path, .size = 1}, LS_MESSAGE_PLACE_NO_BOX, "a.gltf");
    check_refused(&(LsBakeInput){.path = path, .turn = 1}, LS_MESSAGE_PLACE_NO_BOX, "a.gltf");
    check_refused(&(LsBakeInput){.path = path, .is_at = true}, LS_MESSAGE_PLACE_NO_BOX, "a.gltf");
    write_text("b.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                        "property float y\nproperty float z\nelement face 1\n"
                        "property list uchar int vertex_indices\nend_header\n"
                        "1 2 3\n1 2 3\n1 2 3\n3 0 1 2\n");
    check_refused(&(LsBakeInput){.path = find_path("b.ply"), .size = 1}, LS_MESSAGE_PLACE_NO_BOX,
                  "point");
    write_triangle("a.ply", "1e10");
    check_refused(&(LsBakeInput){.path = find_path("a.ply"), .scale = 1e30}, LS_MESSAGE_PLACE_RANGE,
                  "scale");
    write_triangle("a.ply", "1e-20");
    check_refused(&(LsBakeInput){.path = find_path("a.ply"), .size = 1e30}, LS_MESSAGE_PLACE_RANGE,
                  "--size");
}

// What only a caller of the library can ask for; lsbake's own table refuses it before.
static void test_wrong_desc(void** state)
{
    (void)state;
    static const struct
    {
        LsBakeInput how;
        LsMessage message;
    } cases[] = {
        {{.path = NULL}, LS_MESSAGE_USAGE_NO_SCENE},
        {{.path = "a.ply", .up = (LsUpAxis)3}, LS_MESSAGE_USAGE_CHOICE},
        {{.path = "a.ply", .scale = -1}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .scale = NAN}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .size = INFINITY}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .turn = NAN}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .is_at = true, .at = {0, NAN, 0}}, LS_MESSAGE_USAGE_NUMBER},
        {{.path = "a.ply", .scene = 1}, LS_MESSAGE_USAGE_NOT_GLTF},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_refused(&cases[i].how, cases[i].message, "");
    const LsBakeInput good = {.path = "a.ply"};
    const struct
    {
        LsBakeDesc desc;
        LsMessage message;
    } bakes[] = {
        {{.inputs = &good, .input_count = 0, .output = "x"}, LS_MESSAGE_USAGE_NO_SCENE},
        {{.inputs = &good, .input_count = 1}, LS_MESSAGE_USAGE_NO_OUTPUT},
        {{.inputs = &good, .input_count = 1, .output = "x", .grid = 5000}, LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .patches = 17},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .smooth_angle = NAN},
         LS_MESSAGE_USAGE_NUMBER},
        {{.inputs = &good, .input_count = 1, .output = "x", .normals = (LsNormalSource)9},
         LS_MESSAGE_USAGE_CHOICE},
    };
    for (size_t i = 0; i < sizeof bakes / sizeof *bakes; i++)
    {
        LsError error = {0};
        assert_int_equal(ls_bake_run(&bakes[i].desc, NULL, &error), LS_ERROR_ARGUMENT);
        assert_int_equal(error.message, bakes[i].message);
    }
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
    write_gltf(name, "0", nodes, "");
}

static void test_depth(void** state)
{
    (void)state;
    write_chain("a.gltf", LS_MAX_NODE_DEPTH);
    write_chain("b.gltf", LS_MAX_NODE_DEPTH - 1);
    check_refused(&(LsBakeInput){.path = find_path("a.gltf"), .size = 1}, LS_MESSAGE_PLACE_DEPTH,
                  "64");
    LsInput deep = compose(&(LsBakeInput){.path = find_path("a.gltf"), .scale = 2}, 1);
    LsInput input = compose(&(LsBakeInput){.path = find_path("b.gltf"), .size = 1}, 1);
    assert_int_equal(input.node_count, LS_MAX_NODE_DEPTH);
    check_chains(&input);
    ls_input_destroy(&deep);
    ls_input_destroy(&input);
}

// ---- Materials ----------------------------------------------------------------------------------

static LsInput override(const char* name, const char* materials)
{
    return compose(&(LsBakeInput){.path = find_path(name), .materials = materials}, 1);
}

static void test_every_field(void** state)
{
    (void)state;
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
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
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
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
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
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
    write_text("a.json", "{\"materials\":{\"red\":{\"metallicFactor\":0.25},"
                         "\"*\":{\"metallicFactor\":0.75,\"roughnessFactor\":0.125}}}\n");
    LsError error;
    const LsBakeInput how = {.path = "a.gltf", .materials = find_path("a.json")};
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
    write_ply("a.ply");
    const char* path = find_path("a.ply");
    const char* red = "{\"baseColorFactor\":[1,0,0]}";
    for (uint32_t which = 0; which < 3; which++)
    {
        LsBakeInput inputs[3] = {{.path = path}, {.path = path}, {.path = path}};
        inputs[which].materials = red;
        LsInput input = compose(inputs, 3);
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
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    const LsBakeInput inputs[2] = {{.path = path}, {.path = find_path("a.gltf"), .materials = red}};
    LsInput input = compose(inputs, 2);
    assert_int_equal(input.material_count, 3);
    assert_true(input.materials[0].core.base_color.y == 0.8f);
    assert_true(input.materials[2].core.base_color.y == 0.0f);
    ls_input_destroy(&input);
}

static void test_materials_refused(void** state)
{
    (void)state;
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    char path[256];
    snprintf(path, sizeof path, "%s", find_path("a.gltf"));
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
        check_refused(&(LsBakeInput){.path = path, .materials = cases[i].json}, cases[i].message,
                      cases[i].word);

    // From files.
    write_text("a.json", "[1, 2]\n");
    write_text("empty.json", "");
    static char large[LS_MATERIAL_FILE_BYTES + 1];
    memset(large, ' ', sizeof large);
    large[0] = '{';
    large[sizeof large - 1] = '}';
    write_bytes("large.json", large, sizeof large);
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
        check_refused(&(LsBakeInput){.path = path, .materials = find_path(files[i].file)},
                      files[i].message, files[i].file);
    check_refused(&(LsBakeInput){.path = path, .materials = "/dev/null"},
                  LS_MESSAGE_FILE_NOT_REGULAR, "/dev/null");
    write_bytes("a.json", "{}\0{}", 5);
    check_refused(&(LsBakeInput){.path = path, .materials = find_path("a.json")},
                  LS_MESSAGE_MATERIAL_JSON, "zero");
    // As deep as JSON goes: refused, not followed.
    memset(large, '[', sizeof large - 1);
    memcpy(large, "{\"ior\":", 7);
    large[sizeof large - 1] = '\0';
    check_refused(&(LsBakeInput){.path = path, .materials = large}, LS_MESSAGE_MATERIAL_JSON,
                  "--material");
    // The largest file that is taken.
    memset(large, ' ', sizeof large);
    large[0] = '{';
    large[LS_MATERIAL_FILE_BYTES - 1] = '}';
    write_bytes("large.json", large, LS_MATERIAL_FILE_BYTES);
    LsInput input = override("a.gltf", find_path("large.json"));
    ls_input_destroy(&input);
}

// ---- Limits --------------------------------------------------------------------------------------

static void test_triangle_limit(void** state)
{
    (void)state;
    write_ply("a.ply");
    const LsBakeInput inputs[] = {{.path = find_path("a.ply")}, {.path = find_path("a.ply")}};
    LsBakeDesc desc = {.inputs = inputs, .input_count = 2, .max_triangles = 4};
    LsInput input = {0};
    LsError error;
    assert_int_equal(ls_compose(&input, &desc, NULL, NULL, &error), LS_OK);
    ls_input_destroy(&input);
    desc.max_triangles = 3;
    check_refused_desc(&desc, LS_MESSAGE_LIMIT_TRIANGLES, "--max-triangles");
    desc.max_triangles = 1;
    check_refused_desc(&desc, LS_MESSAGE_LIMIT_TRIANGLES, "a.ply");
}

static void test_no_triangles(void** state)
{
    (void)state;
    write_gltf("a.gltf", "0", "{\"camera\":0}", "");
    write_ply("a.ply");
    const LsBakeInput inputs[] = {{.path = find_path("a.gltf")}, {.path = find_path("a.ply")}};
    check_refused(&inputs[0], LS_MESSAGE_SCENE_NO_TRIANGLES, "a.gltf");
    // Beside one that has some it may stand.
    LsInput input = compose(inputs, 2);
    ls_input_destroy(&input);
}

static void test_memory_limit(void** state)
{
    (void)state;
    LsError error = {0};
    const uint64_t in_use = ls_memory_in_use();
    assert_true(in_use > 0);
    assert_int_equal(ls_memory_check(0, UINT64_MAX, "a", "b", &error), LS_OK);
    assert_int_equal(ls_memory_check(UINT64_MAX, 1, "a", "b", &error), LS_OK);
    assert_int_equal(ls_memory_check(1, 0, "a.ply", "work", &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    assert_non_null(strstr(error.text, "a.ply: work takes"));
    assert_int_equal(ls_memory_check(UINT64_MAX, UINT64_MAX, "a", "b", &error),
                     LS_ERROR_INPUT_LIMIT);

    // What is in use follows what is used.
    const size_t bytes = 64u << 20;
    char* memory = malloc(bytes);
    assert_non_null(memory);
    memset(memory, 1, bytes);
    assert_true(ls_memory_in_use() >= in_use + bytes / 2);
    free(memory);

    const LsGridFrame frame = {.cells = {4096, 4096, 5}};
    assert_int_equal(ls_grid_need(&frame), 1024 * 1024 * 2 * 8);
    LsWorkVoxel voxels[] = {{.kind = LS_VOXEL_MASKS, .reference_count = 9},
                            {.kind = LS_VOXEL_LIST, .reference_count = 9},
                            {.kind = LS_VOXEL_MASKS, .reference_count = 32}};
    const LsBakedObject object = {.voxels = {.voxels = voxels, .voxel_count = 3}};
    assert_int_equal(ls_tables_need(&object, 1, 2), 15 * 16 * (2 + 4));
    const LsMesh mesh = {.triangle_count = 100};
    assert_int_equal(ls_pack_need(&object, &mesh, 1), 100 * 48 + 3 * 16);
}

// Before a stage begins that is known not to fit; nothing is left at the output's name.
static void test_bake_within_memory(void** state)
{
    (void)state;
    write_ply("a.ply");
    char output[256];
    snprintf(output, sizeof output, "%s", find_path("out.lspace"));
    const LsBakeInput how = {.path = find_path("a.ply")};
    const LsBakeInput bunny = {.path = LS_SOURCE_DIR "/scenes/bunny.ply"};
    LsBakeDesc desc = {.inputs = &how, .input_count = 1, .output = output, .max_memory = 1000};
    LsError error = {0};
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    assert_int_equal(access(output, F_OK), -1);
    // Tables of 15 * 16^4 shafts for each of thousands of voxels.
    desc.inputs = &bunny;
    desc.patches = 16;
    desc.max_memory = 4ull << 30;
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_MEMORY);
    assert_non_null(strstr(error.text, "the table of shafts"));
    assert_int_equal(access(output, F_OK), -1);
    desc.inputs = &how;
    desc.patches = 0;
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_OK);
    assert_int_equal(access(output, F_OK), 0);
}

// Whatever is done to an input, the file is another, and up to date when it is done again.
static void test_bake_knows_its_inputs(void** state)
{
    (void)state;
    write_gltf("a.gltf", "0", TREE, TWO_MATERIALS);
    char output[256], path[256];
    snprintf(output, sizeof output, "%s", find_path("out.lspace"));
    snprintf(path, sizeof path, "%s", find_path("a.gltf"));
    const LsBakeInput ways[] = {{.path = path},
                                {.path = path, .up = LS_UP_X},
                                {.path = path, .scale = 2},
                                {.path = path, .flip = true},
                                {.path = path, .size = 2},
                                {.path = path, .turn = 5},
                                {.path = path, .is_at = true},
                                {.path = path, .materials = "{\"roughnessFactor\":0.5}"}};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
    {
        const LsBakeDesc desc = {.inputs = &ways[i], .input_count = 1, .output = output};
        LsBakeReport report;
        LsError error = {0};
        assert_int_equal(ls_bake_run(&desc, &report, &error), LS_OK);
        assert_false(report.up_to_date);
        assert_int_equal(ls_bake_run(&desc, &report, &error), LS_OK);
        assert_true(report.up_to_date);
    }
}

// ---- Bundled scenes -----------------------------------------------------------------------------

static uint32_t count_triangles(const LsInput* input)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < input->mesh_count; i++)
        sum += input->meshes[i].triangle_count;
    return sum;
}

// Positive for a closed mesh whose faces look outward.
static double find_volume(const LsInputMesh* mesh)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        const float* p[3];
        for (int k = 0; k < 3; k++)
            p[k] = mesh->positions + 3 * mesh->indices[3 * i + (uint32_t)k];
        for (int axis = 0; axis < 3; axis++)
        {
            const int j = (axis + 1) % 3, k = (axis + 2) % 3;
            sum += p[0][axis] * ((double)p[1][j] * p[2][k] - (double)p[1][k] * p[2][j]) / 6.0;
        }
    }
    return sum;
}

static void test_bundled_scenes(void** state)
{
    (void)state;
    LsInput box = compose(&(LsBakeInput){.path = LS_SOURCE_DIR "/scenes/cornell.gltf"}, 1);
    LsInput blocks =
        compose(&(LsBakeInput){.path = LS_SOURCE_DIR "/scenes/cornell_blocks.gltf"}, 1);
    assert_int_equal(count_triangles(&box), 12);
    assert_int_equal(count_triangles(&blocks), 36);
    // The box is the same, and the blocks stand in it and on its floor.
    for (uint32_t i = 0; i < 2; i++)
        assert_memory_equal(blocks.meshes[i].positions, box.meshes[i].positions,
                            box.meshes[i].vertex_count * 3 * sizeof(float));
    assert_int_equal(blocks.mesh_count, 4);
    static const double volumes[] = {0.6 * 0.6 * 0.6, 0.6 * 0.6 * 1.2};
    for (uint32_t i = 0; i < 2; i++)
    {
        const LsInputMesh* block = &blocks.meshes[2 + i];
        check_close((const double[]){find_volume(block)}, &volumes[i], 1, 1e-6);
        for (uint32_t k = 0; k < 3 * block->vertex_count; k++)
            assert_true(fabsf(block->positions[k]) <= 1.0f);
    }
    const LsMaterial* mirror = &blocks.materials[blocks.meshes[3].materials[0]].core;
    assert_true(mirror->metallic == 1.0f && mirror->roughness == 0.0f);
    assert_true(blocks.materials[blocks.meshes[2].materials[0]].core.metallic == 0.0f);
    assert_int_equal(blocks.camera_count, 1);

    const LsBakeInput inputs[] = {{.path = LS_SOURCE_DIR "/scenes/stage.gltf"},
                                  {.path = LS_SOURCE_DIR "/scenes/bunny.ply",
                                   .materials = LS_SOURCE_DIR "/scenes/glossy.json"}};
    LsInput stage = compose(inputs, 2);
    assert_int_equal(count_triangles(&stage), 8 + 69666);
    assert_int_equal(stage.camera_count, 1);
    uint32_t lights = 0;
    for (uint32_t i = 0; i < 2; i++)
        for (uint32_t k = 0; k < stage.meshes[i].triangle_count; k++)
            lights +=
                stage.materials[stage.meshes[i].materials[k]].core.flags & LS_MATERIAL_EMISSIVE;
    assert_int_equal(lights, 6); // two triangles each
    const LsInputMaterial* glossy = &stage.materials[stage.meshes[2].materials[0]];
    assert_true(glossy->core.roughness == 0.443f && glossy->surface.ior == 1.925f);
    ls_input_destroy(&box);
    ls_input_destroy(&blocks);
    ls_input_destroy(&stage);
}

// ---- Progress -----------------------------------------------------------------------------------

typedef struct Heard
{
    double last;
    unsigned count;
    bool is_rising;
} Heard;

static void hear(void* user, double fraction)
{
    Heard* heard = user;
    heard->is_rising = heard->is_rising && fraction >= heard->last && fraction <= 1.0;
    heard->last = fraction;
    heard->count++;
}

// The second of two files begins where the first one's share of the bytes ends.
static void test_progress(void** state)
{
    (void)state;
    write_ply("a.ply");
    const LsBakeInput inputs[] = {{.path = find_path("a.ply")}, {.path = find_path("a.ply")}};
    const LsBakeDesc desc = {.inputs = inputs, .input_count = 2};
    LsInput input = {0};
    LsError error;
    Heard heard = {.is_rising = true};
    assert_int_equal(ls_compose(&input, &desc, hear, &heard, &error), LS_OK);
    assert_true(heard.is_rising && heard.count >= 2 && heard.last >= 0.5);
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
        cmocka_unit_test(test_wrong_desc),
        cmocka_unit_test(test_every_field),
        cmocka_unit_test(test_fields_alone),
        cmocka_unit_test(test_materials_by_name),
        cmocka_unit_test(test_shared_material),
        cmocka_unit_test(test_materials_refused),
        cmocka_unit_test(test_triangle_limit),
        cmocka_unit_test(test_no_triangles),
        cmocka_unit_test(test_memory_limit),
        cmocka_unit_test(test_bake_within_memory),
        cmocka_unit_test(test_bake_knows_its_inputs),
        cmocka_unit_test(test_bundled_scenes),
        cmocka_unit_test(test_progress),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
