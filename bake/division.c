// division.c - from the deepest sub-grids up, the cheaper of a sub-grid and a BVH.

#include "division.h"

#include "cost_model.h"
#include "ls_format.h"

// Of the tests of a voxel what masks of N = 1, 2, 3 leave: means over 100,000 voxels of sub-grids
// of bunny, elephant and scenes of many sizes, which differ by a tenth.
static const double LEFT[] = {1.0, 0.75, 0.31, 0.21};
#define USUAL_PATCHES 3

// Of the voxels with masks, all with the same N or without.
static double mask_cost(const LsDivision* division, double price)
{
    double least = division->mask_tests;
    for (int n = 1; n <= USUAL_PATCHES; n++)
    {
        const double bytes = LS_SHAFT_COUNT(n) / 8.0 * (double)division->mask_references;
        const double cost =
            LS_LOOKUP_COST * division->mask_visits + LEFT[n] * division->mask_tests + price * bytes;
        least = cost < least ? cost : least;
    }
    return least;
}

void ls_divisions_choose(const LsDivision* divisions, uint32_t count, double price, double* costs,
                         bool* kept)
{
    for (uint32_t i = 0; i < count; i++)
    {
        costs[i] = 0.0; // of the sub-grids in it
    }
    for (uint32_t i = count; i-- > 0;)
    {
        const LsDivision* division = &divisions[i];
        const double divided = costs[i] + division->divided_work +
                               price * (double)division->divided_bytes + mask_cost(division, price);
        const double whole = division->whole_work + price * (double)division->whole_bytes;
        kept[i] = divided < whole;
        if (division->parent != LS_NONE)
        {
            costs[division->parent] += kept[i] ? divided : whole;
        }
    }
    for (uint32_t i = 0; i < count; i++)
    {
        const uint32_t parent = divisions[i].parent;
        kept[i] = kept[i] && (parent == LS_NONE || kept[parent]);
    }
}
