// The reference tracer itself: hits known by hand, its culling against none, float against double.

#include "meshes.h"
#include "ray_sets.h"
#include "reference/ref_judge.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// A file in memory, as far as the reference looks at it: one object of kind list, some instances.
typedef struct LsMemoryScene
{
    LsHeader header;
    LsObject object;
    LsInstance instances[3];
    LsTriangle* triangles;
    LsFile file;
} LsMemoryScene;

static LsVec3 vertex_of(const LsTestMesh* mesh, uint32_t triangle, uint32_t corner)
{
    const float* p = mesh->positions + 3 * mesh->indices[3 * triangle + corner];
    return (LsVec3){p[0], p[1], p[2]};
}

static const LsInstance IDENTITY = {
    .object_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
    .world_from_object = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
    .node = LS_NONE,
    .mask = 255,
    .flags = LS_INSTANCE_IDENTITY,
};

static void build_scene(LsMemoryScene* scene, const LsTestMesh* mesh)
{
    memset(scene, 0, sizeof *scene);
    scene->triangles = malloc(mesh->triangle_count * sizeof(LsTriangle));
    assert_non_null(scene->triangles);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        scene->triangles[i] = (LsTriangle){.v0 = vertex_of(mesh, i, 0),
                                           .primitive = i,
                                           .v1 = vertex_of(mesh, i, 1),
                                           .v2 = vertex_of(mesh, i, 2)};
    }
    float lower[3], upper[3];
    ls_test_mesh_bounds(mesh, lower, upper);
    float longest = fmaxf(fmaxf(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
    scene->object = (LsObject){
        .lower = {lower[0], lower[1], lower[2]},
        .kind = LS_OBJECT_LIST,
        .upper = {upper[0], upper[1], upper[2]},
        .reach = 2.0f * longest,
        .triangle_count = mesh->triangle_count,
        .face_count = mesh->triangle_count,
    };
    scene->instances[0] = IDENTITY;
    memcpy(scene->header.lower, lower, sizeof lower);
    memcpy(scene->header.upper, upper, sizeof upper);
    scene->header.counts[LS_CHUNK_OBJECTS] = 1;
    scene->header.counts[LS_CHUNK_INSTANCES] = 1;
    scene->header.counts[LS_CHUNK_TRIANGLES] = mesh->triangle_count;
    scene->file = (LsFile){.header = &scene->header,
                           .objects = &scene->object,
                           .instances = scene->instances,
                           .triangles = scene->triangles};
}

static LsHit trace_one(const LsMemoryScene* scene, LsRay ray, uint32_t mask, uint32_t flags)
{
    LsReference* reference = ls_reference_create(&scene->file);
    assert_non_null(reference);
    LsHit hit;
    ls_reference_trace(reference, &ray, &mask, 1, flags, &hit);
    ls_reference_destroy(reference);
    return hit;
}

// The right triangle (0,0,0) (1,0,0) (0,1,0), twice: seen from +z its front.
static void build_pair(LsMemoryScene* scene)
{
    float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t indices[] = {0, 1, 2, 0, 1, 2};
    LsTestMesh mesh = {positions, 3, indices, 2, false};
    build_scene(scene, &mesh);
}

static const LsRay DOWN = {{0.25f, 0.5f, 1.0f}, 0.0f, {0.0f, 0.0f, -1.0f}, INFINITY};

static void known_hits(void** state)
{
    (void)state;
    LsMemoryScene scene;
    build_pair(&scene);
    LsHit hit = trace_one(&scene, DOWN, 255, 0);
    assert_true(hit.t == 1.0f && hit.u == 0.25f && hit.v == 0.5f);
    assert_int_equal(hit.primitive, 0); // of two alike the first
    assert_int_equal(hit.instance, 0);

    // In the interval, which is open; scaled; and from the other side.
    LsRay ray = DOWN;
    ray.tmax = 1.0f;
    assert_int_equal(trace_one(&scene, ray, 255, 0).primitive, LS_NONE);
    ray.tmax = nextafterf(1.0f, 2.0f);
    assert_int_equal(trace_one(&scene, ray, 255, 0).primitive, 0);
    ray.tmin = 1.0f;
    assert_int_equal(trace_one(&scene, ray, 255, 0).primitive, LS_NONE);
    ray = DOWN;
    ray.direction.z = -0x1p-30f;
    assert_true(trace_one(&scene, ray, 255, 0).t == 0x1p30f);
    ray = DOWN;
    ray.origin.z = -3.0f;
    ray.direction.z = 1.5f;
    assert_true(trace_one(&scene, ray, 255, 0).t == 2.0f);

    // Edges and corners belong to the triangle.
    ray = DOWN;
    ray.origin.x = 0.5f;
    assert_int_equal(trace_one(&scene, ray, 255, 0).primitive, 0);
    ray.origin.x = 0.0f;
    ray.origin.y = 0.0f;
    assert_int_equal(trace_one(&scene, ray, 255, 0).primitive, 0);
    ray.origin.x = -0x1p-30f;
    assert_int_equal(trace_one(&scene, ray, 255, 0).primitive, LS_NONE);
    free(scene.triangles);
}

static void flags_and_masks(void** state)
{
    (void)state;
    LsMemoryScene scene;
    build_pair(&scene);
    LsRay up = DOWN;
    up.origin.z = -1.0f;
    up.direction.z = 1.0f;
    assert_int_equal(trace_one(&scene, DOWN, 255, LS_RAY_FLAG_CULL_BACK_FACING).primitive, 0);
    assert_int_equal(trace_one(&scene, DOWN, 255, LS_RAY_FLAG_CULL_FRONT_FACING).primitive,
                     LS_NONE);
    assert_int_equal(trace_one(&scene, up, 255, LS_RAY_FLAG_CULL_BACK_FACING).primitive, LS_NONE);
    assert_int_equal(trace_one(&scene, up, 255, LS_RAY_FLAG_CULL_FRONT_FACING).primitive, 0);
    scene.instances[0].mask = 6;
    assert_int_equal(trace_one(&scene, DOWN, 9, 0).primitive, LS_NONE);
    assert_int_equal(trace_one(&scene, DOWN, 10, 0).primitive, 0);
    free(scene.triangles);
}

static void instances_and_ties(void** state)
{
    (void)state;
    LsMemoryScene scene;
    build_pair(&scene);
    // 0 lies at z = -1, 1 and 2 at z = 0; 1 is mirrored along x about 0.5.
    scene.header.required_features = LS_FEATURE_TOP_LEVEL;
    scene.header.counts[LS_CHUNK_INSTANCES] = 3;
    scene.instances[1] = scene.instances[2] = scene.instances[0];
    scene.instances[0].flags = 0;
    scene.instances[0].object_from_world[2].w = 1.0f;
    scene.instances[1].object_from_world[0] = (LsVec4){-1.0f, 0.0f, 0.0f, 1.0f};
    scene.instances[1].flags = LS_INSTANCE_MIRRORED;
    LsRay ray = DOWN;
    ray.origin.y = 0.125f;
    ray.direction.z = -0.5f;
    LsHit hit = trace_one(&scene, ray, 255, 0);
    assert_true(hit.t == 2.0f && hit.u == 0.75f && hit.v == 0.125f);
    assert_int_equal(hit.instance, 1);
    assert_int_equal(trace_one(&scene, ray, 255, LS_RAY_FLAG_CULL_FRONT_FACING).instance, 1);
    assert_int_equal(trace_one(&scene, ray, 255, LS_RAY_FLAG_CULL_BACK_FACING).instance, 2);
    scene.instances[1].mask = 0;
    assert_int_equal(trace_one(&scene, ray, 255, 0).instance, 2);
    scene.instances[2].mask = 0;
    hit = trace_one(&scene, ray, 255, 0);
    assert_int_equal(hit.instance, 0);
    assert_true(hit.t == 4.0f);
    free(scene.triangles);
}

static void illegal_rays_miss(void** state)
{
    (void)state;
    LsMemoryScene scene;
    build_pair(&scene);
    LsRay bad[10];
    for (uint32_t i = 0; i < 10; i++)
    {
        bad[i] = DOWN;
    }
    bad[0].origin.x = NAN;
    bad[1].origin.z = INFINITY;
    bad[2].direction.x = NAN;
    bad[3].direction.z = -INFINITY;
    bad[4].direction.z = 0.0f;
    bad[5].direction.z = -0x1p-127f;
    bad[6].tmin = NAN;
    bad[7].tmin = -0.5f;
    bad[8].tmax = NAN;
    bad[9].tmax = 0.0f;
    for (uint32_t i = 0; i < 10; i++)
    {
        LsHit hit = trace_one(&scene, bad[i], 255, 0);
        assert_true(hit.t == -1.0f);
        assert_int_equal(hit.instance, LS_NONE);
    }
    free(scene.triangles);
}

// Moved origins keep what they hit, and t counts from where the ray began.
static void far_origins(void** state)
{
    (void)state;
    LsMemoryScene scene;
    build_pair(&scene);
    LsRay ray = DOWN;
    for (uint32_t power = 1; power < 30; power++)
    {
        ray.origin.z = ldexpf(1.0f, (int)power);
        LsHit hit = trace_one(&scene, ray, 255, 0);
        assert_int_equal(hit.primitive, 0);
        assert_true(fabsf(hit.t - ray.origin.z) <= ldexpf(ray.origin.z, -20));
        assert_true(hit.u == 0.25f && hit.v == 0.5f);
    }
    free(scene.triangles);
}

// The judge: the right answer, and wrong ones of every kind.
static void judge_tells_defects(void** state)
{
    (void)state;
    LsMemoryScene scene;
    float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1, 1, 0, -1, 0, 1, -1};
    uint32_t indices[] = {0, 1, 2, 3, 4, 5};
    LsTestMesh mesh = {positions, 6, indices, 2, false};
    build_scene(&scene, &mesh);
    LsReference* reference = ls_reference_create(&scene.file);
    LsRay ray = DOWN;
    ray.origin.y = 0.25f;
    LsHit right;
    ls_reference_trace(reference, &ray, NULL, 1, 0, &right);
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &right), LS_VERDICT_RIGHT);
    LsHit wrong = ls_reference_miss();
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &wrong), LS_VERDICT_DEFECT);
    wrong = right;
    wrong.t = 1.0f + 0x1p-17f;
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &wrong), LS_VERDICT_DEFECT);
    wrong = right;
    wrong.primitive = 1;
    wrong.t = 2.0f;
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &wrong), LS_VERDICT_DEFECT);
    // On an edge both answers are right, a hair from tmax too.
    ray.origin.x = 0.75f;
    wrong = ls_reference_miss();
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &wrong), LS_VERDICT_EDGE);
    ray.origin.x = 0.25f;
    ray.tmax = nextafterf(1.0f, 2.0f);
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &wrong), LS_VERDICT_T_ERROR);
    // A hit where there is nothing.
    ray.tmax = INFINITY;
    ray.origin.x = 1.5f;
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &right), LS_VERDICT_DEFECT);
    assert_int_equal(ls_reference_judge_all(reference, &ray, 255, &wrong), LS_VERDICT_RIGHT);
    ls_reference_destroy(reference);
    free(scene.triangles);
}

