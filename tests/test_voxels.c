// Baked files against slow oracles: every triangle is listed wherever it can be met, no distance
// skips a filled cell, no mask lacks a bit, boxes hold what they must, and bytes do not depend on
// the number of threads.

#include "baked.h"
#include "reference/polytope.h"
#include "reference/ref_trace.h"
#include "test_random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// Meshes and settings, few but of every kind of voxel.
typedef struct LsVoxelCase
{
    LsTestMeshId mesh;
    uint32_t grid, patches;
    double byte_price; // of N by voxel; 0: N is `patches`
    uint32_t divide_above;
} LsVoxelCase;

static const LsVoxelCase CASES[] = {
    {LS_TEST_MESH_BUNNY, 48, 3, 0, 0},     {LS_TEST_MESH_TEAPOT, 0, 0, 0, 0},
    {LS_TEST_MESH_TEAPOT, 5, 2, 0, 0},     {LS_TEST_MESH_SHELL, 16, 4, 0, 0},
    {LS_TEST_MESH_SHEETS, 10, 3, 0, 0},    {LS_TEST_MESH_SLIVERS, 13, 2, 0, 0},
    {LS_TEST_MESH_HUB, 8, 2, 0, 0},        {LS_TEST_MESH_FAN, 4, 1, 0, 0},
    {LS_TEST_MESH_FLAT, 20, 3, 0, 0},      {LS_TEST_MESH_STADIUM, 9, 3, 0, 0},
    {LS_TEST_MESH_ELEPHANT, 20, 5, 0, 0},  {LS_TEST_MESH_MICRO, 12, 2, 0, 0},
    {LS_TEST_MESH_MEGA, 12, 2, 0, 0},      {LS_TEST_MESH_FAR, 12, 2, 0, 0},
    {LS_TEST_MESH_ONE, 4, 2, 0, 0},        {LS_TEST_MESH_STRAY, 12, 3, 0, 0},
    {LS_TEST_MESH_STRAY, 3, 2, 0, 0},      {LS_TEST_MESH_ELEPHANT, 20, 5, 0.0005, 0},
    {LS_TEST_MESH_TEAPOT, 6, 4, 0.01, 0},  {LS_TEST_MESH_SHELL, 16, 1, 0.001, 0},
    {LS_TEST_MESH_STRAY, 12, 8, 1e-9, 0},  {LS_TEST_MESH_TEAPOT, 12, 2, 0, 3},
    {LS_TEST_MESH_SHELL, 5, 3, 0.001, 10}, {LS_TEST_MESH_ELEPHANT, 7, 2, 0, 100},
};
#define CASE_COUNT (sizeof CASES / sizeof CASES[0])

// ---- A file's grid as the specification reads it ------------------------------------------------

// Where a filled voxel lies, in cells of the grid.
typedef struct LsVoxelPlace
{
    double lower[3];
    double width;
    bool seen;
} LsVoxelPlace;

typedef struct LsGridView
{
    const LsFile* file;
    const LsObject* object;
    uint32_t blocks[3];
    LsVoxelPlace* places; // voxel_count
} LsGridView;

static bool is_link(uint32_t word)
{
    return (word & 15u) == 0;
}

static const LsVoxel* voxel_at(const LsGridView* view, uint32_t index)
{
    assert_true(index < view->object->voxel_count);
    return &view->file->voxels[view->object->first_voxel + index];
}

static const LsCellBlock* cell_block_at(const LsGridView* view, uint32_t index)
{
    assert_true(index < view->object->cell_block_count);
    return &view->file->cell_blocks[view->object->first_cell_block + index];
}

static uint32_t block_word(const LsGridView* view, uint32_t x, uint32_t y, uint32_t z)
{
    return view->file
        ->blocks[view->object->first_block + x + view->blocks[0] * (y + view->blocks[1] * z)];
}

// The word of a cell of the grid; an empty block answers for all its cells.
static uint32_t cell_word(const LsGridView* view, const uint32_t c[3])
{
    uint32_t word = block_word(view, c[0] / 4, c[1] / 4, c[2] / 4);
    if (!is_link(word))
    {
        return word;
    }
    return cell_block_at(view, word >> 4)->cells[c[0] % 4 + 4 * (c[1] % 4 + 4 * (c[2] % 4))];
}

