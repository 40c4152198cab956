// test_check.c - every rule of SPEC.md has a file that breaks it and nothing else before it, and is
// named.

#include "file_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Bits of floats, for edits.
#define NOT_A_NUMBER 0x7FC00000u
#define INFINITE 0x7F800000u
#define MINUS_ONE 0xBF800000u
#define MINUS_ZERO 0x80000000u
#define SMALLEST 0x00000001u
#define HALF 0x3F000000u
#define ONE 0x3F800000u
#define TWO 0x40000000u
#define NINE 0x41100000u

// Where an edit counts from, beside the chunks.
enum
{
    HEADER = LS_CHUNK_COUNT,
    ENTRY,
    PADDING // of the last byte before chunk `record`
};

// Puts the `size` low bytes of `value`.
typedef struct Edit
{
    int place;
    uint32_t record;
    size_t offset;
    uint32_t size;
    uint64_t value;
} Edit;

#define WORD(NAME, record, type, field, value)                   \
    {                                                            \
        LS_CHUNK_##NAME, record, offsetof(type, field), 4, value \
    }
#define INDEX(NAME, record, value)           \
    {                                        \
        LS_CHUNK_##NAME, record, 0, 4, value \
    }
#define HEAD(field, size, value)                          \
    {                                                     \
        HEADER, 0, offsetof(LsHeader, field), size, value \
    }
#define DIRECTORY(record, field, size, value)                \
    {                                                        \
        ENTRY, record, offsetof(LsEntry, field), size, value \
    }

typedef struct Case
{
    const char* rule;
    LsResult result;
    Edit edits[3]; // up to the first of size 0
} Case;

