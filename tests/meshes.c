#include "meshes.h"

#include "test_random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

const char* ls_test_mesh_name(LsTestMeshId id)
{
    static const char* const names[] = {
#define LS_TEST_MESH_TEXT(name, text) text,
        LS_TEST_MESH_LIST(LS_TEST_MESH_TEXT)
#undef LS_TEST_MESH_TEXT
    };
    return names[id];
}

// ---- Building blocks ----------------------------------------------------------------------------

static LsTestMesh make_empty(uint32_t vertex_count, uint32_t triangle_count)
{
    LsTestMesh mesh = {.vertex_count = vertex_count, .triangle_count = triangle_count};
    mesh.positions = calloc(vertex_count, 3 * sizeof(float));
    mesh.indices = calloc(triangle_count, 3 * sizeof(uint32_t));
    assert_true(mesh.positions && mesh.indices);
    return mesh;
}

void ls_test_mesh_destroy(LsTestMesh* mesh)
{
    free(mesh->positions);
    free(mesh->indices);
    *mesh = (LsTestMesh){.positions = NULL};
}

static void set_vertex(LsTestMesh* mesh, uint32_t vertex, double x, double y, double z)
{
    mesh->positions[3 * vertex] = (float)x;
    mesh->positions[3 * vertex + 1] = (float)y;
    mesh->positions[3 * vertex + 2] = (float)z;
}

static void set_triangle(LsTestMesh* mesh, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c)
{
    mesh->indices[3 * triangle] = a;
    mesh->indices[3 * triangle + 1] = b;
    mesh->indices[3 * triangle + 2] = c;
}

// Two triangles for each cell of a sheet of (columns + 1) x (rows + 1) vertices in row order.
static void weave_sheet(LsTestMesh* mesh, uint32_t first_vertex, uint32_t first_triangle,
                        uint32_t columns, uint32_t rows)
{
    for (uint32_t row = 0; row < rows; row++)
    {
        for (uint32_t column = 0; column < columns; column++)
        {
            uint32_t a = first_vertex + row * (columns + 1) + column;
            uint32_t triangle = first_triangle + 2 * (row * columns + column);
            set_triangle(mesh, triangle, a, a + 1, a + columns + 2);
            set_triangle(mesh, triangle + 1, a, a + columns + 2, a + columns + 1);
        }
    }
}

static void transform_mesh(LsTestMesh* mesh, double scale, double x, double y, double z)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
    {
        const float* p = mesh->positions + 3 * i;
        set_vertex(mesh, i, p[0] * scale + x, p[1] * scale + y, p[2] * scale + z);
    }
}