static uint32_t voxel_kind(const LsVoxel* voxel)
{
    return voxel->shape & 255u;
}

// Notes where the voxels of a block lie, down into sub-grids.
static void place_voxels(LsGridView* view, const LsCellBlock* block, const double lower[3],
                         double width)
{
    for (uint32_t i = 0; i < LS_BLOCK_CELLS; i++)
    {
        if (!is_link(block->cells[i]))
        {
            continue;
        }
        uint32_t index = block->cells[i] >> 4;
        const LsVoxel* voxel = voxel_at(view, index);
        LsVoxelPlace* place = &view->places[index];
        assert_false(place->seen);
        *place = (LsVoxelPlace){.width = width, .seen = true};
        place->lower[0] = lower[0] + width * (i % 4);
        place->lower[1] = lower[1] + width * (i / 4 % 4);
        place->lower[2] = lower[2] + width * (i / 16);
        if (voxel_kind(voxel) == LS_VOXEL_SUBGRID)
        {
            place_voxels(view, cell_block_at(view, voxel->table), place->lower, 0.25 * width);
        }
    }
}

static LsGridView view_grid(const LsFile* file, const LsObject* object)
{
    LsGridView view = {.file = file, .object = object};
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        view.blocks[axis] = (object->cells[axis] + 3) / 4;
    }
    view.places = calloc(object->voxel_count, sizeof *view.places);
    assert_non_null(view.places);
    for (uint32_t i = 0; i < object->block_count; i++)
    {
        uint32_t word = file->blocks[object->first_block + i];
        if (is_link(word))
        {
            double lower[3] = {4.0 * (i % view.blocks[0]),
                               4.0 * (i / view.blocks[0] % view.blocks[1]),
                               4.0 * (i / view.blocks[0] / view.blocks[1])};
            place_voxels(&view, cell_block_at(&view, word >> 4), lower, 1.0);
        }
    }
    for (uint32_t i = 0; i < object->voxel_count; i++)
    {
        assert_true(view.places[i].seen);
    }
    return view;
}

// A triangle's corners in grid space, by SPEC 1 in double.
static void grid_corners(const LsGridView* view, uint32_t triangle, double corners[3][3])
{
    const LsTriangle* t = &view->file->triangles[view->object->first_triangle + triangle];
    const LsVec3 points[3] = {t->v0, t->v1, t->v2};
    const LsVec3 lower = view->object->grid_lower;
    double scale = view->object->inverse_cell;
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        corners[corner][0] = ((double)points[corner].x - lower.x) * scale;
        corners[corner][1] = ((double)points[corner].y - lower.y) * scale;
        corners[corner][2] = ((double)points[corner].z - lower.z) * scale;
    }
}

static LsPolytope box_at(const double lower[3], double width, double grow)
{
    LsBox box;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        box.lower[axis] = lower[axis];
        box.upper[axis] = lower[axis] + width;
    }
    return ls_polytope_box(&box, grow);
}

static bool lists_triangle(const LsGridView* view, const LsVoxel* voxel, uint32_t triangle)
{
    const uint32_t* references =
        view->file->references + view->object->first_reference + voxel->first_reference;
    for (uint32_t i = 0; i < voxel->reference_count; i++)
    {
        if (references[i] == triangle)
        {
            return true;
        }
    }
    return false;
}

// ---- Lists --------------------------------------------------------------------------------------

typedef struct LsListTally
{
    uint64_t met, missing;
} LsListTally;

// Looks for the triangle in a cell and, where that is a sub-grid, in its cells.
static void check_cell(const LsGridView* view, uint32_t triangle, const double corners[3][3],
                       uint32_t word, const double lower[3], double width, LsListTally* tally)
{
    LsPolytope box = box_at(lower, width, view->object->bound);
    if (!ls_polytope_meets(&box, corners))
    {
        return;
    }
    if (!is_link(word))
    {
        tally->missing++;
        return;
    }
    const LsVoxel* voxel = voxel_at(view, word >> 4);
    if (voxel_kind(voxel) != LS_VOXEL_SUBGRID)
    {
        tally->met++;
        tally->missing += !lists_triangle(view, voxel, triangle);
        return;
    }
    const LsCellBlock* block = cell_block_at(view, voxel->table);
    for (uint32_t i = 0; i < LS_BLOCK_CELLS; i++)
    {
        double part = 0.25 * width;
        double inner[3] = {lower[0] + part * (i % 4), lower[1] + part * (i / 4 % 4),
                           lower[2] + part * (i / 16)};
        check_cell(view, triangle, corners, block->cells[i], inner, part, tally);
    }
}

