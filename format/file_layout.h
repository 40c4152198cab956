// file_layout.h - what the writer derives and the reader verifies: magic, places, features.

#ifndef LS_FILE_LAYOUT_H
#define LS_FILE_LAYOUT_H

#include "ls_format.h"

// "«lspace 01»", then bytes that a transfer in text mode would change.
static const uint8_t LS_MAGIC[LS_MAGIC_BYTES] = {0xAB, 0x6C, 0x73, 0x70, 0x61, 0x63, 0x65, 0x20,
                                                 0x30, 0x31, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A, 0x00};

// Where a chunk of `bytes` begins whose predecessor, or the directory, ends at `end` (R3.6).
static inline uint64_t place_chunk(uint64_t end, uint64_t bytes)
{
    const uint64_t alignment =
        bytes < LS_LARGE_CHUNK_BYTES ? LS_CHUNK_ALIGNMENT : LS_LARGE_CHUNK_ALIGNMENT;
    return (end + alignment - 1) / alignment * alignment;
}

// Flags of the entry of a known chunk (R3.2).
static inline uint32_t chunk_flags(LsChunk chunk)
{
    const bool optional = chunk == LS_CHUNK_NODES || chunk == LS_CHUNK_LIGHTS ||
                          chunk == LS_CHUNK_CAMERAS || chunk >= LS_CHUNK_SURFACES;
    return optional ? 0 : LS_ENTRY_REQUIRED;
}

// Whether the masks of a file are of exact width: as the first voxel that has any says (R6.4 holds the
// others to it).
static inline bool has_exact_masks(const LsVoxel* voxels, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && (voxels[i].shape & 255) != LS_VOXEL_MASKS)
    {
        ++i;
    }
    return i < count && (voxels[i].shape >> 16 & 255) == 0;
}

// Words of an object's part of SHAFTS that are those of its scene shafts; 0 for an M that R4.3 refuses.
static inline uint32_t count_scene_shafts(const LsObject* object)
{
    const uint32_t patches =
        object->scene_patches <= LS_MAX_SCENE_PATCHES ? object->scene_patches : 0;
    return LS_SHAFT_COUNT(patches);
}

// Required features (R2.14). `counts` as in the header.
static inline uint64_t derive_required_features(const LsObject* objects,
                                                const LsInstance* instances, const LsVoxel* voxels,
                                                const uint32_t counts[LS_HEADER_COUNTS])
{
    uint64_t features = 0;
    if (counts[LS_CHUNK_OBJECTS] > 1 || counts[LS_CHUNK_INSTANCES] > 1 ||
        (counts[LS_CHUNK_INSTANCES] == 1 && (instances[0].flags & LS_INSTANCE_IDENTITY) == 0))
    {
        features |= LS_FEATURE_TOP_LEVEL;
    }
    uint64_t scene_shafts = 0;
    for (uint32_t i = 0; i < counts[LS_CHUNK_OBJECTS]; ++i)
    {
        features |= objects[i].kind == LS_OBJECT_LIST ? LS_FEATURE_LISTS : LS_FEATURE_GRIDS;
        features |= objects[i].scene_patches != 0 ? LS_FEATURE_SCENE_SHAFTS : 0;
        scene_shafts += count_scene_shafts(&objects[i]);
    }
    features |= counts[LS_CHUNK_SUBGRIDS] > 0 ? LS_FEATURE_SUBGRIDS : 0;
    features |= counts[LS_CHUNK_LEAF_NODES] > 0 ? LS_FEATURE_LEAF_BVHS : 0;
    features |= counts[LS_CHUNK_SHAFTS] > scene_shafts ? LS_FEATURE_MASKS : 0;
    features |= has_exact_masks(voxels, counts[LS_CHUNK_VOXELS]) ? LS_FEATURE_EXACT_MASKS : 0;
    return features;
}

// Optional features (R2.15). `counts`, here and below, of every chunk type.
static inline uint64_t derive_optional_features(const uint32_t counts[LS_CHUNK_COUNT])
{
    return (counts[LS_CHUNK_LIGHTS] > 0 ? LS_FEATURE_LIGHTS : 0) |
           (counts[LS_CHUNK_CAMERAS] > 0 ? LS_FEATURE_CAMERAS : 0) |
           (counts[LS_CHUNK_NODES] > 0 ? LS_FEATURE_NODES : 0) |
           (counts[LS_CHUNK_SURFACES] > 0 ? LS_FEATURE_SURFACES : 0) |
           (counts[LS_CHUNK_ATTRIBUTES] > 0 ? LS_FEATURE_ATTRIBUTES : 0) |
           (counts[LS_CHUNK_LAMPS] > 0 ? LS_FEATURE_LAMPS : 0) |
           (counts[LS_CHUNK_ANIMATIONS] > 0 ? LS_FEATURE_ANIMATIONS : 0);
}

// The smallest minor that has all of a file (R2.16).
static inline uint32_t derive_minor(const uint32_t counts[LS_CHUNK_COUNT],
                                    uint64_t required_features)
{
    if ((required_features & LS_FEATURE_SCENE_SHAFTS) != 0)
    {
        return 4;
    }
    if ((required_features & LS_FEATURE_EXACT_MASKS) != 0)
    {
        return 3;
    }
    for (int chunk = LS_CHUNK_SURFACES; chunk < LS_CHUNK_COUNT; ++chunk)
    {
        if (counts[chunk] > 0)
        {
            return 2;
        }
    }
    return 1;
}

// The smallest minor whose readers may read a file (R2.16): those of 0.1 skip what 0.2 added, but know
// no surfaces of materials; masks of exact width are not known before 0.3, scene shafts not before 0.4.
static inline uint32_t derive_reader_minor(const uint32_t counts[LS_CHUNK_COUNT],
                                           uint64_t required_features)
{
    if ((required_features & LS_FEATURE_SCENE_SHAFTS) != 0)
    {
        return 4;
    }
    if ((required_features & LS_FEATURE_EXACT_MASKS) != 0)
    {
        return 3;
    }
    return counts[LS_CHUNK_SURFACES] > 0 ? 2 : 1;
}

#endif
