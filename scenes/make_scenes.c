// make_scenes.c - writes the bundled scenes; kept to show where their bytes come from.
//
//     cc -std=c17 -ffp-contract=off make_scenes.c -lm -o make_scenes
//     ./make_scenes /usr/share/glmark2/models/bunny.obj .
//
// bunny.ply: vertices and faces in the order of the OBJ, scaled to 1.2 along the longest extent,
// centred in x and z, standing on y = -1. cornell.gltf: a box [-1,1]^3 open at z = 1, with a light
// and a camera.

#include <math.h>
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

// ---- Bunny --------------------------------------------------------------------------------------

#define MAX_BUNNY 100000

static double positions[MAX_BUNNY][3];
static int32_t faces[MAX_BUNNY][3];

// Both formats are little-endian, and so is the machine this is for.
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

    FILE* out = open_file(folder, "bunny.ply");
    fprintf(out,
            "ply\nformat binary_little_endian 1.0\n"
            "comment Stanford Bunny, Stanford 3D Scanning Repository\n"
            "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %u\nproperty list uchar int vertex_indices\nend_header\n",
            vertex_count, face_count);
    for (uint32_t i = 0; i < vertex_count; i++)
    {
        float p[3];
        for (int axis = 0; axis < 3; axis++)
            p[axis] = (float)((positions[i][axis] - anchor[axis]) * scale + place[axis]);
        fwrite(p, sizeof p, 1, out);
    }
    for (uint32_t i = 0; i < face_count; i++)
    {
        fputc(3, out);
        fwrite(faces[i], sizeof *faces, 1, out);
    }
    close_file(out);
    printf("bunny.ply: %u vertices, %u triangles\n", vertex_count, face_count);
}

// ---- Cornell box --------------------------------------------------------------------------------

// A quad by its corners, counter-clockwise seen from inside the box.
typedef struct Quad
{
    const char* name;
    float corners[4][3];
} Quad;

