// file_check.c - the rules of SPEC chapters 2 to 6 that look into chunks, one function per topic.
//
// Each chunk is passed once, in order. Partitions and "exactly one" rules become running counters: what
// must come next is known, so nothing is remembered and nothing allocated.

#include "file_layout.h"
#include "hash.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct Check
{
    const LsFile* file;
    const char* name;
    LsError* error;
} Check;

// Reports a broken rule: file, rule, chunk, record, what is wrong with it.
LS_PRINTF(5, 6)
static LsResult report_rule(const Check* check, const char* rule, LsChunk chunk, uint64_t record,
                            const char* format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    return ls_error_set(check->error, LS_ERROR_RULE, "%s: %s: %s record %llu: %s", check->name,
                        rule, ls_chunk_info(chunk).name, (unsigned long long)record, text);
}

// An object's part of an array that may be absent.
#define PART(array, first) ((array) != NULL ? (array) + (first) : NULL)

static uint32_t count_records(const Check* check, LsChunk chunk)
{
    return ls_file_count(check->file, chunk);
}

// ---- Numbers ------------------------------------------------------------------------------------

// Comparisons with NaN are false, so these need no separate test for it.
static bool is_box(LsVec3 lower, LsVec3 upper)
{
    return (lower.x >= -FLT_MAX) & (lower.x <= upper.x) & (upper.x <= FLT_MAX) &
           (lower.y >= -FLT_MAX) & (lower.y <= upper.y) & (upper.y <= FLT_MAX) &
           (lower.z >= -FLT_MAX) & (lower.z <= upper.z) & (upper.z <= FLT_MAX);
}

static bool is_inside(LsVec3 point, LsVec3 lower, LsVec3 upper)
{
    return (point.x >= lower.x) & (point.x <= upper.x) & (point.y >= lower.y) &
           (point.y <= upper.y) & (point.z >= lower.z) & (point.z <= upper.z);
}

static bool is_finite_point(LsVec3 point)
{
    return isfinite(point.x) && isfinite(point.y) && isfinite(point.z);
}

static bool is_finite_matrix(const LsVec4 rows[3])
{
    bool finite = true;
    for (int i = 0; i < 3; ++i)
    {
        finite = finite && isfinite(rows[i].x) && isfinite(rows[i].y) && isfinite(rows[i].z) &&
                 isfinite(rows[i].w);
    }
    return finite;
}

static bool is_identity_matrix(const LsVec4 rows[3])
{
    static const LsVec4 identity[3] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    bool same = true;
    for (int i = 0; i < 3; ++i)
    {
        same = same && rows[i].x == identity[i].x && rows[i].y == identity[i].y &&
               rows[i].z == identity[i].z && rows[i].w == identity[i].w;
    }
    return same;
}

static bool is_fraction(float value)
{
    return value >= 0 && value <= 1;
}

static bool is_zero(const void* bytes, uint64_t size)
{
    const uint8_t* first = bytes;
    return size == 0 || (*first == 0 && memcmp(first, first + 1, size - 1) == 0);
}

// ---- Chapters 2 and 4: scene --------------------------------------------------------------------

static LsResult check_features(const Check* check)
{
    const LsFile* file = check->file;
    const uint64_t derived =
        derive_required_features(file->objects, file->instances, file->header->counts);
    if (file->header->required_features != derived)
    {
        return ls_error_set(check->error, LS_ERROR_RULE,
                            "%s: R2.14: required features 0x%llx, the file uses 0x%llx",
                            check->name, (unsigned long long)file->header->required_features,
                            (unsigned long long)derived);
    }
    return LS_OK;
}

static LsResult check_presence(const Check* check)
{
    static const LsChunk needed[] = {LS_CHUNK_OBJECTS, LS_CHUNK_INSTANCES, LS_CHUNK_MATERIALS,
                                     LS_CHUNK_TRIANGLES};
    for (size_t i = 0; i < sizeof(needed) / sizeof(needed[0]); ++i)
    {
        if (count_records(check, needed[i]) == 0)
        {
            return ls_error_set(check->error, LS_ERROR_RULE, "%s: R4.1: no %s", check->name,
                                ls_chunk_info(needed[i]).name);
        }
    }
    return LS_OK;
}

static LsResult check_list_object(const Check* check, uint32_t index)
{
    const LsObject* object = &check->file->objects[index];
    const uint32_t grid_counts = object->block_count | object->cell_block_count |
                                 object->subgrid_count | object->voxel_count |
                                 object->reference_count | object->leaf_node_count |
                                 object->shaft_word_count;
    if (grid_counts != 0)
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index, "a list with grid arrays");
    }
    if (!is_zero(&object->grid_lower, sizeof(object->grid_lower)) ||
        !is_zero(&object->inverse_cell, sizeof(object->inverse_cell)) ||
        !is_zero(object->cells, sizeof(object->cells)) ||
        !is_zero(&object->bound, sizeof(object->bound)) || object->depth != 0 ||
        object->patches != 0)
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index,
                           "a list with grid fields that are not zero");
    }
    return LS_OK;
}

static uint32_t count_blocks_along(const LsObject* object, int axis)
{
    return (object->cells[axis] + LS_BLOCK_SIDE - 1) / LS_BLOCK_SIDE;
}

