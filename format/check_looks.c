// check_looks.c - SPEC R4.12 to R4.18: surfaces and their textures, attributes of corners, lamps.

#include "check.h"

static bool is_index(uint32_t index, uint32_t count)
{
    return index < count || index == LS_NONE;
}

static LsResult check_surfaces(const LsCheck* check)
{
    const uint32_t texture_count = count_records(check, LS_CHUNK_TEXTURES);
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_SURFACES); ++i)
    {
        const LsSurface* surface = &check->file->surfaces[i];
        if (!is_fraction(surface->transmission) || !is_fraction(surface->alpha) ||
            !(surface->ior == 0 || (isfinite(surface->ior) && surface->ior >= 1)))
        {
            return ls_check_report(check, "R4.12", LS_CHUNK_SURFACES, i,
                                   "transmission %g, alpha %g, index of refraction %g",
                                   (double)surface->transmission, (double)surface->alpha,
                                   (double)surface->ior);
        }
        if (!(isfinite(surface->alpha_cutoff) && surface->alpha_cutoff >= 0) ||
            !isfinite(surface->normal_scale) || (surface->flags & ~LS_SURFACE_MASK) != 0 ||
            surface->reserved != 0)
        {
            return ls_check_report(check, "R4.12", LS_CHUNK_SURFACES, i,
                                   "cutoff %g, normal scale %g, flags 0x%x, reserved 0x%x",
                                   (double)surface->alpha_cutoff, (double)surface->normal_scale,
                                   surface->flags, surface->reserved);
        }
        const uint32_t textures[] = {surface->base_color_texture,
                                     surface->metallic_roughness_texture, surface->normal_texture,
                                     surface->emissive_texture, surface->transmission_texture};
        for (size_t k = 0; k < sizeof(textures) / sizeof(textures[0]); ++k)
        {
            if (!is_index(textures[k], texture_count))
            {
                return ls_check_report(check, "R4.12", LS_CHUNK_SURFACES, i, "texture %u of %u",
                                       textures[k], texture_count);
            }
        }
    }
    return LS_OK;
}

static bool is_texture_row(LsVec4 row)
{
    return isfinite(row.x) && isfinite(row.y) && isfinite(row.z) && row.w == 0;
}

static LsResult check_textures(const LsCheck* check)
{
    const uint32_t image_count = count_records(check, LS_CHUNK_IMAGES);
    const uint32_t both_u = LS_TEXTURE_CLAMP_U | LS_TEXTURE_MIRROR_U;
    const uint32_t both_v = LS_TEXTURE_CLAMP_V | LS_TEXTURE_MIRROR_V;
    const uint32_t known_flags = LS_TEXTURE_SRGB | both_u | both_v | LS_TEXTURE_NEAREST;
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_TEXTURES); ++i)
    {
        const LsTexture* texture = &check->file->textures[i];
        if (!is_texture_row(texture->row_u) || !is_texture_row(texture->row_v))
        {
            return ls_check_report(check, "R4.13", LS_CHUNK_TEXTURES, i,
                                   "a row is not finite, or its fourth number not zero");
        }
        if (texture->image >= image_count || texture->texcoord > 1)
        {
            return ls_check_report(check, "R4.13", LS_CHUNK_TEXTURES, i,
                                   "image %u of %u, texture coordinates %u of 2", texture->image,
                                   image_count, texture->texcoord);
        }
        if ((texture->flags & ~known_flags) != 0 || (texture->flags & both_u) == both_u ||
            (texture->flags & both_v) == both_v || texture->reserved != 0)
        {
            return ls_check_report(check, "R4.13", LS_CHUNK_TEXTURES, i,
                                   "flags 0x%x, reserved 0x%x", texture->flags, texture->reserved);
        }
    }
    return LS_OK;
}

