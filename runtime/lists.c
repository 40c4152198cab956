#include "lists.h"

#include <stdlib.h>

// How far boxes of pairs grow, as a part of how far origins can lie from the far side of their
// object's box: what rounding can do to boxes, rays and tests is a third of it
// (docs/exactness.md).
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

static float max_component(LsVec3 v)
{
    const float largest = v.x > v.y ? v.x : v.y;
    return largest > v.z ? largest : v.z;
}

static float find_longest_side(const LsObject* object)
{
    return max_component((LsVec3){object->upper.x - object->lower.x,
                                  object->upper.y - object->lower.y,
                                  object->upper.z - object->lower.z});
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
    const float longest = 2.0f * find_longest_side(object);
    const float growth = (object->reach > longest ? object->reach : longest) * GROWTH;
    return (LsPairBox){.lower = grow(lower, object->lower, -growth),
                       .upper = grow(upper, object->lower, growth)};
}

static uint32_t count_boxes(const LsObject* object)
{
    return object->triangle_count / 2 + object->triangle_count % 2;
}

static void make_boxes(const LsFile* file, const LsObject* object, LsPairBox* boxes)
{
    for (uint32_t i = 0; i < count_boxes(object); i++)
    {
        const uint32_t left = object->triangle_count - 2 * i;
        boxes[i] =
            make_box(object, &file->triangles[object->first_triangle + 2 * i], left < 2 ? left : 2);
    }
}

// The box of an instance in the top level.
static void find_bounds(const LsFile* file, uint32_t instance, LsPassInstance* record)
{
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

// What the top level of a file without one would say of its only instance, which is not moved: its
// box grown by 2^-19 of the largest coordinate and 2^-15 of its longest side, and for a ray by
// 2^-19 of its origin's, many times what rounding can do (docs/exactness.md).
#define BOUND_WITHOUT_TOP_LEVEL 0x1p-19f

static void make_bounds(const LsObject* object, LsPassInstance* record)
{
    const LsVec3 opposite = {-object->lower.x, -object->lower.y, -object->lower.z};
    const float largest = max_component(max_vec3(opposite, object->upper));
    const float growth = largest * BOUND_WITHOUT_TOP_LEVEL + find_longest_side(object) * 0x1p-15f;
    const LsVec3 origin = {0};
    record->lower = grow(object->lower, origin, -growth);
    record->upper = grow(object->upper, origin, growth);
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
    if (ls_file_count(file, LS_CHUNK_TOP_NODES) != 0)
    {
        find_bounds(file, index, &record);
    }
    else
    {
        make_bounds(object, &record);
    }
    return record;
}

static LsResult upload_table(LsUpload* upload, const void* records, uint32_t count, uint32_t stride,
                             const char* name, LsArray* array, LsError* error)
{
    const LsArrayDesc desc = {.records = records,
                              .count = count,
                              .stride = stride,
                              .name = name,
                              .what = "the table of lists"};
    return count == 0 ? LS_OK : ls_array_create(upload, &desc, array, error);
}

LsResult ls_lists_create(LsUpload* upload, const LsFile* file, uint32_t grid_instance,
                         const char* name, LsLists* lists, LsError* error)
{
    *lists = (LsLists){
        .transform_bound = ls_file_count(file, LS_CHUNK_TOP_NODES) != 0
                               ? file->header->transform_bound
                               : BOUND_WITHOUT_TOP_LEVEL,
    };
    const uint32_t instance_count = ls_file_count(file, LS_CHUNK_INSTANCES);
    uint32_t box_count = 0;
    for (uint32_t i = 0; i < instance_count; i++)
    {
        const LsObject* object = &file->objects[file->instances[i].object];
        box_count += i == grid_instance ? 0 : count_boxes(object);
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
                make_boxes(file, object, boxes + box_count);
                box_count += count_boxes(object);
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
