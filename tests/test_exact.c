// The exactness suite: the GPU through the Line Space against the GPU over all triangles, bit for
// bit, and both against the float reference, double precision and Embree by the contract of SPEC
// 7.6. docs/exactness.md says how to read its table.
//
// test_exact [--rays N] [--brute M] [--mesh NAME] [--scene-shafts M]
//     N rays a mesh and placement, 20,000 by default.
//     The GPU tests all triangles for as many rays of a setting as M million tests allow (default 10; 0: for
//     every ray), and for each ray on which the Line Space, the float reference and Embree are not of one mind.
//     NAME: one mesh instead of all.
//     With --scene-shafts every file is baked with those of M x M patches a face.

#include "baked.h"
#include "gpu.h"
#include "ray_sets.h"
#include "reference/ref_embree.h"
#include "reference/ref_judge.h"
#include "test_random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// One way to bake a mesh, and its share of the rays in percent.
typedef struct LsSetting
{
    LsTestPlacement placement;
    uint32_t grid, patches; // 0: the baker's choice
    uint32_t share;
    double byte_price; // of N by voxel; 0: N is `patches`
    uint32_t divide_above;
} LsSetting;

#define MAX_SETTINGS 5

typedef struct LsExactCase
{
    LsTestMeshId mesh;
    bool ordinary; // a mesh as people use them: its ordinary rays count for the limit on exceptions
    LsSetting settings[MAX_SETTINGS];
} LsExactCase;

