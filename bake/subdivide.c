// subdivide.c - divides crowded voxels breadth first, so that blocks and voxels come out in file
// order.

#include "subdivide.h"

#include "bvh.h"
#include "cost_model.h"
#include "overlap.h"
#include "shaft_cost.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BVH_LEAF_TRIANGLES 4

// A voxel that waits for its division.
typedef struct Pending
{
    LsWorkVoxel voxel;
    uint32_t* references; // owned
    uint32_t count;
    uint32_t parent; // local block
    uint32_t slot;   // the voxel's place in tree->voxels, or LS_NONE for the grid's own
    uint32_t former; // its block in divider->former; LS_NONE: none
} Pending;

typedef struct Divider
{
    LsSubtree* tree;
    const LsMesh* mesh;
    const LsGridFrame* frame;
    double grow;
    uint32_t above; // triangles of voxels that are divided, if that pays
    bool is_weighed;
    const LsSubtree* former; // all that pays, of which no more is divided than is kept; or NULL
    const bool* kept;        // of its blocks
    uint64_t held; // references of voxels that are not divided, those in the queue among them
    uint64_t most; // of them
    Pending* queue;
    uint32_t queue_count, queue_capacity;
    uint32_t block_capacity, voxel_capacity, reference_capacity, leaf_node_capacity;
    uint64_t* touched; // per triangle of the voxel at hand: children it touches
    uint32_t touched_capacity;
} Divider;

static bool reserve(void** array, uint32_t* capacity, uint64_t count, size_t size)
{
    if (count <= *capacity)
    {
        return true;
    }
    uint64_t wanted = count + count / 2 + 16;
    void* grown = wanted > UINT32_MAX ? NULL : realloc(*array, wanted * size);
    if (grown == NULL)
    {
        return false;
    }
    *array = grown;
    *capacity = (uint32_t)wanted;
    return true;
}

static double level_size(uint32_t level)
{
    return 1.0 / (double)(1u << (2 * level));
}

static LsOverlap prepare(const Divider* divider, uint32_t triangle, double corners[3][3])
{
    const LsTriangle* t = &divider->mesh->triangles[triangle];
    ls_grid_point(divider->frame, t->v0, corners[0]);
    ls_grid_point(divider->frame, t->v1, corners[1]);
    ls_grid_point(divider->frame, t->v2, corners[2]);
    return ls_overlap_prepare((const double(*)[3])corners);
}

// Which of the 4^3 children a triangle touches.
static uint64_t touched_children(const Divider* divider, const LsWorkVoxel* voxel,
                                 const LsOverlap* triangle)
{
    double size = level_size(voxel->level + 1);
    int low[3], high[3];
    double half[3] = {0.5 * size + divider->grow, 0.5 * size + divider->grow,
                      0.5 * size + divider->grow};
    for (int axis = 0; axis < 3; axis++)
    {
        double origin = 4.0 * voxel->cell[axis];
        double begin = floor((triangle->lower[axis] - divider->grow) / size) - origin;
        double end = floor((triangle->upper[axis] + divider->grow) / size) - origin;
        low[axis] = begin > 0.0 ? (begin < 4.0 ? (int)begin : 4) : 0;
        high[axis] = end < 3.0 ? (end >= 0.0 ? (int)end : -1) : 3;
    }
    uint64_t children = 0;
    for (int z = low[2]; z <= high[2]; z++)
    {
        for (int y = low[1]; y <= high[1]; y++)
        {
            for (int x = low[0]; x <= high[0]; x++)
            {
                double centre[3] = {(4.0 * voxel->cell[0] + x + 0.5) * size,
                                    (4.0 * voxel->cell[1] + y + 0.5) * size,
                                    (4.0 * voxel->cell[2] + z + 0.5) * size};
                if (ls_overlap_box(triangle, centre, half))
                {
                    children |= 1ull << (x + 4 * y + 16 * z);
                }
            }
        }
    }
    return children;
}

