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

// The triangles of the largest mesh, made beside what it is made from.
uint64_t ls_mesh_need(const LsInput* input);
// The dense table of a grid's blocks.
uint64_t ls_grid_need(const LsGridFrame* frame);
// The masks of all objects; 0 where N is to be chosen, since it is not known yet.
uint64_t ls_tables_need(const LsBakedObject* objects, uint32_t count,
                        const LsPatchesChoice* choice);
// The arrays of the file, all made before the objects that are packed into them are freed.
uint64_t ls_pack_need(const LsBakedObject* objects, const LsMesh* meshes, uint32_t count);

#endif