static LsResult check_grid_object(const Check* check, uint32_t index)
{
    const LsObject* object = &check->file->objects[index];
    if (object->patches < 1 || object->patches > LS_MAX_PATCHES)
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index, "%u patches", object->patches);
    }
    for (int axis = 0; axis < 3; ++axis)
    {
        if (object->cells[axis] < 1 || object->cells[axis] > LS_MAX_CELLS)
        {
            return report_rule(check, "R5.1", LS_CHUNK_OBJECTS, index, "%u cells along axis %d",
                               object->cells[axis], axis);
        }
    }
    if (!(isfinite(object->inverse_cell) && object->inverse_cell > 0) ||
        !is_finite_point(object->grid_lower))
    {
        return report_rule(check, "R5.1", LS_CHUNK_OBJECTS, index,
                           "%g cells per unit from (%g, %g, %g)", (double)object->inverse_cell,
                           (double)object->grid_lower.x, (double)object->grid_lower.y,
                           (double)object->grid_lower.z);
    }
    if (!(object->bound > 0 && object->bound < 0.25f / (float)(1u << (2 * object->depth))))
    {
        return report_rule(check, "R5.1", LS_CHUNK_OBJECTS, index, "bound %g at depth %u",
                           (double)object->bound, object->depth);
    }
    const uint64_t blocks = (uint64_t)count_blocks_along(object, 0) *
                            count_blocks_along(object, 1) * count_blocks_along(object, 2);
    if (object->block_count != blocks)
    {
        return report_rule(check, "R5.2", LS_CHUNK_OBJECTS, index, "%u blocks, the grid has %llu",
                           object->block_count, (unsigned long long)blocks);
    }
    if (object->subgrid_count > object->cell_block_count)
    {
        return report_rule(check, "R5.6", LS_CHUNK_OBJECTS, index, "%u sub-grids in %u cell blocks",
                           object->subgrid_count, object->cell_block_count);
    }
    return LS_OK;
}

static LsResult check_object(const Check* check, uint32_t index)
{
    const LsObject* object = &check->file->objects[index];
    if (object->kind > LS_OBJECT_GRID)
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index, "kind %u", object->kind);
    }
    if (!is_box(object->lower, object->upper))
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index, "box not finite or inverted");
    }
    if (!(isfinite(object->reach) && object->reach >= 0))
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index, "reach %g",
                           (double)object->reach);
    }
    if (object->triangle_count < 1 || object->face_count < object->triangle_count)
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index, "%u triangles of %u faces",
                           object->triangle_count, object->face_count);
    }
    if (object->depth > LS_MAX_DEPTH || object->reserved != 0)
    {
        return report_rule(check, "R4.3", LS_CHUNK_OBJECTS, index, "depth %u, reserved 0x%x",
                           object->depth, object->reserved);
    }
    return object->kind == LS_OBJECT_LIST ? check_list_object(check, index)
                                          : check_grid_object(check, index);
}

static LsResult check_objects(const Check* check)
{
    const LsFile* file = check->file;
    uint64_t sums[LS_CHUNK_COUNT] = {0};
    uint32_t depth = 0;
    const uint32_t object_count = count_records(check, LS_CHUNK_OBJECTS);
    for (uint32_t i = 0; i < object_count; ++i)
    {
        const LsObject* object = &file->objects[i];
        const struct
        {
            LsChunk chunk;
            uint32_t first, count;
        } parts[] = {
            {LS_CHUNK_TRIANGLES, object->first_triangle, object->triangle_count},
            {LS_CHUNK_BLOCKS, object->first_block, object->block_count},
            {LS_CHUNK_CELL_BLOCKS, object->first_cell_block, object->cell_block_count},
            {LS_CHUNK_SUBGRIDS, object->first_subgrid, object->subgrid_count},
            {LS_CHUNK_VOXELS, object->first_voxel, object->voxel_count},
            {LS_CHUNK_REFERENCES, object->first_reference, object->reference_count},
            {LS_CHUNK_LEAF_NODES, object->first_leaf_node, object->leaf_node_count},
            {LS_CHUNK_SHAFTS, object->first_shaft_word, object->shaft_word_count},
        };
        for (size_t k = 0; k < sizeof(parts) / sizeof(parts[0]); ++k)
        {
            uint64_t* sum = &sums[parts[k].chunk];
            const uint32_t total = count_records(check, parts[k].chunk);
            const bool last = i + 1 == object_count;
            if (parts[k].first != *sum || parts[k].count > total - *sum ||
                (last && *sum + parts[k].count != total))
            {
                return report_rule(check, "R4.2", LS_CHUNK_OBJECTS, i,
                                   "%u records of %s from %u, %llu of %u are left to it",
                                   parts[k].count, ls_chunk_info(parts[k].chunk).name,
                                   parts[k].first, (unsigned long long)(total - *sum), total);
            }
            *sum += parts[k].count;
        }
        const LsResult result = check_object(check, i);
        if (result != LS_OK)
        {
            return result;
        }
        depth = object->depth > depth ? object->depth : depth;
    }
    if (file->header->depth != depth)
    {
        return ls_error_set(check->error, LS_ERROR_RULE,
                            "%s: R2.11: depth %u, the deepest object has %u", check->name,
                            file->header->depth, depth);
    }
    return LS_OK;
}

