// pages.h - memory in whole pages, which goes back to the system as soon as it is freed, in whatever order that is.
//
// malloc keeps freed blocks for itself where younger ones lie behind them: a file whose parts are freed as they are
// packed would be in memory twice.

#ifndef LS_PAGES_H
#define LS_PAGES_H

#include <stdint.h>

// Makes `old_bytes` at `pages` (NULL: 0) into `new_bytes`, with its contents as far as they fit; they may move. 0 frees. NULL when out of memory, and then the old ones stay, or when freed.
void* ls_pages_resize(void* pages, uint64_t old_bytes, uint64_t new_bytes);

#endif
