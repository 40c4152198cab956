// cost_model.c - sums over the words of blocks and cells.

#include "cost_model.h"

#include "shaft_cost.h"

double ls_cell_visits(const LsGridFrame* frame)
{
    const double x = frame->cells[0], y = frame->cells[1], z = frame->cells[2];
    return 3.0 / (x * y + y * z + z * x);
}

static bool is_link(uint32_t word)
{
    return (word & 15u) == 0;
}

// Skips that begin in a visit. A line of any direction crosses 1.5 cells for each of their widths
// on average, so a skip of d cells goes on through 1.5 (d - 1) others.
static double word_steps(uint32_t word)
{
    double sum = 0.0;
    for (uint32_t octant = 0; octant < 8; octant++)
    {
        sum += 1.0 / (1.0 + 1.5 * ((double)(word >> (4 * octant) & 15u) - 1.0));
    }
    return is_link(word) ? 1.0 : 0.125 * sum;
}

// Of the cells of a block that lie in the grid; `inside`: how many along each axis, 4 at most.
static double block_steps(const LsCellBlock* block, const uint32_t inside[3])
{
    double sum = 0.0;
    for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
    {
        const bool is_inside =
            (c & 3) < inside[0] && (c >> 2 & 3) < inside[1] && c >> 4 < inside[2];
        sum += is_inside ? word_steps(block->cells[c]) : 0.0;
    }
    return sum;
}

// One to enter it; cells of a quarter of its width are met with a sixteenth of its surface.
double ls_subgrid_steps(const LsCellBlock* block)
{
    static const uint32_t all[3] = {4, 4, 4};
    return 1.0 + block_steps(block, all) / 16.0;
}

double ls_expected_steps(const LsVoxels* voxels)
{
    const uint32_t* cells = voxels->frame.cells;
    const uint32_t nx = (cells[0] + 3) / 4, ny = (cells[1] + 3) / 4;
    double sum = 0.0;
    for (uint32_t i = 0; i < voxels->block_count; i++)
    {
        const uint32_t word = voxels->blocks[i];
        const uint32_t at[3] = {i % nx, i / nx % ny, i / nx / ny};
        uint32_t inside[3];
        for (int axis = 0; axis < 3; axis++)
        {
            const uint32_t left = cells[axis] - 4 * at[axis];
            inside[axis] = left < 4 ? left : 4;
        }
        // In surfaces of a cell: 16 of a block that lies in the grid whole.
        const double surface =
            (inside[0] * inside[1] + inside[1] * inside[2] + inside[2] * inside[0]) / 3.0;
        sum += is_link(word) ? block_steps(&voxels->cell_blocks[word >> 4], inside)
                             : surface * word_steps(word);
    }
    for (uint32_t i = 0; i < voxels->voxel_count; i++)
    {
        const LsWorkVoxel* voxel = &voxels->voxels[i];
        if (voxel->kind == LS_VOXEL_BVH)
        {
            sum += ls_voxel_visits(voxel) *
                   ls_leaf_bvh_boxes(voxels->leaf_nodes + voxel->table, voxel);
        }
        if (voxel->kind == LS_VOXEL_SUBGRID)
        {
            sum += ls_voxel_visits(voxel) * ls_subgrid_steps(&voxels->cell_blocks[voxel->table]);
        }
    }
    return sum * ls_cell_visits(&voxels->frame);
}

double ls_work_cost(const LsWork* work)
{
    return LS_STEP_COST * work->steps + LS_LOOKUP_COST * work->lookups + work->tests;
}
