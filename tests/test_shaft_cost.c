// test_shaft_cost.c - what a ray is expected to test in a voxel: the weights of shafts against sampled
// lines, sums over masks, and the choice of N against all that could have been chosen.

#include "baked.h"
#include "cost_model.h"
#include "linespace.h"
#include "reference/polytope.h"
#include "shaft_cost.h"
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

#define PI 3.14159265358979323846

// ---- Weights ------------------------------------------------------------------------------------

static void weights_sum_to_one(void** state)
{
    (void)state;
    for (uint32_t n = 1; n <= LS_MAX_PATCHES; n += n < 8 ? 1 : 4)
    {
        double sum = 0.0;
        const uint32_t count = LS_SHAFT_COUNT(n);
        for (uint32_t i = 0; i < count; i++)
        {
            const double weight = ls_shaft_weight(i, n);
            assert_true(weight > 0.0);
            sum += weight;
        }
        assert_true(fabs(sum * 0x1p-30 - 1.0) < 1e-10);
        LsShaftWeights weights;
        assert_true(ls_shaft_weights_create(&weights, n));
        assert_true(fabs((double)weights.sum - 0x1p30) <= 0.5 * count);
        ls_shaft_weights_destroy(&weights);
    }
}

// The last bits of log and atan, which differ between C libraries, move a weight by some 1e-6 at most.
static void weights_round_alike_everywhere(void** state)
{
    (void)state;
    double nearest = 1.0;
    for (uint32_t n = 1; n <= LS_MAX_CHOSEN_PATCHES; n++)
    {
        for (uint32_t i = 0; i < LS_SHAFT_COUNT(n); i++)
        {
            const double weight = ls_shaft_weight(i, n);
            nearest = fmin(nearest, fabs(weight - floor(weight) - 0.5));
        }
    }
    print_message("nearest to the middle between two whole numbers: %.3g\n", nearest);
    assert_true(nearest > 5e-5);
}

// Where a line from `from` leaves the unit cube, and by which face.
static uint32_t leave_cube(const double from[3], const double direction[3], double to[3])
{
    double nearest = INFINITY;
    uint32_t face = 0;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        const uint32_t side = direction[axis] > 0.0;
        const double t = (side - from[axis]) / direction[axis];
        if (direction[axis] != 0.0 && t < nearest && t > 1e-12)
        {
            nearest = t;
            face = 2 * axis + side;
        }
    }
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        to[axis] = from[axis] + nearest * direction[axis];
    }
    return face;
}

static uint32_t patch_at(uint32_t face, const double p[3], uint32_t n)
{
    const uint32_t axis = face >> 1;
    const uint32_t i = (uint32_t)(p[(axis + 1) % 3] * n), j = (uint32_t)(p[(axis + 2) % 3] * n);
    return (i < n ? i : n - 1) * n + (j < n ? j : n - 1);
}

// A line as likely as any: from a uniform point of the surface, distributed by the cosine. Returns the
// patches of both ends, each as face * N^2 + patch.
static void sample_line(LsRandom* random, uint32_t n, uint32_t ends[2])
{
    const uint32_t face = ls_random_below(random, 6), axis = face >> 1;
    const double radius = sqrt(ls_random_unit(random)), angle = 2.0 * PI * ls_random_unit(random);
    double from[3], direction[3], to[3];
    from[axis] = face & 1;
    from[(axis + 1) % 3] = ls_random_unit(random);
    from[(axis + 2) % 3] = ls_random_unit(random);
    direction[axis] = ((face & 1) != 0 ? -1.0 : 1.0) * sqrt(1.0 - radius * radius);
    direction[(axis + 1) % 3] = radius * cos(angle);
    direction[(axis + 2) % 3] = radius * sin(angle);
    const uint32_t out = leave_cube(from, direction, to);
    ends[0] = face * n * n + patch_at(face, from, n);
    ends[1] = out * n * n + patch_at(out, to, n);
}

