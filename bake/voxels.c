// voxels.c - count, prefix sum, fill; then sub-grids, distances, order.

#include "voxels.h"

#include "bvh.h"
#include "copies.h"
#include "cost_model.h"
#include "distances.h"
#include "overlap.h"
#include "subdivide.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LINKS (1u << 28) // an index has 28 bits

// A grid is crowded if its cells together hold more references than this for each triangle, and
// more than that for each filled cell: triangles lie through each other, and finer cells hold
// hardly fewer of them. Such a grid is halved until it is not, which bounds time and memory. Meshes
// of one surface hold 1.2 to 3 a triangle, or if their triangles span many cells 1 to 3 a cell. A
// surface fills about as many cells as the box's faces have; where triangles fill the box, so many
// times as many count, since to give each its own cells takes memory by the cube of the grid.
#define CROWDED_TRIANGLE 16
#define CROWDED_CELL 8
#define CROWDED_FACES 4

// With its sub-grids an object may hold so many times as many.
#define CROWDED_SUBGRIDS 2

// How far the stage is when voxels begin and end to be divided; this and the table in `run` are
// measured on a scanned model (the Stanford dragon, 512 cells).
#define DIVIDE_BEGIN 0.45
#define DIVIDE_END 0.85

static LsOverlap prepare_triangle(const LsGridFrame* frame, const LsTriangle* triangle)
{
    double corners[3][3];
    ls_grid_point(frame, triangle->v0, corners[0]);
    ls_grid_point(frame, triangle->v1, corners[1]);
    ls_grid_point(frame, triangle->v2, corners[2]);
    return ls_overlap_prepare(corners);
}

// Visits the cells of a level that a triangle touches, each grown by e.
typedef struct Visit
{
    const LsOverlap* triangle;
    double size; // of a cell, in cells of the grid
    double grow;
    void (*cell)(struct Visit* visit, uint32_t x, uint32_t y, uint32_t z);
    struct Build* build;
    uint32_t triangle_index;
    uint32_t count; // of cells visited
} Visit;

static bool range_touches(const Visit* visit, const int low[3], const int high[3])
{
    double centre[3], half[3];
    for (int axis = 0; axis < 3; axis++)
    {
        centre[axis] = 0.5 * (low[axis] + high[axis]) * visit->size;
        half[axis] = 0.5 * (high[axis] - low[axis]) * visit->size + visit->grow;
    }
    return ls_overlap_box(visit->triangle, centre, half);
}

// Halves the range [low, high) along its longest side until single cells remain, so that the work
// follows the triangle's area and not its bounding box.
static void visit_range(Visit* visit, const int low[3], const int high[3])
{
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
    {
        longest = high[axis] - low[axis] > high[longest] - low[longest] ? axis : longest;
    }
    if (!range_touches(visit, low, high))
    {
        return;
    }
    if (high[longest] - low[longest] == 1)
    {
        visit->cell(visit, (uint32_t)low[0], (uint32_t)low[1], (uint32_t)low[2]);
        visit->count++;
        return;
    }
    int middle = (low[longest] + high[longest]) / 2;
    int low_end[3] = {high[0], high[1], high[2]}, high_begin[3] = {low[0], low[1], low[2]};
    low_end[longest] = middle;
    high_begin[longest] = middle;
    visit_range(visit, low, low_end);
    visit_range(visit, high_begin, high);
}

static void visit_triangle(Visit* visit, const uint32_t limits[3])
{
    int low[3], high[3];
    for (int axis = 0; axis < 3; axis++)
    {
        double begin = floor((visit->triangle->lower[axis] - visit->grow) / visit->size);
        double end = floor((visit->triangle->upper[axis] + visit->grow) / visit->size) + 1.0;
        low[axis] = begin > 0.0 ? (int)begin : 0;
        high[axis] = end < limits[axis] ? (int)end : (int)limits[axis];
    }
    visit_range(visit, low, high);
}

