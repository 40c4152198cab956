// tables.c - runs the shaft test over all voxels and packs the masks.

#include "tables.h"

#include "linespace.h"
#include "ls_format.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

static void corners_in_voxel(const LsVoxels* voxels, const LsWorkVoxel* voxel,
                             const LsTriangle* triangle, double corners[3][3])
{
    double scale = (double)(1u << (2 * voxel->level));
    ls_grid_point(&voxels->frame, triangle->v0, corners[0]);
    ls_grid_point(&voxels->frame, triangle->v1, corners[1]);
    ls_grid_point(&voxels->frame, triangle->v2, corners[2]);
    for (int k = 0; k < 9; k++)
    {
        corners[k / 3][k % 3] = corners[k / 3][k % 3] * scale - voxel->cell[k % 3];
    }
}

// Packs masks of 32 bits a shaft into `width` bits, one behind the other. Returns the number of masks
// that are not 0.
static uint64_t pack_masks(const uint32_t* masks, uint32_t count, uint32_t width, uint32_t* words)
{
    uint64_t filled = 0;
    uint64_t pending = 0; // bits that no word has yet, fewer than 32 before each mask
    uint32_t pending_count = 0;
    for (uint32_t i = 0; i < count; i++)
    {
        filled += masks[i] != 0;
        pending |= (uint64_t)masks[i] << pending_count;
        pending_count += width;
        if (pending_count >= 32)
        {
            *words++ = (uint32_t)pending;
            pending >>= 32;
            pending_count -= 32;
        }
    }
    if (pending_count > 0)
    {
        *words = (uint32_t)pending;
    }
    return filled;
}

static LsResult place_tables(LsTables* tables, LsVoxels* voxels, uint32_t patches, LsError* error)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < voxels->voxel_count; i++)
    {
        LsWorkVoxel* voxel = &voxels->voxels[i];
        if (voxel->kind == LS_VOXEL_MASKS)
        {
            voxel->table = (uint32_t)sum;
            sum += ls_mask_words(LS_SHAFT_COUNT(patches), voxel->reference_count);
            tables->shaft_count += LS_SHAFT_COUNT(patches);
        }
    }
    if (sum > UINT32_MAX)
    {
        return ls_error_set(error, LS_MESSAGE_LIMIT_RECORDS,
                            "the shaft tables of an object need %llu MiB, more than the format "
                            "holds; use fewer --patches",
                            (unsigned long long)(sum >> 18));
    }
    tables->word_count = (uint32_t)sum;
    tables->words = calloc(sum + 1, sizeof(uint32_t));
    return tables->words != NULL
               ? LS_OK
               : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                              "out of memory for %llu MiB of shaft tables; use fewer --patches",
                              (unsigned long long)(sum >> 18));
}

LsResult ls_tables_create(LsTables* tables, LsVoxels* voxels, const LsMesh* mesh, uint32_t patches,
                          uint32_t threads, const LsStageProgress* progress, LsError* error)
{
    *tables = (LsTables){0};
    LsResult result = place_tables(tables, voxels, patches, error);
    if (result != LS_OK)
    {
        return result;
    }
    uint64_t filled = 0;
    bool ok = true;
    uint32_t shafts = LS_SHAFT_COUNT(patches);
#pragma omp parallel num_threads(threads) reduction(+ : filled) reduction(&& : ok)
    {
        LsShaftScratch* scratch = ls_shaft_scratch_create();
        uint32_t* masks = malloc(sizeof(uint32_t) * shafts);
        ok = ok && scratch != NULL && masks != NULL;
#pragma omp for schedule(dynamic, 32)
        for (uint32_t i = 0; i < voxels->voxel_count; i++)
        {
            const LsWorkVoxel* voxel = &voxels->voxels[i];
            // Voxels go out in order, so the first thread's own says how far all are.
            if (omp_get_thread_num() == 0 && i % 32 == 0)
            {
                ls_stage_note(progress, (double)i / voxels->voxel_count);
            }
            if (!ok || voxel->kind != LS_VOXEL_MASKS)
            {
                continue;
            }
            double corners[LS_MASK_TRIANGLES][3][3];
            for (uint32_t k = 0; k < voxel->reference_count; k++)
            {
                uint32_t reference = voxels->references[voxel->first_reference + k];
                corners_in_voxel(voxels, voxel, &mesh->triangles[reference], corners[k]);
            }
            double bound = (double)voxels->frame.bound * (double)(1u << (2 * voxel->level));
            ls_shafts_mark((const double(*)[3][3])corners, voxel->reference_count, bound, patches,
                           masks, scratch);
            filled +=
                pack_masks(masks, shafts, voxel->reference_count, tables->words + voxel->table);
        }
        free(masks);
        ls_shaft_scratch_destroy(scratch);
    }
    tables->filled_count = filled;
    if (!ok)
    {
        ls_tables_destroy(tables);
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for the shaft test");
    }
    return LS_OK;
}

void ls_tables_destroy(LsTables* tables)
{
    free(tables->words);
    *tables = (LsTables){0};
}
