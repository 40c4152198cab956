// The separable shaft test never says no where the exact polytope says yes.

#include "linespace.h"
#include "reference/polytope.h"
#include "shaft_tables.h"
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

// Cases of one setting: triangles against every shaft, or against `shaft_sample` of them.
typedef struct LsShaftRun
{
    uint32_t patches;
    double bound;
    uint32_t triangle_count;
    uint32_t shaft_sample; // 0: all
} LsShaftRun;

typedef struct LsShaftTally
{
    uint64_t cases, oracle_yes, separable_yes, wrong_no;
} LsShaftTally;

typedef void LsTriangleMaker(LsRandom* random, uint32_t patches, double bound,
                             double corners[3][3]);

// Anywhere in and around the voxel.
static void make_random(LsRandom* random, uint32_t patches, double bound, double corners[3][3])
{
    (void)patches;
    (void)bound;
    double size = exp(ls_random_between(random, log(1e-3), log(3.0)));
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double middle = ls_random_between(random, -0.2, 1.2);
        for (uint32_t corner = 0; corner < 3; corner++)
        {
            corners[corner][axis] = middle + size * ls_random_between(random, -1.0, 1.0);
        }
    }
}

// Like a piece of a smooth mesh: about as large as the voxel, well shaped.
static void make_mesh_like(LsRandom* random, uint32_t patches, double bound, double corners[3][3])
{
    (void)patches;
    (void)bound;
    double u[3], v[3], dot = 0.0, length = 0.0;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        u[axis] = ls_random_between(random, -1.0, 1.0);
        v[axis] = ls_random_between(random, -1.0, 1.0);
        length += u[axis] * u[axis];
        dot += u[axis] * v[axis];
    }
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        v[axis] -= dot / length * u[axis];
    }
    double size = ls_random_between(random, 0.2, 1.0);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double middle = ls_random_between(random, 0.0, 1.0);
        corners[0][axis] = middle - size * 0.4 * (u[axis] + v[axis]);
        corners[1][axis] = middle + size * 0.4 * u[axis];
        corners[2][axis] = middle + size * 0.4 * v[axis];
    }
}

// Long and thin, down to a millionth of its length.
static void make_needle(LsRandom* random, uint32_t patches, double bound, double corners[3][3])
{
    (void)patches;
    (void)bound;
    double width = exp(ls_random_between(random, log(1e-6), log(1e-2)));
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        corners[0][axis] = ls_random_between(random, -0.5, 1.5);
        corners[1][axis] = ls_random_between(random, -0.5, 1.5);
        corners[2][axis] = corners[0][axis] + width * ls_random_between(random, -1.0, 1.0);
    }
}

// A coordinate that something happens at: a patch border, as it is, grown by the bound, or beside
// it.
static double pick_border(LsRandom* random, uint32_t patches, double bound)
{
    double border = (double)ls_random_below(random, patches + 1) / patches;
    static const double offsets[] = {0.0, 1.0, -1.0, 0.999999, -0.999999, 0.5};
    return border + bound * offsets[ls_random_below(random, 6)];
}

// Corners on the lattice of patch borders: triangles in the planes of faces, through patch corners,
// along edges, touching grown patches from outside, sometimes shrunk to a line's breadth.
static void make_adversarial(LsRandom* random, uint32_t patches, double bound, double corners[3][3])
{
    uint32_t kind = ls_random_below(random, 4);
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            corners[corner][axis] = pick_border(random, patches, bound);
        }
    }
    uint32_t axis = ls_random_below(random, 3);
    if (kind == 1) // coplanar with a face, or grown beside it
    {
        static const double offsets[] = {0.0, 1.0, -1.0, 0.999999, -0.999999};
        double plane = ls_random_below(random, 2) + bound * offsets[ls_random_below(random, 5)];
        corners[0][axis] = corners[1][axis] = corners[2][axis] = plane;
    }
    else if (kind == 2) // a corner that barely touches a face from far outside
    {
        double side = ls_random_below(random, 2);
        double outward = side > 0.0 ? 1.0 : -1.0;
        corners[0][axis] = side + outward * bound * 0.999999;
        corners[1][axis] = side + outward * ls_random_between(random, 0.5, 3.0);
        corners[2][axis] = side + outward * ls_random_between(random, 0.5, 3.0);
    }
    else if (kind == 3) // an edge along an axis, on a border of patches
    {
        for (uint32_t other = 1; other < 3; other++)
        {
            corners[1][(axis + other) % 3] = corners[0][(axis + other) % 3];
        }
        corners[0][axis] = -0.5;
        corners[1][axis] = 1.5;
    }
}

