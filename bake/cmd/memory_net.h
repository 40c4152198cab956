// memory_net.h - the limit of --max-memory as one of the process.

#ifndef LS_MEMORY_NET_H
#define LS_MEMORY_NET_H

#include <stdint.h>

// From here on allocations fail that take the private memory of this process beyond `bytes`, what it
// has already and its threads' stacks apart. No memory sanitizer lives with that: built with one,
// this does nothing. `threads`: 0 for all processors.
void ls_memory_net_set(uint64_t bytes, uint32_t threads);

#endif
