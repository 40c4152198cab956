// pack.c - concatenates objects; every index stays relative to its object's part.

#include "pack.h"

#include "bvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Most of the room that a growing array has too much.
#define SPARE_BYTES (64u << 20)

static LsResult report_memory(LsError* error)
{
    return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                        "out of memory for the arrays of the file");
}

static LsResult count_records(LsPack* pack, const LsInput* input, const LsMesh* meshes,
                              const LsBakedObject* baked, LsError* error)
{
    uint64_t triangles = 0, blocks = 0, cell_blocks = 0, subgrids = 0, voxels = 0, references = 0,
             leaf_nodes = 0;
    uint64_t shafts = 0;
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        const LsVoxels* v = &baked[i].voxels;
        triangles += meshes[i].triangle_count;
        blocks += v->block_count;
        cell_blocks += v->cell_block_count;
        subgrids += v->subgrid_count;
        voxels += v->voxel_count;
        references += v->reference_count;
        leaf_nodes += v->leaf_node_count;
        shafts += (uint64_t)baked[i].scene_shafts.word_count + baked[i].tables.word_count;
    }
    const uint64_t counts[] = {triangles, blocks,     cell_blocks, subgrids,
                               voxels,    references, leaf_nodes,  shafts};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    {
        if (counts[i] > UINT32_MAX)
        {
            return ls_error_set(error, LS_MESSAGE_LIMIT_RECORDS,
                                "the scene needs more records than the format counts; use a "
                                "coarser --grid or fewer --patches");
        }
    }
    pack->desc.TRIANGLES_count = (uint32_t)triangles;
    pack->desc.BLOCKS_count = (uint32_t)blocks;
    pack->desc.CELL_BLOCKS_count = (uint32_t)cell_blocks;
    pack->desc.SUBGRIDS_count = (uint32_t)subgrids;
    pack->desc.VOXELS_count = (uint32_t)voxels;
    pack->desc.REFERENCES_count = (uint32_t)references;
    pack->desc.LEAF_NODES_count = (uint32_t)leaf_nodes;
    pack->desc.SHAFTS_count = (uint32_t)shafts;
    pack->objects = calloc(input->mesh_count + 1ull, sizeof *pack->objects);
    pack->materials = malloc((input->material_count + 1ull) * sizeof *pack->materials);
    const bool ok = pack->objects != NULL && pack->materials != NULL;
    return ok ? LS_OK : report_memory(error);
}

// Tables begin behind the words of the scene's shafts.
static LsVoxel pack_voxel(const LsWorkVoxel* work, uint32_t scene_words)
{
    LsVoxel voxel = {.first_reference = work->first_reference,
                     .reference_count = work->reference_count,
                     .shape = work->kind,
                     .table = work->table};
    if (work->kind == LS_VOXEL_MASKS)
    {
        voxel.shape |= work->patches << 8; // and masks of exact width
        voxel.table += scene_words;
    }
    return voxel;
}

// Everything of an object but its first_* fields, which follow from the objects before.
static LsObject describe_object(const LsMesh* mesh, const LsBakedObject* baked, uint32_t patches)
{
    LsObject object = {
        .lower = {mesh->lower[0], mesh->lower[1], mesh->lower[2]},
        .upper = {mesh->upper[0], mesh->upper[1], mesh->upper[2]},
        .kind = baked->has_grid ? LS_OBJECT_GRID : LS_OBJECT_LIST,
        .triangle_count = mesh->triangle_count,
        .face_count = mesh->face_count,
    };
    double longest = 0.0;
    for (int axis = 0; axis < 3; axis++)
    {
        longest = fmax(longest, (double)mesh->upper[axis] - mesh->lower[axis]);
    }
    object.reach = ls_float_below(2.0 * longest);
    if (baked->has_grid)
    {
        const LsVoxels* voxels = &baked->voxels;
        const LsGridFrame* frame = &voxels->frame;
        object.grid_lower = (LsVec3){frame->lower[0], frame->lower[1], frame->lower[2]};
        object.inverse_cell = frame->inverse_cell;
        memcpy(object.cells, frame->cells, sizeof object.cells);
        object.bound = frame->bound;
        object.block_count = voxels->block_count;
        object.cell_block_count = voxels->cell_block_count;
        object.subgrid_count = voxels->subgrid_count;
        object.voxel_count = voxels->voxel_count;
        object.reference_count = voxels->reference_count;
        object.leaf_node_count = voxels->leaf_node_count;
        object.shaft_word_count = baked->scene_shafts.word_count + baked->tables.word_count;
        object.depth = voxels->depth;
        object.patches = patches;
        object.scene_patches = baked->scene_shafts.patches;
    }
    return object;
}