// A broken file each, its hashes made right again. In the fixture the entries are the chunks in
// order, so entry n is chunk n. See file_fixture.c for what the records hold.
static const Case cases[] = {
    {"R2.1", LS_ERROR_NOT_LSPACE, {HEAD(magic[0], 1, 0)}},
    {"R2.1", LS_ERROR_NOT_LSPACE, {HEAD(magic[9], 1, '2')}},
    {"R2.1", LS_ERROR_NOT_LSPACE, {HEAD(magic[11], 1, '\n')}},
    {"R2.1", LS_ERROR_NOT_LSPACE, {HEAD(magic[0], 8, 0), HEAD(magic[8], 8, 0)}},
    {"R2.2", LS_ERROR_VERSION, {HEAD(version_major, 4, 1)}},
    {"R2.2", LS_ERROR_VERSION, {HEAD(version_major, 4, 0x01000000)}},
    {"R2.2", LS_ERROR_BYTE_ORDER, {HEAD(version_minor, 4, 0x01000000)}},
    {"R2.3", LS_ERROR_VERSION, {HEAD(reader_minor, 4, 3)}},
    {"R2.4", LS_ERROR_RULE, {HEAD(chunk_count, 4, 0)}},
    {"R2.4", LS_ERROR_RULE, {HEAD(chunk_count, 4, 4097)}},
    {"R2.4", LS_ERROR_RULE, {HEAD(chunk_count, 4, UINT32_MAX)}},
    {"R2.5", LS_ERROR_FEATURE, {HEAD(required_features, 8, 127)}},
    {"R2.5", LS_ERROR_FEATURE, {HEAD(required_features, 8, 1ull << 63 | 63)}},
    {"R2.6", LS_ERROR_TRUNCATED, {HEAD(file_bytes, 8, 1 << 20)}},
    {"R2.6", LS_ERROR_RULE, {HEAD(file_bytes, 8, 5000)}},
    {"R2.6", LS_ERROR_RULE, {HEAD(file_bytes, 8, UINT64_MAX)}},
    {"R2.6", LS_ERROR_RULE, {HEAD(file_bytes, 8, (1ull << 36) + 1)}},
    {"R2.7", LS_ERROR_RULE, {HEAD(directory_offset, 8, 320)}},
    {"R2.8", LS_ERROR_RULE, {HEAD(counts[LS_CHUNK_VOXELS], 4, 12)}},
    {"R2.8", LS_ERROR_RULE, {HEAD(counts[LS_CHUNK_SURFACES], 4, 1)}},
    {"R2.9", LS_ERROR_RULE, {HEAD(lower[1], 4, NOT_A_NUMBER)}},
    {"R2.9", LS_ERROR_RULE, {HEAD(upper[2], 4, INFINITE)}},
    {"R2.9", LS_ERROR_RULE, {HEAD(lower[0], 4, NINE)}},
    {"R2.10", LS_ERROR_RULE, {HEAD(transform_bound, 4, NOT_A_NUMBER)}},
    {"R2.10", LS_ERROR_RULE, {HEAD(transform_bound, 4, INFINITE)}},
    {"R2.10", LS_ERROR_RULE, {HEAD(transform_bound, 4, MINUS_ONE)}},
    {"R2.11", LS_ERROR_RULE, {HEAD(depth, 4, 9)}},
    {"R2.11", LS_ERROR_RULE, {HEAD(depth, 4, 1)}},
    {"R2.11", LS_ERROR_RULE, {HEAD(depth, 4, 3)}},
    {"R2.12", LS_ERROR_RULE, {HEAD(reserved[0], 1, 1)}},
    {"R2.12", LS_ERROR_RULE, {HEAD(reserved[63], 1, 128)}},
    {"R2.14", LS_ERROR_RULE, {HEAD(required_features, 8, 62)}},
    {"R2.14", LS_ERROR_RULE, {HEAD(required_features, 8, 61)}},
    {"R2.14", LS_ERROR_RULE, {HEAD(required_features, 8, 31)}},
    {"R2.15", LS_ERROR_RULE, {HEAD(optional_features, 8, 6)}},
    {"R2.15", LS_ERROR_RULE, {HEAD(optional_features, 8, 5)}},
    {"R2.15", LS_ERROR_RULE, {HEAD(optional_features, 8, 3)}},

    {"R3.1", LS_ERROR_RULE, {DIRECTORY(1, type, 4, 0x544A424F)}}, // OBJT twice
    {"R3.1",
     LS_ERROR_RULE,
     {DIRECTORY(8, type, 4, 0x47425553), DIRECTORY(10, type, 4, 0x434F4C42)}}, // SUBG before BLOC
    {"R3.1",
     LS_ERROR_RULE,
     {DIRECTORY(4, type, 4, 0x504F5453),   // unknown type
      DIRECTORY(4, flags, 4, 0),           //
      DIRECTORY(5, type, 4, 0x544A424F)}}, // OBJT again behind it
    {"R3.2", LS_ERROR_RULE, {DIRECTORY(0, flags, 4, 0)}},
    {"R3.2", LS_ERROR_RULE, {DIRECTORY(3, flags, 4, 1)}},
    {"R3.2", LS_ERROR_RULE, {DIRECTORY(14, flags, 4, 3)}},
    {"R3.2", LS_ERROR_FEATURE, {DIRECTORY(14, type, 4, 0x504F5453)}},
    {"R3.3", LS_ERROR_RULE, {DIRECTORY(0, stride, 4, 0)}},
    {"R3.3", LS_ERROR_RULE, {DIRECTORY(11, stride, 4, 8)}},
    {"R3.3",
     LS_ERROR_RULE,
     {DIRECTORY(5, type, 4, 0x504F5453), //
      DIRECTORY(5, stride, 4, 0)}},
    {"R3.4", LS_ERROR_RULE, {DIRECTORY(0, element_count, 8, 0)}},
    {"R3.4", LS_ERROR_RULE, {DIRECTORY(0, element_count, 8, 1ull << 60 | 3)}},
    {"R3.4", LS_ERROR_RULE, {DIRECTORY(0, stored_bytes, 8, 431)}},
    {"R3.4", LS_ERROR_RULE, {DIRECTORY(0, logical_bytes, 8, 433)}},
    {"R3.4",
     LS_ERROR_RULE,
     {DIRECTORY(14, element_count, 8, 1ull << 32), DIRECTORY(14, stored_bytes, 8, 1ull << 34),
      DIRECTORY(14, logical_bytes, 8, 1ull << 34)}},
    {"R3.5", LS_ERROR_RULE, {DIRECTORY(7, codec, 4, 1)}},
    {"R3.6", LS_ERROR_RULE, {DIRECTORY(0, offset, 8, 8192)}},
    {"R3.6", LS_ERROR_RULE, {DIRECTORY(0, offset, 8, 4097)}},
    {"R3.6", LS_ERROR_RULE, {DIRECTORY(2, offset, 8, UINT64_MAX - 4095)}},
    {"R3.6",
     LS_ERROR_RULE,
     {DIRECTORY(14, element_count, 8, 238), DIRECTORY(14, stored_bytes, 8, 952),
      DIRECTORY(14, logical_bytes, 8, 952)}},
    {"R3.6",
     LS_ERROR_RULE,
     {DIRECTORY(14, element_count, 8, 236), DIRECTORY(14, stored_bytes, 8, 944),
      DIRECTORY(14, logical_bytes, 8, 944)}},
    {"R3.7", LS_ERROR_RULE, {{PADDING, 0, 0, 1, 1}}},
    {"R3.7", LS_ERROR_RULE, {{PADDING, 14, 0, 1, 128}}},

    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, first_triangle, 1)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, first_subgrid, 1)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, triangle_count, 39)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, voxel_count, UINT32_MAX)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, first_block, 3)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, first_cell_block, 6)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, subgrid_count, 1)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, first_voxel, 0)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, reference_count, 0)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, first_leaf_node, 5)}},
    {"R4.2", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, shaft_word_count, 1)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, kind, 2)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, kind, LS_OBJECT_LIST)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, lower.x, NOT_A_NUMBER)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, upper.y, INFINITE)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, lower.z, TWO)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, reach, MINUS_ONE)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, reach, INFINITE)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, face_count, 39)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, patches, 0)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, patches, 17)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, patches, 3)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, depth, 9)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, depth, 1)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, reserved, 1)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, grid_lower.y, ONE)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, inverse_cell, ONE)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, cells[2], 1)}},
    {"R4.3", LS_ERROR_RULE, {WORD(OBJECTS, 0, LsObject, bound, SMALLEST)}},
    {"R4.4", LS_ERROR_RULE, {WORD(TRIANGLES, 0, LsTriangle, v0.x, NOT_A_NUMBER)}},
    {"R4.4", LS_ERROR_RULE, {WORD(TRIANGLES, 41, LsTriangle, v1.y, TWO)}},
    {"R4.4", LS_ERROR_RULE, {WORD(TRIANGLES, 42, LsTriangle, v2.z, INFINITE)}},
    {"R4.4", LS_ERROR_RULE, {WORD(TRIANGLES, 0, LsTriangle, primitive, 4)}},
    {"R4.4", LS_ERROR_RULE, {WORD(TRIANGLES, 20, LsTriangle, material, 2)}},
    {"R4.4", LS_ERROR_RULE, {WORD(TRIANGLES, 20, LsTriangle, reserved, 1)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 1, LsInstance, object_from_world[1].z, INFINITE)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 3, LsInstance, world_from_object[2].w, NOT_A_NUMBER)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 1, LsInstance, object, 3)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 1, LsInstance, node, 3)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 1, LsInstance, mask, 256)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 1, LsInstance, flags, 4)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 1, LsInstance, flags, LS_INSTANCE_IDENTITY)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 0, LsInstance, world_from_object[0].w, SMALLEST)}},
    {"R4.5", LS_ERROR_RULE, {WORD(INSTANCES, 3, LsInstance, reserved[3], 1)}},
    {"R4.6", LS_ERROR_RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 2 << 4 | 2)}},
    {"R4.6", LS_ERROR_RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 4 << 4 | 1)}},
    {"R4.6", LS_ERROR_RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 3 << 4 | 1)}},
    {"R4.6",
     LS_ERROR_RULE,
     {WORD(TOP_NODES, 4, LsBvhNode, leaf, 0 << 4 | 1), WORD(TOP_NODES, 4, LsBvhNode, escape, 5)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 0, LsBvhNode, escape, 4)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 0, LsBvhNode, escape, 8)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 2)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 5)}}, // ends in its sibling
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 8)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 0)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 2, LsBvhNode, escape, 2)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 2, LsBvhNode, escape, 4)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 2 << 4)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 6, LsBvhNode, leaf, 0)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 5, LsBvhNode, lower.x, NOT_A_NUMBER)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 5, LsBvhNode, upper.z, INFINITE)}},
    {"R4.7", LS_ERROR_RULE, {WORD(TOP_NODES, 5, LsBvhNode, lower.y, NINE)}},
    {"R4.7", LS_ERROR_RULE, {WORD(LEAF_NODES, 0, LsBvhNode, escape, 4)}},
    {"R4.7", LS_ERROR_RULE, {WORD(LEAF_NODES, 2, LsBvhNode, escape, 6)}},
    {"R4.7", LS_ERROR_RULE, {WORD(LEAF_NODES, 5, LsBvhNode, lower.x, NINE)}},
    {"R4.8", LS_ERROR_RULE, {WORD(NODES, 1, LsSceneNode, parent_from_node[0].x, NOT_A_NUMBER)}},
    {"R4.8", LS_ERROR_RULE, {WORD(NODES, 0, LsSceneNode, parent, 0)}},
    {"R4.8", LS_ERROR_RULE, {WORD(NODES, 1, LsSceneNode, parent, 2)}},
    {"R4.8", LS_ERROR_RULE, {WORD(NODES, 1, LsSceneNode, parent, LS_NONE - 1)}},
    {"R4.8", LS_ERROR_RULE, {WORD(NODES, 2, LsSceneNode, reserved[2], 1)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, base_color.x, MINUS_ONE)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, base_color.z, TWO)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, metallic, NOT_A_NUMBER)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, roughness, TWO)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 1, LsMaterial, emission.x, MINUS_ONE)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 1, LsMaterial, emission.y, INFINITE)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, flags, LS_MATERIAL_EMISSIVE)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, emission.z, SMALLEST)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, flags, 4)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 0, LsMaterial, reserved0, 1)}},
    {"R4.9", LS_ERROR_RULE, {WORD(MATERIALS, 1, LsMaterial, reserved1, 1)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, instance, 4)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, triangle, 2)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, triangle, 0)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, area, 0)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, area, INFINITE)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, cumulative, 0)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, cumulative, TWO)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 0, LsLight, cumulative, NOT_A_NUMBER)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 1, LsLight, cumulative, HALF)}},
    {"R4.10", LS_ERROR_RULE, {WORD(LIGHTS, 1, LsLight, cumulative, SMALLEST)}},
    {"R4.11", LS_ERROR_RULE, {WORD(CAMERAS, 0, LsCamera, world_from_camera[2].w, INFINITE)}},
    {"R4.11", LS_ERROR_RULE, {WORD(CAMERAS, 0, LsCamera, tan_half_y, 0)}},
    {"R4.11", LS_ERROR_RULE, {WORD(CAMERAS, 0, LsCamera, tan_half_y, INFINITE)}},
    {"R4.11", LS_ERROR_RULE, {WORD(CAMERAS, 0, LsCamera, aspect, MINUS_ONE)}},
    {"R4.11", LS_ERROR_RULE, {WORD(CAMERAS, 0, LsCamera, aspect, NOT_A_NUMBER)}},
    {"R4.11", LS_ERROR_RULE, {WORD(CAMERAS, 0, LsCamera, reserved[0], 1)}},

    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, cells[0], 0)}},
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, cells[2], 4097)}},
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, cells[1], UINT32_MAX)}},
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, inverse_cell, 0)}},
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, inverse_cell, INFINITE)}},
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, grid_lower.z, NOT_A_NUMBER)}},
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, bound, 0)}},
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, bound, 0x3C800000u)}}, // 2^-6
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, bound, 0x3E800000u)}}, // 2^-2
    {"R5.1", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, bound, NOT_A_NUMBER)}},
    {"R5.2", LS_ERROR_RULE, {WORD(OBJECTS, 1, LsObject, cells[0], 9)}},
    {"R5.2",
     LS_ERROR_RULE,
     {WORD(OBJECTS, 1, LsObject, cells[0], 4096), WORD(OBJECTS, 1, LsObject, cells[1], 4096),
      WORD(OBJECTS, 1, LsObject, cells[2], 4096)}},
    {"R5.3", LS_ERROR_RULE, {INDEX(BLOCKS, 1, 0x11111101)}},
    {"R5.3", LS_ERROR_RULE, {INDEX(BLOCKS, 1, 0x01111111)}},
    {"R5.3", LS_ERROR_RULE, {INDEX(BLOCKS, 3, 5 << 4)}},
    {"R5.3", LS_ERROR_RULE, {INDEX(BLOCKS, 3, 0xFFFFFFF0)}},
    {"R5.3", LS_ERROR_RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[1], 0x11011111)}},
    {"R5.3", LS_ERROR_RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[0], 12 << 4)}},
    {"R5.3", LS_ERROR_RULE, {WORD(CELL_BLOCKS, 4, LsCellBlock, cells[63], 0xFFFFFFF0)}},
    {"R5.4", LS_ERROR_RULE, {INDEX(BLOCKS, 0, 1 << 4)}},
    {"R5.4", LS_ERROR_RULE, {INDEX(BLOCKS, 3, 0 << 4)}},
    {"R5.4", LS_ERROR_RULE, {INDEX(BLOCKS, 3, 2 << 4)}},
    {"R5.4",
     LS_ERROR_RULE,
     {INDEX(BLOCKS, 4, 0x11111111)}}, // its block and voxel are never reached
    {"R5.4", LS_ERROR_RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[0], 1 << 4)}},
    {"R5.4", LS_ERROR_RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[1], 0 << 4)}},
    {"R5.4", LS_ERROR_RULE, {WORD(CELL_BLOCKS, 4, LsCellBlock, cells[63], 0x11111111)}},
    {"R5.5",
     LS_ERROR_RULE,
     {WORD(CELL_BLOCKS, 1, LsCellBlock, cells[0], 0x11111111),
      WORD(CELL_BLOCKS, 1, LsCellBlock, cells[2], 4 << 4)}},
    {"R5.5",
     LS_ERROR_RULE,
     {WORD(CELL_BLOCKS, 1, LsCellBlock, cells[0], 0x11111111),
      WORD(CELL_BLOCKS, 1, LsCellBlock, cells[4], 4 << 4)}},
    {"R5.5",
     LS_ERROR_RULE,
     {WORD(CELL_BLOCKS, 5, LsCellBlock, cells[0], 0x11111111),
      WORD(CELL_BLOCKS, 5, LsCellBlock, cells[16], 0 << 4)}},
    {"R5.6", LS_ERROR_RULE, {INDEX(SUBGRIDS, 0, 2)}},
    {"R5.6", LS_ERROR_RULE, {INDEX(SUBGRIDS, 2, 4)}},
    {"R5.6", LS_ERROR_RULE, {INDEX(SUBGRIDS, 2, LS_NONE)}},
    {"R5.6", LS_ERROR_RULE, {INDEX(SUBGRIDS, 2, 0)}}, // depth 2 is not reached
    {"R5.6", LS_ERROR_RULE, {INDEX(SUBGRIDS, 1, 2), INDEX(SUBGRIDS, 2, 3)}}, // depth 3
    {"R5.6", LS_ERROR_RULE, {WORD(OBJECTS, 2, LsObject, depth, 1)}},
    {"R5.7", LS_ERROR_RULE, {WORD(VOXELS, 2, LsVoxel, table, 1)}},
    {"R5.7", LS_ERROR_RULE, {WORD(VOXELS, 2, LsVoxel, table, 5)}},
    {"R5.7", LS_ERROR_RULE, {WORD(VOXELS, 2, LsVoxel, table, LS_NONE)}},
    {"R5.7", LS_ERROR_RULE, {WORD(VOXELS, 2, LsVoxel, table, 2)}}, // twice
    {"R5.7", LS_ERROR_RULE, {WORD(VOXELS, 2, LsVoxel, table, 4)}}, // another block's
    {"R5.7", LS_ERROR_RULE, {WORD(VOXELS, 7, LsVoxel, shape, LS_VOXEL_LIST)}},

    {"R6.1", LS_ERROR_RULE, {WORD(VOXELS, 0, LsVoxel, shape, 4)}},
    {"R6.1", LS_ERROR_RULE, {WORD(VOXELS, 0, LsVoxel, shape, LS_VOXEL_LIST | 1 << 8)}},
    {"R6.1", LS_ERROR_RULE, {WORD(VOXELS, 2, LsVoxel, shape, LS_VOXEL_SUBGRID | 1 << 16)}},
    {"R6.1", LS_ERROR_RULE, {WORD(VOXELS, 5, LsVoxel, shape, LS_VOXEL_BVH | 1 << 23)}},
    {"R6.1", LS_ERROR_RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x01020101)}},
    {"R6.2", LS_ERROR_RULE, {WORD(VOXELS, 0, LsVoxel, first_reference, 1)}},
    {"R6.2", LS_ERROR_RULE, {WORD(VOXELS, 2, LsVoxel, first_reference, 0)}},
    {"R6.2", LS_ERROR_RULE, {WORD(VOXELS, 0, LsVoxel, reference_count, 102)}},
    {"R6.2", LS_ERROR_RULE, {WORD(VOXELS, 0, LsVoxel, reference_count, UINT32_MAX)}},
    {"R6.2",
     LS_ERROR_RULE,
     {WORD(VOXELS, 11, LsVoxel, reference_count, 2),
      WORD(LEAF_NODES, 5, LsBvhNode, leaf, 2)}}, // one is left over
    {"R6.2", LS_ERROR_RULE, {INDEX(REFERENCES, 1, 40)}},
    {"R6.2", LS_ERROR_RULE, {INDEX(REFERENCES, 1, 0)}},        // twice
    {"R6.2", LS_ERROR_RULE, {INDEX(REFERENCES, 3, 1)}},        // falling
    {"R6.2", LS_ERROR_RULE, {INDEX(REFERENCES, 20, LS_NONE)}}, // in a BVH
    {"R6.2", LS_ERROR_RULE, {INDEX(REFERENCES, 101, 1)}},
    {"R6.3", LS_ERROR_RULE, {WORD(VOXELS, 0, LsVoxel, table, 1)}},
    {"R6.3", LS_ERROR_RULE, {WORD(VOXELS, 0, LsVoxel, reference_count, 0)}},
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00020001)}},
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00021101)}},
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00010101)}},
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 9, LsVoxel, shape, 0x00060101)}},
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 9, LsVoxel, shape, 0x00040101)}}, // 32 in 16 bits
    {"R6.4",
     LS_ERROR_RULE,
     {WORD(VOXELS, 1, LsVoxel, shape, 0x00051001)}}, // more words than there are
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 1, LsVoxel, table, 1)}},
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 4, LsVoxel, table, 0)}},
    {"R6.4", LS_ERROR_RULE, {WORD(VOXELS, 10, LsVoxel, shape, 0x00020201)}}, // words are left over
    {"R6.4", LS_ERROR_RULE, {INDEX(SHAFTS, 1, 0x00080000)}},                 // bit 3 of 3
    {"R6.4", LS_ERROR_RULE, {INDEX(SHAFTS, 1, 0x10000000)}},                 // behind the 15th mask
    {"R6.4", LS_ERROR_RULE, {INDEX(SHAFTS, 69, 0x00010000)}},                // same, 16 bits wide
    {"R6.4", LS_ERROR_RULE, {INDEX(SHAFTS, 30, 0x40000000)}},                // bit 6 of 6
    {"R6.5",
     LS_ERROR_RULE,
     {WORD(VOXELS, 7, LsVoxel, reference_count, 1), WORD(VOXELS, 8, LsVoxel, first_reference, 59),
      WORD(VOXELS, 8, LsVoxel, reference_count, 3)}},
    {"R6.6", LS_ERROR_RULE, {WORD(VOXELS, 5, LsVoxel, table, 1)}},
    {"R6.6", LS_ERROR_RULE, {WORD(VOXELS, 11, LsVoxel, table, 0)}},
    {"R6.6", LS_ERROR_RULE, {WORD(LEAF_NODES, 0, LsBvhNode, escape, 7)}},
    {"R6.6", LS_ERROR_RULE, {WORD(LEAF_NODES, 0, LsBvhNode, escape, 0)}},
    {"R6.6", LS_ERROR_RULE, {WORD(LEAF_NODES, 1, LsBvhNode, leaf, 1 << 4 | 15)}},
    {"R6.6", LS_ERROR_RULE, {WORD(LEAF_NODES, 3, LsBvhNode, leaf, 15 << 4 | 14)}},
    {"R6.6", LS_ERROR_RULE, {WORD(LEAF_NODES, 4, LsBvhNode, leaf, 30 << 4 | 6)}},
    {"R6.6", LS_ERROR_RULE, {WORD(LEAF_NODES, 4, LsBvhNode, leaf, 30 << 4 | 4)}},
};

