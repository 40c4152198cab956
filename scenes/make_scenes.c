// make_scenes.c - writes the bundled scenes; kept to show where their bytes come from.
//
//     cc -std=c17 -ffp-contract=off make_scenes.c -lm -o make_scenes
//     ./make_scenes FOLDER                      cornell.gltf, cornell_blocks.gltf, stage.gltf
//     ./make_scenes FOLDER bunny BUNNY.obj      bunny.ply, from /usr/share/glmark2/models/bunny.obj
//     ./make_scenes FOLDER teapot TEAPOT.txt N  teapot.ply, 64 N^2 triangles, from tests/data/teapot.txt
//
// bunny.ply: vertices and faces in the order of the OBJ, scaled to 1.2 along the longest extent,
// centred in x and z, standing on y = -1. cornell.gltf: a box [-1,1]^3 open at z = 1, with a light
// and a camera; cornell_blocks.gltf: the same with two blocks. stage.gltf: a plane at y = -1, three
// lights, a camera. teapot.ply: as the patches are, z up.

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fail(const char* what)
{
    fprintf(stderr, "make_scenes: %s\n", what);
    exit(1);
}

static FILE* open_file(const char* folder, const char* name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE* file = fopen(path, "wb");
    if (!file)
        fail("cannot write");
    return file;
}

static void close_file(FILE* file)
{
    if (ferror(file) || fclose(file))
        fail("cannot write");
}

// Both formats are little-endian, and so is the machine this is for.
static FILE* open_ply(const char* folder, const char* name, const char* comment,
                      uint32_t vertex_count, uint32_t face_count)
{
    FILE* out = open_file(folder, name);
    fprintf(out,
            "ply\nformat binary_little_endian 1.0\n"
            "comment %s\n"
            "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %u\nproperty list uchar int vertex_indices\nend_header\n",
            comment, vertex_count, face_count);
    return out;
}

static void write_face(FILE* out, const int32_t corners[3])
{
    fputc(3, out);
    fwrite(corners, sizeof *corners, 3, out);
}

// ---- Bunny --------------------------------------------------------------------------------------

#define MAX_BUNNY 100000

static double positions[MAX_BUNNY][3];
static int32_t faces[MAX_BUNNY][3];

static void write_bunny(const char* obj, const char* folder)
{
    FILE* in = fopen(obj, "r");
    if (!in)
        fail("cannot read the bunny's OBJ");
    uint32_t vertex_count = 0;
    uint32_t face_count = 0;
    double lower[3] = {INFINITY, INFINITY, INFINITY};
    double upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    char line[256];
    while (fgets(line, sizeof line, in))
    {
        double* v = positions[vertex_count];
        int a, b, c;
        if (sscanf(line, "v %lf %lf %lf", &v[0], &v[1], &v[2]) == 3)
        {
            for (int axis = 0; axis < 3; axis++)
            {
                lower[axis] = fmin(lower[axis], v[axis]);
                upper[axis] = fmax(upper[axis], v[axis]);
            }
            vertex_count++;
        }
        else if (sscanf(line, "f %d%*[^ ] %d%*[^ ] %d", &a, &b, &c) == 3 ||
                 sscanf(line, "f %d %d %d", &a, &b, &c) == 3)
        {
            memcpy(faces[face_count], (int32_t[3]){a - 1, b - 1, c - 1}, sizeof *faces);
            face_count++;
        }
        if (vertex_count == MAX_BUNNY || face_count == MAX_BUNNY)
            fail("the bunny has grown");
    }
    fclose(in);

    double longest = 0.0;
    for (int axis = 0; axis < 3; axis++)
        longest = fmax(longest, upper[axis] - lower[axis]);
    const double scale = 1.2 / longest;
    const double anchor[3] = {0.5 * (lower[0] + upper[0]), lower[1], 0.5 * (lower[2] + upper[2])};
    const double place[3] = {0.0, -1.0, 0.0};

    FILE* out = open_ply(folder, "bunny.ply", "Stanford Bunny, Stanford 3D Scanning Repository",
                         vertex_count, face_count);
    for (uint32_t i = 0; i < vertex_count; i++)
    {
        float p[3];
        for (int axis = 0; axis < 3; axis++)
            p[axis] = (float)((positions[i][axis] - anchor[axis]) * scale + place[axis]);
        fwrite(p, sizeof p, 1, out);
    }
    for (uint32_t i = 0; i < face_count; i++)
        write_face(out, faces[i]);
    close_file(out);
    printf("bunny.ply: %u vertices, %u triangles\n", vertex_count, face_count);
}

