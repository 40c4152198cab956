// distances.c - d(cell) = 1 + min over the seven neighbours in the octant, 0 if the cell is filled.
//
// Both functions run one backward dynamic program per octant and keep two layers of it. Coordinates
// are mirrored along negative axes, so that every octant runs the same way.

#include "distances.h"

#include <stdlib.h>
#include <string.h>

#define LARGEST 15

// Octants are written at the same time, each its own nibble of words that begin with all bits set.
static void narrow(uint32_t* word, uint32_t octant, uint32_t distance)
{
    const uint32_t kept = ~((LARGEST ^ distance) << (4 * octant));
#pragma omp atomic
    *word &= kept;
}

static uint32_t read_word(const uint32_t* word)
{
    uint32_t value;
#pragma omp atomic read
    value = *word;
    return value;
}

static bool is_link(uint32_t word)
{
    return (word & 15u) == 0;
}

static uint8_t smaller(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

static uint8_t one_more(uint8_t distance)
{
    return distance < LARGEST ? (uint8_t)(distance + 1) : LARGEST;
}

// ---- A dense table ------------------------------------------------------------------------------

// Minimum of up to three rows: the neighbours in y, z and both.
static void find_minimum(const uint8_t* near, const uint8_t* layer, const uint8_t* both,
                         uint32_t count, uint8_t* minimum)
{
    for (uint32_t x = 0; x < count; x++)
    {
        minimum[x] = smaller(smaller(near[x], layer[x]), both[x]);
    }
}

// Row entries at size[0] stand for what lies outside.
static bool run_table(const uint32_t size[3], uint32_t* words, uint32_t octant)
{
    const uint32_t nx = size[0], ny = size[1], nz = size[2];
    const size_t row = (size_t)nx + 1, layer_bytes = row * (ny + 1);
    uint8_t* memory = malloc(2 * layer_bytes + row);
    if (memory == NULL)
    {
        return false;
    }
    uint8_t* above = memory; // the layer before in z, all outside at first
    uint8_t* current = memory + layer_bytes;
    uint8_t* minimum = memory + 2 * layer_bytes;
    memset(memory, LARGEST, 2 * layer_bytes);
    for (uint32_t k = nz; k-- > 0;)
    {
        const uint32_t z = octant & 4 ? nz - 1 - k : k;
        for (uint32_t j = ny; j-- > 0;)
        {
            const uint32_t y = octant & 2 ? ny - 1 - j : j;
            uint32_t* line = words + (size_t)nx * (y + (size_t)ny * z);
            uint8_t* d = current + row * j;
            find_minimum(d + row, above + row * j, above + row * (j + 1), (uint32_t)row, minimum);
            for (uint32_t i = nx; i-- > 0;)
            {
                const uint32_t x = octant & 1 ? nx - 1 - i : i;
                d[i] = one_more(smaller(smaller(minimum[i], minimum[i + 1]), d[i + 1]));
                if (is_link(read_word(&line[x])))
                {
                    d[i] = 0;
                }
                else if (d[i] < LARGEST)
                {
                    narrow(&line[x], octant, d[i]);
                }
            }
        }
        uint8_t* swap = above;
        above = current;
        current = swap;
    }
    free(memory);
    return true;
}

bool ls_block_distances(const uint32_t size[3], uint32_t* words, uint32_t threads)
{
    bool ok = true;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) reduction(&& : ok)
    for (uint32_t octant = 0; octant < 8; octant++)
    {
        ok = run_table(size, words, octant) && ok;
    }
    return ok;
}

// ---- Cells in blocks ----------------------------------------------------------------------------

enum
{
    SIDE = LS_BLOCK_SIDE,
    EDGE = SIDE + 1, // with the first cells of the blocks behind
    WIDE = 8,        // a row of that, filled up to a vector
};

// The distances of a block's cells.
typedef struct BlockDistances
{
    uint8_t d[SIDE][SIDE][SIDE]; // [z][y][x]
} BlockDistances;

// A layer of blocks with one row and column more for what lies outside.
typedef struct Layer
{
    BlockDistances* blocks; // where any is below 15
    uint8_t* is_near;       // whether any is
} Layer;

typedef struct CellRun
{
    uint32_t size[3];
    size_t row; // blocks of a layer's row
    const uint32_t* words;
    const uint64_t* filled; // per cell block a bit per cell
    LsCellBlock* cell_blocks;
    uint32_t octant;
    Layer above, current;
} CellRun;

static bool create_layer(Layer* layer, size_t count)
{
    layer->blocks = malloc(count * sizeof *layer->blocks);
    layer->is_near = calloc(count, 1);
    return layer->blocks != NULL && layer->is_near != NULL;
}

static void destroy_layer(Layer* layer)
{
    free(layer->blocks);
    free(layer->is_near);
}

// Copies what borders on the block of a neighbour behind it along x, y and z (0 or 1 each;
// constants).
static inline __attribute__((always_inline)) void
copy_border(const Layer* layer, size_t at, uint8_t d[EDGE][EDGE][WIDE], int x, int y, int z)
{
    if (!layer->is_near[at])
    {
        return;
    }
    const BlockDistances* from = &layer->blocks[at];
    for (int k = 0; k < (z ? 1 : SIDE); k++)
    {
        for (int j = 0; j < (y ? 1 : SIDE); j++)
        {
            memcpy(&d[k + SIDE * z][j + SIDE * y][SIDE * x], from->d[k][j], x ? 1 : SIDE);
        }
    }
}

