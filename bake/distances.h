// distances.h - how far a ray may skip from an empty cell, one distance per octant of directions.

#ifndef LS_DISTANCES_H
#define LS_DISTANCES_H

#include <stdint.h>

// Where distances are read from and stored to. Rows run along x; `size` in cells (or blocks).
typedef struct LsDistanceGrid
{
    uint32_t size[3];
    // Writes size[0] bytes: nonzero where the cell (x, y, z) is filled.
    void (*read_row)(void* user, uint32_t y, uint32_t z, uint8_t* filled);
    // Takes size[0] distances: 0 for filled cells, otherwise the side, 1..15, of the largest empty
    // cube that starts at the cell and grows into the octant (bit i: negative along axis i);
    // outside counts as empty. Called concurrently for different octants.
    void (*store_row)(void* user, uint32_t y, uint32_t z, uint32_t octant,
                      const uint8_t* distances);
    void* user;
} LsDistanceGrid;

// One backward dynamic program per octant, two layers of it in memory. Returns 0 when out of
// memory.
int ls_octant_distances(const LsDistanceGrid* grid, uint32_t threads);

#endif
