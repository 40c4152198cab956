// check_scene.c - SPEC chapters 2 and 4: what the header says, and the scene around the grids.

#include "check.h"
#include "file_layout.h"

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

static LsResult check_features(const LsCheck* check)
{
    const LsFile* file = check->file;
    const uint64_t derived = derive_required_features(file->objects, file->instances, file->voxels,
                                                      file->header->counts);
    if (file->header->required_features != derived)
    {
        return ls_error_set(
            check->error, LS_MESSAGE_LSPACE_RULE,
            "%s: R2.14: required features 0x%llx, the file uses 0x%llx; bake it again", check->name,
            (unsigned long long)file->header->required_features, (unsigned long long)derived);
    }
    return LS_OK;
}

static LsResult check_presence(const LsCheck* check)
{
    static const LsChunk needed[] = {LS_CHUNK_OBJECTS, LS_CHUNK_INSTANCES, LS_CHUNK_MATERIALS,
                                     LS_CHUNK_TRIANGLES};
    for (size_t i = 0; i < sizeof(needed) / sizeof(needed[0]); ++i)
    {
        if (count_records(check, needed[i]) == 0)
        {
            return ls_error_set(check->error, LS_MESSAGE_LSPACE_RULE,
                                "%s: R4.1: no %s; bake it again", check->name,
                                ls_chunk_info(needed[i]).name);
        }
    }
    return LS_OK;
}

static LsResult check_list_object(const LsCheck* check, uint32_t index)
{
    const LsObject* object = &check->file->objects[index];
    const uint32_t grid_counts = object->block_count | object->cell_block_count |
                                 object->subgrid_count | object->voxel_count |
                                 object->reference_count | object->leaf_node_count |
                                 object->shaft_word_count;
    if (grid_counts != 0)
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index, "a list with grid arrays");
    }
    if (!is_zero(&object->grid_lower, sizeof(object->grid_lower)) ||
        !is_zero(&object->inverse_cell, sizeof(object->inverse_cell)) ||
        !is_zero(object->cells, sizeof(object->cells)) ||
        !is_zero(&object->bound, sizeof(object->bound)) || object->depth != 0 ||
        object->patches != 0 || object->scene_patches != 0)
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index,
                               "a list with grid fields that are not zero");
    }
    return LS_OK;
}

static LsResult check_grid_object(const LsCheck* check, uint32_t index)
{
    const LsObject* object = &check->file->objects[index];
    if (object->patches < 1 || object->patches > LS_MAX_PATCHES ||
        object->scene_patches > LS_MAX_SCENE_PATCHES)
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index,
                               "%u patches, %u of scene shafts", object->patches,
                               object->scene_patches);
    }
    for (int axis = 0; axis < 3; ++axis)
    {
        if (object->cells[axis] < 1 || object->cells[axis] > LS_MAX_CELLS)
        {
            return ls_check_report(check, "R5.1", LS_CHUNK_OBJECTS, index, "%u cells along axis %d",
                                   object->cells[axis], axis);
        }
    }
    if (!(isfinite(object->inverse_cell) && object->inverse_cell > 0) ||
        !is_finite_point(object->grid_lower))
    {
        return ls_check_report(check, "R5.1", LS_CHUNK_OBJECTS, index,
                               "%g cells per unit from (%g, %g, %g)", (double)object->inverse_cell,
                               (double)object->grid_lower.x, (double)object->grid_lower.y,
                               (double)object->grid_lower.z);
    }
    if (!(object->bound > 0 && object->bound < 0.25f / (float)(1u << (2 * object->depth))))
    {
        return ls_check_report(check, "R5.1", LS_CHUNK_OBJECTS, index, "bound %g at depth %u",
                               (double)object->bound, object->depth);
    }
    const uint64_t blocks = (uint64_t)count_blocks_along(object, 0) *
                            count_blocks_along(object, 1) * count_blocks_along(object, 2);
    if (object->block_count != blocks)
    {
        return ls_check_report(check, "R5.2", LS_CHUNK_OBJECTS, index,
                               "%u blocks, the grid has %llu", object->block_count,
                               (unsigned long long)blocks);
    }
    if (object->subgrid_count > object->cell_block_count)
    {
        return ls_check_report(check, "R5.6", LS_CHUNK_OBJECTS, index,
                               "%u sub-grids in %u cell blocks", object->subgrid_count,
                               object->cell_block_count);
    }
    return LS_OK;
}

