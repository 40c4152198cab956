// write_scenes.c - writes the inputs that test.sh bakes with two compilers' builds to compare the
// bytes: sub-grids, leaves of BVHs, needles, coordinates of zero with both signs, each alone and as
// turned, stretched and mirrored instances. Prints the path of each scene, one a line.

#include "meshes.h"

#include <stdio.h>
#include <stdlib.h>

enum
{
    SIDE = 12, // quads along a side of the sheets of zeros
    CORNERS = SIDE + 1,
};

// A sheet over [0,1] x [-1,0], flat or bent down from z = 0. Its zeros, those on the borders of its
// box above all, take both signs in turn.
static LsTestMesh make_zeros(double bend)
{
    LsTestMesh mesh = {.vertex_count = CORNERS * CORNERS, .triangle_count = 2 * SIDE * SIDE};
    mesh.positions = calloc(mesh.vertex_count, 3 * sizeof(float));
    mesh.indices = calloc(mesh.triangle_count, 3 * sizeof(uint32_t));
    if (!mesh.positions || !mesh.indices)
    {
        fprintf(stderr, "write_scenes: out of memory\n");
        exit(1);
    }
    for (uint32_t i = 0; i < mesh.vertex_count; i++)
    {
        const double x = (double)(i % CORNERS) / SIDE, y = (double)(i / CORNERS) / SIDE - 1.0;
        const double p[3] = {x, y, bend * x * y};
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            const float zero = (i + axis) % 2 == 0 ? 0.0f : -0.0f;
            mesh.positions[3 * i + axis] = p[axis] == 0.0 ? zero : (float)p[axis];
        }
    }
    uint32_t* index = mesh.indices;
    for (uint32_t i = 0; i < SIDE * SIDE; i++, index += 6)
    {
        const uint32_t a = i / SIDE * CORNERS + i % SIDE, b = a + CORNERS;
        index[0] = index[3] = a;
        index[1] = a + 1;
        index[2] = index[4] = b + 1;
        index[5] = b;
    }
    return mesh;
}

static void write_scene(const LsTestMesh* mesh, const char* folder, const char* name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s.ply", folder, name);
    ls_test_mesh_write_ply(mesh, path);
    puts(path);
    snprintf(path, sizeof path, "%s/%s.gltf", folder, name);
    ls_test_mesh_write_gltf(mesh, path);
    puts(path);
}

// The mesh whose NAME.bin lies in the folder, mirrored at planes through the origin and stretched
// from it: the bounds of the world meet zeros of both signs.
static void write_mirrored(const LsTestMesh* mesh, const char* folder, const char* name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s_mirrored.gltf", folder, name);
    FILE* file = fopen(path, "w");
    if (!file)
    {
        fprintf(stderr, "write_scenes: cannot write %s\n", path);
        exit(1);
    }
    const uint32_t position_bytes = 12 * mesh->vertex_count;
    const uint32_t index_bytes = 12 * mesh->triangle_count;
    fprintf(file,
            "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2,3]}],\n"
            "\"buffers\":[{\"uri\":\"%s.bin\",\"byteLength\":%u}],\n"
            "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":%u},"
            "{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u}],\n"
            "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,"
            "\"type\":\"VEC3\",\"min\":[0,-1,0],\"max\":[1,0,0]},"
            "{\"bufferView\":1,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}],\n"
            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],\n"
            "\"nodes\":[{\"mesh\":0,\"scale\":[1,1,-1]},{\"mesh\":0,\"scale\":[2,1,0.5]},"
            "{\"mesh\":0,\"scale\":[1,3,1]},{\"mesh\":0,\"scale\":[0.5,2,-2]}]}\n",
            name, position_bytes + index_bytes, position_bytes, position_bytes, index_bytes,
            mesh->vertex_count, 3 * mesh->triangle_count);
    if (fclose(file) != 0)
    {
        fprintf(stderr, "write_scenes: cannot write %s\n", path);
        exit(1);
    }
    puts(path);
}

int main(int argc, char** argv)
{
    if (argc != 2)
    {
        fprintf(stderr, "usage: write_scenes FOLDER\n");
        return 1;
    }
    static const LsTestMeshId ids[] = {LS_TEST_MESH_TEAPOT,  LS_TEST_MESH_SHELL, LS_TEST_MESH_HUB,
                                       LS_TEST_MESH_SLIVERS, LS_TEST_MESH_FAN,   LS_TEST_MESH_ONE,
                                       LS_TEST_MESH_STADIUM, LS_TEST_MESH_FAR};
    for (size_t i = 0; i < sizeof ids / sizeof ids[0]; i++)
    {
        LsTestMesh mesh = ls_test_mesh_make(ids[i]);
        write_scene(&mesh, argv[1], ls_test_mesh_name(ids[i]));
        ls_test_mesh_destroy(&mesh);
    }
    LsTestMesh zeros = make_zeros(0.0);
    write_scene(&zeros, argv[1], "flat_zeros");
    write_mirrored(&zeros, argv[1], "flat_zeros");
    ls_test_mesh_destroy(&zeros);
    zeros = make_zeros(0.25);
    write_scene(&zeros, argv[1], "bent_zeros");
    write_mirrored(&zeros, argv[1], "bent_zeros");
    ls_test_mesh_destroy(&zeros);
    return 0;
}
