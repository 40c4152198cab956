// choose.c - surveys a few grids of every object, then looks for the price.

#include "choose.h"

#include "memory_limit.h"

#include <math.h>
#include <stdlib.h>

// Cells along the longest side that are tried, by those of ls_grid_by_triangles: with a given memory all, else
// the first three.
static const double RATIOS[] = {1.0, 0.7, 1.4, 0.5, 2.0};
#define RATIO_COUNT ((int)(sizeof RATIOS / sizeof *RATIOS))
#define NEAR_RATIO_COUNT 3

// Voxels whose masks are made for a survey: the most, of all objects together, and the fewest. Bytes of an object then come out
// within one or two of a hundred.
#define SAMPLED_PART (63.0 / 64.0)
#define MOST_SAMPLES 2048
#define ALL_SAMPLES 4096
#define FEWEST_SAMPLES 64

// Prices lie between: at the first all masks pay, at the last none.
#define LEAST_PRICE 1e-20
#define MOST_PRICE 1e6

typedef struct Candidates
{
    LsSurvey surveys[RATIO_COUNT];
    int count;
    int picked;
    double weight; // part of all lines that meet gridded objects
} Candidates;

// What all objects take and cost at a price.
typedef struct Total
{
    double cost, bytes;
} Total;

typedef struct Chooser
{
    const LsChooseDesc* desc;
    const LsInput* input;
    const LsMesh* meshes;
    Candidates* objects; // of gridded ones the candidates
} Chooser;

static uint32_t scale_grid(uint32_t triangle_count, double ratio)
{
    const double side = floor(ratio * 0.3 * sqrt((double)triangle_count));
    return side < 4.0 ? 4 : side > LS_MAX_CELLS ? LS_MAX_CELLS : (uint32_t)side;
}

uint32_t ls_grid_by_triangles(uint32_t triangle_count)
{
    const uint32_t grid = scale_grid(triangle_count, 1.0);
    return grid < 512 ? grid : 512;
}

// ---- Surveys ------------------------------------------------------------------------------------------

static LsResult add_survey(Chooser* chooser, uint32_t object, uint32_t grid, LsError* error)
{
    const LsChooseDesc* desc = chooser->desc;
    Candidates* candidates = &chooser->objects[object];
    const LsMesh* mesh = &chooser->meshes[object];
    const LsGridFrame frame = ls_grid_frame(mesh, grid);
    LsResult result = ls_memory_check(desc->max_memory, ls_grid_need(&frame, mesh->triangle_count),
                                      desc->scene, "the grid of an object", error);
    if (result == LS_OK)
    {
        uint32_t samples = ALL_SAMPLES / chooser->input->mesh_count;
        samples = samples > FEWEST_SAMPLES ? samples : FEWEST_SAMPLES;
        samples = samples < MOST_SAMPLES ? samples : MOST_SAMPLES;
        result = ls_survey_create(&candidates->surveys[candidates->count], mesh, grid, samples,
                                  desc->patches, desc->threads, error);
    }
    candidates->count += result == LS_OK;
    return result;
}

static bool is_surveyed(const Candidates* candidates, uint32_t grid)
{
    bool is = false;
    for (int i = 0; i < candidates->count; i++)
    {
        is = is || candidates->surveys[i].grid == grid;
    }
    return is;
}

static LsResult survey_object(Chooser* chooser, uint32_t object, const LsStageProgress* progress,
                              LsError* error)
{
    const LsChooseDesc* desc = chooser->desc;
    const int count = desc->grid != 0 ? 1 : desc->memory != 0 ? RATIO_COUNT : NEAR_RATIO_COUNT;
    LsResult result = LS_OK;
    for (int i = 0; i < count && result == LS_OK; i++)
    {
        const uint32_t triangles = chooser->meshes[object].triangle_count;
        const uint32_t grid = desc->grid != 0 ? desc->grid : scale_grid(triangles, RATIOS[i]);
        ls_stage_note(progress, (object + (double)i / count) / chooser->input->mesh_count);
        if (!is_surveyed(&chooser->objects[object], grid))
        {
            result = add_survey(chooser, object, grid, error);
        }
    }
    return result;
}

