// check_cases.h - broken files by the rule that they break, for test_check.c.

#ifndef LS_TEST_CHECK_CASES_H
#define LS_TEST_CHECK_CASES_H

#include "ls_format.h"

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

// What is raised, in the table's words.
#define FOREIGN LS_MESSAGE_LSPACE_FOREIGN
#define BYTE_ORDER LS_MESSAGE_LSPACE_BYTE_ORDER
#define MAJOR LS_MESSAGE_LSPACE_MAJOR
#define READER LS_MESSAGE_LSPACE_READER
#define FEATURE LS_MESSAGE_LSPACE_FEATURE
#define UNKNOWN_CHUNK LS_MESSAGE_LSPACE_CHUNK
#define CUT LS_MESSAGE_LSPACE_CUT
#define RULE LS_MESSAGE_LSPACE_RULE

typedef struct Case
{
    const char* rule;
    LsMessage message;
    Edit edits[3]; // up to the first of size 0
} Case;

// A broken file each, its hashes made right again. In the fixture the entries are the chunks in
// order, so entry n is chunk n. See file_fixture.c for what the records hold.
static const Case cases[] = {
    {"R2.1", FOREIGN, {HEAD(magic[0], 1, 0)}},
    {"R2.1", FOREIGN, {HEAD(magic[9], 1, '2')}},
    {"R2.1", FOREIGN, {HEAD(magic[11], 1, '\n')}},
    {"R2.1", FOREIGN, {HEAD(magic[0], 8, 0), HEAD(magic[8], 8, 0)}},
    {"R2.2", MAJOR, {HEAD(version_major, 4, 1)}},
    {"R2.2", MAJOR, {HEAD(version_major, 4, 0x01000000)}},
    {"R2.2", BYTE_ORDER, {HEAD(version_minor, 4, 0x01000000)}},
    {"R2.2", BYTE_ORDER, {HEAD(version_minor, 4, 0x02000000)}},
    {"R2.2", BYTE_ORDER, {HEAD(version_minor, 4, 0x03000000)}},
    {"R2.2", BYTE_ORDER, {HEAD(version_minor, 4, 0x04000000)}},
    {"R2.3", READER, {HEAD(reader_minor, 4, 5)}},
    {"R2.4", RULE, {HEAD(chunk_count, 4, 0)}},
    {"R2.4", RULE, {HEAD(chunk_count, 4, 4097)}},
    {"R2.4", RULE, {HEAD(chunk_count, 4, UINT32_MAX)}},
    {"R2.5", FEATURE, {HEAD(required_features, 8, 511)}},
    {"R2.5", FEATURE, {HEAD(required_features, 8, 1ull << 63 | 63)}},
    {"R2.6", CUT, {HEAD(file_bytes, 8, 1 << 20)}},
    {"R2.6", RULE, {HEAD(file_bytes, 8, 5000)}},
    {"R2.6", RULE, {HEAD(file_bytes, 8, UINT64_MAX)}},
    {"R2.6", RULE, {HEAD(file_bytes, 8, (1ull << 36) + 1)}},
    {"R2.7", RULE, {HEAD(directory_offset, 8, 320)}},
    {"R2.8", RULE, {HEAD(counts[LS_CHUNK_VOXELS], 4, 12)}},
    {"R2.8", RULE, {HEAD(counts[LS_CHUNK_SURFACES], 4, 2)}},
    {"R2.9", RULE, {HEAD(lower[1], 4, NOT_A_NUMBER)}},
    {"R2.9", RULE, {HEAD(upper[2], 4, INFINITE)}},
    {"R2.9", RULE, {HEAD(lower[0], 4, NINE)}},
    {"R2.10", RULE, {HEAD(transform_bound, 4, NOT_A_NUMBER)}},
    {"R2.10", RULE, {HEAD(transform_bound, 4, INFINITE)}},
    {"R2.10", RULE, {HEAD(transform_bound, 4, MINUS_ONE)}},
    {"R2.11", RULE, {HEAD(depth, 4, 9)}},
    {"R2.11", RULE, {HEAD(depth, 4, 1)}},
    {"R2.11", RULE, {HEAD(depth, 4, 3)}},
    {"R2.12", RULE, {HEAD(reserved[0], 1, 1)}},
    {"R2.12", RULE, {HEAD(reserved[63], 1, 128)}},
    {"R2.14", RULE, {HEAD(required_features, 8, 62)}},
    {"R2.14", RULE, {HEAD(required_features, 8, 61)}},
    {"R2.14", RULE, {HEAD(required_features, 8, 31)}},
    {"R2.14",
     RULE,
     {HEAD(required_features, 8, 127), HEAD(version_minor, 4, 3), HEAD(reader_minor, 4, 3)}},
    {"R2.14",
     RULE,
     {HEAD(required_features, 8, 191), HEAD(version_minor, 4, 4), HEAD(reader_minor, 4, 4)}},
    {"R2.15", RULE, {HEAD(optional_features, 8, 126)}},
    {"R2.15", RULE, {HEAD(optional_features, 8, 125)}},
    {"R2.15", RULE, {HEAD(optional_features, 8, 123)}},
    {"R2.15", RULE, {HEAD(optional_features, 8, 119)}},
    {"R2.15", RULE, {HEAD(optional_features, 8, 111)}},
    {"R2.15", RULE, {HEAD(optional_features, 8, 95)}},
    {"R2.15", RULE, {HEAD(optional_features, 8, 63)}},
    {"R2.16", RULE, {HEAD(version_minor, 4, 0)}},
    {"R2.16", RULE, {HEAD(version_minor, 4, 1)}},
    {"R2.16", RULE, {HEAD(reader_minor, 4, 0)}},
    {"R2.16", RULE, {HEAD(reader_minor, 4, 1)}},
    {"R2.16", RULE, {HEAD(version_minor, 4, 3)}},
    {"R2.16", RULE, {HEAD(reader_minor, 4, 3)}},
    {"R2.16", RULE, {HEAD(required_features, 8, 127)}},
    {"R2.16", RULE, {HEAD(required_features, 8, 191)}},

    {"R3.1", RULE, {DIRECTORY(1, type, 4, 0x544A424F)}}, // OBJT twice
    {"R3.1",
     RULE,
     {DIRECTORY(8, type, 4, 0x47425553), DIRECTORY(10, type, 4, 0x434F4C42)}}, // SUBG before BLOC
    {"R3.1",
     RULE,
     {DIRECTORY(4, type, 4, 0x504F5453),   // unknown type
      DIRECTORY(4, flags, 4, 0),           //
      DIRECTORY(5, type, 4, 0x544A424F)}}, // OBJT again behind it
    {"R3.2", RULE, {DIRECTORY(0, flags, 4, 0)}},
    {"R3.2", RULE, {DIRECTORY(3, flags, 4, 1)}},
    {"R3.2", RULE, {DIRECTORY(14, flags, 4, 3)}},
    {"R3.2", UNKNOWN_CHUNK, {DIRECTORY(14, type, 4, 0x504F5453)}},
    {"R3.3", RULE, {DIRECTORY(0, stride, 4, 0)}},
    {"R3.3", RULE, {DIRECTORY(11, stride, 4, 8)}},
    {"R3.3",
     RULE,
     {DIRECTORY(5, type, 4, 0x504F5453), //
      DIRECTORY(5, stride, 4, 0)}},
    {"R3.4", RULE, {DIRECTORY(0, element_count, 8, 0)}},
    {"R3.4", RULE, {DIRECTORY(0, element_count, 8, 1ull << 60 | 3)}},
    {"R3.4", RULE, {DIRECTORY(0, stored_bytes, 8, 431)}},
    {"R3.4", RULE, {DIRECTORY(0, logical_bytes, 8, 433)}},
    {"R3.4",
     RULE,
     {DIRECTORY(14, element_count, 8, 1ull << 32), DIRECTORY(14, stored_bytes, 8, 1ull << 34),
      DIRECTORY(14, logical_bytes, 8, 1ull << 34)}},
    {"R3.5", RULE, {DIRECTORY(7, codec, 4, 1)}},
    {"R3.6", RULE, {DIRECTORY(0, offset, 8, 8192)}},
    {"R3.6", RULE, {DIRECTORY(0, offset, 8, 4097)}},
    {"R3.6", RULE, {DIRECTORY(2, offset, 8, UINT64_MAX - 4095)}},
    {"R3.6",
     RULE,
     {DIRECTORY(26, element_count, 8, 57), DIRECTORY(26, stored_bytes, 8, 228),
      DIRECTORY(26, logical_bytes, 8, 228)}},
    {"R3.6",
     RULE,
     {DIRECTORY(26, element_count, 8, 55), DIRECTORY(26, stored_bytes, 8, 220),
      DIRECTORY(26, logical_bytes, 8, 220)}},
    {"R3.7", RULE, {{PADDING, 0, 0, 1, 1}}},
    {"R3.7", RULE, {{PADDING, 14, 0, 1, 128}}},
    {"R3.7", RULE, {{PADDING, 26, 0, 1, 64}}},

    {"R4.2", RULE, {WORD(OBJECTS, 0, LsObject, first_triangle, 1)}},
    {"R4.2", RULE, {WORD(OBJECTS, 0, LsObject, first_subgrid, 1)}},
    {"R4.2", RULE, {WORD(OBJECTS, 1, LsObject, triangle_count, 39)}},
    {"R4.2", RULE, {WORD(OBJECTS, 1, LsObject, voxel_count, UINT32_MAX)}},
    {"R4.2", RULE, {WORD(OBJECTS, 2, LsObject, first_block, 3)}},
    {"R4.2", RULE, {WORD(OBJECTS, 2, LsObject, first_cell_block, 6)}},
    {"R4.2", RULE, {WORD(OBJECTS, 2, LsObject, subgrid_count, 1)}},
    {"R4.2", RULE, {WORD(OBJECTS, 2, LsObject, first_voxel, 0)}},
    {"R4.2", RULE, {WORD(OBJECTS, 2, LsObject, reference_count, 0)}},
    {"R4.2", RULE, {WORD(OBJECTS, 2, LsObject, first_leaf_node, 5)}},
    {"R4.2", RULE, {WORD(OBJECTS, 2, LsObject, shaft_word_count, 1)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, kind, 2)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, kind, LS_OBJECT_LIST)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, lower.x, NOT_A_NUMBER)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, upper.y, INFINITE)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, lower.z, TWO)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, reach, MINUS_ONE)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, reach, INFINITE)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, face_count, 39)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, patches, 0)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, patches, 17)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, patches, 3)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, depth, 9)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, depth, 1)}},
    {"R4.3", RULE, {WORD(OBJECTS, 2, LsObject, scene_patches, 33)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, grid_lower.y, ONE)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, inverse_cell, ONE)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, cells[2], 1)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, bound, SMALLEST)}},
    {"R4.4", RULE, {WORD(TRIANGLES, 0, LsTriangle, v0.x, NOT_A_NUMBER)}},
    {"R4.4", RULE, {WORD(TRIANGLES, 41, LsTriangle, v1.y, TWO)}},
    {"R4.4", RULE, {WORD(TRIANGLES, 42, LsTriangle, v2.z, INFINITE)}},
    {"R4.4", RULE, {WORD(TRIANGLES, 0, LsTriangle, primitive, 4)}},
    {"R4.4", RULE, {WORD(TRIANGLES, 20, LsTriangle, material, 2)}},
    {"R4.4", RULE, {WORD(TRIANGLES, 20, LsTriangle, reserved, 1)}},
    {"R4.5", RULE, {WORD(INSTANCES, 1, LsInstance, object_from_world[1].z, INFINITE)}},
    {"R4.5", RULE, {WORD(INSTANCES, 3, LsInstance, world_from_object[2].w, NOT_A_NUMBER)}},
    {"R4.5", RULE, {WORD(INSTANCES, 1, LsInstance, object, 3)}},
    {"R4.5", RULE, {WORD(INSTANCES, 1, LsInstance, node, 3)}},
    {"R4.5", RULE, {WORD(INSTANCES, 1, LsInstance, mask, 256)}},
    {"R4.5", RULE, {WORD(INSTANCES, 1, LsInstance, flags, 4)}},
    {"R4.5", RULE, {WORD(INSTANCES, 1, LsInstance, flags, LS_INSTANCE_IDENTITY)}},
    {"R4.5", RULE, {WORD(INSTANCES, 0, LsInstance, world_from_object[0].w, SMALLEST)}},
    {"R4.5", RULE, {WORD(INSTANCES, 3, LsInstance, reserved[3], 1)}},
    {"R4.6", RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 2 << 4 | 2)}},
    {"R4.6", RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 4 << 4 | 1)}},
    {"R4.6", RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 3 << 4 | 1)}},
    {"R4.6",
     RULE,
     {WORD(TOP_NODES, 4, LsBvhNode, leaf, 0 << 4 | 1), WORD(TOP_NODES, 4, LsBvhNode, escape, 5)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 0, LsBvhNode, escape, 4)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 0, LsBvhNode, escape, 8)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 2)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 5)}}, // ends in its sibling
    {"R4.7", RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 8)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 1, LsBvhNode, escape, 0)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 2, LsBvhNode, escape, 2)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 2, LsBvhNode, escape, 4)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 2, LsBvhNode, leaf, 2 << 4)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 6, LsBvhNode, leaf, 0)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 5, LsBvhNode, lower.x, NOT_A_NUMBER)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 5, LsBvhNode, upper.z, INFINITE)}},
    {"R4.7", RULE, {WORD(TOP_NODES, 5, LsBvhNode, lower.y, NINE)}},
    {"R4.7", RULE, {WORD(LEAF_NODES, 0, LsBvhNode, escape, 4)}},
    {"R4.7", RULE, {WORD(LEAF_NODES, 2, LsBvhNode, escape, 6)}},
    {"R4.7", RULE, {WORD(LEAF_NODES, 5, LsBvhNode, lower.x, NINE)}},
    {"R4.8", RULE, {WORD(NODES, 1, LsSceneNode, parent_from_node[0].x, NOT_A_NUMBER)}},
    {"R4.8", RULE, {WORD(NODES, 0, LsSceneNode, parent, 0)}},
    {"R4.8", RULE, {WORD(NODES, 1, LsSceneNode, parent, 2)}},
    {"R4.8", RULE, {WORD(NODES, 1, LsSceneNode, parent, LS_NONE - 1)}},
    {"R4.8", RULE, {WORD(NODES, 2, LsSceneNode, reserved[2], 1)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, base_color.x, MINUS_ONE)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, base_color.z, TWO)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, metallic, NOT_A_NUMBER)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, roughness, TWO)}},
    {"R4.9", RULE, {WORD(MATERIALS, 1, LsMaterial, emission.x, MINUS_ONE)}},
    {"R4.9", RULE, {WORD(MATERIALS, 1, LsMaterial, emission.y, INFINITE)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, flags, LS_MATERIAL_EMISSIVE)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, emission.z, SMALLEST)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, flags, 4)}},
    {"R4.9", RULE, {WORD(MATERIALS, 1, LsMaterial, surface, 2)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, surface, LS_NONE)}},
    {"R4.9", RULE, {WORD(MATERIALS, 0, LsMaterial, reserved0, 1)}},
    {"R4.9", RULE, {WORD(MATERIALS, 1, LsMaterial, reserved1, 1)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, instance, 4)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, triangle, 2)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, triangle, 0)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, area, 0)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, area, INFINITE)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, cumulative, 0)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, cumulative, TWO)}},
    {"R4.10", RULE, {WORD(LIGHTS, 0, LsLight, cumulative, NOT_A_NUMBER)}},
    {"R4.10", RULE, {WORD(LIGHTS, 1, LsLight, cumulative, HALF)}},
    {"R4.10", RULE, {WORD(LIGHTS, 1, LsLight, cumulative, SMALLEST)}},
    {"R4.11", RULE, {WORD(CAMERAS, 0, LsCamera, world_from_camera[2].w, INFINITE)}},
    {"R4.11", RULE, {WORD(CAMERAS, 0, LsCamera, tan_half_y, 0)}},
    {"R4.11", RULE, {WORD(CAMERAS, 0, LsCamera, tan_half_y, INFINITE)}},
    {"R4.11", RULE, {WORD(CAMERAS, 0, LsCamera, aspect, MINUS_ONE)}},
    {"R4.11", RULE, {WORD(CAMERAS, 0, LsCamera, aspect, NOT_A_NUMBER)}},
    {"R4.11", RULE, {WORD(CAMERAS, 0, LsCamera, reserved[0], 1)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, transmission, MINUS_ONE)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, transmission, TWO)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, ior, HALF)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, ior, MINUS_ONE)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, ior, INFINITE)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, ior, NOT_A_NUMBER)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, alpha, TWO)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, alpha, NOT_A_NUMBER)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, alpha_cutoff, MINUS_ONE)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, alpha_cutoff, INFINITE)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, normal_scale, INFINITE)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, flags, 2)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, base_color_texture, 2)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, metallic_roughness_texture, 2)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, normal_texture, 2)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, emissive_texture, 2)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, transmission_texture, 2)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, base_color_texture, LS_NONE - 1)}},
    {"R4.12", RULE, {WORD(SURFACES, 0, LsSurface, reserved, 1)}},
    {"R4.13", RULE, {WORD(TEXTURES, 0, LsTexture, row_u.x, NOT_A_NUMBER)}},
    {"R4.13", RULE, {WORD(TEXTURES, 0, LsTexture, row_u.w, ONE)}},
    {"R4.13", RULE, {WORD(TEXTURES, 1, LsTexture, row_v.z, INFINITE)}},
    {"R4.13", RULE, {WORD(TEXTURES, 1, LsTexture, row_v.w, SMALLEST)}},
    {"R4.13", RULE, {WORD(TEXTURES, 0, LsTexture, image, 2)}},
    {"R4.13", RULE, {WORD(TEXTURES, 1, LsTexture, image, LS_NONE)}},
    {"R4.13", RULE, {WORD(TEXTURES, 1, LsTexture, texcoord, 2)}},
    {"R4.13", RULE, {WORD(TEXTURES, 0, LsTexture, flags, 64)}},
    {"R4.13",
     RULE,
     {WORD(TEXTURES, 0, LsTexture, flags, LS_TEXTURE_CLAMP_U | LS_TEXTURE_MIRROR_U)}},
    {"R4.13",
     RULE,
     {WORD(TEXTURES, 0, LsTexture, flags, LS_TEXTURE_CLAMP_V | LS_TEXTURE_MIRROR_V)}},
    {"R4.13", RULE, {WORD(TEXTURES, 1, LsTexture, reserved, 1)}},
    {"R4.14", RULE, {WORD(IMAGES, 0, LsImage, width, 0)}},
    {"R4.14", RULE, {WORD(IMAGES, 1, LsImage, height, 0)}},
    {"R4.14", RULE, {WORD(IMAGES, 0, LsImage, width, 16385)}},
    {"R4.14", RULE, {WORD(IMAGES, 1, LsImage, height, LS_NONE)}},
    {"R4.14", RULE, {WORD(IMAGES, 0, LsImage, reserved, 1)}},
    {"R4.14", RULE, {WORD(IMAGES, 0, LsImage, first_pixel, 1)}},
    {"R4.14", RULE, {WORD(IMAGES, 1, LsImage, first_pixel, 3)}},
    {"R4.14", RULE, {WORD(IMAGES, 1, LsImage, first_pixel, 0)}},
    {"R4.14", RULE, {WORD(IMAGES, 1, LsImage, height, 4)}},
    {"R4.14", RULE, {WORD(IMAGES, 1, LsImage, height, 2)}},
    // 2^14 * 2^14 pixels: more than there are.
    {"R4.14",
     RULE,
     {WORD(IMAGES, 1, LsImage, width, 16384), WORD(IMAGES, 1, LsImage, height, 16384)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 0, LsAttributes, first_normal, 1)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 0, LsAttributes, first_normal, LS_NONE)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 0, LsAttributes, first_texcoord[0], 6)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 0, LsAttributes, first_texcoord[1], 0)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 0, LsAttributes, first_texcoord[1], LS_NONE)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 0, LsAttributes, first_color, LS_NONE)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 2, LsAttributes, first_color, 5)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 2, LsAttributes, first_color, LS_NONE)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 1, LsAttributes, first_color, 6)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 1, LsAttributes, first_normal, 6)}},
    {"R4.15", RULE, {WORD(ATTRIBUTES, 1, LsAttributes, first_texcoord[0], 12)}},
    {"R4.16", RULE, {INDEX(NORMALS, 0, 0x00008000)}},
    {"R4.16", RULE, {INDEX(NORMALS, 5, 0x80007FFF)}},
    {"R4.17", RULE, {WORD(TEXCOORDS, 0, LsTexcoord, u, NOT_A_NUMBER)}},
    {"R4.17", RULE, {WORD(TEXCOORDS, 11, LsTexcoord, v, INFINITE)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, kind, 3)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, node, 3)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, node, LS_NONE - 1)}},
    {"R4.18", RULE, {WORD(LAMPS, 2, LsLamp, reserved[1], 1)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, position.x, NOT_A_NUMBER)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, position.z, INFINITE)}},
    {"R4.18", RULE, {WORD(LAMPS, 2, LsLamp, position.y, SMALLEST)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, direction.z, ONE)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, direction.x, SMALLEST)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, direction.y, 0)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, direction.y, 0x3F802000u)}}, // 1 + 2^-10
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, direction.x, NOT_A_NUMBER)}},
    {"R4.18", RULE, {WORD(LAMPS, 2, LsLamp, direction.z, HALF)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, range, MINUS_ONE)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, range, INFINITE)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, intensity.y, MINUS_ONE)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, intensity.z, INFINITE)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, intensity.x, NOT_A_NUMBER)}},
    {"R4.18", RULE, {WORD(LAMPS, 0, LsLamp, cos_inner, HALF)}},
    {"R4.18", RULE, {WORD(LAMPS, 2, LsLamp, cos_outer, 0)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, cos_inner, 0)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, cos_inner, TWO)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, cos_outer, NOT_A_NUMBER)}},
    {"R4.18", RULE, {WORD(LAMPS, 1, LsLamp, cos_outer, 0xC0000000u)}}, // -2
    {"R4.19", RULE, {WORD(ANIMATIONS, 0, LsAnimation, first_channel, 1)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 1, LsAnimation, first_channel, 0)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 0, LsAnimation, channel_count, 0)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 0, LsAnimation, channel_count, 2)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 0, LsAnimation, channel_count, 4)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 1, LsAnimation, channel_count, 6)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 1, LsAnimation, channel_count, LS_NONE)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 0, LsAnimation, duration, ONE)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 0, LsAnimation, duration, NOT_A_NUMBER)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 1, LsAnimation, duration, TWO)}},
    {"R4.19", RULE, {WORD(ANIMATIONS, 1, LsAnimation, reserved, 1)}},
    {"R4.20",
     RULE,
     {WORD(CHANNELS, 3, LsChannel, node, 3), WORD(CHANNELS, 4, LsChannel, node, 3),
      WORD(CHANNELS, 5, LsChannel, node, 3)}},
    {"R4.20", RULE, {WORD(CHANNELS, 1, LsChannel, node, 1)}},
    {"R4.20", RULE, {WORD(CHANNELS, 5, LsChannel, node, 1)}},
    {"R4.20", RULE, {WORD(CHANNELS, 0, LsChannel, path, LS_PATH_SCALE)}},
    {"R4.20", RULE, {WORD(CHANNELS, 1, LsChannel, path, 3)}},
    {"R4.20", RULE, {WORD(CHANNELS, 4, LsChannel, path, LS_PATH_TRANSLATION)}},
    {"R4.20", RULE, {WORD(CHANNELS, 0, LsChannel, interpolation, 3)}},
    {"R4.20", RULE, {WORD(CHANNELS, 2, LsChannel, key_count, 0)}},
    {"R4.20", RULE, {WORD(CHANNELS, 2, LsChannel, reserved[0], 1)}},
    {"R4.20", RULE, {WORD(CHANNELS, 0, LsChannel, first_time, 1)}},
    {"R4.20", RULE, {WORD(CHANNELS, 0, LsChannel, first_value, 2)}},
    {"R4.20", RULE, {WORD(CHANNELS, 1, LsChannel, first_time, 12)}},
    {"R4.20", RULE, {WORD(CHANNELS, 1, LsChannel, first_value, 11)}},
    {"R4.20", RULE, {WORD(CHANNELS, 1, LsChannel, key_count, 2)}},
    {"R4.20", RULE, {WORD(CHANNELS, 2, LsChannel, first_time, 0)}},
    {"R4.20", RULE, {WORD(CHANNELS, 3, LsChannel, interpolation, LS_INTERPOLATION_LINEAR)}},
    {"R4.20", RULE, {WORD(CHANNELS, 4, LsChannel, first_time, 28)}},
    {"R4.20", RULE, {WORD(CHANNELS, 5, LsChannel, first_value, 54)}},
    // Behind the end, in 32 bits and beyond.
    {"R4.20",
     RULE,
     {WORD(CHANNELS, 5, LsChannel, first_time, 53), WORD(CHANNELS, 5, LsChannel, first_value, 54)}},
    {"R4.20",
     RULE,
     {WORD(CHANNELS, 5, LsChannel, first_time, 53),
      WORD(CHANNELS, 5, LsChannel, key_count, 0x40000000u),
      WORD(CHANNELS, 5, LsChannel, first_value, 0x40000035u)}},
    // The last three numbers are left over.
    {"R4.20",
     RULE,
     {WORD(ANIMATIONS, 0, LsAnimation, channel_count, 6), WORD(CHANNELS, 3, LsChannel, node, 2)}},
    {"R4.21", RULE, {INDEX(KEYS, 0, MINUS_ONE)}},
    {"R4.21", RULE, {INDEX(KEYS, 1, NOT_A_NUMBER)}},
    {"R4.21", RULE, {INDEX(KEYS, 2, INFINITE)}},
    {"R4.21", RULE, {INDEX(KEYS, 2, ONE)}}, // as the one before
    {"R4.21", RULE, {INDEX(KEYS, 1, NINE)}},
    {"R4.21", RULE, {INDEX(KEYS, 3, INFINITE)}},
    {"R4.21", RULE, {INDEX(KEYS, 11, NOT_A_NUMBER)}},
    {"R4.21", RULE, {INDEX(KEYS, 12, ONE)}},
    {"R4.21", RULE, {INDEX(KEYS, 20, 0)}},
    {"R4.21", RULE, {INDEX(KEYS, 15, NOT_A_NUMBER)}},
    {"R4.21", RULE, {INDEX(KEYS, 30, INFINITE)}},
    {"R4.21", RULE, {INDEX(KEYS, 52, ONE)}},
    {"R4.21", RULE, {INDEX(KEYS, 55, NOT_A_NUMBER)}},

    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, cells[0], 0)}},
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, cells[2], 4097)}},
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, cells[1], UINT32_MAX)}},
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, inverse_cell, 0)}},
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, inverse_cell, INFINITE)}},
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, grid_lower.z, NOT_A_NUMBER)}},
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, bound, 0)}},
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, bound, 0x3C800000u)}}, // 2^-6
    {"R5.1", RULE, {WORD(OBJECTS, 2, LsObject, bound, 0x3E800000u)}}, // 2^-2
    {"R5.1", RULE, {WORD(OBJECTS, 1, LsObject, bound, NOT_A_NUMBER)}},
    {"R5.2", RULE, {WORD(OBJECTS, 1, LsObject, cells[0], 9)}},
    {"R5.2",
     RULE,
     {WORD(OBJECTS, 1, LsObject, cells[0], 4096), WORD(OBJECTS, 1, LsObject, cells[1], 4096),
      WORD(OBJECTS, 1, LsObject, cells[2], 4096)}},
    {"R5.3", RULE, {INDEX(BLOCKS, 1, 0x11111101)}},
    {"R5.3", RULE, {INDEX(BLOCKS, 1, 0x01111111)}},
    {"R5.3", RULE, {INDEX(BLOCKS, 3, 5 << 4)}},
    {"R5.3", RULE, {INDEX(BLOCKS, 3, 0xFFFFFFF0)}},
    {"R5.3", RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[1], 0x11011111)}},
    {"R5.3", RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[0], 12 << 4)}},
    {"R5.3", RULE, {WORD(CELL_BLOCKS, 4, LsCellBlock, cells[63], 0xFFFFFFF0)}},
    {"R5.4", RULE, {INDEX(BLOCKS, 0, 1 << 4)}},
    {"R5.4", RULE, {INDEX(BLOCKS, 3, 0 << 4)}},
    {"R5.4", RULE, {INDEX(BLOCKS, 3, 2 << 4)}},
    {"R5.4", RULE, {INDEX(BLOCKS, 4, 0x11111111)}}, // its block and voxel are never reached
    {"R5.4", RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[0], 1 << 4)}},
    {"R5.4", RULE, {WORD(CELL_BLOCKS, 0, LsCellBlock, cells[1], 0 << 4)}},
    {"R5.4", RULE, {WORD(CELL_BLOCKS, 4, LsCellBlock, cells[63], 0x11111111)}},
    {"R5.5",
     RULE,
     {WORD(CELL_BLOCKS, 1, LsCellBlock, cells[0], 0x11111111),
      WORD(CELL_BLOCKS, 1, LsCellBlock, cells[2], 4 << 4)}},
    {"R5.5",
     RULE,
     {WORD(CELL_BLOCKS, 1, LsCellBlock, cells[0], 0x11111111),
      WORD(CELL_BLOCKS, 1, LsCellBlock, cells[4], 4 << 4)}},
    {"R5.5",
     RULE,
     {WORD(CELL_BLOCKS, 5, LsCellBlock, cells[0], 0x11111111),
      WORD(CELL_BLOCKS, 5, LsCellBlock, cells[16], 0 << 4)}},
    {"R5.6", RULE, {INDEX(SUBGRIDS, 0, 2)}},
    {"R5.6", RULE, {INDEX(SUBGRIDS, 2, 4)}},
    {"R5.6", RULE, {INDEX(SUBGRIDS, 2, LS_NONE)}},
    {"R5.6", RULE, {INDEX(SUBGRIDS, 2, 0)}},                        // depth 2 is not reached
    {"R5.6", RULE, {INDEX(SUBGRIDS, 1, 2), INDEX(SUBGRIDS, 2, 3)}}, // depth 3
    {"R5.6", RULE, {WORD(OBJECTS, 2, LsObject, depth, 1)}},
    {"R5.7", RULE, {WORD(VOXELS, 2, LsVoxel, table, 1)}},
    {"R5.7", RULE, {WORD(VOXELS, 2, LsVoxel, table, 5)}},
    {"R5.7", RULE, {WORD(VOXELS, 2, LsVoxel, table, LS_NONE)}},
    {"R5.7", RULE, {WORD(VOXELS, 2, LsVoxel, table, 2)}}, // twice
    {"R5.7", RULE, {WORD(VOXELS, 2, LsVoxel, table, 4)}}, // another block's
    {"R5.7", RULE, {WORD(VOXELS, 7, LsVoxel, shape, LS_VOXEL_LIST)}},

    {"R6.1", RULE, {WORD(VOXELS, 0, LsVoxel, shape, 4)}},
    {"R6.1", RULE, {WORD(VOXELS, 0, LsVoxel, shape, LS_VOXEL_LIST | 1 << 8)}},
    {"R6.1", RULE, {WORD(VOXELS, 2, LsVoxel, shape, LS_VOXEL_SUBGRID | 1 << 16)}},
    {"R6.1", RULE, {WORD(VOXELS, 5, LsVoxel, shape, LS_VOXEL_BVH | 1 << 23)}},
    {"R6.1", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x01020101)}},
    {"R6.2", RULE, {WORD(VOXELS, 0, LsVoxel, first_reference, 1)}},
    {"R6.2", RULE, {WORD(VOXELS, 2, LsVoxel, first_reference, 0)}},
    {"R6.2", RULE, {WORD(VOXELS, 0, LsVoxel, reference_count, 102)}},
    {"R6.2", RULE, {WORD(VOXELS, 0, LsVoxel, reference_count, UINT32_MAX)}},
    {"R6.2",
     RULE,
     {WORD(VOXELS, 11, LsVoxel, reference_count, 2),
      WORD(LEAF_NODES, 5, LsBvhNode, leaf, 2)}}, // one is left over
    {"R6.2", RULE, {INDEX(REFERENCES, 1, 40)}},
    {"R6.2", RULE, {INDEX(REFERENCES, 1, 0)}},        // twice
    {"R6.2", RULE, {INDEX(REFERENCES, 3, 1)}},        // falling
    {"R6.2", RULE, {INDEX(REFERENCES, 20, LS_NONE)}}, // in a BVH
    {"R6.2", RULE, {INDEX(REFERENCES, 101, 1)}},
    {"R6.3", RULE, {WORD(VOXELS, 0, LsVoxel, table, 1)}},
    {"R6.3", RULE, {WORD(VOXELS, 0, LsVoxel, reference_count, 0)}},
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00020001)}},
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00021101)}},
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00010101)}},
    {"R6.4", RULE, {WORD(VOXELS, 9, LsVoxel, shape, 0x00060101)}},
    {"R6.4", RULE, {WORD(VOXELS, 9, LsVoxel, shape, 0x00040101)}}, // 32 in 16 bits
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00051001)}}, // more words than there are
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, table, 1)}},
    {"R6.4", RULE, {WORD(VOXELS, 4, LsVoxel, table, 0)}},
    {"R6.4", RULE, {WORD(VOXELS, 10, LsVoxel, shape, 0x00020201)}}, // words are left over
    {"R6.4", RULE, {INDEX(SHAFTS, 1, 0x00080000)}},                 // bit 3 of 3
    {"R6.4", RULE, {INDEX(SHAFTS, 1, 0x10000000)}},                 // behind the 15th mask
    {"R6.4", RULE, {INDEX(SHAFTS, 69, 0x00010000)}},                // same, 16 bits wide
    {"R6.4", RULE, {INDEX(SHAFTS, 30, 0x40000000)}},                // bit 6 of 6
    {"R6.5",
     RULE,
     {WORD(VOXELS, 7, LsVoxel, reference_count, 1), WORD(VOXELS, 8, LsVoxel, first_reference, 59),
      WORD(VOXELS, 8, LsVoxel, reference_count, 3)}},
    {"R6.6", RULE, {WORD(VOXELS, 5, LsVoxel, table, 1)}},
    {"R6.6", RULE, {WORD(VOXELS, 11, LsVoxel, table, 0)}},
    {"R6.6", RULE, {WORD(LEAF_NODES, 0, LsBvhNode, escape, 7)}},
    {"R6.6", RULE, {WORD(LEAF_NODES, 0, LsBvhNode, escape, 0)}},
    {"R6.6", RULE, {WORD(LEAF_NODES, 1, LsBvhNode, leaf, 1 << 4 | 15)}},
    {"R6.6", RULE, {WORD(LEAF_NODES, 3, LsBvhNode, leaf, 15 << 4 | 14)}},
    {"R6.6", RULE, {WORD(LEAF_NODES, 4, LsBvhNode, leaf, 30 << 4 | 6)}},
    {"R6.6", RULE, {WORD(LEAF_NODES, 4, LsBvhNode, leaf, 30 << 4 | 4)}},
};

