// survey.h - what a grid would cost and take: its voxels, and of some the tests that each N leaves.

#ifndef LS_SURVEY_H
#define LS_SURVEY_H

#include "cost_model.h"
#include "shaft_cost.h"

// A voxel that would have masks, standing for several.
typedef struct LsSurveyVoxel
{
    uint32_t count;                          // triangles
    uint32_t subgrid;                        // that it lies in; LS_NONE: none
    double visits;                           // of a line
    double tests[LS_MAX_CHOSEN_PATCHES + 1]; // in a visit, by N; without masks: count
} LsSurveyVoxel;

// Owns its arrays.
typedef struct LsSurvey
{
    uint32_t grid;  // cells along the longest side, as asked for
    double visits;  // of a line to a cell of the grid
    double work;    // of a line, in triangle tests, without voxels with masks
    uint64_t bytes; // of all records without masks, triangles too
    LsSurveyVoxel* voxels;
    uint32_t voxel_count;
    double each; // voxels that one stands for
    // If they are weighed. Work and bytes above are without them.
    LsDivision* divisions;
    uint32_t division_count;
    double* costs; // of as many, to work with
    bool* kept;
} LsSurvey;

// What of a survey a byte price buys.
typedef struct LsOffer
{
    double work;  // of a line, in triangle tests
    double bytes; // with masks
} LsOffer;

// How a survey is made.
typedef struct LsSurveyDesc
{
    uint32_t samples; // voxels whose masks are made, if so many would have some
    uint32_t patches; // the most N
    LsDivisionRule rule;
    const LsShaftWeights* weights; // of each N from 1 on, borrowed
    uint32_t threads;
} LsSurveyDesc;

// Voxelizes the mesh and samples. A crowded grid is halved as ls_voxels_create does. Errors: those
// of ls_voxels_create.
LsResult ls_survey_create(LsSurvey* survey, const LsMesh* mesh, uint32_t grid,
                          const LsSurveyDesc* desc, LsError* error);
void ls_survey_destroy(LsSurvey* survey);

// Every voxel with the N, up to `patches`, or no masks, of the least cost of a line + price *
// bytes; and of the divisions those that are worth it. Not for two threads at once.
LsOffer ls_survey_offer(const LsSurvey* survey, uint32_t patches, double price);

#endif