// On real and unkind meshes: the float tracer keeps the contract with double, and the judge that
// looks only at triangles near the ray says what the one that looks at all says, of right and of
// spoilt answers.
static void float_keeps_the_contract(void** state)
{
    (void)state;
    static const LsTestMeshId ids[] = {LS_TEST_MESH_TEAPOT, LS_TEST_MESH_SLIVERS,
                                       LS_TEST_MESH_SHELL, LS_TEST_MESH_MICRO, LS_TEST_MESH_FAR};
    for (uint32_t m = 0; m < sizeof ids / sizeof ids[0]; m++)
    {
        LsTestMesh mesh = ls_test_mesh_make(ids[m]);
        LsMemoryScene scene;
        build_scene(&scene, &mesh);
        LsReference* reference = ls_reference_create(&scene.file);
        assert_non_null(reference);
        LsRaySet set = ls_ray_set_make(&scene.file, 4000, 11 + m);
        LsHit* hits = malloc(2 * set.count * sizeof *hits);
        LsVerdict* verdicts = malloc(2 * set.count * sizeof *verdicts);
        assert_true(hits && verdicts);
        ls_reference_trace(reference, set.rays, NULL, set.count, 0, hits);
        for (uint32_t i = 0; i < set.count; i++)
        {
            hits[set.count + i] = i % 2 ? ls_reference_miss() : hits[(i + 7) % set.count];
        }
        const LsHit* answers[2] = {hits, hits + set.count};
        LsVerdict* out[2] = {verdicts, verdicts + set.count};
        ls_reference_judge(reference, set.rays, NULL, set.count, 2, answers, out);
        uint32_t counts[2][LS_VERDICT_COUNT] = {{0}};
        uint32_t hit_count = 0;
        for (uint32_t i = 0; i < 2 * set.count; i++)
        {
            counts[i / set.count][verdicts[i]]++;
            hit_count += i < set.count && hits[i].instance != LS_NONE;
            if (i % 5 == 0)
            {
                const LsRay* ray = &set.rays[i % set.count];
                assert_int_equal(ls_reference_judge_all(reference, ray, 255, &hits[i]),
                                 verdicts[i]);
            }
            if (verdicts[i] == LS_VERDICT_DEFECT && i < set.count)
            {
                LsReferenceMargin margin = {.t = NAN};
                ls_reference_margin(reference, &set.rays[i], 255, hits[i].instance,
                                    hits[i].primitive, &margin);
                print_message("%s ray, t %.9g: %.17g +- %g, edge %g of %g, cosine %g, inside %d\n",
                              ls_ray_class_name(set.classes[i]), hits[i].t, margin.t,
                              margin.t_bound, margin.edge_distance, margin.edge_bound,
                              margin.cosine, margin.inside);
            }
        }
        print_message(
            "%s: %u of %u rays hit; right %u, edge %u, t error %u, edge-on %u, defect %u\n",
            ls_test_mesh_name(ids[m]), hit_count, set.count, counts[0][0], counts[0][1],
            counts[0][2], counts[0][3], counts[0][4]);
        assert_int_equal(counts[0][LS_VERDICT_DEFECT], 0);
        assert_true(counts[1][LS_VERDICT_DEFECT] > set.count / 10);
        assert_true(hit_count > set.count / 5);
        free(verdicts);
        free(hits);
        ls_ray_set_destroy(&set);
        ls_reference_destroy(reference);
        free(scene.triangles);
        ls_test_mesh_destroy(&mesh);
    }
}