// The same for the fixture with masks of exact width.
static const Case exact_cases[] = {
    {"R2.14",
     RULE,
     {HEAD(required_features, 8, 63), HEAD(version_minor, 4, 2), HEAD(reader_minor, 4, 2)}},
    {"R2.14", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00020101)}},
    {"R2.16", RULE, {HEAD(version_minor, 4, 2)}},
    {"R2.16", RULE, {HEAD(reader_minor, 4, 2)}},
    {"R2.16", RULE, {HEAD(required_features, 8, 63)}},
    {"R6.1", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x01000101)}},
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00000001)}},
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00001101)}},
    {"R6.4", RULE, {WORD(VOXELS, 4, LsVoxel, shape, 0x00030201)}}, // 8 bits
    {"R6.4", RULE, {WORD(VOXELS, 9, LsVoxel, shape, 0x00050101)}}, // as wide as exact
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, reference_count, 0)}},
    {"R6.4", RULE, {WORD(VOXELS, 9, LsVoxel, reference_count, 33), INDEX(REFERENCES, 94, 39)}},
    {"R6.4", RULE, {WORD(VOXELS, 4, LsVoxel, table, 1)}},
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, shape, 0x00001001)}},  // more words than there are
    {"R6.4", RULE, {WORD(VOXELS, 10, LsVoxel, shape, 0x00000201)}}, // words are left over
    {"R6.4", RULE, {INDEX(SHAFTS, 1, 0x00002000)}},   // behind the 15th mask of 3 bits
    {"R6.4", RULE, {INDEX(SHAFTS, 219, 0x80000000)}}, // behind the last of 4 bits
};

