// bvh.c - median splits, depth-first layout.

#include "bvh.h"

#include <math.h>
#include <stdlib.h>

float ls_float_below(double x)
{
    float f = (float)x;
    return ((double)f > x ? nextafterf(f, -INFINITY) : f) + 0.0f;
}

float ls_float_above(double x)
{
    float f = (float)x;
    return ((double)f < x ? nextafterf(f, INFINITY) : f) + 0.0f;
}

static LsBox unite(const LsBox* boxes, const uint32_t* order, uint32_t count)
{
    LsBox all = boxes[order[0]];
    for (uint32_t i = 1; i < count; i++)
    {
        const LsBox* box = &boxes[order[i]];
        for (int axis = 0; axis < 3; axis++)
        {
            all.lower[axis] =
                box->lower[axis] < all.lower[axis] ? box->lower[axis] : all.lower[axis];
            all.upper[axis] =
                box->upper[axis] > all.upper[axis] ? box->upper[axis] : all.upper[axis];
        }
    }
    return all;
}

static int longest_centre_axis(const LsBox* boxes, const uint32_t* order, uint32_t count)
{
    int best = 0;
    double longest = -1.0;
    for (int axis = 0; axis < 3; axis++)
    {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t i = 0; i < count; i++)
        {
            const LsBox* box = &boxes[order[i]];
            double centre = box->lower[axis] + box->upper[axis];
            low = centre < low ? centre : low;
            high = centre > high ? centre : high;
        }
        if (high - low > longest)
        {
            longest = high - low;
            best = axis;
        }
    }
    return best;
}

static int is_before(const LsBox* boxes, int axis, uint32_t a, uint32_t b)
{
    double ca = boxes[a].lower[axis] + boxes[a].upper[axis];
    double cb = boxes[b].lower[axis] + boxes[b].upper[axis];
    return ca < cb || (ca == cb && a < b);
}

// Partially sorts so that order[middle] is where a full sort would put it (Hoare's selection; a
// total order, so the result depends on nothing else).
static void select_middle(const LsBox* boxes, int axis, uint32_t* order, uint32_t count,
                          uint32_t middle)
{
    uint32_t begin = 0, end = count;
    while (end - begin > 1)
    {
        uint32_t pivot =
            order[begin + (end - begin - 1) / 2]; // never the last, so both parts shrink
        uint32_t i = begin, j = end - 1;
        for (;;)
        {
            while (is_before(boxes, axis, order[i], pivot))
            {
                i++;
            }
            while (is_before(boxes, axis, pivot, order[j]))
            {
                j--;
            }
            if (i >= j)
            {
                break;
            }
            uint32_t swap = order[i];
            order[i++] = order[j];
            order[j--] = swap;
        }
        // [begin, j] is not after the pivot, [j + 1, end) not before.
        if (middle <= j)
        {
            end = j + 1;
        }
        else
        {
            begin = j + 1;
        }
    }
}

typedef struct Builder
{
    const LsBox* boxes;
    uint32_t* order;
    uint32_t leaf_size;
    LsBvhNode* nodes;
    uint32_t node_count;
} Builder;

static void build_node(Builder* builder, uint32_t first, uint32_t count)
{
    uint32_t* order = builder->order + first;
    LsBox box = unite(builder->boxes, order, count);
    uint32_t index = builder->node_count++;
    LsBvhNode* node = &builder->nodes[index];
    node->lower = (LsVec3){ls_float_below(box.lower[0]), ls_float_below(box.lower[1]),
                           ls_float_below(box.lower[2])};
    node->upper = (LsVec3){ls_float_above(box.upper[0]), ls_float_above(box.upper[1]),
                           ls_float_above(box.upper[2])};
    if (count <= builder->leaf_size)
    {
        node->leaf = first << 4 | count;
    }
    else
    {
        node->leaf = 0;
        uint32_t middle = count / 2;
        select_middle(builder->boxes, longest_centre_axis(builder->boxes, order, count), order,
                      count, middle);
        build_node(builder, first, middle);
        build_node(builder, first + middle, count - middle);
    }
    builder->nodes[index].escape = builder->node_count;
}

uint32_t ls_bvh_build(const LsBox* boxes, uint32_t* order, uint32_t count, uint32_t leaf_size,
                      LsBvhNode* nodes)
{
    Builder builder = {.boxes = boxes, .order = order, .leaf_size = leaf_size, .nodes = nodes};
    build_node(&builder, 0, count);
    return builder.node_count;
}