static void expect_sampled_weights(uint32_t n, uint32_t lines)
{
    const uint32_t patches = 6 * n * n, count = LS_SHAFT_COUNT(n);
    uint32_t* shaft_of = calloc((size_t)patches * patches, sizeof(uint32_t)); // 1 + shaft
    uint32_t* met = calloc(count, sizeof(uint32_t));
    assert_true(shaft_of && met);
    for (uint32_t i = 0; i < count; i++)
    {
        const LsShaftEnds ends = ls_polytope_shaft_ends(i, n);
        const uint32_t a = ends.face[0] * n * n + ends.i[0] * n + ends.j[0];
        const uint32_t b = ends.face[1] * n * n + ends.i[1] * n + ends.j[1];
        shaft_of[a * patches + b] = shaft_of[b * patches + a] = 1 + i;
    }
    LsRandom random = {n};
    for (uint32_t i = 0; i < lines; i++)
    {
        uint32_t ends[2];
        sample_line(&random, n, ends);
        const uint32_t shaft = shaft_of[ends[0] * patches + ends[1]];
        assert_true(shaft > 0);
        met[shaft - 1]++;
    }
    double squares = 0.0;
    for (uint32_t i = 0; i < count; i++)
    {
        const double expected = ls_shaft_weight(i, n) * 0x1p-30 * lines;
        const double off = met[i] - expected;
        assert_true(fabs(off) < 6.0 * sqrt(expected) + 6.0);
        squares += off * off / expected;
    }
    // Of chi squared with so many degrees of freedom, mean 1 and deviation sqrt(2 / count).
    print_message("N = %u: chi squared %.3f a degree of freedom\n", n, squares / (count - 1));
    assert_true(fabs(squares / (count - 1) - 1.0) < 5.0 * sqrt(2.0 / count));
    free(shaft_of);
    free(met);
}

static void weights_are_those_of_lines(void** state)
{
    (void)state;
    expect_sampled_weights(1, 1000000);
    expect_sampled_weights(3, 2000000);
    expect_sampled_weights(4, 2000000);
}

// ---- Sums ---------------------------------------------------------------------------------------

static void tests_are_weighed_bits(void** state)
{
    (void)state;
    for (uint32_t n = 1; n <= 4; n++)
    {
        const uint32_t count = LS_SHAFT_COUNT(n);
        LsShaftWeights weights;
        assert_true(ls_shaft_weights_create(&weights, n));
        uint32_t* masks = calloc(count, sizeof(uint32_t));
        assert_non_null(masks);
        assert_true(ls_shaft_tests(&weights, masks) == 0.0);
        LsRandom random = {n};
        double sum = 0.0;
        for (uint32_t i = 0; i < count; i++)
        {
            masks[i] = ls_random_word(&random);
            uint32_t bits = 0;
            for (uint32_t k = 0; k < 32; k++)
            {
                bits += masks[i] >> k & 1;
            }
            sum += bits * ls_shaft_weight(i, n) * 0x1p-30;
        }
        assert_true(fabs(ls_shaft_tests(&weights, masks) - sum) < 1e-4);
        memset(masks, 0xFF, count * sizeof(uint32_t));
        assert_true(ls_shaft_tests(&weights, masks) == 32.0);
        free(masks);
        ls_shaft_weights_destroy(&weights);
    }
}

static void leaf_bvhs_test_what_boxes_let_in(void** state)
{
    (void)state;
    const LsWorkVoxel voxel = {.cell = {5, 4, 4}, .level = 1}; // [1.25, 1.5] x [1, 1.25]^2
    assert_true(ls_voxel_visits(&voxel) == 1.0 / 16.0);
    const LsBvhNode nodes[3] = {
        {.lower = {1, 1, 1}, .escape = 3, .upper = {2, 2, 2}},
        {.lower = {1, 0, 0}, .escape = 2, .upper = {2, 2, 2}, .leaf = 0 << 4 | 10},
        {.lower = {1.25f, 1, 1}, .escape = 3, .upper = {1.5f, 1.25f, 1.125f}, .leaf = 10 << 4 | 3},
    };
    // All of the ten; of the three those whose half of the voxel is met: 4 of 6 faces' area.
    assert_true(fabs(ls_leaf_bvh_tests(nodes, &voxel) - (10.0 + 3.0 * 4.0 / 6.0)) < 1e-12);
}

// ---- The choice ---------------------------------------------------------------------------------

// Cost of each voxel's masks as a file has them, and the work that is not in bytes.
typedef struct Costs
{
    uint32_t count;
    double* tests; // by voxel: 1 look-up and the expected tests, or those of a list
    double* bytes;
} Costs;

static Costs read_costs(const LsFile* file)
{
    const LsObject* object = &file->objects[0];
    Costs costs = {.count = object->voxel_count};
    costs.tests = calloc(costs.count, sizeof(double));
    costs.bytes = calloc(costs.count, sizeof(double));
    uint32_t* masks = malloc(LS_SHAFT_COUNT(LS_MAX_CHOSEN_PATCHES) * sizeof(uint32_t));
    assert_true(costs.tests && costs.bytes && masks);
    LsShaftWeights weights[LS_MAX_CHOSEN_PATCHES + 1] = {0};
    for (uint32_t i = 0; i < costs.count; i++)
    {
        const LsVoxel* voxel = &file->voxels[i];
        costs.tests[i] = voxel->reference_count;
        if ((voxel->shape & 255) != LS_VOXEL_MASKS)
        {
            continue;
        }
        const uint32_t n = voxel->shape >> 8 & 255, width = voxel->reference_count;
        for (uint32_t k = 0; k < LS_SHAFT_COUNT(n); k++)
        {
            masks[k] = ls_mask_read(file->shafts + voxel->table, k, width);
        }
        assert_true(weights[n].shafts != NULL || ls_shaft_weights_create(&weights[n], n));
        costs.tests[i] = LS_LOOKUP_COST + ls_shaft_tests(&weights[n], masks);
        costs.bytes[i] = 4.0 * (double)ls_mask_words(LS_SHAFT_COUNT(n), width);
    }
    for (uint32_t n = 0; n <= LS_MAX_CHOSEN_PATCHES; n++)
    {
        ls_shaft_weights_destroy(&weights[n]);
    }
    free(masks);
    return costs;
}

