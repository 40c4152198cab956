// What the mesh stage says of how faces hang together: small meshes whose counts are known, and many
// random ones against a slow second opinion.

#include "reference/ref_topology.h"
#include "test_random.h"
#include "topology.h"
#include "weld.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

#define MAX_FACES 256

typedef struct Findings
{
    LsMeshReport report;
    LsMeshExamples examples;
} Findings;

// Checks faces given by vertices alone; none of them is flat.
static Findings check_faces(const uint32_t (*faces)[3], uint32_t face_count, uint32_t vertex_count)
{
    static const uint8_t flat[MAX_FACES];
    Findings findings = {0};
    const LsFaces input = {.corners = &faces[0][0],
                           .indices = &faces[0][0],
                           .flat = flat,
                           .face_count = face_count,
                           .vertex_count = vertex_count};
    assert_true(ls_topology_check(&input, 2, &findings.report, &findings.examples));
    return findings;
}

static const LsMeshExample* example_of(const Findings* findings, LsMeshFault fault, uint32_t index)
{
    assert_true(index < findings->examples.count[fault]);
    return &findings->examples.of[fault][index];
}

static void assert_faults(const Findings* findings, uint64_t duplicate, uint64_t inverted,
                          uint64_t unorientable, uint64_t boundary, uint64_t holes,
                          uint64_t nonmanifold)
{
    const LsMeshReport* report = &findings->report;
    assert_int_equal(report->duplicate_count, duplicate);
    assert_int_equal(report->inverted_count, inverted);
    assert_int_equal(report->unorientable_count, unorientable);
    assert_int_equal(report->boundary_edge_count, boundary);
    assert_int_equal(report->hole_count, holes);
    assert_int_equal(report->nonmanifold_edge_count, nonmanifold);
    for (int fault = 0; fault < LS_MESH_FAULT_COUNT; fault++)
    {
        uint64_t count = ls_mesh_fault_count(report, (LsMeshFault)fault);
        uint64_t kept = count < LS_MESH_EXAMPLES ? count : LS_MESH_EXAMPLES;
        assert_int_equal(findings->examples.count[fault], kept);
    }
}

// Corners of an octahedron: 0 and 5 its tips, 1 to 4 round its middle.
static const uint32_t OCTAHEDRON[8][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1},
                                          {5, 2, 1}, {5, 3, 2}, {5, 4, 3}, {5, 1, 4}};

static void closed_meshes_have_no_faults(void** state)
{
    (void)state;
    Findings findings = check_faces(OCTAHEDRON, 8, 6);
    assert_int_equal(findings.report.edge_count, 12);
    assert_faults(&findings, 0, 0, 0, 0, 0, 0);
}

static void holes_are_counted_and_shown(void** state)
{
    (void)state;
    // Without the first face: a hole of three edges.
    Findings one = check_faces(OCTAHEDRON + 1, 7, 6);
    assert_faults(&one, 0, 0, 0, 3, 1, 0);
    const LsMeshExample* hole = example_of(&one, LS_MESH_FAULT_HOLE, 0);
    assert_int_equal(hole->other, 3);
    // Edge (0, 1) is the last side of the face {0, 4, 1}, which runs from 1 to 0.
    assert_int_equal(hole->face, 2);
    assert_int_equal(hole->vertices[0], 1);
    assert_int_equal(hole->vertices[1], 0);
    assert_int_equal(hole->vertices[2], UINT32_MAX);

    // Two faces gone that share a corner alone: what is left there is two fans, and the loop goes from
    // one to the other, as the boundary of the surface does.
    uint32_t faces[6][3];
    memcpy(faces, OCTAHEDRON + 1, sizeof faces);
    memcpy(faces[1], OCTAHEDRON[7], sizeof faces[1]); // {0, 1, 2} and {0, 3, 4} are missing
    Findings two = check_faces((const uint32_t(*)[3])faces, 6, 6);
    assert_faults(&two, 0, 0, 0, 6, 1, 0);
    assert_int_equal(example_of(&two, LS_MESH_FAULT_HOLE, 0)->other, 6);

    // A single triangle is bounded by one loop, two that touch in a corner by two.
    static const uint32_t touching[2][3] = {{0, 1, 2}, {0, 3, 4}};
    Findings single = check_faces(touching, 1, 3);
    assert_faults(&single, 0, 0, 0, 3, 1, 0);
    Findings pair = check_faces(touching, 2, 5);
    assert_faults(&pair, 0, 0, 0, 6, 2, 0);
}

static void nonmanifold_edges_end_chains(void** state)
{
    (void)state;
    // Three triangles at an edge: the boundary is three chains that end there, and no loop.
    static const uint32_t book[3][3] = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
    Findings findings = check_faces(book, 3, 5);
    assert_faults(&findings, 0, 0, 0, 6, 0, 1);
    const LsMeshExample* edge = example_of(&findings, LS_MESH_FAULT_NONMANIFOLD, 0);
    assert_int_equal(edge->face, 0);
    assert_int_equal(edge->vertices[0], 0);
    assert_int_equal(edge->vertices[1], 1);
    assert_int_equal(edge->other, 3);
}