// The same for the fixture with scene shafts of M = 1, 15 words in each of the two grids.
static const Case scene_cases[] = {
    {"R2.14",
     RULE,
     {HEAD(required_features, 8, 63), HEAD(version_minor, 4, 2), HEAD(reader_minor, 4, 2)}},
    {"R2.14", RULE, {HEAD(required_features, 8, 159)}}, // no masks
    {"R2.14",
     RULE,
     {WORD(OBJECTS, 1, LsObject, scene_patches, 0), WORD(OBJECTS, 2, LsObject, scene_patches, 0)}},
    {"R2.16", RULE, {HEAD(version_minor, 4, 3)}},
    {"R2.16", RULE, {HEAD(reader_minor, 4, 3)}},
    {"R2.16", RULE, {HEAD(required_features, 8, 63)}},
    {"R4.3", RULE, {WORD(OBJECTS, 0, LsObject, scene_patches, 1)}}, // a list
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, scene_patches, 33)}},
    {"R4.3", RULE, {WORD(OBJECTS, 1, LsObject, scene_patches, 0xFFFFFFFF)}},
    {"R6.4", RULE, {WORD(OBJECTS, 1, LsObject, scene_patches, 2)}}, // tables begin too early
    {"R6.4", RULE, {WORD(OBJECTS, 1, LsObject, scene_patches, 0)}}, // too late
    {"R6.4", RULE, {WORD(VOXELS, 1, LsVoxel, table, 0)}},
    {"R6.4", RULE, {WORD(OBJECTS, 2, LsObject, scene_patches, 0)}}, // words are left over
    {"R6.7", RULE, {WORD(OBJECTS, 2, LsObject, scene_patches, 2)}}, // more words than there are
};

#endif