// ---- Teapot -------------------------------------------------------------------------------------

static void weigh_bernstein(double t, double weights[4])
{
    const double s = 1.0 - t;
    weights[0] = s * s * s;
    weights[1] = 3.0 * s * s * t;
    weights[2] = 3.0 * s * t * t;
    weights[3] = t * t * t;
}

#define PATCHES 32
#define MAX_POINTS 400

// The data: their own line "patches points", 16 numbers of points a patch, the points.
static void read_patches(const char* path, unsigned patches[PATCHES][16],
                         double points[MAX_POINTS][3])
{
    FILE* in = fopen(path, "r");
    if (!in)
        fail("cannot read the teapot's patches");
    char line[256];
    unsigned patch_count = 0;
    unsigned point_count = 0;
    while (!patch_count && fgets(line, sizeof line, in))
        if (sscanf(line, "%u %u", &patch_count, &point_count) != 2)
            patch_count = 0;
    if (patch_count != PATCHES || point_count > MAX_POINTS)
        fail("the teapot has other patches");
    for (unsigned i = 0; i < PATCHES * 16; i++)
        if (fscanf(in, "%u", &patches[i / 16][i % 16]) != 1 ||
            patches[i / 16][i % 16] >= point_count)
            fail("the teapot's patches are cut");
    for (unsigned i = 0; i < point_count; i++)
        if (fscanf(in, "%lf %lf %lf", &points[i][0], &points[i][1], &points[i][2]) != 3)
            fail("the teapot's points are cut");
    fclose(in);
}

// Each patch has vertices of its own, (n + 1)^2.
static void write_teapot(const char* path, unsigned n, const char* folder)
{
    static unsigned patches[PATCHES][16];
    static double points[MAX_POINTS][3];
    read_patches(path, patches, points);
    const unsigned side = n + 1;
    FILE* out = open_ply(folder, "teapot.ply", "Utah teapot, 32 patches after Newell",
                         PATCHES * side * side, PATCHES * 2 * n * n);
    for (unsigned vertex = 0; vertex < PATCHES * side * side; vertex++)
    {
        const unsigned* patch = patches[vertex / (side * side)];
        double u[4], v[4], p[3] = {0.0, 0.0, 0.0};
        weigh_bernstein((double)(vertex % side) / n, u);
        weigh_bernstein((double)(vertex / side % side) / n, v);
        for (int i = 0; i < 16; i++)
            for (int axis = 0; axis < 3; axis++)
                p[axis] += v[i / 4] * u[i % 4] * points[patch[i]][axis];
        fwrite((const float[]){(float)p[0], (float)p[1], (float)p[2]}, sizeof(float), 3, out);
    }
    for (unsigned cell = 0; cell < PATCHES * n * n; cell++)
    {
        const int32_t a = (int32_t)(cell / (n * n) * side * side + cell / n % n * side + cell % n);
        const int32_t b = a + (int32_t)side;
        write_face(out, (const int32_t[]){a, a + 1, b + 1});
        write_face(out, (const int32_t[]){a, b + 1, b});
    }
    close_file(out);
    printf("teapot.ply: %u triangles\n", PATCHES * 2 * n * n);
}

// ---- Scenes of quads ----------------------------------------------------------------------------

// Corners counter-clockwise seen from where the quad is looked at.
typedef struct Quad
{
    float corners[4][3];
} Quad;

// Quads of one material; `mesh` begins a mesh of that name.
typedef struct Primitive
{
    unsigned first, count, material;
    const char* mesh;
} Primitive;

#define MAX_QUADS 18
#define MAX_PRIMITIVES 6

typedef struct Scene
{
    const char* file;
    const char* roots;     // as the scene lists them
    const char* nodes;     // JSON
    const char* materials; // JSON
    unsigned quad_count, primitive_count;
    Quad quads[MAX_QUADS];
    Primitive primitives[MAX_PRIMITIVES];
} Scene;