static LsResult check_all(const LsFixtureBytes* bytes, LsError* error)
{
    LsFile file;
    LsResult result = ls_file_open(&file, bytes->bytes, bytes->size, "broken", error);
    result = result == LS_OK ? ls_file_check(&file, "broken", error) : result;
    return result == LS_OK ? ls_file_check_hashes(&file, "broken", error) : result;
}

// Whether `bytes` are refused with `result` by `rule`; says so if not.
static bool is_refused(const LsFixtureBytes* bytes, LsResult result, const char* rule,
                       const char* what)
{
    LsError error = {0};
    const LsResult got = check_all(bytes, &error);
    const char* named = strchr(error.text, 'R');
    const size_t length = strlen(rule);
    if (got != result || named == NULL || strncmp(named, rule, length) != 0 ||
        strchr(":)", named[length]) == NULL || strncmp(error.text, "broken: ", 8) != 0 ||
        strchr(error.text, '\n') != NULL)
    {
        print_error("%s, %s: %s, \"%s\"\n", rule, what, ls_result_text(got), error.text);
        return false;
    }
    return true;
}

static void apply_edit(const LsFixtureBytes* bytes, const Edit* edit)
{
    uint64_t offset = edit->offset;
    const LsEntry* entries = (const LsEntry*)(const void*)(bytes->bytes + LS_HEADER_BYTES);
    if (edit->place == PADDING)
    {
        offset = entries[edit->record].offset - 1;
    }
    else if (edit->place == ENTRY)
    {
        offset += LS_HEADER_BYTES + edit->record * LS_ENTRY_BYTES;
    }
    else if (edit->place < LS_CHUNK_COUNT)
    {
        assert_true(edit->record < entries[edit->place].element_count);
        offset += entries[edit->place].offset + edit->record * entries[edit->place].stride;
    }
    memcpy(bytes->bytes + offset, &edit->value, edit->size);
}

