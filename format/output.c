// output.c - files that appear whole or not at all.

#define _XOPEN_SOURCE 700 // realpath

#include "ls_messages.h"
#include "ls_output.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// realpath fills as much.
static_assert(LS_OUTPUT_PATH >= PATH_MAX, "a path of the system must fit");

LsResult ls_output_report(const char* name, int reason, LsError* error)
{
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG)
    {
        return ls_error_set(error, LS_MESSAGE_OUTPUT_FULL,
                            "%s: no space left for the output (%s); make room or write elsewhere",
                            name, strerror(reason));
    }
    return ls_error_set(error, LS_MESSAGE_OUTPUT_UNWRITABLE,
                        "%s: cannot be written: %s; choose another place", name, strerror(reason));
}

// Follows links, so that a link stays one, and finds the directory.
static LsResult find_place(LsOutput* output, LsError* error)
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
            return ls_output_report(output->name, errno, error);
        }
    }
    else
    {
        const int length = snprintf(output->path, sizeof(output->path), "%s", output->name);
        if (length == 0 || length >= (int)sizeof(output->path))
        {
            return ls_output_report(output->name, length == 0 ? ENOENT : ENAMETOOLONG, error);
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
    LsOutput output = {.name = path};
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

// Makes the temporary file. Returns 0, or the errno.
static int open_temporary(LsOutput* output)
{
    for (unsigned attempt = 0;; ++attempt)
    {
        snprintf(output->temporary, sizeof(output->temporary), "%s/.lspace-%ld-%u.tmp",
                 output->directory, (long)getpid(), attempt);
        output->descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (output->descriptor >= 0)
        {
            return 0;
        }
        if (errno != EEXIST || attempt == 1000)
        {
            return errno;
        }
    }
}

// Returns 0, or the errno. Not every file system can set room aside; there the writes themselves report
// a full disk.
static int reserve_room(const LsOutput* output, uint64_t size)
{
    const int reason = size > 0 ? posix_fallocate(output->descriptor, 0, (off_t)size) : 0;
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG)
    {
        return reason;
    }
    return ftruncate(output->descriptor, (off_t)size) == 0 ? 0 : errno;
}

LsResult ls_output_open(LsOutput* output, const char* path, uint64_t size, LsError* error)
{
    *output = (LsOutput){.name = path};
    LsResult result = find_place(output, error);
    if (result != LS_OK)
    {
        *output = (LsOutput){0};
        return result;
    }
    int reason = open_temporary(output);
    if (reason != 0)
    {
        *output = (LsOutput){0};
        return ls_output_report(path, reason, error);
    }
    reason = reserve_room(output, size);
    if (reason != 0)
    {
        ls_output_drop(output);
        return ls_output_report(path, reason, error);
    }
    return LS_OK;
}

LsResult ls_output_put(LsOutput* output, const void* bytes, uint64_t size, uint64_t offset,
                       LsError* error)
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
            return ls_output_report(output->name, errno, error);
        }
        done += put > 0 ? (uint64_t)put : 0;
    }
    return LS_OK;
}

LsResult ls_output_sync(LsOutput* output, LsError* error)
{
    return fsync(output->descriptor) == 0 ? LS_OK : ls_output_report(output->name, errno, error);
}

// The old file stays in place until all of the new one is on disk.
LsResult ls_output_commit(LsOutput* output, LsError* error)
{
    if (fsync(output->descriptor) != 0 || rename(output->temporary, output->path) != 0)
    {
        const LsResult result = ls_output_report(output->name, errno, error);
        ls_output_drop(output);
        return result;
    }
    close(output->descriptor);
    // The file is whole and in place; a directory that cannot be synchronised does not change that.
    const int directory = open(output->directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0)
    {
        fsync(directory);
        close(directory);
    }
    *output = (LsOutput){0};
    return LS_OK;
}

void ls_output_drop(LsOutput* output)
{
    if (output->name != NULL)
    {
        close(output->descriptor);
        unlink(output->temporary);
    }
    *output = (LsOutput){0};
}

LsResult ls_bytes_write(const void* bytes, uint64_t size, const char* path, LsError* error)
{
    LsOutput output;
    LsResult result = ls_output_open(&output, path, size, error);
    if (result != LS_OK)
    {
        return result;
    }
    result = ls_output_put(&output, bytes, size, 0, error);
    if (result != LS_OK)
    {
        ls_output_drop(&output);
        return result;
    }
    return ls_output_commit(&output, error);
}
