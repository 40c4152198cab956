// Cells and N by expected work: the model against lines that are walked, and choices within a
// memory.

#include "baked.h"
#include "cost_model.h"
#include "hard_meshes.h"
#include "ls_messages.h"
#include "test_random.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- Lines through a grid -------------------------------------------------------------------------------

// A line in cells of the grid.
typedef struct Line
{
    double origin[3], direction[3];
    uint32_t octant;
} Line;

// Where the line is in a box: false if nowhere.
static bool clip(const Line* line, const double lower[3], const double upper[3], double* first,
                 double* last)
{
    for (int axis = 0; axis < 3; axis++)
    {
        const double inverse = 1.0 / line->direction[axis];
        const double a = (lower[axis] - line->origin[axis]) * inverse;
        const double b = (upper[axis] - line->origin[axis]) * inverse;
        *first = fmax(*first, fmin(a, b));
        *last = fmin(*last, fmax(a, b));
    }
    return *first < *last;
}

// Uniform among lines that meet the box [0, cells]: through a disk across a random direction.
static bool make_line(LsRandom* random, const double cells[3], Line* line)
{
    const double z = ls_random_between(random, -1.0, 1.0);
    const double turn = ls_random_between(random, 0.0, 2.0 * 3.14159265358979323846);
    const double around = sqrt(1.0 - z * z);
    const double d[3] = {around * cos(turn), around * sin(turn), z};
    const double u[3] = {-sin(turn), cos(turn), 0.0};
    const double v[3] = {-z * cos(turn), -z * sin(turn), around};
    const double radius =
        0.5 * sqrt(cells[0] * cells[0] + cells[1] * cells[1] + cells[2] * cells[2]);
    const double a = ls_random_between(random, -radius, radius);
    const double b = ls_random_between(random, -radius, radius);
    *line = (Line){0};
    for (int axis = 0; axis < 3; axis++)
    {
        line->direction[axis] = d[axis];
        line->origin[axis] = 0.5 * cells[axis] + a * u[axis] + b * v[axis];
        line->octant |= d[axis] < 0.0 ? 1u << axis : 0u;
    }
    const double zero[3] = {0};
    double first = -1e30, last = 1e30;
    return a * a + b * b <= radius * radius && clip(line, zero, cells, &first, &last);
}

// The cells of one level: those of the grid, of its blocks' table, or of a sub-grid.
typedef struct Level
{
    double lower[3]; // in cells of the grid
    double width;    // of a cell
    uint32_t cells[3];
} Level;

static uint32_t read_block(const LsFile* file, const uint32_t cell[3])
{
    const uint32_t* cells = file->objects[0].cells;
    const uint32_t nx = (cells[0] + 3) / 4, ny = (cells[1] + 3) / 4;
    return file->blocks[cell[0] / 4 + nx * (cell[1] / 4 + ny * (cell[2] / 4))];
}

static uint32_t cell_in_block(const uint32_t cell[3])
{
    return (cell[0] & 3) + 4 * (cell[1] & 3) + 16 * (cell[2] & 3);
}

// Boxes of a voxel's BVH that a line looks at between first and last.
static double count_boxes(const LsBvhNode* nodes, const Line* line, double first, double last)
{
    double boxes = 0.0;
    uint32_t i = 0;
    while (i < nodes[0].escape)
    {
        const LsBvhNode* node = &nodes[i];
        const double lower[3] = {node->lower.x, node->lower.y, node->lower.z};
        const double upper[3] = {node->upper.x, node->upper.y, node->upper.z};
        double enter = first, leave = last;
        boxes += 1.0;
        i = node->leaf == 0 && clip(line, lower, upper, &enter, &leave) ? i + 1 : node->escape;
    }
    return boxes;
}