// Whether a triangle of a lower primitive has the same corners in the same order.
static bool is_copy(const LsGridView* view, uint32_t triangle)
{
    const LsTriangle* triangles = view->file->triangles + view->object->first_triangle;
    const LsTriangle* own = &triangles[triangle];
    for (uint32_t i = 0; i < view->object->triangle_count; i++)
    {
        const LsTriangle* other = &triangles[i];
        if (other->primitive < own->primitive &&
            memcmp(&other->v0, &own->v0, sizeof own->v0) == 0 &&
            memcmp(&other->v1, &own->v1, sizeof own->v1) == 0 &&
            memcmp(&other->v2, &own->v2, sizeof own->v2) == 0)
        {
            return true;
        }
    }
    return false;
}

static LsListTally check_lists(const LsGridView* view)
{
    LsListTally tally = {0};
    double bound = view->object->bound;
    for (uint32_t triangle = 0; triangle < view->object->triangle_count; triangle++)
    {
        const LsListTally before = tally;
        double corners[3][3];
        grid_corners(view, triangle, corners);
        uint32_t first[3], last[3];
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            double low = fmin(fmin(corners[0][axis], corners[1][axis]), corners[2][axis]) - bound;
            double high = fmax(fmax(corners[0][axis], corners[1][axis]), corners[2][axis]) + bound;
            double most = view->object->cells[axis] - 1.0;
            // Every triangle lies in the grid, its growth may not.
            assert_true(low >= -1.0 && high <= most + 2.0);
            first[axis] = (uint32_t)fmin(fmax(floor(low), 0.0), most);
            last[axis] = (uint32_t)fmin(fmax(floor(high), 0.0), most);
        }
        uint32_t c[3];
        for (c[2] = first[2]; c[2] <= last[2]; c[2]++)
        {
            for (c[1] = first[1]; c[1] <= last[1]; c[1]++)
            {
                for (c[0] = first[0]; c[0] <= last[0]; c[0]++)
                {
                    double lower[3] = {c[0], c[1], c[2]};
                    check_cell(view, triangle, corners, cell_word(view, c), lower, 1.0, &tally);
                }
            }
        }
        if (tally.missing != before.missing && is_copy(view, triangle))
        {
            tally = before;
        }
    }
    return tally;
}

// ---- Distances ----------------------------------------------------------------------------------

// Filled cells of a box of cells, answered by a table of sums over all boxes from the corner on.
typedef struct LsFillTable
{
    uint32_t size[3];
    uint32_t* sums; // (size + 1) per axis
} LsFillTable;

static uint32_t* fill_sum(const LsFillTable* table, uint32_t x, uint32_t y, uint32_t z)
{
    return &table->sums[x + (table->size[0] + 1) * (y + (size_t)(table->size[1] + 1) * z)];
}

static LsFillTable make_fill_table(const uint32_t size[3])
{
    LsFillTable table = {.size = {size[0], size[1], size[2]}};
    table.sums = calloc((size_t)(size[0] + 1) * (size[1] + 1) * (size[2] + 1), sizeof(uint32_t));
    assert_non_null(table.sums);
    return table;
}

static void sum_fill_table(LsFillTable* table)
{
    for (uint32_t z = 1; z <= table->size[2]; z++)
    {
        for (uint32_t y = 1; y <= table->size[1]; y++)
        {
            for (uint32_t x = 1; x <= table->size[0]; x++)
            {
                *fill_sum(table, x, y, z) +=
                    *fill_sum(table, x - 1, y, z) + *fill_sum(table, x, y - 1, z) +
                    *fill_sum(table, x, y, z - 1) - *fill_sum(table, x - 1, y - 1, z) -
                    *fill_sum(table, x - 1, y, z - 1) - *fill_sum(table, x, y - 1, z - 1) +
                    *fill_sum(table, x - 1, y - 1, z - 1);
            }
        }
    }
}