static LsTestMesh join_meshes(LsTestMesh* a, LsTestMesh* b)
{
    LsTestMesh mesh =
        make_empty(a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
    memcpy(mesh.positions, a->positions, 3 * a->vertex_count * sizeof(float));
    memcpy(mesh.positions + 3 * a->vertex_count, b->positions, 3 * b->vertex_count * sizeof(float));
    memcpy(mesh.indices, a->indices, 3 * a->triangle_count * sizeof(uint32_t));
    for (uint32_t i = 0; i < 3 * b->triangle_count; i++)
    {
        mesh.indices[3 * a->triangle_count + i] = b->indices[i] + a->vertex_count;
    }
    ls_test_mesh_destroy(a);
    ls_test_mesh_destroy(b);
    return mesh;
}

// ---- Loaded -------------------------------------------------------------------------------------

// Reads the PLY files of this repository: binary little-endian, three floats a vertex, triangles.
static LsTestMesh load_ply(const char* path)
{
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    char line[256];
    uint32_t vertex_count = 0, triangle_count = 0;
    while (fgets(line, sizeof line, file) && strcmp(line, "end_header\n") != 0)
    {
        unsigned count;
        if (sscanf(line, "element vertex %u", &count) == 1)
        {
            vertex_count = count;
        }
        else if (sscanf(line, "element face %u", &count) == 1)
        {
            triangle_count = count;
        }
    }
    LsTestMesh mesh = make_empty(vertex_count, triangle_count);
    assert_int_equal(fread(mesh.positions, 3 * sizeof(float), vertex_count, file), vertex_count);
    for (uint32_t i = 0; i < triangle_count; i++)
    {
        assert_int_equal(fgetc(file), 3);
        assert_int_equal(fread(mesh.indices + 3 * i, sizeof(uint32_t), 3, file), 3);
    }
    fclose(file);
    return mesh;
}

static void weigh_bernstein(double t, double weights[4])
{
    double r = 1.0 - t;
    weights[0] = r * r * r;
    weights[1] = 3.0 * r * r * t;
    weights[2] = 3.0 * r * t * t;
    weights[3] = t * t * t;
}

// 64 n^2 triangles of the teapot's patches; those at the cusps have no area.
static LsTestMesh tessellate_teapot(uint32_t n)
{
    FILE* file = fopen(LS_SOURCE_DIR "/tests/data/teapot.txt", "r");
    assert_non_null(file);
    char line[256];
    uint32_t patch_count = 0, point_count = 0;
    while (patch_count == 0 && fgets(line, sizeof line, file))
    {
        sscanf(line, "%u %u", &patch_count, &point_count);
    }
    assert_int_equal(patch_count, 32);
    uint32_t patches[32][16];
    double points[400][3];
    assert_true(point_count <= 400);
    for (uint32_t i = 0; i < 32 * 16; i++)
    {
        assert_int_equal(fscanf(file, "%u", &patches[i / 16][i % 16]), 1);
        assert_true(patches[i / 16][i % 16] < point_count);
    }
    for (uint32_t i = 0; i < point_count; i++)
    {
        assert_int_equal(fscanf(file, "%lf %lf %lf", &points[i][0], &points[i][1], &points[i][2]),
                         3);
    }
    fclose(file);

    LsTestMesh mesh = make_empty(32 * (n + 1) * (n + 1), 32 * 2 * n * n);
    for (uint32_t patch = 0; patch < 32; patch++)
    {
        uint32_t first = patch * (n + 1) * (n + 1);
        for (uint32_t vertex = 0; vertex < (n + 1) * (n + 1); vertex++)
        {
            double u[4], v[4], p[3] = {0.0, 0.0, 0.0};
            weigh_bernstein((double)(vertex % (n + 1)) / n, u);
            weigh_bernstein((double)(vertex / (n + 1)) / n, v);
            for (uint32_t i = 0; i < 16; i++)
            {
                for (uint32_t axis = 0; axis < 3; axis++)
                {
                    p[axis] += v[i / 4] * u[i % 4] * points[patches[patch][i]][axis];
                }
            }
            set_vertex(&mesh, first + vertex, p[0], p[1], p[2]);
        }
        weave_sheet(&mesh, first, patch * 2 * n * n, n, n);
    }
    return mesh;
}

// ---- Made ---------------------------------------------------------------------------------------

// The surface of a cube of side `side` from `lower` on, `n` cells along each edge, seen from
// outside or, turned, from inside. Faces share their border vertices.
static LsTestMesh make_cube(uint32_t n, double lower, double side, bool turned)
{
    uint32_t lattice = (n + 1) * (n + 1) * (n + 1);
    uint32_t* number = malloc(lattice * sizeof *number);
    assert_non_null(number);
    LsTestMesh mesh = make_empty(6 * n * n + 2, 12 * n * n);
    uint32_t vertex = 0, triangle = 0;
    for (uint32_t i = 0; i < lattice; i++)
    {
        uint32_t x = i % (n + 1), y = i / (n + 1) % (n + 1), z = i / (n + 1) / (n + 1);
        if (x % n == 0 || y % n == 0 || z % n == 0)
        {
            number[i] = vertex;
            set_vertex(&mesh, vertex++, lower + side * x / n, lower + side * y / n,
                       lower + side * z / n);
        }
    }
    const uint32_t steps[3] = {1, n + 1, (n + 1) * (n + 1)};
    for (uint32_t face = 0; face < 6; face++)
    {
        uint32_t axis = face / 2;
        uint32_t u = steps[(axis + 1) % 3], v = steps[(axis + 2) % 3];
        for (uint32_t cell = 0; cell < n * n; cell++)
        {
            uint32_t a = (face % 2) * n * steps[axis] + cell % n * u + cell / n * v;
            uint32_t b = (face % 2 == 1) != turned ? a + u : a + v;
            uint32_t c = (face % 2 == 1) != turned ? a + v : a + u;
            set_triangle(&mesh, triangle++, number[a], number[b], number[a + u + v]);
            set_triangle(&mesh, triangle++, number[a], number[a + u + v], number[c]);
        }
    }
    free(number);
    return mesh;
}

static LsTestMesh make_shell(void)
{
    LsTestMesh outer = make_cube(8, 0.0, 1.0, false);
    LsTestMesh inner = make_cube(8, 1e-4, 1.0 - 2e-4, true);
    return join_meshes(&outer, &inner);
}

static LsTestMesh make_sheets(void)
{
    const uint32_t n = 24;
    LsTestMesh mesh = make_empty(2 * (n + 1) * (n + 1), 4 * n * n);
    for (uint32_t i = 0; i < 2 * (n + 1) * (n + 1); i++)
    {
        uint32_t sheet = i / ((n + 1) * (n + 1));
        double x = (double)(i % (n + 1)) / n;
        double y = (double)(i / (n + 1) % (n + 1)) / n;
        // Polynomials, so that no library function decides a bit.
        double z = 0.2 * x * (1.0 - x) * (0.5 - y) + 0.05 * y * y;
        set_vertex(&mesh, i, x, y, z + 1e-5 * sheet);
    }
    weave_sheet(&mesh, 0, 0, n, n);
    weave_sheet(&mesh, (n + 1) * (n + 1), 2 * n * n, n, n);
    return mesh;
}

static LsTestMesh make_slivers(void)
{
    const uint32_t count = 2400;
    LsRandom random = {5};
    LsTestMesh mesh = make_empty(3 * count, count);
    for (uint32_t i = 0; i < count; i++)
    {
        double p[3][3];
        double width = pow(10.0, -(double)ls_random_below(&random, 7));
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            p[0][axis] = ls_random_unit(&random);
            p[1][axis] = p[0][axis] + 0.3 * ls_random_between(&random, -1.0, 1.0);
            p[2][axis] = p[0][axis] + 0.3 * width * ls_random_between(&random, -1.0, 1.0);
        }
        bool coplanar = i % 5 == 1;
        bool duplicate = i % 7 == 2;
        bool lengthwise = i % 11 == 3; // a short side in the middle of a long one
        for (uint32_t corner = 0; corner < 3; corner++)
        {
            double z = coplanar ? 0.25 * (i % 3 + 1) : p[corner][2];
            double w = lengthwise && corner == 2 ? 0.5 : 0.0;
            set_vertex(&mesh, 3 * i + corner, (1.0 - w) * p[corner][0] + w * p[1][0],
                       (1.0 - w) * p[corner][1] + w * p[1][1], (1.0 - w) * z + w * p[1][2]);
        }
        if (duplicate)
        {
            uint32_t other = ls_random_below(&random, i);
            memcpy(mesh.positions + 9 * i, mesh.positions + 9 * other, 9 * sizeof(float));
        }
        // Duplicates in each of the three rotations and in both windings.
        uint32_t turn = ls_random_below(&random, 3), flip = ls_random_below(&random, 2);
        set_triangle(&mesh, i, 3 * i + turn, 3 * i + (turn + 1 + flip) % 3,
                     3 * i + (turn + 2 - flip) % 3);
    }
    return mesh;
}

