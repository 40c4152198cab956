// file_write.c - one .lspace file from arrays, and atomic replacement of files in general.

#define _XOPEN_SOURCE 700 // realpath

#include "file_layout.h"
#include "hash.h"
#include "ls_write.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- Atomic output ------------------------------------------------------------------------------

// A file on its way to `path`, written under a temporary name beside it.
typedef struct Output
{
    const char* name; // as the caller gave it, for messages
    int descriptor;
    char path[PATH_MAX]; // links followed
    char directory[PATH_MAX];
    char temporary[PATH_MAX + 64];
} Output;

static LsResult report_output(const Output* output, int reason, LsError* error)
{
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG)
    {
        return ls_error_set(error, LS_MESSAGE_OUTPUT_FULL,
                            "%s: no space left for the output (%s); make room or write elsewhere",
                            output->name, strerror(reason));
    }
    return ls_error_set(error, LS_MESSAGE_OUTPUT_UNWRITABLE,
                        "%s: cannot be written: %s; choose another place", output->name,
                        strerror(reason));
}

// Closes and removes the temporary file.
static void abandon_output(Output* output)
{
    close(output->descriptor);
    unlink(output->temporary);
}

// Follows links, so that a link stays one, and finds the directory.
static LsResult find_place(Output* output, LsError* error)
{
    struct stat status;
    if (stat(output->name, &status) == 0)
    {
        if (S_ISDIR(status.st_mode))
        {
            return ls_error_set(error, LS_MESSAGE_OUTPUT_IS_FOLDER,
                                "%s: is a directory; name a file in it", output->name);
        }
        if (!S_ISREG(status.st_mode))
        {
            return ls_error_set(error, LS_MESSAGE_OUTPUT_NOT_REGULAR,
                                "%s: is no regular file and is not replaced; choose another name",
                                output->name);
        }
        if (realpath(output->name, output->path) == NULL)
        {
            return report_output(output, errno, error);
        }
    }
    else
    {
        const int length = snprintf(output->path, sizeof(output->path), "%s", output->name);
        if (length == 0 || length >= (int)sizeof(output->path))
        {
            return report_output(output, length == 0 ? ENOENT : ENAMETOOLONG, error);
        }
    }
    const char* slash = strrchr(output->path, '/');
    if (slash != NULL && slash[1] == '\0')
    {
        return ls_error_set(error, LS_MESSAGE_OUTPUT_IS_FOLDER,
                            "%s: names a directory; name a file in it", output->name);
    }
    if (slash == NULL)
    {
        strcpy(output->directory, ".");
    }
    else
    {
        const size_t length = slash == output->path ? 1 : (size_t)(slash - output->path);
        memcpy(output->directory, output->path, length);
        output->directory[length] = '\0';
    }
    return LS_OK;
}

LsResult ls_output_check(const char* path, LsError* error)
{
    Output output = {.name = path};
    const LsResult result = find_place(&output, error);
    if (result != LS_OK)
    {
        return result;
    }
    struct stat status;
    if (stat(output.directory, &status) != 0 || !S_ISDIR(status.st_mode) ||
        access(output.directory, W_OK | X_OK) != 0)
    {
        return ls_error_set(error, LS_MESSAGE_OUTPUT_UNWRITABLE,
                            "%s: cannot be written; make the folder %s and allow writing to it",
                            path, output.directory);
    }
    return LS_OK;
}

// Opens the temporary file and sets room of `size` zero bytes aside in it.
static LsResult open_output(Output* output, const char* path, uint64_t size, LsError* error)
{
    output->name = path;
    LsResult result = find_place(output, error);
    if (result != LS_OK)
    {
        return result;
    }
    for (unsigned attempt = 0;; ++attempt)
    {
        snprintf(output->temporary, sizeof(output->temporary), "%s/.lspace-%ld-%u.tmp",
                 output->directory, (long)getpid(), attempt);
        output->descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (output->descriptor >= 0)
        {
            break;
        }
        if (errno != EEXIST || attempt == 1000)
        {
            return report_output(output, errno, error);
        }
    }
    // Not every file system can set room aside; there the writes themselves report a full disk.
    const int reason = size > 0 ? posix_fallocate(output->descriptor, 0, (off_t)size) : 0;
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG)
    {
        abandon_output(output);
        return report_output(output, reason, error);
    }
    if (ftruncate(output->descriptor, (off_t)size) != 0)
    {
        const int cause = errno;
        abandon_output(output);
        return report_output(output, cause, error);
    }
    return LS_OK;
}

