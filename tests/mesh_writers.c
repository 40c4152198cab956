#include "mesh_writers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

const float ls_odd_positions[LS_ODD_VERTICES][3] = {
    {0.0f, 0.0f, 0.0f},   {1.0f, 0.0f, 0.0f},       {0.0f, 1.0f, 0.0f},  {0.0f, 0.0f, 1.0f},
    {0.5f, -1.25f, 0.1f}, {1.0e-7f, 2.5e6f, -0.3f}, {0.0f, 0.0f, -0.0f},
};
static const uint32_t odd_sizes[LS_ODD_FACES] = {3, 3, 3, 3, 3, 3, 5};
static const uint32_t odd_corners[] = {0, 1, 2, 0, 3, 1, 6, 1, 4, 0, 1, 2,
                                       5, 5, 2, 0, 6, 1, 0, 1, 2, 3, 5};
const uint32_t ls_odd_indices[LS_ODD_TRIANGLES][3] = {
    {0, 1, 2}, {0, 3, 1}, {6, 1, 4}, {0, 1, 2}, {5, 5, 2},
    {0, 6, 1}, {0, 1, 2}, {0, 2, 3}, {0, 3, 5},
};
const LsPolygonMesh ls_odd_mesh = {
    .positions = ls_odd_positions[0],
    .vertex_count = LS_ODD_VERTICES,
    .face_sizes = odd_sizes,
    .face_count = LS_ODD_FACES,
    .corners = odd_corners,
};

const char* ls_mesh_format_name(LsMeshFormat format)
{
    static const char* const names[] = {
#define LS_MESH_FORMAT_TEXT(name, ending) #name,
        LS_MESH_FORMAT_LIST(LS_MESH_FORMAT_TEXT)
#undef LS_MESH_FORMAT_TEXT
    };
    return names[format];
}

const char* ls_mesh_format_ending(LsMeshFormat format)
{
    static const char* const endings[] = {
#define LS_MESH_FORMAT_TEXT(name, ending) ending,
        LS_MESH_FORMAT_LIST(LS_MESH_FORMAT_TEXT)
#undef LS_MESH_FORMAT_TEXT
    };
    return endings[format];
}

LsPolygonMesh ls_polygons_of(const LsTestMesh* mesh)
{
    uint32_t* sizes = malloc(mesh->triangle_count * sizeof *sizes);
    assert_non_null(sizes);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        sizes[i] = 3;
    return (LsPolygonMesh){
        .positions = mesh->positions,
        .vertex_count = mesh->vertex_count,
        .face_sizes = sizes,
        .face_count = mesh->triangle_count,
        .corners = mesh->indices,
    };
}

// ---- Parts --------------------------------------------------------------------------------------

static void put_position(FILE* file, const char* before, const float* position)
{
    fprintf(file, "%s%.9g %.9g %.9g\n", before, (double)position[0], (double)position[1],
            (double)position[2]);
}

static void put_words(FILE* file, const void* words, size_t count, bool is_swapped)
{
    const unsigned char* bytes = words;
    for (size_t i = 0; i < 4 * count; i++)
        fputc(bytes[is_swapped ? i ^ 3 : i], file);
}

static void put_word(FILE* file, uint32_t word)
{
    put_words(file, &word, 1, false);
}

static uint32_t count_triangles(const LsPolygonMesh* mesh)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->face_count; i++)
        count += mesh->face_sizes[i] - 2;
    return count;
}

// The faces as triangles, three vertices each; malloc'ed.
static uint32_t* fan(const LsPolygonMesh* mesh)
{
    uint32_t* indices = malloc(3 * (size_t)count_triangles(mesh) * sizeof *indices);
    assert_non_null(indices);
    uint32_t* next = indices;
    const uint32_t* face = mesh->corners;
    for (uint32_t i = 0; i < mesh->face_count; i++)
    {
        for (uint32_t k = 2; k < mesh->face_sizes[i]; k++)
        {
            *next++ = face[0];
            *next++ = face[k - 1];
            *next++ = face[k];
        }
        face += mesh->face_sizes[i];
    }
    return indices;
}

// Vertices and faces as OFF and PLY have them in text.
static void put_records(FILE* file, const LsPolygonMesh* mesh)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        put_position(file, "", mesh->positions + 3 * (size_t)i);
    const uint32_t* corner = mesh->corners;
    for (uint32_t i = 0; i < mesh->face_count; i++)
    {
        fprintf(file, "%u", mesh->face_sizes[i]);
        for (uint32_t k = 0; k < mesh->face_sizes[i]; k++)
            fprintf(file, " %u", *corner++);
        fputc('\n', file);
    }
}