// The work of one voxelization.
typedef struct Build
{
    LsVoxels* out;
    const LsMesh* mesh;
    const LsDivisionRule* rule;
    uint32_t threads;
    const LsStageProgress* progress;
    double grow;
    uint8_t* copies;     // of ls_find_copies; voxels do not list them
    uint64_t visited;    // cells of triangles in the last visit, at least `most` if it was given up
    uint64_t most;       // a visit gives up after so many
    bool may_be_crowded; // it has one cell and cannot be halved
    bool crowded;        // see CROWDED_TRIANGLE
    uint32_t blocks[3];  // blocks per axis
    uint32_t grid_blocks; // cell blocks of the grid itself
    uint32_t* counts;     // references per cell of the cell blocks, then fill positions
    uint32_t* first;      // first reference per cell
    uint64_t grid_references;
    uint32_t* references; // of the grid's voxels, before subdivision
    LsSubtree* subtrees;  // of the grid's voxels, in their order
    uint32_t subtree_count;
} Build;

static uint32_t block_index(const Build* build, uint32_t x, uint32_t y, uint32_t z)
{
    return x + build->blocks[0] * (y + build->blocks[1] * z);
}

static void mark_block(Visit* visit, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t* word = &visit->build->out->blocks[block_index(visit->build, x, y, z)];
#pragma omp atomic write
    *word = 0;
}

static uint32_t cell_slot(const Build* build, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t block = build->out->blocks[block_index(build, x >> 2, y >> 2, z >> 2)] >> 4;
    return block * LS_BLOCK_CELLS + (x & 3) + 4 * (y & 3) + 16 * (z & 3);
}

static void count_cell(Visit* visit, uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t* count = &visit->build->counts[cell_slot(visit->build, x, y, z)];
#pragma omp atomic
    (*count)++;
}

static void fill_cell(Visit* visit, uint32_t x, uint32_t y, uint32_t z)
{
    Build* build = visit->build;
    uint32_t* position = &build->counts[cell_slot(build, x, y, z)];
    uint32_t at;
#pragma omp atomic capture
    at = (*position)++;
    build->references[at] = visit->triangle_index;
}

static void visit_all(Build* build, double size, const uint32_t limits[3],
                      void (*cell)(Visit*, uint32_t, uint32_t, uint32_t))
{
    const LsMesh* mesh = build->mesh;
    build->visited = 0;
#pragma omp parallel for schedule(dynamic, 64) num_threads(build->threads)
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        uint64_t visited;
#pragma omp atomic read
        visited = build->visited;
        if (build->copies[i] || visited >= build->most)
        {
            continue;
        }
        LsOverlap triangle = prepare_triangle(&build->out->frame, &mesh->triangles[i]);
        Visit visit = {.triangle = &triangle,
                       .size = size,
                       .grow = build->grow,
                       .cell = cell,
                       .build = build,
                       .triangle_index = i};
        visit_triangle(&visit, limits);
#pragma omp atomic
        build->visited += visit.count;
    }
}

static int compare_words(const void* a, const void* b)
{
    uint32_t x = *(const uint32_t*)a, y = *(const uint32_t*)b;
    return (x > y) - (x < y);
}

// Insertion for the usual short lists.
static void sort_words(uint32_t* words, uint32_t count)
{
    if (count > 64)
    {
        qsort(words, count, sizeof *words, compare_words);
        return;
    }
    for (uint32_t i = 1; i < count; i++)
    {
        uint32_t word = words[i];
        uint32_t j = i;
        for (; j > 0 && words[j - 1] > word; j--)
        {
            words[j] = words[j - 1];
        }
        words[j] = word;
    }
}

static LsResult report_memory(LsError* error)
{
    return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                        "out of memory for the voxels; use a coarser --grid");
}

static LsResult report_limit(LsError* error, const char* what)
{
    return ls_error_set(error, LS_MESSAGE_LIMIT_RECORDS,
                        "an object has more %s than the format counts; use a coarser --grid", what);
}

