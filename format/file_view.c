// file_view.c - header and directory: every rule of SPEC chapters 2 and 3 that needs no chunk, then
// pointers and counts.

#include "file_layout.h"
#include "hash.h"

#include <math.h>
#include <string.h>

#if !defined(__BYTE_ORDER__) || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the bytes of a file are used as they lie: only little-endian machines"
#endif

static const LsChunkInfo chunk_infos[LS_CHUNK_COUNT] = {
#define LS_CHUNK_INFO(NAME, field, type, code) {code, #NAME, sizeof(type)},
    LS_CHUNK_LIST(LS_CHUNK_INFO)
#undef LS_CHUNK_INFO
};

LsChunkInfo ls_chunk_info(LsChunk chunk)
{
    assert((unsigned)chunk < LS_CHUNK_COUNT);
    return chunk_infos[chunk];
}

static LsResult check_identity(const void* bytes, uint64_t size, const char* name, LsError* error)
{
    const uint64_t present = size < LS_MAGIC_BYTES ? size : LS_MAGIC_BYTES;
    if (memcmp(bytes, LS_MAGIC, present) != 0)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_FOREIGN,
                            "%s: not an .lspace file (R2.1); bake one with lsbake", name);
    }
    if (size < LS_HEADER_BYTES)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_CUT,
                            "%s: cut short: %llu bytes are less than a header (R2.6); copy or bake "
                            "it again",
                            name, (unsigned long long)size);
    }
    return LS_OK;
}

static LsResult check_version(const LsHeader* header, const char* name, LsError* error)
{
    if (header->version_major == 0 && header->version_minor != 0 &&
        (header->version_minor & 0xFFFFFF) == 0)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_BYTE_ORDER,
                            "%s: written with reversed byte order (R2.2); bake it again", name);
    }
    if (header->version_major != LS_FORMAT_MAJOR)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_MAJOR,
                            "%s: format %u.%u, but only %d.x is read here (R2.2); bake it again",
                            name, header->version_major, header->version_minor, LS_FORMAT_MAJOR);
    }
    if (header->reader_minor > LS_FORMAT_MINOR)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_READER,
                            "%s: needs a reader of format %d.%u, this one is %d.%d (R2.3); update "
                            "it, or bake the file again",
                            name, LS_FORMAT_MAJOR, header->reader_minor, LS_FORMAT_MAJOR,
                            LS_FORMAT_MINOR);
    }
    const uint64_t unknown = header->required_features & ~LS_FEATURE_ALL;
    if (unknown != 0)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_FEATURE,
                            "%s: requires features 0x%llx that this reader does not know (R2.5); "
                            "update it, or bake the file again",
                            name, (unsigned long long)unknown);
    }
    return LS_OK;
}

static LsResult check_extent(const LsHeader* header, uint64_t size, const char* name,
                             LsError* error)
{
    if (header->file_bytes > LS_MAX_FILE_BYTES)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R2.6: %llu bytes, more than %llu; bake it again", name,
                            (unsigned long long)header->file_bytes, LS_MAX_FILE_BYTES);
    }
    if (size < header->file_bytes)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_CUT,
                            "%s: cut short: %llu of %llu bytes (R2.6); copy or bake it again", name,
                            (unsigned long long)size, (unsigned long long)header->file_bytes);
    }
    if (size > header->file_bytes)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R2.6: %llu bytes follow the end of the file; bake it again", name,
                            (unsigned long long)(size - header->file_bytes));
    }
    if (header->chunk_count < 1 || header->chunk_count > LS_MAX_CHUNKS ||
        header->chunk_count > (size - LS_HEADER_BYTES) / LS_ENTRY_BYTES)
    {
        return ls_error_set(
            error, LS_MESSAGE_LSPACE_RULE,
            "%s: R2.4: %u chunks, legal are 1 to %d that the file has room for; bake it again",
            name, header->chunk_count, LS_MAX_CHUNKS);
    }
    if (header->directory_offset != LS_HEADER_BYTES)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R2.7: directory at %llu, legal is %d; bake it again", name,
                            (unsigned long long)header->directory_offset, LS_HEADER_BYTES);
    }
    return LS_OK;
}

