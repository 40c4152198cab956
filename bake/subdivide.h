// subdivide.h - what becomes of a voxel by its count of triangles: a list, masks, a sub-grid or a
// BVH.

#ifndef LS_SUBDIVIDE_H
#define LS_SUBDIVIDE_H

#include "division.h"
#include "grid_frame.h"

// What lies below one voxel of the grid. All indices are local: blocks and voxels count from 0,
// parents of the first block are LS_NONE. Owns its arrays; all empty for a voxel that stays whole
// without a BVH.
typedef struct LsSubtree
{
    LsCellBlock* blocks; // links count voxels of this tree
    uint32_t* parents;
    uint32_t block_count;
    LsWorkVoxel* voxels; // in the order of the cells of the blocks
    uint32_t voxel_count;
    uint32_t* references;
    uint32_t reference_count;
    LsBvhNode* leaf_nodes;
    uint32_t leaf_node_count;
    LsDivision* divisions; // of the blocks, if they are weighed at no price
} LsSubtree;

// Decides the voxel's kind. `references` is the voxel's list, sorted; a BVH leaf permutes it. A
// voxel that is divided loses its own references (reference_count becomes 0). Division ends at
// `rule->above` triangles, at the frame's depth, where the children together would hold more than
// four times the references, or none of them clearly fewer, and where the tree would hold more than
// `most` in all; of what is divided so far only what is worth it stays, if that is weighed. The
// rule's price is of a line that visits the voxel's cell. False when out of memory.
bool ls_subtree_create(LsSubtree* tree, LsWorkVoxel* voxel, const LsMesh* mesh,
                       const LsGridFrame* frame, const LsDivisionRule* rule, uint64_t most,
                       uint32_t* references);
void ls_subtree_destroy(LsSubtree* tree);

#endif
