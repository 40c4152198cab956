// grid_frame.c - cubic cells along the longest side, with a margin of some e all round.

#include "grid_frame.h"

#include "bvh.h"

#include <math.h>

LsGridFrame ls_grid_frame(const LsMesh* mesh, uint32_t grid)
{
    LsGridFrame frame = {.grid = grid};
    double bound = grid * 0x1p-18;
    double longest = 0.0;
    for (int axis = 0; axis < 3; axis++)
    {
        longest = fmax(longest, (double)mesh->upper[axis] - mesh->lower[axis]);
    }
    // Margins of 4 e, generously rounded outward; float may push the lower corner out by much more
    // where the mesh lies far from its origin.
    double margin = 4.0 * bound / grid * longest * 1.01;
    double span = 0.0;
    for (int axis = 0; axis < 3; axis++)
    {
        frame.lower[axis] = ls_float_below(mesh->lower[axis] - margin);
        span = fmax(span, mesh->upper[axis] - (double)frame.lower[axis]);
    }
    frame.inverse_cell = ls_float_below((grid - 4.0 * bound) / span);
    frame.bound = ls_float_above(bound);
    for (int axis = 0; axis < 3; axis++)
    {
        double top =
            (mesh->upper[axis] - (double)frame.lower[axis]) * frame.inverse_cell + 3.0 * bound;
        uint32_t cells = (uint32_t)top + 1;
        frame.cells[axis] = cells < grid ? cells : grid;
    }
    // A sub-cell stays 16 e wide at least, and its planes exact in float.
    double width = 1.0;
    while (frame.depth < LS_MAX_DEPTH && width / 4.0 >= 16.0 * bound && grid / width * 4.0 < 0x1p22)
    {
        width /= 4.0;
        frame.depth++;
    }
    return frame;
}

void ls_grid_point(const LsGridFrame* frame, LsVec3 point, double out[3])
{
    out[0] = ((double)point.x - frame->lower[0]) * frame->inverse_cell;
    out[1] = ((double)point.y - frame->lower[1]) * frame->inverse_cell;
    out[2] = ((double)point.z - frame->lower[2]) * frame->inverse_cell;
}
