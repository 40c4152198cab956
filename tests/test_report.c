// What lsbake prints of a bake, and the errors of scenes that cannot be baked.

#include "ls_layout.h"
#include "ls_messages.h"
#include "report.h"

#include <cjson/cJSON.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

static char folder[] = "/tmp/ls-test-report-XXXXXX";

static char* path_in(char path[128], const char* name)
{
    snprintf(path, 128, "%s/%s", folder, name);
    return path;
}

static int make_folder(void** state)
{
    (void)state;
    return mkdtemp(folder) != NULL ? 0 : -1;
}

static int remove_folder(void** state)
{
    (void)state;
    static const char* const names[] = {"scene.off", "scene.gltf", "other.off", "out.lspace",
                                        "printed"};
    char path[128];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    {
        unlink(path_in(path, names[i]));
    }
    return rmdir(folder);
}

static void write_text(const char* name, const char* text)
{
    char path[128];
    FILE* file = fopen(path_in(path, name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

// Runs `print` with standard output going to a file, and returns what it wrote.
static char* capture(void (*print)(const LsBakeReport*), const LsBakeReport* report)
{
    char path[128];
    path_in(path, "printed");
    fflush(stdout);
    int kept = dup(STDOUT_FILENO);
    assert_true(kept >= 0 && freopen(path, "w", stdout) != NULL);
    print(report);
    fflush(stdout);
    assert_true(dup2(kept, STDOUT_FILENO) >= 0);
    close(kept);
    FILE* file = fopen(path, "r");
    assert_non_null(file);
    char* text = calloc(1, 1 << 16);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 16) - 1, file) > 0);
    fclose(file);
    return text;
}

static void print_text(const LsBakeReport* report)
{
    ls_report_print_text(report, "out.lspace");
}

static void print_json(const LsBakeReport* report)
{
    assert_true(ls_report_print_json(report, "out.lspace", &(BakeWarnings){0}));
}

// A tetrahedron without its last face; a face without area; a triangle that comes again at the end, turned round; a
// book of three faces; a tetrahedron of which one face is turned round.
static const char FAULTY[] = "OFF\n18 13 0\n"
                             "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0\n"
                             "5 0 0\n5 1 0\n6 0 0\n4 0 0\n5 0 1\n"
                             "0 9 0\n1 9 0\n0 10 0\n0 9 1\n0 9 0\n"
                             "20 0 0\n21 0 0\n20 1 0\n"
                             "3 0 2 1\n3 0 1 3\n3 2 0 3\n3 1 4 2\n3 15 16 17\n"
                             "3 5 6 7\n3 5 6 8\n3 6 5 9\n"
                             "3 10 12 11\n3 10 11 13\n3 12 13 14\n3 11 12 13\n3 17 16 15\n";

static LsBakeReport bake_faulty(void)
{
    char source[128], output[128];
    write_text("scene.off", FAULTY);
    // An object without a fault before it.
    write_text("other.off",
               "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 2 0 3\n3 1 2 3\n");
    const LsBakeInput inputs[2] = {{.path = path_in(output, "other.off")},
                                   {.path = path_in(source, "scene.off")}};
    char target[128];
    LsBakeReport report = {0};
    LsError error = {0};
    LsResult result = ls_bake_run(&(LsBakeDesc){.inputs = inputs,
                                                .input_count = 2,
                                                .output = path_in(target, "out.lspace"),
                                                .force = true},
                                  &report, &error);
    if (result != LS_OK)
    {
        fail_msg("%s", error.text);
    }
    return report;
}