static void test_fixture_is_legal(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    const LsResult result = check_all(&bytes, &error);
    assert_string_equal(error.text, "");
    assert_int_equal(result, LS_OK);
    ls_fixture_free(&bytes);
}

static void test_edits_break_their_rule(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFixtureBytes legal = ls_fixture_bytes(&fixture.desc);
    LsFixtureBytes broken = {aligned_alloc(4096, (legal.size + 4095) / 4096 * 4096), legal.size};
    uint32_t failures = 0;
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); ++i)
    {
        memcpy(broken.bytes, legal.bytes, legal.size);
        for (int k = 0; k < 3 && cases[i].edits[k].size > 0; ++k)
        {
            apply_edit(&broken, &cases[i].edits[k]);
        }
        ls_fixture_rehash(&broken);
        char what[32];
        snprintf(what, sizeof(what), "case %zu", i);
        failures += !is_refused(&broken, cases[i].result, cases[i].rule, what);
    }
    assert_int_equal(failures, 0);
    ls_fixture_free(&broken);
    ls_fixture_free(&legal);
}

// R2.13 and R3.8: the same edit, the hash left as it was.
static void test_hashes_are_compared(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    bytes.bytes[offsetof(LsHeader, source_hash)] ^= 1;
    assert_true(is_refused(&bytes, LS_ERROR_HASH, "R2.13", "source_hash"));
    bytes.bytes[offsetof(LsHeader, source_hash)] ^= 1;
    bytes.bytes[bytes.size - 600] ^= 1; // a legal bit of a mask
    assert_true(is_refused(&bytes, LS_ERROR_HASH, "R3.8", "a mask"));
    ls_fixture_free(&bytes);
}