static void tally_case(const LsShaftRun* run, const LsPolytope* body, uint32_t shaft,
                       const double corners[3][3], bool separable, LsShaftTally* tally)
{
    bool oracle = ls_polytope_meets(body, corners);
    tally->cases++;
    tally->oracle_yes += oracle;
    tally->separable_yes += separable;
    tally->wrong_no += oracle && !separable;
    if (oracle && !separable && tally->wrong_no == 1)
    {
        print_message("N %u e %g shaft %u:", run->patches, run->bound, shaft);
        for (uint32_t c = 0; c < 9; c++)
        {
            print_message(" %.17g", corners[c / 3][c % 3]);
        }
        print_message("\n");
    }
}

static void run_maker(const LsShaftRun* run, LsTriangleMaker* make, uint64_t seed,
                      LsShaftTally* tally)
{
    LsRandom random = {seed};
    uint32_t shaft_count = LS_SHAFT_COUNT(run->patches);
    uint32_t body_count = run->shaft_sample ? run->shaft_sample : shaft_count;
    uint32_t* shafts = malloc(body_count * sizeof *shafts);
    LsPolytope* bodies = malloc(body_count * sizeof *bodies);
    uint32_t* words = malloc(shaft_count * sizeof *words);
    LsShaftScratch* scratch = ls_shaft_scratch_create();
    assert_true(shafts && bodies && words && scratch);
    for (uint32_t i = 0; i < body_count; i++)
    {
        shafts[i] = run->shaft_sample ? ls_random_below(&random, shaft_count) : i;
        bodies[i] = ls_polytope_shaft(shafts[i], run->patches, run->bound);
    }

    // Voxels of every number of triangles.
    uint32_t size = 1;
    for (uint32_t t = 0; t < run->triangle_count; t += size)
    {
        size = 1 + (t + size) % LS_MASK_TRIANGLES;
        size = size < run->triangle_count - t ? size : run->triangle_count - t;
        double corners[LS_MASK_TRIANGLES][3][3];
        for (uint32_t k = 0; k < size; k++)
        {
            make(&random, run->patches, run->bound, corners[k]);
        }
        memset(words, 0xFF, shaft_count * sizeof *words);
        ls_shafts_mark((const double(*)[3][3])corners, size, run->bound, run->patches, words,
                       scratch);
        for (uint32_t i = 0; i < body_count; i++)
        {
            assert_true(size == 32 || words[shafts[i]] >> size == 0);
            for (uint32_t k = 0; k < size; k++)
            {
                tally_case(run, &bodies[i], shafts[i], (const double(*)[3])corners[k],
                           words[shafts[i]] >> k & 1u, tally);
            }
        }
    }

    ls_shaft_scratch_destroy(scratch);
    free(words);
    free(bodies);
    free(shafts);
}

static const double BOUNDS[] = {1e-6, 1.5e-5, 1e-3, 0.1};

static void run_kind(LsTriangleMaker* make, const char* name, uint64_t seed)
{
    LsShaftTally sum = {0};
    for (uint32_t patches = 1; patches <= 6; patches++)
    {
        for (uint32_t b = 0; b < 4; b++)
        {
            LsShaftRun run = {.patches = patches,
                              .bound = BOUNDS[b],
                              .triangle_count = patches <= 3 ? 400 / patches : 60,
                              .shaft_sample = patches > 2 ? 150 : 0};
            run_maker(&run, make, seed + 8 * patches + b, &sum);
        }
    }
    static const uint32_t spots[] = {7, 10, 13, 16};
    for (uint32_t spot = 0; spot < 4; spot++)
    {
        LsShaftRun run = {
            .patches = spots[spot], .bound = 1e-3, .triangle_count = 12, .shaft_sample = 200};
        run_maker(&run, make, seed + 100 + spot, &sum);
    }
    print_message("%s: %llu cases, %llu yes, %llu by the separable test, %llu wrong no\n", name,
                  (unsigned long long)sum.cases, (unsigned long long)sum.oracle_yes,
                  (unsigned long long)sum.separable_yes, (unsigned long long)sum.wrong_no);
    assert_true(sum.cases > 250000);
    assert_true(sum.oracle_yes > 1000);
    assert_int_equal(sum.wrong_no, 0);
}