// Returns 0, or the errno.
static int put_bytes(Output* output, const void* bytes, uint64_t size, uint64_t offset)
{
    const uint64_t block = 1u << 30;
    uint64_t done = 0;
    while (done < size)
    {
        const uint64_t left = size - done;
        const ssize_t put = pwrite(output->descriptor, (const char*)bytes + done,
                                   left < block ? left : block, (off_t)(offset + done));
        if (put < 0 && errno != EINTR)
        {
            return errno;
        }
        done += put > 0 ? (uint64_t)put : 0;
    }
    return 0;
}

// Returns 0, or the errno. The old file stays in place until all of the new one is on disk.
static int commit_output(Output* output)
{
    if (fsync(output->descriptor) != 0 || rename(output->temporary, output->path) != 0)
    {
        return errno;
    }
    close(output->descriptor);
    // The file is whole and in place; a directory that cannot be synchronised does not change that.
    const int directory = open(output->directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0)
    {
        fsync(directory);
        close(directory);
    }
    return 0;
}

LsResult ls_bytes_write(const void* bytes, uint64_t size, const char* path, LsError* error)
{
    Output output;
    LsResult result = open_output(&output, path, size, error);
    if (result != LS_OK)
    {
        return result;
    }
    int reason = put_bytes(&output, bytes, size, 0);
    reason = reason != 0 ? reason : commit_output(&output);
    if (reason != 0)
    {
        abandon_output(&output);
        return report_output(&output, reason, error);
    }
    return LS_OK;
}

// ---- The .lspace file ---------------------------------------------------------------------------

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

    header->version_minor = derive_minor(plan->counts);
    header->reader_minor = derive_reader_minor(plan->counts);

    uint64_t end = LS_HEADER_BYTES + header->chunk_count * (uint64_t)LS_ENTRY_BYTES;
    for (uint32_t i = 0; i < header->chunk_count; ++i)
    {
        plan->entries[i].offset = place_chunk(end, plan->entries[i].stored_bytes);
        end = plan->entries[i].offset + plan->entries[i].stored_bytes;
    }
    header->file_bytes = end;

    header->required_features =
        derive_required_features(desc->objects, desc->instances, plan->counts);
    header->optional_features = derive_optional_features(plan->counts);
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

// Returns 0, or the errno. The magic comes last, so that no unfinished file passes for a whole one.
static int put_file(Output* output, const Plan* plan)
{
    int reason = 0;
    for (uint32_t i = 0; i < plan->header.chunk_count && reason == 0; ++i)
    {
        const LsEntry* entry = &plan->entries[i];
        reason = put_bytes(output, plan->arrays[i], entry->stored_bytes, entry->offset);
    }
    if (reason == 0)
    {
        reason = put_bytes(output, plan->entries, plan->header.chunk_count * sizeof(LsEntry),
                           LS_HEADER_BYTES);
    }
    if (reason == 0)
    {
        reason = put_bytes(output, (const uint8_t*)&plan->header + LS_MAGIC_BYTES,
                           LS_HEADER_BYTES - LS_MAGIC_BYTES, LS_MAGIC_BYTES);
    }
    if (reason == 0 && fsync(output->descriptor) != 0)
    {
        reason = errno;
    }
    if (reason == 0)
    {
        reason = put_bytes(output, plan->header.magic, LS_MAGIC_BYTES, 0);
    }
    return reason;
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
    Output output;
    LsResult result = open_output(&output, path, plan.header.file_bytes, error);
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

    int reason = put_file(&output, &plan);
    reason = reason != 0 ? reason : commit_output(&output);
    if (reason != 0)
    {
        abandon_output(&output);
        return report_output(&output, reason, error);
    }
    return LS_OK;
}