static LsResult check_object(const LsCheck* check, uint32_t index)
{
    const LsObject* object = &check->file->objects[index];
    if (object->kind > LS_OBJECT_GRID)
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index, "kind %u", object->kind);
    }
    if (!is_box(object->lower, object->upper))
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index,
                               "box not finite or inverted");
    }
    if (!(isfinite(object->reach) && object->reach >= 0))
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index, "reach %g",
                               (double)object->reach);
    }
    // A list may be empty: every face of its input was degenerate.
    if ((object->triangle_count < 1 && object->kind == LS_OBJECT_GRID) ||
        object->face_count < object->triangle_count)
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index, "%u triangles of %u faces",
                               object->triangle_count, object->face_count);
    }
    if (object->depth > LS_MAX_DEPTH)
    {
        return ls_check_report(check, "R4.3", LS_CHUNK_OBJECTS, index, "depth %u", object->depth);
    }
    return object->kind == LS_OBJECT_LIST ? check_list_object(check, index)
                                          : check_grid_object(check, index);
}

static LsResult check_objects(const LsCheck* check)
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
                return ls_check_report(check, "R4.2", LS_CHUNK_OBJECTS, i,
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
        return ls_error_set(check->error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R2.11: depth %u, the deepest object has %u; bake it again",
                            check->name, file->header->depth, depth);
    }
    return LS_OK;
}

LsResult ls_check_triangles(const LsCheck* check, uint32_t object_index)
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
            return ls_check_report(check, "R4.4", LS_CHUNK_TRIANGLES, record,
                                   "a corner outside the box of object %u", object_index);
        }
        return ls_check_report(check, "R4.4", LS_CHUNK_TRIANGLES, record,
                               "primitive %u of %u, material %u of %u, reserved 0x%x",
                               triangle->primitive, object.face_count, triangle->material,
                               material_count, triangle->reserved);
    }
    return LS_OK;
}

static LsResult check_instances(const LsCheck* check)
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
            return ls_check_report(check, "R4.5", LS_CHUNK_INSTANCES, i, "a matrix is not finite");
        }
        if (instance->object >= object_count ||
            (instance->node >= node_count && instance->node != LS_NONE))
        {
            return ls_check_report(check, "R4.5", LS_CHUNK_INSTANCES, i,
                                   "object %u of %u, node %u of %u", instance->object, object_count,
                                   instance->node, node_count);
        }
        if (instance->mask > 255 || (instance->flags & ~known_flags) != 0 ||
            !is_zero(instance->reserved, sizeof(instance->reserved)))
        {
            return ls_check_report(check, "R4.5", LS_CHUNK_INSTANCES, i,
                                   "mask 0x%x, flags 0x%x, or a reserved word", instance->mask,
                                   instance->flags);
        }
        if ((instance->flags & LS_INSTANCE_IDENTITY) != 0 &&
            !(is_identity_matrix(instance->object_from_world) &&
              is_identity_matrix(instance->world_from_object)))
        {
            return ls_check_report(check, "R4.5", LS_CHUNK_INSTANCES, i,
                                   "flagged as the identity, which its matrices are not");
        }
    }
    return LS_OK;
}