// Fills touched[] and the children's counts; says whether the division pays, and then counts it.
static bool division_pays(Divider* divider, const Pending* pending, uint32_t counts[LS_BLOCK_CELLS],
                          bool* memory)
{
    *memory = reserve((void**)&divider->touched, &divider->touched_capacity, pending->count,
                      sizeof(uint64_t));
    if (!*memory || pending->voxel.level >= divider->frame->depth)
    {
        return false;
    }
    memset(counts, 0, sizeof(uint32_t) * LS_BLOCK_CELLS);
    const uint64_t others = divider->held - pending->count;
    const uint64_t room = divider->most > others ? divider->most - others : 0;
    const uint64_t most = 4ull * pending->count < room ? 4ull * pending->count : room;
    uint64_t sum = 0;
    for (uint32_t i = 0; i < pending->count && sum <= most; i++)
    {
        double corners[3][3];
        LsOverlap triangle = prepare(divider, pending->references[i], corners);
        uint64_t children = touched_children(divider, &pending->voxel, &triangle);
        divider->touched[i] = children;
        for (; children != 0; children &= children - 1)
        {
            counts[__builtin_ctzll(children)]++;
            sum++;
        }
    }
    uint32_t fewest = UINT32_MAX;
    for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
    {
        fewest = counts[c] != 0 && counts[c] < fewest ? counts[c] : fewest;
    }
    const bool pays = sum != 0 && sum <= most && fewest <= 0.8 * pending->count;
    divider->held = pays ? others + sum : divider->held;
    return pays;
}

static bool is_divided(Divider* divider, const Pending* pending, uint32_t counts[LS_BLOCK_CELLS],
                       bool* memory)
{
    const bool may_be = divider->former != NULL
                            ? pending->former != LS_NONE && divider->kept[pending->former]
                            : pending->count > divider->above;
    return may_be && division_pays(divider, pending, counts, memory);
}

// Octant distances of a 4^3 block by its filled cells; outside counts as empty.
static uint32_t distance_word(uint64_t filled, int x, int y, int z)
{
    uint32_t word = 0;
    for (int octant = 0; octant < 8; octant++)
    {
        uint32_t distance = 15;
        for (int k = 1; k < 4 && distance == 15; k++)
        {
            for (int i = 0; i < (k + 1) * (k + 1) * (k + 1) && distance == 15; i++)
            {
                int dx = i % (k + 1), dy = i / (k + 1) % (k + 1), dz = i / ((k + 1) * (k + 1));
                int cx = octant & 1 ? x - dx : x + dx, cy = octant & 2 ? y - dy : y + dy;
                int cz = octant & 4 ? z - dz : z + dz;
                bool inside = cx >= 0 && cx < 4 && cy >= 0 && cy < 4 && cz >= 0 && cz < 4;
                if (inside && (filled >> (cx + 4 * cy + 16 * cz) & 1) != 0)
                {
                    distance = (uint32_t)k;
                }
            }
        }
        word |= distance << (4 * octant);
    }
    return word;
}

// A BVH over the voxel's triangles, each boxed by its part inside the voxel; boxes grown as SPEC 6
// says.
static bool make_bvh(Divider* divider, LsWorkVoxel* voxel, uint32_t* references, uint32_t count)
{
    LsSubtree* tree = divider->tree;
    LsBox* boxes = malloc(sizeof(LsBox) * count);
    uint32_t* order = malloc(sizeof(uint32_t) * count);
    uint32_t* permuted = malloc(sizeof(uint32_t) * count);
    bool ok = boxes != NULL && order != NULL && permuted != NULL &&
              reserve((void**)&tree->leaf_nodes, &divider->leaf_node_capacity,
                      (uint64_t)tree->leaf_node_count + 2ull * count, sizeof(LsBvhNode));
    if (ok)
    {
        double size = level_size(voxel->level), grow = divider->grow;
        for (uint32_t i = 0; i < count; i++)
        {
            double corners[3][3];
            LsOverlap triangle = prepare(divider, references[i], corners);
            for (int axis = 0; axis < 3; axis++)
            {
                double low = voxel->cell[axis] * size - grow,
                       high = (voxel->cell[axis] + 1) * size + grow;
                boxes[i].lower[axis] = fmin(fmax(triangle.lower[axis], low), high) - 2.0 * grow;
                boxes[i].upper[axis] = fmax(fmin(triangle.upper[axis], high), low) + 2.0 * grow;
            }
            order[i] = i;
        }
        voxel->kind = LS_VOXEL_BVH;
        voxel->table = tree->leaf_node_count;
        tree->leaf_node_count +=
            ls_bvh_build(boxes, order, count, BVH_LEAF_TRIANGLES, tree->leaf_nodes + voxel->table);
        for (uint32_t i = 0; i < count; i++)
        {
            permuted[i] = references[order[i]];
        }
        memcpy(references, permuted, sizeof(uint32_t) * count);
    }
    free(boxes);
    free(order);
    free(permuted);
    return ok;
}

