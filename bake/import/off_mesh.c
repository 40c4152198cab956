// off_mesh.c - what text and binary OFF files have in common: the mesh they become.

#include "off_mesh.h"

#include "srgb.h"

#include <limits.h>
#include <math.h>
#include <string.h>

LsResult ls_off_fail_face(const LsOff* off, LsMessage message, uint64_t face, const char* text)
{
    return ls_error_set(off->error, (int)message, "%s: face %llu: %s", off->path,
                        (unsigned long long)face, text);
}

LsResult ls_off_check_counts(const LsOff* off)
{
    if (off->vertex_count <= INT_MAX && off->face_count < LS_NONE && off->triangle_count < LS_NONE)
        return LS_OK;
    return ls_error_set(off->error, LS_MESSAGE_LIMIT_MESH,
                        "%s: more than 2147483647 vertices or 4294967294 triangles; split the mesh",
                        off->path);
}

static void note_color(float* largest, const float* color, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        *largest = fmaxf(*largest, color[i]);
}

static void store_color(float target[4], const float* color, uint32_t count, float largest)
{
    const float scale = largest > 1.0f ? 255.0f : 1.0f;
    for (uint32_t i = 0; i < 3; i++)
        target[i] = ls_linear_from_srgb(color[i] / scale);
    target[3] = count == 4 ? fminf(fmaxf(color[3] / scale, 0.0f), 1.0f) : 1.0f;
}

void ls_off_add_vertex(LsOff* off, uint64_t vertex, const float* numbers, uint32_t color_count)
{
    LsInputMesh* mesh = off->mesh;
    const float* normal = numbers + 3;
    const float* color = normal + (off->has_normals ? 3 : 0);
    const float* texcoord = color + (off->has_colors ? color_count : 0);
    if (!mesh)
    {
        if (off->has_colors)
            note_color(&off->largest_color, color, color_count);
        return;
    }
    memcpy(&mesh->positions[3 * vertex], numbers, 3 * sizeof *numbers);
    if (off->has_normals)
        memcpy(&mesh->streams[LS_STREAM_NORMAL].values[3 * vertex], normal, 3 * sizeof *normal);
    if (off->has_colors)
        store_color(&mesh->streams[LS_STREAM_COLOR].values[4 * vertex], color, color_count,
                    off->largest_color);
    if (off->has_texcoords)
    {
        float* target = &mesh->streams[LS_STREAM_TEXCOORD_0].values[2 * vertex];
        target[0] = texcoord[0];
        target[1] = 1.0f - texcoord[1];
    }
}

void ls_off_begin_face(LsOff* off, uint64_t face, uint64_t corner_count)
{
    if (corner_count < 3 && !off->is_first_done && off->small_face_count++ == 0)
        off->first_small_face = face;
}

LsResult ls_off_add_corner(LsOff* off, uint64_t face, uint64_t corner, int64_t vertex)
{
    if (vertex < 0 || (uint64_t)vertex >= off->vertex_count)
        return ls_error_set(off->error, LS_MESSAGE_OFF_CORNER,
                            "%s: face %llu names vertex %lld, but the file has %llu, numbered from "
                            "0; export it again",
                            off->path, (unsigned long long)face, (long long)vertex,
                            (unsigned long long)off->vertex_count);
    if (corner >= 2)
    {
        const uint64_t triangle = off->triangle_count++;
        LsInputMesh* mesh = off->mesh;
        if (mesh && triangle >= mesh->triangle_count)
            return ls_error_set(off->error, LS_MESSAGE_FILE_CHANGED,
                                "%s: changed while it was read; try again when nobody writes it",
                                off->path);
        if (mesh)
        {
            mesh->indices[3 * triangle] = off->fan[0];
            mesh->indices[3 * triangle + 1] = off->fan[1];
            mesh->indices[3 * triangle + 2] = (uint32_t)vertex;
        }
    }
    off->fan[corner > 0] = (uint32_t)vertex;
    return LS_OK;
}

void ls_off_color_face(LsOff* off, uint64_t face, uint64_t first_triangle, const float* color,
                       uint32_t color_count)
{
    if (!off->mesh)
    {
        off->has_face_colors |= color_count > 0;
        note_color(&off->largest_face_color, color, color_count);
        return;
    }
    LsInputStream* stream = &off->mesh->streams[LS_STREAM_COLOR];
    if (!stream->indices)
        return;
    for (uint64_t i = 3 * first_triangle; i < 3 * off->triangle_count; i++)
        stream->indices[i] = color_count ? (uint32_t)face : LS_NONE;
    if (color_count)
        store_color(&stream->values[4 * face], color, color_count, off->largest_face_color);
}

static LsResult warn_of_counted(const LsOff* off)
{
    LsResult result = LS_OK;
    if (off->small_face_count)
        result = ls_input_warn(off->input, off->error, LS_MESSAGE_OFF_SMALL_FACES,
                               "%s: %llu of its faces have fewer than three corners, the first is "
                               "face %llu; they are left out",
                               off->path, (unsigned long long)off->small_face_count,
                               (unsigned long long)off->first_small_face);
    if (result == LS_OK && off->has_face_colors && off->has_colors)
        result = ls_input_warn(off->input, off->error, LS_MESSAGE_OFF_FACE_COLORS,
                               "%s: its faces have colours beside those of its vertices; they are "
                               "left out",
                               off->path);
    if (result == LS_OK && off->triangle_count == 0 && off->vertex_count)
        result = ls_input_warn(off->input, off->error, LS_MESSAGE_OFF_POINTS,
                               "%s: its %llu vertices are points without faces; they are left out",
                               off->path, (unsigned long long)off->vertex_count);
    return result;
}

LsResult ls_off_create_mesh(LsOff* off)
{
    off->is_first_done = true;
    LsResult result = warn_of_counted(off);
    if (result != LS_OK || off->triangle_count == 0)
        return result;
    result = ls_off_check_counts(off);
    if (result != LS_OK)
        return result;
    const bool colors_faces = off->has_face_colors && !off->has_colors;
    const uint64_t vertex_bytes = 12 + (off->has_normals ? 12u : 0u) +
                                  (off->has_colors ? 16u : 0u) + (off->has_texcoords ? 8u : 0u);
    uint64_t bytes = vertex_bytes * off->vertex_count + 16 * off->triangle_count;
    if (colors_faces)
        bytes += 16 * off->face_count + 12 * off->triangle_count;
    result = ls_input_reserve(off->input, off->path, bytes, off->triangle_count, off->error);
    if (result != LS_OK)
        return result;
    const uint32_t vertex_count = (uint32_t)off->vertex_count;
    LsInputMesh* mesh =
        ls_input_add_plain_mesh(off->input, vertex_count, (uint32_t)off->triangle_count);
    off->mesh = mesh;
    off->triangle_count = 0;
    if (!mesh ||
        (off->has_normals &&
         !ls_input_stream_create(mesh, LS_STREAM_NORMAL, vertex_count, false)) ||
        (off->has_colors && !ls_input_stream_create(mesh, LS_STREAM_COLOR, vertex_count, false)) ||
        (off->has_texcoords &&
         !ls_input_stream_create(mesh, LS_STREAM_TEXCOORD_0, vertex_count, false)) ||
        (colors_faces &&
         !ls_input_stream_create(mesh, LS_STREAM_COLOR, (uint32_t)off->face_count, true)))
        return ls_error_set(off->error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s: out of memory while reading it", off->path);
    return LS_OK;
}
