// scene_shafts.c - signatures by counting filled cells in boxes.
//
// The points at the same fraction f of the ways from box A to box B fill a box, whose corners are
// A's and B's mixed by f. So each axis has its own range of cells for each piece of the way, found
// once for all pairs of places on that axis; and whether a box of cells is empty is told by eight
// sums (F. C. Crow, "Summed-Area Tables for Texture Mapping", SIGGRAPH 1984, in three dimensions).

#include "scene_shafts.h"

#include "ls_format.h"

#include <math.h>
#include <stdlib.h>

// An interval is looked at in so many pieces, for the box around a slanted piece holds more than
// the piece.
#define PIECES 2
#define PIECE_COUNT (PIECES * LS_SIGNATURE_INTERVALS)

// Sides of the table of sums: cells of larger grids are joined.
#define MAX_SIDE 256

// Places along an axis: the M patches, then the low and the high face.
#define PLACE_COUNT(patches) ((patches) + 2)

// Joined cells from `low` up to but without `high`.
typedef struct Range
{
    uint16_t low, high;
} Range;

typedef struct Work
{
    uint32_t* sums;    // of filled joined cells below (x, y, z), sizes[] + 1 along each axis
    uint32_t sizes[3]; // in joined cells
    uint32_t join_log2;
    Range* ranges[3]; // [place of A][place of B][piece]
    uint32_t patches;
} Work;

static uint32_t find_join(const LsGridFrame* frame)
{
    uint32_t join_log2 = 0;
    for (int axis = 0; axis < 3; axis++)
    {
        while ((frame->cells[axis] - 1) >> join_log2 >= MAX_SIDE)
        {
            join_log2++;
        }
    }
    return join_log2;
}

static uint64_t count_sums(const LsGridFrame* frame)
{
    uint64_t count = 1;
    for (int axis = 0; axis < 3; axis++)
    {
        count *= ((frame->cells[axis] - 1) >> find_join(frame)) + 2;
    }
    return count;
}

static uint64_t count_ranges(uint32_t patches)
{
    return (uint64_t)PLACE_COUNT(patches) * PLACE_COUNT(patches) * PIECE_COUNT;
}

uint64_t ls_scene_shafts_need(const LsGridFrame* frame, uint32_t patches)
{
    return count_sums(frame) * sizeof(uint32_t) + 3 * count_ranges(patches) * sizeof(Range) +
           LS_SHAFT_COUNT((uint64_t)patches) * sizeof(uint32_t);
}

static size_t find_sum(const Work* work, uint32_t x, uint32_t y, uint32_t z)
{
    const size_t row = work->sizes[0] + 1, slice = row * (work->sizes[1] + 1);
    return x + row * y + slice * z;
}

static void add_up(Work* work, const LsVoxels* voxels)
{
    for (uint32_t i = 0; i < voxels->voxel_count; i++)
    {
        const LsWorkVoxel* voxel = &voxels->voxels[i];
        if (voxel->level == 0)
        {
            work->sums[find_sum(work, (voxel->cell[0] >> work->join_log2) + 1,
                                (voxel->cell[1] >> work->join_log2) + 1,
                                (voxel->cell[2] >> work->join_log2) + 1)] = 1;
        }
    }
    const size_t steps[3] = {find_sum(work, 1, 0, 0), find_sum(work, 0, 1, 0),
                             find_sum(work, 0, 0, 1)};
    for (int axis = 0; axis < 3; axis++)
    {
        for (uint32_t z = 1; z <= work->sizes[2]; z++)
        {
            for (uint32_t y = 1; y <= work->sizes[1]; y++)
            {
                for (uint32_t x = 1; x <= work->sizes[0]; x++)
                {
                    const size_t at = find_sum(work, x, y, z);
                    work->sums[at] += work->sums[at - steps[axis]];
                }
            }
        }
    }
}

static void find_place(uint32_t place, uint32_t patches, double cells, double* low, double* high)
{
    const bool is_patch = place < patches;
    *low = is_patch ? cells * place / patches : place == patches ? 0.0 : cells;
    *high = is_patch ? cells * (place + 1) / patches : *low;
}

static uint16_t clamp_cell(double cell, uint32_t size)
{
    return (uint16_t)(cell < 0.0 ? 0 : cell > size ? size : (uint32_t)cell);
}

// For one axis. Ranges hold every cell that, grown by 2 bounds, meets the patches' mix, which grows
// by as much.
static void fill_ranges(Work* work, int axis, const LsGridFrame* frame)
{
    const uint32_t places = PLACE_COUNT(work->patches);
    const double cells = frame->cells[axis], grow = 4.0 * frame->bound;
    const double inverse = 1.0 / (double)(1u << work->join_log2);
    Range* range = work->ranges[axis];
    for (uint32_t pair = 0; pair < places * places; pair++)
    {
        double a[2], b[2];
        find_place(pair / places, work->patches, cells, &a[0], &a[1]);
        find_place(pair % places, work->patches, cells, &b[0], &b[1]);
        for (int piece = 0; piece < PIECE_COUNT; piece++)
        {
            const double from = (double)piece / PIECE_COUNT, to = (piece + 1.0) / PIECE_COUNT;
            const double low = fmin(a[0] + from * (b[0] - a[0]), a[0] + to * (b[0] - a[0])) - grow;
            const double high = fmax(a[1] + from * (b[1] - a[1]), a[1] + to * (b[1] - a[1])) + grow;
            range->low = clamp_cell(floor(low * inverse), work->sizes[axis]);
            range->high = clamp_cell(floor(high * inverse) + 1.0, work->sizes[axis]);
            range++;
        }
    }
}