static double bvh_work(const LsBvhNode* nodes, const LsWorkVoxel* voxel)
{
    return ls_voxel_visits(voxel) *
           (LS_STEP_COST * ls_leaf_bvh_boxes(nodes, voxel) + ls_leaf_bvh_tests(nodes, voxel));
}

// What a voxel that is divided would be with a BVH.
static bool weigh_whole(Divider* divider, const Pending* pending, LsDivision* division)
{
    LsSubtree* tree = divider->tree;
    LsWorkVoxel voxel = pending->voxel;
    uint32_t* references = malloc(sizeof(uint32_t) * pending->count);
    if (references == NULL)
    {
        return false;
    }
    memcpy(references, pending->references, sizeof(uint32_t) * pending->count);
    const uint32_t before = tree->leaf_node_count;
    const bool ok = make_bvh(divider, &voxel, references, pending->count);
    if (ok)
    {
        *division = (LsDivision){
            .parent = pending->parent,
            .whole_work = bvh_work(tree->leaf_nodes + before, &voxel),
            .whole_bytes = sizeof(uint32_t) * (uint64_t)pending->count +
                           sizeof(LsBvhNode) * (uint64_t)(tree->leaf_node_count - before),
        };
        tree->leaf_node_count = before;
    }
    free(references);
    return ok;
}

// What a voxel of a sub-grid adds to it.
static void weigh_child(LsDivision* division, const LsSubtree* tree, const LsWorkVoxel* voxel)
{
    const double visits = ls_voxel_visits(voxel);
    division->divided_bytes +=
        sizeof(LsVoxel) + sizeof(uint32_t) * (uint64_t)voxel->reference_count;
    switch (voxel->kind)
    {
    case LS_VOXEL_LIST:
        division->divided_work += visits * voxel->reference_count;
        break;
    case LS_VOXEL_BVH:
        division->divided_work += bvh_work(tree->leaf_nodes + voxel->table, voxel);
        division->divided_bytes +=
            sizeof(LsBvhNode) * (uint64_t)tree->leaf_nodes[voxel->table].escape;
        break;
    case LS_VOXEL_MASKS:
        division->mask_visits += visits;
        division->mask_tests += visits * voxel->reference_count;
        division->mask_references += voxel->reference_count;
        break;
    default: // a sub-grid, which is a division of its own
        break;
    }
}

// What the sub-grids are, once all is settled.
static void weigh_divided(const LsSubtree* tree)
{
    for (uint32_t b = 0; b < tree->block_count; b++)
    {
        const LsCellBlock* block = &tree->blocks[b];
        LsDivision* division = &tree->divisions[b];
        double visits = 0.0; // of its voxel: 16 times those of any of its cells
        division->divided_bytes = sizeof(LsCellBlock) + sizeof(uint32_t);
        for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
        {
            if ((block->cells[c] & 15u) == 0)
            {
                const LsWorkVoxel* child = &tree->voxels[block->cells[c] >> 4];
                visits = 16.0 * ls_voxel_visits(child);
                weigh_child(division, tree, child);
            }
        }
        division->divided_work += visits * LS_STEP_COST * ls_subgrid_steps(block);
    }
}