// ---- OBJ, PLY, OFF ------------------------------------------------------------------------------

static void write_obj(FILE* file, const LsPolygonMesh* mesh)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        put_position(file, "v ", mesh->positions + 3 * (size_t)i);
    const uint32_t* corner = mesh->corners;
    for (uint32_t i = 0; i < mesh->face_count; i++)
    {
        fputc('f', file);
        for (uint32_t k = 0; k < mesh->face_sizes[i]; k++)
            fprintf(file, " %u", *corner++ + 1);
        fputc('\n', file);
    }
}

static void put_ply_header(FILE* file, const LsPolygonMesh* mesh, const char* kind)
{
    fprintf(file,
            "ply\nformat %s 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
            "property float z\nelement face %u\nproperty list uchar int vertex_indices\n"
            "end_header\n",
            kind, mesh->vertex_count, mesh->face_count);
}

static void write_ply_text(FILE* file, const LsPolygonMesh* mesh)
{
    put_ply_header(file, mesh, "ascii");
    put_records(file, mesh);
}

static void write_ply_binary(FILE* file, const LsPolygonMesh* mesh, bool is_big)
{
    put_ply_header(file, mesh, is_big ? "binary_big_endian" : "binary_little_endian");
    put_words(file, mesh->positions, 3 * (size_t)mesh->vertex_count, is_big);
    const uint32_t* face = mesh->corners;
    for (uint32_t i = 0; i < mesh->face_count; i++)
    {
        fputc((int)mesh->face_sizes[i], file);
        put_words(file, face, mesh->face_sizes[i], is_big);
        face += mesh->face_sizes[i];
    }
}

static void write_off(FILE* file, const LsPolygonMesh* mesh)
{
    fprintf(file, "OFF\n%u %u 0\n", mesh->vertex_count, mesh->face_count);
    put_records(file, mesh);
}

// ---- STL ----------------------------------------------------------------------------------------

static void write_stl_text(FILE* file, const LsPolygonMesh* mesh)
{
    uint32_t* indices = fan(mesh);
    fprintf(file, "solid a mesh\n");
    for (uint32_t i = 0; i < count_triangles(mesh); i++)
    {
        fprintf(file, "  facet normal 0 0 0\n    outer loop\n");
        for (int k = 0; k < 3; k++)
            put_position(file, "      vertex ",
                         mesh->positions + 3 * (size_t)indices[3 * (size_t)i + (size_t)k]);
        fprintf(file, "    endloop\n  endfacet\n");
    }
    fprintf(file, "endsolid\n");
    free(indices);
}

static void write_stl_binary(FILE* file, const LsPolygonMesh* mesh)
{
    uint32_t* indices = fan(mesh);
    const char header[80] = "solid in truth binary";
    fwrite(header, 1, sizeof header, file);
    put_word(file, count_triangles(mesh));
    for (uint32_t i = 0; i < count_triangles(mesh); i++)
    {
        const float normal[3] = {0};
        put_words(file, normal, 3, false);
        for (int k = 0; k < 3; k++)
            put_words(file, mesh->positions + 3 * (size_t)indices[3 * (size_t)i + (size_t)k], 3,
                      false);
        fputc(0, file);
        fputc(0, file);
    }
    free(indices);
}

// ---- glTF ---------------------------------------------------------------------------------------

// Positions, then indices.
static unsigned char* make_buffer(const LsPolygonMesh* mesh, size_t* size)
{
    const size_t positions = 12 * (size_t)mesh->vertex_count;
    const size_t indices = 12 * (size_t)count_triangles(mesh);
    unsigned char* bytes = malloc(positions + indices);
    uint32_t* fanned = fan(mesh);
    assert_non_null(bytes);
    memcpy(bytes, mesh->positions, positions);
    memcpy(bytes + positions, fanned, indices);
    free(fanned);
    *size = positions + indices;
    return bytes;
}

static void put_base64(FILE* file, const unsigned char* bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3)
    {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; k++)
            word = word << 8 | (i + k < size ? bytes[i + k] : 0);
        for (size_t k = 0; k < 4; k++)
            fputc(i + k <= size ? digits[word >> (18 - 6 * k) & 63] : '=', file);
    }
}

