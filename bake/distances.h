// distances.h - how far a ray may skip from an empty cell, one distance per octant of directions.
//
// Words are those of SPEC chapter 5: a link, whose lowest nibble is 0, or eight distances. The
// distance of an octant (bit i: negative along axis i) is the side, 1..15, of the largest empty
// cube that starts at the cell and grows into the octant; outside counts as empty.

#ifndef LS_DISTANCES_H
#define LS_DISTANCES_H

#include "ls_layout.h"

#include <stdbool.h>

// Sets the distances in all words of a dense table that are no links; these must be LS_NONE before.
// x runs fastest. False when out of memory.
bool ls_block_distances(const uint32_t size[3], uint32_t* words, uint32_t threads);

// The same for the words of the cell blocks that a table of blocks links to, the table having its
// distances; cells of blocks without a link are empty. Takes time and memory for the table's blocks
// and the cells near links, not for all cells. False when out of memory.
bool ls_cell_distances(const uint32_t size[3], const uint32_t* blocks, LsCellBlock* cell_blocks,
                       uint32_t cell_block_count, uint32_t threads);

#endif