static void duplicates_of_any_order(void** state)
{
    (void)state;
    static const uint32_t two[3][3] = {{2, 3, 4}, {0, 1, 2}, {2, 1, 0}};
    Findings pair = check_faces(two, 3, 5);
    assert_int_equal(pair.report.duplicate_count, 1);
    const LsMeshExample* duplicate = example_of(&pair, LS_MESH_FAULT_DUPLICATE, 0);
    assert_int_equal(duplicate->face, 2);
    assert_int_equal(duplicate->other, 1);

    // The same face twice is nobody's to turn round, alone or in a sheet.
    static const uint32_t twice[2][3] = {{0, 1, 2}, {1, 2, 0}};
    Findings twins = check_faces(twice, 2, 3);
    assert_int_equal(twins.report.duplicate_count, 1);
    assert_int_equal(twins.report.inverted_count, 0);
    static const uint32_t sheet[3][3] = {{0, 1, 2}, {0, 2, 3}, {0, 2, 3}};
    assert_int_equal(check_faces(sheet, 3, 4).report.inverted_count, 0);

    static const uint32_t many[5][3] = {{1, 2, 0}, {0, 1, 2}, {1, 0, 3}, {0, 2, 1}, {3, 1, 0}};
    Findings five = check_faces(many, 5, 4);
    assert_int_equal(five.report.duplicate_count, 3);
    assert_int_equal(example_of(&five, LS_MESH_FAULT_DUPLICATE, 0)->face, 1);
    assert_int_equal(example_of(&five, LS_MESH_FAULT_DUPLICATE, 0)->other, 0);
    assert_int_equal(example_of(&five, LS_MESH_FAULT_DUPLICATE, 1)->face, 3);
    assert_int_equal(example_of(&five, LS_MESH_FAULT_DUPLICATE, 2)->face, 4);
    assert_int_equal(example_of(&five, LS_MESH_FAULT_DUPLICATE, 2)->other, 2);
    assert_int_equal(five.report.nonmanifold_edge_count, 3);
}

static void the_lesser_part_is_inverted(void** state)
{
    (void)state;
    uint32_t faces[8][3];
    memcpy(faces, OCTAHEDRON, sizeof faces);
    const uint32_t turned[3] = {0, 3, 6};
    for (int i = 0; i < 3; i++)
    {
        uint32_t* face = faces[turned[i]];
        uint32_t swap = face[1];
        face[1] = face[2];
        face[2] = swap;
    }
    Findings few = check_faces((const uint32_t(*)[3])faces, 8, 6);
    assert_faults(&few, 0, 3, 0, 0, 0, 0);
    for (uint32_t i = 0; i < 3; i++)
    {
        assert_int_equal(example_of(&few, LS_MESH_FAULT_INVERTED, i)->face, turned[i]);
    }
    // Of a pair that disagree the first is right.
    static const uint32_t pair[2][3] = {{0, 1, 2}, {0, 1, 3}};
    Findings two = check_faces(pair, 2, 4);
    assert_faults(&two, 0, 1, 0, 4, 1, 0);
    assert_int_equal(example_of(&two, LS_MESH_FAULT_INVERTED, 0)->face, 1);
}

static void moebius_strips_have_no_orientation(void** state)
{
    (void)state;
    enum
    {
        LENGTH = 5
    };
    uint32_t faces[2 * LENGTH][3];
    for (uint32_t i = 0; i < LENGTH; i++)
    {
        bool last = i + 1 == LENGTH;
        uint32_t a = 2 * i, b = 2 * i + 1;
        uint32_t c = last ? 1 : a + 2, d = last ? 0 : b + 2;
        memcpy(faces[2 * i], (uint32_t[3]){a, b, c}, sizeof faces[0]);
        memcpy(faces[2 * i + 1], (uint32_t[3]){b, d, c}, sizeof faces[0]);
    }
    Findings findings = check_faces((const uint32_t(*)[3])faces, 2 * LENGTH, 2 * LENGTH);
    assert_faults(&findings, 0, 0, 1, 2 * LENGTH, 1, 0);
    assert_int_equal(example_of(&findings, LS_MESH_FAULT_UNORIENTABLE, 0)->face, 0);
}

static void examples_end_at_the_eighth(void** state)
{
    (void)state;
    uint32_t faces[60][3];
    for (uint32_t i = 0; i < 60; i++)
    {
        memcpy(faces[i], (uint32_t[3]){3 * i, 3 * i + 1, 3 * i + 2}, sizeof faces[0]);
    }
    Findings findings = check_faces((const uint32_t(*)[3])faces, 60, 180);
    assert_faults(&findings, 0, 0, 0, 180, 60, 0);
}