// Steps of a line between first and last. `block` is a sub-grid's, or LS_NONE for the grid itself.
static double count_steps(const LsFile* file, const Level* level, uint32_t block, const Line* line,
                          double first, double last)
{
    double steps = 0.0, t = first;
    const double nudge = 1e-7 * level->width;
    while (t < last - nudge)
    {
        uint32_t cell[3];
        for (int axis = 0; axis < 3; axis++)
        {
            const double at = line->origin[axis] + (t + nudge) * line->direction[axis];
            const double k = floor((at - level->lower[axis]) / level->width);
            cell[axis] = (uint32_t)fmin(fmax(k, 0.0), level->cells[axis] - 1.0);
        }
        uint32_t side = 1, from[3] = {cell[0], cell[1], cell[2]};
        uint32_t word = block == LS_NONE ? read_block(file, cell)
                                         : file->cell_blocks[block].cells[cell_in_block(cell)];
        if (block == LS_NONE && (word & 15) == 0)
        {
            word = file->cell_blocks[word >> 4].cells[cell_in_block(cell)];
        }
        else if (block == LS_NONE)
        {
            side = 4;
            for (int axis = 0; axis < 3; axis++)
            {
                from[axis] = cell[axis] / 4 * 4;
            }
        }
        const uint32_t skip = (word & 15) == 0 ? 1 : word >> (4 * line->octant) & 15;
        double lower[3], upper[3], enter = -1e30, leave = 1e30;
        for (int axis = 0; axis < 3; axis++)
        {
            const bool falls = (line->octant >> axis & 1) != 0;
            const double near = from[axis] + (falls ? side : 0.0);
            const double far = near + (falls ? -1.0 : 1.0) * skip * side;
            lower[axis] = level->lower[axis] + level->width * fmin(near, far);
            upper[axis] = level->lower[axis] + level->width * fmax(near, far);
        }
        steps += 1.0;
        const bool is_in = clip(line, lower, upper, &enter, &leave);
        const LsVoxel* voxel = &file->voxels[word >> 4];
        if (is_in && (word & 15) == 0 && (voxel->shape & 255) == LS_VOXEL_SUBGRID)
        {
            const Level below = {.lower = {lower[0], lower[1], lower[2]},
                                 .width = level->width / 4.0,
                                 .cells = {4, 4, 4}};
            steps += 1.0 + count_steps(file, &below, voxel->table, line, fmax(enter, first), leave);
        }
        if (is_in && (word & 15) == 0 && (voxel->shape & 255) == LS_VOXEL_BVH)
        {
            steps += count_boxes(file->leaf_nodes + voxel->table, line, enter, leave);
        }
        t = is_in ? fmax(leave, t + nudge) : t + nudge;
    }
    return steps;
}

// Lines of the model come to all cells alike, real ones to those where the skip before ends.
static void check_steps(const LsTestMesh* mesh, const char* name, uint32_t grid,
                        uint32_t divide_above)
{
    LsBaked baked;
    ls_baked_open_desc(&baked, mesh, name, LS_TEST_ALONE,
                       &(LsBakeDesc){.grid = grid, .patches = 1, .divide_above = divide_above});
    const LsObject* object = &baked.file.objects[0];
    const double cells[3] = {object->cells[0], object->cells[1], object->cells[2]};
    const Level level = {.width = 1.0,
                         .cells = {object->cells[0], object->cells[1], object->cells[2]}};
    LsRandom random = {7};
    double sum = 0.0;
    uint32_t count = 0;
    while (count < 20000)
    {
        Line line;
        const double zero[3] = {0};
        double first = -1e30, last = 1e30;
        if (make_line(&random, cells, &line))
        {
            clip(&line, zero, cells, &first, &last);
            sum += count_steps(&baked.file, &level, LS_NONE, &line, first, last);
            count++;
        }
    }
    const double walked = sum / count, expected = baked.report.steps_per_line;
    print_message("%s %u, divided above %u: expected %.3f steps of a line, walked %.3f\n", name,
                  grid, divide_above, expected, walked);
    assert_true(fabs(expected / walked - 1.0) < 0.25);
    ls_baked_close(&baked);
}

