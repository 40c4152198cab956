#include "hard_meshes.h"

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
// clang-format on

#include "test_random.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

static LsTestMesh allocate(uint32_t vertices, uint32_t triangles)
{
    LsTestMesh mesh = {.vertex_count = vertices, .triangle_count = triangles};
    mesh.positions = calloc(3 * (size_t)vertices, sizeof(float));
    mesh.indices = calloc(3 * (size_t)triangles, sizeof(uint32_t));
    assert_non_null(mesh.positions);
    assert_non_null(mesh.indices);
    return mesh;
}

static void put_vertex(LsTestMesh* mesh, uint32_t vertex, double x, double y, double z)
{
    float* p = mesh->positions + 3 * (size_t)vertex;
    p[0] = (float)x;
    p[1] = (float)y;
    p[2] = (float)z;
}

static void put_triangle(LsTestMesh* mesh, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t* corners = mesh->indices + 3 * (size_t)triangle;
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

// Each triangle with corners of its own.
static LsTestMesh allocate_soup(uint32_t triangles)
{
    LsTestMesh mesh = allocate(3 * triangles, triangles);
    for (uint32_t i = 0; i < triangles; i++)
    {
        put_triangle(&mesh, i, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

// A triangle about a point, its corners at most `size` away along each axis.
static void put_speck(LsTestMesh* mesh, uint32_t triangle, LsRandom* random, const double at[3],
                      double size)
{
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        double p[3];
        for (int axis = 0; axis < 3; axis++)
        {
            p[axis] = at[axis] + size * ls_random_between(random, -1.0, 1.0);
        }
        put_vertex(mesh, 3 * triangle + corner, p[0], p[1], p[2]);
    }
}

// Squares of side x side, two triangles each, from vertex and triangle on.
static void put_sheet(LsTestMesh* mesh, uint32_t vertex, uint32_t triangle, uint32_t side,
                      double size, double z)
{
    for (uint32_t y = 0; y <= side; y++)
    {
        for (uint32_t x = 0; x <= side; x++)
        {
            put_vertex(mesh, vertex + y * (side + 1) + x, size * ((double)x / side - 0.5),
                       size * ((double)y / side - 0.5), z);
        }
    }
    for (uint32_t y = 0; y < side; y++)
    {
        for (uint32_t x = 0; x < side; x++)
        {
            const uint32_t a = vertex + y * (side + 1) + x;
            put_triangle(mesh, triangle++, a, a + 1, a + side + 2);
            put_triangle(mesh, triangle++, a, a + side + 2, a + side + 1);
        }
    }
}

static uint32_t count_ball_vertices(uint32_t rings)
{
    return 2 * (rings + 1) * rings;
}

static uint32_t count_ball_triangles(uint32_t rings)
{
    return 4 * rings * rings;
}

// From vertex and triangle on.
static void put_ball(LsTestMesh* mesh, uint32_t vertex, uint32_t triangle, uint32_t rings,
                     const double middle[3], double radius)
{
    const uint32_t sectors = 2 * rings;
    for (uint32_t ring = 0; ring <= rings; ring++)
    {
        for (uint32_t sector = 0; sector < sectors; sector++)
        {
            const double u = PI * ring / rings, v = 2.0 * PI * sector / sectors;
            put_vertex(mesh, vertex + ring * sectors + sector, middle[0] + radius * sin(u) * cos(v),
                       middle[1] + radius * sin(u) * sin(v), middle[2] + radius * cos(u));
            if (ring < rings)
            {
                const uint32_t next = (sector + 1) % sectors;
                const uint32_t a = vertex + ring * sectors, b = a + sectors;
                put_triangle(mesh, triangle++, a + sector, b + sector, b + next);
                put_triangle(mesh, triangle++, a + sector, b + next, a + next);
            }
        }
    }
}

static LsTestMesh make_stadium(uint32_t count)
{
    enum
    {
        FLOOR = 10
    };
    const uint32_t rings = (uint32_t)sqrt(count / 4.0) + 2;
    const uint32_t ball = count_ball_vertices(rings), ball_triangles = count_ball_triangles(rings);
    LsTestMesh mesh =
        allocate(ball + (FLOOR + 1) * (FLOOR + 1), ball_triangles + 2 * FLOOR * FLOOR);
    put_ball(&mesh, 0, 0, rings, (const double[3]){0}, 1.0);
    put_sheet(&mesh, ball, ball_triangles, FLOOR, 20000.0, -1.01);
    return mesh;
}

static LsTestMesh make_dust(uint32_t count, LsRandom* random, double spread, double size)
{
    LsTestMesh mesh = allocate_soup(count);
    for (uint32_t i = 0; i < count; i++)
    {
        const double at[3] = {spread * ls_random_unit(random), spread * ls_random_unit(random),
                              spread * ls_random_unit(random)};
        put_speck(&mesh, i, random, at, size);
    }
    return mesh;
}

static LsTestMesh make_span(uint32_t count, LsRandom* random)
{
    LsTestMesh mesh = make_dust(count, random, 1.0, 0.5 / sqrt(count));
    put_vertex(&mesh, 0, -5.0, -5.0, -5.0);
    put_vertex(&mesh, 1, 8.0, 6.0, 5.0);
    put_vertex(&mesh, 2, -4.0, 9.0, 8.0);
    return mesh;
}

static LsTestMesh make_cluster(uint32_t count, LsRandom* random)
{
    LsTestMesh mesh = make_dust(count, random, 1e-3, 1e-3 / sqrt(count));
    for (uint32_t i = 0; i < 2; i++)
    {
        put_vertex(&mesh, 3 * i, -0.5, -0.5, i - 0.5);
        put_vertex(&mesh, 3 * i + 1, 0.5, -0.5, i - 0.5);
        put_vertex(&mesh, 3 * i + 2, -0.5, 0.5, i - 0.5);
    }
    return mesh;
}

static LsTestMesh make_hub(uint32_t count, LsRandom* random)
{
    LsTestMesh mesh = allocate(2 * count + 1, count);
    for (uint32_t i = 0; i < count; i++)
    {
        const double z = ls_random_between(random, -1.0, 1.0);
        const double turn = 2.0 * PI * ls_random_unit(random);
        const double r = sqrt(1.0 - z * z);
        put_vertex(&mesh, 1 + 2 * i, r * cos(turn), r * sin(turn), z);
        put_vertex(&mesh, 2 + 2 * i, r * cos(turn + 0.02), r * sin(turn + 0.02), z);
        put_triangle(&mesh, i, 0, 1 + 2 * i, 2 + 2 * i);
    }
    return mesh;
}

static LsTestMesh make_edge(uint32_t count)
{
    LsTestMesh mesh = allocate(count + 2, count);
    put_vertex(&mesh, 1, 0.0, 0.0, 1.0);
    for (uint32_t i = 0; i < count; i++)
    {
        const double turn = 2.0 * PI * i / count;
        put_vertex(&mesh, 2 + i, cos(turn), sin(turn), 0.5);
        put_triangle(&mesh, i, 0, 1, 2 + i);
    }
    return mesh;
}

static LsTestMesh make_layers(uint32_t count, uint32_t layers)
{
    const uint32_t side = (uint32_t)sqrt(count / 2.0 / layers) + 1;
    const uint32_t vertices = (side + 1) * (side + 1), triangles = 2 * side * side;
    LsTestMesh mesh = allocate(layers * vertices, layers * triangles);
    for (uint32_t i = 0; i < layers; i++)
    {
        put_sheet(&mesh, i * vertices, i * triangles, side, 1.0, 0.0);
    }
    return mesh;
}

static LsTestMesh make_equal(uint32_t count)
{
    LsTestMesh mesh = allocate(3, count);
    put_vertex(&mesh, 0, 0.0, 0.0, 0.0);
    put_vertex(&mesh, 1, 1.0, 0.1, 0.2);
    put_vertex(&mesh, 2, 0.3, 1.0, 0.7);
    for (uint32_t i = 0; i < count; i++)
    {
        put_triangle(&mesh, i, 0, 1, 2);
    }
    return mesh;
}

static LsTestMesh make_needles(uint32_t count, LsRandom* random)
{
    LsTestMesh mesh = allocate_soup(count);
    for (uint32_t i = 0; i < count; i++)
    {
        double p[2][3];
        for (int k = 0; k < 6; k++)
        {
            p[k / 3][k % 3] = ls_random_unit(random);
        }
        put_vertex(&mesh, 3 * i, p[0][0], p[0][1], p[0][2]);
        put_vertex(&mesh, 3 * i + 1, p[1][0], p[1][1], p[1][2]);
        put_vertex(&mesh, 3 * i + 2, p[1][0] + 1e-5, p[1][1] - 1e-5, p[1][2]);
    }
    return mesh;
}

// Along a spiral, so that none lies in another.
static LsTestMesh make_sizes(uint32_t count)
{
    enum
    {
        BALLS = 12
    };
    const uint32_t rings = (uint32_t)sqrt(count / 4.0 / BALLS) + 2;
    const uint32_t vertices = count_ball_vertices(rings), triangles = count_ball_triangles(rings);
    LsTestMesh mesh = allocate(BALLS * vertices, BALLS * triangles);
    double radius = 1.0;
    for (uint32_t i = 0; i < BALLS; i++)
    {
        const double middle[3] = {4.0 * cos(0.9 * i), 4.0 * sin(0.9 * i), 0.3 * i};
        put_ball(&mesh, i * vertices, i * triangles, rings, middle, radius);
        radius *= 0.6;
    }
    return mesh;
}

const char* ls_hard_mesh_name(LsHardMeshId id)
{
    static const char* const names[] = {
#define LS_HARD_MESH_TEXT(name, text) text,
        LS_HARD_MESH_LIST(LS_HARD_MESH_TEXT)
#undef LS_HARD_MESH_TEXT
    };
    return names[id];
}

LsTestMesh ls_hard_mesh_make(LsHardMeshId id, uint32_t count)
{
    LsRandom random = {id};
    switch (id)
    {
    case LS_HARD_MESH_STADIUM:
        return make_stadium(count);
    case LS_HARD_MESH_SPAN:
        return make_span(count, &random);
    case LS_HARD_MESH_CLUSTER:
        return make_cluster(count, &random);
    case LS_HARD_MESH_HUB:
        return make_hub(count, &random);
    case LS_HARD_MESH_EDGE:
        return make_edge(count);
    case LS_HARD_MESH_FLAT:
        return make_layers(count, 1);
    case LS_HARD_MESH_LAYERS:
        return make_layers(count, 10);
    case LS_HARD_MESH_EQUAL:
        return make_equal(count);
    case LS_HARD_MESH_SIZES:
        return make_sizes(count);
    default:
        return make_needles(count, &random);
    }
}