static double number_of(const cJSON* object, const char* name)
{
    const cJSON* item = cJSON_GetObjectItemCaseSensitive(object, name);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

static void json_lists_all(void** state)
{
    (void)state;
    LsBakeReport report = bake_faulty();
    char* text = capture(print_json, &report);
    cJSON* root = cJSON_Parse(text);
    assert_non_null(root);
    assert_true(number_of(root, "dropped_faces") == 1.0);
    const cJSON* mesh = cJSON_GetObjectItemCaseSensitive(root, "mesh");
    assert_true(number_of(mesh, "input_vertices") == 22.0);
    assert_true(number_of(mesh, "vertices") == 20.0);
    assert_true(number_of(mesh, "faces") == 17.0);
    const cJSON* faulty = cJSON_GetObjectItemCaseSensitive(root, "faulty_objects");
    assert_int_equal(cJSON_GetArraySize(faulty), 1);
    const cJSON* object = cJSON_GetArrayItem(faulty, 0);
    assert_true(number_of(object, "object") == 1.0);
    assert_non_null(
        strstr(cJSON_GetObjectItemCaseSensitive(object, "input")->valuestring, "scene.off"));
    assert_true(number_of(object, "degenerate_faces") == 1.0);
    assert_true(number_of(object, "duplicate_faces") == 1.0);
    assert_true(number_of(object, "nonmanifold_edges") == 1.0);
    assert_true(number_of(object, "holes") == 1.0);
    const cJSON* examples = cJSON_GetObjectItemCaseSensitive(object, "examples");
    const cJSON* example;
    uint32_t seen = 0;
    cJSON_ArrayForEach(example, examples)
    {
        const char* fault = cJSON_GetObjectItemCaseSensitive(example, "fault")->valuestring;
        const cJSON* vertices = cJSON_GetObjectItemCaseSensitive(example, "vertices");
        double face = number_of(example, "face");
        if (strcmp(fault, "degenerate faces") == 0)
        {
            assert_true(face == 3.0);
            assert_true(cJSON_GetArrayItem(vertices, 1)->valuedouble == 4.0);
            seen |= 1;
        }
        else if (strcmp(fault, "duplicate faces") == 0)
        {
            assert_true(face == 12.0 && number_of(example, "first_face") == 4.0);
            seen |= 2;
        }
        else if (strcmp(fault, "inverted faces") == 0)
        {
            seen |= face == 10.0 ? 8 : 0;
        }
        else if (strcmp(fault, "holes") == 0)
        {
            assert_true(face == 0.0 && number_of(example, "edges") == 3.0);
            seen |= 16;
        }
        else if (strcmp(fault, "non-manifold edges") == 0)
        {
            assert_true(face == 5.0 && number_of(example, "faces") == 3.0);
            assert_int_equal(cJSON_GetArraySize(vertices), 2);
            seen |= 4;
        }
    }
    assert_int_equal(seen, 31);
    cJSON_Delete(root);
    free(text);
    ls_bake_report_destroy(&report);
    assert_null(report.faulty);
}

static void text_has_a_line_a_kind(void** state)
{
    (void)state;
    LsBakeReport report = bake_faulty();
    char* text = capture(print_text, &report);
    assert_non_null(strstr(text, "(1 dropped: they have no area)"));
    assert_non_null(
        strstr(text, "scene.off, object 1: degenerate faces 1: face 3 (vertices 1 4 2)"));
    assert_non_null(
        strstr(text, "object 1: duplicate faces 1: face 12 (vertices 17 16 15) as face 4"));
    assert_non_null(strstr(text,
                           "object 1: non-manifold edges 1: one of 3 faces, vertices 5 and 6, "
                           "the first face 5"));
    assert_null(strstr(text, "object 0"));
    free(text);
    ls_bake_report_destroy(&report);
}

// Seconds of every stage, and what memory it took: in both.
static void reports_tell_time_and_memory(void** state)
{
    (void)state;
    LsBakeReport report = bake_faulty();
    char* text = capture(print_json, &report);
    cJSON* root = cJSON_Parse(text);
    assert_non_null(root);
    free(text);
    text = capture(print_text, &report);
    const cJSON* stages = cJSON_GetObjectItemCaseSensitive(root, "stage_seconds");
    assert_int_equal(cJSON_GetArraySize(stages), LS_BAKE_STAGE_COUNT);
    double sum = 0.0;
    for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
    {
        const char* name = ls_bake_stage_text((LsBakeStage)i);
        const double seconds = number_of(stages, name);
        assert_true(seconds > 0.0 && seconds < 3600.0);
        sum += seconds;
        char words[64];
        snprintf(words, sizeof words, " %s %.2f s", name, seconds);
        assert_non_null(strstr(text, words));
    }
    assert_float_equal(sum, number_of(root, "seconds"), 1e-9);
    const double bytes = number_of(root, "peak_memory_bytes");
    assert_true(bytes > 1e5);
    char words[64];
    snprintf(words, sizeof words, "peak memory %.0f MB\n", bytes * 1e-6);
    assert_non_null(strstr(text, words));
    free(text);
    cJSON_Delete(root);
    ls_bake_report_destroy(&report);
}

static void expect_error(const char* name, const char* text, LsMessage message)
{
    char source[128], target[128];
    write_text(name, text);
    const LsBakeInput input = {.path = path_in(source, name)};
    LsError error = {0};
    LsBakeReport report = {0};
    path_in(target, "out.lspace");
    unlink(target);
    LsResult result = ls_bake_run(
        &(LsBakeDesc){.inputs = &input, .input_count = 1, .output = target}, &report, &error);
    assert_int_equal(result, message / 100);
    assert_int_equal(error.message, message);
    assert_null(report.faulty);
    assert_int_not_equal(access(target, F_OK), 0);
}

static void scenes_that_cannot_be_baked(void** state)
{
    (void)state;
    expect_error("scene.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", LS_MESSAGE_SCENE_NO_TRIANGLES);
    expect_error("scene.off", "OFF\n3 1 0\n0 0 0\n1 1 1\n2 2 2\n3 0 1 2\n",
                 LS_MESSAGE_SCENE_ALL_FLAT);
}

// An older file is taken for current only if it is sound, and not by a strict bake of what has warnings.
static void older_outputs(void** state)
{
    (void)state;
    char source[128], target[128];
    write_text("odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 0\nf 1//1 2//1 3//1\n");
    path_in(target, "out.lspace");
    unlink(target);
    const LsBakeInput input = {.path = path_in(source, "odd.obj")};
    LsBakeDesc desc = {.inputs = &input, .input_count = 1, .output = target};
    for (int round = 0; round < 3; round++)
    {
        LsBakeReport report = {0};
        LsError error = {0};
        assert_int_equal(ls_bake_run(&desc, &report, &error), LS_OK);
        assert_int_equal(report.up_to_date, round == 1);
        ls_bake_report_destroy(&report);
        if (round == 1)
        {
            FILE* file = fopen(target, "r+b");
            assert_non_null(file);
            assert_int_equal(fseek(file, -1, SEEK_END), 0);
            const int last = fgetc(file);
            assert_int_equal(fseek(file, -1, SEEK_END), 0);
            assert_int_not_equal(fputc(last ^ 1, file), EOF);
            assert_int_equal(fclose(file), 0);
        }
    }
    LsError error = {0};
    desc.strict = true;
    assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_ERROR_INPUT_WARNING);
    unlink(target);
    unlink(source);
}