static LsResult check_values(const LsHeader* header, const char* name, LsError* error)
{
    for (int axis = 0; axis < 3; ++axis)
    {
        if (!(isfinite(header->lower[axis]) && isfinite(header->upper[axis]) &&
              header->lower[axis] <= header->upper[axis]))
        {
            return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                                "%s: R2.9: world bounds [%g, %g] along axis %d; bake it again",
                                name, (double)header->lower[axis], (double)header->upper[axis],
                                axis);
        }
    }
    if (!(isfinite(header->transform_bound) && header->transform_bound >= 0))
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R2.10: transform bound %g; bake it again", name,
                            (double)header->transform_bound);
    }
    if (header->depth > LS_MAX_DEPTH)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R2.11: depth %u, at most %d is legal; bake it again", name,
                            header->depth, LS_MAX_DEPTH);
    }
    for (size_t i = 0; i < sizeof(header->reserved); ++i)
    {
        if (header->reserved[i] != 0)
        {
            return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                                "%s: R2.12: reserved byte %zu is not zero; bake it again", name, i);
        }
    }
    return LS_OK;
}

// Which chunk an entry describes; LS_CHUNK_COUNT when unknown.
static LsChunk find_chunk(const LsEntry* entry)
{
    int chunk = 0;
    while (chunk < LS_CHUNK_COUNT && memcmp(entry->type, chunk_infos[chunk].code, 4) != 0)
    {
        ++chunk;
    }
    return (LsChunk)chunk;
}

// Checks entry `index`; *last is the last known chunk before it, *end where the bytes before it
// end.
static LsResult check_entry(LsFile* file, uint32_t index, int* last, uint64_t* end,
                            const char* name, LsError* error)
{
    const LsEntry* entry = &file->entries[index];
    const LsChunk chunk = find_chunk(entry);
    const bool known = chunk < LS_CHUNK_COUNT;
    if (known && (int)chunk <= *last)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R3.1: entry %u: %s stands twice or out of order; bake it again",
                            name, index, chunk_infos[chunk].name);
    }
    if ((entry->flags & ~LS_ENTRY_REQUIRED) != 0 || (known && entry->flags != chunk_flags(chunk)))
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R3.2: entry %u: flags 0x%x; bake it again", name, index,
                            entry->flags);
    }
    if (!known && (entry->flags & LS_ENTRY_REQUIRED) != 0)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_CHUNK,
                            "%s: requires chunk %u of type %02x %02x %02x %02x, which this reader "
                            "does not know (R3.2); update it, or bake the file again",
                            name, index, entry->type[0], entry->type[1], entry->type[2],
                            entry->type[3]);
    }
    if (known ? entry->stride != chunk_infos[chunk].stride : entry->stride < 1)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R3.3: entry %u: stride %u; bake it again", name, index,
                            entry->stride);
    }
    if (entry->element_count < 1 || entry->element_count > UINT64_MAX / entry->stride ||
        entry->logical_bytes != entry->element_count * entry->stride ||
        entry->stored_bytes != entry->logical_bytes || (known && entry->element_count > UINT32_MAX))
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R3.4: entry %u: %llu records of %u bytes, but %llu bytes (%llu "
                            "stored); bake it again",
                            name, index, (unsigned long long)entry->element_count, entry->stride,
                            (unsigned long long)entry->logical_bytes,
                            (unsigned long long)entry->stored_bytes);
    }
    if (entry->codec != 0)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R3.5: entry %u: codec %u; bake it again", name, index,
                            entry->codec);
    }
    const uint64_t offset = place_chunk(*end, entry->stored_bytes);
    if (entry->offset != offset || offset > file->size || entry->stored_bytes > file->size - offset)
    {
        return ls_error_set(
            error, LS_MESSAGE_LSPACE_RULE,
            "%s: R3.6: entry %u: %llu bytes at %llu, its place is %llu in %llu; bake it again",
            name, index, (unsigned long long)entry->stored_bytes, (unsigned long long)entry->offset,
            (unsigned long long)offset, (unsigned long long)file->size);
    }
    *end = offset + entry->stored_bytes;
    if (known)
    {
        *last = (int)chunk;
        file->chunk_entries[chunk] = entry;
    }
    return LS_OK;
}

