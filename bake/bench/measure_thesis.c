// measure_thesis.c - the bake that F.-L. Schröder's thesis (2017, section 9) times, with our exact test: no sub-grids,
// and for every voxel a mask as wide as its number of triangles for each of its 15 N^4 shafts, however many that is.
//
//     measure_thesis SCENE GRID PATCHES [THREADS]
//
// Makes all masks in memory, writes nothing, and prints what it took. The first object counts.

#include "compose.h"
#include "linespace.h"
#include "tables.h"
#include "voxels.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct Measure
{
    LsInput input;
    LsMesh mesh;
    LsVoxels voxels;
    uint32_t patches, threads;
    uint64_t pair_count;   // of triangle and shaft
    uint64_t filled_pairs; // that may meet
    uint64_t mask_bytes;
    double seconds[4]; // import, mesh, voxels, masks
} Measure;

static uint32_t count_bits(uint32_t word)
{
    return (uint32_t)__builtin_popcount(word);
}

static void load_corners(const Measure* measure, const LsWorkVoxel* voxel, uint32_t first,
                         uint32_t count, double corners[LS_MASK_TRIANGLES][3][3])
{
    const LsVoxels* voxels = &measure->voxels;
    for (uint32_t i = 0; i < count; i++)
    {
        const LsTriangle* triangle =
            &measure->mesh.triangles[voxels->references[voxel->first_reference + first + i]];
        ls_grid_point(&voxels->frame, triangle->v0, corners[i][0]);
        ls_grid_point(&voxels->frame, triangle->v1, corners[i][1]);
        ls_grid_point(&voxels->frame, triangle->v2, corners[i][2]);
        for (int k = 0; k < 9; k++)
        {
            corners[i][k / 3][k % 3] -= voxel->cell[k % 3];
        }
    }
}

// Masks of one voxel, 32 triangles at a time, kept in memory that the caller frees with all others. NULL when out of
// memory.
static uint32_t* mark_voxel(Measure* measure, const LsWorkVoxel* voxel, LsShaftScratch* scratch,
                            uint64_t* filled)
{
    const uint32_t shafts = LS_SHAFT_COUNT(measure->patches);
    const uint32_t groups = (voxel->reference_count + LS_MASK_TRIANGLES - 1) / LS_MASK_TRIANGLES;
    uint32_t* masks = malloc(sizeof(uint32_t) * (size_t)shafts * groups);
    for (uint32_t group = 0; masks != NULL && group < groups; group++)
    {
        double corners[LS_MASK_TRIANGLES][3][3];
        const uint32_t first = group * LS_MASK_TRIANGLES;
        const uint32_t rest = voxel->reference_count - first;
        const uint32_t count = rest < LS_MASK_TRIANGLES ? rest : LS_MASK_TRIANGLES;
        uint32_t* words = masks + (size_t)group * shafts;
        load_corners(measure, voxel, first, count, corners);
        ls_shafts_mark((const double(*)[3][3])corners, count, measure->voxels.frame.bound,
                       measure->patches, words, scratch);
        for (uint32_t i = 0; i < shafts; i++)
        {
            *filled += count_bits(words[i]);
        }
    }
    return masks;
}

static bool mark_all(Measure* measure)
{
    const LsVoxels* voxels = &measure->voxels;
    const uint32_t shafts = LS_SHAFT_COUNT(measure->patches);
    uint32_t** masks = calloc(voxels->voxel_count + 1, sizeof *masks);
    bool ok = masks != NULL;
    uint64_t pairs = 0, filled = 0, bytes = 0;
#pragma omp parallel num_threads(measure->threads) reduction(+ : pairs, filled, bytes) if (ok)
    {
        LsShaftScratch* scratch = ls_shaft_scratch_create();
#pragma omp for schedule(dynamic, 4)
        for (uint32_t i = 0; i < voxels->voxel_count; i++)
        {
            const LsWorkVoxel* voxel = &voxels->voxels[i];
            masks[i] = scratch != NULL ? mark_voxel(measure, voxel, scratch, &filled) : NULL;
            pairs += (uint64_t)voxel->reference_count * shafts;
            bytes += ((uint64_t)voxel->reference_count * shafts + 7) / 8;
            if (masks[i] == NULL)
            {
#pragma omp atomic write
                ok = false;
            }
        }
        ls_shaft_scratch_destroy(scratch);
    }
    for (uint32_t i = 0; masks != NULL && i < voxels->voxel_count; i++)
    {
        free(masks[i]);
    }
    free(masks);
    measure->pair_count = pairs;
    measure->filled_pairs = filled;
    measure->mask_bytes = bytes;
    return ok;
}

