#define _XOPEN_SOURCE 700 // realpath

#include "out_file.h"

#include "ls_messages.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static LsResult report_failure(const char* name, int reason, LsError* error)
{
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG)
    {
        return ls_error_set(error, LS_MESSAGE_OUTPUT_FULL,
                            "%s: no space left for the output (%s); make room or "
                            "write elsewhere",
                            name, strerror(reason));
    }
    return ls_error_set(error, LS_MESSAGE_OUTPUT_UNWRITABLE,
                        "%s: cannot be written: %s; choose another place", name, strerror(reason));
}

static LsResult open_directly(LsOutFile* file, int descriptor, LsError* error)
{
    if (descriptor < 0)
    {
        return report_failure(file->name, errno, error);
    }
    file->descriptor = descriptor;
    return LS_OK;
}

// Opens `path`.tmp-XXXXXX, of the mode that a new file gets.
static LsResult open_temporary(LsOutFile* file, LsError* error)
{
    const char ending[] = ".tmp-XXXXXX";
    size_t length = strlen(file->path);
    file->temporary = malloc(length + sizeof(ending));
    if (!file->temporary)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s: out of memory; close other programs", file->name);
    }
    memcpy(file->temporary, file->path, length);
    memcpy(file->temporary + length, ending, sizeof(ending));
    int descriptor = mkstemp(file->temporary);
    if (descriptor < 0)
    {
        int reason = errno;
        free(file->temporary);
        file->temporary = NULL;
        return report_failure(file->name, reason, error);
    }
    file->descriptor = descriptor;
    mode_t mask = umask(0);
    umask(mask);
    return fchmod(descriptor, 0666 & ~mask) == 0 ? LS_OK : report_failure(file->name, errno, error);
}

LsResult ls_out_file_open(LsOutFile* file, const char* name, LsError* error)
{
    bool standard_output = strcmp(name, "-") == 0;
    *file = (LsOutFile){.name = standard_output ? "standard output" : name, .descriptor = -1};
    struct stat status;
    bool exists = stat(name, &status) == 0;
    LsResult result;
    if (standard_output)
    {
        result = open_directly(file, dup(STDOUT_FILENO), error);
    }
    else if (name[0] == '\0')
    {
        result = report_failure("the empty name", ENOENT, error);
    }
    else if (exists && S_ISDIR(status.st_mode))
    {
        result = ls_error_set(error, LS_MESSAGE_OUTPUT_IS_FOLDER,
                              "%s: is a directory; name a file in it", name);
    }
    else if (exists && !S_ISREG(status.st_mode))
    {
        result = open_directly(file, open(name, O_WRONLY | O_CLOEXEC), error);
    }
    else
    {
        // Following links keeps a link what it is.
        file->path = exists ? realpath(name, NULL) : strdup(name);
        result = file->path ? open_temporary(file, error) : report_failure(name, errno, error);
    }
    if (result != LS_OK)
    {
        ls_out_file_drop(file);
    }
    return result;
}

LsResult ls_out_file_write(LsOutFile* file, const void* bytes, size_t size, LsError* error)
{
    for (size_t done = 0; done < size;)
    {
        ssize_t put = write(file->descriptor, (const char*)bytes + done, size - done);
        if (put < 0 && errno != EINTR)
        {
            return report_failure(file->name, errno, error);
        }
        done += put > 0 ? (size_t)put : 0;
    }
    return LS_OK;
}

LsResult ls_out_file_commit(LsOutFile* file, LsError* error)
{
    int reason = 0;
    if (file->temporary)
    {
        if (fsync(file->descriptor) != 0 || rename(file->temporary, file->path) != 0)
        {
            reason = errno;
        }
        else
        {
            free(file->temporary);
            file->temporary = NULL;
        }
    }
    LsResult result = reason ? report_failure(file->name, reason, error) : LS_OK;
    ls_out_file_drop(file);
    return result;
}

void ls_out_file_drop(LsOutFile* file)
{
    if (file->name && file->descriptor >= 0)
    {
        close(file->descriptor);
    }
    if (file->temporary)
    {
        unlink(file->temporary);
    }
    free(file->temporary);
    free(file->path);
    *file = (LsOutFile){0};
}
