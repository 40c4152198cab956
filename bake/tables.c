// tables.c - runs the shaft test over all voxels, chooses N where asked to, and packs the masks.

#include "tables.h"

#include "cost_model.h"
#include "ls_format.h"
#include "pages.h"
#include "voxel_masks.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

// Packs masks of 32 bits a shaft into `width` bits, one behind the other. Returns the number of
// masks that are not 0.
static uint64_t pack_masks(const uint32_t* masks, uint32_t count, uint32_t width, uint32_t* words)
{
    uint64_t filled = 0;
    uint64_t pending = 0; // bits that no word has yet, fewer than 32 before each mask
    uint32_t pending_count = 0;
    for (uint32_t i = 0; i < count; i++)
    {
        filled += masks[i] != 0;
        pending |= (uint64_t)masks[i] << pending_count;
        pending_count += width;
        if (pending_count >= 32)
        {
            *words++ = (uint32_t)pending;
            pending >>= 32;
            pending_count -= 32;
        }
    }
    if (pending_count > 0)
    {
        *words = (uint32_t)pending;
    }
    return filled;
}

// ---- One voxel ----------------------------------------------------------------------------------------

// A thread's own, and what all share.
typedef struct Worker
{
    const LsVoxels* voxels;
    const LsMesh* mesh;
    const LsPatchesChoice* choice;
    const LsShaftWeights* weights; // by N
    LsVoxelMasks masks;
    uint32_t* best; // LS_SHAFT_COUNT(choice->patches) words each
    uint32_t* current;
    uint32_t* next;
    uint32_t* gathered; // tables of a block whose words are not known beforehand; gathered_capacity
    uint64_t gathered_capacity;
} Worker;

static size_t count_mask_bytes(const LsPatchesChoice* choice)
{
    return sizeof(uint32_t) * LS_SHAFT_COUNT(choice->patches);
}

uint64_t ls_tables_words(const LsWorkVoxel* voxels, uint32_t count, uint32_t patches)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
    {
        sum += voxels[i].kind == LS_VOXEL_MASKS
                   ? ls_mask_words(LS_SHAFT_COUNT(patches), voxels[i].reference_count)
                   : 0;
    }
    return sum;
}

uint64_t ls_tables_work_bytes(const LsPatchesChoice* choice)
{
    return ls_shaft_scratch_bytes() + (choice->chosen ? 3 : 1) * (uint64_t)count_mask_bytes(choice);
}

static bool create_worker(Worker* worker)
{
    const size_t bytes = count_mask_bytes(worker->choice);
    const bool ok = ls_voxel_masks_create(&worker->masks, worker->voxels, worker->mesh);
    worker->best = malloc(bytes);
    worker->current = worker->choice->chosen ? malloc(bytes) : NULL;
    worker->next = worker->choice->chosen ? malloc(bytes) : NULL;
    return ok && worker->best != NULL &&
           (!worker->choice->chosen || (worker->current != NULL && worker->next != NULL));
}

static void destroy_worker(Worker* worker)
{
    ls_voxel_masks_destroy(&worker->masks);
    free(worker->best);
    free(worker->current);
    free(worker->next);
    free(worker->gathered);
}

static void swap_masks(uint32_t** a, uint32_t** b)
{
    uint32_t* before = *a;
    *a = *b;
    *b = before;
}

// Masks of N in `current`; those of 2, which 1 are made of, wait in `next`.
static void mark_next(Worker* worker, uint32_t patches)
{
    if (patches == 1 && worker->choice->patches > 1)
    {
        ls_voxel_masks_mark(&worker->masks, 2, worker->next);
        ls_voxel_masks_merge(worker->next, 2, worker->current);
    }
    else if (patches == 2)
    {
        swap_masks(&worker->current, &worker->next);
    }
    else
    {
        ls_voxel_masks_mark(&worker->masks, patches, worker->current);
    }
}

static double table_price(const Worker* worker, uint32_t patches, uint32_t count)
{
    return worker->choice->byte_price * sizeof(uint32_t) *
           (double)ls_mask_words(LS_SHAFT_COUNT(patches), count);
}