static LsResult check_triangles(const Check* check, uint32_t object_index)
{
    const LsObject object = check->file->objects[object_index];
    const LsTriangle* triangles = check->file->triangles + object.first_triangle;
    const uint32_t material_count = count_records(check, LS_CHUNK_MATERIALS);
    for (uint32_t i = 0; i < object.triangle_count; ++i)
    {
        const LsTriangle* triangle = &triangles[i];
        const bool inside = is_inside(triangle->v0, object.lower, object.upper) &&
                            is_inside(triangle->v1, object.lower, object.upper) &&
                            is_inside(triangle->v2, object.lower, object.upper);
        if (inside && triangle->primitive < object.face_count &&
            triangle->material < material_count && triangle->reserved == 0)
        {
            continue;
        }
        const uint64_t record = (uint64_t)object.first_triangle + i;
        if (!inside)
        {
            return report_rule(check, "R4.4", LS_CHUNK_TRIANGLES, record,
                               "a corner outside the box of object %u", object_index);
        }
        return report_rule(check, "R4.4", LS_CHUNK_TRIANGLES, record,
                           "primitive %u of %u, material %u of %u, reserved 0x%x",
                           triangle->primitive, object.face_count, triangle->material,
                           material_count, triangle->reserved);
    }
    return LS_OK;
}

static LsResult check_instances(const Check* check)
{
    const uint32_t object_count = count_records(check, LS_CHUNK_OBJECTS);
    const uint32_t node_count = count_records(check, LS_CHUNK_NODES);
    const uint32_t known_flags = LS_INSTANCE_MIRRORED | LS_INSTANCE_IDENTITY;
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_INSTANCES); ++i)
    {
        const LsInstance* instance = &check->file->instances[i];
        if (!is_finite_matrix(instance->object_from_world) ||
            !is_finite_matrix(instance->world_from_object))
        {
            return report_rule(check, "R4.5", LS_CHUNK_INSTANCES, i, "a matrix is not finite");
        }
        if (instance->object >= object_count ||
            (instance->node >= node_count && instance->node != LS_NONE))
        {
            return report_rule(check, "R4.5", LS_CHUNK_INSTANCES, i,
                               "object %u of %u, node %u of %u", instance->object, object_count,
                               instance->node, node_count);
        }
        if (instance->mask > 255 || (instance->flags & ~known_flags) != 0 ||
            !is_zero(instance->reserved, sizeof(instance->reserved)))
        {
            return report_rule(check, "R4.5", LS_CHUNK_INSTANCES, i,
                               "mask 0x%x, flags 0x%x, or a reserved word", instance->mask,
                               instance->flags);
        }
        if ((instance->flags & LS_INSTANCE_IDENTITY) != 0 &&
            !(is_identity_matrix(instance->object_from_world) &&
              is_identity_matrix(instance->world_from_object)))
        {
            return report_rule(check, "R4.5", LS_CHUNK_INSTANCES, i,
                               "flagged as the identity, which its matrices are not");
        }
    }
    return LS_OK;
}

// R4.7 for the `count` nodes from record `first` of a chunk.
static LsResult check_bvh(const Check* check, LsChunk chunk, const LsBvhNode* nodes, uint32_t first,
                          uint32_t count)
{
    if (nodes[0].escape != count)
    {
        return report_rule(check, "R4.7", chunk, first, "the root escapes to %u of %u nodes",
                           nodes[0].escape, count);
    }
    for (uint32_t i = 0; i < count; ++i)
    {
        const LsBvhNode* node = &nodes[i];
        const uint64_t record = (uint64_t)first + i;
        if (!is_box(node->lower, node->upper))
        {
            return report_rule(check, "R4.7", chunk, record, "box not finite or inverted");
        }
        const bool inner = node->leaf == 0;
        const bool escapes =
            inner ? node->escape > i + 1 && node->escape <= count : node->escape == i + 1;
        if (!escapes || (!inner && (node->leaf & 15) == 0))
        {
            return report_rule(check, "R4.7", chunk, record, "escape %u, leaf 0x%x in %u nodes",
                               node->escape, node->leaf, count);
        }
        // Hop over the children: the last escapes to where the parent does. As long as that held for
        // all nodes before, every node is hopped over once, so the pass stays linear.
        uint32_t child = inner ? i + 1 : node->escape;
        while (child < node->escape)
        {
            child = nodes[child].escape > child ? nodes[child].escape : UINT32_MAX;
        }
        if (child != node->escape)
        {
            return report_rule(check, "R4.7", chunk, record, "a child does not escape within it");
        }
    }
    return LS_OK;
}

