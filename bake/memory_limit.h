// memory_limit.h - what the stages after the import will need at least, held against --max-memory.
//
// What is known before a stage begins is refused before it begins. These are lower bounds: what
// working arrays take beside them is left to the limit of the process, which lsbake sets.

#ifndef LS_MEMORY_LIMIT_H
#define LS_MEMORY_LIMIT_H

#include "pack.h"

// Whether `needed` bytes beside what this process has in memory now are within `limit` (0: none).
// `scene` and `what` are for the message. Errors: LIMIT_MEMORY.
LsResult ls_memory_check(uint64_t limit, uint64_t needed, const char* scene, const char* what,
                         LsError* error);

// Bytes of private memory that this process has now; 0 where the system does not tell.
uint64_t ls_memory_in_use(void);

// Hands what malloc keeps of freed memory back to the system, where it can be asked to.
void ls_memory_give_back(void);

// What the largest mesh is made with: welded corners, marks of faces without area, and its
// triangles.
uint64_t ls_mesh_need(const LsInput* input);
// The dense table of a grid's blocks, and the triangles put into another order, with their new
// numbers.
uint64_t ls_grid_need(const LsGridFrame* frame, uint32_t triangle_count);
// The tables of all objects, and the more of what is worked with meanwhile and what packing, which
// comes next, takes beside them. Where a choice finds N by voxel, only what is worked with: the
// tables are not known beforehand.
uint64_t ls_tables_need(const LsBakedObject* objects, uint32_t count, const LsPatchesChoice* choice,
                        uint32_t threads);
// What packing takes besides these tables, once they are made.
uint64_t ls_pack_need(const LsBakedObject* objects, uint32_t count);

#endif
