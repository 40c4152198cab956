// voxel_masks.c - brings a voxel's triangles into the unit cube and marks their shafts.

#include "voxel_masks.h"

bool ls_voxel_masks_create(LsVoxelMasks* masks, const LsVoxels* voxels, const LsMesh* mesh)
{
    *masks = (LsVoxelMasks){.voxels = voxels, .mesh = mesh, .scratch = ls_shaft_scratch_create()};
    return masks->scratch != NULL;
}

void ls_voxel_masks_destroy(LsVoxelMasks* masks)
{
    ls_shaft_scratch_destroy(masks->scratch);
    *masks = (LsVoxelMasks){0};
}

static void corners_in_voxel(const LsGridFrame* frame, const LsWorkVoxel* voxel,
                             const LsTriangle* triangle, double corners[3][3])
{
    const double scale = (double)(1u << (2 * voxel->level));
    ls_grid_point(frame, triangle->v0, corners[0]);
    ls_grid_point(frame, triangle->v1, corners[1]);
    ls_grid_point(frame, triangle->v2, corners[2]);
    for (int k = 0; k < 9; k++)
    {
        corners[k / 3][k % 3] = corners[k / 3][k % 3] * scale - voxel->cell[k % 3];
    }
}

void ls_voxel_masks_begin(LsVoxelMasks* masks, const LsWorkVoxel* voxel)
{
    const LsGridFrame* frame = &masks->voxels->frame;
    masks->count = voxel->reference_count;
    masks->bound = (double)frame->bound * (double)(1u << (2 * voxel->level));
    for (uint32_t k = 0; k < voxel->reference_count; k++)
    {
        const uint32_t reference = masks->voxels->references[voxel->first_reference + k];
        corners_in_voxel(frame, voxel, &masks->mesh->triangles[reference], masks->corners[k]);
    }
}

void ls_voxel_masks_mark(LsVoxelMasks* masks, uint32_t patches, uint32_t* words)
{
    ls_shafts_mark((const double(*)[3][3])masks->corners, masks->count, masks->bound, patches,
                   words, masks->scratch);
}

void ls_voxel_masks_merge(const uint32_t* words, uint32_t patches, uint32_t merged[15])
{
    const uint32_t square = patches * patches;
    for (uint32_t pair = 0; pair < 15; pair++)
    {
        merged[pair] = 0;
        for (uint32_t i = 0; i < square * square; i++)
        {
            merged[pair] |= words[pair * square * square + i];
        }
    }
}
