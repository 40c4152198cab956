// output.c - files that appear whole or not at all.

#define _GNU_SOURCE // realpath, O_TMPFILE

#include "ls_messages.h"
#include "ls_output.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdbool.h>
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

// ---- The temporary file -------------------------------------------------------------------------
//
// Where the system can, it has no name until it is whole, so that a program that is killed leaves nothing
// behind. Else it has one from the first, and is in the list of those to be removed when the program is
// told to end.

// Held while names are made or removed.
static pthread_mutex_t names_lock = PTHREAD_MUTEX_INITIALIZER;
static LsOutput* named; // open ones whose temporary file has a name

static void choose_name(LsOutput* output, unsigned attempt)
{
    snprintf(output->temporary, sizeof(output->temporary), "%s/.lspace-%ld-%u.tmp",
             output->directory, (long)getpid(), attempt);
}

// Links a file without a name to this one. Returns 0, or the errno.
static int link_nameless(const LsOutput* output, const char* path)
{
    char open_file[64];
    snprintf(open_file, sizeof(open_file), "/proc/self/fd/%d", output->descriptor);
    return linkat(AT_FDCWD, open_file, AT_FDCWD, path, AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
}

// False where such files cannot be made, or not be named later: that had better show before hours of
// work. Linking to a name that exists fails last for that reason.
static bool open_nameless(LsOutput* output)
{
#ifdef O_TMPFILE
    output->descriptor = open(output->directory, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    char here[LS_OUTPUT_PATH + 2];
    snprintf(here, sizeof(here), "%s/.", output->directory);
    if (output->descriptor >= 0 && link_nameless(output, here) == EEXIST)
    {
        return true;
    }
    if (output->descriptor >= 0)
    {
        close(output->descriptor);
    }
#endif
    return false;
}

// Returns 0, or the errno.
static int open_named(LsOutput* output)
{
    int reason = EEXIST;
    pthread_mutex_lock(&names_lock);
    for (unsigned attempt = 0; reason == EEXIST && attempt <= 1000; ++attempt)
    {
        choose_name(output, attempt);
        output->descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        reason = output->descriptor >= 0 ? 0 : errno;
    }
    if (reason == 0)
    {
        output->next = named;
        named = output;
    }
    pthread_mutex_unlock(&names_lock);
    return reason;
}

// The lock is held.
static void forget_name(LsOutput* output)
{
    for (LsOutput** at = &named; *at != NULL; at = &(*at)->next)
    {
        if (*at == output)
        {
            *at = output->next;
            break;
        }
    }
    output->temporary[0] = '\0';
}

static void remove_name(LsOutput* output)
{
    if (output->temporary[0] != '\0')
    {
        unlink(output->temporary);
    }
    forget_name(output);
}

// Puts the file in its place. Returns 0, or the errno.
static int take_place(LsOutput* output)
{
    if (output->temporary[0] == '\0')
    {
        // If nothing is there, no other name is needed; else only renaming replaces at a stroke.
        int reason = link_nameless(output, output->path);
        for (unsigned attempt = 0; reason == EEXIST && attempt <= 1000; ++attempt)
        {
            choose_name(output, attempt);
            reason = link_nameless(output, output->temporary);
            if (reason == 0)
            {
                reason = rename(output->temporary, output->path) == 0 ? 0 : errno;
                reason == 0 ? forget_name(output) : remove_name(output);
                return reason;
            }
        }
        output->temporary[0] = '\0';
        return reason;
    }
    if (rename(output->temporary, output->path) != 0)
    {
        return errno;
    }
    forget_name(output);
    return 0;
}

void ls_output_abandon_all(void)
{
    pthread_mutex_lock(&names_lock);
    for (const LsOutput* output = named; output != NULL; output = output->next)
    {
        unlink(output->temporary);
    }
    // The lock is kept: nobody gets any further.
}

// ---- Writing ------------------------------------------------------------------------------------

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
    int reason = open_nameless(output) ? 0 : open_named(output);
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
    int reason = fsync(output->descriptor) == 0 ? 0 : errno;
    if (reason == 0)
    {
        pthread_mutex_lock(&names_lock);
        reason = take_place(output);
        pthread_mutex_unlock(&names_lock);
    }
    if (reason != 0)
    {
        const LsResult result = ls_output_report(output->name, reason, error);
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
        pthread_mutex_lock(&names_lock);
        remove_name(output);
        pthread_mutex_unlock(&names_lock);
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
