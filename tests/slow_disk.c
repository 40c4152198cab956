// slow_disk.c - preloaded into a program: a disk on which bringing files to it takes its time, so that a signal
// can come meanwhile; with LS_NAMED_FILES set, a file system without files that have no name.

#define _GNU_SOURCE // O_TMPFILE

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int open64(const char* path, int flags, ...)
{
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    if ((flags & O_TMPFILE) == O_TMPFILE && getenv("LS_NAMED_FILES") != NULL)
    {
        errno = EOPNOTSUPP;
        return -1;
    }
    return openat(AT_FDCWD, path, flags, mode);
}

int fsync(int descriptor)
{
    const struct timespec pause = {.tv_nsec = 60 * 1000 * 1000};
    nanosleep(&pause, NULL);
    return (int)syscall(SYS_fsync, descriptor);
}
