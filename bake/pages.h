// pages.h - memory in whole pages, which goes back to the system as soon as it is freed, in
// whatever order that is.
//
// malloc keeps freed blocks for itself where younger ones lie behind them: a file whose parts are
// freed as they are packed would be in memory twice.

#ifndef LS_PAGES_H
#define LS_PAGES_H

#include <stdint.h>

// bytes > 0. NULL when out of memory.
void* ls_pages_create(uint64_t bytes);
void ls_pages_destroy(void* pages,
                      uint64_t bytes); // of as many bytes as were asked for; NULL is allowed

#endif