static void random_triangles(void** state)
{
    (void)state;
    run_kind(make_random, "random", 1);
}

static void mesh_like_triangles(void** state)
{
    (void)state;
    run_kind(make_mesh_like, "mesh-like", 1000);
}

static void needle_triangles(void** state)
{
    (void)state;
    run_kind(make_needle, "needles", 2000);
}

static void adversarial_triangles(void** state)
{
    (void)state;
    run_kind(make_adversarial, "adversarial", 3000);
}

// What the separable test costs: shafts it names that the triangle does not meet.
static void surplus_is_small(void** state)
{
    (void)state;
    static const double most[] = {0.0, 0.05, 0.10, 0.20, 0.30, 0.40, 0.50};
    for (uint32_t patches = 1; patches <= 6; patches++)
    {
        LsShaftTally tally = {0};
        LsShaftRun run = {.patches = patches,
                          .bound = 1.5e-5,
                          .triangle_count = 150,
                          .shaft_sample = patches > 3 ? 1000 : 0};
        run_maker(&run, make_mesh_like, 4000 + patches, &tally);
        double surplus = (double)tally.separable_yes / (double)tally.oracle_yes - 1.0;
        print_message("N = %u: %.1f %% of %llu cases are filled, surplus %.1f %%\n", patches,
                      100.0 * (double)tally.oracle_yes / (double)tally.cases,
                      (unsigned long long)tally.cases, 100.0 * surplus);
        assert_int_equal(tally.wrong_no, 0);
        assert_true(surplus <= most[patches]);
    }
}

// Every pair of patches on two different faces has one shaft, and a thin triangle that crosses
// exactly that pair's middle line marks it: the numbering of the test and of the bake agree with
// the specification.
static void numbering_is_a_bijection(void** state)
{
    (void)state;
    LsShaftScratch* scratch = ls_shaft_scratch_create();
    assert_non_null(scratch);
    for (uint32_t patches = 1; patches <= 5; patches++)
    {
        uint32_t count = LS_SHAFT_COUNT(patches);
        uint32_t* words = malloc(count * sizeof *words);
        bool* seen = calloc(36u * patches * patches * patches * patches, 1);
        assert_true(words && seen);
        for (uint32_t shaft = 0; shaft < count; shaft++)
        {
            LsShaftEnds ends = ls_polytope_shaft_ends(shaft, patches);
            uint32_t square = patches * patches;
            uint32_t a = ends.face[0], b = ends.face[1];
            uint32_t patch_a = ends.i[0] * patches + ends.j[0];
            uint32_t patch_b = ends.i[1] * patches + ends.j[1];
            assert_true(a < b && b < 6 && patch_a < square && patch_b < square);
            uint32_t pair = a * 5 - a * (a - 1) / 2 + (b - a - 1);
            assert_int_equal((pair * square + patch_a) * square + patch_b, shaft);
            uint32_t key = ((a * 6 + b) * square + patch_a) * square + patch_b;
            assert_false(seen[key]);
            seen[key] = true;

            double corners[1][3][3];
            for (uint32_t end = 0; end < 2; end++)
            {
                uint32_t axis = ends.face[end] / 2;
                corners[0][end][axis] = ends.face[end] % 2;
                corners[0][end][(axis + 1) % 3] = (ends.i[end] + 0.5) / patches;
                corners[0][end][(axis + 2) % 3] = (ends.j[end] + 0.5) / patches;
            }
            for (uint32_t axis = 0; axis < 3; axis++)
            {
                double middle = 0.5 * (corners[0][0][axis] + corners[0][1][axis]);
                corners[0][2][axis] = middle + 1e-7 * (axis + 1);
            }
            ls_shafts_mark((const double(*)[3][3])corners, 1, 1e-6, patches, words, scratch);
            assert_int_equal(words[shaft], 1);
        }
        free(seen);
        free(words);
    }
    ls_shaft_scratch_destroy(scratch);
}