// ---- Lines that meet an object --------------------------------------------------------------------------

static double cross_length(const double a[3], const double b[3])
{
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
    const double z = a[0] * b[1] - a[1] * b[0];
    return sqrt(x * x + y * y + z * z);
}

// Of an instance's box in the world.
static double box_surface(const LsInputInstance* instance, const LsMesh* mesh)
{
    double sides[3][3];
    for (int axis = 0; axis < 3; axis++)
    {
        const double length = (double)mesh->upper[axis] - mesh->lower[axis];
        for (int row = 0; row < 3; row++)
        {
            sides[axis][row] = instance->world_from_object[row][axis] * length;
        }
    }
    return 2.0 * (cross_length(sides[0], sides[1]) + cross_length(sides[1], sides[2]) +
                  cross_length(sides[2], sides[0]));
}

static void weigh_objects(Chooser* chooser)
{
    double sum = 0.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < chooser->input->instance_count; i++)
    {
        const LsInputInstance* instance = &chooser->input->instances[i];
        Candidates* object = &chooser->objects[instance->mesh];
        const double surface = box_surface(instance, &chooser->meshes[instance->mesh]);
        object->weight += object->count > 0 ? surface : 0.0;
        sum += object->count > 0 ? surface : 0.0;
    }
    for (uint32_t i = 0; i < chooser->input->mesh_count; i++)
    {
        count += chooser->objects[i].count > 0;
    }
    // An object without instances, or scenes too small or large to multiply, still get their share.
    for (uint32_t i = 0; i < chooser->input->mesh_count; i++)
    {
        const double even = 1.0 / (count + 1.0);
        const double part = sum > 0.0 && sum < 1e300 ? chooser->objects[i].weight / sum : even;
        chooser->objects[i].weight = fmax(part, 1e-6 * even);
    }
}

// ---- The price ----------------------------------------------------------------------------------------

static Total offer_at(const Chooser* chooser, const Candidates* object, int survey, double price)
{
    const LsOffer offer =
        ls_survey_offer(&object->surveys[survey], chooser->desc->patches, price / object->weight);
    return (Total){.cost = object->weight * ls_work_cost(&offer.work), .bytes = offer.bytes};
}

// Of every object the survey of the least cost at a price.
static void pick_surveys(Chooser* chooser, double price)
{
    for (uint32_t i = 0; i < chooser->input->mesh_count; i++)
    {
        Candidates* object = &chooser->objects[i];
        double least = INFINITY;
        for (int k = 0; k < object->count; k++)
        {
            const Total here = offer_at(chooser, object, k, price);
            if (here.cost + price * here.bytes < least)
            {
                least = here.cost + price * here.bytes;
                object->picked = k;
            }
        }
    }
}

static Total sum_picked(const Chooser* chooser, double price)
{
    Total total = {0};
    for (uint32_t i = 0; i < chooser->input->mesh_count; i++)
    {
        const Candidates* object = &chooser->objects[i];
        const Total here =
            object->count > 0 ? offer_at(chooser, object, object->picked, price) : (Total){0};
        total.cost += here.cost;
        total.bytes += here.bytes;
    }
    return total;
}

// With a little room, since samples tell bytes within one or two of a hundred.
static bool fits(Chooser* chooser, double price, bool repicks)
{
    if (repicks)
    {
        pick_surveys(chooser, price);
    }
    return sum_picked(chooser, price).bytes <= SAMPLED_PART * (double)chooser->desc->memory;
}

// The least price at which all fits, and one just below at which it does not, or the same: by halving on a logarithmic
// scale, since square roots, unlike logarithms, are the same on every machine.
typedef struct Bracket
{
    double below, least;
} Bracket;

static Bracket bracket_price(Chooser* chooser, bool repicks)
{
    double low = LEAST_PRICE, high = MOST_PRICE;
    if (fits(chooser, low, repicks))
    {
        return (Bracket){low, low};
    }
    for (int i = 0; i < 40; i++)
    {
        const double middle = sqrt(low) * sqrt(high);
        if (fits(chooser, middle, repicks))
        {
            high = middle;
        }
        else
        {
            low = middle;
        }
    }
    return (Bracket){low, high};
}