// Leaves the masks of the best N in `best`; N is 0 where none is worth its table.
static uint32_t choose_patches(Worker* worker, const LsWorkVoxel* voxel, double* tests)
{
    const uint32_t count = voxel->reference_count;
    const double visits = ls_voxel_visits(voxel);
    double least = visits * count, before = count;
    uint32_t best = 0;
    *tests = count;
    for (uint32_t n = 1; n <= worker->choice->patches; n++)
    {
        mark_next(worker, n);
        const double here = ls_shaft_tests(&worker->weights[n], worker->current);
        const double cost = visits * (LS_LOOKUP_COST + here) + table_price(worker, n, count);
        if (cost < least)
        {
            least = cost;
            best = n;
            *tests = here;
            swap_masks(&worker->best, &worker->current);
        }
        const double hope = visits * ls_expected_saving(n, before, here);
        const double step = table_price(worker, n + 1, count) - table_price(worker, n, count);
        if (n >= 2 && cost + step - hope >= least)
        {
            break;
        }
        before = here;
    }
    return best;
}

// Room for all tables of a block, at most `most` words; NULL when out of memory. Where N is given
// they all come, and go where they stay. Where it is chosen they are gathered first, since only
// then their size is known.
static uint32_t* reserve_words(Worker* worker, LsTableBlock* block, uint64_t most)
{
    if (!worker->choice->chosen)
    {
        return block->words = ls_pages_create(most * sizeof(uint32_t));
    }
    if (most > worker->gathered_capacity)
    {
        free(worker->gathered);
        worker->gathered = malloc(most * sizeof(uint32_t));
        worker->gathered_capacity = worker->gathered != NULL ? most : 0;
    }
    return worker->gathered;
}

// Gives a block the words that were gathered for it. False when out of memory.
static bool keep_gathered(const Worker* worker, LsTableBlock* block)
{
    const size_t bytes = block->word_count * sizeof(uint32_t);
    if (bytes == 0)
    {
        return true;
    }
    block->words = ls_pages_create(bytes);
    if (block->words == NULL)
    {
        return false;
    }
    memcpy(block->words, worker->gathered, bytes);
    return true;
}

// Appends the table of a voxel of kind MASKS to the block's `words`, or makes it a LIST. Its
// `table` counts from the first of them.
static void add_table(Worker* worker, LsTableBlock* block, uint32_t* words, LsWorkVoxel* voxel,
                      double* tests)
{
    ls_voxel_masks_begin(&worker->masks, voxel);
    uint32_t patches = worker->choice->patches;
    if (worker->choice->chosen)
    {
        patches = choose_patches(worker, voxel, tests);
    }
    else
    {
        ls_voxel_masks_mark(&worker->masks, patches, worker->best);
        *tests = ls_shaft_tests(&worker->weights[patches], worker->best);
    }
    if (patches == 0)
    {
        voxel->kind = LS_VOXEL_LIST;
        voxel->patches = voxel->table = 0;
        return;
    }
    const uint32_t shafts = LS_SHAFT_COUNT(patches);
    voxel->patches = patches;
    voxel->table = block->word_count;
    block->filled_count +=
        pack_masks(worker->best, shafts, voxel->reference_count, words + block->word_count);
    block->word_count += (uint32_t)ls_mask_words(shafts, voxel->reference_count);
    block->shaft_count += shafts;
}

// ---- All voxels ---------------------------------------------------------------------------------------

static bool fill_block(Worker* worker, LsTableBlock* block, LsWorkVoxel* first, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
    {
        if (first[i].kind == LS_VOXEL_LIST) // which another price may have made of it
        {
            first[i].kind = ls_voxel_kind(first[i].reference_count);
        }
    }
    const uint64_t most = ls_tables_words(first, count, worker->choice->patches);
    uint32_t* words = most > 0 ? reserve_words(worker, block, most) : NULL;
    if (most > 0 && words == NULL)
    {
        return false;
    }
    for (uint32_t i = 0; i < count; i++)
    {
        LsWorkVoxel* voxel = &first[i];
        double tests = voxel->reference_count;
        if (voxel->kind == LS_VOXEL_SUBGRID)
        {
            continue;
        }
        if (voxel->kind == LS_VOXEL_BVH)
        {
            tests = ls_leaf_bvh_tests(worker->voxels->leaf_nodes + voxel->table, voxel);
        }
        if (voxel->kind == LS_VOXEL_MASKS)
        {
            add_table(worker, block, words, voxel, &tests);
        }
        const double visits = ls_voxel_visits(voxel);
        block->visits += visits;
        block->lookups += voxel->kind == LS_VOXEL_MASKS ? visits : 0.0;
        block->tests += visits * tests;
    }
    return !worker->choice->chosen || keep_gathered(worker, block);
}

