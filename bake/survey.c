// survey.c - one voxelization, and the masks of every so many voxels for each N.

#include "survey.h"

#include "ls_format.h"
#include "shaft_cost.h"
#include "voxel_masks.h"

#include <stdlib.h>

// What is no matter of N, and the numbers of the voxels that are. False when out of memory.
static bool list_voxels(LsSurvey* survey, const LsVoxels* voxels, uint32_t** listed,
                        uint32_t* listed_count)
{
    *listed = malloc(sizeof(uint32_t) * (voxels->voxel_count + 1ull));
    *listed_count = 0;
    const double cell = ls_cell_visits(&voxels->frame);
    for (uint32_t i = 0; *listed != NULL && i < voxels->voxel_count; i++)
    {
        const LsWorkVoxel* voxel = &voxels->voxels[i];
        const double visits = cell * ls_voxel_visits(voxel);
        switch (voxel->kind)
        {
        case LS_VOXEL_LIST:
            survey->tests += visits * voxel->reference_count;
            break;
        case LS_VOXEL_BVH:
            survey->tests += visits * ls_leaf_bvh_tests(voxels->leaf_nodes + voxel->table, voxel);
            break;
        case LS_VOXEL_MASKS:
            (*listed)[(*listed_count)++] = i;
            break;
        default: // a sub-grid, whose voxels are listed themselves
            break;
        }
    }
    return *listed != NULL;
}

// A thread's own.
typedef struct Sampler
{
    LsVoxelMasks masks;
    uint32_t* words;
} Sampler;

static void sample_voxel(Sampler* sampler, LsSurveyVoxel* sample, const LsWorkVoxel* voxel,
                         const LsShaftWeights* weights, uint32_t patches)
{
    sample->count = voxel->reference_count;
    sample->tests[0] = voxel->reference_count;
    ls_voxel_masks_begin(&sampler->masks, voxel);
    for (uint32_t n = patches; n > 0; n--)
    {
        uint32_t merged[15];
        if (n > 1)
        {
            ls_voxel_masks_mark(&sampler->masks, n, sampler->words);
        }
        else if (patches > 1) // as tables are made: of the masks of 2
        {
            ls_voxel_masks_merge(sampler->words, 2, merged);
        }
        else
        {
            ls_voxel_masks_mark(&sampler->masks, 1, merged);
        }
        sample->tests[n] = ls_shaft_tests(&weights[n], n > 1 ? sampler->words : merged);
    }
}

static bool sample_voxels(LsSurvey* survey, const LsVoxels* voxels, const LsMesh* mesh,
                          const uint32_t* listed, const LsShaftWeights* weights, uint32_t patches,
                          uint32_t threads)
{
    const double cell = ls_cell_visits(&voxels->frame);
    bool ok = true;
#pragma omp parallel num_threads(threads) reduction(&& : ok)
    {
        Sampler sampler = {.words = malloc(sizeof(uint32_t) * LS_SHAFT_COUNT(patches))};
        ok = ls_voxel_masks_create(&sampler.masks, voxels, mesh) && sampler.words != NULL;
#pragma omp for schedule(dynamic, 16)
        for (uint32_t i = 0; i < survey->voxel_count; i++)
        {
            const LsWorkVoxel* voxel = &voxels->voxels[listed[(uint64_t)(i * survey->each)]];
            LsSurveyVoxel* sample = &survey->voxels[i];
            sample->visits = cell * ls_voxel_visits(voxel);
            if (ok)
            {
                sample_voxel(&sampler, sample, voxel, weights, patches);
            }
        }
        ls_voxel_masks_destroy(&sampler.masks);
        free(sampler.words);
    }
    return ok;
}

static bool take_samples(LsSurvey* survey, const LsVoxels* voxels, const LsMesh* mesh,
                         uint32_t samples, uint32_t patches, uint32_t threads)
{
    uint32_t *listed, listed_count;
    if (!list_voxels(survey, voxels, &listed, &listed_count))
    {
        return false;
    }
    survey->voxel_count = listed_count < samples ? listed_count : samples;
    survey->each = survey->voxel_count > 0 ? (double)listed_count / survey->voxel_count : 1.0;
    survey->voxels = calloc(survey->voxel_count + 1ull, sizeof *survey->voxels);
    LsShaftWeights weights[LS_MAX_CHOSEN_PATCHES + 1] = {0};
    bool ok = survey->voxels != NULL;
    for (uint32_t n = 1; n <= patches && ok; n++)
    {
        ok = ls_shaft_weights_create(&weights[n], n);
    }
    ok = ok && sample_voxels(survey, voxels, mesh, listed, weights, patches, threads);
    for (uint32_t n = 0; n <= LS_MAX_CHOSEN_PATCHES; n++)
    {
        ls_shaft_weights_destroy(&weights[n]);
    }
    free(listed);
    return ok;
}

LsResult ls_survey_create(LsSurvey* survey, const LsMesh* mesh, uint32_t grid, uint32_t samples,
                          uint32_t patches, uint32_t threads, LsError* error)
{
    *survey = (LsSurvey){.grid = grid};
    LsVoxels voxels;
    LsResult result = ls_voxels_create(&voxels, mesh, grid, LS_MAX_DEPTH, threads, NULL, error);
    if (result != LS_OK)
    {
        return result;
    }
    survey->bytes = sizeof(LsTriangle) * (uint64_t)mesh->triangle_count + ls_voxels_bytes(&voxels);
    survey->steps = ls_expected_steps(&voxels);
    if (!take_samples(survey, &voxels, mesh, samples, patches, threads))
    {
        ls_survey_destroy(survey);
        result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                              "out of memory for a survey of %u cells", grid);
    }
    ls_voxels_destroy(&voxels);
    return result;
}

void ls_survey_destroy(LsSurvey* survey)
{
    free(survey->voxels);
    *survey = (LsSurvey){0};
}

LsOffer ls_survey_offer(const LsSurvey* survey, uint32_t patches, double price)
{
    LsOffer offer = {.work = {.steps = survey->steps, .tests = survey->tests},
                     .bytes = (double)survey->bytes};
    for (uint32_t i = 0; i < survey->voxel_count; i++)
    {
        const LsSurveyVoxel* voxel = &survey->voxels[i];
        double least = voxel->visits * voxel->tests[0], bytes = 0.0;
        uint32_t best = 0;
        for (uint32_t n = 1; n <= patches; n++)
        {
            const double table =
                sizeof(uint32_t) * (double)ls_mask_words(LS_SHAFT_COUNT(n), voxel->count);
            const double cost = voxel->visits * (LS_LOOKUP_COST + voxel->tests[n]) + price * table;
            if (cost < least)
            {
                least = cost;
                best = n;
                bytes = table;
            }
        }
        offer.work.lookups += best > 0 ? survey->each * voxel->visits : 0.0;
        offer.work.tests += survey->each * voxel->visits * voxel->tests[best];
        offer.bytes += survey->each * bytes;
    }
    return offer;
}