uint64_t ls_pack_spare(uint64_t bytes)
{
    return bytes / 16 < SPARE_BYTES ? bytes / 16 : SPARE_BYTES;
}

// Growing moves pages, not bytes, where the system can. False when out of memory.
static bool append_copy(LsPackArray* array, const void* part, uint64_t count, size_t size)
{
    if (array->count + count > array->capacity)
    {
        const uint64_t needed = array->count + count;
        const uint64_t capacity = needed + ls_pack_spare(needed * size) / size;
        void* records = realloc(array->records, capacity * size);
        if (records == NULL)
        {
            return false;
        }
        array->records = records;
        array->capacity = capacity;
    }
    if (count > 0)
    {
        memcpy((char*)array->records + array->count * size, part, count * size);
    }
    array->count += count;
    return true;
}

// Appends a part that malloc made, which is not the caller's any more: the first becomes the array
// itself.
static bool append_part(LsPackArray* array, void* part, uint64_t count, size_t size)
{
    if (array->records == NULL && count > 0)
    {
        *array = (LsPackArray){.records = part, .count = count, .capacity = count};
        return true;
    }
    const bool ok = append_copy(array, part, count, size);
    free(part);
    return ok;
}

static bool append_tables(LsPackArray* array, LsTables* tables)
{
    bool ok = true;
    for (uint32_t b = 0; b < tables->block_count && ok; b++)
    {
        LsTableBlock* block = &tables->blocks[b];
        ok = append_copy(array, block->words, block->word_count, sizeof *block->words);
        ls_table_block_destroy(block);
    }
    return ok;
}

static bool append_voxels(LsPackArray* array, LsVoxels* work, uint32_t scene_words)
{
    LsVoxel* voxels = malloc((work->voxel_count + 1ull) * sizeof *voxels);
    if (voxels == NULL)
    {
        return false;
    }
    for (uint32_t i = 0; i < work->voxel_count; i++)
    {
        voxels[i] = pack_voxel(&work->voxels[i], scene_words);
    }
    free(work->voxels);
    work->voxels = NULL;
    return append_part(array, voxels, work->voxel_count, sizeof *voxels);
}

// Takes an object's arrays over, all it had. False when out of memory: the caller still has what is
// left.
static bool append_object(LsPack* pack, LsObject object, LsMesh* mesh, LsBakedObject* baked)
{
    LsVoxels* voxels = &baked->voxels;
    object.first_triangle = (uint32_t)pack->triangles.count;
    object.first_block = (uint32_t)pack->blocks.count;
    object.first_cell_block = (uint32_t)pack->cell_blocks.count;
    object.first_subgrid = (uint32_t)pack->subgrids.count;
    object.first_voxel = (uint32_t)pack->voxels.count;
    object.first_reference = (uint32_t)pack->references.count;
    object.first_leaf_node = (uint32_t)pack->leaf_nodes.count;
    object.first_shaft_word = (uint32_t)pack->shafts.count;
    pack->objects[pack->desc.OBJECTS_count++] = object;

    bool ok = true;
#define APPEND(array, part, count)                                   \
    if (ok)                                                          \
    {                                                                \
        ok = append_part(&(array), (part), (count), sizeof *(part)); \
        (part) = NULL;                                               \
    }
    APPEND(pack->triangles, mesh->triangles, object.triangle_count)
    APPEND(pack->blocks, voxels->blocks, object.block_count)
    APPEND(pack->cell_blocks, voxels->cell_blocks, object.cell_block_count)
    APPEND(pack->subgrids, voxels->subgrids, object.subgrid_count)
    APPEND(pack->references, voxels->references, object.reference_count)
    APPEND(pack->leaf_nodes, voxels->leaf_nodes, object.leaf_node_count)
    ok = ok && append_voxels(&pack->voxels, voxels, baked->scene_shafts.word_count);
    APPEND(pack->shafts, baked->scene_shafts.words, baked->scene_shafts.word_count)
#undef APPEND
    return ok && append_tables(&pack->shafts, &baked->tables);
}

