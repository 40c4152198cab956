// memory_net.c - RLIMIT_DATA, which on Linux counts all private writable memory.

#include "memory_net.h"

#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_SHADOW_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HAS_SHADOW_MEMORY 1
#endif
#endif

#ifndef HAS_SHADOW_MEMORY
// The sixth number of statm: pages of data and stack. 0 where the system does not tell.
static uint64_t find_data_bytes(void)
{
    unsigned long long pages = 0;
    FILE* file = fopen("/proc/self/statm", "r");
    if (!file)
        return 0;
    if (fscanf(file, "%*u %*u %*u %*u %*u %llu", &pages) != 1)
        pages = 0;
    fclose(file);
    return pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

// glibc gives a thread the room that the first one's stack may take, or 2 MiB if that has no limit.
static uint64_t find_stack_bytes(void)
{
    struct rlimit limit;
    return getrlimit(RLIMIT_STACK, &limit) || limit.rlim_cur == RLIM_INFINITY ? 2u << 20
                                                                              : limit.rlim_cur;
}
#endif

void ls_memory_net_set(uint64_t bytes, uint32_t threads)
{
#ifdef HAS_SHADOW_MEMORY
    (void)bytes;
    (void)threads;
#else
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const uint64_t stacks = find_stack_bytes() * (threads          ? threads
                                                  : processors > 0 ? (uint64_t)processors
                                                                   : 1);
    const uint64_t beside = find_data_bytes() + stacks;
    struct rlimit limit;
    if (getrlimit(RLIMIT_DATA, &limit) || bytes > UINT64_MAX / 2 - beside ||
        bytes + beside >= limit.rlim_cur)
        return;
    limit.rlim_cur = bytes + beside;
    setrlimit(RLIMIT_DATA, &limit);
#endif
}