// Each instance in exactly one leaf: as many leaves as instances, and none alike. The second is looked
// at for so many instances at a time as a small table holds.
static LsResult check_top_leaves(const Check* check)
{
    const LsBvhNode* nodes = check->file->top_nodes;
    const uint32_t node_count = count_records(check, LS_CHUNK_TOP_NODES);
    const uint32_t instance_count = count_records(check, LS_CHUNK_INSTANCES);
    uint32_t leaf_count = 0;
    for (uint32_t i = 0; i < node_count; ++i)
    {
        const uint32_t leaf = nodes[i].leaf;
        if (leaf != 0 && ((leaf & 15) != 1 || leaf >> 4 >= instance_count))
        {
            return report_rule(check, "R4.6", LS_CHUNK_TOP_NODES, i,
                               "a leaf of %u instances from %u; there are %u", leaf & 15, leaf >> 4,
                               instance_count);
        }
        leaf_count += leaf != 0;
    }
    if (leaf_count != instance_count)
    {
        return report_rule(check, "R4.6", LS_CHUNK_TOP_NODES, 0, "%u leaves for %u instances",
                           leaf_count, instance_count);
    }
    uint64_t seen[4096];
    const uint64_t window = 64 * sizeof(seen) / sizeof(seen[0]);
    for (uint64_t start = 0; start < instance_count; start += window)
    {
        memset(seen, 0, sizeof(seen));
        for (uint32_t i = 0; i < node_count; ++i)
        {
            const uint64_t place = (nodes[i].leaf >> 4) - start;
            if (nodes[i].leaf == 0 || place >= window)
            {
                continue;
            }
            const uint64_t bit = 1ull << place % 64;
            if ((seen[place / 64] & bit) != 0)
            {
                return report_rule(check, "R4.6", LS_CHUNK_TOP_NODES, i,
                                   "instance %u stands in two leaves", nodes[i].leaf >> 4);
            }
            seen[place / 64] |= bit;
        }
    }
    return LS_OK;
}

static LsResult check_top_nodes(const Check* check)
{
    const uint32_t count = count_records(check, LS_CHUNK_TOP_NODES);
    const bool needed = (check->file->header->required_features & LS_FEATURE_TOP_LEVEL) != 0;
    if (needed != (count > 0))
    {
        return ls_error_set(check->error, LS_ERROR_RULE, "%s: R4.6: TOP_NODES %s", check->name,
                            needed ? "are missing" : "without need of a top level");
    }
    if (count == 0)
    {
        return LS_OK;
    }
    const LsResult result = check_bvh(check, LS_CHUNK_TOP_NODES, check->file->top_nodes, 0, count);
    return result != LS_OK ? result : check_top_leaves(check);
}

static LsResult check_nodes(const Check* check)
{
    const LsSceneNode* nodes = check->file->nodes;
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_NODES); ++i)
    {
        const LsSceneNode* node = &nodes[i];
        if (!is_finite_matrix(node->parent_from_node) ||
            !is_zero(node->reserved, sizeof(node->reserved)))
        {
            return report_rule(check, "R4.8", LS_CHUNK_NODES, i,
                               "matrix not finite, or a reserved word is not zero");
        }
        if (node->parent >= i && node->parent != LS_NONE)
        {
            return report_rule(check, "R4.8", LS_CHUNK_NODES, i, "parent %u", node->parent);
        }
        int levels = 1;
        for (uint32_t above = node->parent; above != LS_NONE; above = nodes[above].parent)
        {
            if (++levels > LS_MAX_NODE_DEPTH)
            {
                return report_rule(check, "R4.8", LS_CHUNK_NODES, i, "more than %d levels",
                                   LS_MAX_NODE_DEPTH);
            }
        }
    }
    return LS_OK;
}

static LsResult check_materials(const Check* check)
{
    const uint32_t known_flags = LS_MATERIAL_EMISSIVE | LS_MATERIAL_DOUBLE_SIDED;
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_MATERIALS); ++i)
    {
        const LsMaterial* material = &check->file->materials[i];
        const LsVec3 color = material->base_color;
        const LsVec3 emission = material->emission;
        if (!(is_fraction(color.x) && is_fraction(color.y) && is_fraction(color.z) &&
              is_fraction(material->metallic) && is_fraction(material->roughness)))
        {
            return report_rule(check, "R4.9", LS_CHUNK_MATERIALS, i,
                               "base colour, metallic or roughness outside [0,1]");
        }
        if (!is_finite_point(emission) || !(emission.x >= 0 && emission.y >= 0 && emission.z >= 0))
        {
            return report_rule(check, "R4.9", LS_CHUNK_MATERIALS, i, "emission (%g, %g, %g)",
                               (double)emission.x, (double)emission.y, (double)emission.z);
        }
        const bool emits = emission.x > 0 || emission.y > 0 || emission.z > 0;
        const bool flagged = (material->flags & LS_MATERIAL_EMISSIVE) != 0;
        if ((material->flags & ~known_flags) != 0 || emits != flagged)
        {
            return report_rule(check, "R4.9", LS_CHUNK_MATERIALS, i, "flags 0x%x, but it %s",
                               material->flags, emits ? "emits" : "does not emit");
        }
        if (material->reserved0 != 0 || material->reserved1[0] != 0 || material->reserved1[1] != 0)
        {
            return report_rule(check, "R4.9", LS_CHUNK_MATERIALS, i, "a reserved word is not zero");
        }
    }
    return LS_OK;
}

