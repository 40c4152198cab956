#define _DEFAULT_SOURCE // MAP_ANONYMOUS

#include "pages.h"

#include <stddef.h>
#include <sys/mman.h>

// Linux allows a process 65530 mappings. Pages made anew join the mapping beside them; those that
// mremap moves never do, so there is no growing.
void* ls_pages_create(uint64_t bytes)
{
    void* pages = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return pages != MAP_FAILED ? pages : NULL;
}

void ls_pages_destroy(void* pages, uint64_t bytes)
{
    if (pages != NULL)
    {
        munmap(pages, bytes);
    }
}