// The part of a table that the cube of k^3 cells covers which grows from a cell into an octant: [a,
// b).
static void clamp_cube(const LsFillTable* table, const uint32_t cell[3], uint32_t octant,
                       uint32_t k, uint32_t a[3], uint32_t b[3])
{
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        bool down = octant >> axis & 1u;
        a[axis] = !down ? cell[axis] : cell[axis] + 1 > k ? cell[axis] + 1 - k : 0;
        b[axis] = down ? cell[axis] + 1 : cell[axis] + k;
        b[axis] = b[axis] < table->size[axis] ? b[axis] : table->size[axis];
    }
}

static bool is_cube_empty(const LsFillTable* table, const uint32_t cell[3], uint32_t octant,
                          uint32_t k)
{
    uint32_t a[3], b[3];
    clamp_cube(table, cell, octant, k, a, b);
    uint32_t inside = *fill_sum(table, b[0], b[1], b[2]) - *fill_sum(table, a[0], b[1], b[2]) -
                      *fill_sum(table, b[0], a[1], b[2]) - *fill_sum(table, b[0], b[1], a[2]) +
                      *fill_sum(table, a[0], a[1], b[2]) + *fill_sum(table, a[0], b[1], a[2]) +
                      *fill_sum(table, b[0], a[1], a[2]) - *fill_sum(table, a[0], a[1], a[2]);
    return inside == 0;
}

// Whether a cube one wider would be empty too and reach cells that this one does not.
static bool is_cube_short(const LsFillTable* table, const uint32_t cell[3], uint32_t octant,
                          uint32_t k)
{
    uint32_t a[3], b[3], wide_a[3], wide_b[3];
    clamp_cube(table, cell, octant, k, a, b);
    clamp_cube(table, cell, octant, k + 1, wide_a, wide_b);
    bool reaches = memcmp(a, wide_a, sizeof a) != 0 || memcmp(b, wide_b, sizeof b) != 0;
    return reaches && is_cube_empty(table, cell, octant, k + 1);
}

typedef struct LsDistanceTally
{
    uint64_t distances, too_long, too_short;
} LsDistanceTally;

static void check_word(const LsFillTable* table, const uint32_t cell[3], uint32_t word,
                       LsDistanceTally* tally)
{
    for (uint32_t octant = 0; octant < 8; octant++)
    {
        uint32_t k = word >> (4 * octant) & 15u;
        assert_true(k >= 1);
        tally->distances++;
        tally->too_long += !is_cube_empty(table, cell, octant, k);
        tally->too_short += k < 15 && is_cube_short(table, cell, octant, k);
    }
}

static void check_table(LsFillTable* table, const uint32_t* words, LsDistanceTally* tally)
{
    uint32_t c[3];
    for (uint32_t pass = 0; pass < 2; pass++)
    {
        for (c[2] = 0; c[2] < table->size[2]; c[2]++)
        {
            for (c[1] = 0; c[1] < table->size[1]; c[1]++)
            {
                for (c[0] = 0; c[0] < table->size[0]; c[0]++)
                {
                    uint32_t word =
                        words[c[0] + table->size[0] * (c[1] + (size_t)table->size[1] * c[2])];
                    if (pass == 0)
                    {
                        *fill_sum(table, c[0] + 1, c[1] + 1, c[2] + 1) = is_link(word);
                    }
                    else if (!is_link(word))
                    {
                        check_word(table, c, word, tally);
                    }
                }
            }
        }
        if (pass == 0)
        {
            sum_fill_table(table);
        }
    }
    free(table->sums);
}