static LsResult check_lights(const Check* check)
{
    const LsFile* file = check->file;
    const uint32_t instance_count = count_records(check, LS_CHUNK_INSTANCES);
    const uint32_t light_count = count_records(check, LS_CHUNK_LIGHTS);
    float before = 0;
    for (uint32_t i = 0; i < light_count; ++i)
    {
        const LsLight* light = &file->lights[i];
        if (light->instance >= instance_count)
        {
            return report_rule(check, "R4.10", LS_CHUNK_LIGHTS, i, "instance %u of %u",
                               light->instance, instance_count);
        }
        const LsObject* object = &file->objects[file->instances[light->instance].object];
        if (light->triangle >= object->triangle_count)
        {
            return report_rule(check, "R4.10", LS_CHUNK_LIGHTS, i, "triangle %u of %u",
                               light->triangle, object->triangle_count);
        }
        const uint32_t material =
            file->triangles[object->first_triangle + light->triangle].material;
        if ((file->materials[material].flags & LS_MATERIAL_EMISSIVE) == 0)
        {
            return report_rule(check, "R4.10", LS_CHUNK_LIGHTS, i, "material %u does not emit",
                               material);
        }
        const bool last = i + 1 == light_count;
        if (!(isfinite(light->area) && light->area > 0) ||
            !(light->cumulative > 0 && light->cumulative >= before && light->cumulative <= 1) ||
            (last && light->cumulative != 1))
        {
            return report_rule(check, "R4.10", LS_CHUNK_LIGHTS, i,
                               "area %g, cumulative %g after %g", (double)light->area,
                               (double)light->cumulative, (double)before);
        }
        before = light->cumulative;
    }
    return LS_OK;
}

static LsResult check_cameras(const Check* check)
{
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_CAMERAS); ++i)
    {
        const LsCamera* camera = &check->file->cameras[i];
        if (!is_finite_matrix(camera->world_from_camera) ||
            !(isfinite(camera->tan_half_y) && camera->tan_half_y > 0) ||
            !(isfinite(camera->aspect) && camera->aspect >= 0) ||
            !is_zero(camera->reserved, sizeof(camera->reserved)))
        {
            return report_rule(check, "R4.11", LS_CHUNK_CAMERAS, i,
                               "matrix not finite, tan_half_y %g, aspect %g, or a reserved word",
                               (double)camera->tan_half_y, (double)camera->aspect);
        }
    }
    return LS_OK;
}

// ---- Chapter 5: grids ---------------------------------------------------------------------------

// What the pass over an object's cells carries along.
typedef struct GridPass
{
    const LsObject* object;
    const uint32_t* subgrids;
    const LsVoxel* voxels;
    uint32_t grid_block_count; // cell blocks that are no sub-grids
    uint32_t next_block;
    uint32_t next_voxel;
    uint32_t linked_subgrids;
} GridPass;

static bool is_empty_word(uint32_t word)
{
    // No nibble is zero: borrow reaches a nibble's high bit only from a zero.
    return ((word - 0x11111111u) & ~word & 0x88888888u) == 0;
}

// Whether `table` was already linked by an earlier sub-grid voxel of the same block.
static bool find_table(const LsVoxel* voxels, uint32_t first, uint32_t end, uint32_t table)
{
    for (uint32_t i = first; i < end; ++i)
    {
        if ((voxels[i].shape & 255) == LS_VOXEL_SUBGRID && voxels[i].table == table)
        {
            return true;
        }
    }
    return false;
}

// R5.7 for voxel `voxel` of kind sub-grid, the voxels of its block beginning at `first`. A sub-grid is
// linked only from its parent block, so no two links alike within each block is enough.
static LsResult check_subgrid_link(const Check* check, GridPass* pass, uint32_t block,
                                   uint32_t first, uint32_t voxel)
{
    const uint32_t table = pass->voxels[voxel].table;
    if (table < pass->grid_block_count || table >= pass->object->cell_block_count ||
        pass->subgrids[table - pass->grid_block_count] != block ||
        find_table(pass->voxels, first, voxel, table))
    {
        return report_rule(
            check, "R5.7", LS_CHUNK_VOXELS, (uint64_t)pass->object->first_voxel + voxel,
            "links cell block %u, which is no sub-grid of block %u or linked twice", table, block);
    }
    ++pass->linked_subgrids;
    return LS_OK;
}

// Checks the words of cell block `block`, of which `inside` cells per axis lie in the grid.
static LsResult check_cell_block(const Check* check, GridPass* pass, uint32_t block,
                                 const uint32_t inside[3])
{
    const uint64_t record = (uint64_t)pass->object->first_cell_block + block;
    const uint32_t* cells = check->file->cell_blocks[record].cells;
    const uint32_t first_voxel = pass->next_voxel;
    for (uint32_t i = 0; i < LS_BLOCK_CELLS; ++i)
    {
        const uint32_t word = cells[i];
        if (is_empty_word(word))
        {
            continue;
        }
        const uint32_t voxel = word >> 4;
        if ((word & 15) != 0 || voxel >= pass->object->voxel_count)
        {
            return report_rule(check, "R5.3", LS_CHUNK_CELL_BLOCKS, record,
                               "cell %u is 0x%08x, neither empty nor a link to one of %u voxels", i,
                               word, pass->object->voxel_count);
        }
        if (voxel != pass->next_voxel)
        {
            return report_rule(check, "R5.4", LS_CHUNK_CELL_BLOCKS, record,
                               "cell %u links voxel %u, the next in order is %u", i, voxel,
                               pass->next_voxel);
        }
        if (i % 4 >= inside[0] || i / 4 % 4 >= inside[1] || i / 16 >= inside[2])
        {
            return report_rule(check, "R5.5", LS_CHUNK_CELL_BLOCKS, record,
                               "cell %u lies outside the grid and is not empty", i);
        }
        ++pass->next_voxel;
        if ((pass->voxels[voxel].shape & 255) == LS_VOXEL_SUBGRID)
        {
            const LsResult result = check_subgrid_link(check, pass, block, first_voxel, voxel);
            if (result != LS_OK)
            {
                return result;
            }
        }
    }
    return LS_OK;
}