// ---- Files of other shapes ----------------------------------------------------------------------

static void expect_desc(const LsFileDesc* desc, const char* rule, const char* what)
{
    LsFixtureBytes bytes = ls_fixture_bytes(desc);
    assert_true(is_refused(&bytes, LS_ERROR_RULE, rule, what));
    ls_fixture_free(&bytes);
}

static void test_missing_chunks(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFileDesc desc = fixture.desc;
    desc.OBJECTS_count = 0;
    expect_desc(&desc, "R4.1", "no objects");
    desc = fixture.desc;
    desc.INSTANCES_count = 0;
    expect_desc(&desc, "R4.1", "no instances");
    desc = fixture.desc;
    desc.MATERIALS_count = 0;
    expect_desc(&desc, "R4.1", "no materials");
    desc = fixture.desc;
    desc.TRIANGLES_count = 0;
    expect_desc(&desc, "R4.1", "no triangles");
    desc = fixture.desc;
    desc.TOP_NODES_count = 0;
    expect_desc(&desc, "R4.6", "no top level");
    desc = fixture.desc;
    desc.NODES_count = 0;
    expect_desc(&desc, "R4.5", "no nodes");
    desc = fixture.desc;
    desc.VOXELS_count -= 1;
    expect_desc(&desc, "R4.2", "a voxel fewer");
    fixture.objects[1].triangle_count = 0;
    fixture.objects[2].first_triangle = 2;
    desc = fixture.desc;
    desc.TRIANGLES_count = 3;
    expect_desc(&desc, "R4.3", "an object without triangles");
}