static void copy_borders(const CellRun* run, size_t at, uint8_t d[EDGE][EDGE][WIDE])
{
    const size_t beside = at + run->row;
    copy_border(&run->current, at + 1, d, 1, 0, 0);
    copy_border(&run->current, beside, d, 0, 1, 0);
    copy_border(&run->current, beside + 1, d, 1, 1, 0);
    copy_border(&run->above, at, d, 0, 0, 1);
    copy_border(&run->above, at + 1, d, 1, 0, 1);
    copy_border(&run->above, beside, d, 0, 1, 1);
    copy_border(&run->above, beside + 1, d, 1, 1, 1);
}

// The dynamic program within one block. Says whether any distance is below 15.
static bool run_cells(uint8_t d[EDGE][EDGE][WIDE], uint64_t filled)
{
    uint8_t least = LARGEST;
    for (uint32_t z = SIDE; z-- > 0;)
    {
        for (uint32_t y = SIDE; y-- > 0;)
        {
            uint8_t minimum[WIDE];
            find_minimum(d[z][y + 1], d[z + 1][y], d[z + 1][y + 1], WIDE, minimum);
            for (uint32_t x = SIDE; x-- > 0;)
            {
                const uint8_t next =
                    one_more(smaller(smaller(minimum[x], minimum[x + 1]), d[z][y][x + 1]));
                d[z][y][x] = filled >> (x + 4 * y + 16 * z) & 1 ? 0 : next;
                least = smaller(least, d[z][y][x]);
            }
        }
    }
    return least < LARGEST;
}

static uint64_t mirror_cells(uint64_t filled, uint32_t octant)
{
    const uint32_t flip =
        (octant & 1 ? 3u : 0u) | (octant & 2 ? 12u : 0u) | (octant & 4 ? 48u : 0u);
    uint64_t mirrored = 0;
    for (; filled != 0; filled &= filled - 1)
    {
        mirrored |= 1ull << ((uint32_t)__builtin_ctzll(filled) ^ flip);
    }
    return mirrored;
}

static void run_block(const CellRun* run, size_t at, uint32_t word)
{
    uint8_t d[EDGE][EDGE][WIDE];
    memset(d, LARGEST, sizeof d);
    copy_borders(run, at, d);
    const uint64_t filled = is_link(word) ? run->filled[word >> 4] : 0;
    run->current.is_near[at] = run_cells(d, mirror_cells(filled, run->octant));
    BlockDistances* out = &run->current.blocks[at];
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
    {
        memcpy(out->d[i / SIDE][i % SIDE], d[i / SIDE][i % SIDE], SIDE);
    }
    if (!is_link(word))
    {
        return;
    }
    uint32_t* cells = run->cell_blocks[word >> 4].cells;
    for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
    {
        const uint32_t x = run->octant & 1 ? 3 - (c & 3) : c & 3;
        const uint32_t y = run->octant & 2 ? 3 - (c >> 2 & 3) : c >> 2 & 3;
        const uint32_t z = run->octant & 4 ? 3 - (c >> 4) : c >> 4;
        if ((filled >> c & 1) == 0 && d[z][y][x] < LARGEST)
        {
            narrow(&cells[c], run->octant, d[z][y][x]);
        }
    }
}

// Whether distances of the block's cells are wanted: it is filled, or distances below 15 may pass
// through it on their way to a filled block, which takes one in the octant and one opposite, four
// blocks away at most.
static bool is_wanted(uint32_t word, uint32_t octant)
{
    return is_link(word) ||
           ((word >> (4 * octant) & 15u) <= 4 && (word >> (4 * (octant ^ 7)) & 15u) <= 4);
}

static void run_layer(CellRun* run, uint32_t k)
{
    const uint32_t nx = run->size[0], ny = run->size[1], nz = run->size[2];
    const uint32_t z = run->octant & 4 ? nz - 1 - k : k;
    for (uint32_t j = ny; j-- > 0;)
    {
        const uint32_t y = run->octant & 2 ? ny - 1 - j : j;
        const uint32_t* line = run->words + (size_t)nx * (y + (size_t)ny * z);
        for (uint32_t i = nx; i-- > 0;)
        {
            const uint32_t word = line[run->octant & 1 ? nx - 1 - i : i];
            run->current.is_near[run->row * j + i] = 0;
            if (is_wanted(word, run->octant))
            {
                run_block(run, run->row * j + i, word);
            }
        }
    }
}

static bool run_blocks(CellRun run)
{
    const size_t count = run.row * ((size_t)run.size[1] + 1);
    bool ok = create_layer(&run.above, count);
    ok = create_layer(&run.current, count) && ok;
    for (uint32_t k = run.size[2]; ok && k-- > 0;)
    {
        run_layer(&run, k);
        const Layer swap = run.above;
        run.above = run.current;
        run.current = swap;
    }
    destroy_layer(&run.above);
    destroy_layer(&run.current);
    return ok;
}

bool ls_cell_distances(const uint32_t size[3], const uint32_t* blocks, LsCellBlock* cell_blocks,
                       uint32_t cell_block_count, uint32_t threads)
{
    uint64_t* filled = calloc((size_t)cell_block_count + 1, sizeof *filled);
    bool ok = filled != NULL;
    for (uint32_t i = 0; ok && i < cell_block_count; i++)
    {
        for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
        {
            filled[i] |= (uint64_t)is_link(cell_blocks[i].cells[c]) << c;
        }
    }
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) reduction(&& : ok)
    for (uint32_t octant = 0; octant < 8; octant++)
    {
        const CellRun run = {.size = {size[0], size[1], size[2]},
                             .row = (size_t)size[0] + 1,
                             .words = blocks,
                             .filled = filled,
                             .cell_blocks = cell_blocks,
                             .octant = octant};
        ok = ok && run_blocks(run);
    }
    free(filled);
    return ok;
}