static LsResult check_directory(LsFile* file, const char* name, LsError* error)
{
    const LsHeader* header = file->header;
    int last = -1;
    uint64_t end = LS_HEADER_BYTES + header->chunk_count * (uint64_t)LS_ENTRY_BYTES;
    for (uint32_t i = 0; i < header->chunk_count; ++i)
    {
        LsResult result = check_entry(file, i, &last, &end, name, error);
        if (result != LS_OK)
        {
            return result;
        }
    }
    if (end != file->size)
    {
        return ls_error_set(
            error, LS_MESSAGE_LSPACE_RULE,
            "%s: R3.6: the last chunk ends at %llu, the file at %llu; bake it again", name,
            (unsigned long long)end, (unsigned long long)file->size);
    }
    uint32_t counts[LS_CHUNK_COUNT] = {0};
    for (int i = 0; i < LS_CHUNK_COUNT; ++i)
    {
        const LsEntry* entry = file->chunk_entries[i];
        counts[i] = entry != NULL ? (uint32_t)entry->element_count : 0;
        if (i < LS_HEADER_COUNTS && header->counts[i] != counts[i])
        {
            return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                                "%s: R2.8: the header counts %u records of chunk type %d (%s), the "
                                "directory %u; bake it again",
                                name, header->counts[i], i, chunk_infos[i].name, counts[i]);
        }
    }
    const uint32_t minor = derive_minor(counts, header->required_features);
    const uint32_t reader_minor = derive_reader_minor(counts, header->required_features);
    if (header->version_minor <= LS_FORMAT_MINOR &&
        (header->version_minor != minor || header->reader_minor != reader_minor))
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE,
                            "%s: R2.16: format 0.%u for readers from 0.%u on, its parts say 0.%u "
                            "and 0.%u; bake it again",
                            name, header->version_minor, header->reader_minor, minor, reader_minor);
    }
    const uint64_t optional = derive_optional_features(counts);
    if ((header->optional_features & LS_FEATURE_OPTIONAL_ALL) != optional)
    {
        return ls_error_set(
            error, LS_MESSAGE_LSPACE_RULE,
            "%s: R2.15: optional features 0x%llx, the chunks say 0x%llx; bake it again", name,
            (unsigned long long)header->optional_features, (unsigned long long)optional);
    }
    return LS_OK;
}

static const void* chunk_bytes(const LsFile* file, LsChunk chunk)
{
    const LsEntry* entry = file->chunk_entries[chunk];
    return entry != NULL ? file->bytes + entry->offset : NULL;
}

static LsResult open_view(LsFile* file, const char* name, LsError* error)
{
    LsResult result = check_identity(file->bytes, file->size, name, error);
    if (result != LS_OK)
    {
        return result;
    }
    const LsHeader* header = (const LsHeader*)(const void*)file->bytes;
    file->header = header;
    if ((result = check_version(header, name, error)) != LS_OK ||
        (result = check_extent(header, file->size, name, error)) != LS_OK)
    {
        return result;
    }
    file->entries = (const LsEntry*)(const void*)(file->bytes + LS_HEADER_BYTES);
    uint8_t hash[LS_HASH_BYTES];
    ls_hash_header(header, file->entries, hash);
    if (memcmp(hash, header->hash, sizeof(hash)) != 0)
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_DAMAGED_HEAD,
                            "%s: header or directory is damaged (R2.13); copy or bake it again",
                            name);
    }
    if ((result = check_values(header, name, error)) != LS_OK)
    {
        return result;
    }
    return check_directory(file, name, error);
}

LsResult ls_file_open(LsFile* file, const void* bytes, uint64_t size, const char* name,
                      LsError* error)
{
    assert((uintptr_t)bytes % 64 == 0);
    *file = (LsFile){.bytes = bytes, .size = size};
    const LsResult result = open_view(file, name, error);
    if (result != LS_OK)
    {
        *file = (LsFile){0};
        return result;
    }
#define LS_CHUNK_FIELD(NAME, field, type, code) file->field = chunk_bytes(file, LS_CHUNK_##NAME);
    LS_CHUNK_LIST(LS_CHUNK_FIELD)
#undef LS_CHUNK_FIELD
    return LS_OK;
}