// Checks word `index` of the object's BLOCKS, and the cell block that it links.
static LsResult check_block(const Check* check, GridPass* pass, uint32_t index)
{
    const LsObject* object = pass->object;
    const uint64_t record = (uint64_t)object->first_block + index;
    const uint32_t word = check->file->blocks[record];
    if (is_empty_word(word))
    {
        return LS_OK;
    }
    const uint32_t block = word >> 4;
    if ((word & 15) != 0 || block >= object->cell_block_count)
    {
        return report_rule(check, "R5.3", LS_CHUNK_BLOCKS, record,
                           "0x%08x is neither empty nor a link to one of %u cell blocks", word,
                           object->cell_block_count);
    }
    if (block != pass->next_block || block >= pass->grid_block_count)
    {
        return report_rule(check, "R5.4", LS_CHUNK_BLOCKS, record,
                           "links cell block %u, the next in order is %u of %u", block,
                           pass->next_block, pass->grid_block_count);
    }
    ++pass->next_block;
    uint32_t inside[3];
    uint32_t place = index;
    for (int axis = 0; axis < 3; ++axis)
    {
        const uint32_t blocks = count_blocks_along(object, axis);
        inside[axis] = object->cells[axis] - place % blocks * LS_BLOCK_SIDE;
        place /= blocks;
    }
    return check_cell_block(check, pass, block, inside);
}

// R5.6: parents come before their sub-grids, and the levels end at the object's depth.
static LsResult check_subgrids(const Check* check, const GridPass* pass)
{
    const LsObject* object = pass->object;
    uint32_t depth = 0;
    for (uint32_t s = 0; s < object->subgrid_count; ++s)
    {
        const uint64_t record = (uint64_t)object->first_subgrid + s;
        if (pass->subgrids[s] >= pass->grid_block_count + s)
        {
            return report_rule(check, "R5.6", LS_CHUNK_SUBGRIDS, record,
                               "parent block %u, its own is %u", pass->subgrids[s],
                               pass->grid_block_count + s);
        }
        uint32_t level = 1;
        uint32_t parent = pass->subgrids[s];
        while (parent >= pass->grid_block_count && level <= object->depth)
        {
            parent = pass->subgrids[parent - pass->grid_block_count];
            ++level;
        }
        if (level > object->depth)
        {
            return report_rule(check, "R5.6", LS_CHUNK_SUBGRIDS, record,
                               "deeper than the object's depth %u", object->depth);
        }
        depth = level > depth ? level : depth;
    }
    if (depth != object->depth)
    {
        return report_rule(check, "R5.6", LS_CHUNK_OBJECTS,
                           (uint64_t)(object - check->file->objects),
                           "depth %u, its sub-grids reach %u", object->depth, depth);
    }
    return LS_OK;
}

static LsResult check_grid(const Check* check, uint32_t object_index)
{
    const LsFile* file = check->file;
    const LsObject* object = &file->objects[object_index];
    GridPass pass = {
        .object = object,
        .subgrids = PART(file->subgrids, object->first_subgrid),
        .voxels = PART(file->voxels, object->first_voxel),
        .grid_block_count = object->cell_block_count - object->subgrid_count,
    };
    LsResult result = check_subgrids(check, &pass);
    for (uint32_t i = 0; i < object->block_count && result == LS_OK; ++i)
    {
        result = check_block(check, &pass, i);
    }
    static const uint32_t whole[3] = {LS_BLOCK_SIDE, LS_BLOCK_SIDE, LS_BLOCK_SIDE};
    for (uint32_t s = 0; s < object->subgrid_count && result == LS_OK; ++s)
    {
        result = check_cell_block(check, &pass, pass.grid_block_count + s, whole);
    }
    if (result != LS_OK)
    {
        return result;
    }
    if (pass.next_block != pass.grid_block_count || pass.next_voxel != object->voxel_count)
    {
        return report_rule(check, "R5.4", LS_CHUNK_OBJECTS, object_index,
                           "%u of %u cell blocks and %u of %u voxels are linked", pass.next_block,
                           pass.grid_block_count, pass.next_voxel, object->voxel_count);
    }
    if (pass.linked_subgrids != object->subgrid_count)
    {
        return report_rule(check, "R5.7", LS_CHUNK_OBJECTS, object_index,
                           "%u of %u sub-grids are linked", pass.linked_subgrids,
                           object->subgrid_count);
    }
    return LS_OK;
}

// ---- Chapter 6: voxels and shafts ---------------------------------------------------------------

// What the pass over an object's voxels carries along: how much of each array is used up.
typedef struct VoxelPass
{
    const LsObject* object;
    const uint32_t* references;
    const LsBvhNode* leaf_nodes;
    const uint32_t* shafts;
    uint32_t next_reference;
    uint32_t next_leaf_node;
    uint32_t next_shaft_word;
} VoxelPass;

