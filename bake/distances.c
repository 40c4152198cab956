// distances.c - d(cell) = 1 + min over the seven neighbours in the octant, 0 if the cell is filled.

#include "distances.h"

#include <stdlib.h>
#include <string.h>

#define LARGEST 15

// Minimum of up to three rows (the neighbours in y, z and both), at x and at x + 1 in the octant's
// sense.
static void neighbour_minimum(const uint8_t* near, const uint8_t* layer, const uint8_t* both,
                              uint32_t count, uint8_t* minimum)
{
    for (uint32_t x = 0; x < count; x++)
    {
        uint8_t m = near[x] < layer[x] ? near[x] : layer[x];
        minimum[x] = m < both[x] ? m : both[x];
    }
}

// Rows are kept reversed along negative axes, so that every octant runs the same way; row entries
// at `count` stand for what lies outside.
static int run_octant(const LsDistanceGrid* grid, uint32_t octant)
{
    uint32_t nx = grid->size[0], ny = grid->size[1], nz = grid->size[2];
    size_t row = nx + 1, layer_bytes = row * (ny + 1);
    uint8_t* memory = malloc(2 * layer_bytes + 3 * row);
    if (memory == NULL)
    {
        return 0;
    }
    uint8_t* above = memory; // the layer before in z, all outside at first
    uint8_t* current = memory + layer_bytes;
    uint8_t* filled = memory + 2 * layer_bytes;
    uint8_t* minimum = filled + row;
    uint8_t* out = minimum + row;
    memset(memory, LARGEST, 2 * layer_bytes);
    for (uint32_t k = nz; k-- > 0;)
    {
        uint32_t z = octant & 4 ? nz - 1 - k : k;
        for (uint32_t j = ny; j-- > 0;)
        {
            uint32_t y = octant & 2 ? ny - 1 - j : j;
            uint8_t* d = current + row * j;
            grid->read_row(grid->user, y, z, filled);
            neighbour_minimum(d + row, above + row * j, above + row * (j + 1), (uint32_t)row,
                              minimum);
            d[nx] = LARGEST;
            for (uint32_t i = nx; i-- > 0;)
            {
                uint32_t x = octant & 1 ? nx - 1 - i : i;
                uint8_t m = minimum[i] < minimum[i + 1] ? minimum[i] : minimum[i + 1];
                m = d[i + 1] < m ? d[i + 1] : m;
                d[i] = filled[x] ? 0 : (uint8_t)(m < LARGEST ? m + 1 : LARGEST);
                out[x] = d[i];
            }
            grid->store_row(grid->user, y, z, octant, out);
        }
        uint8_t* swap = above;
        above = current;
        current = swap;
    }
    free(memory);
    return 1;
}

int ls_octant_distances(const LsDistanceGrid* grid, uint32_t threads)
{
    int ok = 1;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) reduction(& : ok)
    for (int octant = 0; octant < 8; octant++)
    {
        ok &= run_octant(grid, (uint32_t)octant);
    }
    return ok;
}