static bool append_references(Divider* divider, LsWorkVoxel* voxel, const uint32_t* references,
                              uint32_t count)
{
    LsSubtree* tree = divider->tree;
    if (!reserve((void**)&tree->references, &divider->reference_capacity,
                 (uint64_t)tree->reference_count + count, sizeof(uint32_t)))
    {
        return false;
    }
    voxel->first_reference = tree->reference_count;
    voxel->reference_count = count;
    memcpy(tree->references + tree->reference_count, references, sizeof(uint32_t) * count);
    tree->reference_count += count;
    return true;
}

static bool push(Divider* divider, Pending pending)
{
    if (!reserve((void**)&divider->queue, &divider->queue_capacity,
                 (uint64_t)divider->queue_count + 1, sizeof(Pending)))
    {
        return false;
    }
    divider->queue[divider->queue_count++] = pending;
    return true;
}

// The children's voxels, in cell order; those that are crowded themselves wait in the queue.
static bool make_children(Divider* divider, const Pending* pending, uint32_t block,
                          const uint32_t counts[LS_BLOCK_CELLS])
{
    LsSubtree* tree = divider->tree;
    uint64_t filled = 0;
    for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
    {
        filled |= (uint64_t)(counts[c] != 0) << c;
    }
    for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
    {
        uint32_t x = c & 3, y = c >> 2 & 3, z = c >> 4;
        if (counts[c] == 0)
        {
            tree->blocks[block].cells[c] = distance_word(filled, (int)x, (int)y, (int)z);
            continue;
        }
        const uint32_t* cell = pending->voxel.cell;
        LsWorkVoxel child = {.cell = {4 * cell[0] + x, 4 * cell[1] + y, 4 * cell[2] + z},
                             .level = pending->voxel.level + 1,
                             .kind = ls_voxel_kind(counts[c])};
        uint32_t* references = malloc(sizeof(uint32_t) * counts[c]);
        if (references == NULL)
        {
            return false;
        }
        uint32_t count = 0;
        for (uint32_t i = 0; i < pending->count; i++)
        {
            if (divider->touched[i] >> c & 1)
            {
                references[count++] = pending->references[i];
            }
        }
        if (!reserve((void**)&tree->voxels, &divider->voxel_capacity,
                     (uint64_t)tree->voxel_count + 1, sizeof(LsWorkVoxel)))
        {
            free(references);
            return false;
        }
        tree->blocks[block].cells[c] = tree->voxel_count << 4;
        uint32_t slot = tree->voxel_count++;
        uint32_t former = LS_NONE;
        if (divider->former != NULL)
        {
            const LsSubtree* all = divider->former;
            const LsWorkVoxel* same = &all->voxels[all->blocks[pending->former].cells[c] >> 4];
            former = same->kind == LS_VOXEL_SUBGRID ? same->table : LS_NONE;
        }
        tree->voxels[slot] = child;
        Pending next = {.voxel = child,
                        .references = references,
                        .count = count,
                        .parent = block,
                        .slot = slot,
                        .former = former};
        if (!push(divider, next))
        {
            free(references);
            return false;
        }
    }
    return true;
}

// Settles one voxel: whole, divided, or a BVH.
static bool settle(Divider* divider, Pending* pending, LsWorkVoxel* voxel)
{
    LsSubtree* tree = divider->tree;
    bool is_grid = pending->slot == LS_NONE;
    *voxel = pending->voxel;
    uint32_t counts[LS_BLOCK_CELLS];
    bool memory = true;
    if (!is_divided(divider, pending, counts, &memory))
    {
        voxel->kind = ls_voxel_kind(pending->count);
        const bool ok = pending->count <= LS_MASK_TRIANGLES ||
                        make_bvh(divider, voxel, pending->references, pending->count);
        return memory && ok &&
               (is_grid || append_references(divider, voxel, pending->references, pending->count));
    }
    uint32_t block = tree->block_count;
    uint32_t parents_capacity = divider->block_capacity;
    uint32_t divisions_capacity = divider->block_capacity;
    if (!reserve((void**)&tree->blocks, &divider->block_capacity, (uint64_t)block + 1,
                 sizeof(LsCellBlock)) ||
        !reserve((void**)&tree->parents, &parents_capacity, (uint64_t)block + 1,
                 sizeof(uint32_t)) ||
        (divider->is_weighed && (!reserve((void**)&tree->divisions, &divisions_capacity,
                                          (uint64_t)block + 1, sizeof(LsDivision)) ||
                                 !weigh_whole(divider, pending, &tree->divisions[block]))))
    {
        return false;
    }
    tree->block_count++;
    tree->parents[block] = pending->parent;
    voxel->kind = LS_VOXEL_SUBGRID;
    voxel->table = block;
    voxel->first_reference = tree->reference_count;
    voxel->reference_count = 0;
    return make_children(divider, pending, block, counts);
}