static void write_base64(FILE* out, const uint8_t* bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3)
    {
        const size_t left = size - i;
        const uint32_t word = (uint32_t)bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) |
                              (left > 2 ? bytes[i + 2] : 0);
        fputc(digits[word >> 18], out);
        fputc(digits[word >> 12 & 63], out);
        fputc(left > 1 ? digits[word >> 6 & 63] : '=', out);
        fputc(left > 2 ? digits[word & 63] : '=', out);
    }
}

static void write_accessors(FILE* out, const Scene* scene, size_t quad_bytes, size_t index_bytes)
{
    for (unsigned p = 0; p < scene->primitive_count; p++)
    {
        const unsigned first = scene->primitives[p].first;
        const unsigned count = scene->primitives[p].count;
        float lower[3] = {INFINITY, INFINITY, INFINITY};
        float upper[3] = {-INFINITY, -INFINITY, -INFINITY};
        for (unsigned i = 4 * first; i < 4 * (first + count); i++)
            for (int axis = 0; axis < 3; axis++)
            {
                lower[axis] = fminf(lower[axis], scene->quads[i / 4].corners[i % 4][axis]);
                upper[axis] = fmaxf(upper[axis], scene->quads[i / 4].corners[i % 4][axis]);
            }
        fprintf(
            out,
            "    { \"bufferView\": 0, \"byteOffset\": %zu, \"componentType\": 5126, \"count\": %u, "
            "\"type\": \"VEC3\",\n"
            "      \"min\": [ %.9g, %.9g, %.9g ], \"max\": [ %.9g, %.9g, %.9g ] },\n",
            first * quad_bytes, 4 * count, lower[0], lower[1], lower[2], upper[0], upper[1],
            upper[2]);
        fprintf(
            out,
            "    { \"bufferView\": 1, \"byteOffset\": %zu, \"componentType\": 5123, \"count\": %u, "
            "\"type\": \"SCALAR\" }%s\n",
            first * index_bytes, 6 * count, p + 1 < scene->primitive_count ? "," : "");
    }
}

static void write_meshes(FILE* out, const Scene* scene)
{
    for (unsigned p = 0; p < scene->primitive_count; p++)
    {
        const Primitive* primitive = &scene->primitives[p];
        if (primitive->mesh)
            fprintf(out, "%s    { \"name\": \"%s\", \"primitives\": [\n", p ? "    ] },\n" : "",
                    primitive->mesh);
        const bool is_last = p + 1 == scene->primitive_count || primitive[1].mesh;
        fprintf(
            out,
            "      { \"attributes\": { \"POSITION\": %u }, \"indices\": %u, \"material\": %u }%s\n",
            2 * p, 2 * p + 1, primitive->material, is_last ? "" : ",");
    }
}

