// Octant distances against their definition: of every empty cell the largest number of steps, along
// all axes at once, to a filled cell of the octant.

#include "distances.h"
#include "test_random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

enum
{
    MOST_BLOCKS = 12 * 12 * 12,
    MOST_FILLED = 4096,
};

// Filled blocks or cells.
typedef struct LsFilled
{
    int at[MOST_FILLED][3];
    uint32_t count;
} LsFilled;

static void add_filled(LsFilled* filled, uint32_t x, uint32_t y, uint32_t z)
{
    assert_true(filled->count < MOST_FILLED);
    int* at = filled->at[filled->count++];
    at[0] = (int)x;
    at[1] = (int)y;
    at[2] = (int)z;
}

// The side of the largest empty cube, at most 15.
static uint32_t define_distance(const LsFilled* filled, const int at[3], uint32_t octant)
{
    int side = 15;
    for (uint32_t i = 0; i < filled->count; i++)
    {
        int steps = 0;
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            const int step = (filled->at[i][axis] - at[axis]) * (octant >> axis & 1 ? -1 : 1);
            steps = step < 0 ? 15 : (step > steps ? step : steps);
        }
        side = steps < side ? steps : side;
    }
    return (uint32_t)side;
}

static uint32_t define_word(const LsFilled* filled, const int at[3])
{
    uint32_t word = 0;
    for (uint32_t octant = 0; octant < 8; octant++)
    {
        word |= define_distance(filled, at, octant) << (4 * octant);
    }
    return word;
}

// Some blocks of a table with some cells in each; all words as the functions want them.
typedef struct LsTable
{
    uint32_t size[3];
    uint32_t words[MOST_BLOCKS];
    LsCellBlock cell_blocks[MOST_BLOCKS];
    uint32_t cell_block_count;
    LsFilled blocks, cells;
} LsTable;

static void fill_table(LsTable* table, LsRandom* random, const uint32_t size[3], uint32_t one_in)
{
    memset(table, 0, sizeof *table);
    memcpy(table->size, size, sizeof table->size);
    memset(table->words, 0xFF, sizeof table->words);
    memset(table->cell_blocks, 0xFF, sizeof table->cell_blocks);
    const uint32_t count = size[0] * size[1] * size[2];
    for (uint32_t i = 0; i < count; i++)
    {
        if (ls_random_below(random, one_in) != 0)
        {
            continue;
        }
        const uint32_t x = i % size[0], y = i / size[0] % size[1], z = i / size[0] / size[1];
        add_filled(&table->blocks, x, y, z);
        table->words[i] = table->cell_block_count << 4;
        uint32_t* cells = table->cell_blocks[table->cell_block_count++].cells;
        const uint32_t cell_count = 1 + ls_random_below(random, 4);
        for (uint32_t k = 0; k < cell_count; k++)
        {
            const uint32_t c = ls_random_below(random, LS_BLOCK_CELLS);
            cells[c] = k << 4;
            add_filled(&table->cells, 4 * x + (c & 3), 4 * y + (c >> 2 & 3), 4 * z + (c >> 4));
        }
    }
}

static void check_blocks(const LsTable* table)
{
    for (uint32_t i = 0; i < table->size[0] * table->size[1] * table->size[2]; i++)
    {
        const int at[3] = {(int)(i % table->size[0]), (int)(i / table->size[0] % table->size[1]),
                           (int)(i / table->size[0] / table->size[1])};
        const uint32_t word = define_word(&table->blocks, at);
        assert_int_equal(table->words[i] & 15 ? table->words[i] : 0, word);
    }
}

static void check_cells(const LsTable* table, uint64_t* cells)
{
    for (uint32_t i = 0; i < table->blocks.count; i++)
    {
        const int* block = table->blocks.at[i];
        for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
        {
            const int at[3] = {4 * block[0] + (int)(c & 3), 4 * block[1] + (int)(c >> 2 & 3),
                               4 * block[2] + (int)(c >> 4)};
            const uint32_t stored = table->cell_blocks[i].cells[c];
            assert_int_equal(stored & 15 ? stored : 0, define_word(&table->cells, at));
            (*cells)++;
        }
    }
}

static void distances_are_those_of_the_definition(void** state)
{
    (void)state;
    static const uint32_t sizes[][3] = {{1, 1, 1},  {12, 1, 1},   {1, 12, 2},
                                        {9, 11, 7}, {12, 12, 12}, {5, 6, 12}};
    static const uint32_t one_in[] = {1, 3, 20, 150};
    static LsTable table;
    LsRandom random = {77};
    uint64_t cells = 0;
    for (uint32_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    {
        for (uint32_t k = 0; k < sizeof one_in / sizeof *one_in; k++)
        {
            if (sizes[i][0] * sizes[i][1] * sizes[i][2] / one_in[k] > 400)
            {
                continue; // the definition is slow
            }
            fill_table(&table, &random, sizes[i], one_in[k]);
            assert_true(ls_block_distances(table.size, table.words, 2));
            assert_true(ls_cell_distances(table.size, table.words, table.cell_blocks,
                                          table.cell_block_count, 2));
            check_blocks(&table);
            check_cells(&table, &cells);
        }
    }
    assert_true(cells > 50000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_of_the_definition),
    };
    return cmocka_run_group_tests_name("distances", tests, NULL, NULL);
}