// Every kind of vectors that this machine has fills the same tables.
static void vectors_agree(void** state)
{
    (void)state;
    LsShaftTablesFill* fills[3] = {ls_shaft_tables_fill};
    uint32_t fill_count = 1;
#ifdef LS_HAS_X86_VARIANTS
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2"))
    {
        fills[fill_count++] = ls_shaft_tables_fill_avx2;
    }
    if (__builtin_cpu_supports("avx512f"))
    {
        fills[fill_count++] = ls_shaft_tables_fill_avx512;
    }
#endif
    LsRandom random = {99};
    LsShaftTables* expected = malloc(sizeof *expected);
    LsShaftTables* tables = malloc(sizeof *tables);
    assert_true(expected && tables);
    for (uint32_t round = 0; round < 300; round++)
    {
        LsShaftBatch batch = {.count = 3 + (int)ls_random_below(&random, LS_MAX_CORNERS - 2)};
        for (int lane = 0; lane < LS_LANES; lane++)
        {
            for (int axis = 0; axis < 3; axis++)
            {
                for (int corner = 0; corner < LS_MAX_CORNERS; corner++)
                {
                    // Now and then on a border, where comparisons are close.
                    batch.p[axis][corner][lane] = ls_random_below(&random, 4) == 0
                                                      ? pick_border(&random, 4, 1e-3)
                                                      : ls_random_between(&random, -1e-3, 1.001);
                }
                batch.normal[axis][lane] = ls_random_between(&random, -1.0, 1.0);
            }
            batch.e[lane] = 1e-3;
            batch.margin[lane] = 1e-13;
            batch.bits[lane] = 1 << lane;
        }
        int patches = 1 + (int)ls_random_below(&random, LS_MAX_PATCHES);
        memset(expected, 0, sizeof *expected);
        fills[0](expected, &batch, patches);
        for (uint32_t i = 1; i < fill_count; i++)
        {
            memset(tables, 0, sizeof *tables);
            fills[i](tables, &batch, patches);
            assert_memory_equal(tables, expected, sizeof *tables);
        }
    }
    print_message("%u kinds of vectors compared with the plain one\n", fill_count - 1);
    free(expected);
    free(tables);
}

// The oracle itself, against points drawn from triangle and hull: a common point means yes.
static void oracle_agrees_with_sampling(void** state)
{
    (void)state;
    LsRandom random = {77};
    uint32_t found = 0, misses = 0;
    for (uint32_t round = 0; round < 400; round++)
    {
        uint32_t patches = 1 + ls_random_below(&random, 5);
        uint32_t shaft = ls_random_below(&random, LS_SHAFT_COUNT(patches));
        LsPolytope body = ls_polytope_shaft(shaft, patches, 1e-3);
        double corners[3][3];
        make_random(&random, patches, 1e-3, corners);
        bool meets = ls_polytope_meets(&body, corners);
        bool common = false;
        for (uint32_t sample = 0; sample < 2000 && !common; sample++)
        {
            double u = ls_random_unit(&random), v = ls_random_unit(&random);
            u = u + v > 1.0 ? 1.0 - u : u;
            v = u + v > 1.0 ? 1.0 - v : v;
            bool inside = u + v <= 1.0;
            for (uint32_t p = 0; p < body.plane_count; p++)
            {
                double distance = -body.planes[p][3];
                for (uint32_t axis = 0; axis < 3; axis++)
                {
                    distance += body.planes[p][axis] *
                                (corners[0][axis] + u * (corners[1][axis] - corners[0][axis]) +
                                 v * (corners[2][axis] - corners[0][axis]));
                }
                inside = inside && distance <= -1e-9;
            }
            common = inside;
        }
        found += common;
        misses += !meets;
        assert_true(meets || !common);
    }
    assert_true(found > 20 && misses > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(oracle_agrees_with_sampling),
        cmocka_unit_test(numbering_is_a_bijection),
        cmocka_unit_test(vectors_agree),
        cmocka_unit_test(random_triangles),
        cmocka_unit_test(mesh_like_triangles),
        cmocka_unit_test(needle_triangles),
        cmocka_unit_test(adversarial_triangles),
        cmocka_unit_test(surplus_is_small),
    };
    return cmocka_run_group_tests_name("shafts", tests, NULL, NULL);
}