static LsTestMesh make_hub(void)
{
    const uint32_t count = 3000;
    LsRandom random = {6};
    LsTestMesh mesh = make_empty(1 + 2 * count, count);
    set_vertex(&mesh, 0, 0.3, 0.4, 0.5);
    for (uint32_t i = 0; i < count; i++)
    {
        double p[3];
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            p[axis] = ls_random_unit(&random);
        }
        set_vertex(&mesh, 1 + 2 * i, p[0], p[1], p[2]);
        set_vertex(&mesh, 2 + 2 * i, p[0] + 0.05 * ls_random_unit(&random),
                   p[1] + 0.05 * ls_random_unit(&random), p[2] + 0.05 * ls_random_unit(&random));
        set_triangle(&mesh, i, 0, 1 + 2 * i, 2 + 2 * i);
    }
    return mesh;
}

static LsTestMesh make_fan(void)
{
    const uint32_t count = 100;
    LsTestMesh mesh = make_empty(count + 2, count);
    for (uint32_t i = 0; i <= count; i++)
    {
        double along = (double)i / count;
        set_vertex(&mesh, i + 1, 1.0, 1e-4 * along, 0.01 * along * along);
    }
    for (uint32_t i = 0; i < count; i++)
    {
        set_triangle(&mesh, i, 0, i + 1, i + 2);
    }
    return mesh;
}

