// survey.c - one voxelization, and the masks of every so many voxels for each N.

#include "survey.h"

#include "ls_format.h"
#include "voxel_masks.h"

#include <stdlib.h>

// What is no matter of N, and the numbers of the voxels that are. False when out of memory.
static bool list_voxels(LsSurvey* survey, const LsVoxels* voxels, uint32_t** listed,
                        uint32_t* listed_count)
{
    *listed = malloc(sizeof(uint32_t) * (voxels->voxel_count + 1ull));
    *listed_count = 0;
    const double cell = survey->visits;
    for (uint32_t i = 0; *listed != NULL && i < voxels->voxel_count; i++)
    {
        const LsWorkVoxel* voxel = &voxels->voxels[i];
        const double visits = cell * ls_voxel_visits(voxel);
        switch (voxel->kind)
        {
        case LS_VOXEL_LIST:
            survey->work += visits * voxel->reference_count;
            break;
        case LS_VOXEL_BVH:
            survey->work += visits * ls_leaf_bvh_tests(voxels->leaf_nodes + voxel->table, voxel);
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
                          const uint32_t* listed, const LsSurveyDesc* desc)
{
    bool ok = true;
#pragma omp parallel num_threads(desc->threads) reduction(&& : ok)
    {
        Sampler sampler = {.words = malloc(sizeof(uint32_t) * LS_SHAFT_COUNT(desc->patches))};
        ok = ls_voxel_masks_create(&sampler.masks, voxels, mesh) && sampler.words != NULL;
#pragma omp for schedule(dynamic, 16)
        for (uint32_t i = 0; i < survey->voxel_count; i++)
        {
            const LsWorkVoxel* voxel = &voxels->voxels[listed[(uint64_t)(i * survey->each)]];
            LsSurveyVoxel* sample = &survey->voxels[i];
            sample->subgrid = LS_NONE;
            sample->visits = survey->visits * ls_voxel_visits(voxel);
            if (ok)
            {
                sample_voxel(&sampler, sample, voxel, desc->weights, desc->patches);
            }
        }
        ls_voxel_masks_destroy(&sampler.masks);
        free(sampler.words);
    }
    return ok;
}

// The voxels of each sub-grid are numbered in a row.
static void find_subgrids(LsSurvey* survey, const LsVoxels* voxels, const uint32_t* listed)
{
    const LsCellBlock* blocks =
        voxels->cell_blocks + (voxels->cell_block_count - voxels->subgrid_count);
    uint32_t sample = 0;
    while (sample < survey->voxel_count &&
           voxels->voxels[listed[(uint64_t)(sample * survey->each)]].level == 0)
    {
        sample++;
    }
    for (uint32_t s = 0; s < voxels->subgrid_count; s++)
    {
        uint32_t last = 0;
        for (uint32_t c = 0; c < LS_BLOCK_CELLS; c++)
        {
            const uint32_t word = blocks[s].cells[c];
            last = (word & 15u) == 0 ? word >> 4 : last;
        }
        for (; sample < survey->voxel_count && listed[(uint64_t)(sample * survey->each)] <= last;
             sample++)
        {
            survey->voxels[sample].subgrid = s;
        }
    }
}

// Sets the divisions apart from the rest.
static bool take_divisions(LsSurvey* survey, LsVoxels* voxels, const uint32_t* listed)
{
    find_subgrids(survey, voxels, listed);
    survey->divisions = voxels->divisions;
    survey->division_count = voxels->subgrid_count;
    voxels->divisions = NULL;
    survey->costs = malloc(sizeof(double) * (survey->division_count + 1ull));
    survey->kept = malloc(sizeof(bool) * (survey->division_count + 1ull));
    for (uint32_t i = 0; i < survey->division_count; i++)
    {
        survey->work -= survey->visits * survey->divisions[i].divided_work;
        survey->bytes -= survey->divisions[i].divided_bytes;
    }
    return survey->costs != NULL && survey->kept != NULL;
}

static bool take_samples(LsSurvey* survey, LsVoxels* voxels, const LsMesh* mesh,
                         const LsSurveyDesc* desc)
{
    uint32_t *listed, listed_count;
    if (!list_voxels(survey, voxels, &listed, &listed_count))
    {
        return false;
    }
    survey->voxel_count = listed_count < desc->samples ? listed_count : desc->samples;
    survey->each = survey->voxel_count > 0 ? (double)listed_count / survey->voxel_count : 1.0;
    survey->voxels = calloc(survey->voxel_count + 1ull, sizeof *survey->voxels);
    const bool ok = survey->voxels != NULL && sample_voxels(survey, voxels, mesh, listed, desc) &&
                    (voxels->divisions == NULL || take_divisions(survey, voxels, listed));
    free(listed);
    return ok;
}

LsResult ls_survey_create(LsSurvey* survey, const LsMesh* mesh, uint32_t grid,
                          const LsSurveyDesc* desc, LsError* error)
{
    *survey = (LsSurvey){.grid = grid};
    LsVoxels voxels;
    LsResult result =
        ls_voxels_create(&voxels, mesh, grid, &desc->rule, desc->threads, NULL, error);
    if (result != LS_OK)
    {
        return result;
    }
    survey->bytes = sizeof(LsTriangle) * (uint64_t)mesh->triangle_count + ls_voxels_bytes(&voxels);
    survey->visits = ls_cell_visits(&voxels.frame);
    survey->work = LS_STEP_COST * ls_expected_steps(&voxels);
    if (!take_samples(survey, &voxels, mesh, desc))
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
    free(survey->divisions);
    free(survey->costs);
    free(survey->kept);
    *survey = (LsSurvey){0};
}

static double table_bytes(uint32_t patches, uint32_t count)
{
    return sizeof(uint32_t) * (double)ls_mask_words(LS_SHAFT_COUNT(patches), count);
}

// The N that a table would be made with, by the same search.
static uint32_t find_patches(const LsSurveyVoxel* voxel, uint32_t most, double price)
{
    double least = voxel->visits * voxel->tests[0];
    uint32_t best = 0;
    bool goes_on = true;
    for (uint32_t n = 1; n <= most && goes_on; n++)
    {
        const double table = table_bytes(n, voxel->count);
        const double cost = voxel->visits * (LS_LOOKUP_COST + voxel->tests[n]) + price * table;
        best = cost < least ? n : best;
        least = cost < least ? cost : least;
        const double hope =
            voxel->visits * ls_expected_saving(n, voxel->tests[n - 1], voxel->tests[n]);
        const double step = price * (table_bytes(n + 1, voxel->count) - table);
        goes_on = n < 2 || cost + step - hope < least;
    }
    return best;
}

// What is divided and what is whole, without masks. Bytes are whole numbers, so they are exact.
static void add_divisions(const LsSurvey* survey, double price, LsOffer* offer)
{
    ls_divisions_choose(survey->divisions, survey->division_count, price / survey->visits,
                        survey->costs, survey->kept);
    double work = 0.0;
    for (uint32_t i = 0; i < survey->division_count; i++)
    {
        const LsDivision* division = &survey->divisions[i];
        const bool is_there = division->parent == LS_NONE || survey->kept[division->parent];
        if (survey->kept[i])
        {
            work += division->divided_work;
            offer->bytes += (double)division->divided_bytes;
        }
        else if (is_there)
        {
            work += division->whole_work;
            offer->bytes += (double)division->whole_bytes;
        }
    }
    offer->work += survey->visits * work;
}

LsOffer ls_survey_offer(const LsSurvey* survey, uint32_t patches, double price)
{
    LsOffer offer = {.work = survey->work, .bytes = (double)survey->bytes};
    add_divisions(survey, price, &offer);
    for (uint32_t i = 0; i < survey->voxel_count; i++)
    {
        const LsSurveyVoxel* voxel = &survey->voxels[i];
        const bool is_there = voxel->subgrid == LS_NONE || survey->kept[voxel->subgrid];
        if (is_there)
        {
            const uint32_t n = find_patches(voxel, patches, price);
            const double lookup = n > 0 ? LS_LOOKUP_COST : 0.0;
            offer.work += survey->each * voxel->visits * (lookup + voxel->tests[n]);
            offer.bytes += n > 0 ? survey->each * table_bytes(n, voxel->count) : 0.0;
        }
    }
    return offer;
}