static void test_top_level_without_need(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    fixture.desc.INSTANCES_count = 1; // the identity
    fixture.desc.LIGHTS_count = 0;
    expect_desc(&fixture.desc, "R4.6", "one instance with the identity");
    fixture.instances[0].flags = 0;
    expect_desc(&fixture.desc, "R4.6", "four leaves for one instance");
    fixture.top_nodes[0].escape = 1;
    fixture.top_nodes[0].leaf = 1;
    fixture.desc.TOP_NODES_count = 1;
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    assert_int_equal(check_all(&bytes, &error), LS_OK);
    ls_fixture_free(&bytes);
}

static void test_subgrids_without_blocks(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    fixture.objects[1].subgrid_count = 6;
    fixture.objects[2].first_subgrid = 6;
    const uint32_t subgrids[6] = {0};
    fixture.desc.subgrids = subgrids;
    fixture.desc.SUBGRIDS_count = 6;
    expect_desc(&fixture.desc, "R5.6", "more sub-grids than cell blocks");
}

static void test_node_levels(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsSceneNode nodes[LS_MAX_NODE_DEPTH + 1];
    for (uint32_t i = 0; i <= LS_MAX_NODE_DEPTH; ++i)
    {
        nodes[i] = fixture.nodes[0];
        nodes[i].parent = i == 0 ? LS_NONE : i - 1;
    }
    fixture.desc.nodes = nodes;
    fixture.desc.NODES_count = LS_MAX_NODE_DEPTH;
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    assert_int_equal(check_all(&bytes, &error), LS_OK);
    ls_fixture_free(&bytes);
    fixture.desc.NODES_count = LS_MAX_NODE_DEPTH + 1;
    expect_desc(&fixture.desc, "R4.8", "65 levels");
}