static void write_scene(const char* folder, const Scene* scene)
{
    // One buffer: the corners of all quads, then two triangles each, numbered within their
    // primitive.
    static uint8_t data[MAX_QUADS * (sizeof(Quad) + 6 * sizeof(uint16_t))];
    const size_t corner_bytes = scene->quad_count * sizeof(Quad);
    const size_t index_bytes = 6 * sizeof(uint16_t);
    const size_t data_bytes = corner_bytes + scene->quad_count * index_bytes;
    memcpy(data, scene->quads, corner_bytes);
    for (unsigned p = 0; p < scene->primitive_count; p++)
        for (unsigned i = 0; i < scene->primitives[p].count; i++)
        {
            uint16_t indices[6];
            for (unsigned k = 0; k < 6; k++)
                indices[k] = (uint16_t)(4 * i + (const unsigned[]){0, 1, 2, 0, 2, 3}[k]);
            memcpy(data + corner_bytes + (scene->primitives[p].first + i) * index_bytes, indices,
                   index_bytes);
        }

    FILE* out = open_file(folder, scene->file);
    fprintf(out,
            "{\n"
            "  \"asset\": { \"version\": \"2.0\" },\n"
            "  \"scene\": 0,\n"
            "  \"scenes\": [ { \"nodes\": [ %s ] } ],\n"
            "  \"nodes\": [\n%s  ],\n",
            scene->roots, scene->nodes);
    fprintf(
        out,
        "  \"cameras\": [\n"
        "    { \"type\": \"perspective\", \"perspective\": { \"yfov\": %.17g, \"znear\": 0.01 } }\n"
        "  ],\n",
        2.0 * atan(0.38));
    fprintf(out,
            "  \"extensionsUsed\": [ \"KHR_materials_emissive_strength\" ],\n"
            "  \"materials\": [\n%s  ],\n",
            scene->materials);
    fprintf(out, "  \"meshes\": [\n");
    write_meshes(out, scene);
    fprintf(out, "    ] }\n  ],\n  \"accessors\": [\n");
    write_accessors(out, scene, sizeof(Quad), index_bytes);
    fprintf(out,
            "  ],\n  \"bufferViews\": [\n"
            "    { \"buffer\": 0, \"byteLength\": %zu, \"target\": 34962 },\n"
            "    { \"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu, \"target\": 34963 }\n  "
            "],\n",
            corner_bytes, corner_bytes, data_bytes - corner_bytes);
    fprintf(
        out,
        "  \"buffers\": [ { \"byteLength\": %zu, \"uri\": \"data:application/octet-stream;base64,",
        data_bytes);
    write_base64(out, data, data_bytes);
    fprintf(out, "\" } ]\n}\n");
    close_file(out);
    printf("%s: %u triangles\n", scene->file, 2 * scene->quad_count);
}

// ---- Cornell box --------------------------------------------------------------------------------

#define CORNELL_NODES                             \
    "    { \"name\": \"walls\", \"mesh\": 0 },\n" \
    "    { \"name\": \"light\", \"mesh\": 1 },\n" \
    "    { \"name\": \"camera\", \"camera\": 0, \"translation\": [ 0, 0, 3.2 ] }"

#define CORNELL_MATERIALS                                                                          \
    "    { \"name\": \"white\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.73, 0.73, "   \
    "0.73, 1 ], \"metallicFactor\": 0 } },\n"                                                      \
    "    { \"name\": \"red\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.63, 0.06, "     \
    "0.05, 1 ], \"metallicFactor\": 0 } },\n"                                                      \
    "    { \"name\": \"green\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.12, 0.45, "   \
    "0.15, 1 ], \"metallicFactor\": 0 } },\n"                                                      \
    "    { \"name\": \"light\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.78, 0.78, "   \
    "0.78, 1 ], \"metallicFactor\": 0 },\n"                                                        \
    "      \"emissiveFactor\": [ 1, 0.83, 0.6 ],\n"                                                \
    "      \"extensions\": { \"KHR_materials_emissive_strength\": { \"emissiveStrength\": 18 } } " \
    "}"