// ---- Against the reference ----------------------------------------------------------------------

static void compare_meshes(const LsRefMesh* mesh, bool weld, uint64_t tally[6])
{
    uint32_t* ids = malloc((mesh->vertex_count + 1) * sizeof *ids);
    uint32_t* corners = malloc((3 * mesh->face_count + 1) * sizeof *corners);
    uint8_t* flat = malloc(mesh->face_count + 1);
    assert_true(ids != NULL && corners != NULL && flat != NULL);
    uint32_t vertex_count = mesh->vertex_count;
    if (weld)
    {
        assert_true(ls_weld(mesh->positions, mesh->vertex_count, ids, &vertex_count));
    }
    for (uint32_t c = 0; c < 3 * mesh->face_count; c++)
    {
        corners[c] = weld ? ids[mesh->indices[c]] : mesh->indices[c];
    }
    for (uint32_t f = 0; f < mesh->face_count; f++)
    {
        // No three positions lie on a line, and each has an x of its own.
        const uint32_t* v = mesh->indices + 3 * f;
        float a = mesh->positions[3 * v[0]], b = mesh->positions[3 * v[1]];
        float c = mesh->positions[3 * v[2]];
        flat[f] = a == b || b == c || c == a;
    }
    const LsFaces faces = {.corners = corners,
                           .indices = mesh->indices,
                           .flat = flat,
                           .face_count = mesh->face_count,
                           .vertex_count = vertex_count};
    Findings one = {0}, two = {0};
    assert_true(ls_topology_check(&faces, 1, &one.report, &one.examples));
    assert_true(ls_topology_check(&faces, 3, &two.report, &two.examples));
    assert_memory_equal(&one, &two, sizeof one);
    LsRefTopology expected = ls_ref_topology(mesh, weld);
    assert_int_equal(vertex_count, expected.vertices);
    assert_int_equal(one.report.degenerate_count, expected.degenerate);
    assert_int_equal(one.report.edge_count, expected.edges);
    assert_faults(&one, expected.duplicate, expected.inverted, expected.unorientable,
                  expected.boundary, expected.holes, expected.nonmanifold);
    const uint64_t found[6] = {expected.duplicate,   expected.inverted, expected.unorientable,
                               expected.nonmanifold, expected.holes,    expected.degenerate};
    for (int i = 0; i < 6; i++)
    {
        tally[i] += found[i];
    }
    free(ids);
    free(corners);
    free(flat);
}

static void random_meshes(void** state)
{
    (void)state;
    LsRandom random = {77};
    uint64_t tally[6] = {0};
    for (uint32_t round = 0; round < 3000; round++)
    {
        // From crowds in which all touch all to faces that seldom meet.
        float positions[3 * 96];
        uint32_t indices[3 * 64];
        uint32_t places = 3 + ls_random_below(&random, round % 3 == 0 ? 6 : 40);
        LsRefMesh mesh = {.positions = positions,
                          .vertex_count = places + places / 2,
                          .indices = indices,
                          .face_count = ls_random_below(&random, 65)};
        for (uint32_t v = 0; v < mesh.vertex_count; v++)
        {
            // On a curve of which no three points lie in a line; the last third repeats the first.
            float t = (float)(v % places);
            memcpy(positions + 3 * v, (float[3]){t, t * t, t == 0.0f && v > 0 ? -0.0f : t * t * t},
                   3 * sizeof(float));
        }
        bool strips = round % 2 == 0; // many faces in a row that share edges
        for (uint32_t c = 0; c < 3 * mesh.face_count; c++)
        {
            indices[c] = strips && c >= 3 && c % 3 != 2
                             ? indices[c - 2]
                             : ls_random_below(&random, mesh.vertex_count);
        }
        compare_meshes(&mesh, round % 5 != 0, tally);
    }
    print_message(
        "duplicate %llu, inverted %llu, unorientable %llu, non-manifold %llu, holes %llu, "
        "degenerate %llu\n",
        (unsigned long long)tally[0], (unsigned long long)tally[1], (unsigned long long)tally[2],
        (unsigned long long)tally[3], (unsigned long long)tally[4], (unsigned long long)tally[5]);
    for (int i = 0; i < 6; i++)
    {
        assert_true(tally[i] > 20);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_meshes_have_no_faults),
        cmocka_unit_test(holes_are_counted_and_shown),
        cmocka_unit_test(nonmanifold_edges_end_chains),
        cmocka_unit_test(duplicates_of_any_order),
        cmocka_unit_test(the_lesser_part_is_inverted),
        cmocka_unit_test(moebius_strips_have_no_orientation),
        cmocka_unit_test(examples_end_at_the_eighth),
        cmocka_unit_test(random_meshes),
    };
    return cmocka_run_group_tests_name("topology", tests, NULL, NULL);
}