static LsTestMesh make_one(void)
{
    LsTestMesh mesh = make_empty(3, 1);
    set_vertex(&mesh, 0, -0.3, 0.1, 0.2);
    set_vertex(&mesh, 1, 0.9, -0.2, 0.4);
    set_vertex(&mesh, 2, 0.2, 0.8, -0.1);
    set_triangle(&mesh, 0, 0, 1, 2);
    return mesh;
}

static LsTestMesh make_flat(void)
{
    const uint32_t n = 20;
    LsTestMesh mesh = make_empty((n + 1) * (n + 1), 2 * n * n);
    for (uint32_t i = 0; i < (n + 1) * (n + 1); i++)
    {
        set_vertex(&mesh, i, (double)(i % (n + 1)) / n, 0.25, (double)(i / (n + 1)) / n);
    }
    weave_sheet(&mesh, 0, 0, n, n);
    return mesh;
}

static LsTestMesh make_stadium(void)
{
    const uint32_t columns = 48, rows = 12;
    LsTestMesh bowl = make_empty((columns + 1) * (rows + 1), 2 * columns * rows);
    for (uint32_t i = 0; i < bowl.vertex_count; i++)
    {
        // Once round a rational circle: no sine, no cosine.
        double t = 4.0 * (i % (columns + 1)) / columns;
        uint32_t quarter = (uint32_t)t % 4;
        double h = t - (uint32_t)t;
        double a = (1.0 - h * h) / (1.0 + h * h), b = 2.0 * h / (1.0 + h * h);
        double x = quarter == 0 ? a : quarter == 1 ? -b : quarter == 2 ? -a : b;
        double y = quarter == 0 ? b : quarter == 1 ? a : quarter == 2 ? -b : -a;
        uint32_t row = i / (columns + 1);
        double radius = 60.0 + 4.0 * (row / 2);
        set_vertex(&bowl, i, radius * x, 0.8 * radius * y, 3.0 * ((row + 1) / 2));
    }
    weave_sheet(&bowl, 0, 0, columns, rows);
    LsTestMesh teapot = tessellate_teapot(5);
    transform_mesh(&teapot, 0.03, 7.0, -3.0, 0.1);
    return join_meshes(&bowl, &teapot);
}