static LsResult check_references(const Check* check, VoxelPass* pass, const LsVoxel* voxel,
                                 uint64_t record)
{
    const uint32_t left = pass->object->reference_count - pass->next_reference;
    if (voxel->first_reference != pass->next_reference || voxel->reference_count > left)
    {
        return report_rule(check, "R6.2", LS_CHUNK_VOXELS, record,
                           "%u references from %u, the next is %u of %u", voxel->reference_count,
                           voxel->first_reference, pass->next_reference,
                           pass->object->reference_count);
    }
    const uint32_t* references = pass->references + voxel->first_reference;
    const bool sorted = (voxel->shape & 255) != LS_VOXEL_BVH;
    int64_t before = -1;
    for (uint32_t i = 0; i < voxel->reference_count; ++i)
    {
        if (references[i] >= pass->object->triangle_count || (sorted && references[i] <= before))
        {
            return report_rule(check, "R6.2", LS_CHUNK_REFERENCES,
                               (uint64_t)pass->object->first_reference + pass->next_reference + i,
                               "triangle %u of %u in voxel %llu, or not rising", references[i],
                               pass->object->triangle_count, (unsigned long long)record);
        }
        before = references[i];
    }
    pass->next_reference += voxel->reference_count;
    return LS_OK;
}

// Whether no mask has a bit at or above `count`, and the last word none behind the last mask.
static bool is_clean_table(const uint32_t* words, uint64_t bits, uint32_t width, uint32_t count)
{
    const uint64_t lanes = UINT32_MAX / ((1ull << width) - 1); // bit 0 of each mask of a word
    const uint32_t illegal = ~(uint32_t)(lanes * ((1ull << count) - 1));
    const uint64_t word_count = (bits + 31) / 32;
    uint32_t any = 0;
    for (uint64_t i = 0; i < word_count && illegal != 0; ++i)
    {
        any |= words[i] & illegal;
    }
    if (bits % 32 != 0)
    {
        any |= words[word_count - 1] >> bits % 32;
    }
    return any == 0;
}

static LsResult check_masks(const Check* check, VoxelPass* pass, const LsVoxel* voxel,
                            uint64_t record)
{
    const uint32_t patches = voxel->shape >> 8 & 255;
    const uint32_t log2_width = voxel->shape >> 16 & 255;
    if (patches < 1 || patches > LS_MAX_PATCHES || log2_width < 2 || log2_width > 5)
    {
        return report_rule(check, "R6.4", LS_CHUNK_VOXELS, record, "%u patches, width 2^%u",
                           patches, log2_width);
    }
    const uint32_t width = 1u << log2_width;
    if (voxel->reference_count < 1 || voxel->reference_count > width)
    {
        return report_rule(check, "R6.4", LS_CHUNK_VOXELS, record,
                           "%u references for masks of %u bits", voxel->reference_count, width);
    }
    const uint64_t bits = 15ull * patches * patches * patches * patches * width;
    const uint64_t words = (bits + 31) / 32;
    if (voxel->table != pass->next_shaft_word ||
        words > pass->object->shaft_word_count - pass->next_shaft_word)
    {
        return report_rule(check, "R6.4", LS_CHUNK_VOXELS, record,
                           "a table of %llu words at %u, the next is %u of %u",
                           (unsigned long long)words, voxel->table, pass->next_shaft_word,
                           pass->object->shaft_word_count);
    }
    if (!is_clean_table(pass->shafts + voxel->table, bits, width, voxel->reference_count))
    {
        return report_rule(check, "R6.4", LS_CHUNK_VOXELS, record,
                           "its table has bits for more than %u triangles, or behind its end",
                           voxel->reference_count);
    }
    pass->next_shaft_word += (uint32_t)words;
    return LS_OK;
}

static LsResult check_leaf_bvh(const Check* check, VoxelPass* pass, const LsVoxel* voxel,
                               uint64_t record)
{
    const LsObject* object = pass->object;
    const uint32_t left = object->leaf_node_count - pass->next_leaf_node;
    if (voxel->reference_count < 1 || voxel->table != pass->next_leaf_node || left == 0)
    {
        return report_rule(check, "R6.6", LS_CHUNK_VOXELS, record,
                           "%u references, BVH at %u, the next is %u of %u", voxel->reference_count,
                           voxel->table, pass->next_leaf_node, object->leaf_node_count);
    }
    const LsBvhNode* nodes = pass->leaf_nodes + voxel->table;
    const uint32_t count = nodes[0].escape;
    if (count < 1 || count > left)
    {
        return report_rule(check, "R6.6", LS_CHUNK_VOXELS, record, "a BVH of %u nodes, %u are left",
                           count, left);
    }
    const uint32_t first = object->first_leaf_node + voxel->table;
    const LsResult result = check_bvh(check, LS_CHUNK_LEAF_NODES, nodes, first, count);
    if (result != LS_OK)
    {
        return result;
    }
    uint32_t used = 0;
    for (uint32_t i = 0; i < count; ++i)
    {
        const uint32_t leaf = nodes[i].leaf;
        if (leaf != 0 && (leaf >> 4 != used || (leaf & 15) > voxel->reference_count - used))
        {
            return report_rule(check, "R6.6", LS_CHUNK_LEAF_NODES, (uint64_t)first + i,
                               "%u references from %u, the next is %u of %u", leaf & 15, leaf >> 4,
                               used, voxel->reference_count);
        }
        used += leaf & 15;
    }
    if (used != voxel->reference_count)
    {
        return report_rule(check, "R6.6", LS_CHUNK_VOXELS, record,
                           "its BVH holds %u of %u references", used, voxel->reference_count);
    }
    pass->next_leaf_node += count;
    return LS_OK;
}