static LsResult check_images(const LsCheck* check)
{
    const uint32_t pixel_count = count_records(check, LS_CHUNK_PIXELS);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_IMAGES); ++i)
    {
        const LsImage* image = &check->file->images[i];
        if (image->width < 1 || image->width > LS_MAX_IMAGE_SIDE || image->height < 1 ||
            image->height > LS_MAX_IMAGE_SIDE || image->reserved != 0)
        {
            return ls_check_report(check, "R4.14", LS_CHUNK_IMAGES, i,
                                   "%u x %u pixels, reserved 0x%x", image->width, image->height,
                                   image->reserved);
        }
        const uint64_t size = (uint64_t)image->width * image->height;
        if (image->first_pixel != sum || size > pixel_count - sum)
        {
            return ls_check_report(
                check, "R4.14", LS_CHUNK_IMAGES, i, "%llu pixels from %u, the next is %llu of %u",
                (unsigned long long)size, image->first_pixel, (unsigned long long)sum, pixel_count);
        }
        sum += size;
    }
    if (sum != pixel_count)
    {
        return ls_check_report(check, "R4.14", LS_CHUNK_PIXELS, sum, "it belongs to no image");
    }
    return LS_OK;
}

// Takes the part of object `index` that begins at `first`, if it has one; *sum is how much of the
// chunk is taken.
static LsResult take_part(const LsCheck* check, uint32_t index, LsChunk chunk, uint32_t first,
                          uint64_t* sum)
{
    if (first == LS_NONE)
    {
        return LS_OK;
    }
    const uint64_t size = 3ull * check->file->objects[index].triangle_count;
    const uint32_t count = count_records(check, chunk);
    if (first != *sum || size > count - *sum)
    {
        return ls_check_report(check, "R4.15", LS_CHUNK_ATTRIBUTES, index,
                               "%llu records of %s from %u, the next is %llu of %u",
                               (unsigned long long)size, ls_chunk_info(chunk).name, first,
                               (unsigned long long)*sum, count);
    }
    *sum += size;
    return LS_OK;
}

static LsResult check_attributes(const LsCheck* check)
{
    const uint32_t attribute_count = count_records(check, LS_CHUNK_ATTRIBUTES);
    const uint32_t object_count = count_records(check, LS_CHUNK_OBJECTS);
    if (attribute_count != 0 && attribute_count != object_count)
    {
        return ls_check_report(check, "R4.15", LS_CHUNK_ATTRIBUTES, 0, "%u records for %u objects",
                               attribute_count, object_count);
    }
    uint64_t sums[LS_CHUNK_COUNT] = {0};
    for (uint32_t i = 0; i < attribute_count; ++i)
    {
        const LsAttributes* attributes = &check->file->attributes[i];
        const struct
        {
            LsChunk chunk;
            uint32_t first;
        } parts[] = {
            {LS_CHUNK_NORMALS, attributes->first_normal},
            {LS_CHUNK_TEXCOORDS, attributes->first_texcoord[0]},
            {LS_CHUNK_TEXCOORDS, attributes->first_texcoord[1]},
            {LS_CHUNK_COLORS, attributes->first_color},
        };
        for (size_t k = 0; k < sizeof(parts) / sizeof(parts[0]); ++k)
        {
            const LsResult result =
                take_part(check, i, parts[k].chunk, parts[k].first, &sums[parts[k].chunk]);
            if (result != LS_OK)
            {
                return result;
            }
        }
    }
    static const LsChunk chunks[] = {LS_CHUNK_NORMALS, LS_CHUNK_TEXCOORDS, LS_CHUNK_COLORS};
    for (size_t k = 0; k < sizeof(chunks) / sizeof(chunks[0]); ++k)
    {
        if (sums[chunks[k]] != count_records(check, chunks[k]))
        {
            return ls_check_report(check, "R4.15", chunks[k], sums[chunks[k]],
                                   "it belongs to no object");
        }
    }
    return LS_OK;
}

