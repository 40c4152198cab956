// pack_looks.c - surfaces, then textures, images and pixels that they reach, then corners.

#include "pack_looks.h"

#include <stdlib.h>
#include <string.h>

// Marks, then numbers: from the input's index to the file's, LS_NONE for what is left out.
typedef struct Numbers
{
    uint32_t* materials; // number of the surface
    uint32_t* textures;
    uint32_t* images;
} Numbers;

static LsResult report_memory(LsError* error)
{
    return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                        "out of memory for the looks in the arrays of the file");
}

static LsResult report_limit(LsError* error, const char* what, const char* remedy)
{
    return ls_error_set(error, LS_MESSAGE_LIMIT_RECORDS,
                        "the scene needs more %s than the format counts; %s", what, remedy);
}

static uint32_t* make_numbers(uint32_t count)
{
    uint32_t* numbers = malloc((count + 1ull) * sizeof *numbers);
    if (numbers != NULL)
    {
        memset(numbers, 0xFF, count * sizeof *numbers);
    }
    return numbers;
}

// Numbers in rising order what has been marked by another value than LS_NONE; returns the count.
static uint32_t number_marked(uint32_t* numbers, uint32_t count)
{
    uint32_t next = 0;
    for (uint32_t i = 0; i < count; i++)
    {
        numbers[i] = numbers[i] != LS_NONE ? next++ : LS_NONE;
    }
    return next;
}

// The five texture fields of a surface.
static void list_textures(LsSurface* surface, uint32_t* fields[5])
{
    fields[0] = &surface->base_color_texture;
    fields[1] = &surface->metallic_roughness_texture;
    fields[2] = &surface->normal_texture;
    fields[3] = &surface->emissive_texture;
    fields[4] = &surface->transmission_texture;
}

static bool is_default(const LsSurface* surface)
{
    static const LsSurface plain = LS_SURFACE_DEFAULT;
    return memcmp(surface, &plain, sizeof plain) == 0;
}

// ---- Materials ----------------------------------------------------------------------------------

static void mark_surfaces(const Numbers* numbers, LsInput* input, const LsMesh* meshes)
{
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        for (uint32_t k = 0; k < meshes[i].triangle_count; k++)
        {
            numbers->materials[meshes[i].triangles[k].material] = 0;
        }
    }
    for (uint32_t i = 0; i < input->material_count; i++)
    {
        LsSurface* surface = &input->materials[i].surface;
        if (numbers->materials[i] == LS_NONE || is_default(surface))
        {
            numbers->materials[i] = LS_NONE;
            continue;
        }
        uint32_t* fields[5];
        list_textures(surface, fields);
        for (int k = 0; k < 5; k++)
        {
            if (*fields[k] != LS_NONE)
            {
                numbers->textures[*fields[k]] = 0;
                numbers->images[input->textures[*fields[k]].image] = 0;
            }
        }
    }
}

static LsResult pack_surfaces(LsPackLooks* looks, LsFileDesc* desc, LsMaterial* materials,
                              LsInput* input, const Numbers* numbers, LsError* error)
{
    desc->SURFACES_count = number_marked(numbers->materials, input->material_count);
    desc->TEXTURES_count = number_marked(numbers->textures, input->texture_count);
    looks->surfaces = malloc((desc->SURFACES_count + 1ull) * sizeof *looks->surfaces);
    looks->textures = malloc((desc->TEXTURES_count + 1ull) * sizeof *looks->textures);
    if (looks->surfaces == NULL || looks->textures == NULL)
    {
        return report_memory(error);
    }
    for (uint32_t i = 0; i < input->material_count; i++)
    {
        uint32_t number = numbers->materials[i];
        materials[i].surface = number == LS_NONE ? 0 : number + 1;
        if (number != LS_NONE)
        {
            uint32_t* fields[5];
            LsSurface* surface = &looks->surfaces[number];
            *surface = input->materials[i].surface;
            list_textures(surface, fields);
            for (int k = 0; k < 5; k++)
            {
                *fields[k] = *fields[k] != LS_NONE ? numbers->textures[*fields[k]] : LS_NONE;
            }
        }
    }
    return LS_OK;
}

