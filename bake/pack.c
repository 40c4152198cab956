// pack.c - concatenates objects; every index stays relative to its object's part.

#include "pack.h"

#include "bvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
        shafts += baked[i].tables.word_count;
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
    pack->triangles = malloc((triangles + 1) * sizeof *pack->triangles);
    pack->blocks = malloc((blocks + 1) * sizeof *pack->blocks);
    pack->cell_blocks = malloc((cell_blocks + 1) * sizeof *pack->cell_blocks);
    pack->subgrids = malloc((subgrids + 1) * sizeof *pack->subgrids);
    pack->voxels = malloc((voxels + 1) * sizeof *pack->voxels);
    pack->references = malloc((references + 1) * sizeof *pack->references);
    pack->leaf_nodes = malloc((leaf_nodes + 1) * sizeof *pack->leaf_nodes);
    pack->shafts = malloc((shafts + 1) * sizeof *pack->shafts);
    pack->materials = malloc((input->material_count + 1ull) * sizeof *pack->materials);
    bool ok = pack->objects && pack->triangles && pack->blocks && pack->cell_blocks &&
              pack->subgrids && pack->voxels && pack->references && pack->leaf_nodes &&
              pack->shafts && pack->materials;
    return ok ? LS_OK
              : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                             "out of memory for the arrays of the file");
}

static LsVoxel pack_voxel(const LsWorkVoxel* work)
{
    LsVoxel voxel = {.first_reference = work->first_reference,
                     .reference_count = work->reference_count,
                     .shape = work->kind,
                     .table = work->table};
    if (work->kind == LS_VOXEL_MASKS)
    {
        voxel.shape |= work->patches << 8; // and masks of exact width
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
        object.shaft_word_count = baked->tables.word_count;
        object.depth = voxels->depth;
        object.patches = patches;
    }
    return object;
}

static void append_object(LsPack* pack, LsObject* next, LsObject object, const LsMesh* mesh,
                          const LsBakedObject* baked)
{
    const LsVoxels* voxels = &baked->voxels;
    object.first_triangle = next->first_triangle;
    object.first_block = next->first_block;
    object.first_cell_block = next->first_cell_block;
    object.first_subgrid = next->first_subgrid;
    object.first_voxel = next->first_voxel;
    object.first_reference = next->first_reference;
    object.first_leaf_node = next->first_leaf_node;
    object.first_shaft_word = next->first_shaft_word;

    // An array that is empty may be NULL, which memcpy does not take.
#define COPY(target, source, count) \
    if ((count) > 0)                \
    memcpy((target), (source), sizeof *(target) * (size_t)(count))
    COPY(pack->triangles + object.first_triangle, mesh->triangles, object.triangle_count);
    COPY(pack->blocks + object.first_block, voxels->blocks, object.block_count);
    COPY(pack->cell_blocks + object.first_cell_block, voxels->cell_blocks, object.cell_block_count);
    COPY(pack->subgrids + object.first_subgrid, voxels->subgrids, object.subgrid_count);
    COPY(pack->references + object.first_reference, voxels->references, object.reference_count);
    COPY(pack->leaf_nodes + object.first_leaf_node, voxels->leaf_nodes, object.leaf_node_count);
#undef COPY
    ls_tables_copy(&baked->tables, pack->shafts + object.first_shaft_word);
    for (uint32_t v = 0; v < object.voxel_count; v++)
    {
        pack->voxels[object.first_voxel + v] = pack_voxel(&voxels->voxels[v]);
    }

    next->first_triangle += object.triangle_count;
    next->first_block += object.block_count;
    next->first_cell_block += object.cell_block_count;
    next->first_subgrid += object.subgrid_count;
    next->first_voxel += object.voxel_count;
    next->first_reference += object.reference_count;
    next->first_leaf_node += object.leaf_node_count;
    next->first_shaft_word += object.shaft_word_count;
    pack->objects[pack->desc.OBJECTS_count++] = object;
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
    LsObject next = {0};
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        append_object(pack, &next, describe_object(&meshes[i], &baked[i], patches), &meshes[i],
                      &baked[i]);
        ls_mesh_destroy(&meshes[i]);
        ls_voxels_destroy(&baked[i].voxels);
        ls_tables_destroy(&baked[i].tables);
    }
    desc->objects = pack->objects;
    desc->triangles = pack->triangles;
    desc->blocks = pack->blocks;
    desc->cell_blocks = pack->cell_blocks;
    desc->subgrids = pack->subgrids;
    desc->voxels = pack->voxels;
    desc->references = pack->references;
    desc->leaf_nodes = pack->leaf_nodes;
    desc->shafts = pack->shafts;
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
    free(pack->triangles);
    free(pack->blocks);
    free(pack->cell_blocks);
    free(pack->subgrids);
    free(pack->voxels);
    free(pack->references);
    free(pack->leaf_nodes);
    free(pack->shafts);
    free(pack->materials);
    ls_pack_looks_destroy(&pack->looks);
    *pack = (LsPack){0};
}