static LsResult check_normals(const LsCheck* check)
{
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_NORMALS); ++i)
    {
        const uint32_t word = check->file->normals[i];
        if ((word & 0xFFFF) == 0x8000 || word >> 16 == 0x8000)
        {
            return ls_check_report(check, "R4.16", LS_CHUNK_NORMALS, i, "0x%08x holds a -32768",
                                   word);
        }
    }
    return LS_OK;
}

static LsResult check_texcoords(const LsCheck* check)
{
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_TEXCOORDS); ++i)
    {
        const LsTexcoord* texcoord = &check->file->texcoords[i];
        if (!isfinite(texcoord->u) || !isfinite(texcoord->v))
        {
            return ls_check_report(check, "R4.17", LS_CHUNK_TEXCOORDS, i, "(%g, %g)",
                                   (double)texcoord->u, (double)texcoord->v);
        }
    }
    return LS_OK;
}

static bool is_lamp_place(const LsLamp* lamp)
{
    const LsVec3 d = lamp->direction;
    if (lamp->kind == LS_LAMP_DIRECTIONAL &&
        !(lamp->position.x == 0 && lamp->position.y == 0 && lamp->position.z == 0))
    {
        return false;
    }
    if (lamp->kind == LS_LAMP_POINT && !(d.x == 0 && d.y == 0 && d.z == -1))
    {
        return false;
    }
    return is_finite_point(lamp->position) &&
           is_unit((double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z);
}

static LsResult check_lamps(const LsCheck* check)
{
    const uint32_t node_count = count_records(check, LS_CHUNK_NODES);
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_LAMPS); ++i)
    {
        const LsLamp* lamp = &check->file->lamps[i];
        if (lamp->kind > LS_LAMP_DIRECTIONAL || !is_index(lamp->node, node_count) ||
            !is_zero(lamp->reserved, sizeof(lamp->reserved)))
        {
            return ls_check_report(check, "R4.18", LS_CHUNK_LAMPS, i,
                                   "kind %u, node %u of %u, or a reserved word", lamp->kind,
                                   lamp->node, node_count);
        }
        if (!is_lamp_place(lamp))
        {
            return ls_check_report(check, "R4.18", LS_CHUNK_LAMPS, i,
                                   "kind %u at (%g, %g, %g) towards (%g, %g, %g)", lamp->kind,
                                   (double)lamp->position.x, (double)lamp->position.y,
                                   (double)lamp->position.z, (double)lamp->direction.x,
                                   (double)lamp->direction.y, (double)lamp->direction.z);
        }
        const LsVec3 intensity = lamp->intensity;
        if (!is_finite_point(intensity) ||
            !(intensity.x >= 0 && intensity.y >= 0 && intensity.z >= 0) ||
            !(isfinite(lamp->range) && lamp->range >= 0))
        {
            return ls_check_report(check, "R4.18", LS_CHUNK_LAMPS, i,
                                   "intensity (%g, %g, %g), range %g", (double)intensity.x,
                                   (double)intensity.y, (double)intensity.z, (double)lamp->range);
        }
        const bool cone = lamp->kind == LS_LAMP_SPOT
                              ? lamp->cos_outer >= -1 && lamp->cos_outer <= lamp->cos_inner &&
                                    lamp->cos_inner <= 1
                              : lamp->cos_inner == 1 && lamp->cos_outer == -1;
        if (!cone)
        {
            return ls_check_report(check, "R4.18", LS_CHUNK_LAMPS, i, "cosines %g and %g",
                                   (double)lamp->cos_inner, (double)lamp->cos_outer);
        }
    }
    return LS_OK;
}

LsResult ls_check_looks(const LsCheck* check)
{
    static LsResult (*const steps[])(const LsCheck*) = {
        check_surfaces, check_textures,  check_images, check_attributes,
        check_normals,  check_texcoords, check_lamps,
    };
    for (size_t i = 0; i < sizeof(steps) / sizeof(steps[0]); ++i)
    {
        const LsResult result = steps[i](check);
        if (result != LS_OK)
        {
            return result;
        }
    }
    return LS_OK;
}