// Finds the blocks that hold anything and numbers them in order.
static LsResult find_blocks(Build* build, LsError* error)
{
    LsVoxels* out = build->out;
    uint64_t count = 1;
    for (int axis = 0; axis < 3; axis++)
    {
        build->blocks[axis] = (out->frame.cells[axis] + 3) / 4;
        count *= build->blocks[axis];
    }
    out->block_count = (uint32_t)count;
    out->blocks = malloc(sizeof(uint32_t) * count);
    if (out->blocks == NULL)
    {
        return report_memory(error);
    }
    memset(out->blocks, 0xFF, sizeof(uint32_t) * count);
    visit_all(build, LS_BLOCK_SIDE, build->blocks, mark_block);
    for (uint64_t i = 0; i < count; i++)
    {
        if (out->blocks[i] != LS_NONE)
        {
            out->blocks[i] = build->grid_blocks++ << 4;
        }
    }
    // Cell slots must fit 32 bits as well.
    return build->grid_blocks < (1u << 26) ? LS_OK : report_limit(error, "filled blocks");
}

// References that a grid of so many filled cells may hold and not be crowded.
static uint64_t count_bearable(const LsMesh* mesh, const LsGridFrame* frame, uint64_t filled)
{
    const uint64_t x = frame->cells[0], y = frame->cells[1], z = frame->cells[2];
    const uint64_t faces = CROWDED_FACES * 2 * (x * y + y * z + z * x);
    const uint64_t by_triangles = CROWDED_TRIANGLE * (uint64_t)mesh->triangle_count;
    const uint64_t by_cells = CROWDED_CELL * (filled < faces ? filled : faces);
    return by_triangles > by_cells ? by_triangles : by_cells;
}

// Counts, sums and fills the references of the grid's cells.
static LsResult fill_cells(Build* build, LsError* error)
{
    size_t slots = (size_t)build->grid_blocks * LS_BLOCK_CELLS;
    const uint32_t* cells = build->out->frame.cells;
    build->counts = calloc(slots, sizeof(uint32_t));
    build->first = malloc((slots + 1) * sizeof(uint32_t));
    if (build->counts == NULL || build->first == NULL)
    {
        return report_memory(error);
    }
    // Beyond this the grid is crowded, whatever the number of filled cells.
    build->most = build->may_be_crowded
                      ? UINT64_MAX
                      : count_bearable(build->mesh, &build->out->frame, slots) + 1;
    visit_all(build, 1.0, cells, count_cell);
    uint64_t sum = 0, filled = 0;
    for (size_t i = 0; i < slots; i++)
    {
        filled += build->counts[i] != 0;
        build->first[i] = (uint32_t)sum;
        sum += build->counts[i];
        build->counts[i] = build->first[i];
    }
    build->first[slots] = (uint32_t)sum;
    build->grid_references = sum;
    build->crowded =
        !build->may_be_crowded && sum > count_bearable(build->mesh, &build->out->frame, filled);
    build->most = UINT64_MAX;
    if (build->crowded)
    {
        return LS_OK;
    }
    if (sum > UINT32_MAX)
    {
        return report_limit(error, "references");
    }
    build->references = malloc((sum + 1) * sizeof(uint32_t));
    if (build->references == NULL)
    {
        return report_memory(error);
    }
    visit_all(build, 1.0, cells, fill_cell);
    return LS_OK;
}

