// file_write.c - one .lspace file from arrays.

#include "file_layout.h"
#include "hash.h"
#include "ls_write.h"

#include <math.h>
#include <string.h>

// Header and directory as they are written; `arrays` in the order of the directory.
typedef struct Plan
{
    LsHeader header;
    LsEntry entries[LS_CHUNK_COUNT];
    uint32_t counts[LS_CHUNK_COUNT]; // by chunk type
    const void* arrays[LS_CHUNK_COUNT];
} Plan;

static void add_chunk(Plan* plan, LsChunk chunk, const void* array, uint32_t count)
{
    if (count == 0)
    {
        return;
    }
    assert(array != NULL);
    const LsChunkInfo info = ls_chunk_info(chunk);
    plan->counts[chunk] = count;
    if (chunk < LS_HEADER_COUNTS)
    {
        plan->header.counts[chunk] = count;
    }
    LsEntry* entry = &plan->entries[plan->header.chunk_count];
    plan->arrays[plan->header.chunk_count++] = array;
    memcpy(entry->type, info.code, sizeof(entry->type));
    entry->flags = chunk_flags(chunk);
    entry->stored_bytes = count * (uint64_t)info.stride;
    entry->logical_bytes = entry->stored_bytes;
    entry->element_count = count;
    entry->stride = info.stride;
}

