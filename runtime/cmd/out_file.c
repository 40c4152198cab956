#include "out_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static LsResult open_directly(LsOutFile* file, int descriptor, LsError* error)
{
    if (descriptor < 0)
    {
        return ls_output_report(file->name, errno, error);
    }
    file->direct = true;
    file->descriptor = descriptor;
    return LS_OK;
}

LsResult ls_out_file_open(LsOutFile* file, const char* name, LsError* error)
{
    const bool standard_output = strcmp(name, "-") == 0;
    *file = (LsOutFile){.name = standard_output ? "standard output" : name};
    struct stat status;
    const bool exists = stat(name, &status) == 0;
    LsResult result;
    if (standard_output)
    {
        result = open_directly(file, dup(STDOUT_FILENO), error);
    }
    else if (name[0] == '\0')
    {
        result = ls_output_report("the empty name", ENOENT, error);
    }
    else if (exists && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
    {
        result = open_directly(file, open(name, O_WRONLY | O_CLOEXEC), error);
    }
    else
    {
        result = ls_output_open(&file->output, name, 0, error);
    }
    if (result != LS_OK)
    {
        *file = (LsOutFile){0};
    }
    return result;
}

static LsResult write_directly(const LsOutFile* file, const void* bytes, size_t size,
                               LsError* error)
{
    for (size_t done = 0; done < size;)
    {
        const ssize_t put = write(file->descriptor, (const char*)bytes + done, size - done);
        if (put < 0 && errno != EINTR)
        {
            return ls_output_report(file->name, errno, error);
        }
        done += put > 0 ? (size_t)put : 0;
    }
    return LS_OK;
}

LsResult ls_out_file_write(LsOutFile* file, const void* bytes, size_t size, LsError* error)
{
    const LsResult result = file->direct
                                ? write_directly(file, bytes, size, error)
                                : ls_output_put(&file->output, bytes, size, file->size, error);
    file->size += size;
    return result;
}

LsResult ls_out_file_commit(LsOutFile* file, LsError* error)
{
    const LsResult result = file->direct ? LS_OK : ls_output_commit(&file->output, error);
    ls_out_file_drop(file);
    return result;
}

void ls_out_file_drop(LsOutFile* file)
{
    if (file->direct)
    {
        close(file->descriptor);
    }
    ls_output_drop(&file->output);
    *file = (LsOutFile){0};
}