static LsDistanceTally check_distances(const LsGridView* view)
{
    LsDistanceTally tally = {0};
    const LsObject* object = view->object;
    LsFillTable blocks = make_fill_table(view->blocks);
    check_table(&blocks, view->file->blocks + object->first_block, &tally);

    // Cells of filled blocks; an empty block's cells count as empty and have no words of their own.
    uint32_t size[3] = {4 * view->blocks[0], 4 * view->blocks[1], 4 * view->blocks[2]};
    LsFillTable cells = make_fill_table(size);
    uint32_t c[3];
    for (uint32_t pass = 0; pass < 2; pass++)
    {
        for (c[2] = 0; c[2] < size[2]; c[2]++)
        {
            for (c[1] = 0; c[1] < size[1]; c[1]++)
            {
                for (c[0] = 0; c[0] < size[0]; c[0]++)
                {
                    uint32_t word = cell_word(view, c);
                    bool own = is_link(block_word(view, c[0] / 4, c[1] / 4, c[2] / 4));
                    if (pass == 0)
                    {
                        *fill_sum(&cells, c[0] + 1, c[1] + 1, c[2] + 1) = is_link(word);
                    }
                    else if (own && !is_link(word))
                    {
                        check_word(&cells, c, word, &tally);
                    }
                }
            }
        }
        if (pass == 0)
        {
            sum_fill_table(&cells);
        }
    }
    free(cells.sums);

    for (uint32_t s = 0; s < object->subgrid_count; s++)
    {
        const uint32_t side[3] = {LS_BLOCK_SIDE, LS_BLOCK_SIDE, LS_BLOCK_SIDE};
        LsFillTable sub = make_fill_table(side);
        uint32_t block = object->cell_block_count - object->subgrid_count + s;
        check_table(&sub, cell_block_at(view, block)->cells, &tally);
    }
    return tally;
}

// ---- Masks --------------------------------------------------------------------------------------

typedef struct LsMaskTally
{
    uint64_t cases, met, marked, missing;
} LsMaskTally;

static bool read_bit(const uint32_t* table, uint64_t bit)
{
    return table[bit / 32] >> (bit % 32) & 1u;
}

static LsMaskTally check_masks(const LsGridView* view, uint32_t voxel_samples,
                               uint32_t shaft_samples)
{
    LsMaskTally tally = {0};
    LsRandom random = {4711};
    const LsObject* object = view->object;
    for (uint32_t sample = 0; sample < voxel_samples; sample++)
    {
        uint32_t index = ls_random_below(&random, object->voxel_count);
        const LsVoxel* voxel = voxel_at(view, index);
        if (voxel_kind(voxel) != LS_VOXEL_MASKS)
        {
            continue;
        }
        const LsVoxelPlace* place = &view->places[index];
        uint32_t patches = voxel->shape >> 8 & 255u;
        assert_int_equal(voxel->shape >> 16, 0); // exact width
        uint32_t width = voxel->reference_count;
        const uint32_t* table = view->file->shafts + object->first_shaft_word + voxel->table;
        const uint32_t* references =
            view->file->references + object->first_reference + voxel->first_reference;
        uint32_t shaft_count = LS_SHAFT_COUNT(patches);
        for (uint32_t s = 0; s < shaft_samples; s++)
        {
            uint32_t shaft = ls_random_below(&random, shaft_count);
            LsPolytope body = ls_polytope_shaft(shaft, patches, object->bound / place->width);
            for (uint32_t k = 0; k < voxel->reference_count; k++)
            {
                double corners[3][3];
                grid_corners(view, references[k], corners);
                for (uint32_t i = 0; i < 9; i++)
                {
                    corners[i / 3][i % 3] =
                        (corners[i / 3][i % 3] - place->lower[i % 3]) / place->width;
                }
                bool meets = ls_polytope_meets(&body, corners);
                bool marked = read_bit(table, (uint64_t)shaft * width + k);
                tally.cases++;
                tally.met += meets;
                tally.marked += marked;
                tally.missing += meets && !marked;
            }
        }
    }
    return tally;
}

// ---- Boxes --------------------------------------------------------------------------------------

static double component(LsVec3 v, uint32_t axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static bool holds_point(const LsBvhNode* node, const double p[3], double grown)
{
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        if (!(component(node->lower, axis) <= p[axis] - grown &&
              component(node->upper, axis) >= p[axis] + grown))
        {
            return false;
        }
    }
    return true;
}

static bool holds_node(const LsBvhNode* node, const LsBvhNode* inner)
{
    const double lower[3] = {inner->lower.x, inner->lower.y, inner->lower.z};
    const double upper[3] = {inner->upper.x, inner->upper.y, inner->upper.z};
    return holds_point(node, lower, 0.0) && holds_point(node, upper, 0.0);
}

