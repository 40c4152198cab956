// file_check.c - the rules of SPEC chapters 2 to 6 that look into chunks, and the hashes.
//
// Each chunk is passed once, in order. Partitions and "exactly one" rules become running counters:
// what must come next is known, so nothing is remembered and nothing allocated.

#include "check.h"
#include "hash.h"

LsResult ls_file_check(const LsFile* file, const char* name, LsError* error)
{
    static LsResult (*const object_steps[])(const LsCheck*, uint32_t) = {
        ls_check_triangles,
        ls_check_grid,
        ls_check_voxels,
    };
    const LsCheck check = {.file = file, .name = name, .error = error};
    LsResult result = ls_check_scene(&check);
    for (uint32_t object = 0; object < count_records(&check, LS_CHUNK_OBJECTS); ++object)
    {
        for (size_t i = 0; i < sizeof(object_steps) / sizeof(object_steps[0]); ++i)
        {
            result = result == LS_OK ? object_steps[i](&check, object) : result;
        }
    }
    result = result == LS_OK ? ls_check_lights(&check) : result;
    result = result == LS_OK ? ls_check_looks(&check) : result;
    return result == LS_OK ? ls_check_animations(&check) : result;
}

LsResult ls_file_check_chunk_hash(const LsFile* file, uint32_t chunk, const char* name,
                                  LsError* error)
{
    const LsEntry* entry = &file->entries[chunk];
    const uint64_t end =
        chunk > 0 ? entry[-1].offset + entry[-1].stored_bytes
                  : LS_HEADER_BYTES + file->header->chunk_count * (uint64_t)LS_ENTRY_BYTES;
    if (!is_zero(file->bytes + end, entry->offset - end))
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R3.7: padding before chunk %u is not zero; bake it again", name,
                            chunk);
    }
    uint8_t hash[LS_HASH_BYTES];
    ls_hash_bytes(file->bytes + entry->offset, entry->stored_bytes, hash);
    return memcmp(hash, entry->hash, sizeof(hash)) == 0
               ? LS_OK
               : ls_error_set(error, LS_MESSAGE_LSPACE_DAMAGED_CHUNK,
                              "%s: chunk %u (%.4s) is damaged (R3.8); copy or bake it again", name,
                              chunk, (const char*)entry->type);
}

LsResult ls_file_check_hashes(const LsFile* file, const char* name, LsError* error)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < file->header->chunk_count && result == LS_OK; ++i)
    {
        result = ls_file_check_chunk_hash(file, i, name, error);
    }
    return result;
}