static void steps_are_those_of_lines(void** state)
{
    (void)state;
    LsTestMesh bunny = ls_test_mesh_make(LS_TEST_MESH_BUNNY);
    check_steps(&bunny, "steps", 16, 0);                   // all of it divided
    check_steps(&bunny, "steps", 16, 3);                   // twice
    check_steps(&bunny, "steps", 16, LS_MAX_DIVIDE_ABOVE); // BVHs
    check_steps(&bunny, "steps", 64, 0);
    check_steps(&bunny, "steps", 64, 6);
    check_steps(&bunny, "steps", 200, 0);
    ls_test_mesh_destroy(&bunny);
    // A thin box, whose blocks mostly lie across its border.
    LsTestMesh ring = ls_test_mesh_make(LS_TEST_MESH_TEAPOT);
    for (uint32_t i = 0; i < ring.vertex_count; i++)
    {
        ring.positions[3 * i + 1] *= 0.01f;
    }
    check_steps(&ring, "thin", 100, 0);
    ls_test_mesh_destroy(&ring);
    LsTestMesh hub = ls_test_mesh_make(LS_TEST_MESH_HUB); // BVHs
    check_steps(&hub, "hub", 12, 0);
    ls_test_mesh_destroy(&hub);
}

// ---- Memory -------------------------------------------------------------------------------------------

static double count_work(const LsBakeReport* report)
{
    const LsWork work = {.steps = report->steps_per_line,
                         .lookups = report->lookups_per_line,
                         .tests = report->tests_per_line};
    return ls_work_cost(&work);
}

// Bytes of the chunks that tracing reads.
static uint64_t count_traced(const LsBakeReport* report)
{
    static const int chunks[] = {LS_CHUNK_OBJECTS,    LS_CHUNK_INSTANCES, LS_CHUNK_TOP_NODES,
                                 LS_CHUNK_TRIANGLES,  LS_CHUNK_BLOCKS,    LS_CHUNK_CELL_BLOCKS,
                                 LS_CHUNK_SUBGRIDS,   LS_CHUNK_VOXELS,    LS_CHUNK_REFERENCES,
                                 LS_CHUNK_LEAF_NODES, LS_CHUNK_SHAFTS};
    uint64_t sum = 0;
    for (size_t i = 0; i < sizeof chunks / sizeof *chunks; i++)
    {
        sum += report->chunk_bytes[chunks[i]];
    }
    return sum;
}

static void memory_is_kept_and_used(void** state)
{
    (void)state;
    static const LsTestPlacement placements[] = {LS_TEST_ALONE, LS_TEST_INSTANCES};
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_ELEPHANT);
    for (int p = 0; p < 2; p++)
    {
        double before = INFINITY;
        for (uint64_t memory = 600 << 10; memory <= 10 << 20; memory *= 2)
        {
            LsBaked baked;
            ls_baked_open_desc(&baked, &mesh, "memory", placements[p],
                               &(LsBakeDesc){.memory = memory});
            const uint64_t traced = count_traced(&baked.report);
            const double work = count_work(&baked.report);
            print_message("%7llu of %8llu bytes: %u cells, work %.2f\n", (unsigned long long)traced,
                          (unsigned long long)memory, baked.report.most_grid, work);
            assert_true(traced <= baked.report.memory_bytes);
            assert_true(traced + 256 >= baked.report.memory_bytes);
            assert_true(baked.report.memory_bytes <= memory);
            // Of all that is given, up to where every voxel has the most N (18.6 MB here); and twice as
            // much does not trace slower.
            assert_true(traced >= memory / 100 * 95);
            assert_true(work <= before);
            before = work;
            ls_baked_close(&baked);
        }
    }
    ls_test_mesh_destroy(&mesh);
}

