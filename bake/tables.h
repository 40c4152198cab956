// tables.h - the shaft tables of an object: a mask per shaft for every voxel that is worth one.

#ifndef LS_TABLES_H
#define LS_TABLES_H

#include "shaft_cost.h"
#include "voxels.h"

// What the table of a voxel costs and saves, to choose N by.
typedef struct LsPatchesChoice
{
    bool by_work;      // grids and byte_price are found by expected work: ls_choose
    uint32_t patches;  // N of every voxel, or the most that may be chosen
    bool chosen;       // each voxel has the N, or no table, of the least tests + price * bytes
    double byte_price; // triangle tests of a ray through a voxel of a whole cell; if chosen
} LsPatchesChoice;

// Tables of LS_TABLE_VOXELS voxels, one behind the other.
typedef struct LsTableBlock
{
    uint32_t* words; // ls_pages_create; NULL if there are none
    uint32_t word_count;
    uint64_t shaft_count;
    uint64_t filled_count; // shafts whose mask is not 0
    double visits;         // of voxels that rays test triangles in: ls_voxel_visits
    double lookups;        // visits of those with masks
    double tests;          // expected in all visits
} LsTableBlock;

#define LS_TABLE_VOXELS 256

// Owns its arrays.
typedef struct LsTables
{
    LsTableBlock* blocks;
    uint32_t block_count;
    uint32_t word_count;
    uint64_t shaft_count;
    uint64_t filled_count;
    double visits; // tests / visits: expected triangle tests of a voxel that a ray visits
    double lookups;
    double tests;
} LsTables;

// Makes the tables of all voxels of kind MASKS, also of those that a former choice made LISTs, and
// sets their `patches` and `table`; where a choice finds no table worth its bytes, the voxel
// becomes a LIST. weights: of each N that may be used. The result does not depend on `threads`.
// `progress` may be NULL. Errors: OUT_OF_MEMORY, LIMIT_RECORDS.
LsResult ls_tables_create(LsTables* tables, LsVoxels* voxels, const LsMesh* mesh,
                          const LsPatchesChoice* choice, const LsShaftWeights* weights,
                          uint32_t threads, const LsStageProgress* progress, LsError* error);
void ls_tables_destroy(LsTables* tables);
void ls_table_block_destroy(LsTableBlock* block); // of its words alone; its counts stay

// Words of the tables of these voxels if all have the same N.
uint64_t ls_tables_words(const LsWorkVoxel* voxels, uint32_t count, uint32_t patches);
// Bytes that each thread works with besides the tables; where N is chosen, besides those of a block
// too.
uint64_t ls_tables_work_bytes(const LsPatchesChoice* choice);

#endif