// Of four faces three have no area: a point, a segment whose ends are two corners and one, and three corners
// on a line, exactly so by their few bits, in every order; many a one crosses cells.
static LsTestMesh make_stray(void)
{
    const uint32_t count = 1600;
    LsRandom random = {9};
    LsTestMesh mesh = make_empty(3 * count, count);
    mesh.keep_degenerate = true;
    for (uint32_t i = 0; i < count; i++)
    {
        double p[3][3];
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            p[0][axis] = ls_random_below(&random, 1024);
            double step = (double)ls_random_below(&random, 101) - 50.0;
            // A third of the lines run along an axis.
            step = i % 3 == 0 && axis != i / 3 % 3 ? 0.0 : step;
            p[1][axis] = p[0][axis] + 2.0 * step;
            p[2][axis] = p[0][axis] + 3.0 * step;
        }
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            p[1][axis] = i % 4 == 1 ? p[0][axis] : p[1][axis];
            p[2][axis] = i % 4 == 1 || i % 4 == 2 ? p[0][axis] : p[2][axis];
            p[2][axis] += i % 4 == 0 ? (double)ls_random_below(&random, 101) - 50.0 : 0.0;
        }
        for (uint32_t corner = 0; corner < 3; corner++)
        {
            set_vertex(&mesh, 3 * i + corner, p[corner][0] / 1024.0, p[corner][1] / 1024.0,
                       p[corner][2] / 1024.0);
        }
        uint32_t turn = ls_random_below(&random, 3);
        set_triangle(&mesh, i, 3 * i + turn, 3 * i + (turn + 1) % 3, 3 * i + (turn + 2) % 3);
    }
    return mesh;
}

LsTestMesh ls_test_mesh_make(LsTestMeshId id)
{
    LsTestMesh mesh = {.positions = NULL};
    switch (id)
    {
    case LS_TEST_MESH_BUNNY:
        return load_ply(LS_SOURCE_DIR "/scenes/bunny.ply");
    case LS_TEST_MESH_ELEPHANT:
        return load_ply(LS_SOURCE_DIR "/tests/data/elephant.ply");
    case LS_TEST_MESH_TEAPOT:
        return tessellate_teapot(6);
    case LS_TEST_MESH_SHELL:
        return make_shell();
    case LS_TEST_MESH_SHEETS:
        return make_sheets();
    case LS_TEST_MESH_SLIVERS:
        return make_slivers();
    case LS_TEST_MESH_HUB:
        return make_hub();
    case LS_TEST_MESH_FAN:
        return make_fan();
    case LS_TEST_MESH_ONE:
        return make_one();
    case LS_TEST_MESH_FLAT:
        return make_flat();
    case LS_TEST_MESH_STADIUM:
        return make_stadium();
    case LS_TEST_MESH_MICRO:
        mesh = tessellate_teapot(4);
        transform_mesh(&mesh, 1e-6, 0.0, 0.0, 0.0);
        return mesh;
    case LS_TEST_MESH_MEGA:
        mesh = tessellate_teapot(4);
        transform_mesh(&mesh, 1e6, 0.0, 0.0, 0.0);
        return mesh;
    case LS_TEST_MESH_FAR:
        mesh = tessellate_teapot(4);
        transform_mesh(&mesh, 1.0, 6e4, -3e4, 5e3);
        return mesh;
    case LS_TEST_MESH_STRAY:
        return make_stray();
    case LS_TEST_MESH_COUNT:
        break;
    }
    fail_msg("no such mesh");
    return mesh;
}

// ---- Asked --------------------------------------------------------------------------------------

static int compare_edges(const void* a, const void* b)
{
    const uint64_t x = *(const uint64_t*)a;
    const uint64_t y = *(const uint64_t*)b;
    return x < y ? -1 : x > y;
}