// No grid of a search by hand does better by the model within the same memory; on a GPU:
// docs/cost-model.md.
static void choices_beat_a_search(void** state)
{
    (void)state;
    static const uint32_t grids[] = {16, 22, 31, 44, 62};
    static const uint64_t memories[] = {700 << 10, 2 << 20, 8 << 20};
    enum
    {
        MEMORY_COUNT = sizeof memories / sizeof *memories
    };
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_ELEPHANT);
    LsBaked baked;
    double chosen[MEMORY_COUNT];
    for (size_t m = 0; m < MEMORY_COUNT; m++)
    {
        ls_baked_open_desc(&baked, &mesh, "search", LS_TEST_ALONE,
                           &(LsBakeDesc){.memory = memories[m]});
        chosen[m] = count_work(&baked.report);
        ls_baked_close(&baked);
    }
    uint32_t compared = 0;
    for (size_t g = 0; g < sizeof grids / sizeof *grids; g++)
    {
        for (uint32_t patches = 1; patches <= 5; patches++)
        {
            ls_baked_open_desc(&baked, &mesh, "search", LS_TEST_ALONE,
                               &(LsBakeDesc){.grid = grids[g], .patches = patches});
            for (size_t m = 0; m < MEMORY_COUNT; m++)
            {
                if (baked.report.memory_bytes <= memories[m])
                {
                    assert_true(chosen[m] <= 1.02 * count_work(&baked.report));
                    compared++;
                }
            }
            ls_baked_close(&baked);
        }
    }
    assert_true(compared > 30);
    ls_test_mesh_destroy(&mesh);
}

// What is given beside a memory stays: the grid, and the most N.
static void what_is_given_stays(void** state)
{
    (void)state;
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_ELEPHANT);
    LsBaked baked;
    ls_baked_open_desc(&baked, &mesh, "given", LS_TEST_ALONE,
                       &(LsBakeDesc){.grid = 25, .memory = 2 << 20});
    assert_int_equal(baked.report.least_grid, 25);
    assert_int_equal(baked.report.most_grid, 25);
    assert_true(baked.report.memory_bytes <= 2 << 20);
    ls_baked_close(&baked);
    static const uint32_t most[] = {1, 2, 8};
    for (int i = 0; i < 3; i++)
    {
        ls_baked_open_desc(
            &baked, &mesh, "given", LS_TEST_ALONE,
            &(LsBakeDesc){.memory = 64 << 20, .choose_patches = true, .patches = most[i]});
        assert_true(baked.report.patches_count[most[i]] > 0);
        for (uint32_t n = most[i] + 1; n <= LS_MAX_PATCHES; n++)
        {
            assert_int_equal(baked.report.patches_count[n], 0);
        }
        ls_baked_close(&baked);
    }
    static const uint32_t above[] = {8, LS_MAX_DIVIDE_ABOVE};
    for (int i = 0; i < 2; i++)
    {
        ls_baked_open_desc(&baked, &mesh, "given", LS_TEST_ALONE,
                           &(LsBakeDesc){.memory = 1 << 20, .divide_above = above[i]});
        assert_int_equal(baked.report.subgrid_count > 0, i == 0);
        ls_baked_close(&baked);
    }
    // Scene shafts are part of the memory.
    ls_baked_open_desc(&baked, &mesh, "given", LS_TEST_ALONE,
                       &(LsBakeDesc){.memory = 2 << 20, .scene_patches = 8});
    assert_true(baked.report.memory_bytes <= 2 << 20);
    assert_true(baked.report.chunk_bytes[LS_CHUNK_SHAFTS] > 4 * 15 * 8 * 8 * 8 * 8);
    ls_baked_close(&baked);
    ls_test_mesh_destroy(&mesh);
}

// ---- Divisions ----------------------------------------------------------------------------------------

static double count_divisions(const LsDivision* divisions, uint32_t count, uint32_t kept,
                              double price)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++)
    {
        const LsDivision* division = &divisions[i];
        bool is_there = true;
        for (uint32_t k = division->parent; k != LS_NONE; k = divisions[k].parent)
        {
            is_there = is_there && (kept >> k & 1) != 0;
        }
        const bool is_kept = (kept >> i & 1) != 0;
        sum += !is_there ? 0.0
               : is_kept ? division->divided_work + price * (double)division->divided_bytes
                         : division->whole_work + price * (double)division->whole_bytes;
    }
    return sum;
}

