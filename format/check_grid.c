// check_grid.c - SPEC chapter 5: blocks, cells and sub-grids of an object.

#include "check.h"

// What the pass over an object's cells carries along.
typedef struct GridPass
{
    const LsObject* object;
    const uint32_t* subgrids;
    const LsVoxel* voxels;
    uint32_t grid_block_count; // cell blocks that are no sub-grids
    uint32_t next_block;
    uint32_t next_voxel;
    uint32_t linked_subgrids;
} GridPass;

static bool is_empty_word(uint32_t word)
{
    // No nibble is zero: borrow reaches a nibble's high bit only from a zero.
    return ((word - 0x11111111u) & ~word & 0x88888888u) == 0;
}

// Whether `table` was already linked by an earlier sub-grid voxel of the same block.
static bool find_table(const LsVoxel* voxels, uint32_t first, uint32_t end, uint32_t table)
{
    for (uint32_t i = first; i < end; ++i)
    {
        if ((voxels[i].shape & 255) == LS_VOXEL_SUBGRID && voxels[i].table == table)
        {
            return true;
        }
    }
    return false;
}

// R5.7 for voxel `voxel` of kind sub-grid, the voxels of its block beginning at `first`. A sub-grid
// is linked only from its parent block, so no two links alike within each block is enough.
static LsResult check_subgrid_link(const LsCheck* check, GridPass* pass, uint32_t block,
                                   uint32_t first, uint32_t voxel)
{
    const uint32_t table = pass->voxels[voxel].table;
    if (table < pass->grid_block_count || table >= pass->object->cell_block_count ||
        pass->subgrids[table - pass->grid_block_count] != block ||
        find_table(pass->voxels, first, voxel, table))
    {
        return ls_check_report(
            check, "R5.7", LS_CHUNK_VOXELS, (uint64_t)pass->object->first_voxel + voxel,
            "links cell block %u, which is no sub-grid of block %u or linked twice", table, block);
    }
    ++pass->linked_subgrids;
    return LS_OK;
}

// Checks the words of cell block `block`, of which `inside` cells per axis lie in the grid.
static LsResult check_cell_block(const LsCheck* check, GridPass* pass, uint32_t block,
                                 const uint32_t inside[3])
{
    const uint64_t record = (uint64_t)pass->object->first_cell_block + block;
    const uint32_t* cells = check->file->cell_blocks[record].cells;
    const uint32_t first_voxel = pass->next_voxel;
    for (uint32_t i = 0; i < LS_BLOCK_CELLS; ++i)
    {
        const uint32_t word = cells[i];
        if (is_empty_word(word))
        {
            continue;
        }
        const uint32_t voxel = word >> 4;
        if ((word & 15) != 0 || voxel >= pass->object->voxel_count)
        {
            return ls_check_report(
                check, "R5.3", LS_CHUNK_CELL_BLOCKS, record,
                "cell %u is 0x%08x, neither empty nor a link to one of %u voxels", i, word,
                pass->object->voxel_count);
        }
        if (voxel != pass->next_voxel)
        {
            return ls_check_report(check, "R5.4", LS_CHUNK_CELL_BLOCKS, record,
                                   "cell %u links voxel %u, the next in order is %u", i, voxel,
                                   pass->next_voxel);
        }
        if (i % 4 >= inside[0] || i / 4 % 4 >= inside[1] || i / 16 >= inside[2])
        {
            return ls_check_report(check, "R5.5", LS_CHUNK_CELL_BLOCKS, record,
                                   "cell %u lies outside the grid and is not empty", i);
        }
        ++pass->next_voxel;
        if ((pass->voxels[voxel].shape & 255) == LS_VOXEL_SUBGRID)
        {
            const LsResult result = check_subgrid_link(check, pass, block, first_voxel, voxel);
            if (result != LS_OK)
            {
                return result;
            }
        }
    }
    return LS_OK;
}