// Places the grid's voxels in the order of their cells.
static LsResult list_grid_voxels(Build* build, LsError* error)
{
    LsVoxels* out = build->out;
    size_t slots = (size_t)build->grid_blocks * LS_BLOCK_CELLS;
    for (size_t i = 0; i < slots; i++)
    {
        out->voxel_count += build->first[i + 1] > build->first[i];
    }
    if (out->voxel_count >= MAX_LINKS)
    {
        return report_limit(error, "voxels");
    }
    out->voxels = calloc(out->voxel_count + 1, sizeof(LsWorkVoxel));
    build->subtrees = calloc(out->voxel_count + 1, sizeof(LsSubtree));
    if (out->voxels == NULL || build->subtrees == NULL)
    {
        return report_memory(error);
    }
    build->subtree_count = out->voxel_count;
    uint32_t voxel = 0;
    for (uint32_t z = 0; z < build->blocks[2]; z++)
    {
        for (uint32_t y = 0; y < build->blocks[1]; y++)
        {
            for (uint32_t x = 0; x < build->blocks[0]; x++)
            {
                uint32_t word = out->blocks[block_index(build, x, y, z)];
                if (word == LS_NONE)
                {
                    continue;
                }
                for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
                {
                    size_t slot = (size_t)(word >> 4) * LS_BLOCK_CELLS + c;
                    if (build->first[slot + 1] == build->first[slot])
                    {
                        continue;
                    }
                    out->voxels[voxel++] = (LsWorkVoxel){
                        .cell = {4 * x + (c & 3), 4 * y + (c >> 2 & 3), 4 * z + (c >> 4)},
                        .first_reference = build->first[slot],
                        .reference_count = build->first[slot + 1] - build->first[slot]};
                }
            }
        }
    }
    return LS_OK;
}

// Sorts each voxel's list, so that the order of filling is forgotten, and divides the crowded ones.
static LsResult divide_voxels(Build* build, LsError* error)
{
    LsVoxels* out = build->out;
    // Voxels share evenly in what the object may hold.
    const double growth = CROWDED_SUBGRIDS *
                          (double)count_bearable(build->mesh, &out->frame, out->voxel_count) /
                          ((double)build->grid_references + 1.0);
    LsDivisionRule rule = *build->rule;
    rule.price /= ls_cell_visits(&out->frame);
    bool ok = true;
#pragma omp parallel for schedule(dynamic, 16) num_threads(build->threads) reduction(&& : ok)
    for (uint32_t i = 0; i < out->voxel_count; i++)
    {
        // Voxels go out in order, so the first thread's own says how far all are.
        if (omp_get_thread_num() == 0 && i % 16 == 0)
        {
            ls_stage_note(build->progress,
                          DIVIDE_BEGIN + (DIVIDE_END - DIVIDE_BEGIN) * i / out->voxel_count);
        }
        LsWorkVoxel* voxel = &out->voxels[i];
        uint32_t* references = build->references + voxel->first_reference;
        sort_words(references, voxel->reference_count);
        const uint64_t most = (uint64_t)(growth * voxel->reference_count);
        ok = ok && ls_subtree_create(&build->subtrees[i], voxel, build->mesh, &out->frame, &rule,
                                     most, references);
    }
    return ok ? LS_OK : report_memory(error);
}