// Leaves of voxels hold their triangles' part of the grown voxel, grown by two bounds; nodes hold
// their children.
static uint64_t check_leaf_boxes(const LsGridView* view)
{
    const LsObject* object = view->object;
    uint64_t checked = 0;
    for (uint32_t index = 0; index < object->voxel_count; index++)
    {
        const LsVoxel* voxel = voxel_at(view, index);
        if (voxel_kind(voxel) != LS_VOXEL_BVH)
        {
            continue;
        }
        const LsBvhNode* nodes = view->file->leaf_nodes + object->first_leaf_node + voxel->table;
        const uint32_t* references =
            view->file->references + object->first_reference + voxel->first_reference;
        LsPolytope box =
            box_at(view->places[index].lower, view->places[index].width, object->bound);
        for (uint32_t n = 0; n < nodes[0].escape; n++)
        {
            for (uint32_t inner = n + 1; inner < nodes[n].escape; inner++)
            {
                assert_true(holds_node(&nodes[n], &nodes[inner]));
            }
            for (uint32_t k = 0; k < (nodes[n].leaf & 15u); k++)
            {
                double corners[3][3], part[LS_POLYTOPE_MAX_CORNERS][3];
                grid_corners(view, references[(nodes[n].leaf >> 4) + k], corners);
                uint32_t count = ls_polytope_clip(&box, corners, part);
                for (uint32_t i = 0; i < count; i++)
                {
                    assert_true(
                        holds_point(&nodes[n], part[i], 2.0 * object->bound - LS_POLYTOPE_SLACK));
                    checked++;
                }
            }
        }
    }
    return checked;
}

// ---- Tests --------------------------------------------------------------------------------------

static void files_against_oracles(void** state)
{
    (void)state;
    uint64_t kinds[4] = {0}, leaf_corners = 0, masks_met = 0;
    uint64_t chosen[LS_MAX_CHOSEN_PATCHES + 1] = {0};
    for (uint32_t i = 0; i < CASE_COUNT; i++)
    {
        const char* name = ls_test_mesh_name(CASES[i].mesh);
        LsTestMesh mesh = ls_test_mesh_make(CASES[i].mesh);
        LsBaked baked;
        ls_baked_open_desc(&baked, &mesh, name, LS_TEST_ALONE,
                           &(LsBakeDesc){.grid = CASES[i].grid,
                                         .patches = CASES[i].patches,
                                         .choose_patches = CASES[i].byte_price > 0.0,
                                         .byte_price = CASES[i].byte_price,
                                         .divide_above = CASES[i].divide_above});
        for (uint32_t n = 1; n <= LS_MAX_CHOSEN_PATCHES && CASES[i].byte_price > 0.0; n++)
        {
            chosen[n] += baked.report.patches_count[n];
        }
        const LsObject* object = &baked.file.objects[0];
        assert_int_equal(object->face_count, mesh.triangle_count);
        assert_true(object->triangle_count + baked.report.dropped_count == mesh.triangle_count);
        if (object->kind == LS_OBJECT_LIST)
        {
            assert_true(object->triangle_count <= LS_LIST_TRIANGLES);
            print_message("%s: a list of %u\n", name, object->triangle_count);
        }
        else
        {
            LsGridView view = view_grid(&baked.file, object);
            LsListTally lists = check_lists(&view);
            LsDistanceTally distances = check_distances(&view);
            LsMaskTally masks = check_masks(&view, 300, 40);
            leaf_corners += check_leaf_boxes(&view);
            masks_met += masks.met;
            for (uint32_t kind = 0; kind < 4; kind++)
            {
                kinds[kind] += baked.report.voxel_kind_count[kind];
            }
            print_message(
                "%s %ux%ux%u depth %u: %llu references met, %llu missing; %llu distances, %llu too "
                "long, %.2f %% shorter than need be; %llu mask bits looked at, %llu met, %llu set, "
                "%llu missing\n",
                name, object->cells[0], object->cells[1], object->cells[2], object->depth,
                (unsigned long long)lists.met, (unsigned long long)lists.missing,
                (unsigned long long)distances.distances, (unsigned long long)distances.too_long,
                100.0 * (double)distances.too_short / (double)(distances.distances + 1),
                (unsigned long long)masks.cases, (unsigned long long)masks.met,
                (unsigned long long)masks.marked, (unsigned long long)masks.missing);
            // Kept faces without area are listed as all others.
            assert_true(lists.met >= object->triangle_count);
            assert_int_equal(lists.missing, 0);
            assert_int_equal(distances.too_long, 0);
            assert_int_equal(masks.missing, 0);
            free(view.places);
        }
        ls_baked_close(&baked);
        ls_test_mesh_destroy(&mesh);
    }
    // The cases do exercise every kind.
    for (uint32_t kind = 0; kind < 4; kind++)
    {
        assert_true(kinds[kind] > 0);
    }
    assert_true(leaf_corners > 0);
    assert_true(masks_met > 10000);
    // Choices do lead to different N.
    assert_true(chosen[1] > 0 && chosen[2] > 0 && chosen[3] > 0 && chosen[8] > 0);
}

