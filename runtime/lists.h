// lists.h - what the first of two passes reads of a scene with one grid, made when it is created.

#ifndef LS_LISTS_H
#define LS_LISTS_H

#include "array.h"

typedef struct LsLists
{
    LsArray instances; // LsPassInstance: the lists, in the order of instances, then the grid's
    LsArray boxes;     // LsPairBox of all of them; zero if there are none
    uint32_t list_count;
    float transform_bound; // as LsTraceScene's; of a file without a top level, what it would be
} LsLists;

// Makes the tables from a checked file, with a box for each two triangles of each instance, so the
// caller sees to it that these are few, and queues their copy. `grid_instance` is the instance
// whose object has the grid, `name` is for messages. Whatever the result, ls_lists_destroy must be
// called, once the upload has ended. Errors: DEVICE_MEMORY, DEVICE_LOST, DEVICE, MEMORY.
LsResult ls_lists_create(LsUpload* upload, const LsFile* file, uint32_t grid_instance,
                         const char* name, LsLists* lists, LsError* error);
void ls_lists_destroy(const LsContext* context, LsLists* lists); // zero ones are allowed

#endif