// Puts the grid's voxels and the sub-grids behind them into one set of arrays.
static LsResult join_subtrees(Build* build, LsError* error)
{
    LsVoxels* out = build->out;
    uint32_t grid_voxels = out->voxel_count;
    uint64_t blocks = build->grid_blocks, voxels = grid_voxels, references = 0, leaf_nodes = 0,
             subgrids = 0;
    for (uint32_t i = 0; i < grid_voxels; i++)
    {
        const LsSubtree* tree = &build->subtrees[i];
        subgrids += tree->block_count;
        voxels += tree->voxel_count;
        references += tree->reference_count + out->voxels[i].reference_count;
        leaf_nodes += tree->leaf_node_count;
    }
    blocks += subgrids;
    if (blocks >= MAX_LINKS || voxels >= MAX_LINKS || references > UINT32_MAX ||
        leaf_nodes > UINT32_MAX)
    {
        return report_limit(error, "voxels");
    }
    out->cell_block_count = (uint32_t)blocks;
    out->subgrid_count = (uint32_t)subgrids;
    out->leaf_node_count = (uint32_t)leaf_nodes;
    out->cell_blocks = malloc((blocks + 1) * sizeof(LsCellBlock));
    out->subgrids = malloc((subgrids + 1) * sizeof(uint32_t));
    out->references = malloc((references + 1) * sizeof(uint32_t));
    out->leaf_nodes = malloc((leaf_nodes + 1) * sizeof(LsBvhNode));
    const bool is_told = build->rule->is_weighed && build->rule->price == 0.0;
    out->divisions = is_told ? malloc((subgrids + 1) * sizeof(LsDivision)) : NULL;
    LsWorkVoxel* all = realloc(out->voxels, (voxels + 1) * sizeof(LsWorkVoxel));
    out->voxels = all != NULL ? all : out->voxels;
    if (out->cell_blocks == NULL || out->subgrids == NULL || out->references == NULL ||
        out->leaf_nodes == NULL || (is_told && out->divisions == NULL) || all == NULL)
    {
        return report_memory(error);
    }

    // The grid's own voxels: their links, references and BVHs. Words of empty cells are all ones.
    memset(out->cell_blocks, 0xFF, build->grid_blocks * sizeof(LsCellBlock));
    uint32_t leaf_node = 0;
    for (uint32_t i = 0; i < grid_voxels; i++)
    {
        LsWorkVoxel* voxel = &out->voxels[i];
        const LsSubtree* tree = &build->subtrees[i];
        const uint32_t* cell = voxel->cell;
        uint32_t slot = cell_slot(build, cell[0], cell[1], cell[2]);
        out->cell_blocks[slot / LS_BLOCK_CELLS].cells[slot % LS_BLOCK_CELLS] = i << 4;
        memcpy(out->references + out->reference_count, build->references + voxel->first_reference,
               sizeof(uint32_t) * voxel->reference_count);
        voxel->first_reference = out->reference_count;
        out->reference_count += voxel->reference_count;
        if (voxel->kind == LS_VOXEL_BVH)
        {
            voxel->table = leaf_node;
            memcpy(out->leaf_nodes + leaf_node, tree->leaf_nodes,
                   sizeof(LsBvhNode) * tree->leaf_node_count);
            leaf_node += tree->leaf_node_count;
        }
    }

    // Sub-grids, each tree's blocks and voxels behind those before.
    uint32_t block = build->grid_blocks;
    out->voxel_count = grid_voxels;
    for (uint32_t i = 0; i < grid_voxels; i++)
    {
        LsSubtree* tree = &build->subtrees[i];
        if (out->voxels[i].kind != LS_VOXEL_SUBGRID)
        {
            continue;
        }
        const uint32_t* cell = out->voxels[i].cell;
        uint32_t parent = cell_slot(build, cell[0], cell[1], cell[2]) / LS_BLOCK_CELLS;
        out->voxels[i].table = block;
        for (uint32_t b = 0; b < tree->block_count; b++)
        {
            LsCellBlock* words = &out->cell_blocks[block + b];
            *words = tree->blocks[b];
            for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
            {
                bool link = (words->cells[c] & 15) == 0;
                words->cells[c] += link ? out->voxel_count << 4 : 0;
            }
            uint32_t above = tree->parents[b];
            const uint32_t subgrid = block + b - build->grid_blocks;
            out->subgrids[subgrid] = above == LS_NONE ? parent : block + above;
            if (is_told)
            {
                out->divisions[subgrid] = tree->divisions[b];
                out->divisions[subgrid].parent = above == LS_NONE ? LS_NONE : subgrid - b + above;
            }
        }
        for (uint32_t v = 0; v < tree->voxel_count; v++)
        {
            LsWorkVoxel voxel = tree->voxels[v];
            voxel.first_reference += out->reference_count;
            voxel.table += voxel.kind == LS_VOXEL_SUBGRID
                               ? block
                               : (voxel.kind == LS_VOXEL_BVH ? leaf_node : 0);
            out->depth = voxel.level > out->depth ? voxel.level : out->depth;
            out->voxels[out->voxel_count + v] = voxel;
        }
        if (tree->reference_count > 0)
        {
            memcpy(out->references + out->reference_count, tree->references,
                   sizeof(uint32_t) * tree->reference_count);
        }
        if (tree->leaf_node_count > 0)
        {
            memcpy(out->leaf_nodes + leaf_node, tree->leaf_nodes,
                   sizeof(LsBvhNode) * tree->leaf_node_count);
        }
        block += tree->block_count;
        out->voxel_count += tree->voxel_count;
        out->reference_count += tree->reference_count;
        leaf_node += tree->leaf_node_count;
    }
    return LS_OK;
}