static LsResult run(Measure* measure, const LsBakeDesc* desc, LsError* error)
{
    double begin = omp_get_wtime();
    LsResult result = ls_compose(&measure->input, desc, NULL, NULL, error);
    measure->seconds[0] = omp_get_wtime() - begin;
    if (result == LS_OK)
    {
        LsMeshFindings findings;
        begin = omp_get_wtime();
        result = ls_mesh_create(&measure->mesh, &measure->input, 0, desc, measure->threads, NULL,
                                &findings, error);
        measure->seconds[1] = omp_get_wtime() - begin;
    }
    if (result == LS_OK)
    {
        begin = omp_get_wtime();
        const LsDivisionRule never = {.above = LS_MASK_TRIANGLES};
        result = ls_voxels_create(&measure->voxels, &measure->mesh, desc->grid, &never,
                                  measure->threads, NULL, error);
        measure->seconds[2] = omp_get_wtime() - begin;
    }
    if (result == LS_OK)
    {
        begin = omp_get_wtime();
        result = mark_all(measure)
                     ? LS_OK
                     : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for masks");
        measure->seconds[3] = omp_get_wtime() - begin;
    }
    return result;
}

static void print(const Measure* measure)
{
    const LsVoxels* voxels = &measure->voxels;
    uint32_t widest = 0;
    for (uint32_t i = 0; i < voxels->voxel_count; i++)
    {
        const uint32_t count = voxels->voxels[i].reference_count;
        widest = count > widest ? count : widest;
    }
    printf("triangles %u, grid %u x %u x %u, N = %u, threads %u\n", measure->mesh.triangle_count,
           voxels->frame.cells[0], voxels->frame.cells[1], voxels->frame.cells[2], measure->patches,
           measure->threads);
    printf("voxels %u, references %u, %u in the fullest voxel\n", voxels->voxel_count,
           voxels->reference_count, widest);
    printf("pairs of triangle and shaft %.2f G, %.1f %% may meet, masks %.0f MB\n",
           (double)measure->pair_count * 1e-9,
           100.0 * (double)measure->filled_pairs / (double)measure->pair_count,
           (double)measure->mask_bytes * 1e-6);
    printf("import %.2f s, mesh %.2f s, voxels %.2f s, masks %.2f s\n", measure->seconds[0],
           measure->seconds[1], measure->seconds[2], measure->seconds[3]);
}

int main(int argc, char** argv)
{
    if (argc != 4 && argc != 5)
    {
        fputs("usage: measure_thesis SCENE GRID PATCHES [THREADS]\n", stderr);
        return EXIT_FAILURE;
    }
    const LsBakeInput input = {.path = argv[1]};
    const LsBakeDesc desc = {
        .inputs = &input, .input_count = 1, .grid = (uint32_t)strtoul(argv[2], NULL, 10)};
    static Measure measure;
    measure.patches = (uint32_t)strtoul(argv[3], NULL, 10);
    measure.threads = argc == 5 ? (uint32_t)strtoul(argv[4], NULL, 10) : 2;
    if (desc.grid < 1 || desc.grid > LS_MAX_CELLS || measure.patches < 1 ||
        measure.patches > LS_MAX_PATCHES || measure.threads < 1)
    {
        fputs("measure_thesis: GRID is 1 to 4096, PATCHES 1 to 16, THREADS at least 1\n", stderr);
        return EXIT_FAILURE;
    }
    LsError error;
    const LsResult result = run(&measure, &desc, &error);
    if (result == LS_OK)
    {
        print(&measure);
    }
    else
    {
        fprintf(stderr, "measure_thesis: %s\n", error.text);
    }
    ls_voxels_destroy(&measure.voxels);
    ls_mesh_destroy(&measure.mesh);
    ls_input_destroy(&measure.input);
    return result == LS_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