// Images in order; then textures can name them.
static LsResult pack_images(LsPackLooks* looks, LsFileDesc* desc, LsInput* input,
                            const Numbers* numbers, LsError* error)
{
    desc->IMAGES_count = number_marked(numbers->images, input->image_count);
    uint64_t pixels = 0;
    for (uint32_t i = 0; i < input->image_count; i++)
    {
        const LsInputImage* image = &input->images[i];
        pixels += numbers->images[i] != LS_NONE ? (uint64_t)image->width * image->height : 0;
    }
    if (pixels > UINT32_MAX)
    {
        return report_limit(error, "pixels", "use smaller images");
    }
    desc->PIXELS_count = (uint32_t)pixels;
    looks->images = malloc((desc->IMAGES_count + 1ull) * sizeof *looks->images);
    looks->pixels = malloc((pixels + 1) * sizeof *looks->pixels);
    if (looks->images == NULL || looks->pixels == NULL)
    {
        return report_memory(error);
    }
    uint32_t first = 0;
    for (uint32_t i = 0; i < input->image_count; i++)
    {
        LsInputImage* image = &input->images[i];
        if (numbers->images[i] != LS_NONE)
        {
            size_t count = (size_t)image->width * image->height;
            looks->images[numbers->images[i]] =
                (LsImage){.width = image->width, .height = image->height, .first_pixel = first};
            memcpy(looks->pixels + first, image->pixels, count * sizeof *looks->pixels);
            first += (uint32_t)count;
        }
        free(image->pixels);
        image->pixels = NULL;
    }
    for (uint32_t i = 0; i < input->texture_count; i++)
    {
        if (numbers->textures[i] != LS_NONE)
        {
            LsTexture* texture = &looks->textures[numbers->textures[i]];
            *texture = input->textures[i];
            texture->image = numbers->images[texture->image];
        }
    }
    return LS_OK;
}

static LsResult pack_materials(LsPackLooks* looks, LsFileDesc* desc, LsMaterial* materials,
                               LsInput* input, const LsMesh* meshes, LsError* error)
{
    const Numbers numbers = {.materials = make_numbers(input->material_count),
                             .textures = make_numbers(input->texture_count),
                             .images = make_numbers(input->image_count)};
    LsResult result;
    if (numbers.materials == NULL || numbers.textures == NULL || numbers.images == NULL)
    {
        result = report_memory(error);
    }
    else
    {
        mark_surfaces(&numbers, input, meshes);
        result = pack_surfaces(looks, desc, materials, input, &numbers, error);
        result = result == LS_OK ? pack_images(looks, desc, input, &numbers, error) : result;
    }
    free(numbers.materials);
    free(numbers.textures);
    free(numbers.images);
    return result;
}

// ---- Corners ------------------------------------------------------------------------------------