// Distances of all empty cells and blocks.
static LsResult fill_distances(Build* build, LsError* error)
{
    LsVoxels* out = build->out;
    const uint32_t* cells = out->frame.cells;
    if (!ls_block_distances(build->blocks, out->blocks, build->threads) ||
        !ls_cell_distances(build->blocks, out->blocks, out->cell_blocks, build->grid_blocks,
                           build->threads))
    {
        return report_memory(error);
    }
    // What of a border block lies outside the grid is empty; no ray asks how far.
    for (uint32_t i = 0; i < out->block_count; i++)
    {
        uint32_t word = out->blocks[i];
        if ((word & 15) != 0)
        {
            continue;
        }
        uint32_t x = i % build->blocks[0], y = i / build->blocks[0] % build->blocks[1];
        uint32_t z = i / build->blocks[0] / build->blocks[1];
        for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
        {
            if (4 * x + (c & 3) >= cells[0] || 4 * y + (c >> 2 & 3) >= cells[1] ||
                4 * z + (c >> 4) >= cells[2])
            {
                out->cell_blocks[word >> 4].cells[c] = 0x11111111u;
            }
        }
    }
    return LS_OK;
}

static LsResult run(Build* build, LsError* error)
{
    static const struct
    {
        LsResult (*run)(Build*, LsError*);
        double end;
    } steps[] = {
        {find_blocks, 0.1},          {fill_cells, DIVIDE_BEGIN}, {list_grid_voxels, DIVIDE_BEGIN},
        {divide_voxels, DIVIDE_END}, {join_subtrees, 0.87},      {fill_distances, 1.0}};
    LsResult result = LS_OK;
    for (size_t i = 0; i < sizeof steps / sizeof *steps && result == LS_OK && !build->crowded; i++)
    {
        result = steps[i].run(build, error);
        ls_stage_note(build->progress, steps[i].end);
    }
    return result;
}

// References that a grid will hold, on average over where its cells begin: by Steiner's formula for
// boxes a convex body in the plane meets 1 cell, and one for each cell of its extents along the
// axes and of the areas of its projections along them.
static double expect_references(const LsMesh* mesh, const uint8_t* copies, const LsGridFrame* frame,
                                uint32_t threads)
{
    // Summed as whole numbers, in hundredths, so that the sum does not depend on threads.
    uint64_t sum = 0;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(+ : sum)
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        const LsOverlap triangle = prepare_triangle(frame, &mesh->triangles[i]);
        double expected = 1.0;
        for (int axis = 0; axis < 3; axis++)
        {
            expected += triangle.upper[axis] - triangle.lower[axis];
            expected += 0.5 * fabs(triangle.normal[axis]);
        }
        sum += copies[i] ? 0 : (uint64_t)(100.0 * expected);
    }
    return 0.01 * (double)sum;
}

// Whether a grid will be crowded, were all of its cells filled, or hold more than the format
// counts. Found out without a visit to its cells, which may be very many.
static bool must_be_crowded(const LsMesh* mesh, const uint8_t* copies, uint32_t grid,
                            uint32_t threads)
{
    const LsGridFrame frame = ls_grid_frame(mesh, grid);
    const uint64_t cells = (uint64_t)frame.cells[0] * frame.cells[1] * frame.cells[2];
    const double expected = expect_references(mesh, copies, &frame, threads);
    return expected > UINT32_MAX || expected > (double)count_bearable(mesh, &frame, cells);
}

