// The mesh stage and what of looks goes into the file: on inputs made here, by what is known of them.

#include "mesh.h"
#include "normals.h"
#include "octahedral.h"
#include "pack.h"
#include "test_random.h"
#include "weld.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- Inputs -------------------------------------------------------------------------------------

static void expect_ok(LsResult result, const LsError* error)
{
    if (result != LS_OK)
    {
        fail_msg("%s", error->text);
    }
}

// An input of one file without meshes.
static LsInput begin_input(void)
{
    LsInput input = {0};
    input.paths = calloc(1, sizeof *input.paths);
    assert_non_null(input.paths);
    input.paths[0] = strdup("made.here");
    return input;
}

static void end_input(LsInput* input)
{
    input->file_count = 1;
    ls_input_destroy(input);
}

static LsInputMesh* add_mesh(LsInput* input, const float* positions, uint32_t vertex_count,
                             const uint32_t* indices, uint32_t face_count)
{
    LsInputMesh* mesh = ls_input_add_plain_mesh(input, vertex_count, face_count);
    assert_non_null(mesh);
    memcpy(mesh->positions, positions, 3 * vertex_count * sizeof *positions);
    memcpy(mesh->indices, indices, 3 * face_count * sizeof *indices);
    return mesh;
}

static const float CUBE[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                 {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
static const uint32_t CUBE_FACES[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                           {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                           {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

static LsInputMesh* add_cube(LsInput* input)
{
    return add_mesh(input, &CUBE[0][0], 8, &CUBE_FACES[0][0], 12);
}

static LsMesh create(LsInput* input, const LsBakeDesc* desc, LsMeshFindings* findings)
{
    LsMesh mesh;
    LsError error = {0};
    LsMeshFindings own;
    expect_ok(
        ls_mesh_create(&mesh, input, 0, desc, 2, NULL, findings != NULL ? findings : &own, &error),
        &error);
    return mesh;
}

// ---- Welding ------------------------------------------------------------------------------------

static void equal_positions_are_one(void** state)
{
    (void)state;
    static const float positions[7][3] = {{1, 2, 3},
                                          {0, 5, 6},
                                          {1, 2, 3},
                                          {-0.0f, 5, 6},
                                          {1, 2, 3.001f},
                                          {3, 2, 1},
                                          {1, 2, 3.0000002384f}};
    static const uint32_t expected[7] = {0, 1, 0, 1, 2, 3, 4};
    uint32_t ids[7], count;
    assert_true(ls_weld(&positions[0][0], 7, ids, &count));
    assert_int_equal(count, 5);
    assert_memory_equal(ids, expected, sizeof ids);
    assert_true(ls_weld(NULL, 0, ids, &count));
    assert_int_equal(count, 0);
}

static void welding_many(void** state)
{
    (void)state;
    const uint32_t count = 300000;
    float* positions = malloc(sizeof(float) * 3 * count);
    uint32_t* ids = malloc(sizeof(uint32_t) * count);
    uint32_t* first = malloc(sizeof(uint32_t) * 64 * 64 * 64);
    assert_true(positions != NULL && ids != NULL && first != NULL);
    memset(first, 0xFF, sizeof(uint32_t) * 64 * 64 * 64);
    LsRandom random = {3};
    uint32_t distinct = 0;
    for (uint32_t v = 0; v < count; v++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            positions[3 * v + axis] = (float)ls_random_below(&random, 64) - 32.0f;
        }
    }
    uint32_t found;
    assert_true(ls_weld(positions, count, ids, &found));
    for (uint32_t v = 0; v < count; v++)
    {
        const float* p = positions + 3 * v;
        uint32_t cell = (uint32_t)(p[0] + 32.0f) + 64 * (uint32_t)(p[1] + 32.0f) +
                        4096 * (uint32_t)(p[2] + 32.0f);
        first[cell] = first[cell] == UINT32_MAX ? distinct++ : first[cell];
        assert_int_equal(ids[v], first[cell]);
    }
    assert_int_equal(found, distinct);
    free(positions);
    free(ids);
    free(first);
}

static void welding_can_be_switched_off(void** state)
{
    (void)state;
    // The cube with corners of its own for each face, as STL has it.
    float positions[36][3];
    uint32_t indices[36];
    for (uint32_t c = 0; c < 36; c++)
    {
        memcpy(positions[c], CUBE[CUBE_FACES[c / 3][c % 3]], sizeof positions[c]);
        indices[c] = c;
    }
    for (int no_weld = 0; no_weld < 2; no_weld++)
    {
        LsInput input = begin_input();
        add_mesh(&input, &positions[0][0], 36, indices, 12);
        LsMeshFindings findings;
        LsMesh mesh = create(&input, &(LsBakeDesc){.no_weld = no_weld}, &findings);
        assert_int_equal(findings.report.input_vertex_count, 36);
        assert_int_equal(findings.report.vertex_count, no_weld ? 36 : 8);
        assert_int_equal(findings.report.edge_count, no_weld ? 36 : 18);
        assert_int_equal(findings.report.hole_count, no_weld ? 12 : 0);
        // Neither changes a position nor a number.
        assert_int_equal(mesh.triangle_count, 12);
        for (uint32_t k = 0; k < 12; k++)
        {
            assert_int_equal(mesh.triangles[k].primitive, k);
            assert_memory_equal(&mesh.triangles[k].v0, positions[3 * k], 12);
            assert_memory_equal(&mesh.triangles[k].v1, positions[3 * k + 1], 12);
            assert_memory_equal(&mesh.triangles[k].v2, positions[3 * k + 2], 12);
        }
        ls_mesh_destroy(&mesh);
        end_input(&input);
    }
}

// ---- Faces without area -------------------------------------------------------------------------

static void flat_faces_are_dropped_or_kept(void** state)
{
    (void)state;
    // A triangle; corners on a line in three orders; a segment; a point.
    static const float positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                          {3, 3, 3}, {1, 1, 1}, {0, 0, 0}};
    static const uint32_t indices[6][3] = {{0, 1, 2}, {0, 4, 3}, {4, 0, 3},
                                           {3, 0, 4}, {0, 0, 1}, {5, 0, 5}};
    for (int keep = 0; keep < 2; keep++)
    {
        LsInput input = begin_input();
        add_mesh(&input, &positions[0][0], 6, &indices[0][0], 6);
        LsMeshFindings findings;
        LsMesh mesh = create(&input, &(LsBakeDesc){.keep_degenerate = keep}, &findings);
        assert_int_equal(findings.report.degenerate_count, 5);
        assert_int_equal(mesh.degenerate_count, 5);
        assert_int_equal(mesh.face_count, 6);
        assert_int_equal(mesh.triangle_count, keep ? 6 : 1);
        assert_true(mesh.upper[0] == (keep ? 3.0f : 1.0f));
        const LsMeshExample* first = &findings.examples.of[LS_MESH_FAULT_DEGENERATE][0];
        assert_int_equal(first->face, 1);
        assert_int_equal(first->vertices[1], 4);
        for (uint32_t k = 1; k < mesh.triangle_count; k++)
        {
            const LsTriangle* t = &mesh.triangles[k];
            assert_int_equal(t->primitive, k);
            // Two corners are one to the last bit, and both ends of the segment are still there.
            bool ab = memcmp(&t->v0, &t->v1, 12) == 0, bc = memcmp(&t->v1, &t->v2, 12) == 0;
            assert_true(ab || bc || memcmp(&t->v0, &t->v2, 12) == 0);
            float low = fminf(fminf(t->v0.x, t->v1.x), t->v2.x);
            float high = fmaxf(fmaxf(t->v0.x, t->v1.x), t->v2.x);
            assert_true(low == 0.0f && high == (k < 4 ? 3.0f : k == 4 ? 1.0f : 0.0f));
        }
        ls_mesh_destroy(&mesh);
        end_input(&input);
    }
}

static void a_mesh_of_flat_faces_keeps_none(void** state)
{
    (void)state;
    static const float positions[3][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    static const uint32_t indices[3] = {0, 1, 2};
    LsInput input = begin_input();
    add_mesh(&input, &positions[0][0], 3, indices, 1);
    LsMesh mesh = create(&input, &(LsBakeDesc){.keep_degenerate = true}, NULL);
    assert_int_equal(mesh.triangle_count, 0);
    assert_int_equal(mesh.face_count, 1);
    ls_mesh_destroy(&mesh);
    end_input(&input);
}

// ---- Normals ------------------------------------------------------------------------------------

static double angle_between(const double a[3], const double b[3])
{
    double c[3];
    for (int k = 0; k < 3; k++)
    {
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
    return atan2(sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]),
                 a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

static void octahedral_error_is_bounded(void** state)
{
    (void)state;
    LsRandom random = {8};
    double largest = 0.0;
    for (uint32_t i = 0; i < 2000000; i++)
    {
        double v[3], back[3];
        double size = pow(10.0, ls_random_between(&random, -150.0, 150.0));
        for (int axis = 0; axis < 3; axis++)
        {
            // Every seventh lies near an axis, an octant's border or a corner of the square.
            double small = i % 7 == 0 ? pow(10.0, -(double)ls_random_below(&random, 9)) : 1.0;
            v[axis] = size * small * ls_random_between(&random, -1.0, 1.0);
        }
        uint32_t word = ls_octahedral_encode(v);
        assert_true(word != LS_NONE && (word & 0xFFFF) != 0x8000 && word >> 16 != 0x8000);
        ls_octahedral_decode(word, back);
        largest = fmax(largest, angle_between(v, back));
    }
    print_message("largest error %.3g radians, bound %.3g\n", largest, LS_OCTAHEDRAL_ERROR);
    assert_true(largest <= LS_OCTAHEDRAL_ERROR);
    assert_true(largest > 0.8 * LS_OCTAHEDRAL_ERROR);
    // The axes are exact, and what would read as "none" is its neighbour.
    for (int axis = 0; axis < 6; axis++)
    {
        double v[3] = {0.0, 0.0, 0.0}, back[3];
        v[axis / 2] = axis % 2 == 0 ? 2.5 : -2.5;
        ls_octahedral_decode(ls_octahedral_encode(v), back);
        for (int k = 0; k < 3; k++)
        {
            assert_true(back[k] == v[k] / 2.5);
        }
    }
    double none[3];
    ls_octahedral_decode(LS_NONE, none);
    assert_int_equal(ls_octahedral_encode(none), 0x0000FFFF);
}

// Each corner's normal of the cube's twelve faces, decoded; false for one that has none.
static bool corner_normal(const LsMesh* mesh, uint32_t corner, double n[3])
{
    uint32_t word = mesh->looks.normals[corner];
    if (word == LS_NONE)
    {
        return false;
    }
    ls_octahedral_decode(word, n);
    return true;
}

static void smooth_normals_bridge_an_angle(void** state)
{
    (void)state;
    // A cube's edges have 90 degrees: less leaves it flat, and then it has no normals.
    const double degrees[3] = {0.0, 90.0, 180.0};
    for (int i = 0; i < 3; i++)
    {
        LsInput input = begin_input();
        add_cube(&input);
        LsMesh mesh = create(
            &input, &(LsBakeDesc){.normals = LS_NORMALS_SMOOTH, .smooth_angle = degrees[i]}, NULL);
        assert_int_equal(mesh.looks.normals == NULL, i == 0);
        for (uint32_t c = 0; c < 36 && i > 0; c++)
        {
            const float* p = CUBE[CUBE_FACES[c / 3][c % 3]];
            double n[3];
            const double diagonal[3] = {p[0] - 0.5, p[1] - 0.5, p[2] - 0.5};
            assert_true(corner_normal(&mesh, c, n));
            // By angles all three sides weigh the same, however they are cut into triangles.
            assert_true(angle_between(n, diagonal) <= LS_OCTAHEDRAL_ERROR);
        }
        ls_mesh_destroy(&mesh);
        end_input(&input);
    }
}

static void smooth_normals_follow_a_sphere(void** state)
{
    (void)state;
    enum
    {
        AROUND = 48,
        ALONG = 24,
        FACES = 2 * AROUND * ALONG
    };
    static float positions[FACES * 3][3];
    static uint32_t indices[FACES * 3];
    const double pi = 3.14159265358979323846;
    for (uint32_t c = 0; c < FACES * 3; c++)
    {
        // Two triangles a patch, with corners of their own; those at the poles have no area.
        static const uint32_t corner_x[6] = {0, 1, 1, 0, 1, 0}, corner_y[6] = {0, 0, 1, 0, 1, 1};
        uint32_t patch = c / 6, x = (patch % AROUND + corner_x[c % 6]) % AROUND;
        uint32_t y = patch / AROUND + corner_y[c % 6];
        double ring = y == 0 || y == ALONG ? 0.0 : sin(pi * y / ALONG);
        positions[c][0] = (float)(ring * cos(2.0 * pi * x / AROUND));
        positions[c][1] = (float)(ring * sin(2.0 * pi * x / AROUND));
        positions[c][2] = (float)-cos(pi * y / ALONG);
        indices[c] = c;
    }
    uint32_t one[3 * FACES];
    for (int round = 0; round < 2; round++)
    {
        LsInput input = begin_input();
        add_mesh(&input, &positions[0][0], FACES * 3, indices, FACES);
        LsMeshFindings findings;
        LsMesh mesh;
        LsError error = {0};
        expect_ok(ls_mesh_create(&mesh, &input, 0,
                                 &(LsBakeDesc){.normals = LS_NORMALS_SMOOTH, .smooth_angle = 40.0},
                                 round == 0 ? 1 : 3, NULL, &findings, &error),
                  &error);
        assert_int_equal(findings.report.degenerate_count, 2 * AROUND);
        assert_int_equal(findings.report.hole_count, 0);
        assert_non_null(mesh.looks.normals);
        for (uint32_t c = 0; c < 3 * FACES; c++)
        {
            double n[3];
            const double radius[3] = {positions[c][0], positions[c][1], positions[c][2]};
            bool has = corner_normal(&mesh, c, n);
            bool flat = c / 6 < AROUND ? c % 6 < 3 : c / 6 >= FACES / 2 - AROUND && c % 6 >= 3;
            assert_int_equal(has, !flat);
            assert_true(!has || angle_between(n, radius) < 0.02);
        }
        if (round == 0)
        {
            memcpy(one, mesh.looks.normals, sizeof one);
        }
        assert_memory_equal(mesh.looks.normals, one, sizeof one);
        ls_mesh_destroy(&mesh);
        end_input(&input);
    }
}

static void crowded_vertices_stay_flat(void** state)
{
    (void)state;
    // A flat fan of more faces than a smooth vertex has, its rim a little up and down.
    const uint32_t count = LS_SMOOTH_FACES + 2;
    float* positions = calloc(3 * (count + 1ull), sizeof *positions);
    uint32_t* indices = calloc(3ull * count, sizeof *indices);
    assert_true(positions != NULL && indices != NULL);
    for (uint32_t i = 0; i < count; i++)
    {
        double angle = 2.0 * 3.14159265358979323846 * i / count;
        positions[3 * (i + 1)] = (float)cos(angle);
        positions[3 * (i + 1) + 1] = (float)sin(angle);
        positions[3 * (i + 1) + 2] = i % 2 == 0 ? 0.0f : 0.001f;
        indices[3 * i + 1] = i + 1;
        indices[3 * i + 2] = (i + 1) % count + 1;
    }
    LsInput input = begin_input();
    add_mesh(&input, positions, count + 1, indices, count);
    LsMesh mesh =
        create(&input, &(LsBakeDesc){.normals = LS_NORMALS_SMOOTH, .smooth_angle = 40.0}, NULL);
    for (uint32_t i = 0; i < count; i++)
    {
        double own[3], at_hub[3], at_rim[3];
        ls_face_normal(positions, indices + 3 * i, own);
        assert_true(corner_normal(&mesh, 3 * i, at_hub) && corner_normal(&mesh, 3 * i + 1, at_rim));
        assert_true(angle_between(own, at_hub) <= LS_OCTAHEDRAL_ERROR);
        assert_true(angle_between(own, at_rim) > 0.01);
    }
    ls_mesh_destroy(&mesh);
    end_input(&input);
    free(positions);
    free(indices);
}

static void given_normals_are_taken_or_left_out(void** state)
{
    (void)state;
    // Per face corner: its side's normal, of another length each; that is flat shading.
    for (int round = 0; round < 3; round++)
    {
        LsInput input = begin_input();
        LsInputMesh* source = add_cube(&input);
        assert_true(ls_input_stream_create(source, LS_STREAM_NORMAL, 12, true));
        for (uint32_t face = 0; face < 12; face++)
        {
            double n[3];
            ls_face_normal(source->positions, source->indices + 3 * face, n);
            for (int k = 0; k < 3; k++)
            {
                source->streams[LS_STREAM_NORMAL].values[3 * face + k] = (float)(n[k] * (face + 1));
                source->streams[LS_STREAM_NORMAL].indices[3 * face + k] = face;
            }
        }
        if (round > 0)
        {
            float* last = &source->streams[LS_STREAM_NORMAL].values[33];
            last[0] = last[1] = last[2] = 1.0f;
            source->streams[LS_STREAM_NORMAL].indices[7] = LS_NONE;
            memset(&source->streams[LS_STREAM_NORMAL].values[9], 0, 3 * sizeof(float));
        }
        LsMesh mesh =
            create(&input,
                   &(LsBakeDesc){.normals = round == 2 ? LS_NORMALS_NONE : LS_NORMALS_INPUT}, NULL);
        assert_int_equal(mesh.looks.normals != NULL, round == 1);
        if (round == 1)
        {
            double n[3];
            const double given[3] = {1.0, 1.0, 1.0};
            assert_true(corner_normal(&mesh, 33, n));
            assert_true(angle_between(n, given) <= LS_OCTAHEDRAL_ERROR);
            assert_false(corner_normal(&mesh, 7, n));  // a corner without
            assert_false(corner_normal(&mesh, 10, n)); // (0, 0, 0)
            assert_true(corner_normal(&mesh, 6, n));
        }
        assert_int_equal(input.warning_count, 0);
        ls_mesh_destroy(&mesh);
        end_input(&input);
    }
}

// ---- Warnings and errors ------------------------------------------------------------------------

static void expect_warning(LsInput* input, LsMessage message)
{
    for (int strict = 0; strict < 2; strict++)
    {
        input->options.strict = strict;
        LsMesh mesh;
        LsMeshFindings findings;
        LsError error = {0};
        LsResult result =
            ls_mesh_create(&mesh, input, 0, &(LsBakeDesc){0}, 1, NULL, &findings, &error);
        if (strict)
        {
            assert_int_equal(result, LS_ERROR_INPUT_WARNING);
            assert_int_equal(error.message, message);
        }
        else
        {
            expect_ok(result, &error);
            assert_int_equal(input->warning_count, 1);
            assert_int_equal(input->warnings[0].message, message);
            assert_int_equal(input->warnings[0].input_index, 0);
            assert_non_null(strstr(input->warnings[0].text, "made.here"));
            ls_mesh_destroy(&mesh);
        }
    }
}

// A surface of one texture that reads a set.
static void add_texture(LsInput* input, uint32_t material, uint32_t set)
{
    LsInputImage* image = ls_input_add_image(input);
    assert_non_null(image);
    image->width = image->height = 2;
    image->pixels = calloc(4, sizeof *image->pixels);
    assert_non_null(image->pixels);
    for (uint32_t i = 0; i < 4; i++)
    {
        image->pixels[i] = 100 * input->image_count + i;
    }
    LsTexture* texture = ls_input_add_texture(input);
    assert_non_null(texture);
    texture->row_u.x = texture->row_v.y = 1.0f;
    texture->image = input->image_count - 1;
    texture->texcoord = set;
    input->materials[material].surface.base_color_texture = input->texture_count - 1;
}

static void warnings_name_the_mesh(void** state)
{
    (void)state;
    LsInput normals = begin_input();
    LsInputMesh* source = add_cube(&normals);
    assert_true(ls_input_stream_create(source, LS_STREAM_NORMAL, 8, false));
    source->streams[LS_STREAM_NORMAL].values[4] = NAN;
    expect_warning(&normals, LS_MESSAGE_MESH_NORMAL);
    end_input(&normals);

    LsInput texcoords = begin_input();
    source = add_cube(&texcoords);
    add_texture(&texcoords, 0, 1);
    assert_true(ls_input_stream_create(source, LS_STREAM_TEXCOORD_1, 8, false));
    source->streams[LS_STREAM_TEXCOORD_1].values[5] = INFINITY;
    expect_warning(&texcoords, LS_MESSAGE_MESH_TEXCOORD);
    end_input(&texcoords);

    LsInput missing = begin_input();
    source = add_cube(&missing);
    add_texture(&missing, 0, 1);
    assert_true(ls_input_stream_create(source, LS_STREAM_TEXCOORD_0, 8, false));
    expect_warning(&missing, LS_MESSAGE_MESH_NO_TEXCOORD);
    end_input(&missing);
}

static void expect_error(LsInput* input, LsMessage message)
{
    LsMesh mesh;
    LsMeshFindings findings;
    LsError error = {0};
    assert_int_equal(ls_mesh_create(&mesh, input, 0, &(LsBakeDesc){0}, 1, NULL, &findings, &error),
                     message / 100);
    assert_int_equal(error.message, message);
    assert_non_null(strstr(error.text, "made.here"));
    end_input(input);
}

static void errors_have_numbers(void** state)
{
    (void)state;
    LsInput input = begin_input();
    add_cube(&input)->positions[4] = NAN;
    expect_error(&input, LS_MESSAGE_MESH_NOT_FINITE);

    input = begin_input();
    LsInputMesh* mesh = add_cube(&input);
    for (int i = 0; i < 24; i++)
    {
        mesh->positions[i] += 4e6f;
    }
    expect_error(&input, LS_MESSAGE_MESH_FAR);

    input = begin_input();
    mesh = add_cube(&input);
    for (int i = 0; i < 24; i++)
    {
        mesh->positions[i] *= 1e13f;
    }
    expect_error(&input, LS_MESSAGE_MESH_EXTENT);

    input = begin_input();
    add_cube(&input)->triangle_count = LS_MAX_FACES + 1; // seen before any face is read
    expect_error(&input, LS_MESSAGE_LIMIT_RECORDS);
}

static void transforms_have_numbers(void** state)
{
    (void)state;
    static const struct
    {
        double scale[3];
        LsMessage message;
    } cases[] = {{{1, 0, 1}, LS_MESSAGE_TRANSFORM_SINGULAR},
                 {{1, 1, 1e7}, LS_MESSAGE_TRANSFORM_CONDITION},
                 {{1e19, 1e19, 1e19}, LS_MESSAGE_TRANSFORM_RANGE}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        LsInput input = begin_input();
        add_cube(&input);
        for (int axis = 0; axis < 3; axis++)
        {
            input.instances[0].world_from_object[axis][axis] = cases[i].scale[axis];
        }
        LsMesh mesh = create(&input, &(LsBakeDesc){0}, NULL);
        LsWorld world;
        LsError error = {0};
        assert_int_equal(ls_world_create(&world, &input, &mesh, &error), LS_ERROR_INPUT_TRANSFORM);
        assert_int_equal(error.message, cases[i].message);
        ls_mesh_destroy(&mesh);
        end_input(&input);
    }
}

// More lights than 32 bits count, of few triangles and few instances.
static void lights_beyond_counting(void** state)
{
    (void)state;
    enum
    {
        COUNT = 65537
    };
    LsTriangle* triangles = calloc(COUNT, sizeof *triangles);
    assert_non_null(triangles);
    for (uint32_t i = 0; i < COUNT; i++)
    {
        triangles[i] = (LsTriangle){.v1 = {1, 0, 0}, .v2 = {0, 1, 0}, .primitive = i};
    }
    LsInput input = begin_input();
    add_cube(&input);
    input.materials[0].core.flags = LS_MATERIAL_EMISSIVE;
    input.materials[0].core.emission = (LsVec3){1, 1, 1};
    while (input.instance_count < COUNT)
    {
        LsInputInstance* added = ls_input_add_instance(&input);
        assert_non_null(added);
        *added = input.instances[0];
    }
    LsMesh mesh = {.triangles = triangles, .triangle_count = COUNT, .upper = {1, 1, 0}};
    LsWorld world;
    LsError error = {0};
    assert_int_equal(ls_world_create(&world, &input, &mesh, &error), LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_RECORDS);
    free(triangles);
    end_input(&input);
}

// ---- Packing ------------------------------------------------------------------------------------

// Packs meshes as they are, as lists or with a grid, with the rest of the scene.
static void pack_input(LsInput* input, bool with_grid, LsWorld* world, LsPack* pack)
{
    LsMesh* meshes = calloc(input->mesh_count, sizeof *meshes);
    LsBakedObject* objects = calloc(input->mesh_count, sizeof *objects);
    assert_true(meshes != NULL && objects != NULL);
    LsError error = {0};
    LsShaftWeights weights[LS_MAX_PATCHES + 1];
    assert_true(ls_shaft_weights_create_all(weights, 1, 1));
    const LsDivisionRule rule = {.above = LS_MASK_TRIANGLES, .most_depth = LS_MAX_DEPTH};
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        LsMeshFindings findings;
        expect_ok(
            ls_mesh_create(&meshes[i], input, i, &(LsBakeDesc){0}, 1, NULL, &findings, &error),
            &error);
        if (with_grid)
        {
            expect_ok(ls_voxels_create(&objects[i].voxels, &meshes[i], 8, &rule, 1, NULL, &error),
                      &error);
            expect_ok(ls_voxels_order_triangles(&objects[i].voxels, &meshes[i], 1, &error), &error);
            expect_ok(ls_tables_create(&objects[i].tables, &objects[i].voxels, &meshes[i],
                                       &(LsPatchesChoice){.patches = 1}, weights, 1, NULL, &error),
                      &error);
            objects[i].has_grid = true;
        }
    }
    expect_ok(ls_world_create(world, input, meshes, &error), &error);
    expect_ok(ls_pack_create(pack, input, meshes, objects, world, 1, &error), &error);
    ls_shaft_weights_destroy_all(weights);
    free(meshes);
    free(objects);
}

static void plain_scenes_have_no_looks(void** state)
{
    (void)state;
    LsInput input = begin_input();
    LsInputMesh* source = add_cube(&input);
    // Texture coordinates that no material reads, colours that are white, a texture of no triangle.
    assert_true(ls_input_stream_create(source, LS_STREAM_TEXCOORD_0, 8, false));
    assert_true(ls_input_stream_create(source, LS_STREAM_COLOR, 8, false));
    for (int i = 0; i < 32; i++)
    {
        source->streams[LS_STREAM_COLOR].values[i] = 1.0f;
    }
    assert_non_null(ls_input_add_material(&input));
    add_texture(&input, 1, 0);
    LsWorld world;
    LsPack pack;
    pack_input(&input, false, &world, &pack);
    const LsFileDesc* desc = &pack.desc;
    assert_int_equal(desc->MATERIALS_count, 2);
    assert_int_equal(desc->materials[0].surface, 0);
    assert_int_equal(desc->materials[1].surface, 0);
    assert_int_equal(desc->SURFACES_count + desc->TEXTURES_count + desc->IMAGES_count, 0);
    assert_int_equal(desc->PIXELS_count + desc->ATTRIBUTES_count + desc->NORMALS_count, 0);
    assert_int_equal(desc->TEXCOORDS_count + desc->COLORS_count + desc->LAMPS_count, 0);
    assert_int_equal(desc->ANIMATIONS_count + desc->CHANNELS_count + desc->KEYS_count, 0);
    ls_pack_destroy(&pack);
    ls_world_destroy(&world);
    end_input(&input);
}

static void used_looks_are_packed_in_order(void** state)
{
    (void)state;
    LsInput input = begin_input();
    add_cube(&input);                               // object 0: no looks at all
    LsInputMesh* source = add_cube(&input);         // object 1: both sets, colours
    assert_non_null(ls_input_add_material(&input)); // 1: default surface
    assert_non_null(ls_input_add_material(&input)); // 2: of no triangle
    assert_non_null(ls_input_add_material(&input)); // 3: texture of set 1
    assert_non_null(ls_input_add_material(&input)); // 4: glass, texture of set 0
    add_texture(&input, 2, 0);
    add_texture(&input, 3, 1);
    add_texture(&input, 4, 0);
    input.materials[4].surface.transmission = 0.5f;
    // The same image by another texture.
    *ls_input_add_texture(&input) = input.textures[1];
    input.materials[4].surface.normal_texture = 3;
    for (uint32_t face = 0; face < 12; face++)
    {
        source->materials[face] = face % 2 == 0 ? 4 : 3;
    }
    for (int kind = LS_STREAM_TEXCOORD_0; kind <= LS_STREAM_COLOR; kind++)
    {
        assert_true(ls_input_stream_create(source, (LsStreamKind)kind, 8, false));
        for (uint32_t i = 0; i < 8 * ls_stream_size((LsStreamKind)kind); i++)
        {
            source->streams[kind].values[i] = (float)(i + 1) / (float)(40 * kind);
        }
    }
    LsLamp* lamp = ls_input_add_lamp(&input);
    LsAnimation* animation = ls_input_add_animation(&input);
    LsChannel* channel = ls_input_add_channel(&input);
    assert_true(lamp != NULL && animation != NULL && channel != NULL);
    assert_non_null(ls_input_add_keys(&input, 5));

    LsWorld world;
    LsPack pack;
    pack_input(&input, false, &world, &pack);
    const LsFileDesc* desc = &pack.desc;
    const uint32_t surfaces[5] = {0, 0, 0, 1, 2};
    for (uint32_t i = 0; i < 5; i++)
    {
        assert_int_equal(desc->materials[i].surface, surfaces[i]);
    }
    assert_int_equal(desc->SURFACES_count, 2);
    assert_int_equal(desc->TEXTURES_count, 3);
    assert_int_equal(desc->IMAGES_count, 2);
    assert_int_equal(desc->surfaces[0].base_color_texture, 0);
    assert_int_equal(desc->surfaces[1].base_color_texture, 1);
    assert_int_equal(desc->surfaces[1].normal_texture, 2);
    assert_int_equal(desc->surfaces[1].emissive_texture, LS_NONE);
    assert_true(desc->surfaces[1].transmission == 0.5f);
    assert_int_equal(desc->textures[0].image, 0);
    assert_int_equal(desc->textures[1].image, 1);
    assert_int_equal(desc->textures[2].image, 0);
    assert_int_equal(desc->PIXELS_count, 8);
    assert_int_equal(desc->images[1].first_pixel, 4);
    assert_int_equal(desc->pixels[0], 200);
    assert_int_equal(desc->pixels[7], 303);

    assert_int_equal(desc->ATTRIBUTES_count, 2);
    const LsAttributes none = {LS_NONE, {LS_NONE, LS_NONE}, LS_NONE};
    assert_memory_equal(&desc->attributes[0], &none, sizeof none);
    const LsAttributes own = {LS_NONE, {0, 36}, 0};
    assert_memory_equal(&desc->attributes[1], &own, sizeof own);
    assert_int_equal(desc->NORMALS_count, 0);
    assert_int_equal(desc->TEXCOORDS_count, 72);
    assert_int_equal(desc->COLORS_count, 36);
    for (uint32_t c = 0; c < 36; c++)
    {
        uint32_t v = CUBE_FACES[c / 3][c % 3];
        assert_true(desc->texcoords[c].u == (float)(2 * v + 1) / 40.0f);
        assert_true(desc->texcoords[36 + c].v == (float)(2 * v + 2) / 80.0f);
        assert_int_equal(desc->colors[c].red_green & 0xFFFF,
                         lrint(65535.0 * ((float)(4 * v + 1) / 120.0f)));
        assert_int_equal(desc->colors[c].blue_alpha >> 16,
                         lrint(65535.0 * ((float)(4 * v + 4) / 120.0f)));
    }
    assert_int_equal(desc->LAMPS_count, 1);
    assert_int_equal(desc->ANIMATIONS_count, 1);
    assert_int_equal(desc->CHANNELS_count, 1);
    assert_int_equal(desc->KEYS_count, 5);
    assert_true(desc->lamps == input.lamps && desc->keys == input.keys);
    ls_pack_destroy(&pack);
    ls_world_destroy(&world);
    end_input(&input);
}

// The voxel stage sorts triangles anew; their corners' records must go with them.
static void looks_follow_their_triangles(void** state)
{
    (void)state;
    const uint32_t count = 500;
    float positions[1500][3];
    uint32_t indices[1500];
    LsRandom random = {31};
    for (uint32_t c = 0; c < 3 * count; c++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            positions[c][axis] = (float)ls_random_unit(&random);
        }
        indices[c] = c;
    }
    // One face without area in front, so that numbers and places differ.
    memcpy(positions[1], positions[0], sizeof positions[1]);
    LsInput input = begin_input();
    LsInputMesh* source = add_mesh(&input, &positions[0][0], 3 * count, indices, count);
    add_texture(&input, 0, 0);
    assert_true(ls_input_stream_create(source, LS_STREAM_NORMAL, 3 * count, false));
    assert_true(ls_input_stream_create(source, LS_STREAM_TEXCOORD_0, 3 * count, false));
    for (uint32_t c = 0; c < 3 * count; c++)
    {
        memcpy(&source->streams[LS_STREAM_NORMAL].values[3 * c], positions[c], 12);
        memcpy(&source->streams[LS_STREAM_TEXCOORD_0].values[2 * c], positions[c], 8);
    }
    LsWorld world;
    LsPack pack;
    pack_input(&input, true, &world, &pack);
    const LsFileDesc* desc = &pack.desc;
    assert_int_equal(desc->TRIANGLES_count, count - 1);
    assert_int_equal(desc->NORMALS_count, 3 * (count - 1));
    assert_int_equal(desc->TEXCOORDS_count, 3 * (count - 1));
    bool moved = false;
    for (uint32_t k = 0; k < count - 1; k++)
    {
        const LsTriangle* t = &desc->triangles[k];
        const LsVec3 corners[3] = {t->v0, t->v1, t->v2};
        moved = moved || t->primitive != k + 1;
        for (uint32_t c = 0; c < 3; c++)
        {
            const double p[3] = {corners[c].x, corners[c].y, corners[c].z};
            assert_true(desc->texcoords[3 * k + c].u == corners[c].x);
            assert_true(desc->texcoords[3 * k + c].v == corners[c].y);
            assert_int_equal(desc->normals[3 * k + c], ls_octahedral_encode(p));
        }
    }
    assert_true(moved);
    ls_pack_destroy(&pack);
    ls_world_destroy(&world);
    end_input(&input);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_positions_are_one),
        cmocka_unit_test(welding_many),
        cmocka_unit_test(welding_can_be_switched_off),
        cmocka_unit_test(flat_faces_are_dropped_or_kept),
        cmocka_unit_test(a_mesh_of_flat_faces_keeps_none),
        cmocka_unit_test(octahedral_error_is_bounded),
        cmocka_unit_test(smooth_normals_bridge_an_angle),
        cmocka_unit_test(smooth_normals_follow_a_sphere),
        cmocka_unit_test(crowded_vertices_stay_flat),
        cmocka_unit_test(given_normals_are_taken_or_left_out),
        cmocka_unit_test(warnings_name_the_mesh),
        cmocka_unit_test(errors_have_numbers),
        cmocka_unit_test(transforms_have_numbers),
        cmocka_unit_test(lights_beyond_counting),
        cmocka_unit_test(plain_scenes_have_no_looks),
        cmocka_unit_test(used_looks_are_packed_in_order),
        cmocka_unit_test(looks_follow_their_triangles),
    };
    return cmocka_run_group_tests_name("mesh", tests, NULL, NULL);
}
