#include "lists.h"

#include <float.h>
#include <stdlib.h>

// How far boxes grow, as a part of an object's `reach`, which is twice its longest side: what
// rounding can do to boxes, rays and tests is a third of it (docs/exactness.md).
static const float GROWTH = 0x1p-17f;

static LsVec3 min_vec3(LsVec3 a, LsVec3 b)
{
    return (LsVec3){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}

static LsVec3 max_vec3(LsVec3 a, LsVec3 b)
{
    return (LsVec3){a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}

// First from the corner: growth may be less than what coordinates far from 0 can tell apart.
static LsVec3 grow(LsVec3 v, LsVec3 corner, float growth)
{
    return (LsVec3){(v.x - corner.x) + growth, (v.y - corner.y) + growth,
                    (v.z - corner.z) + growth};
}

static LsPairBox make_box(const LsObject* object, const LsTriangle* pair, uint32_t count)
{
    LsVec3 lower = pair[0].v0;
    LsVec3 upper = pair[0].v0;
    for (uint32_t i = 0; i < count; i++)
    {
        lower = min_vec3(min_vec3(lower, pair[i].v0), min_vec3(pair[i].v1, pair[i].v2));
        upper = max_vec3(max_vec3(upper, pair[i].v0), max_vec3(pair[i].v1, pair[i].v2));
    }
    const float growth = object->reach * GROWTH;
    return (LsPairBox){.lower = grow(lower, object->lower, -growth),
                       .upper = grow(upper, object->lower, growth)};
}

// The boxes of a list. Returns their number; `boxes` may be NULL.
static uint32_t make_boxes(const LsFile* file, const LsObject* object, LsPairBox* boxes)
{
    const uint32_t count = object->triangle_count / 2 + object->triangle_count % 2;
    for (uint32_t i = 0; i < count && boxes; i++)
    {
        const uint32_t left = object->triangle_count - 2 * i;
        boxes[i] =
            make_box(object, &file->triangles[object->first_triangle + 2 * i], left < 2 ? left : 2);
    }
    return count;
}

// The box of an instance in world space. Without a top level there is one instance, which every
// ray is carried into.
static void find_bounds(const LsFile* file, uint32_t instance, LsPassInstance* record)
{
    record->lower = (LsVec3){-FLT_MAX, -FLT_MAX, -FLT_MAX};
    record->upper = (LsVec3){FLT_MAX, FLT_MAX, FLT_MAX};
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_TOP_NODES); i++)
    {
        const LsBvhNode* node = &file->top_nodes[i];
        if (node->leaf != 0 && node->leaf >> 4 == instance)
        {
            record->lower = node->lower;
            record->upper = node->upper;
        }
    }
}

static LsPassInstance make_instance(const LsFile* file, uint32_t index, uint32_t first_box)
{
    const LsInstance* instance = &file->instances[index];
    const LsObject* object = &file->objects[instance->object];
    LsPassInstance record = {
        .mask = instance->mask,
        .flags = instance->flags,
        .object_from_world = {instance->object_from_world[0], instance->object_from_world[1],
                              instance->object_from_world[2]},
        .object_lower = object->lower,
        .reach = object->reach,
        .object_upper = object->upper,
        .first_box = first_box,
        .instance = index,
        .object = instance->object,
        .first_triangle = object->first_triangle,
        .triangle_count = object->triangle_count,
    };
    find_bounds(file, index, &record);
    return record;
}

static LsResult upload_table(LsUpload* upload, const void* records, uint32_t count, uint32_t stride,
                             const char* name, LsArray* array, LsError* error)
{
    const LsArrayDesc desc = {
        .records = records, .count = count, .stride = stride, .name = name, .what = "the lists"};
    return count == 0 ? LS_OK : ls_array_create(upload, &desc, array, error);
}

LsResult ls_lists_create(LsUpload* upload, const LsFile* file, uint32_t grid_instance,
                         const char* name, LsLists* lists, LsError* error)
{
    *lists = (LsLists){0};
    const uint32_t instance_count = ls_file_count(file, LS_CHUNK_INSTANCES);
    uint32_t box_count = 0;
    for (uint32_t i = 0; i < instance_count; i++)
    {
        const LsObject* object = &file->objects[file->instances[i].object];
        box_count += i == grid_instance ? 0 : make_boxes(file, object, NULL);
    }
    LsPassInstance* instances = malloc(instance_count * sizeof *instances);
    LsPairBox* boxes = malloc((box_count + 1) * sizeof *boxes);
    LsResult result = LS_OK;
    if (!instances || !boxes)
    {
        result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory for lists", name);
    }
    else
    {
        box_count = 0;
        for (uint32_t i = 0; i < instance_count; i++)
        {
            if (i != grid_instance)
            {
                const LsObject* object = &file->objects[file->instances[i].object];
                instances[lists->list_count++] = make_instance(file, i, box_count);
                box_count += make_boxes(file, object, boxes + box_count);
            }
        }
        instances[lists->list_count] = make_instance(file, grid_instance, 0);
        result = upload_table(upload, instances, instance_count, sizeof *instances, name,
                              &lists->instances, error);
    }
    if (result == LS_OK)
    {
        result = upload_table(upload, boxes, box_count, sizeof *boxes, name, &lists->boxes, error);
    }
    free(instances);
    free(boxes);
    return result;
}

void ls_lists_destroy(const LsContext* context, LsLists* lists)
{
    ls_array_destroy(context, &lists->instances);
    ls_array_destroy(context, &lists->boxes);
    *lists = (LsLists){0};
}