// One attempt. *crowded tells that the grid is to be halved; voxels is then empty.
static LsResult try_grid(LsVoxels* voxels, const LsMesh* mesh, uint32_t grid,
                         const LsDivisionRule* rule, uint8_t* copies, uint32_t threads,
                         const LsStageProgress* progress, bool* crowded, LsError* error)
{
    *voxels = (LsVoxels){.frame = ls_grid_frame(mesh, grid)};
    voxels->frame.depth =
        voxels->frame.depth < rule->most_depth ? voxels->frame.depth : rule->most_depth;
    // The slack keeps the rounding of double on the safe side of e.
    Build build = {.out = voxels,
                   .mesh = mesh,
                   .rule = rule,
                   .threads = threads,
                   .progress = progress,
                   .grow = voxels->frame.bound * (1.0 + 1e-6),
                   .copies = copies,
                   .most = UINT64_MAX,
                   .may_be_crowded = grid == 1};
    LsResult result = run(&build, error);
    for (uint32_t i = 0; i < build.subtree_count; i++)
    {
        ls_subtree_destroy(&build.subtrees[i]);
    }
    free(build.counts);
    free(build.first);
    free(build.references);
    free(build.subtrees);
    *crowded = build.crowded;
    if (result != LS_OK || build.crowded)
    {
        ls_voxels_destroy(voxels);
    }
    return result;
}

LsResult ls_voxels_create(LsVoxels* voxels, const LsMesh* mesh, uint32_t grid,
                          const LsDivisionRule* rule, uint32_t threads,
                          const LsStageProgress* progress, LsError* error)
{
    *voxels = (LsVoxels){0};
    uint8_t* copies = ls_find_copies(mesh);
    if (copies == NULL)
    {
        return report_memory(error);
    }
    uint32_t cells = grid;
    while (cells > 1 && must_be_crowded(mesh, copies, cells, threads))
    {
        cells /= 2;
    }
    bool crowded = true;
    LsResult result = LS_OK;
    for (; crowded && result == LS_OK; cells /= 2)
    {
        result = try_grid(voxels, mesh, cells, rule, copies, threads, progress, &crowded, error);
    }
    free(copies);
    return result;
}

void ls_voxels_destroy(LsVoxels* voxels)
{
    free(voxels->blocks);
    free(voxels->cell_blocks);
    free(voxels->subgrids);
    free(voxels->voxels);
    free(voxels->references);
    free(voxels->leaf_nodes);
    free(voxels->divisions);
    *voxels = (LsVoxels){0};
}

uint64_t ls_voxels_bytes(const LsVoxels* voxels)
{
    return sizeof(LsCellBlock) * (uint64_t)voxels->cell_block_count +
           sizeof(LsVoxel) * (uint64_t)voxels->voxel_count +
           sizeof(LsBvhNode) * (uint64_t)voxels->leaf_node_count +
           sizeof(uint32_t) *
               ((uint64_t)voxels->block_count + voxels->subgrid_count + voxels->reference_count);
}

LsResult ls_voxels_order_triangles(LsVoxels* voxels, LsMesh* mesh, uint32_t threads, LsError* error)
{
    uint32_t* renumbered = malloc(sizeof(uint32_t) * mesh->triangle_count);
    LsTriangle* triangles = malloc(sizeof(LsTriangle) * (size_t)mesh->triangle_count);
    if (renumbered == NULL || triangles == NULL)
    {
        free(renumbered);
        free(triangles);
        return report_memory(error);
    }
    memset(renumbered, 0xFF, sizeof(uint32_t) * mesh->triangle_count);
    uint32_t next = 0;
    for (uint32_t i = 0; i < voxels->reference_count; i++)
    {
        uint32_t* reference = &voxels->references[i];
        if (renumbered[*reference] == LS_NONE)
        {
            triangles[next] = mesh->triangles[*reference];
            renumbered[*reference] = next++;
        }
        *reference = renumbered[*reference];
    }
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        if (renumbered[i] == LS_NONE) // a copy
        {
            triangles[next++] = mesh->triangles[i];
        }
    }
    free(renumbered);
    free(mesh->triangles);
    mesh->triangles = triangles;
#pragma omp parallel for schedule(static) num_threads(threads)
    for (uint32_t i = 0; i < voxels->voxel_count; i++)
    {
        const LsWorkVoxel* voxel = &voxels->voxels[i];
        if (voxel->kind == LS_VOXEL_LIST || voxel->kind == LS_VOXEL_MASKS)
        {
            sort_words(voxels->references + voxel->first_reference, voxel->reference_count);
        }
    }
    return LS_OK;
}