static const LsExactCase CASES[] = {
    {LS_TEST_MESH_BUNNY,
     true,
     {{LS_TEST_ALONE, 0, 0, 40, 0, 0},
      {LS_TEST_ALONE, 64, 5, 30, 0, 0},
      {LS_TEST_ALONE, 13, 2, 30, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_TEAPOT,
     true,
     {{LS_TEST_ALONE, 0, 0, 40, 0, 0},
      {LS_TEST_ALONE, 40, 1, 30, 0, 0},
      {LS_TEST_ALONE, 3, 4, 30, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 60, 0, 0},
      {LS_TEST_INSTANCES, 20, 5, 40, 0, 0}}},
    {LS_TEST_MESH_ELEPHANT,
     true,
     {{LS_TEST_ALONE, 0, 0, 40, 0, 0},
      {LS_TEST_ALONE, 100, 2, 30, 0, 0},
      {LS_TEST_ALONE, 9, 6, 30, 0.0003, 8},
      {LS_TEST_INSTANCES, 0, 0, 60, 0, 0},
      {LS_TEST_INSTANCES, 7, 3, 40, 0, 0}}},
    {LS_TEST_MESH_SHELL,
     false,
     {{LS_TEST_ALONE, 0, 0, 40, 0, 0},
      {LS_TEST_ALONE, 16, 4, 30, 0.001, 0},
      {LS_TEST_ALONE, 1, 3, 30, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 60, 0, 0},
      {LS_TEST_INSTANCES, 16, 2, 40, 0, 0}}},
    {LS_TEST_MESH_SHEETS,
     false,
     {{LS_TEST_ALONE, 0, 0, 50, 0, 0},
      {LS_TEST_ALONE, 30, 3, 50, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_SLIVERS,
     false,
     {{LS_TEST_ALONE, 0, 0, 40, 0, 0},
      {LS_TEST_ALONE, 25, 2, 30, 0, 0},
      {LS_TEST_ALONE, 4, 5, 30, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 60, 0, 0},
      {LS_TEST_INSTANCES, 12, 3, 40, 0, 0}}},
    {LS_TEST_MESH_HUB,
     false,
     {{LS_TEST_ALONE, 0, 0, 50, 0, 0},
      {LS_TEST_ALONE, 8, 2, 50, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_FAN,
     false,
     {{LS_TEST_ALONE, 0, 0, 50, 0, 0},
      {LS_TEST_ALONE, 64, 3, 50, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_ONE,
     false,
     {{LS_TEST_ALONE, 0, 0, 100, 0, 0}, {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_FLAT,
     false,
     {{LS_TEST_ALONE, 0, 0, 50, 0, 0},
      {LS_TEST_ALONE, 20, 3, 50, 0, 0},
      {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_STADIUM,
     false,
     {{LS_TEST_ALONE, 0, 0, 50, 0, 0},
      {LS_TEST_ALONE, 9, 3, 50, 0, 0},
      {LS_TEST_INSTANCES, 9, 3, 100, 0, 0}}},
    {LS_TEST_MESH_MICRO,
     false,
     {{LS_TEST_ALONE, 0, 0, 100, 0, 0}, {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_MEGA,
     false,
     {{LS_TEST_ALONE, 0, 0, 100, 0, 0}, {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_FAR,
     false,
     {{LS_TEST_ALONE, 0, 0, 100, 0, 0}, {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
    {LS_TEST_MESH_STRAY,
     false,
     {{LS_TEST_ALONE, 12, 3, 100, 0, 0}, {LS_TEST_INSTANCES, 0, 0, 100, 0, 0}}},
};
#define CASE_COUNT (sizeof CASES / sizeof CASES[0])

// Who answers, in the order of the table.
typedef enum LsAnswerer
{
    LS_ANSWER_EXACT,
    LS_ANSWER_BRUTE,
    LS_ANSWER_CPU,
    LS_ANSWER_EMBREE,
    LS_ANSWER_COUNT,
} LsAnswerer;

typedef struct LsTally
{
    uint64_t rays, hits, ordinary_rays;
    uint64_t brute_rays;                     // traced over all triangles on the GPU as well
    uint64_t differing;                      // of these: exact and brute are not the same bits
    uint64_t cpu_equal;                      // exact and the float reference are the same bits
    uint64_t exceptions[LS_EXCEPTION_COUNT]; // of these, by cause; NONE are defects
    uint64_t ordinary_exceptions;
    double largest_cosine;           // of an excepted triangle
    uint64_t flagged, flagged_wrong; // rays traced again with flags, and answers that do not fit
    uint64_t verdicts[LS_ANSWER_COUNT][LS_VERDICT_COUNT];
    uint64_t embree_differs, embree_differs_ordinary; // another triangle than the GPU
    uint64_t inside, lost; // rays from inside a closed mesh, and those that came out
} LsTally;

static LsGpu gpu;
static uint32_t ray_count = 20000;
static uint64_t brute_million = 10;
static uint32_t scene_patches;
static LsTally total;
static uint64_t ordinary_mesh_rays, ordinary_mesh_exceptions;

// ---- One set of rays ----------------------------------------------------------------------------

typedef struct LsContest
{
    const LsBaked* baked;
    LsGpuScene scene;
    LsReference* reference;
    LsEmbree* embree;
    LsHit* answers[LS_ANSWER_COUNT];
    LsVerdict* verdicts[LS_ANSWER_COUNT];
} LsContest;

static bool is_same_triangle(const LsHit* a, const LsHit* b)
{
    return a->instance == b->instance && a->primitive == b->primitive;
}

static void print_ray(const char* what, const LsRay* ray)
{
    print_message("  %s: o %.9g %.9g %.9g d %.9g %.9g %.9g t %.9g %.9g\n", what, ray->origin.x,
                  ray->origin.y, ray->origin.z, ray->direction.x, ray->direction.y,
                  ray->direction.z, ray->tmin, ray->tmax);
}

static void print_answer(const LsContest* contest, const LsRay* ray, const char* who,
                         const LsHit* hit)
{
    LsReferenceMargin margin = {.t = NAN};
    ls_reference_margin(contest->reference, ray, 255, hit->instance, hit->primitive, &margin);
    print_message(
        "  %s: t %.9g u %.9g v %.9g of %d %d; in double t %.17g +- %g, edge %g of %g, cosine %g\n",
        who, hit->t, hit->u, hit->v, (int)hit->instance, (int)hit->primitive, margin.t,
        margin.t_bound, margin.edge_distance, margin.edge_bound, margin.cosine);
}

// Rays of a setting that the budget of the GPU's tests allows.
static uint32_t count_affordable(const LsContest* contest, uint32_t count)
{
    const LsFile* file = &contest->baked->file;
    uint64_t tests = 0; // of one ray
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_INSTANCES); i++)
    {
        tests += file->objects[file->instances[i].object].triangle_count;
    }
    uint64_t affordable = brute_million * 1000000 / tests;
    return brute_million == 0 || affordable > count ? count : (uint32_t)affordable;
}

// Chooses the rays for brute force, traces them and puts the answers in their places. Elsewhere the
// float reference has given the same bits, which are taken for the device's own.
static void trace_brute(LsContest* contest, const LsRaySet* set, LsTally* tally)
{
    uint32_t affordable = count_affordable(contest, set->count);
    uint32_t* chosen = malloc(set->count * sizeof *chosen);
    LsRay* rays = malloc(set->count * sizeof *rays);
    LsHit* hits = malloc(set->count * sizeof *hits);
    assert_true(chosen && rays && hits);
    uint32_t count = 0;
    for (uint32_t i = 0; i < set->count; i++)
    {
        const LsHit* exact = &contest->answers[LS_ANSWER_EXACT][i];
        const LsHit* cpu = &contest->answers[LS_ANSWER_CPU][i];
        bool equal = memcmp(exact, cpu, sizeof *exact) == 0;
        tally->cpu_equal += equal;
        contest->answers[LS_ANSWER_BRUTE][i] = *cpu;
        if (i < affordable || !equal ||
            !is_same_triangle(exact, &contest->answers[LS_ANSWER_EMBREE][i]))
        {
            chosen[count] = i;
            rays[count++] = set->rays[i];
        }
    }
    ls_gpu_trace(&gpu, &contest->scene, LS_TRACE_BRUTE, 0, rays, NULL, count, hits);
    for (uint32_t i = 0; i < count; i++)
    {
        contest->answers[LS_ANSWER_BRUTE][chosen[i]] = hits[i];
    }
    tally->brute_rays += count;
    free(hits);
    free(rays);
    free(chosen);
}

// Exact against brute, bit for bit, each difference explained or a defect.
static void compare_methods(LsContest* contest, const LsRaySet* set, LsTally* tally)
{
    uint64_t shown = 0;
    for (uint32_t i = 0; i < set->count; i++)
    {
        const LsHit* exact = &contest->answers[LS_ANSWER_EXACT][i];
        const LsHit* brute = &contest->answers[LS_ANSWER_BRUTE][i];
        tally->hits += brute->instance != LS_NONE;
        tally->ordinary_rays += set->classes[i] < LS_ORDINARY_CLASS_COUNT;
        if (memcmp(exact, brute, sizeof *exact) == 0)
        {
            continue;
        }
        double cosine;
        LsException cause =
            ls_reference_explain(contest->reference, &set->rays[i], 255, brute, exact, &cosine);
        tally->differing++;
        tally->exceptions[cause]++;
        tally->ordinary_exceptions += set->classes[i] < LS_ORDINARY_CLASS_COUNT;
        if (cause != LS_EXCEPTION_NONE)
        {
            tally->largest_cosine = fmax(tally->largest_cosine, cosine);
        }
        else if (shown++ < 5)
        {
            print_ray(ls_ray_class_name(set->classes[i]), &set->rays[i]);
            print_answer(contest, &set->rays[i], "exact", exact);
            print_answer(contest, &set->rays[i], "brute", brute);
        }
    }
}

// Any hit must agree with the closest hit on whether there is one, and name a triangle that is hit;
// culling must agree between the methods. On a part of the rays.
static void compare_flags(LsContest* contest, const LsRaySet* set, LsTally* tally)
{
    uint32_t count = count_affordable(contest, set->count) / 4 + 1;
    count = count < set->count ? count : set->count;
    LsHit* any = malloc(count * sizeof *any);
    LsHit* culled = malloc(2 * count * sizeof *culled);
    assert_true(any && culled);
    ls_gpu_trace(&gpu, &contest->scene, LS_TRACE_EXACT, LS_RAY_FLAG_ANY_HIT, set->rays, NULL, count,
                 any);
    for (uint32_t i = 0; i < count; i++)
    {
        const LsHit* exact = &contest->answers[LS_ANSWER_EXACT][i];
        bool hit = exact->instance != LS_NONE;
        LsReferenceMargin margin;
        bool fits = (any[i].instance != LS_NONE) == hit && any[i].t == (hit ? 0.0f : -1.0f);
        if (fits && hit)
        {
            bool known = ls_reference_margin(contest->reference, &set->rays[i], 255,
                                             any[i].instance, any[i].primitive, &margin);
            fits = known && (margin.inside || margin.edge_distance <= margin.edge_bound);
        }
        tally->flagged++;
        tally->flagged_wrong += !fits;
    }
    static const uint32_t flags[] = {LS_RAY_FLAG_CULL_BACK_FACING, LS_RAY_FLAG_CULL_FRONT_FACING};
    for (uint32_t f = 0; f < 2; f++)
    {
        ls_gpu_trace(&gpu, &contest->scene, LS_TRACE_EXACT, flags[f], set->rays, NULL, count,
                     culled);
        ls_gpu_trace(&gpu, &contest->scene, LS_TRACE_BRUTE, flags[f], set->rays, NULL, count,
                     culled + count);
        for (uint32_t i = 0; i < count; i++)
        {
            double cosine;
            bool same = memcmp(&culled[i], &culled[count + i], sizeof *culled) == 0;
            bool fits = same || ls_reference_explain(contest->reference, &set->rays[i], 255,
                                                     &culled[count + i], &culled[i],
                                                     &cosine) != LS_EXCEPTION_NONE;
            tally->flagged++;
            tally->flagged_wrong += !fits;
        }
    }
    free(culled);
    free(any);
}

static void judge_answers(LsContest* contest, const LsRaySet* set, LsTally* tally)
{
    static const char* const names[] = {"exact", "brute", "cpu", "embree"};
    ls_reference_judge(contest->reference, set->rays, NULL, set->count, LS_ANSWER_COUNT,
                       (const LsHit* const*)contest->answers, contest->verdicts);
    uint64_t shown = 0;
    for (uint32_t i = 0; i < set->count; i++)
    {
        for (uint32_t a = 0; a < LS_ANSWER_COUNT; a++)
        {
            LsVerdict verdict = contest->verdicts[a][i];
            tally->verdicts[a][verdict]++;
            if (verdict == LS_VERDICT_DEFECT && a != LS_ANSWER_EMBREE && shown++ < 4)
            {
                print_ray(ls_ray_class_name(set->classes[i]), &set->rays[i]);
                print_answer(contest, &set->rays[i], names[a], &contest->answers[a][i]);
            }
        }
        const LsHit* exact = &contest->answers[LS_ANSWER_EXACT][i];
        bool embree_differs = !is_same_triangle(exact, &contest->answers[LS_ANSWER_EMBREE][i]);
        tally->embree_differs += embree_differs;
        tally->embree_differs_ordinary +=
            embree_differs && set->classes[i] < LS_ORDINARY_CLASS_COUNT;
    }
}

// ---- Closed meshes ------------------------------------------------------------------------------

static void copy_vertex(const LsTestMesh* mesh, uint32_t index, double out[3])
{
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        out[axis] = mesh->positions[3 * mesh->indices[index] + axis];
    }
}

// Rays from inside a closed mesh at its vertices and edges.
static LsRaySet make_inside_rays(const LsFile* file, const LsTestMesh* mesh, uint32_t count)
{
    LsRaySet set = {.count = count};
    set.rays = malloc(count * sizeof *set.rays);
    assert_non_null(set.rays);
    LsRandom random = {99};
    float lower[3], upper[3];
    ls_test_mesh_bounds(mesh, lower, upper);
    double origins[12][3];
    for (uint32_t found = 0; found < 12;)
    {
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            // In float, so that the origin of the ray is the point that was asked about.
            origins[found][axis] = (float)ls_random_between(&random, lower[axis], upper[axis]);
        }
        if (found < 2)
        {
            // Close to the surface, where thin walls have their inside.
            uint32_t corner = 3 * ls_random_below(&random, mesh->triangle_count);
            double weights[3] = {ls_random_unit(&random), ls_random_unit(&random),
                                 ls_random_unit(&random)};
            double sum = weights[0] + weights[1] + weights[2];
            double offset =
                5e-5 * ((double)upper[0] - lower[0]) * (ls_random_below(&random, 2) ? 1.0 : -1.0);
            for (uint32_t axis = 0; axis < 3; axis++)
            {
                double p = offset;
                for (uint32_t i = 0; i < 3; i++)
                {
                    double vertex[3];
                    copy_vertex(mesh, corner + i, vertex);
                    p += weights[i] / sum * vertex[axis];
                }
                origins[found][axis] = (float)p;
            }
        }
        found += ls_test_mesh_contains(mesh, origins[found]);
    }

    uint32_t instance_count = ls_file_count(file, LS_CHUNK_INSTANCES);
    for (uint32_t i = 0; i < count; i++)
    {
        double a[3], b[3], o[3], d[3];
        uint32_t corner = ls_random_below(&random, 3 * mesh->triangle_count);
        uint32_t next = corner % 3 == 2 ? corner - 2 : corner + 1;
        copy_vertex(mesh, corner, a);
        copy_vertex(mesh, next, b);
        double along = i % 3 == 0 ? 0.0 : i % 3 == 1 ? 0.5 : ls_random_unit(&random);
        memcpy(o, origins[ls_random_below(&random, 12)], sizeof o);
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            d[axis] = (1.0 - along) * a[axis] + along * b[axis] - o[axis];
        }
        const LsVec4* m = file->instances[i % instance_count].world_from_object;
        float world[2][3];
        for (uint32_t row = 0; row < 3; row++)
        {
            world[0][row] = (float)(m[row].x * o[0] + m[row].y * o[1] + m[row].z * o[2] + m[row].w);
            world[1][row] = (float)(m[row].x * d[0] + m[row].y * d[1] + m[row].z * d[2]);
        }
        set.rays[i] = (LsRay){.origin = {world[0][0], world[0][1], world[0][2]},
                              .direction = {world[1][0], world[1][1], world[1][2]},
                              .tmax = INFINITY};
    }
    return set;
}

static void count_lost(LsContest* contest, const LsTestMesh* mesh, uint32_t count, LsTally* tally)
{
    LsRaySet set = make_inside_rays(&contest->baked->file, mesh, count);
    LsHit* hits = malloc(count * sizeof *hits);
    assert_non_null(hits);
    for (uint32_t method = 0; method < 2; method++)
    {
        if (method == 0)
        {
            ls_gpu_trace(&gpu, &contest->scene, LS_TRACE_EXACT, 0, set.rays, NULL, count, hits);
        }
        else
        {
            ls_reference_trace(contest->reference, set.rays, NULL, count, 0, hits);
        }
        for (uint32_t i = 0; i < count; i++)
        {
            tally->inside++;
            tally->lost += hits[i].instance == LS_NONE;
        }
    }
    free(hits);
    ls_ray_set_destroy(&set);
}

// ---- A mesh -------------------------------------------------------------------------------------

static void run_setting(const LsExactCase* exact_case, const LsSetting* setting,
                        const LsTestMesh* mesh, LsTally* tally)
{
    LsBaked baked;
    ls_baked_open_desc(&baked, mesh, ls_test_mesh_name(exact_case->mesh), setting->placement,
                       &(LsBakeDesc){.grid = setting->grid,
                                     .patches = setting->patches,
                                     .choose_patches = setting->byte_price > 0.0,
                                     .byte_price = setting->byte_price,
                                     .divide_above = setting->divide_above,
                                     .scene_patches = scene_patches});
    LsContest contest = {.baked = &baked};
    ls_gpu_scene_open(&gpu, &contest.scene, baked.path);
    contest.reference = ls_reference_create(&baked.file);
    assert_non_null(contest.reference);
    contest.embree = ls_embree_create(&baked.file, contest.reference);
    assert_non_null(contest.embree);
    uint32_t count = (uint32_t)((uint64_t)ray_count * setting->share / 100);
    for (uint32_t a = 0; a < LS_ANSWER_COUNT; a++)
    {
        contest.answers[a] = malloc(count * sizeof(LsHit));
        contest.verdicts[a] = malloc(count * sizeof(LsVerdict));
        assert_true(contest.answers[a] && contest.verdicts[a]);
    }

    LsRaySet set = ls_ray_set_make(&baked.file, count, 17 + setting->grid);
    tally->rays += count;
    ls_gpu_trace(&gpu, &contest.scene, LS_TRACE_EXACT, 0, set.rays, NULL, count,
                 contest.answers[LS_ANSWER_EXACT]);
    ls_reference_trace(contest.reference, set.rays, NULL, count, 0, contest.answers[LS_ANSWER_CPU]);
    ls_embree_trace(contest.embree, set.rays, NULL, count, contest.answers[LS_ANSWER_EMBREE]);
    trace_brute(&contest, &set, tally);
    compare_methods(&contest, &set, tally);
    judge_answers(&contest, &set, tally);
    compare_flags(&contest, &set, tally);
    if (ls_test_mesh_is_closed(mesh))
    {
        count_lost(&contest, mesh, count / 4, tally);
    }

    ls_ray_set_destroy(&set);
    for (uint32_t a = 0; a < LS_ANSWER_COUNT; a++)
    {
        free(contest.answers[a]);
        free(contest.verdicts[a]);
    }
    ls_embree_destroy(contest.embree);
    ls_reference_destroy(contest.reference);
    ls_gpu_scene_close(&contest.scene);
    ls_baked_close(&baked);
}

static void add_tally(LsTally* sum, const LsTally* tally)
{
    sum->rays += tally->rays;
    sum->hits += tally->hits;
    sum->ordinary_rays += tally->ordinary_rays;
    sum->brute_rays += tally->brute_rays;
    sum->differing += tally->differing;
    sum->cpu_equal += tally->cpu_equal;
    sum->ordinary_exceptions += tally->ordinary_exceptions;
    sum->largest_cosine = fmax(sum->largest_cosine, tally->largest_cosine);
    sum->flagged += tally->flagged;
    sum->flagged_wrong += tally->flagged_wrong;
    sum->embree_differs += tally->embree_differs;
    sum->embree_differs_ordinary += tally->embree_differs_ordinary;
    sum->inside += tally->inside;
    sum->lost += tally->lost;
    for (uint32_t i = 0; i < LS_EXCEPTION_COUNT; i++)
    {
        sum->exceptions[i] += tally->exceptions[i];
    }
    for (uint32_t i = 0; i < LS_ANSWER_COUNT * LS_VERDICT_COUNT; i++)
    {
        sum->verdicts[i / LS_VERDICT_COUNT][i % LS_VERDICT_COUNT] +=
            tally->verdicts[i / LS_VERDICT_COUNT][i % LS_VERDICT_COUNT];
    }
}

static void print_heading(void)
{
    print_message(
        "%-9s %8s %8s %8s %6s | %5s %5s %5s %6s | %6s %7s %6s | %8s %6s | %6s %6s | %6s %4s\n",
        "mesh", "rays", "hits", "brute", "differ", "other", "tmax", "cell", "defect", "edge",
        "t error", "defect", "cpu bits", "defect", "embree", "loose", "inside", "lost");
}

static void print_tally(const char* name, const LsTally* t)
{
    const uint64_t* own = t->verdicts[LS_ANSWER_EXACT];
    const unsigned long long columns[] = {
        t->rays,
        t->hits,
        t->brute_rays,
        t->differing,
        t->exceptions[LS_EXCEPTION_OTHER_HIT],
        t->exceptions[LS_EXCEPTION_TMAX],
        t->exceptions[LS_EXCEPTION_CELL_END],
        t->exceptions[LS_EXCEPTION_NONE],
        own[LS_VERDICT_EDGE],
        own[LS_VERDICT_T_ERROR] + own[LS_VERDICT_EDGE_ON],
        own[LS_VERDICT_DEFECT] + t->verdicts[LS_ANSWER_BRUTE][LS_VERDICT_DEFECT],
        t->cpu_equal,
        t->verdicts[LS_ANSWER_CPU][LS_VERDICT_DEFECT],
        t->embree_differs,
        t->verdicts[LS_ANSWER_EMBREE][LS_VERDICT_DEFECT],
        t->inside,
        t->lost,
    };
    static const int widths[] = {8, 8, 8, 6, 5, 5, 5, 6, 6, 7, 6, 8, 6, 6, 6, 6, 4};
    static const char* const bars[] = {"", "", "",   "", "| ", "", "",   "", "| ",
                                       "", "", "| ", "", "| ", "", "| ", ""};
    char line[256];
    int length = snprintf(line, sizeof line, "%-9s", name);
    for (uint32_t i = 0; i < sizeof columns / sizeof columns[0]; i++)
    {
        length += snprintf(line + length, sizeof line - (size_t)length, " %s%*llu", bars[i],
                           widths[i], columns[i]);
    }
    print_message("%s\n", line);
}

static void check_mesh(void** state)
{
    const LsExactCase* exact_case = *state;
    const char* name = ls_test_mesh_name(exact_case->mesh);
    LsTestMesh mesh = ls_test_mesh_make(exact_case->mesh);
    LsTally tally = {0};
    for (uint32_t s = 0; s < MAX_SETTINGS && exact_case->settings[s].share > 0; s++)
    {
        run_setting(exact_case, &exact_case->settings[s], &mesh, &tally);
    }
    ls_test_mesh_destroy(&mesh);
    print_tally(name, &tally);
    add_tally(&total, &tally);
    if (exact_case->ordinary)
    {
        ordinary_mesh_rays += tally.ordinary_rays;
        ordinary_mesh_exceptions += tally.ordinary_exceptions;
    }

    assert_true(tally.hits > tally.rays / 20);
    assert_int_equal(tally.exceptions[LS_EXCEPTION_NONE], 0);
    assert_int_equal(tally.flagged_wrong, 0);
    assert_int_equal(tally.verdicts[LS_ANSWER_EXACT][LS_VERDICT_DEFECT], 0);
    assert_int_equal(tally.verdicts[LS_ANSWER_BRUTE][LS_VERDICT_DEFECT], 0);
    assert_int_equal(tally.verdicts[LS_ANSWER_CPU][LS_VERDICT_DEFECT], 0);
    assert_int_equal(tally.lost, 0);
    // Where Embree differs every answer was judged above; that it seldom does on real meshes is
    // what makes it a second opinion.
    assert_true(!exact_case->ordinary ||
                tally.embree_differs_ordinary * 1000 < tally.ordinary_rays);
}

static void exceptions_are_rare(void** state)
{
    (void)state;
    print_heading();
    print_tally("all", &total);
    print_message("%llu of %llu ordinary rays on ordinary meshes excepted; largest cosine of any "
                  "exception %.3g; %llu "
                  "rays traced with flags\n",
                  (unsigned long long)ordinary_mesh_exceptions,
                  (unsigned long long)ordinary_mesh_rays, total.largest_cosine,
                  (unsigned long long)total.flagged);
    assert_true(ordinary_mesh_exceptions * 10000 <= ordinary_mesh_rays);
}

static int open_device(void** state)
{
    (void)state;
    ls_gpu_open(&gpu);
    print_heading();
    return 0;
}

static int close_device(void** state)
{
    (void)state;
    ls_gpu_close(&gpu);
    return 0;
}

int main(int argc, char** argv)
{
    const char* only = NULL;
    for (int i = 1; i + 1 < argc; i += 2)
    {
        if (strcmp(argv[i], "--rays") == 0)
        {
            ray_count = (uint32_t)strtoul(argv[i + 1], NULL, 10);
        }
        else if (strcmp(argv[i], "--mesh") == 0)
        {
            only = argv[i + 1];
        }
        else if (strcmp(argv[i], "--brute") == 0)
        {
            brute_million = strtoull(argv[i + 1], NULL, 10);
        }
        else if (strcmp(argv[i], "--scene-shafts") == 0)
        {
            scene_patches = (uint32_t)strtoul(argv[i + 1], NULL, 10);
        }
    }
    struct CMUnitTest tests[CASE_COUNT + 1];
    uint32_t count = 0;
    for (uint32_t i = 0; i < CASE_COUNT; i++)
    {
        const char* name = ls_test_mesh_name(CASES[i].mesh);
        if (!only || strcmp(only, name) == 0)
        {
            tests[count++] = (struct CMUnitTest){
                .name = name, .test_func = check_mesh, .initial_state = (void*)&CASES[i]};
        }
    }
    if (count == 0)
    {
        fprintf(stderr, "test_exact: no mesh is called %s\n", only);
        return 1;
    }
    tests[count++] = (struct CMUnitTest)cmocka_unit_test(exceptions_are_rare);
    return _cmocka_run_group_tests("exact", tests, count, open_device, close_device);
}
