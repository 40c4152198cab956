// lsinfo_summary.c - one pass over a checked file.

#include "lsinfo_summary.h"

static uint64_t count_filled(const uint32_t* table, uint64_t shafts, uint32_t width)
{
    uint64_t filled = 0;
    for (uint64_t i = 0; i < shafts; ++i)
    {
        filled += ls_mask_read(table, i, width) != 0;
    }
    return filled;
}

static void add_voxels(LsSummary* summary, const LsFile* file, const LsObject* object)
{
    for (uint32_t i = 0; i < object->voxel_count; ++i)
    {
        const LsVoxel* voxel = &file->voxels[object->first_voxel + i];
        ++summary->voxel_kind_count[voxel->shape & 255];
        if ((voxel->shape & 255) != LS_VOXEL_MASKS)
        {
            continue;
        }
        const uint32_t patches = voxel->shape >> 8 & 255;
        const uint64_t shafts = LS_SHAFT_COUNT(patches);
        const uint32_t* table = file->shafts + object->first_shaft_word + voxel->table;
        summary->shaft_count += shafts;
        summary->filled_shaft_count += count_filled(table, shafts, ls_mask_width(voxel));
        if (summary->patches_least == 0 || patches < summary->patches_least)
        {
            summary->patches_least = patches;
        }
        summary->patches_most = patches > summary->patches_most ? patches : summary->patches_most;
    }
}

static void add_scene_shafts(LsSummary* summary, const LsFile* file, const LsObject* object)
{
    const uint32_t patches = object->scene_patches;
    const uint64_t shafts = LS_SHAFT_COUNT(patches);
    for (uint64_t i = 0; i < shafts; ++i)
    {
        summary->filled_scene_shaft_count += file->shafts[object->first_shaft_word + i] != 0;
    }
    summary->scene_shaft_count += shafts;
}

static void add_looks(LsSummary* summary, const LsFile* file)
{
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_SURFACES); ++i)
    {
        summary->masked_surface_count += (file->surfaces[i].flags & LS_SURFACE_MASK) != 0;
    }
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_ATTRIBUTES); ++i)
    {
        const LsAttributes* attributes = &file->attributes[i];
        summary->normal_object_count += attributes->first_normal != LS_NONE;
        summary->texcoord_object_count[0] += attributes->first_texcoord[0] != LS_NONE;
        summary->texcoord_object_count[1] += attributes->first_texcoord[1] != LS_NONE;
        summary->color_object_count += attributes->first_color != LS_NONE;
    }
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_NORMALS); ++i)
    {
        summary->bare_corner_count += file->normals[i] == LS_NONE;
    }
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_LAMPS); ++i)
    {
        ++summary->lamp_kind_count[file->lamps[i].kind];
    }
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_ANIMATIONS); ++i)
    {
        const LsAnimation* animation = &file->animations[i];
        summary->animated_node_count += animation->channel_count / 3;
        if ((double)animation->duration > summary->longest_animation)
        {
            summary->longest_animation = (double)animation->duration;
        }
    }
}

LsSummary ls_summarize(const LsFile* file)
{
    LsSummary summary = {.triangle_count = ls_file_count(file, LS_CHUNK_TRIANGLES)};
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_OBJECTS); ++i)
    {
        const LsObject* object = &file->objects[i];
        summary.face_count += object->face_count;
        if (object->kind == LS_OBJECT_LIST)
        {
            ++summary.list_object_count;
            continue;
        }
        ++summary.grid_object_count;
        summary.cell_count += (uint64_t)object->cells[0] * object->cells[1] * object->cells[2];
        add_voxels(&summary, file, object);
        add_scene_shafts(&summary, file, object);
    }
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_INSTANCES); ++i)
    {
        const LsObject* object = &file->objects[file->instances[i].object];
        summary.instanced_triangle_count += object->triangle_count;
    }
    add_looks(&summary, file);
    uint64_t used = LS_HEADER_BYTES + file->header->chunk_count * (uint64_t)LS_ENTRY_BYTES;
    for (uint32_t i = 0; i < file->header->chunk_count; ++i)
    {
        used += file->entries[i].stored_bytes;
    }
    summary.padding_bytes = file->size - used;
    return summary;
}

const char* ls_explain_absence(const LsFile* file, LsChunk chunk)
{
    const bool lists_only = (file->header->required_features & LS_FEATURE_GRIDS) == 0;
    switch (chunk)
    {
    case LS_CHUNK_TOP_NODES:
        return "top level: one object, one instance, the identity";
    case LS_CHUNK_NODES:
        return "node hierarchy: the input has none";
    case LS_CHUNK_LIGHTS:
        return "lights: no emissive triangle";
    case LS_CHUNK_CAMERAS:
        return "cameras: the input has none";
    case LS_CHUNK_BLOCKS:
        return "grids: every object is a list of few triangles";
    case LS_CHUNK_CELL_BLOCKS:
        return lists_only ? "cells: no object has a grid" : "cells: every block is empty";
    case LS_CHUNK_VOXELS:
        return lists_only ? "voxels: no object has a grid" : "voxels: every cell is empty";
    case LS_CHUNK_REFERENCES:
        return lists_only ? "references: no object has a grid" : "references: no voxel is filled";
    case LS_CHUNK_SUBGRIDS:
        return "sub-grids: no voxel is divided";
    case LS_CHUNK_LEAF_NODES:
        return "leaf BVHs: no voxel needs one";
    case LS_CHUNK_SHAFTS:
        return "shaft masks: no voxel has enough triangles for them";
    case LS_CHUNK_SURFACES:
        return "surfaces: no material has transmission, holes or textures";
    case LS_CHUNK_TEXTURES:
        return "textures: no surface has one";
    case LS_CHUNK_IMAGES:
        return "images: no texture uses one";
    case LS_CHUNK_PIXELS:
        return "pixels: there are no images";
    case LS_CHUNK_ATTRIBUTES:
        return "attributes: no object has normals, texture coordinates or colours";
    case LS_CHUNK_NORMALS:
        return "normals: no object has any, or those of the faces are meant";
    case LS_CHUNK_TEXCOORDS:
        return "texture coordinates: no object has any, or no texture needs them";
    case LS_CHUNK_COLORS:
        return "colours of corners: no object has any";
    case LS_CHUNK_LAMPS:
        return "lamps: the input has none";
    case LS_CHUNK_ANIMATIONS:
        return "animations: the input has none";
    case LS_CHUNK_CHANNELS:
        return "channels: there are no animations";
    case LS_CHUNK_KEYS:
        return "keys: there are no animations";
    default:
        return "absent";
    }
}
