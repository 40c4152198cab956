#define _GNU_SOURCE // mremap

#include "pages.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static uint64_t round_up(uint64_t bytes)
{
    const uint64_t page = (uint64_t)sysconf(_SC_PAGESIZE);
    return (bytes + page - 1) / page * page;
}

static void* map(uint64_t size)
{
    void* pages = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return pages != MAP_FAILED ? pages : NULL;
}

static void* remap(void* pages, uint64_t old_size, uint64_t new_size)
{
#ifdef MREMAP_MAYMOVE
    void* moved = mremap(pages, old_size, new_size, MREMAP_MAYMOVE);
    return moved != MAP_FAILED ? moved : NULL;
#else
    void* moved = map(new_size);
    if (moved != NULL)
    {
        memcpy(moved, pages, old_size < new_size ? old_size : new_size);
        munmap(pages, old_size);
    }
    return moved;
#endif
}

void* ls_pages_resize(void* pages, uint64_t old_bytes, uint64_t new_bytes)
{
    const uint64_t old_size = round_up(old_bytes), new_size = round_up(new_bytes);
    if (old_size == new_size)
    {
        return pages;
    }
    if (new_size == 0)
    {
        munmap(pages, old_size);
        return NULL;
    }
    return old_size == 0 ? map(new_size) : remap(pages, old_size, new_size);
}