// Of all ways to keep some of the divisions none costs less.
static void the_best_divisions_are_kept(void** state)
{
    (void)state;
    enum
    {
        COUNT = 9
    };
    LsRandom random = {11};
    uint32_t sums[2] = {0};
    for (int round = 0; round < 300; round++)
    {
        LsDivision divisions[COUNT];
        for (uint32_t i = 0; i < COUNT; i++)
        {
            const double parent = floor(ls_random_unit(&random) * (i + 1.0));
            divisions[i] = (LsDivision){
                .parent = parent < i ? (uint32_t)parent : LS_NONE,
                .whole_work = ls_random_between(&random, 0.0, 10.0),
                .divided_work = ls_random_between(&random, 0.0, 5.0),
                .whole_bytes = (uint64_t)ls_random_between(&random, 0.0, 1000.0),
                .divided_bytes = (uint64_t)ls_random_between(&random, 0.0, 1000.0),
            };
        }
        const double price = round % 3 == 0 ? 0.0 : ls_random_between(&random, 0.0, 0.02);
        double costs[COUNT], least = INFINITY;
        bool kept[COUNT];
        ls_divisions_choose(divisions, COUNT, price, costs, kept);
        uint32_t chosen = 0;
        for (uint32_t i = 0; i < COUNT; i++)
        {
            chosen |= (uint32_t)kept[i] << i;
            assert_true(!kept[i] || divisions[i].parent == LS_NONE || kept[divisions[i].parent]);
            sums[kept[i]]++;
        }
        for (uint32_t some = 0; some < 1u << COUNT; some++)
        {
            least = fmin(least, count_divisions(divisions, COUNT, some, price));
        }
        assert_true(count_divisions(divisions, COUNT, chosen, price) <= least + 1e-9);
    }
    assert_true(sums[0] > 200 && sums[1] > 200);
}

// The least memory that a scene takes, as the message tells it.
static uint64_t read_least(const char* path, uint32_t divide_above)
{
    const LsBakeInput input = {.path = path};
    const LsBakeDesc desc = {.inputs = &input,
                             .input_count = 1,
                             .output = LS_BINARY_DIR "/refused.lspace",
                             .memory = 1,
                             .divide_above = divide_above};
    LsError error;
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_MESSAGE_LIMIT_BUDGET / 100);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_BUDGET);
    const char* takes = strstr(error.text, "takes ");
    assert_non_null(takes);
    return strtoull(takes + strlen("takes "), NULL, 10);
}

// Where memory is short, voxels that are not worth a sub-grid have a BVH: less memory is enough, to
// the byte, and of the same the work is no more than if all were divided.
static void divisions_are_chosen(void** state)
{
    (void)state;
    static const char* path = LS_BINARY_DIR "/divisions.ply";
    for (int i = 0; i < 3; i++)
    {
        LsTestMesh mesh =
            i == 0 ? ls_test_mesh_make(LS_TEST_MESH_ELEPHANT)
                   : ls_hard_mesh_make(i == 1 ? LS_HARD_MESH_HUB : LS_HARD_MESH_SIZES, 3000);
        ls_test_mesh_write_ply(&mesh, path);
        const uint64_t least = read_least(path, 0), before = read_least(path, LS_MASK_TRIANGLES);
        print_message("%llu bytes at least, %llu if all are divided\n", (unsigned long long)least,
                      (unsigned long long)before);
        assert_true(least < before);
        LsBaked baked;
        ls_baked_open_desc(&baked, &mesh, "least", LS_TEST_ALONE, &(LsBakeDesc){.memory = least});
        assert_int_equal(baked.report.memory_bytes, least);
        assert_true(baked.report.voxel_kind_count[LS_VOXEL_BVH] > 0);
        ls_baked_close(&baked);
        for (uint64_t memory = before; memory < 3 * before; memory += before)
        {
            ls_baked_open_desc(&baked, &mesh, "divided", LS_TEST_ALONE,
                               &(LsBakeDesc){.memory = memory, .divide_above = LS_MASK_TRIANGLES});
            const double divided = count_work(&baked.report);
            ls_baked_close(&baked);
            ls_baked_open_desc(&baked, &mesh, "chosen", LS_TEST_ALONE,
                               &(LsBakeDesc){.memory = memory});
            print_message("%llu bytes: work %.3f, if all are divided %.3f\n",
                          (unsigned long long)memory, count_work(&baked.report), divided);
            const bool is_uneven = i == 2 && memory == before;
            assert_true(count_work(&baked.report) <= (is_uneven ? 0.8 : 1.01) * divided);
            ls_baked_close(&baked);
        }
        ls_test_mesh_destroy(&mesh);
    }
}