bool ls_test_mesh_is_closed(const LsTestMesh* mesh)
{
    uint32_t count = 3 * mesh->triangle_count;
    uint64_t* edges = malloc(count * sizeof *edges);
    assert_non_null(edges);
    for (uint32_t i = 0; i < count; i++)
    {
        uint32_t from = mesh->indices[i];
        uint32_t to = mesh->indices[i % 3 == 2 ? i - 2 : i + 1];
        edges[i] = (uint64_t)from << 32 | to;
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    bool closed = true;
    for (uint32_t i = 0; i < count && closed; i++)
    {
        uint64_t reversed = edges[i] << 32 | edges[i] >> 32;
        closed = (i == 0 || edges[i] != edges[i - 1]) &&
                 bsearch(&reversed, edges, count, sizeof *edges, compare_edges);
    }
    free(edges);
    return closed;
}

void ls_test_mesh_bounds(const LsTestMesh* mesh, float lower[3], float upper[3])
{
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        lower[axis] = INFINITY;
        upper[axis] = -INFINITY;
        for (uint32_t i = 0; i < mesh->vertex_count; i++)
        {
            lower[axis] = fminf(lower[axis], mesh->positions[3 * i + axis]);
            upper[axis] = fmaxf(upper[axis], mesh->positions[3 * i + axis]);
        }
    }
}

// Six times the signed volume of the tetrahedron p a b c.
static double measure_volume(const double* p, const double* a, const double* b, const double* c)
{
    double x[3], y[3], z[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        x[axis] = a[axis] - p[axis];
        y[axis] = b[axis] - p[axis];
        z[axis] = c[axis] - p[axis];
    }
    return x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) +
           x[2] * (y[0] * z[1] - y[1] * z[0]);
}

static bool crosses(const LsTestMesh* mesh, uint32_t triangle, const double p[3], const double q[3])
{
    double corners[3][3];
    for (uint32_t i = 0; i < 9; i++)
    {
        corners[i / 3][i % 3] = mesh->positions[3 * mesh->indices[3 * triangle + i / 3] + i % 3];
    }
    double from = measure_volume(p, corners[0], corners[1], corners[2]);
    double to = measure_volume(q, corners[0], corners[1], corners[2]);
    if ((from > 0.0) == (to > 0.0))
    {
        return false;
    }
    bool u = measure_volume(p, q, corners[0], corners[1]) > 0.0;
    bool v = measure_volume(p, q, corners[1], corners[2]) > 0.0;
    bool w = measure_volume(p, q, corners[2], corners[0]) > 0.0;
    return u == v && v == w;
}

bool ls_test_mesh_contains(const LsTestMesh* mesh, const double point[3])
{
    float lower[3], upper[3];
    ls_test_mesh_bounds(mesh, lower, upper);
    static const double ways[3][3] = {{3.1, 1.7, 2.3}, {-2.2, 3.3, 1.9}, {1.3, -1.6, -3.7}};
    for (uint32_t way = 0; way < 3; way++)
    {
        double away[3];
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            away[axis] = point[axis] + ways[way][axis] * (upper[0] - lower[0] + upper[1] -
                                                          lower[1] + upper[2] - lower[2]);
        }
        uint32_t crossings = 0;
        for (uint32_t triangle = 0; triangle < mesh->triangle_count; triangle++)
        {
            crossings += crosses(mesh, triangle, point, away);
        }
        if (crossings % 2 == 0)
        {
            return false;
        }
    }
    return true;
}

// ---- Written ------------------------------------------------------------------------------------

void ls_test_mesh_write_ply(const LsTestMesh* mesh, const char* path)
{
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\n"
            "property float y\nproperty float z\nelement face %u\n"
            "property list uchar int vertex_indices\nend_header\n",
            mesh->vertex_count, mesh->triangle_count);
    fwrite(mesh->positions, 3 * sizeof(float), mesh->vertex_count, file);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        fputc(3, file);
        fwrite(mesh->indices + 3 * i, sizeof(uint32_t), 3, file);
    }
    assert_int_equal(fclose(file), 0);
}

static void write_matrix(FILE* file, const double m[3][4], bool last)
{
    fprintf(file, "{\"mesh\":0,\"matrix\":[");
    for (uint32_t column = 0; column < 4; column++)
    {
        fprintf(file, "%.9g,%.9g,%.9g,%d%s", m[0][column], m[1][column], m[2][column], column == 3,
                column < 3 ? "," : "");
    }
    fprintf(file, "]}%s\n", last ? "" : ",");
}

