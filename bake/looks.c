// looks.c - streams of the input into records of the file, one kind after the other.

#include "looks.h"

#include "normals.h"
#include "octahedral.h"

#include <math.h>
#include <stdlib.h>

static LsResult report_memory(const LsInput* input, const LsInputMesh* mesh, LsError* error)
{
    return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                        "%s: out of memory for the looks of a mesh of %u faces",
                        input->paths[mesh->input_index], mesh->triangle_count);
}

static const char* mesh_name(const LsInputMesh* mesh)
{
    return mesh->name != NULL ? mesh->name : "without a name";
}

// The element of a stream at a corner, or NULL.
static const float* read_element(const LsInputMesh* mesh, LsStreamKind kind, uint64_t corner)
{
    const LsInputStream* stream = &mesh->streams[kind];
    uint32_t index = stream->indices != NULL ? stream->indices[corner] : mesh->indices[corner];
    return index < stream->count ? stream->values + (size_t)ls_stream_size(kind) * index : NULL;
}

// ---- Normals ------------------------------------------------------------------------------------

// The word of a normal of the input; counts those that are not finite.
static uint32_t encode_normal(const float* normal, uint32_t* broken)
{
    if (normal == NULL || (normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f))
    {
        return LS_NONE;
    }
    if (!isfinite(normal[0]) || !isfinite(normal[1]) || !isfinite(normal[2]))
    {
        ++*broken;
        return LS_NONE;
    }
    return ls_octahedral_encode((const double[3]){normal[0], normal[1], normal[2]});
}

static LsResult read_normals(LsLooks* looks, LsInput* input, const LsInputMesh* mesh,
                             const uint8_t* flat, LsError* error)
{
    uint32_t broken = 0;
    for (uint64_t corner = 0; corner < 3ull * mesh->triangle_count; corner++)
    {
        const float* normal = read_element(mesh, LS_STREAM_NORMAL, corner);
        uint32_t word = encode_normal(normal, &broken);
        looks->normals[corner] = flat[corner / 3] ? LS_NONE : word;
    }
    return broken == 0
               ? LS_OK
               : ls_input_warn(input, error, LS_MESSAGE_MESH_NORMAL,
                               "%s: mesh %s: %u corners have normals that are not finite numbers; "
                               "their faces' own are used, or repair the mesh",
                               input->paths[mesh->input_index], mesh_name(mesh), broken);
}

// Whether all normals say what the faces say themselves.
static bool is_flat_shaded(const LsLooks* looks, const LsInputMesh* mesh, const uint8_t* flat)
{
    for (uint32_t face = 0; face < mesh->triangle_count; face++)
    {
        double own[3] = {0.0, 0.0, 0.0};
        if (!flat[face])
        {
            ls_face_normal(mesh->positions, mesh->indices + 3 * (size_t)face, own);
        }
        for (int k = 0; k < 3; k++)
        {
            uint32_t word = looks->normals[3 * (size_t)face + k];
            if (word == LS_NONE)
            {
                continue;
            }
            double n[3];
            ls_octahedral_decode(word, n);
            double x = n[0] - own[0], y = n[1] - own[1], z = n[2] - own[2];
            // The input's normal is rounded itself.
            if (x * x + y * y + z * z > 1.2 * LS_OCTAHEDRAL_ERROR * LS_OCTAHEDRAL_ERROR)
            {
                return false;
            }
        }
    }
    return true;
}

static LsResult make_normals(LsLooks* looks, LsInput* input, const LsInputMesh* mesh,
                             const LsBakeDesc* desc, const LsLooksSource* source, LsError* error)
{
    bool given = desc->normals == LS_NORMALS_INPUT && mesh->streams[LS_STREAM_NORMAL].count > 0;
    if (!given && desc->normals != LS_NORMALS_SMOOTH)
    {
        return LS_OK;
    }
    looks->normals = malloc((3ull * mesh->triangle_count + 1) * sizeof *looks->normals);
    if (looks->normals == NULL)
    {
        return report_memory(input, mesh, error);
    }
    if (given)
    {
        LsResult result = read_normals(looks, input, mesh, source->flat, error);
        if (result != LS_OK)
        {
            return result;
        }
    }
    else
    {
        const LsSmoothFaces faces = {.positions = mesh->positions,
                                     .indices = mesh->indices,
                                     .corners = source->corners,
                                     .flat = source->flat,
                                     .face_count = mesh->triangle_count,
                                     .vertex_count = source->vertex_count};
        if (!ls_normals_smooth(&faces, desc->smooth_angle, source->threads, looks->normals))
        {
            return report_memory(input, mesh, error);
        }
    }
    if (is_flat_shaded(looks, mesh, source->flat))
    {
        free(looks->normals);
        looks->normals = NULL;
    }
    return LS_OK;
}

// ---- Texture coordinates ------------------------------------------------------------------------

// Sets of texture coordinates that a material's textures read: bit 0, bit 1.
static uint32_t find_texcoord_sets(const LsInput* input, uint32_t material)
{
    const LsSurface* surface = &input->materials[material].surface;
    const uint32_t textures[] = {surface->base_color_texture, surface->metallic_roughness_texture,
                                 surface->normal_texture, surface->emissive_texture,
                                 surface->transmission_texture};
    uint32_t sets = 0;
    for (size_t i = 0; i < sizeof textures / sizeof *textures; i++)
    {
        if (textures[i] < input->texture_count)
        {
            sets |= 1u << (input->textures[textures[i]].texcoord & 1u);
        }
    }
    return sets;
}

