// tables.h - the shaft tables of an object: a mask per shaft for every voxel that is worth one.

#ifndef LS_TABLES_H
#define LS_TABLES_H

#include "voxels.h"

// Owns its array.
typedef struct LsTables
{
    uint32_t* words; // all tables, voxel after voxel
    uint32_t word_count;
    uint64_t shaft_count;  // in all tables
    uint64_t filled_count; // shafts whose mask is not 0
} LsTables;

// Makes the tables of all voxels of kind MASKS and sets their `table`. The result does not depend
// on `threads`. `progress` may be NULL. Errors: OUT_OF_MEMORY, LIMIT_RECORDS.
LsResult ls_tables_create(LsTables* tables, LsVoxels* voxels, const LsMesh* mesh, uint32_t patches,
                          uint32_t threads, const LsStageProgress* progress, LsError* error);
void ls_tables_destroy(LsTables* tables);

#endif
