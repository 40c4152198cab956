// ls_format.h - the read side of .lspace files: map, open, check, view.
//
// A file is mapped (or read into memory by the caller), its header and directory are checked by
// ls_file_open, its contents by ls_file_check, and then it is plain arrays. Nothing here allocates;
// a view borrows the bytes it was opened on, which must stay in place and unchanged while it is
// used.
//
// What it does not do: write files (ls_write.h), repair them, convert byte orders, read older
// majors. format/SPEC.md is the norm; rule ids in messages ("R3.4") are its numbers.

#ifndef LS_FORMAT_H
#define LS_FORMAT_H

#include "ls_base.h"
#include "ls_layout.h"
#include "ls_messages.h"

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C"
{
#endif

#define LS_FORMAT_MAJOR 0
#define LS_FORMAT_MINOR 4

#define LS_MAGIC_BYTES 16
#define LS_HEADER_BYTES 256
#define LS_ENTRY_BYTES 64
#define LS_CHUNK_ALIGNMENT 4096
#define LS_LARGE_CHUNK_BYTES \
    (16u << 20) // chunks this large are aligned to LS_LARGE_CHUNK_ALIGNMENT
#define LS_LARGE_CHUNK_ALIGNMENT 65536
#define LS_MAX_CHUNKS 4096
#define LS_HEADER_COUNTS 16 // chunk types counted in the header; later ones in the directory alone
#define LS_MAX_FILE_BYTES (1ull << 36) // default cap: 64 GiB

// The chunk types in the order in which they lie in a file: NAME, view field, record, four
// characters.
#define LS_CHUNK_LIST(X)                             \
    X(OBJECTS, objects, LsObject, "OBJT")            \
    X(INSTANCES, instances, LsInstance, "INST")      \
    X(TOP_NODES, top_nodes, LsBvhNode, "TOPN")       \
    X(NODES, nodes, LsSceneNode, "NODE")             \
    X(MATERIALS, materials, LsMaterial, "MATL")      \
    X(LIGHTS, lights, LsLight, "LGHT")               \
    X(CAMERAS, cameras, LsCamera, "CAMR")            \
    X(TRIANGLES, triangles, LsTriangle, "TRIA")      \
    X(BLOCKS, blocks, uint32_t, "BLOC")              \
    X(CELL_BLOCKS, cell_blocks, LsCellBlock, "CELL") \
    X(SUBGRIDS, subgrids, uint32_t, "SUBG")          \
    X(VOXELS, voxels, LsVoxel, "VOXL")               \
    X(REFERENCES, references, uint32_t, "REFS")      \
    X(LEAF_NODES, leaf_nodes, LsBvhNode, "LEAF")     \
    X(SHAFTS, shafts, uint32_t, "SHFT")              \
    X(SURFACES, surfaces, LsSurface, "SURF")         \
    X(TEXTURES, textures, LsTexture, "TEXR")         \
    X(IMAGES, images, LsImage, "IMAG")               \
    X(PIXELS, pixels, uint32_t, "PIXL")              \
    X(ATTRIBUTES, attributes, LsAttributes, "ATTR")  \
    X(NORMALS, normals, uint32_t, "NORM")            \
    X(TEXCOORDS, texcoords, LsTexcoord, "TEXC")      \
    X(COLORS, colors, LsCornerColor, "COLR")         \
    X(LAMPS, lamps, LsLamp, "LAMP")                  \
    X(ANIMATIONS, animations, LsAnimation, "ANIM")   \
    X(CHANNELS, channels, LsChannel, "CHAN")         \
    X(KEYS, keys, float, "KEYS")

    typedef enum LsChunk
    {
#define LS_CHUNK_ENUMERATOR(NAME, field, type, code) LS_CHUNK_##NAME,
        LS_CHUNK_LIST(LS_CHUNK_ENUMERATOR)
#undef LS_CHUNK_ENUMERATOR
            LS_CHUNK_COUNT
    } LsChunk;

// Required features: a reader that does not know a set bit refuses the file. A bit is set if and
// only if the file uses the feature, so the runtime compiles only what a scene needs.
#define LS_FEATURE_TOP_LEVEL 1ull      // several objects or instances, or one not the identity
#define LS_FEATURE_LISTS 2ull          // objects without a grid
#define LS_FEATURE_GRIDS 4ull          // objects with a grid
#define LS_FEATURE_SUBGRIDS 8ull       // subdivided voxels
#define LS_FEATURE_LEAF_BVHS 16ull     // voxels that are BVH leaves
#define LS_FEATURE_MASKS 32ull         // shaft tables of masks
#define LS_FEATURE_EXACT_MASKS 64ull   // all masks take as many bits as their voxel has triangles
#define LS_FEATURE_SCENE_SHAFTS 128ull // grids with shafts across the whole of them
#define LS_FEATURE_COUNT 8
#define LS_FEATURE_ALL ((1ull << LS_FEATURE_COUNT) - 1)

// Optional features: what is here beyond the geometry. Unknown bits are ignored.
#define LS_FEATURE_LIGHTS 1ull
#define LS_FEATURE_CAMERAS 2ull
#define LS_FEATURE_NODES 4ull
#define LS_FEATURE_SURFACES 8ull    // materials with more than LsMaterial
#define LS_FEATURE_ATTRIBUTES 16ull // normals, texture coordinates or colours at corners
#define LS_FEATURE_LAMPS 32ull
#define LS_FEATURE_ANIMATIONS 64ull
#define LS_FEATURE_OPTIONAL_ALL 127ull

    // Stored. The first 256 bytes of a file.
    typedef struct LsHeader
    {
        uint8_t magic[LS_MAGIC_BYTES];
        uint32_t version_major; // bytes changed: other majors are refused
        uint32_t
            version_minor; // optional things were added: the smallest minor that has all of the file
        uint32_t reader_minor; // the smallest minor whose readers may read this file
        uint32_t chunk_count;
        uint64_t required_features;
        uint64_t optional_features;
        uint64_t file_bytes;
        uint64_t directory_offset; // LS_HEADER_BYTES
        uint32_t
            counts[LS_HEADER_COUNTS]; // records of the first chunk types, in the order of LsChunk
        float lower[3];               // world bounds of all instances
        float upper[3];
        float transform_bound; // see LsDeviceScene
        uint32_t depth;        // deepest sub-grid level of any object
        uint8_t source_hash
            [16]; // of input and options, for "is this bake current?"; no part of validity
        uint8_t reserved[64]; // 0
        uint8_t
            hash[16]; // XXH3-128, big-endian (canonical), of header (this field 0) and directory
    } LsHeader;
    static_assert(sizeof(LsHeader) == LS_HEADER_BYTES, "the header is 256 bytes");

#define LS_ENTRY_REQUIRED 1u // a reader that does not know the type refuses the file

    // Stored. One per chunk, right after the header, sorted by offset.
    typedef struct LsEntry
    {
        uint8_t type[4];
        uint32_t flags;  // LS_ENTRY_*
        uint64_t offset; // from file start
        uint64_t stored_bytes;
        uint64_t logical_bytes; // equal: codec 0 is the only one
        uint64_t element_count;
        uint32_t stride;  // bytes per record, fixed by type
        uint32_t codec;   // 0: as it lies
        uint8_t hash[16]; // XXH3-128, canonical, of the stored bytes
    } LsEntry;
    static_assert(sizeof(LsEntry) == LS_ENTRY_BYTES, "a directory entry is 64 bytes");

    // A read-only file in memory. Zeroed when closed.
    typedef struct LsMapping
    {
        const void* bytes; // page-aligned
        uint64_t size;
    } LsMapping;

    // Maps a file read-only. Pages are brought in here, so that a file cut short meanwhile fails
    // this call rather than a later access. Errors: FILE_MISSING, FILE_READ, FILE_EMPTY,
    // FILE_IS_DIRECTORY.
    LsResult ls_mapping_open(LsMapping* mapping, const char* path, LsError* error);
    void ls_mapping_close(LsMapping* mapping);

    // Whether two paths lead to the same file, by whatever names and links; false if either is
    // missing. For programs that must not write over what they read.
    bool ls_path_is_same(const char* a, const char* b);

    // An opened file: pointers into the borrowed bytes, one array per chunk type; absent chunks are
    // NULL with count 0 (ls_file_count).
    typedef struct LsFile
    {
        const uint8_t* bytes;
        uint64_t size;
        const LsHeader* header;
        const LsEntry* entries;                       // header->chunk_count
        const LsEntry* chunk_entries[LS_CHUNK_COUNT]; // NULL when absent
#define LS_CHUNK_FIELD(NAME, field, type, code) const type* field;
        LS_CHUNK_LIST(LS_CHUNK_FIELD)
#undef LS_CHUNK_FIELD
    } LsFile;

    // Static facts of a chunk type.
    typedef struct LsChunkInfo
    {
        const char* code; // four characters
        const char* name; // "TRIANGLES"
        uint32_t stride;
    } LsChunkInfo;
    LsChunkInfo ls_chunk_info(LsChunk chunk);

    // Opens `size` bytes at `bytes` (alignment at least 64): checks everything of header and
    // directory, their hash included (SPEC chapters 2 and 3), but nothing inside chunks. `name` is
    // used in messages only. Errors: NOT_LSPACE, BYTE_ORDER, VERSION, FEATURE, TRUNCATED, HASH,
    // RULE.
    LsResult ls_file_open(LsFile* file, const void* bytes, uint64_t size, const char* name,
                          LsError* error);

    // Records in a chunk.
    static inline uint32_t ls_file_count(const LsFile* file, LsChunk chunk)
    {
        if (chunk < LS_HEADER_COUNTS)
        {
            return file->header->counts[chunk];
        }
        const LsEntry* entry = file->chunk_entries[chunk];
        return entry != NULL ? (uint32_t)entry->element_count : 0;
    }

    // Bits of a mask of a voxel of kind MASKS, 1..32.
    static inline uint32_t ls_mask_width(const LsVoxel* voxel)
    {
        const uint32_t log2_width = voxel->shape >> 16 & 255;
        return log2_width == 0 ? voxel->reference_count : 1u << log2_width;
    }

// Shafts between the patches of six faces of N x N: 15 N^4, of the type of `patches`.
#define LS_SHAFT_COUNT(patches) (15u * (patches) * (patches) * (patches) * (patches))

    // Words of a table of `shaft_count` masks of `width` bits.
    static inline uint64_t ls_mask_words(uint64_t shaft_count, uint32_t width)
    {
        return (shaft_count * width + 31) / 32;
    }

    // The mask of a shaft, of a voxel's table of masks of `width` bits.
    static inline uint32_t ls_mask_read(const uint32_t* table, uint64_t shaft, uint32_t width)
    {
        const uint64_t bit = shaft * width;
        const uint32_t* word = table + bit / 32;
        const uint32_t shift = (uint32_t)(bit % 32);
        const uint64_t next = shift + width > 32 ? word[1] : 0;
        return (uint32_t)((next << 32 | *word) >> shift) & UINT32_MAX >> (32 - width);
    }

    // Checks the contents of every chunk in one linear pass (SPEC chapters 4 to 6), after which
    // every index in the file may be followed without a check. Stops at the first broken rule and
    // names it, with the record, in `error`. Errors: RULE.
    LsResult ls_file_check(const LsFile* file, const char* name, LsError* error);

    // Verifies the hash of every chunk and that all padding is zero. Errors: HASH, RULE.
    LsResult ls_file_check_hashes(const LsFile* file, const char* name, LsError* error);

    // The same of one chunk, by its place in the directory, and the padding before it: for callers with
    // several threads.
    LsResult ls_file_check_chunk_hash(const LsFile* file, uint32_t chunk, const char* name,
                                      LsError* error);

#ifdef __cplusplus
}
#endif

#endif