// Columns of a rotation times factors, turning the mesh about its middle and placing that at
// `place`.
static void place_mesh(double m[3][4], const double factors[3], double qx, double qy, double qz,
                       double qw, const double middle[3], const double place[3])
{
    double norm = 2.0 / (qx * qx + qy * qy + qz * qz + qw * qw);
    const double r[3][3] = {
        {1.0 - norm * (qy * qy + qz * qz), norm * (qx * qy - qz * qw), norm * (qx * qz + qy * qw)},
        {norm * (qx * qy + qz * qw), 1.0 - norm * (qx * qx + qz * qz), norm * (qy * qz - qx * qw)},
        {norm * (qx * qz - qy * qw), norm * (qy * qz + qx * qw), 1.0 - norm * (qx * qx + qy * qy)},
    };
    for (uint32_t row = 0; row < 3; row++)
    {
        m[row][3] = place[row];
        for (uint32_t column = 0; column < 3; column++)
        {
            m[row][column] = r[row][column] * factors[column];
            m[row][3] -= m[row][column] * middle[column];
        }
    }
}

void ls_test_mesh_write_gltf(const LsTestMesh* mesh, const char* path)
{
    char bin_path[1024];
    size_t stem = strlen(path) - strlen(".gltf");
    assert_true(stem + 5 < sizeof bin_path);
    snprintf(bin_path, sizeof bin_path, "%.*s.bin", (int)stem, path);
    FILE* bin = fopen(bin_path, "wb");
    assert_non_null(bin);
    fwrite(mesh->positions, 3 * sizeof(float), mesh->vertex_count, bin);
    fwrite(mesh->indices, 3 * sizeof(uint32_t), mesh->triangle_count, bin);
    assert_int_equal(fclose(bin), 0);

    float lower[3], upper[3];
    ls_test_mesh_bounds(mesh, lower, upper);
    double middle[3], size = 0.0;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        middle[axis] = 0.5 * ((double)lower[axis] + upper[axis]);
        size = fmax(size, (double)upper[axis] - lower[axis]);
    }

    FILE* file = fopen(path, "w");
    assert_non_null(file);
    const char* name = strrchr(bin_path, '/') ? strrchr(bin_path, '/') + 1 : bin_path;
    uint32_t position_bytes = 12 * mesh->vertex_count, index_bytes = 12 * mesh->triangle_count;
    fprintf(
        file,
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2,3]}],\n"
        "\"buffers\":[{\"uri\":\"%s\",\"byteLength\":%u}],\n"
        "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":%u},"
        "{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u}],\n"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\","
        "\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]},"
        "{\"bufferView\":1,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}],\n"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\n"
        "\"nodes\":[\n{\"mesh\":0},\n",
        name, position_bytes + index_bytes, position_bytes, position_bytes, index_bytes,
        mesh->vertex_count, lower[0], lower[1], lower[2], upper[0], upper[1], upper[2],
        3 * mesh->triangle_count);
    double m[3][4];
    const double turned[3] = {middle[0] + 0.9 * size, middle[1] + 0.2 * size, middle[2]};
    place_mesh(m, (double[3]){1.0, 1.0, 1.0}, 0.3, -0.5, 0.2, 0.8, middle, turned);
    write_matrix(file, m, false);
    const double stretched[3] = {middle[0] - 0.3 * size, middle[1] + 1.1 * size,
                                 middle[2] - 0.4 * size};
    place_mesh(m, (double[3]){1.7, 0.3, 0.9}, -0.4, 0.1, 0.7, 0.5, middle, stretched);
    write_matrix(file, m, false);
    const double mirrored[3] = {middle[0] + 0.1 * size, middle[1] - 0.2 * size,
                                middle[2] + 0.8 * size};
    place_mesh(m, (double[3]){-1.0, 1.0, 1.0}, 0.6, 0.6, -0.1, 0.3, middle, mirrored);
    write_matrix(file, m, true);
    fprintf(file, "]}\n");
    assert_int_equal(fclose(file), 0);
}