// What N was chosen, and what is left to test.
static void voxels_by_patches(void** state)
{
    (void)state;
    const LsBakeInput input = {.path = LS_SOURCE_DIR "/tests/data/elephant.ply"};
    char target[128], line[64];
    LsBakeReport report = {0};
    LsError error = {0};
    assert_int_equal(ls_bake_run(&(LsBakeDesc){.inputs = &input,
                                               .input_count = 1,
                                               .output = path_in(target, "out.lspace"),
                                               .grid = 20,
                                               .choose_patches = true},
                                 &report, &error),
                     LS_OK);
    char* text = capture(print_text, &report);
    assert_non_null(strstr(text, "  expected triangle tests in a voxel "));
    snprintf(line, sizeof line, "%llu of 2", (unsigned long long)report.patches_count[2]);
    assert_non_null(strstr(text, line));
    free(text);
    text = capture(print_json, &report);
    cJSON* root = cJSON_Parse(text);
    assert_non_null(root);
    const cJSON* counts = cJSON_GetObjectItem(root, "voxels_by_patches");
    assert_int_equal(cJSON_GetArraySize(counts), LS_MAX_PATCHES + 1);
    double sum = 0.0;
    for (int n = 0; n <= LS_MAX_PATCHES; n++)
    {
        sum += cJSON_GetArrayItem(counts, n)->valuedouble;
    }
    assert_true(sum > 0.0 && sum == cJSON_GetObjectItem(root, "voxels_masks")->valuedouble);
    const double tests = cJSON_GetObjectItem(root, "tests_per_voxel")->valuedouble;
    assert_true(tests > 1.0 && tests < 32.0);
    cJSON_Delete(root);
    free(text);
    ls_bake_report_destroy(&report);
}

// Shaft tables of the finest kind over very many voxels: counted before anything is allocated.
static void tables_beyond_the_format(void** state)
{
    (void)state;
    const LsBakeInput input = {.path = LS_SOURCE_DIR "/scenes/bunny.ply"};
    char target[128];
    LsError error = {0};
    assert_int_equal(ls_bake_run(&(LsBakeDesc){.inputs = &input,
                                               .input_count = 1,
                                               .output = path_in(target, "out.lspace"),
                                               .grid = 48,
                                               .patches = 16},
                                 NULL, &error),
                     LS_ERROR_INPUT_LIMIT);
    assert_int_equal(error.message, LS_MESSAGE_LIMIT_RECORDS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_lists_all),
        cmocka_unit_test(text_has_a_line_a_kind),
        cmocka_unit_test(reports_tell_time_and_memory),
        cmocka_unit_test(scenes_that_cannot_be_baked),
        cmocka_unit_test(older_outputs),
        cmocka_unit_test(voxels_by_patches),
        cmocka_unit_test(tables_beyond_the_format),
    };
    return cmocka_run_group_tests_name("report", tests, make_folder, remove_folder);
}