// Settles a voxel of the grid and all below it.
static bool settle_all(Divider* divider, Pending root, LsWorkVoxel* voxel)
{
    bool ok = settle(divider, &root, voxel);
    for (uint32_t i = 0; i < divider->queue_count; i++)
    {
        Pending pending = divider->queue[i];
        LsWorkVoxel settled = pending.voxel;
        ok = ok && settle(divider, &pending, &settled);
        if (ok)
        {
            divider->tree->voxels[pending.slot] = settled;
        }
        free(pending.references);
    }
    free(divider->queue);
    free(divider->touched);
    LsSubtree* tree = divider->tree;
    if (tree->leaf_node_count == 0) // but room for those that were weighed
    {
        free(tree->leaf_nodes);
        tree->leaf_nodes = NULL;
    }
    return ok;
}

// Divides once more, and no more than is worth its bytes.
static bool settle_worthy(const Divider* divider, Pending root, double price, LsWorkVoxel* voxel)
{
    LsSubtree all = *divider->tree;
    double* costs = malloc(sizeof(double) * all.block_count);
    bool* kept = malloc(sizeof(bool) * all.block_count);
    bool ok = costs != NULL && kept != NULL, is_all = true;
    if (ok)
    {
        ls_divisions_choose(all.divisions, all.block_count, price, costs, kept);
    }
    for (uint32_t i = 0; ok && i < all.block_count; i++)
    {
        is_all = is_all && kept[i];
    }
    if (ok && !is_all)
    {
        *divider->tree = (LsSubtree){0};
        Divider again = {.tree = divider->tree,
                         .mesh = divider->mesh,
                         .frame = divider->frame,
                         .grow = divider->grow,
                         .former = &all,
                         .kept = kept,
                         .held = root.count,
                         .most = UINT64_MAX};
        ok = settle_all(&again, root, voxel);
        ls_subtree_destroy(&all);
    }
    free(costs);
    free(kept);
    return ok;
}

bool ls_subtree_create(LsSubtree* tree, LsWorkVoxel* voxel, const LsMesh* mesh,
                       const LsGridFrame* frame, const LsDivisionRule* rule, uint64_t most,
                       uint32_t* references)
{
    *tree = (LsSubtree){0};
    if (voxel->reference_count <= rule->above && voxel->reference_count <= LS_MASK_TRIANGLES)
    {
        voxel->kind = ls_voxel_kind(voxel->reference_count);
        return true;
    }
    Divider divider = {.tree = tree,
                       .mesh = mesh,
                       .frame = frame,
                       .grow = frame->bound * (1.0 + 1e-6),
                       .above = rule->above,
                       .is_weighed = rule->is_weighed,
                       .held = voxel->reference_count,
                       .most = most};
    const Pending root = {.voxel = *voxel,
                          .references = references,
                          .count = voxel->reference_count,
                          .parent = LS_NONE,
                          .slot = LS_NONE};
    bool ok = settle_all(&divider, root, voxel);
    if (ok && rule->is_weighed && tree->block_count > 0)
    {
        weigh_divided(tree);
        ok = rule->price == 0.0 || settle_worthy(&divider, root, rule->price, voxel);
    }
    return ok;
}

void ls_subtree_destroy(LsSubtree* tree)
{
    free(tree->blocks);
    free(tree->parents);
    free(tree->voxels);
    free(tree->references);
    free(tree->leaf_nodes);
    free(tree->divisions);
    *tree = (LsSubtree){0};
}