static const Scene cornell = {
    .file = "cornell.gltf",
    .roots = "0, 1, 2",
    .nodes = CORNELL_NODES "\n",
    .materials = CORNELL_MATERIALS "\n",
    .quad_count = 6,
    .primitive_count = 4,
    .quads =
        {
            {{{-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}}}, // floor
            {{{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}},     // ceiling
            {{{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}}, // back
            {{{-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}}}, // left
            {{{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}},     // right
            {{{-0.25f, 0.99f, -0.25f},
              {0.25f, 0.99f, -0.25f},
              {0.25f, 0.99f, 0.25f},
              {-0.25f, 0.99f, 0.25f}}}, // light
        },
    .primitives = {{0, 3, 0, "walls"}, {3, 1, 1, NULL}, {4, 1, 2, NULL}, {5, 1, 3, "light"}},
};

// A block on the floor, turned by the angle of this sine and cosine; six quads seen from outside.
static void make_block(Quad quads[6], double x, double z, double height, double sine, double cosine)
{
    static const double side = 0.6;
    static const uint8_t corners[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (int face = 0; face < 6; face++)
        for (int k = 0; k < 4; k++)
        {
            // Bits of a corner: x, y, z.
            const uint8_t corner = corners[face][k];
            const double u = corner & 1 ? 0.5 * side : -0.5 * side;
            const double w = corner & 4 ? 0.5 * side : -0.5 * side;
            quads[face].corners[k][0] = (float)(x + (cosine * u + sine * w));
            quads[face].corners[k][1] = (float)(corner & 2 ? height - 1.0 : -1.0);
            quads[face].corners[k][2] = (float)(z + (cosine * w - sine * u));
        }
}

// Turned by a triangle of 7, 24 and 25, which needs no library's sine.
static Scene make_cornell_blocks(void)
{
    Scene scene = cornell;
    scene.file = "cornell_blocks.gltf";
    scene.roots = "0, 1, 2, 3, 4";
    scene.nodes = CORNELL_NODES ",\n"
                                "    { \"name\": \"diffuse block\", \"mesh\": 2 },\n"
                                "    { \"name\": \"mirroring block\", \"mesh\": 3 }\n";
    scene.materials =
        CORNELL_MATERIALS ",\n"
                          "    { \"name\": \"mirror\", \"pbrMetallicRoughness\": { "
                          "\"baseColorFactor\": [ 0.95, 0.95, 0.95, 1 ], \"metallicFactor\": 1, "
                          "\"roughnessFactor\": 0 } }\n";
    scene.quad_count = 18;
    scene.primitive_count = 6;
    make_block(&scene.quads[6], 0.35, 0.35, 0.6, -0.28, 0.96);
    make_block(&scene.quads[12], -0.35, -0.3, 1.2, 0.28, 0.96);
    scene.primitives[4] = (Primitive){6, 6, 0, "diffuse block"};
    scene.primitives[5] = (Primitive){12, 6, 4, "mirroring block"};
    return scene;
}

// ---- Stage --------------------------------------------------------------------------------------

// Lights face down; the camera looks down by the angle whose sine is 0.28.
static const Scene stage = {
    .file = "stage.gltf",
    .roots = "0, 1, 2",
    .nodes =
        "    { \"name\": \"plane\", \"mesh\": 0 },\n"
        "    { \"name\": \"lights\", \"mesh\": 1 },\n"
        "    { \"name\": \"camera\", \"camera\": 0, \"matrix\": [ 1, 0, 0, 0, 0, 0.96, -0.28, 0, "
        "0, 0.28, 0.96, 0, 0, 0.2, 2.2, 1 ] }\n",
    .materials =
        "    { \"name\": \"plane\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.73, "
        "0.73, 0.73, 1 ], \"metallicFactor\": 0 } },\n"
        "    { \"name\": \"light\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.78, "
        "0.78, 0.78, 1 ], \"metallicFactor\": 0 },\n"
        "      \"emissiveFactor\": [ 1, 0.93, 0.83 ],\n"
        "      \"extensions\": { \"KHR_materials_emissive_strength\": { "
        "\"emissiveStrength\": 6 } } }\n",
    .quad_count = 4,
    .primitive_count = 2,
    .quads =
        {
            {{{-4, -1, 4}, {4, -1, 4}, {4, -1, -4}, {-4, -1, -4}}},
            {{{-2, 2, 0.5f}, {-1, 2, 0.5f}, {-1, 2, 1.5f}, {-2, 2, 1.5f}}},
            {{{1, 2, 0.5f}, {2, 2, 0.5f}, {2, 2, 1.5f}, {1, 2, 1.5f}}},
            {{{-0.5f, 2, -2}, {0.5f, 2, -2}, {0.5f, 2, -1}, {-0.5f, 2, -1}}},
        },
    .primitives = {{0, 1, 0, "plane"}, {1, 3, 1, "lights"}},
};

int main(int argc, char** argv)
{
    const unsigned long n = argc == 5 ? strtoul(argv[4], NULL, 10) : 0;
    if (argc == 2)
    {
        const Scene blocks = make_cornell_blocks();
        write_scene(argv[1], &cornell);
        write_scene(argv[1], &blocks);
        write_scene(argv[1], &stage);
    }
    else if (argc == 4 && !strcmp(argv[2], "bunny"))
        write_bunny(argv[3], argv[1]);
    else if (argc == 5 && !strcmp(argv[2], "teapot") && n >= 1 && n <= 1000)
        write_teapot(argv[3], (unsigned)n, argv[1]);
    else
        fail("usage: make_scenes FOLDER [bunny BUNNY.obj | teapot TEAPOT.txt N]");
    return 0;
}