LsResult ls_pack_create(LsPack* pack, LsInput* input, LsMesh* meshes, LsBakedObject* baked,
                        const LsWorld* world, uint32_t patches, LsError* error)
{
    *pack = (LsPack){0};
    LsFileDesc* desc = &pack->desc;
    LsResult result = count_records(pack, input, meshes, baked, error);
    for (uint32_t i = 0; i < input->material_count && result == LS_OK; i++)
    {
        pack->materials[i] = input->materials[i].core;
    }
    result = result == LS_OK
                 ? ls_pack_looks_create(&pack->looks, desc, pack->materials, input, meshes, error)
                 : result;
    if (result != LS_OK)
    {
        ls_pack_destroy(pack);
        return result;
    }
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        const LsObject object = describe_object(&meshes[i], &baked[i], patches);
        if (!append_object(pack, object, &meshes[i], &baked[i]))
        {
            ls_pack_destroy(pack);
            return report_memory(error);
        }
        ls_mesh_destroy(&meshes[i]);
        ls_voxels_destroy(&baked[i].voxels);
        ls_scene_shafts_destroy(&baked[i].scene_shafts);
        ls_tables_destroy(&baked[i].tables);
    }
    desc->objects = pack->objects;
    desc->triangles = pack->triangles.records;
    desc->blocks = pack->blocks.records;
    desc->cell_blocks = pack->cell_blocks.records;
    desc->subgrids = pack->subgrids.records;
    desc->voxels = pack->voxels.records;
    desc->references = pack->references.records;
    desc->leaf_nodes = pack->leaf_nodes.records;
    desc->shafts = pack->shafts.records;
    desc->instances = world->instances;
    desc->INSTANCES_count = world->instance_count;
    desc->top_nodes = world->top_nodes;
    desc->TOP_NODES_count = world->top_node_count;
    desc->lights = world->lights;
    desc->LIGHTS_count = world->light_count;
    desc->nodes = input->nodes;
    desc->NODES_count = input->node_count;
    desc->materials = pack->materials;
    desc->MATERIALS_count = input->material_count;
    desc->cameras = input->cameras;
    desc->CAMERAS_count = input->camera_count;
    desc->lamps = input->lamps;
    desc->LAMPS_count = input->lamp_count;
    desc->animations = input->animations;
    desc->ANIMATIONS_count = input->animation_count;
    desc->channels = input->channels;
    desc->CHANNELS_count = input->channel_count;
    desc->keys = input->keys;
    desc->KEYS_count = input->key_count;
    memcpy(desc->lower, world->lower, sizeof desc->lower);
    memcpy(desc->upper, world->upper, sizeof desc->upper);
    desc->transform_bound = world->transform_bound;
    return LS_OK;
}

void ls_pack_destroy(LsPack* pack)
{
    free(pack->objects);
    free(pack->triangles.records);
    free(pack->blocks.records);
    free(pack->cell_blocks.records);
    free(pack->subgrids.records);
    free(pack->voxels.records);
    free(pack->references.records);
    free(pack->leaf_nodes.records);
    free(pack->shafts.records);
    free(pack->materials);
    ls_pack_looks_destroy(&pack->looks);
    *pack = (LsPack){0};
}