// The JSON; without bytes its buffer is the one of a GLB.
static void put_gltf(FILE* file, const LsPolygonMesh* mesh, const unsigned char* bytes, size_t size)
{
    const size_t positions = 12 * (size_t)mesh->vertex_count;
    fprintf(file, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
                  "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
                  "{\"POSITION\":0},\"indices\":1}]}],");
    fprintf(file,
            "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,"
            "\"type\":\"VEC3\"",
            mesh->vertex_count);
    for (int side = 0; side < 2; side++)
    {
        fprintf(file, ",\"%s\":[", side ? "max" : "min");
        for (int axis = 0; axis < 3; axis++)
        {
            float bound = mesh->positions[axis];
            for (uint32_t i = 1; i < mesh->vertex_count; i++)
            {
                const float value = mesh->positions[3 * (size_t)i + (size_t)axis];
                bound = (side ? value > bound : value < bound) ? value : bound;
            }
            fprintf(file, "%s%.9g", axis > 0 ? "," : "", (double)bound);
        }
        fputc(']', file);
    }
    fprintf(file,
            "},{\"bufferView\":1,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}],"
            "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu},{\"buffer\":0,\"byteOffset\":%zu,"
            "\"byteLength\":%zu}],\"buffers\":[{\"byteLength\":%zu",
            3 * count_triangles(mesh), positions, positions, size - positions, size);
    if (bytes != NULL)
    {
        fprintf(file, ",\"uri\":\"data:application/octet-stream;base64,");
        put_base64(file, bytes, size);
        fputc('"', file);
    }
    fprintf(file, "}]}");
}

static void write_gltf(FILE* file, const LsPolygonMesh* mesh)
{
    size_t size;
    unsigned char* bytes = make_buffer(mesh, &size);
    put_gltf(file, mesh, bytes, size);
    fputc('\n', file);
    free(bytes);
}

static void write_glb(FILE* file, const LsPolygonMesh* mesh)
{
    size_t size;
    unsigned char* bytes = make_buffer(mesh, &size);
    char* json = NULL;
    size_t length;
    FILE* text = open_memstream(&json, &length);
    assert_non_null(text);
    put_gltf(text, mesh, NULL, size);
    fflush(text);
    while (length % 4 != 0) // chunks end at a multiple of four
    {
        fputc(' ', text);
        fflush(text);
    }
    assert_int_equal(fclose(text), 0);

    put_word(file, 0x46546C67); // "glTF"
    put_word(file, 2);
    put_word(file, (uint32_t)(12 + 8 + length + 8 + size));
    put_word(file, (uint32_t)length);
    put_word(file, 0x4E4F534A); // "JSON"
    fwrite(json, 1, length, file);
    put_word(file, (uint32_t)size);
    put_word(file, 0x004E4942); // "BIN"
    fwrite(bytes, 1, size, file);
    free(json);
    free(bytes);
}

// ---- All of them --------------------------------------------------------------------------------

char* ls_mesh_bytes(const LsPolygonMesh* mesh, LsMeshFormat format, size_t* size)
{
    char* bytes = NULL;
    FILE* file = open_memstream(&bytes, size);
    assert_non_null(file);
    bool is_text = true;
    switch (format)
    {
    case LS_MESH_FORMAT_OBJ:
        write_obj(file, mesh);
        break;
    case LS_MESH_FORMAT_PLY_TEXT:
        write_ply_text(file, mesh);
        break;
    case LS_MESH_FORMAT_PLY_LITTLE:
    case LS_MESH_FORMAT_PLY_BIG:
        write_ply_binary(file, mesh, format == LS_MESH_FORMAT_PLY_BIG);
        is_text = false;
        break;
    case LS_MESH_FORMAT_OFF:
        write_off(file, mesh);
        break;
    case LS_MESH_FORMAT_STL_TEXT:
        write_stl_text(file, mesh);
        break;
    case LS_MESH_FORMAT_STL_BINARY:
        write_stl_binary(file, mesh);
        is_text = false;
        break;
    case LS_MESH_FORMAT_GLTF:
        write_gltf(file, mesh);
        break;
    case LS_MESH_FORMAT_GLB:
        write_glb(file, mesh);
        is_text = false;
        break;
    case LS_MESH_FORMAT_COUNT:
        fail_msg("no format");
    }
    assert_int_equal(fclose(file), 0);
    assert_non_null(bytes);
    *size -= is_text ? 1 : 0;
    return bytes;
}