// Everything but the hashes.
static void make_plan(Plan* plan, const LsFileDesc* desc)
{
    *plan = (Plan){0};
    LsHeader* header = &plan->header;
    memcpy(header->magic, LS_MAGIC, sizeof(header->magic));
    header->version_major = LS_FORMAT_MAJOR;
    header->directory_offset = LS_HEADER_BYTES;
#define LS_CHUNK_ADD(NAME, field, type, code) \
    add_chunk(plan, LS_CHUNK_##NAME, desc->field, desc->NAME##_count);
    LS_CHUNK_LIST(LS_CHUNK_ADD)
#undef LS_CHUNK_ADD

    uint64_t end = LS_HEADER_BYTES + header->chunk_count * (uint64_t)LS_ENTRY_BYTES;
    for (uint32_t i = 0; i < header->chunk_count; ++i)
    {
        plan->entries[i].offset = place_chunk(end, plan->entries[i].stored_bytes);
        end = plan->entries[i].offset + plan->entries[i].stored_bytes;
    }
    header->file_bytes = end;

    header->required_features =
        derive_required_features(desc->objects, desc->instances, desc->voxels, plan->counts);
    header->optional_features = derive_optional_features(plan->counts);
    header->version_minor = derive_minor(plan->counts, header->required_features);
    header->reader_minor = derive_reader_minor(plan->counts, header->required_features);
    memcpy(header->lower, desc->lower, sizeof(header->lower));
    memcpy(header->upper, desc->upper, sizeof(header->upper));
    header->transform_bound = desc->transform_bound;
    for (uint32_t i = 0; i < desc->OBJECTS_count; ++i)
    {
        const uint32_t depth = desc->objects[i].depth;
        header->depth = depth > header->depth ? depth : header->depth;
    }
    memcpy(header->source_hash, desc->source_hash, sizeof(header->source_hash));
}

LsFileDesc ls_file_desc(const LsFile* file)
{
    LsFileDesc desc = {.transform_bound = file->header->transform_bound};
#define LS_CHUNK_COPY(NAME, field, type, code) \
    desc.field = file->field;                  \
    desc.NAME##_count = ls_file_count(file, LS_CHUNK_##NAME);
    LS_CHUNK_LIST(LS_CHUNK_COPY)
#undef LS_CHUNK_COPY
    memcpy(desc.lower, file->header->lower, sizeof(desc.lower));
    memcpy(desc.upper, file->header->upper, sizeof(desc.upper));
    memcpy(desc.source_hash, file->header->source_hash, sizeof(desc.source_hash));
    return desc;
}

uint64_t ls_file_desc_bytes(const LsFileDesc* desc)
{
    Plan plan;
    make_plan(&plan, desc);
    return plan.header.file_bytes;
}

LsResult ls_file_desc_check(const LsFileDesc* desc, const char* name, LsError* error)
{
    Plan plan;
    make_plan(&plan, desc);
    const LsHeader* header = &plan.header;
    for (int axis = 0; axis < 3; ++axis)
    {
        if (!(isfinite(header->lower[axis]) && header->lower[axis] <= header->upper[axis] &&
              isfinite(header->upper[axis])))
        {
            return ls_error_set(error, LS_MESSAGE_LSPACE_RULE, "%s: R2.9: world bounds not finite",
                                name);
        }
    }
    if (!(isfinite(header->transform_bound) && header->transform_bound >= 0))
    {
        return ls_error_set(error, LS_MESSAGE_LSPACE_RULE, "%s: R2.10: transform bound not finite",
                            name);
    }
    // Entries of absent chunks count no records; the others stand in the order of the chunks.
    LsFile file = {.header = header, .entries = plan.entries};
    const LsEntry* entry = plan.entries;
    for (int chunk = 0; chunk < LS_CHUNK_COUNT; ++chunk)
    {
        file.chunk_entries[chunk] = plan.counts[chunk] > 0 ? entry++ : NULL;
    }
#define LS_CHUNK_SET(NAME, field, type, code) file.field = desc->field;
    LS_CHUNK_LIST(LS_CHUNK_SET)
#undef LS_CHUNK_SET
    return ls_file_check(&file, name, error);
}

// The magic comes last, so that no unfinished file passes for a whole one.
static LsResult put_file(LsOutput* output, const Plan* plan, LsError* error)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < plan->header.chunk_count && result == LS_OK; ++i)
    {
        const LsEntry* entry = &plan->entries[i];
        result = ls_output_put(output, plan->arrays[i], entry->stored_bytes, entry->offset, error);
    }
    if (result == LS_OK)
    {
        result = ls_output_put(output, plan->entries, plan->header.chunk_count * sizeof(LsEntry),
                               LS_HEADER_BYTES, error);
    }
    if (result == LS_OK)
    {
        result = ls_output_put(output, (const uint8_t*)&plan->header + LS_MAGIC_BYTES,
                               LS_HEADER_BYTES - LS_MAGIC_BYTES, LS_MAGIC_BYTES, error);
    }
    result = result == LS_OK ? ls_output_sync(output, error) : result;
    return result == LS_OK ? ls_output_put(output, plan->header.magic, LS_MAGIC_BYTES, 0, error)
                           : result;
}

LsResult ls_file_write(const LsFileDesc* desc, const char* path, LsError* error)
{
    Plan plan;
    make_plan(&plan, desc);
    if (plan.header.file_bytes > LS_MAX_FILE_BYTES)
    {
        return ls_error_set(
            error, LS_MESSAGE_LIMIT_FILE_BYTES,
            "%s: would take %llu bytes, more than %llu; use a coarser grid or fewer "
            "patches",
            path, (unsigned long long)plan.header.file_bytes, LS_MAX_FILE_BYTES);
    }
    // Room first: a full disk should not cost the time of hashing.
    LsOutput output;
    LsResult result = ls_output_open(&output, path, plan.header.file_bytes, error);
    if (result != LS_OK)
    {
        return result;
    }
    for (uint32_t i = 0; i < plan.header.chunk_count; ++i)
    {
        LsEntry* entry = &plan.entries[i];
        ls_hash_bytes(plan.arrays[i], entry->stored_bytes, entry->hash);
    }
    ls_hash_header(&plan.header, plan.entries, plan.header.hash);

    result = put_file(&output, &plan, error);
    if (result != LS_OK)
    {
        ls_output_drop(&output);
        return result;
    }
    return ls_output_commit(&output, error);
}