// R4.7 for the `count` nodes from record `first` of a chunk.
LsResult ls_check_bvh(const LsCheck* check, LsChunk chunk, const LsBvhNode* nodes, uint32_t first,
                      uint32_t count)
{
    if (nodes[0].escape != count)
    {
        return ls_check_report(check, "R4.7", chunk, first, "the root escapes to %u of %u nodes",
                               nodes[0].escape, count);
    }
    for (uint32_t i = 0; i < count; ++i)
    {
        const LsBvhNode* node = &nodes[i];
        const uint64_t record = (uint64_t)first + i;
        if (!is_box(node->lower, node->upper))
        {
            return ls_check_report(check, "R4.7", chunk, record, "box not finite or inverted");
        }
        const bool inner = node->leaf == 0;
        const bool escapes =
            inner ? node->escape > i + 1 && node->escape <= count : node->escape == i + 1;
        if (!escapes || (!inner && (node->leaf & 15) == 0))
        {
            return ls_check_report(check, "R4.7", chunk, record, "escape %u, leaf 0x%x in %u nodes",
                                   node->escape, node->leaf, count);
        }
        // Hop over the children: the last escapes to where the parent does. As long as that held
        // for all nodes before, every node is hopped over once, so the pass stays linear.
        uint32_t child = inner ? i + 1 : node->escape;
        while (child < node->escape)
        {
            child = nodes[child].escape > child ? nodes[child].escape : UINT32_MAX;
        }
        if (child != node->escape)
        {
            return ls_check_report(check, "R4.7", chunk, record,
                                   "a child does not escape within it");
        }
    }
    return LS_OK;
}

// Each instance in exactly one leaf: as many leaves as instances, and none alike. The second is
// looked at for so many instances at a time as a small table holds.
static LsResult check_top_leaves(const LsCheck* check)
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
            return ls_check_report(check, "R4.6", LS_CHUNK_TOP_NODES, i,
                                   "a leaf of %u instances from %u; there are %u", leaf & 15,
                                   leaf >> 4, instance_count);
        }
        leaf_count += leaf != 0;
    }
    if (leaf_count != instance_count)
    {
        return ls_check_report(check, "R4.6", LS_CHUNK_TOP_NODES, 0, "%u leaves for %u instances",
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
                return ls_check_report(check, "R4.6", LS_CHUNK_TOP_NODES, i,
                                       "instance %u stands in two leaves", nodes[i].leaf >> 4);
            }
            seen[place / 64] |= bit;
        }
    }
    return LS_OK;
}

static LsResult check_top_nodes(const LsCheck* check)
{
    const uint32_t count = count_records(check, LS_CHUNK_TOP_NODES);
    const bool needed = (check->file->header->required_features & LS_FEATURE_TOP_LEVEL) != 0;
    if (needed != (count > 0))
    {
        return ls_error_set(check->error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R4.6: TOP_NODES %s; bake it again", check->name,
                            needed ? "are missing" : "without need of a top level");
    }
    if (count == 0)
    {
        return LS_OK;
    }
    const LsResult result =
        ls_check_bvh(check, LS_CHUNK_TOP_NODES, check->file->top_nodes, 0, count);
    return result != LS_OK ? result : check_top_leaves(check);
}

static LsResult check_nodes(const LsCheck* check)
{
    const LsSceneNode* nodes = check->file->nodes;
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_NODES); ++i)
    {
        const LsSceneNode* node = &nodes[i];
        if (!is_finite_matrix(node->parent_from_node) ||
            !is_zero(node->reserved, sizeof(node->reserved)))
        {
            return ls_check_report(check, "R4.8", LS_CHUNK_NODES, i,
                                   "matrix not finite, or a reserved word is not zero");
        }
        if (node->parent >= i && node->parent != LS_NONE)
        {
            return ls_check_report(check, "R4.8", LS_CHUNK_NODES, i, "parent %u", node->parent);
        }
        int levels = 1;
        for (uint32_t above = node->parent; above != LS_NONE; above = nodes[above].parent)
        {
            if (++levels > LS_MAX_NODE_DEPTH)
            {
                return ls_check_report(check, "R4.8", LS_CHUNK_NODES, i, "more than %d levels",
                                       LS_MAX_NODE_DEPTH);
            }
        }
    }
    return LS_OK;
}