// One price for grids and masks leaves gaps: where a little less would buy another grid, memory may jump to twice. So the grids on
// either side of the least price that fits are kept, each at the least price of masks that fits then.
static LsResult fill_memory(Chooser* chooser, double* price, LsError* error)
{
    pick_surveys(chooser, MOST_PRICE);
    const double least = sum_picked(chooser, MOST_PRICE).bytes; // without masks, so exact
    if (least > (double)chooser->desc->memory)
    {
        return ls_error_set(error, LS_MESSAGE_LIMIT_BUDGET,
                            "%s: triangles and voxels take %.1f MB at least, more than the %.1f MB "
                            "that --memory leaves for them; raise it, or bake fewer triangles",
                            chooser->desc->scene, least * 1e-6,
                            (double)chooser->desc->memory * 1e-6);
    }
    const Bracket grids = bracket_price(chooser, true);
    const double sides[2] = {grids.least, grids.below};
    double prices[2] = {MOST_PRICE, MOST_PRICE}, costs[2] = {INFINITY, INFINITY};
    for (int side = 0; side < 2; side++)
    {
        pick_surveys(chooser, sides[side]);
        if (fits(chooser, MOST_PRICE, false))
        {
            prices[side] = bracket_price(chooser, false).least;
            costs[side] = sum_picked(chooser, prices[side]).cost;
        }
    }
    const int better = costs[1] < costs[0];
    pick_surveys(chooser, sides[better]);
    *price = prices[better];
    return LS_OK;
}

static double find_paying_price(Chooser* chooser)
{
    double best = LEAST_PRICE, least = INFINITY;
    for (double price = LEAST_PRICE; price <= MOST_PRICE; price *= 1.25)
    {
        pick_surveys(chooser, price);
        const Total total = sum_picked(chooser, price);
        const double square = total.cost * total.cost, fourth = square * square;
        const double product = fourth * fourth * total.bytes;
        if (product < least)
        {
            least = product;
            best = price;
        }
    }
    pick_surveys(chooser, best);
    return best;
}

static LsResult choose(Chooser* chooser, LsChoice* choices, const LsStageProgress* progress,
                       LsError* error)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < chooser->input->mesh_count && result == LS_OK; i++)
    {
        if (chooser->meshes[i].triangle_count > LS_LIST_TRIANGLES)
        {
            result = survey_object(chooser, i, progress, error);
        }
    }
    double price = 0.0;
    if (result == LS_OK)
    {
        weigh_objects(chooser);
    }
    if (result == LS_OK && chooser->desc->memory == 0)
    {
        price = find_paying_price(chooser);
    }
    else if (result == LS_OK)
    {
        result = fill_memory(chooser, &price, error);
    }
    for (uint32_t i = 0; i < chooser->input->mesh_count && result == LS_OK; i++)
    {
        const Candidates* object = &chooser->objects[i];
        const LsSurvey* survey = &object->surveys[object->picked];
        choices[i] = object->count > 0
                         ? (LsChoice){.grid = survey->grid, .price = price / object->weight}
                         : (LsChoice){0};
    }
    return result;
}

LsResult ls_choose(LsChoice* choices, const LsInput* input, const LsMesh* meshes,
                   const LsChooseDesc* desc, const LsStageProgress* progress, LsError* error)
{
    Chooser chooser = {.desc = desc,
                       .input = input,
                       .meshes = meshes,
                       .objects = calloc(input->mesh_count + 1ull, sizeof(Candidates))};
    const LsResult result = chooser.objects != NULL
                                ? choose(&chooser, choices, progress, error)
                                : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                               "out of memory for %u objects", input->mesh_count);
    for (uint32_t i = 0; chooser.objects != NULL && i < input->mesh_count; i++)
    {
        for (int k = 0; k < chooser.objects[i].count; k++)
        {
            ls_survey_destroy(&chooser.objects[i].surveys[k]);
        }
    }
    free(chooser.objects);
    return result;
}
