// choose.c - surveys a few grids of every object, then looks for the price.

#include "choose.h"

#include "memory_limit.h"

#include <math.h>
#include <stdlib.h>

// With them and the grid of scale_grid files are a third of what they are with 3 patches at their
// own best grid, at 0.91 to 0.96 times the shadow and diffuse rays a second and 0.85 to 0.94 times
// the camera rays (docs/benchmarks.md, "Cells and N: bytes, speed, tests").
#define DEFAULT_PATCHES 2
#define DEFAULT_MOST_PATCHES 5
#define DEFAULT_BYTE_PRICE 0.001

// Cells along the longest side that are tried, as parts of those by the number of triangles: with a
// given memory all, else the first three.
static const double RATIOS[] = {1.0, 0.7, 1.4, 0.5, 2.0};
#define RATIO_COUNT ((int)(sizeof RATIOS / sizeof *RATIOS))
#define NEAR_RATIO_COUNT 3

// Voxels whose masks are made for a survey: objects share so many by their triangles, within
// bounds. With the most, bytes of an object come out within one or two of a hundred, so only a part
// of the memory is aimed at.
#define SHARED_SAMPLES 4096.0
#define FEWEST_SAMPLES 64.0
#define MOST_SAMPLES 2048.0
#define AIMED_PART (63.0 / 64.0)

// Prices lie between: at the first all masks pay, at the last none.
#define LEAST_PRICE 1e-20
#define MOST_PRICE 1e6

typedef struct Candidates
{
    LsSurvey surveys[RATIO_COUNT];
    int count;
    int picked;
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
    LsChoice* choices;
    Candidates* objects;   // none of lists
    double triangle_count; // of all gridded objects
} Chooser;

static bool is_gridded(const LsMesh* mesh)
{
    return mesh->triangle_count > LS_LIST_TRIANGLES;
}

static uint32_t scale_grid(uint32_t triangle_count, double ratio)
{
    const double side = floor(ratio * 0.3 * sqrt((double)triangle_count));
    return side < 4.0 ? 4 : side > LS_MAX_CELLS ? LS_MAX_CELLS : (uint32_t)side;
}

LsPatchesChoice ls_patches_choice(const LsBakeDesc* desc)
{
    const bool by_work =
        desc->memory != 0 || (desc->grid == 0 && desc->patches == 0 && !desc->choose_patches);
    const bool chosen = desc->choose_patches || by_work;
    const double price = desc->byte_price > 0.0 ? desc->byte_price : DEFAULT_BYTE_PRICE;
    return (LsPatchesChoice){.by_work = by_work,
                             .patches = desc->patches != 0 ? desc->patches
                                        : chosen           ? DEFAULT_MOST_PATCHES
                                                           : DEFAULT_PATCHES,
                             .chosen = chosen,
                             .byte_price = chosen && !by_work ? price : 0.0};
}

LsDivisionRule ls_division_rule(const LsBakeDesc* desc)
{
    return (LsDivisionRule){
        .above = desc->divide_above != 0 ? desc->divide_above : LS_MASK_TRIANGLES,
        .most_depth = LS_MAX_DEPTH,
        .is_weighed = ls_patches_choice(desc).by_work && desc->divide_above == 0,
    };
}

// ---- Surveys ------------------------------------------------------------------------------------------