static LsResult read_texcoords(LsLooks* looks, LsInput* input, const LsInputMesh* mesh, int set,
                               LsError* error)
{
    uint64_t count = 3ull * mesh->triangle_count;
    LsTexcoord* out = calloc(count + 1, sizeof *out);
    looks->texcoords[set] = out;
    if (out == NULL)
    {
        return report_memory(input, mesh, error);
    }
    uint32_t broken = 0;
    for (uint64_t corner = 0; corner < count; corner++)
    {
        const float* uv = read_element(mesh, LS_STREAM_TEXCOORD_0 + set, corner);
        if (uv != NULL && isfinite(uv[0]) && isfinite(uv[1]))
        {
            out[corner] = (LsTexcoord){uv[0] + 0.0f, uv[1] + 0.0f};
        }
        else
        {
            broken += uv != NULL;
        }
    }
    return broken == 0
               ? LS_OK
               : ls_input_warn(input, error, LS_MESSAGE_MESH_TEXCOORD,
                               "%s: mesh %s: %u corners have texture coordinates that are not "
                               "finite numbers; (0, 0) is used, or repair the mesh",
                               input->paths[mesh->input_index], mesh_name(mesh), broken);
}

static LsResult make_texcoords(LsLooks* looks, LsInput* input, const LsInputMesh* mesh,
                               LsError* error)
{
    uint32_t wanted = 0;
    for (uint32_t face = 0, sets = 0; face < mesh->triangle_count && wanted != 3; face++)
    {
        const uint32_t* material = &mesh->materials[face];
        sets =
            face > 0 && material[0] == material[-1] ? sets : find_texcoord_sets(input, *material);
        for (int set = 0; set < 2; set++)
        {
            if ((sets & ~wanted) >> set & 1 && mesh->streams[LS_STREAM_TEXCOORD_0 + set].count == 0)
            {
                const char* name = input->materials[*material].name;
                LsResult result = ls_input_warn(
                    input, error, LS_MESSAGE_MESH_NO_TEXCOORD,
                    "%s: mesh %s: textures of the material %s read texture coordinates %d, which "
                    "the mesh does not have, so they do not show; unwrap the mesh",
                    input->paths[mesh->input_index], mesh_name(mesh),
                    name != NULL ? name : "without a name", set);
                if (result != LS_OK)
                {
                    return result;
                }
            }
        }
        wanted |= sets;
    }
    for (int set = 0; set < 2; set++)
    {
        if ((wanted >> set & 1) != 0 && mesh->streams[LS_STREAM_TEXCOORD_0 + set].count > 0)
        {
            LsResult result = read_texcoords(looks, input, mesh, set, error);
            if (result != LS_OK)
            {
                return result;
            }
        }
    }
    return LS_OK;
}

// ---- Colours ------------------------------------------------------------------------------------

static uint32_t to_unorm16(float value)
{
    return value > 0.0f ? (uint32_t)lrint(fmin((double)value, 1.0) * 65535.0) : 0;
}

static LsResult make_colors(LsLooks* looks, const LsInput* input, const LsInputMesh* mesh,
                            LsError* error)
{
    if (mesh->streams[LS_STREAM_COLOR].count == 0)
    {
        return LS_OK;
    }
    uint64_t count = 3ull * mesh->triangle_count;
    looks->colors = malloc((count + 1) * sizeof *looks->colors);
    if (looks->colors == NULL)
    {
        return report_memory(input, mesh, error);
    }
    bool white = true;
    for (uint64_t corner = 0; corner < count; corner++)
    {
        const float* c = read_element(mesh, LS_STREAM_COLOR, corner);
        LsCornerColor color = {UINT32_MAX, UINT32_MAX};
        if (c != NULL)
        {
            color.red_green = to_unorm16(c[0]) | to_unorm16(c[1]) << 16;
            color.blue_alpha = to_unorm16(c[2]) | to_unorm16(c[3]) << 16;
        }
        looks->colors[corner] = color;
        white = white && color.red_green == UINT32_MAX && color.blue_alpha == UINT32_MAX;
    }
    if (white)
    {
        free(looks->colors);
        looks->colors = NULL;
    }
    return LS_OK;
}

LsResult ls_looks_create(LsLooks* looks, LsInput* input, uint32_t index, const LsBakeDesc* desc,
                         const LsLooksSource* source, LsError* error)
{
    *looks = (LsLooks){0};
    const LsInputMesh* mesh = &input->meshes[index];
    uint32_t warning_count = input->warning_count;
    LsResult result = make_normals(looks, input, mesh, desc, source, error);
    result = result == LS_OK ? make_texcoords(looks, input, mesh, error) : result;
    result = result == LS_OK ? make_colors(looks, input, mesh, error) : result;
    // A warning belongs to the file being read, and that is none any more.
    for (uint32_t i = warning_count; i < input->warning_count; i++)
    {
        input->warnings[i].input_index = mesh->input_index;
    }
    if (result != LS_OK)
    {
        ls_looks_destroy(looks);
    }
    return result;
}

void ls_looks_destroy(LsLooks* looks)
{
    free(looks->normals);
    free(looks->texcoords[0]);
    free(looks->texcoords[1]);
    free(looks->colors);
    *looks = (LsLooks){0};
}
