// check_voxels.c - SPEC chapter 6: voxels, their references, masks and BVHs.

#include "check.h"
#include "file_layout.h"

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

static LsResult check_references(const LsCheck* check, VoxelPass* pass, const LsVoxel* voxel,
                                 uint64_t record)
{
    const uint32_t left = pass->object->reference_count - pass->next_reference;
    if (voxel->first_reference != pass->next_reference || voxel->reference_count > left)
    {
        return ls_check_report(check, "R6.2", LS_CHUNK_VOXELS, record,
                               "%u references from %u, the next is %u of %u",
                               voxel->reference_count, voxel->first_reference, pass->next_reference,
                               pass->object->reference_count);
    }
    const uint32_t* references = pass->references + voxel->first_reference;
    const bool sorted = (voxel->shape & 255) != LS_VOXEL_BVH;
    int64_t before = -1;
    for (uint32_t i = 0; i < voxel->reference_count; ++i)
    {
        if (references[i] >= pass->object->triangle_count || (sorted && references[i] <= before))
        {
            return ls_check_report(check, "R6.2", LS_CHUNK_REFERENCES,
                                   (uint64_t)pass->object->first_reference + pass->next_reference +
                                       i,
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
    const uint64_t word_count = (bits + 31) / 32;
    uint32_t any = 0;
    if (count < width) // so the width is a power of two, and masks cross no words
    {
        const uint64_t lanes = UINT32_MAX / ((1ull << width) - 1); // bit 0 of each mask of a word
        const uint32_t illegal = ~(uint32_t)(lanes * ((1ull << count) - 1));
        for (uint64_t i = 0; i < word_count; ++i)
        {
            any |= words[i] & illegal;
        }
    }
    if (bits % 32 != 0)
    {
        any |= words[word_count - 1] >> bits % 32;
    }
    return any == 0;
}

// The masks of a file are all of exact width or none are.
static bool is_legal_width(const LsCheck* check, uint32_t log2_width)
{
    return (check->file->header->required_features & LS_FEATURE_EXACT_MASKS) != 0
               ? log2_width == 0
               : log2_width >= 2 && log2_width <= 5;
}

static LsResult check_masks(const LsCheck* check, VoxelPass* pass, const LsVoxel* voxel,
                            uint64_t record)
{
    const uint32_t patches = voxel->shape >> 8 & 255;
    const uint32_t log2_width = voxel->shape >> 16 & 255;
    if (patches < 1 || patches > LS_MAX_PATCHES || !is_legal_width(check, log2_width))
    {
        return ls_check_report(check, "R6.4", LS_CHUNK_VOXELS, record, "%u patches, width field %u",
                               patches, log2_width);
    }
    const uint32_t width = ls_mask_width(voxel);
    if (voxel->reference_count < 1 || voxel->reference_count > LS_MASK_TRIANGLES ||
        voxel->reference_count > width)
    {
        return ls_check_report(check, "R6.4", LS_CHUNK_VOXELS, record,
                               "%u references for masks of %u bits", voxel->reference_count, width);
    }
    const uint64_t shafts = LS_SHAFT_COUNT(patches);
    const uint64_t words = ls_mask_words(shafts, width);
    if (voxel->table != pass->next_shaft_word ||
        words > pass->object->shaft_word_count - pass->next_shaft_word)
    {
        return ls_check_report(check, "R6.4", LS_CHUNK_VOXELS, record,
                               "a table of %llu words at %u, the next is %u of %u",
                               (unsigned long long)words, voxel->table, pass->next_shaft_word,
                               pass->object->shaft_word_count);
    }
    if (!is_clean_table(pass->shafts + voxel->table, shafts * width, width, voxel->reference_count))
    {
        return ls_check_report(check, "R6.4", LS_CHUNK_VOXELS, record,
                               "its table has bits for more than %u triangles, or behind its end",
                               voxel->reference_count);
    }
    pass->next_shaft_word += (uint32_t)words;
    return LS_OK;
}

static LsResult check_leaf_bvh(const LsCheck* check, VoxelPass* pass, const LsVoxel* voxel,
                               uint64_t record)
{
    const LsObject* object = pass->object;
    const uint32_t left = object->leaf_node_count - pass->next_leaf_node;
    if (voxel->reference_count < 1 || voxel->table != pass->next_leaf_node || left == 0)
    {
        return ls_check_report(check, "R6.6", LS_CHUNK_VOXELS, record,
                               "%u references, BVH at %u, the next is %u of %u",
                               voxel->reference_count, voxel->table, pass->next_leaf_node,
                               object->leaf_node_count);
    }
    const LsBvhNode* nodes = pass->leaf_nodes + voxel->table;
    const uint32_t count = nodes[0].escape;
    if (count < 1 || count > left)
    {
        return ls_check_report(check, "R6.6", LS_CHUNK_VOXELS, record,
                               "a BVH of %u nodes, %u are left", count, left);
    }
    const uint32_t first = object->first_leaf_node + voxel->table;
    const LsResult result = ls_check_bvh(check, LS_CHUNK_LEAF_NODES, nodes, first, count);
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
            return ls_check_report(check, "R6.6", LS_CHUNK_LEAF_NODES, (uint64_t)first + i,
                                   "%u references from %u, the next is %u of %u", leaf & 15,
                                   leaf >> 4, used, voxel->reference_count);
        }
        used += leaf & 15;
    }
    if (used != voxel->reference_count)
    {
        return ls_check_report(check, "R6.6", LS_CHUNK_VOXELS, record,
                               "its BVH holds %u of %u references", used, voxel->reference_count);
    }
    pass->next_leaf_node += count;
    return LS_OK;
}

static LsResult check_voxel(const LsCheck* check, VoxelPass* pass, const LsVoxel* voxel,
                            uint64_t record)
{
    const uint32_t kind = voxel->shape & 255;
    if (kind > LS_VOXEL_BVH || voxel->shape >> 24 != 0 ||
        (kind != LS_VOXEL_MASKS && voxel->shape >> 8 != 0))
    {
        return ls_check_report(check, "R6.1", LS_CHUNK_VOXELS, record, "shape 0x%08x",
                               voxel->shape);
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
    if (kind == LS_VOXEL_LIST && (voxel->reference_count < 1 ||
                                  voxel->reference_count > LS_MASK_TRIANGLES || voxel->table != 0))
    {
        return ls_check_report(check, "R6.3", LS_CHUNK_VOXELS, record,
                               "a list of %u references with table %u", voxel->reference_count,
                               voxel->table);
    }
    if (kind == LS_VOXEL_SUBGRID && voxel->reference_count != 0)
    {
        return ls_check_report(check, "R6.5", LS_CHUNK_VOXELS, record,
                               "a sub-grid with %u references", voxel->reference_count);
    }
    return LS_OK;
}

LsResult ls_check_voxels(const LsCheck* check, uint32_t object_index)
{
    const LsFile* file = check->file;
    const LsObject* object = &file->objects[object_index];
    VoxelPass pass = {
        .object = object,
        .references = PART(file->references, object->first_reference),
        .leaf_nodes = PART(file->leaf_nodes, object->first_leaf_node),
        .shafts = PART(file->shafts, object->first_shaft_word),
        .next_shaft_word = count_scene_shafts(object), // any word is legal
    };
    if (pass.next_shaft_word > object->shaft_word_count)
    {
        return ls_check_report(check, "R6.7", LS_CHUNK_OBJECTS, object_index,
                               "%u scene shafts in %u words", pass.next_shaft_word,
                               object->shaft_word_count);
    }
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
        return ls_check_report(
            check, rule, LS_CHUNK_OBJECTS, object_index,
            "its voxels use %u of %u references, %u of %u shaft words, %u of %u leaf "
            "nodes",
            pass.next_reference, object->reference_count, pass.next_shaft_word,
            object->shaft_word_count, pass.next_leaf_node, object->leaf_node_count);
    }
    return LS_OK;
}