// More instances than the check looks at in one go; the twice named one is in the last part.
static void test_many_instances(void** state)
{
    (void)state;
    enum
    {
        COUNT = 300000
    };
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsInstance* instances = malloc(COUNT * sizeof(LsInstance));
    LsBvhNode* nodes = malloc((COUNT + 1) * sizeof(LsBvhNode));
    assert_non_null(instances);
    assert_non_null(nodes);
    nodes[0] = fixture.top_nodes[0];
    nodes[0].escape = COUNT + 1;
    for (uint32_t i = 0; i < COUNT; ++i)
    {
        instances[i] = fixture.instances[i % 4];
        nodes[i + 1] = fixture.top_nodes[2];
        nodes[i + 1].escape = i + 2;
        nodes[i + 1].leaf = (COUNT - 1 - i) << 4 | 1;
    }
    fixture.desc.instances = instances;
    fixture.desc.INSTANCES_count = COUNT;
    fixture.desc.top_nodes = nodes;
    fixture.desc.TOP_NODES_count = COUNT + 1;
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    assert_int_equal(check_all(&bytes, &error), LS_OK);
    ls_fixture_free(&bytes);
    nodes[2].leaf = nodes[1].leaf;
    expect_desc(&fixture.desc, "R4.6", "the last instance twice");
    free(nodes);
    free(instances);
}