static LsResult check_materials(const LsCheck* check)
{
    const uint32_t known_flags = LS_MATERIAL_EMISSIVE | LS_MATERIAL_DOUBLE_SIDED;
    const uint32_t surface_count = count_records(check, LS_CHUNK_SURFACES);
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_MATERIALS); ++i)
    {
        const LsMaterial* material = &check->file->materials[i];
        const LsVec3 color = material->base_color;
        const LsVec3 emission = material->emission;
        if (!(is_fraction(color.x) && is_fraction(color.y) && is_fraction(color.z) &&
              is_fraction(material->metallic) && is_fraction(material->roughness)))
        {
            return ls_check_report(check, "R4.9", LS_CHUNK_MATERIALS, i,
                                   "base colour, metallic or roughness outside [0,1]");
        }
        if (!is_finite_point(emission) || !(emission.x >= 0 && emission.y >= 0 && emission.z >= 0))
        {
            return ls_check_report(check, "R4.9", LS_CHUNK_MATERIALS, i, "emission (%g, %g, %g)",
                                   (double)emission.x, (double)emission.y, (double)emission.z);
        }
        const bool emits = emission.x > 0 || emission.y > 0 || emission.z > 0;
        const bool flagged = (material->flags & LS_MATERIAL_EMISSIVE) != 0;
        if ((material->flags & ~known_flags) != 0 || emits != flagged)
        {
            return ls_check_report(check, "R4.9", LS_CHUNK_MATERIALS, i, "flags 0x%x, but it %s",
                                   material->flags, emits ? "emits" : "does not emit");
        }
        if (material->surface > surface_count || material->reserved0 != 0 ||
            material->reserved1 != 0)
        {
            return ls_check_report(check, "R4.9", LS_CHUNK_MATERIALS, i,
                                   "surface %u of %u (0: none), or a reserved word is not zero",
                                   material->surface, surface_count);
        }
    }
    return LS_OK;
}

LsResult ls_check_lights(const LsCheck* check)
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
            return ls_check_report(check, "R4.10", LS_CHUNK_LIGHTS, i, "instance %u of %u",
                                   light->instance, instance_count);
        }
        const LsObject* object = &file->objects[file->instances[light->instance].object];
        if (light->triangle >= object->triangle_count)
        {
            return ls_check_report(check, "R4.10", LS_CHUNK_LIGHTS, i, "triangle %u of %u",
                                   light->triangle, object->triangle_count);
        }
        const uint32_t material =
            file->triangles[object->first_triangle + light->triangle].material;
        if ((file->materials[material].flags & LS_MATERIAL_EMISSIVE) == 0)
        {
            return ls_check_report(check, "R4.10", LS_CHUNK_LIGHTS, i, "material %u does not emit",
                                   material);
        }
        const bool last = i + 1 == light_count;
        if (!(isfinite(light->area) && light->area > 0) ||
            !(light->cumulative > 0 && light->cumulative >= before && light->cumulative <= 1) ||
            (last && light->cumulative != 1))
        {
            return ls_check_report(check, "R4.10", LS_CHUNK_LIGHTS, i,
                                   "area %g, cumulative %g after %g", (double)light->area,
                                   (double)light->cumulative, (double)before);
        }
        before = light->cumulative;
    }
    return LS_OK;
}

static LsResult check_cameras(const LsCheck* check)
{
    for (uint32_t i = 0; i < count_records(check, LS_CHUNK_CAMERAS); ++i)
    {
        const LsCamera* camera = &check->file->cameras[i];
        if (!is_finite_matrix(camera->world_from_camera) ||
            !(isfinite(camera->tan_half_y) && camera->tan_half_y > 0) ||
            !(isfinite(camera->aspect) && camera->aspect >= 0) ||
            !is_zero(camera->reserved, sizeof(camera->reserved)))
        {
            return ls_check_report(
                check, "R4.11", LS_CHUNK_CAMERAS, i,
                "matrix not finite, tan_half_y %g, aspect %g, or a reserved word",
                (double)camera->tan_half_y, (double)camera->aspect);
        }
    }
    return LS_OK;
}

LsResult ls_check_scene(const LsCheck* check)
{
    static LsResult (*const steps[])(const LsCheck*) = {
        check_presence, check_objects,   check_materials, check_instances,
        check_features, check_top_nodes, check_nodes,     check_cameras,
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