// Checks word `index` of the object's BLOCKS, and the cell block that it links.
static LsResult check_block(const LsCheck* check, GridPass* pass, uint32_t index)
{
    const LsObject* object = pass->object;
    const uint64_t record = (uint64_t)object->first_block + index;
    const uint32_t word = check->file->blocks[record];
    if (is_empty_word(word))
    {
        return LS_OK;
    }
    const uint32_t block = word >> 4;
    if ((word & 15) != 0 || block >= object->cell_block_count)
    {
        return ls_check_report(check, "R5.3", LS_CHUNK_BLOCKS, record,
                               "0x%08x is neither empty nor a link to one of %u cell blocks", word,
                               object->cell_block_count);
    }
    if (block != pass->next_block || block >= pass->grid_block_count)
    {
        return ls_check_report(check, "R5.4", LS_CHUNK_BLOCKS, record,
                               "links cell block %u, the next in order is %u of %u", block,
                               pass->next_block, pass->grid_block_count);
    }
    ++pass->next_block;
    uint32_t inside[3];
    uint32_t place = index;
    for (int axis = 0; axis < 3; ++axis)
    {
        const uint32_t blocks = count_blocks_along(object, axis);
        inside[axis] = object->cells[axis] - place % blocks * LS_BLOCK_SIDE;
        place /= blocks;
    }
    return check_cell_block(check, pass, block, inside);
}

// R5.6: parents come before their sub-grids, and the levels end at the object's depth.
static LsResult check_subgrids(const LsCheck* check, const GridPass* pass)
{
    const LsObject* object = pass->object;
    uint32_t depth = 0;
    for (uint32_t s = 0; s < object->subgrid_count; ++s)
    {
        const uint64_t record = (uint64_t)object->first_subgrid + s;
        if (pass->subgrids[s] >= pass->grid_block_count + s)
        {
            return ls_check_report(check, "R5.6", LS_CHUNK_SUBGRIDS, record,
                                   "parent block %u, its own is %u", pass->subgrids[s],
                                   pass->grid_block_count + s);
        }
        uint32_t level = 1;
        uint32_t parent = pass->subgrids[s];
        while (parent >= pass->grid_block_count && level <= object->depth)
        {
            parent = pass->subgrids[parent - pass->grid_block_count];
            ++level;
        }
        if (level > object->depth)
        {
            return ls_check_report(check, "R5.6", LS_CHUNK_SUBGRIDS, record,
                                   "deeper than the object's depth %u", object->depth);
        }
        depth = level > depth ? level : depth;
    }
    if (depth != object->depth)
    {
        return ls_check_report(check, "R5.6", LS_CHUNK_OBJECTS,
                               (uint64_t)(object - check->file->objects),
                               "depth %u, its sub-grids reach %u", object->depth, depth);
    }
    return LS_OK;
}

LsResult ls_check_grid(const LsCheck* check, uint32_t object_index)
{
    const LsFile* file = check->file;
    const LsObject* object = &file->objects[object_index];
    GridPass pass = {
        .object = object,
        .subgrids = PART(file->subgrids, object->first_subgrid),
        .voxels = PART(file->voxels, object->first_voxel),
        .grid_block_count = object->cell_block_count - object->subgrid_count,
    };
    LsResult result = check_subgrids(check, &pass);
    for (uint32_t i = 0; i < object->block_count && result == LS_OK; ++i)
    {
        result = check_block(check, &pass, i);
    }
    static const uint32_t whole[3] = {LS_BLOCK_SIDE, LS_BLOCK_SIDE, LS_BLOCK_SIDE};
    for (uint32_t s = 0; s < object->subgrid_count && result == LS_OK; ++s)
    {
        result = check_cell_block(check, &pass, pass.grid_block_count + s, whole);
    }
    if (result != LS_OK)
    {
        return result;
    }
    if (pass.next_block != pass.grid_block_count || pass.next_voxel != object->voxel_count)
    {
        return ls_check_report(check, "R5.4", LS_CHUNK_OBJECTS, object_index,
                               "%u of %u cell blocks and %u of %u voxels are linked",
                               pass.next_block, pass.grid_block_count, pass.next_voxel,
                               object->voxel_count);
    }
    if (pass.linked_subgrids != object->subgrid_count)
    {
        return ls_check_report(check, "R5.7", LS_CHUNK_OBJECTS, object_index,
                               "%u of %u sub-grids are linked", pass.linked_subgrids,
                               object->subgrid_count);
    }
    return LS_OK;
}