static LsResult check_voxel(const Check* check, VoxelPass* pass, const LsVoxel* voxel,
                            uint64_t record)
{
    const uint32_t kind = voxel->shape & 255;
    if (kind > LS_VOXEL_BVH || voxel->shape >> 24 != 0 ||
        (kind != LS_VOXEL_MASKS && voxel->shape >> 8 != 0))
    {
        return report_rule(check, "R6.1", LS_CHUNK_VOXELS, record, "shape 0x%08x", voxel->shape);
    }
    const LsResult result = check_references(check, pass, voxel, record);
    if (result != LS_OK)
    {
        return result;
    }
    if (kind == LS_VOXEL_MASKS)
    {
        return check_masks(check, pass, voxel, record);
    }
    if (kind == LS_VOXEL_BVH)
    {
        return check_leaf_bvh(check, pass, voxel, record);
    }
    if (kind == LS_VOXEL_LIST && (voxel->reference_count < 1 || voxel->table != 0))
    {
        return report_rule(check, "R6.3", LS_CHUNK_VOXELS, record,
                           "a list of %u references with table %u", voxel->reference_count,
                           voxel->table);
    }
    if (kind == LS_VOXEL_SUBGRID && voxel->reference_count != 0)
    {
        return report_rule(check, "R6.5", LS_CHUNK_VOXELS, record, "a sub-grid with %u references",
                           voxel->reference_count);
    }
    return LS_OK;
}

static LsResult check_voxels(const Check* check, uint32_t object_index)
{
    const LsFile* file = check->file;
    const LsObject* object = &file->objects[object_index];
    VoxelPass pass = {
        .object = object,
        .references = PART(file->references, object->first_reference),
        .leaf_nodes = PART(file->leaf_nodes, object->first_leaf_node),
        .shafts = PART(file->shafts, object->first_shaft_word),
    };
    for (uint32_t i = 0; i < object->voxel_count; ++i)
    {
        const uint64_t record = (uint64_t)object->first_voxel + i;
        const LsResult result = check_voxel(check, &pass, &file->voxels[record], record);
        if (result != LS_OK)
        {
            return result;
        }
    }
    const char* rule = pass.next_reference != object->reference_count     ? "R6.2"
                       : pass.next_shaft_word != object->shaft_word_count ? "R6.4"
                       : pass.next_leaf_node != object->leaf_node_count   ? "R6.6"
                                                                          : NULL;
    if (rule != NULL)
    {
        return report_rule(
            check, rule, LS_CHUNK_OBJECTS, object_index,
            "its voxels use %u of %u references, %u of %u shaft words, %u of %u leaf "
            "nodes",
            pass.next_reference, object->reference_count, pass.next_shaft_word,
            object->shaft_word_count, pass.next_leaf_node, object->leaf_node_count);
    }
    return LS_OK;
}

// ---- All ----------------------------------------------------------------------------------------

LsResult ls_file_check(const LsFile* file, const char* name, LsError* error)
{
    // In an order in which each step may follow the indices that those before it have checked.
    static LsResult (*const scene_steps[])(const Check*) = {
        check_presence, check_objects,   check_materials, check_instances,
        check_features, check_top_nodes, check_nodes,     check_cameras,
    };
    static LsResult (*const object_steps[])(const Check*, uint32_t) = {
        check_triangles,
        check_grid,
        check_voxels,
    };
    const Check check = {.file = file, .name = name, .error = error};
    for (size_t i = 0; i < sizeof(scene_steps) / sizeof(scene_steps[0]); ++i)
    {
        const LsResult result = scene_steps[i](&check);
        if (result != LS_OK)
        {
            return result;
        }
    }
    for (uint32_t object = 0; object < count_records(&check, LS_CHUNK_OBJECTS); ++object)
    {
        for (size_t i = 0; i < sizeof(object_steps) / sizeof(object_steps[0]); ++i)
        {
            const LsResult result = object_steps[i](&check, object);
            if (result != LS_OK)
            {
                return result;
            }
        }
    }
    return check_lights(&check);
}

LsResult ls_file_check_hashes(const LsFile* file, const char* name, LsError* error)
{
    uint64_t end = LS_HEADER_BYTES + file->header->chunk_count * (uint64_t)LS_ENTRY_BYTES;
    for (uint32_t i = 0; i < file->header->chunk_count; ++i)
    {
        const LsEntry* entry = &file->entries[i];
        if (!is_zero(file->bytes + end, entry->offset - end))
        {
            return ls_error_set(error, LS_ERROR_RULE,
                                "%s: R3.7: padding before chunk %u is not zero", name, i);
        }
        uint8_t hash[LS_HASH_BYTES];
        ls_hash_bytes(file->bytes + entry->offset, entry->stored_bytes, hash);
        if (memcmp(hash, entry->hash, sizeof(hash)) != 0)
        {
            return ls_error_set(error, LS_ERROR_HASH,
                                "%s: chunk %u (%.4s) is damaged (R3.8); copy or bake it again",
                                name, i, (const char*)entry->type);
        }
        end = entry->offset + entry->stored_bytes;
    }
    return LS_OK;
}