static LsResult check_words(uint64_t count, LsError* error)
{
    return count <= UINT32_MAX
               ? LS_OK
               : ls_error_set(error, LS_MESSAGE_LIMIT_RECORDS,
                              "the shaft tables of an object need %llu MiB, more than the format "
                              "holds; use fewer --patches",
                              (unsigned long long)(count >> 18));
}

// Puts the blocks one behind the other, in order, so that sums do not depend on threads.
static LsResult join_blocks(LsTables* tables, LsVoxels* voxels, LsError* error)
{
    uint64_t sum = 0;
    for (uint32_t b = 0; b < tables->block_count; b++)
    {
        const LsTableBlock* block = &tables->blocks[b];
        const uint32_t first = b * LS_TABLE_VOXELS;
        for (uint32_t i = first; i < voxels->voxel_count && i < first + LS_TABLE_VOXELS; i++)
        {
            LsWorkVoxel* voxel = &voxels->voxels[i];
            voxel->table += voxel->kind == LS_VOXEL_MASKS ? (uint32_t)sum : 0;
        }
        sum += block->word_count;
        tables->shaft_count += block->shaft_count;
        tables->filled_count += block->filled_count;
        tables->visits += block->visits;
        tables->lookups += block->lookups;
        tables->tests += block->tests;
    }
    tables->word_count = (uint32_t)sum;
    return check_words(sum, error);
}

// Fills all blocks; false when out of memory.
static bool fill_blocks(LsTables* tables, LsVoxels* voxels, const Worker* shared, uint32_t threads,
                        const LsStageProgress* progress)
{
    bool ok = true;
#pragma omp parallel num_threads(threads) reduction(&& : ok)
    {
        Worker worker = *shared;
        ok = create_worker(&worker);
#pragma omp for schedule(dynamic)
        for (uint32_t b = 0; b < tables->block_count; b++)
        {
            // Blocks go out in order, so the first thread's own says how far all are.
            if (omp_get_thread_num() == 0)
            {
                ls_stage_note(progress, (double)b / tables->block_count);
            }
            const uint32_t first = b * LS_TABLE_VOXELS;
            const uint32_t left = voxels->voxel_count - first;
            ok = ok && fill_block(&worker, &tables->blocks[b], voxels->voxels + first,
                                  left < LS_TABLE_VOXELS ? left : LS_TABLE_VOXELS);
        }
        destroy_worker(&worker);
    }
    return ok;
}

LsResult ls_tables_create(LsTables* tables, LsVoxels* voxels, const LsMesh* mesh,
                          const LsPatchesChoice* choice, const LsShaftWeights* weights,
                          uint32_t threads, const LsStageProgress* progress, LsError* error)
{
    // What is known beforehand is refused before the work.
    *tables = (LsTables){0};
    const uint64_t words = ls_tables_words(voxels->voxels, voxels->voxel_count, choice->patches);
    LsResult result = choice->chosen ? LS_OK : check_words(words, error);
    if (result != LS_OK)
    {
        return result;
    }
    tables->block_count = voxels->voxel_count / LS_TABLE_VOXELS + 1;
    tables->blocks = calloc(tables->block_count, sizeof *tables->blocks);
    const Worker shared = {.voxels = voxels, .mesh = mesh, .choice = choice, .weights = weights};
    const bool ok =
        tables->blocks != NULL && fill_blocks(tables, voxels, &shared, threads, progress);
    result = ok ? join_blocks(tables, voxels, error)
                : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                               "out of memory for the table of shafts; use fewer --patches");
    if (result != LS_OK)
    {
        ls_tables_destroy(tables);
    }
    return result;
}

void ls_table_block_destroy(LsTableBlock* block)
{
    ls_pages_destroy(block->words, block->word_count * sizeof(uint32_t));
    block->words = NULL;
}

void ls_tables_destroy(LsTables* tables)
{
    for (uint32_t b = 0; tables->blocks != NULL && b < tables->block_count; b++)
    {
        ls_table_block_destroy(&tables->blocks[b]);
    }
    free(tables->blocks);
    *tables = (LsTables){0};
}