static bool is_filled(const Work* work, Range x, Range y, Range z)
{
    const size_t row = work->sizes[0] + 1, slice = row * (work->sizes[1] + 1);
    const size_t y_low = row * y.low, y_high = row * y.high;
    const uint32_t* low = work->sums + slice * z.low;
    const uint32_t* high = work->sums + slice * z.high;
    const uint32_t upto_low =
        low[y_high + x.high] - low[y_high + x.low] - low[y_low + x.high] + low[y_low + x.low];
    const uint32_t upto_high =
        high[y_high + x.high] - high[y_high + x.low] - high[y_low + x.high] + high[y_low + x.low];
    return upto_high != upto_low;
}

// The place along `axis` of a patch on a face.
static uint32_t find_patch_place(uint32_t face, uint32_t patch, uint32_t axis, uint32_t patches)
{
    const uint32_t of_face = face >> 1;
    return axis == of_face             ? patches + (face & 1)
           : axis == (of_face + 1) % 3 ? patch / patches
                                       : patch % patches;
}

static uint32_t make_signature(const Work* work, const Range* const ranges[3])
{
    uint32_t word = 0;
    for (int piece = 0; piece < PIECE_COUNT; piece++)
    {
        const uint32_t bit = 1u << piece / PIECES;
        if ((word & bit) == 0 &&
            is_filled(work, ranges[0][piece], ranges[1][piece], ranges[2][piece]))
        {
            word |= bit;
        }
    }
    return word;
}

// All shafts of a patch to those of another face. Returns how many are filled.
static uint64_t make_row(const Work* work, uint32_t face_a, uint32_t patch_a, uint32_t face_b,
                         uint32_t* words)
{
    const uint32_t patches = work->patches, places = PLACE_COUNT(patches);
    uint64_t filled = 0;
    for (uint32_t patch_b = 0; patch_b < patches * patches; patch_b++)
    {
        const Range* ranges[3];
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            const uint32_t a = find_patch_place(face_a, patch_a, axis, patches);
            const uint32_t b = find_patch_place(face_b, patch_b, axis, patches);
            ranges[axis] = work->ranges[axis] + (size_t)(a * places + b) * PIECE_COUNT;
        }
        words[patch_b] = make_signature(work, ranges);
        filled += words[patch_b] != 0;
    }
    return filled;
}

static uint64_t make_signatures(const Work* work, uint32_t* words, uint32_t threads)
{
    uint32_t faces[15][2], pair_count = 0;
    for (uint32_t a = 0; a < 6; a++)
    {
        for (uint32_t b = a + 1; b < 6; b++)
        {
            faces[pair_count][0] = a;
            faces[pair_count++][1] = b;
        }
    }
    const uint32_t count = work->patches * work->patches;
    uint64_t filled = 0;
#pragma omp parallel for num_threads(threads) schedule(dynamic, 8) reduction(+ : filled)
    for (uint32_t row = 0; row < 15 * count; row++)
    {
        const uint32_t* pair = faces[row / count];
        filled += make_row(work, pair[0], row % count, pair[1], words + (size_t)row * count);
    }
    return filled;
}

LsResult ls_scene_shafts_create(LsSceneShafts* shafts, const LsVoxels* voxels, uint32_t patches,
                                uint32_t threads, LsError* error)
{
    *shafts = (LsSceneShafts){.patches = patches, .word_count = LS_SHAFT_COUNT(patches)};
    Work work = {.join_log2 = find_join(&voxels->frame), .patches = patches};
    shafts->words = malloc(shafts->word_count * sizeof *shafts->words);
    work.sums = calloc(count_sums(&voxels->frame), sizeof *work.sums);
    bool ok = shafts->words != NULL && work.sums != NULL;
    for (int axis = 0; axis < 3; axis++)
    {
        work.sizes[axis] = ((voxels->frame.cells[axis] - 1) >> work.join_log2) + 1;
        work.ranges[axis] = malloc(count_ranges(patches) * sizeof(Range));
        ok = ok && work.ranges[axis] != NULL;
    }
    if (ok)
    {
        add_up(&work, voxels);
        for (int axis = 0; axis < 3; axis++)
        {
            fill_ranges(&work, axis, &voxels->frame);
        }
        shafts->filled_count = make_signatures(&work, shafts->words, threads);
    }
    for (int axis = 0; axis < 3; axis++)
    {
        free(work.ranges[axis]);
    }
    free(work.sums);
    if (!ok)
    {
        ls_scene_shafts_destroy(shafts);
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "out of memory for the scene's shafts");
    }
    return LS_OK;
}

void ls_scene_shafts_destroy(LsSceneShafts* shafts)
{
    free(shafts->words);
    *shafts = (LsSceneShafts){0};
}