static void free_costs(Costs* costs)
{
    free(costs->tests);
    free(costs->bytes);
}

// The voxels of one object in one level, so that all are visited alike.
static LsBaked bake_elephant(const LsTestMesh* mesh, uint32_t patches, double price)
{
    LsBaked baked;
    ls_baked_open_desc(
        &baked, mesh, "cost", LS_TEST_ALONE,
        &(LsBakeDesc){
            .grid = 40, .patches = patches, .choose_patches = price > 0.0, .byte_price = price});
    assert_int_equal(baked.file.header->depth, 0);
    return baked;
}

static void choices_are_the_best(void** state)
{
    (void)state;
    enum
    {
        MOST = 5
    };
    static const double prices[] = {1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_ELEPHANT);
    Costs fixed[MOST + 1];
    for (uint32_t n = 1; n <= MOST; n++)
    {
        LsBaked baked = bake_elephant(&mesh, n, 0.0);
        fixed[n] = read_costs(&baked.file);
        assert_int_equal(baked.report.patches_count[n],
                         baked.report.voxel_kind_count[LS_VOXEL_MASKS]);
        ls_baked_close(&baked);
    }
    for (uint32_t p = 0; p < sizeof prices / sizeof *prices; p++)
    {
        LsBaked baked = bake_elephant(&mesh, MOST, prices[p]);
        Costs chosen = read_costs(&baked.file);
        double sum = 0.0, least = 0.0, tests = 0.0;
        for (uint32_t i = 0; i < chosen.count; i++)
        {
            double best = baked.file.voxels[i].reference_count;
            for (uint32_t n = 1; n <= MOST; n++)
            {
                best = fmin(best, fixed[n].tests[i] + prices[p] * fixed[n].bytes[i]);
            }
            least += best;
            sum += chosen.tests[i] + prices[p] * chosen.bytes[i];
            tests += chosen.tests[i];
        }
        print_message("price %g: cost %.1f of %.1f, %llu lists, %.3f tests a voxel\n", prices[p],
                      sum, least, (unsigned long long)baked.report.voxel_kind_count[LS_VOXEL_LIST],
                      baked.report.tests_per_voxel);
        assert_true(sum <= 1.005 * least);
        const double lookups =
            LS_LOOKUP_COST * (double)baked.report.voxel_kind_count[LS_VOXEL_MASKS];
        assert_true(fabs((tests - lookups) / chosen.count - baked.report.tests_per_voxel) < 1e-6);
        free_costs(&chosen);
        ls_baked_close(&baked);
    }
    for (uint32_t n = 1; n <= MOST; n++)
    {
        free_costs(&fixed[n]);
    }
    ls_test_mesh_destroy(&mesh);
}

// At the ends of the scale: no table pays, and none is too dear.
static void prices_without_limit(void** state)
{
    (void)state;
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_ELEPHANT);
    LsBaked dear = bake_elephant(&mesh, 3, 1e6);
    assert_int_equal(dear.report.voxel_kind_count[LS_VOXEL_MASKS], 0);
    assert_int_equal(ls_file_count(&dear.file, LS_CHUNK_SHAFTS), 0);
    assert_int_equal(dear.file.header->version_minor, 1);
    ls_baked_close(&dear);
    LsBaked cheap = bake_elephant(&mesh, 3, 1e-12);
    const uint64_t masks = cheap.report.voxel_kind_count[LS_VOXEL_MASKS];
    assert_true(masks > 0 && cheap.report.patches_count[3] * 10 > masks * 9);
    ls_baked_close(&cheap);
    ls_test_mesh_destroy(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_sum_to_one),
        cmocka_unit_test(weights_round_alike_everywhere),
        cmocka_unit_test(weights_are_those_of_lines),
        cmocka_unit_test(tests_are_weighed_bits),
        cmocka_unit_test(leaf_bvhs_test_what_boxes_let_in),
        cmocka_unit_test(choices_are_the_best),
        cmocka_unit_test(prices_without_limit),
    };
    return cmocka_run_group_tests_name("shaft cost", tests, NULL, NULL);
}
