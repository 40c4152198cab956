// file_map.c - a whole file read-only in memory. The only platform code of the read side.

#define _DEFAULT_SOURCE // madvise and MAP_ANONYMOUS

#include "ls_format.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

// Since Linux 5.14; older kernels answer EINVAL.
#ifndef MADV_POPULATE_READ
#define MADV_POPULATE_READ 22
#endif

static LsResult report_cut(const char* path, LsError* error)
{
    return ls_error_set(error, LS_MESSAGE_FILE_CHANGED,
                        "%s: the file was cut short while it was being read; try again when nobody "
                        "writes it",
                        path);
}

static LsResult report_errno(const char* path, LsError* error)
{
    if (errno == ENOENT || errno == ENOTDIR)
    {
        return ls_error_set(error, LS_MESSAGE_FILE_MISSING, "%s: file not found; check the path",
                            path);
    }
    return ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE,
                        "%s: cannot be read: %s; check its permissions and the disk", path,
                        strerror(errno));
}

// Where a file cannot be mapped, or its pages not be brought in safely, it is read into memory.
static LsResult read_all(int descriptor, uint64_t size, void** bytes, const char* path,
                         LsError* error)
{
    void* memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
    {
        return report_errno(path, error);
    }
    const uint64_t block = 1u << 30;
    uint64_t done = 0;
    while (done < size)
    {
        const uint64_t left = size - done;
        const ssize_t got =
            pread(descriptor, (char*)memory + done, left < block ? left : block, (off_t)done);
        if (got < 0 && errno == EINTR)
        {
            continue;
        }
        if (got <= 0)
        {
            const LsResult result = got == 0 ? report_cut(path, error) : report_errno(path, error);
            munmap(memory, size);
            return result;
        }
        done += (uint64_t)got;
    }
    mprotect(memory, size, PROT_READ);
    *bytes = memory;
    return LS_OK;
}

static LsResult map_all(int descriptor, uint64_t size, void** bytes, const char* path,
                        LsError* error)
{
    void* memory = mmap(NULL, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (memory == MAP_FAILED)
    {
        return read_all(descriptor, size, bytes, path, error);
    }
    // A page behind the end of a cut file makes this call fail; touching it would be a signal.
    while (madvise(memory, size, MADV_POPULATE_READ) != 0)
    {
        if (errno == EINTR || errno == EAGAIN)
        {
            continue;
        }
        const int reason = errno;
        munmap(memory, size);
        if (reason == EFAULT)
        {
            return report_cut(path, error);
        }
        return read_all(descriptor, size, bytes, path, error);
    }
    *bytes = memory;
    return LS_OK;
}

static LsResult open_mapping(LsMapping* mapping, int descriptor, const char* path, LsError* error)
{
    struct stat before;
    if (fstat(descriptor, &before) != 0)
    {
        return report_errno(path, error);
    }
    if (S_ISDIR(before.st_mode))
    {
        return ls_error_set(error, LS_MESSAGE_FILE_IS_FOLDER,
                            "%s: is a directory; name a file in it", path);
    }
    if (!S_ISREG(before.st_mode))
    {
        return ls_error_set(error, LS_MESSAGE_FILE_NOT_REGULAR,
                            "%s: is no regular file; copy its contents to one", path);
    }
    if (before.st_size == 0)
    {
        return ls_error_set(error, LS_MESSAGE_FILE_EMPTY, "%s: file is empty; make it again", path);
    }
    const uint64_t size = (uint64_t)before.st_size;
    void* bytes = NULL;
    LsResult result = map_all(descriptor, size, &bytes, path, error);
    if (result != LS_OK)
    {
        return result;
    }
    struct stat after;
    if (fstat(descriptor, &after) != 0 || after.st_size != before.st_size)
    {
        munmap(bytes, size);
        return report_cut(path, error);
    }
    *mapping = (LsMapping){.bytes = bytes, .size = size};
    return LS_OK;
}

LsResult ls_mapping_open(LsMapping* mapping, const char* path, LsError* error)
{
    *mapping = (LsMapping){0};
    // Without O_NONBLOCK a named pipe would wait here for its writer.
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
    {
        return report_errno(path, error);
    }
    const LsResult result = open_mapping(mapping, descriptor, path, error);
    close(descriptor);
    return result;
}

void ls_mapping_close(LsMapping* mapping)
{
    if (mapping->bytes != NULL)
    {
        munmap((void*)mapping->bytes, mapping->size);
    }
    *mapping = (LsMapping){0};
}

bool ls_path_is_same(const char* a, const char* b)
{
    struct stat status_a, status_b;
    return stat(a, &status_a) == 0 && stat(b, &status_b) == 0 &&
           status_a.st_dev == status_b.st_dev && status_a.st_ino == status_b.st_ino;
}