static const Quad quads[] = {
    {"floor", {{-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}}},
    {"ceiling", {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}},
    {"back", {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}},
    {"left", {{-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}}},
    {"right", {{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}},
    {"light",
     {{-0.25f, 0.99f, -0.25f},
      {0.25f, 0.99f, -0.25f},
      {0.25f, 0.99f, 0.25f},
      {-0.25f, 0.99f, 0.25f}}},
};
#define QUAD_COUNT (sizeof quads / sizeof *quads)
#define WHITE_QUADS 3 // the first of them share a primitive

// First quad and number of quads of each primitive: white, red, green, light.
static const unsigned primitives[4][2] = {{0, WHITE_QUADS}, {3, 1}, {4, 1}, {5, 1}};

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

static void write_cornell(const char* folder)
{
    // One buffer: the corners of all quads, then two triangles each, numbered within their
    // primitive.
    struct
    {
        float corners[QUAD_COUNT][4][3];
        uint16_t indices[QUAD_COUNT][6];
    } data;
    for (unsigned i = 0; i < QUAD_COUNT; i++)
        memcpy(data.corners[i], quads[i].corners, sizeof quads[i].corners);
    for (unsigned p = 0; p < 4; p++)
        for (unsigned i = 0; i < primitives[p][1]; i++)
            for (unsigned k = 0; k < 6; k++)
                data.indices[primitives[p][0] + i][k] =
                    (uint16_t)(4 * i + (const unsigned[]){0, 1, 2, 0, 2, 3}[k]);

    FILE* out = open_file(folder, "cornell.gltf");
    fprintf(out, "{\n"
                 "  \"asset\": { \"version\": \"2.0\" },\n"
                 "  \"scene\": 0,\n"
                 "  \"scenes\": [ { \"nodes\": [ 0, 1, 2 ] } ],\n"
                 "  \"nodes\": [\n"
                 "    { \"name\": \"walls\", \"mesh\": 0 },\n"
                 "    { \"name\": \"light\", \"mesh\": 1 },\n"
                 "    { \"name\": \"camera\", \"camera\": 0, \"translation\": [ 0, 0, 3.2 ] }\n"
                 "  ],\n");
    fprintf(
        out,
        "  \"cameras\": [\n"
        "    { \"type\": \"perspective\", \"perspective\": { \"yfov\": %.17g, \"znear\": 0.01 } }\n"
        "  ],\n",
        2.0 * atan(0.38));
    fprintf(
        out,
        "  \"extensionsUsed\": [ \"KHR_materials_emissive_strength\" ],\n"
        "  \"materials\": [\n"
        "    { \"name\": \"white\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.73, 0.73, "
        "0.73, 1 ], \"metallicFactor\": 0 } },\n"
        "    { \"name\": \"red\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.63, 0.06, "
        "0.05, 1 ], \"metallicFactor\": 0 } },\n"
        "    { \"name\": \"green\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.12, 0.45, "
        "0.15, 1 ], \"metallicFactor\": 0 } },\n"
        "    { \"name\": \"light\", \"pbrMetallicRoughness\": { \"baseColorFactor\": [ 0.78, 0.78, "
        "0.78, 1 ], \"metallicFactor\": 0 },\n"
        "      \"emissiveFactor\": [ 1, 0.83, 0.6 ],\n"
        "      \"extensions\": { \"KHR_materials_emissive_strength\": { \"emissiveStrength\": 18 } "
        "} }\n"
        "  ],\n");
    fprintf(out, "  \"meshes\": [\n    { \"name\": \"walls\", \"primitives\": [\n");
    for (int p = 0; p < 4; p++)
    {
        fprintf(
            out,
            "      { \"attributes\": { \"POSITION\": %d }, \"indices\": %d, \"material\": %d }%s\n",
            2 * p, 2 * p + 1, p, p < 2 ? "," : "");
        if (p == 2)
            fprintf(out, "    ] },\n    { \"name\": \"light\", \"primitives\": [\n");
    }
    fprintf(out, "    ] }\n  ],\n  \"accessors\": [\n");
    for (int p = 0; p < 4; p++)
    {
        const unsigned first = primitives[p][0];
        const unsigned count = primitives[p][1];
        float lower[3] = {INFINITY, INFINITY, INFINITY};
        float upper[3] = {-INFINITY, -INFINITY, -INFINITY};
        for (unsigned i = 4 * first; i < 4 * (first + count); i++)
            for (int axis = 0; axis < 3; axis++)
            {
                lower[axis] = fminf(lower[axis], data.corners[i / 4][i % 4][axis]);
                upper[axis] = fmaxf(upper[axis], data.corners[i / 4][i % 4][axis]);
            }
        fprintf(
            out,
            "    { \"bufferView\": 0, \"byteOffset\": %zu, \"componentType\": 5126, \"count\": %u, "
            "\"type\": \"VEC3\",\n"
            "      \"min\": [ %.9g, %.9g, %.9g ], \"max\": [ %.9g, %.9g, %.9g ] },\n",
            first * sizeof data.corners[0], 4 * count, lower[0], lower[1], lower[2], upper[0],
            upper[1], upper[2]);
        fprintf(
            out,
            "    { \"bufferView\": 1, \"byteOffset\": %zu, \"componentType\": 5123, \"count\": %u, "
            "\"type\": \"SCALAR\" }%s\n",
            first * sizeof data.indices[0], 6 * count, p < 3 ? "," : "");
    }
    fprintf(out,
            "  ],\n  \"bufferViews\": [\n"
            "    { \"buffer\": 0, \"byteLength\": %zu, \"target\": 34962 },\n"
            "    { \"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu, \"target\": 34963 }\n  "
            "],\n",
            sizeof data.corners, sizeof data.corners, sizeof data.indices);
    fprintf(
        out,
        "  \"buffers\": [ { \"byteLength\": %zu, \"uri\": \"data:application/octet-stream;base64,",
        sizeof data);
    write_base64(out, (const uint8_t*)&data, sizeof data);
    fprintf(out, "\" } ]\n}\n");
    close_file(out);
    printf("cornell.gltf: %zu triangles\n", 2 * QUAD_COUNT);
}

int main(int argc, char** argv)
{
    if (argc != 3)
        fail("usage: make_scenes BUNNY.obj FOLDER");
    write_bunny(argv[1], argv[2]);
    write_cornell(argv[2]);
    return 0;
}