static void meshes_are_what_they_claim(void** state)
{
    (void)state;
    for (uint32_t id = 0; id < LS_TEST_MESH_COUNT; id++)
    {
        LsTestMesh mesh = ls_test_mesh_make(id);
        for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++)
        {
            assert_true(mesh.indices[i] < mesh.vertex_count);
        }
        bool closed = ls_test_mesh_is_closed(&mesh);
        bool expected =
            id == LS_TEST_MESH_BUNNY || id == LS_TEST_MESH_ELEPHANT || id == LS_TEST_MESH_SHELL;
        assert_int_equal(closed, expected);
        ls_test_mesh_destroy(&mesh);
    }

    LsTestMesh teapot = ls_test_mesh_make(LS_TEST_MESH_TEAPOT);
    float lower[3], upper[3];
    ls_test_mesh_bounds(&teapot, lower, upper);
    assert_int_equal(teapot.triangle_count, 2304);
    assert_true(lower[0] == -3.0f || (lower[0] > -3.0f && lower[0] < -2.9f));
    assert_true(upper[0] > 3.4f && upper[0] < 3.525f);
    assert_true(lower[1] == -2.0f && upper[1] == 2.0f);
    assert_true(lower[2] == 0.0f && upper[2] > 3.1f && upper[2] <= 3.15f);
    ls_test_mesh_destroy(&teapot);

    LsTestMesh shell = ls_test_mesh_make(LS_TEST_MESH_SHELL);
    assert_true(ls_test_mesh_contains(&shell, (double[3]){0.51, 0.37, 5e-5})); // in a wall
    assert_false(ls_test_mesh_contains(&shell, (double[3]){0.51, 0.37, 0.4})); // in the hollow
    assert_false(ls_test_mesh_contains(&shell, (double[3]){0.51, 0.37, 1.4}));
    ls_test_mesh_destroy(&shell);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_hits),
        cmocka_unit_test(flags_and_masks),
        cmocka_unit_test(instances_and_ties),
        cmocka_unit_test(illegal_rays_miss),
        cmocka_unit_test(far_origins),
        cmocka_unit_test(judge_tells_defects),
        cmocka_unit_test(meshes_are_what_they_claim),
        cmocka_unit_test(float_keeps_the_contract),
    };
    return cmocka_run_group_tests_name("reference", tests, NULL, NULL);
}