// Corners carried to the world by the exact inverse of the normative transform lie in their
// instance's leaf.
static void top_level_boxes(void** state)
{
    (void)state;
    static const LsTestMeshId ids[] = {LS_TEST_MESH_TEAPOT, LS_TEST_MESH_ONE, LS_TEST_MESH_FAR};
    for (uint32_t m = 0; m < 3; m++)
    {
        LsTestMesh mesh = ls_test_mesh_make(ids[m]);
        LsBaked baked;
        ls_baked_open(&baked, &mesh, ls_test_mesh_name(ids[m]), LS_TEST_INSTANCES, 0, 0, 0);
        const LsFile* file = &baked.file;
        uint32_t node_count = ls_file_count(file, LS_CHUNK_TOP_NODES);
        assert_int_equal(ls_file_count(file, LS_CHUNK_INSTANCES), 4);
        assert_int_equal(ls_file_count(file, LS_CHUNK_OBJECTS), 1);
        assert_true(node_count > 4);
        uint32_t leaves = 0, mirrored = 0;
        for (uint32_t n = 0; n < node_count; n++)
        {
            for (uint32_t inner = n + 1; inner < file->top_nodes[n].escape; inner++)
            {
                assert_true(holds_node(&file->top_nodes[n], &file->top_nodes[inner]));
            }
            if (file->top_nodes[n].leaf == 0)
            {
                continue;
            }
            leaves++;
            const LsInstance* instance = &file->instances[file->top_nodes[n].leaf >> 4];
            const LsVec4* r = instance->object_from_world;
            double determinant =
                (double)r[0].x * ((double)r[1].y * r[2].z - (double)r[1].z * r[2].y) -
                (double)r[0].y * ((double)r[1].x * r[2].z - (double)r[1].z * r[2].x) +
                (double)r[0].z * ((double)r[1].x * r[2].y - (double)r[1].y * r[2].x);
            assert_int_equal(determinant < 0.0, (instance->flags & LS_INSTANCE_MIRRORED) != 0);
            mirrored += determinant < 0.0;
            const double rows[3][3] = {
                {r[0].x, r[0].y, r[0].z}, {r[1].x, r[1].y, r[1].z}, {r[2].x, r[2].y, r[2].z}};
            const double shift[3] = {r[0].w, r[1].w, r[2].w};
            for (uint32_t i = 0; i < file->objects[0].triangle_count; i++)
            {
                const LsVec3 v = file->triangles[i].v0;
                const double b[3] = {v.x - shift[0], v.y - shift[1], v.z - shift[2]};
                double world[3];
                for (uint32_t column = 0; column < 3; column++)
                {
                    // Cramer's rule.
                    double a[3][3];
                    memcpy(a, rows, sizeof a);
                    for (uint32_t row = 0; row < 3; row++)
                    {
                        a[row][column] = b[row];
                    }
                    world[column] = (a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
                                     a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
                                     a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])) /
                                    determinant;
                }
                assert_true(holds_point(&file->top_nodes[n], world, 0.0));
            }
        }
        assert_int_equal(leaves, 4);
        assert_int_equal(mirrored, 1);
        ls_baked_close(&baked);
        ls_test_mesh_destroy(&mesh);
    }
}