// ---- Completeness -------------------------------------------------------------------------------

// Rules that whole tests above break.
static const char* const other_rules[] = {"R2.13", "R3.8", "R4.1"};

static bool is_covered(const char* rule)
{
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); ++i)
    {
        if (strcmp(cases[i].rule, rule) == 0)
        {
            return true;
        }
    }
    for (size_t i = 0; i < sizeof(other_rules) / sizeof(other_rules[0]); ++i)
    {
        if (strcmp(other_rules[i], rule) == 0)
        {
            return true;
        }
    }
    return false;
}

static void test_every_rule_is_broken_once(void** state)
{
    (void)state;
    LsFixtureBytes spec = ls_fixture_read(LS_SOURCE_DIR "/format/SPEC.md");
    spec.bytes[spec.size] = '\0'; // ls_fixture_read leaves room for it
    uint32_t found = 0;
    for (const char* at = strchr((const char*)spec.bytes, 'R'); at != NULL;
         at = strchr(at + 1, 'R'))
    {
        unsigned chapter, number;
        if (sscanf(at, "R%u.%u", &chapter, &number) == 2)
        {
            char rule[32];
            snprintf(rule, sizeof(rule), "R%u.%u", chapter, number);
            ++found;
            if (!is_covered(rule))
            {
                fail_msg("no test breaks %s", rule);
            }
        }
    }
    assert_in_range(found, 47, 1000);
    ls_fixture_free(&spec);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fixture_is_legal),
        cmocka_unit_test(test_edits_break_their_rule),
        cmocka_unit_test(test_hashes_are_compared),
        cmocka_unit_test(test_missing_chunks),
        cmocka_unit_test(test_top_level_without_need),
        cmocka_unit_test(test_subgrids_without_blocks),
        cmocka_unit_test(test_node_levels),
        cmocka_unit_test(test_many_instances),
        cmocka_unit_test(test_every_rule_is_broken_once),
    };
    return cmocka_run_group_tests_name("check", tests, NULL, NULL);
}