static LsResult add_survey(const Chooser* chooser, uint32_t object, uint32_t grid, LsError* error)
{
    const LsChooseDesc* desc = chooser->desc;
    Candidates* candidates = &chooser->objects[object];
    const LsMesh* mesh = &chooser->meshes[object];
    const LsGridFrame frame = ls_grid_frame(mesh, grid);
    LsResult result = ls_memory_check(desc->max_memory, ls_grid_need(&frame, mesh->triangle_count),
                                      desc->scene, "the grid of an object", error);
    if (result == LS_OK)
    {
        const double share = SHARED_SAMPLES * mesh->triangle_count / chooser->triangle_count;
        const LsSurveyDesc how = {
            .samples = (uint32_t)fmin(fmax(share, FEWEST_SAMPLES), MOST_SAMPLES),
            .patches = desc->patches,
            .rule = desc->rule,
            .weights = desc->weights,
            .threads = desc->threads,
        };
        result = ls_survey_create(&candidates->surveys[candidates->count], mesh, grid, &how, error);
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

static LsResult survey_object(const Chooser* chooser, uint32_t object,
                              const LsStageProgress* progress, LsError* error)
{
    const LsChooseDesc* desc = chooser->desc;
    const Candidates* candidates = &chooser->objects[object];
    const int count = desc->grid != 0 ? 1 : desc->memory != 0 ? RATIO_COUNT : NEAR_RATIO_COUNT;
    LsResult result = LS_OK;
    bool goes_on = true;
    for (int i = 0; i < count && goes_on; i++)
    {
        const uint32_t triangles = chooser->meshes[object].triangle_count;
        const uint32_t grid = desc->grid != 0 ? desc->grid : scale_grid(triangles, RATIOS[i]);
        ls_stage_note(progress, (object + (double)i / count) / chooser->input->mesh_count);
        LsError refused = {0};
        if (!is_surveyed(candidates, grid))
        {
            result = add_survey(chooser, object, grid, &refused);
        }
        // Another grid may hold fewer records.
        goes_on = result == LS_OK || refused.message == LS_MESSAGE_LIMIT_RECORDS;
        if (result != LS_OK && error != NULL)
        {
            *error = refused;
        }
    }
    return goes_on && candidates->count > 0 ? LS_OK : result;
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

static void weigh_objects(LsChoice* choices, const LsInput* input, const LsMesh* meshes)
{
    double sum = 0.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        choices[i].weight = 0.0;
        count += is_gridded(&meshes[i]);
    }
    for (uint32_t i = 0; i < input->instance_count; i++)
    {
        const LsInputInstance* instance = &input->instances[i];
        const LsMesh* mesh = &meshes[instance->mesh];
        const double surface = is_gridded(mesh) ? box_surface(instance, mesh) : 0.0;
        choices[instance->mesh].weight += surface;
        sum += surface;
    }
    // An object without instances, or scenes too small or large to multiply, still get their share.
    for (uint32_t i = 0; i < input->mesh_count && count > 0; i++)
    {
        const double even = 1.0 / count;
        const double part = sum > 0.0 && sum < 1e300 ? choices[i].weight / sum : even;
        choices[i].weight = is_gridded(&meshes[i]) ? fmax(part, 1e-6 * even) : 0.0;
    }
}

// ---- The price ----------------------------------------------------------------------------------------

static Total offer_at(const Chooser* chooser, uint32_t object, int survey, double price)
{
    const double weight = chooser->choices[object].weight;
    const LsOffer offer = ls_survey_offer(&chooser->objects[object].surveys[survey],
                                          chooser->desc->patches, price / weight);
    return (Total){.cost = weight * offer.work, .bytes = offer.bytes};
}

// Of every object the survey of the least cost at a price.
static void pick_surveys(const Chooser* chooser, double price)
{
    for (uint32_t i = 0; i < chooser->input->mesh_count; i++)
    {
        Candidates* object = &chooser->objects[i];
        double least = INFINITY;
        for (int k = 0; k < object->count; k++)
        {
            const Total here = offer_at(chooser, i, k, price);
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
            object->count > 0 ? offer_at(chooser, i, object->picked, price) : (Total){0};
        total.cost += here.cost;
        total.bytes += here.bytes;
    }
    return total;
}

// Whether what is picked fits at a price.
static bool fits(const Chooser* chooser, double price)
{
    const double room = (double)(chooser->desc->memory - chooser->desc->fixed_bytes);
    return sum_picked(chooser, price).bytes <= AIMED_PART * room;
}

// The least price at which all fits, and one just below at which it does not, or the same.
typedef struct Bracket
{
    double below, least;
} Bracket;

// By halving on a logarithmic scale, since square roots, unlike logarithms, are the same on every
// machine. `repicks`: grids may change with the price.
static Bracket bracket_price(const Chooser* chooser, bool repicks)
{
    double low = LEAST_PRICE, high = MOST_PRICE, price = LEAST_PRICE;
    for (int i = 0; i < 41 && high > low; i++)
    {
        if (repicks)
        {
            pick_surveys(chooser, price);
        }
        const bool is_enough = fits(chooser, price);
        high = is_enough ? price : high;
        low = is_enough ? low : price;
        price = sqrt(low) * sqrt(high);
    }
    return (Bracket){low, high};
}

// One price for grids and masks leaves gaps: where a little less would buy another grid, memory may
// jump to twice. So the grids on either side of the least price that fits are kept, each at the
// least price of masks that fits then.
static LsResult fill_memory(const Chooser* chooser, double* price, LsError* error)
{
    const LsChooseDesc* desc = chooser->desc;
    pick_surveys(chooser, MOST_PRICE);
    // Without masks, so exact.
    const double least = sum_picked(chooser, MOST_PRICE).bytes + (double)desc->fixed_bytes;
    if (least > (double)desc->memory)
    {
        return ls_error_set(
            error, LS_MESSAGE_LIMIT_BUDGET,
            "%s: tracing takes %.0f bytes at least, more than the %llu of --memory; "
            "raise it, or bake fewer triangles, a coarser --grid or fewer "
            "--scene-shafts",
            desc->scene, least, (unsigned long long)desc->memory);
    }
    const Bracket grids = bracket_price(chooser, true);
    const double sides[2] = {grids.least, grids.below};
    double prices[2] = {MOST_PRICE, MOST_PRICE}, costs[2] = {INFINITY, INFINITY};
    for (int side = 0; side < 2; side++)
    {
        pick_surveys(chooser, sides[side]);
        if (fits(chooser, MOST_PRICE))
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

static double find_paying_price(const Chooser* chooser)
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

static LsResult choose(Chooser* chooser, const LsStageProgress* progress, LsError* error)
{
    const uint32_t count = chooser->input->mesh_count;
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < count; i++)
    {
        chooser->triangle_count +=
            is_gridded(&chooser->meshes[i]) ? chooser->meshes[i].triangle_count : 0.0;
    }
    for (uint32_t i = 0; i < count && result == LS_OK; i++)
    {
        result =
            is_gridded(&chooser->meshes[i]) ? survey_object(chooser, i, progress, error) : LS_OK;
    }
    double price = 0.0;
    if (result == LS_OK && chooser->desc->memory == 0)
    {
        price = find_paying_price(chooser);
    }
    else if (result == LS_OK)
    {
        result = fill_memory(chooser, &price, error);
    }
    for (uint32_t i = 0; i < count && result == LS_OK; i++)
    {
        const Candidates* object = &chooser->objects[i];
        LsChoice* choice = &chooser->choices[i];
        choice->grid = object->count > 0 ? object->surveys[object->picked].grid : 0;
        choice->price = object->count > 0 ? price / choice->weight : 0.0;
    }
    return result;
}

LsResult ls_choose(LsChoice* choices, const LsInput* input, const LsMesh* meshes,
                   const LsChooseDesc* desc, const LsStageProgress* progress, LsError* error)
{
    Chooser chooser = {.desc = desc,
                       .input = input,
                       .meshes = meshes,
                       .choices = choices,
                       .objects = calloc(input->mesh_count + 1ull, sizeof(Candidates))};
    weigh_objects(choices, input, meshes);
    const LsResult result = chooser.objects != NULL
                                ? choose(&chooser, progress, error)
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

void ls_choose_given(LsChoice* choices, const LsInput* input, const LsMesh* meshes, uint32_t grid)
{
    weigh_objects(choices, input, meshes);
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        const uint32_t by_triangles = scale_grid(meshes[i].triangle_count, 1.0);
        const uint32_t cells = grid != 0 ? grid : by_triangles < 512 ? by_triangles : 512;
        choices[i].grid = is_gridded(&meshes[i]) ? cells : 0;
        choices[i].price = 0.0;
    }
}