static LsResult count_corners(LsPackLooks* looks, LsFileDesc* desc, uint32_t mesh_count,
                              const LsMesh* meshes, LsError* error)
{
    uint64_t normals = 0, texcoords = 0, colors = 0;
    for (uint32_t i = 0; i < mesh_count; i++)
    {
        uint64_t corners = 3ull * meshes[i].triangle_count;
        const LsLooks* from = &meshes[i].looks;
        normals += from->normals != NULL ? corners : 0;
        texcoords += from->texcoords[0] != NULL ? corners : 0;
        texcoords += from->texcoords[1] != NULL ? corners : 0;
        colors += from->colors != NULL ? corners : 0;
    }
    if (normals > UINT32_MAX || texcoords > UINT32_MAX || colors > UINT32_MAX)
    {
        return report_limit(error, "normals, texture coordinates or colours at corners",
                            "leave normals out (--normals none), or bake fewer inputs at once");
    }
    desc->NORMALS_count = (uint32_t)normals;
    desc->TEXCOORDS_count = (uint32_t)texcoords;
    desc->COLORS_count = (uint32_t)colors;
    desc->ATTRIBUTES_count = normals + texcoords + colors > 0 ? mesh_count : 0;
    looks->attributes = malloc((desc->ATTRIBUTES_count + 1ull) * sizeof *looks->attributes);
    looks->normals = malloc((normals + 1) * sizeof *looks->normals);
    looks->texcoords = malloc((texcoords + 1) * sizeof *looks->texcoords);
    looks->colors = malloc((colors + 1) * sizeof *looks->colors);
    bool ok = looks->attributes && looks->normals && looks->texcoords && looks->colors;
    return ok ? LS_OK : report_memory(error);
}

// Copies the three records of each triangle, from the order of faces to that of triangles, behind
// the records so far; returns where they begin, LS_NONE without any.
static uint32_t copy_corners(const LsMesh* mesh, const void* source, size_t record, void* target,
                             uint64_t* count)
{
    if (source == NULL || mesh->triangle_count == 0)
    {
        return LS_NONE;
    }
    uint32_t first = (uint32_t)*count;
    for (uint32_t k = 0; k < mesh->triangle_count; k++)
    {
        memcpy((char*)target + (*count + 3ull * k) * record,
               (const char*)source + 3ull * mesh->triangles[k].primitive * record, 3 * record);
    }
    *count += 3ull * mesh->triangle_count;
    return first;
}

static void pack_corners(LsPackLooks* looks, const LsFileDesc* desc, uint32_t mesh_count,
                         LsMesh* meshes)
{
    uint64_t normals = 0, texcoords = 0, colors = 0;
    for (uint32_t i = 0; i < mesh_count && desc->ATTRIBUTES_count > 0; i++)
    {
        const LsMesh* mesh = &meshes[i];
        const LsLooks* from = &mesh->looks;
        LsAttributes* to = &looks->attributes[i];
        to->first_normal =
            copy_corners(mesh, from->normals, sizeof(uint32_t), looks->normals, &normals);
        for (int set = 0; set < 2; set++)
        {
            to->first_texcoord[set] = copy_corners(mesh, from->texcoords[set], sizeof(LsTexcoord),
                                                   looks->texcoords, &texcoords);
        }
        to->first_color =
            copy_corners(mesh, from->colors, sizeof(LsCornerColor), looks->colors, &colors);
        ls_looks_destroy(&meshes[i].looks);
    }
}

LsResult ls_pack_looks_create(LsPackLooks* looks, LsFileDesc* desc, LsMaterial* materials,
                              LsInput* input, LsMesh* meshes, LsError* error)
{
    *looks = (LsPackLooks){0};
    LsResult result = pack_materials(looks, desc, materials, input, meshes, error);
    result =
        result == LS_OK ? count_corners(looks, desc, input->mesh_count, meshes, error) : result;
    if (result != LS_OK)
    {
        ls_pack_looks_destroy(looks);
        return result;
    }
    pack_corners(looks, desc, input->mesh_count, meshes);
    desc->surfaces = looks->surfaces;
    desc->textures = looks->textures;
    desc->images = looks->images;
    desc->pixels = looks->pixels;
    desc->attributes = looks->attributes;
    desc->normals = looks->normals;
    desc->texcoords = looks->texcoords;
    desc->colors = looks->colors;
    return LS_OK;
}

void ls_pack_looks_destroy(LsPackLooks* looks)
{
    free(looks->surfaces);
    free(looks->textures);
    free(looks->images);
    free(looks->pixels);
    free(looks->attributes);
    free(looks->normals);
    free(looks->texcoords);
    free(looks->colors);
    *looks = (LsPackLooks){0};
}