static void same_bytes_for_any_threads(void** state)
{
    (void)state;
    static const LsTestMeshId ids[] = {LS_TEST_MESH_ELEPHANT, LS_TEST_MESH_HUB,
                                       LS_TEST_MESH_STADIUM, LS_TEST_MESH_SLIVERS};
    static const uint32_t threads[] = {1, 2, 8};
    for (uint32_t m = 0; m < 4; m++)
    {
        LsTestMesh mesh = ls_test_mesh_make(ids[m]);
        for (int placement = LS_TEST_ALONE; placement <= LS_TEST_INSTANCES; placement++)
        {
            LsBaked baked[3];
            for (uint32_t i = 0; i < 3; i++)
            {
                // A copy of its own for each, since the name holds the count of threads.
                ls_baked_open_desc(
                    &baked[i], &mesh, ls_test_mesh_name(ids[m]), (LsTestPlacement)placement,
                    &(LsBakeDesc){.choose_patches = m % 2 == 0, .threads = threads[i]});
                assert_true(baked[i].report.tests_per_voxel == baked[0].report.tests_per_voxel);
            }
            for (uint32_t i = 1; i < 3; i++)
            {
                assert_int_equal(baked[i].mapping.size, baked[0].mapping.size);
                assert_memory_equal(baked[i].mapping.bytes, baked[0].mapping.bytes,
                                    baked[0].mapping.size);
            }
            for (uint32_t i = 0; i < 3; i++)
            {
                ls_baked_close(&baked[i]);
            }
        }
        ls_test_mesh_destroy(&mesh);
    }
}

// A point of a triangle, as float has it.
static LsVec3 point_of(const LsTriangle* t, double a, double b)
{
    double c = 1.0 - a - b;
    return (LsVec3){(float)(c * t->v0.x + a * t->v1.x + b * t->v2.x),
                    (float)(c * t->v0.y + a * t->v1.y + b * t->v2.y),
                    (float)(c * t->v0.z + a * t->v1.z + b * t->v2.z)};
}

// Rays aimed at points of kept faces without area, their corners among them.
static void kept_flat_faces_are_never_hit(void** state)
{
    (void)state;
    enum
    {
        RAYS = 60000
    };
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_STRAY);
    LsBaked baked;
    ls_baked_open(&baked, &mesh, "stray-rays", LS_TEST_ALONE, 12, 3, 0);
    assert_int_equal(baked.report.dropped_count, 0);
    assert_true(baked.report.degenerate_count >= 1200);
    LsReference* reference = ls_reference_create(&baked.file);
    LsRay* rays = malloc(sizeof(LsRay) * RAYS);
    LsHit* hits = malloc(sizeof(LsHit) * RAYS);
    assert_true(reference != NULL && rays != NULL && hits != NULL);
    LsRandom random = {12};
    for (uint32_t i = 0; i < RAYS; i++)
    {
        const LsTriangle* t;
        do
        {
            t = &baked.file
                     .triangles[ls_random_below(&random, baked.file.objects[0].triangle_count)];
        } while (t->primitive % 4 == 0);
        double a = i % 5 == 0 ? i / 5 % 2 : ls_random_unit(&random);
        LsVec3 aim = point_of(t, a, (1.0 - a) * ls_random_unit(&random));
        LsVec3 from = {(float)ls_random_between(&random, -0.5, 1.5),
                       (float)ls_random_between(&random, -0.5, 1.5),
                       (float)ls_random_between(&random, -0.5, 1.5)};
        rays[i] = (LsRay){.origin = from,
                          .direction = {aim.x - from.x, aim.y - from.y, aim.z - from.z},
                          .tmax = INFINITY};
    }
    ls_reference_trace(reference, rays, NULL, RAYS, 0, hits);
    uint32_t hit_count = 0;
    for (uint32_t i = 0; i < RAYS; i++)
    {
        hit_count += hits[i].primitive != LS_NONE;
        assert_true(hits[i].primitive == LS_NONE || hits[i].primitive % 4 == 0);
    }
    assert_true(hit_count > RAYS / 100);
    free(rays);
    free(hits);
    ls_reference_destroy(reference);
    ls_baked_close(&baked);
    ls_test_mesh_destroy(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_against_oracles),
        cmocka_unit_test(top_level_boxes),
        cmocka_unit_test(same_bytes_for_any_threads),
        cmocka_unit_test(kept_flat_faces_are_never_hit),
    };
    return cmocka_run_group_tests_name("voxels", tests, NULL, NULL);
}