static void threads_choose_alike(void** state)
{
    (void)state;
    LsTestMesh mesh = ls_test_mesh_make(LS_TEST_MESH_ELEPHANT);
    static const uint32_t threads[3] = {1, 2, 8};
    static const uint64_t memories[3] = {0, 410 << 10, 3 << 20}; // the second: with BVHs
    for (int m = 0; m < 3; m++)
    {
        const uint64_t memory = memories[m];
        LsBaked baked[3];
        for (int i = 0; i < 3; i++)
        {
            ls_baked_open_desc(&baked[i], &mesh, "alike", LS_TEST_INSTANCES,
                               &(LsBakeDesc){.memory = memory, .threads = threads[i]});
            assert_int_equal(baked[i].mapping.size, baked[0].mapping.size);
            assert_memory_equal(baked[i].mapping.bytes, baked[0].mapping.bytes,
                                baked[0].mapping.size);
        }
        assert_true(m != 1 || baked[0].report.voxel_kind_count[LS_VOXEL_BVH] > 0);
        for (int i = 0; i < 3; i++)
        {
            ls_baked_close(&baked[i]);
        }
    }
    ls_test_mesh_destroy(&mesh);
}

// ---- Refused ------------------------------------------------------------------------------------------

static void check_refused(const char* path, LsBakeDesc desc, LsMessage message, const char* named)
{
    const LsBakeInput input = {.path = path};
    desc.inputs = &input;
    desc.input_count = 1;
    desc.output = LS_BINARY_DIR "/refused.lspace";
    LsError error;
    assert_int_equal(ls_bake_run(&desc, NULL, &error), message / 100);
    assert_int_equal(error.message, message);
    assert_non_null(strstr(error.text, named));
}

static void too_little_is_refused(void** state)
{
    (void)state;
    const char* bunny = LS_SOURCE_DIR "/scenes/bunny.ply";
    const char* lists = LS_SOURCE_DIR "/scenes/cornell_blocks.gltf"; // no object has a grid
    // LS_MESSAGE_LIMIT_BUDGET: 69,666 triangles of 48 bytes alone.
    check_refused(bunny, (LsBakeDesc){.memory = 3 << 20}, LS_MESSAGE_LIMIT_BUDGET, "--memory");
    check_refused(bunny, (LsBakeDesc){.memory = 1}, LS_MESSAGE_LIMIT_BUDGET, "--memory");
    check_refused(lists, (LsBakeDesc){.memory = 1}, LS_MESSAGE_LIMIT_BUDGET, "--memory");
    check_refused(bunny, (LsBakeDesc){.memory = 8 << 20, .scene_patches = 32},
                  LS_MESSAGE_LIMIT_BUDGET, "--scene-shafts");
    check_refused(bunny, (LsBakeDesc){.memory = 64 << 20, .patches = 3}, LS_MESSAGE_USAGE_CHOICE,
                  "patches 3");
    check_refused(bunny,
                  (LsBakeDesc){.memory = 64 << 20, .choose_patches = true, .byte_price = 0.1},
                  LS_MESSAGE_USAGE_CHOICE, "byte_price");
    check_refused(bunny, (LsBakeDesc){.byte_price = 0.1}, LS_MESSAGE_USAGE_CHOICE, "byte_price");
    check_refused(bunny, (LsBakeDesc){.grid = 8, .byte_price = 0.1}, LS_MESSAGE_USAGE_CHOICE,
                  "byte_price");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_are_those_of_lines),    cmocka_unit_test(memory_is_kept_and_used),
        cmocka_unit_test(choices_beat_a_search),       cmocka_unit_test(what_is_given_stays),
        cmocka_unit_test(the_best_divisions_are_kept), cmocka_unit_test(divisions_are_chosen),
        cmocka_unit_test(threads_choose_alike),        cmocka_unit_test(too_little_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
