// test_lsinfo.c - the program as users run it: what it prints and how it ends. Arguments: the
// program.

#define _XOPEN_SOURCE 700

#include "file_fixture.h"

#include <cjson/cJSON.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char* program;
static char directory[LS_SCRATCH_PATH];
static char scene_path[LS_SCRATCH_PATH + 32];
static char broken_path[LS_SCRATCH_PATH + 32];
static char damaged_path[LS_SCRATCH_PATH + 32];

// How a run ended, and what it printed.
typedef struct Run
{
    int code;
    char out[16384];
    char error[2048];
} Run;

static void read_text(int descriptor, char* text, size_t size)
{
    size_t length = 0;
    ssize_t got;
    while ((got = read(descriptor, text + length, size - 1 - length)) > 0)
    {
        length += (size_t)got;
    }
    text[length] = '\0';
    close(descriptor);
}

// Runs lsinfo with arguments up to NULL; standard output goes to `out_path` if that is not NULL.
static Run run_lsinfo(const char* out_path, const char* first, const char* second,
                      const char* third)
{
    Run run = {0};
    int out[2], error[2];
    assert_int_equal(pipe(out), 0);
    assert_int_equal(pipe(error), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (out_path == NULL)
    {
        posix_spawn_file_actions_adddup2(&actions, out[1], 1);
    }
    else
    {
        posix_spawn_file_actions_addopen(&actions, 1, out_path, O_WRONLY, 0);
    }
    posix_spawn_file_actions_adddup2(&actions, error[1], 2);
    char* arguments[] = {(char*)program, (char*)first, (char*)second, (char*)third, NULL};
    char* environment[] = {NULL};
    pid_t child;
    assert_int_equal(posix_spawn(&child, program, &actions, NULL, arguments, environment), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(out[1]);
    close(error[1]);
    read_text(out[0], run.out, sizeof(run.out));
    read_text(error[0], run.error, sizeof(run.error));
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    run.code = WEXITSTATUS(status);
    return run;
}

// Nothing on standard output, one line on the other with the message's number that contains `part`.
static void expect_line(const Run* run, LsMessage message, const char* part)
{
    const int code = (int)ls_result_exit_code((LsResult)(message / 100));
    char start[32];
    const int length = snprintf(start, sizeof(start), "lsinfo: error %d: ", (int)message);
    if (run->code != code || strstr(run->error, part) == NULL || run->out[0] != '\0' ||
        strncmp(run->error, start, (size_t)length) != 0 ||
        strchr(run->error, '\n') != run->error + strlen(run->error) - 1)
    {
        fail_msg("exit %d, out \"%s\", error \"%s\"; expected exit %d, \"%s\" and \"%s\"",
                 run->code, run->out, run->error, code, start, part);
    }
}

static void test_help_and_version(void** state)
{
    (void)state;
    Run run = run_lsinfo(NULL, "--help", NULL, NULL);
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "usage: lsinfo"));
    assert_non_null(strstr(run.out, "--json"));
    run = run_lsinfo(NULL, "--version", NULL, NULL);
    assert_int_equal(run.code, 0);
    assert_string_equal(run.out, "lsinfo 0.1, format 0.4\n");
}

static void test_usage_errors(void** state)
{
    (void)state;
    Run run = run_lsinfo(NULL, NULL, NULL, NULL);
    expect_line(&run, LS_MESSAGE_LSINFO_FILES, "no file");
    run = run_lsinfo(NULL, "--frobnicate", scene_path, NULL);
    expect_line(&run, LS_MESSAGE_LSINFO_OPTION, "unknown option --frobnicate");
    run = run_lsinfo(NULL, "check", NULL, NULL);
    expect_line(&run, LS_MESSAGE_LSINFO_FILES, "no file");
    run = run_lsinfo(NULL, scene_path, scene_path, NULL);
    expect_line(&run, LS_MESSAGE_LSINFO_FILES, "more than one file");
    run = run_lsinfo(NULL, "--full", scene_path, NULL);
    expect_line(&run, LS_MESSAGE_LSINFO_COMMAND, "--full");
    run = run_lsinfo(NULL, "check", "--json", scene_path);
    expect_line(&run, LS_MESSAGE_LSINFO_COMMAND, "--json");
}

static void test_input_errors(void** state)
{
    (void)state;
    Run run = run_lsinfo(NULL, "/nonexistent.lspace", NULL, NULL);
    expect_line(&run, LS_MESSAGE_FILE_MISSING, "/nonexistent.lspace: file not found");
    run = run_lsinfo(NULL, directory, NULL, NULL);
    expect_line(&run, LS_MESSAGE_FILE_IS_FOLDER, "is a directory");
    run = run_lsinfo(NULL, "--", program, NULL);
    expect_line(&run, LS_MESSAGE_LSPACE_FOREIGN, "not an .lspace file");
    run = run_lsinfo("/dev/full", scene_path, NULL, NULL);
    expect_line(&run, LS_MESSAGE_OUTPUT_STANDARD, "cannot be written");
}

static void test_check(void** state)
{
    (void)state;
    Run run = run_lsinfo(NULL, "check", scene_path, NULL);
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "every rule holds (structure;"));
    run = run_lsinfo(NULL, "check", "--full", scene_path);
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "every rule holds (full check"));
    run = run_lsinfo(NULL, "check", broken_path, NULL);
    expect_line(&run, LS_MESSAGE_LSPACE_RULE, "R4.9: MATERIALS record 0");
    run = run_lsinfo(NULL, broken_path, NULL, NULL);
    expect_line(&run, LS_MESSAGE_LSPACE_RULE, "R4.9: MATERIALS record 0");
    run = run_lsinfo(NULL, "check", damaged_path, NULL);
    assert_int_equal(run.code, 0); // a colour may have any value
    run = run_lsinfo(NULL, "check", damaged_path, "--full");
    expect_line(&run, LS_MESSAGE_LSPACE_DAMAGED_CHUNK, "R3.8");
}

static void test_text(void** state)
{
    (void)state;
    static const char* const parts[] = {
        ".lspace 0.2, for readers from 0.2 on, 110816 bytes\n",
        "required features  top-level lists grids sub-grids leaf-bvhs masks\n",
        "optional features  lights cameras nodes surfaces attributes lamps animations\n",
        "world bounds       (-1, -1, -1) to (7, 1, 1)\n",
        "TRIANGLES              43     48           2064    1.86%\n",
        "KEYS                   56      4            224    0.20%\n",
        "objects            3: 1 list, 2 grid\n",
        "triangles          43 of 85 faces, 83 with all instances\n",
        "voxels             13: 3 list, 5 masks, 3 subgrid, 2 bvh\n",
        "sub-grids          3, at most 2 deep\n",
        "surfaces           1, 1 with holes\n",
        "textures           2 of 2 images, 5 pixels\n",
        "attributes         1 objects with normals, 1 and 1 with texture coordinates 0 and 1, 2 "
        "with "
        "colours\n",
        "corner normals     6, 1 of them the face's\n",
        "lamps              3: 1 point, 1 spot, 1 directional\n",
        "animations         2 of 2 nodes, 56 keys, at most 4 s\n",
        "nothing: the scene uses every chunk\n",
    };
    Run run = run_lsinfo(NULL, scene_path, NULL, NULL);
    assert_int_equal(run.code, 0);
    assert_string_equal(run.error, "");
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); ++i)
    {
        if (strstr(run.out, parts[i]) == NULL)
        {
            fail_msg("\"%s\" is missing in\n%s", parts[i], run.out);
        }
    }
}

// The masks say the same in any width.
static void test_exact_masks(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsShaftLayout exact = ls_mask_layout(&fixture.desc, true);
    char path[LS_SCRATCH_PATH + 32];
    snprintf(path, sizeof(path), "%s/exact.lspace", directory);
    assert_int_equal(ls_file_write(&exact.desc, path, NULL), LS_OK);
    ls_shaft_layout_destroy(&exact);
    Run run = run_lsinfo(NULL, path, NULL, NULL);
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, ".lspace 0.3, for readers from 0.3 on, "));
    assert_non_null(strstr(run.out, "grids sub-grids leaf-bvhs masks exact-masks\n"));
    Run padded = run_lsinfo(NULL, scene_path, NULL, NULL);
    const char* shafts = strstr(run.out, "shafts  ");
    const char* expected = strstr(padded.out, "shafts  ");
    assert_non_null(shafts);
    assert_non_null(expected);
    assert_memory_equal(shafts, expected, (size_t)(strchr(expected, '\n') - expected));
}

static void test_scene_shafts(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsShaftLayout scene = ls_scene_shaft_layout(&fixture.desc, 1);
    char path[LS_SCRATCH_PATH + 32];
    snprintf(path, sizeof(path), "%s/shafts.lspace", directory);
    assert_int_equal(ls_file_write(&scene.desc, path, NULL), LS_OK);
    ls_shaft_layout_destroy(&scene);
    Run run = run_lsinfo(NULL, path, NULL, NULL);
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, ".lspace 0.4, for readers from 0.4 on, "));
    assert_non_null(strstr(run.out, "grids sub-grids leaf-bvhs masks scene-shafts\n"));
    assert_non_null(strstr(run.out, "scene shafts       30, 80.00% filled\n"));
    run = run_lsinfo(NULL, scene_path, NULL, NULL);
    assert_null(strstr(run.out, "scene shafts"));
}

static double find_number(const cJSON* object, const char* key)
{
    const cJSON* item = cJSON_GetObjectItemCaseSensitive(object, key);
    assert_true(cJSON_IsNumber(item));
    return item->valuedouble;
}

static void test_json(void** state)
{
    (void)state;
    Run run = run_lsinfo(NULL, "--json", scene_path, NULL);
    assert_int_equal(run.code, 0);
    cJSON* root = cJSON_Parse(run.out);
    assert_non_null(root);
    assert_string_equal(cJSON_GetObjectItem(root, "format")->valuestring, "0.2");
    assert_string_equal(cJSON_GetObjectItem(root, "reader_format")->valuestring, "0.2");
    assert_string_equal(cJSON_GetObjectItem(root, "file")->valuestring, scene_path);
    const cJSON* chunks = cJSON_GetObjectItem(root, "chunks");
    assert_int_equal(cJSON_GetArraySize(chunks), LS_CHUNK_COUNT);
    double bytes = LS_HEADER_BYTES + LS_CHUNK_COUNT * LS_ENTRY_BYTES;
    for (int i = 0; i < LS_CHUNK_COUNT; ++i)
    {
        const cJSON* chunk = cJSON_GetArrayItem(chunks, i);
        assert_string_equal(cJSON_GetObjectItem(chunk, "name")->valuestring,
                            ls_chunk_info((LsChunk)i).name);
        assert_true(find_number(chunk, "bytes") ==
                    find_number(chunk, "records") * find_number(chunk, "stride"));
        bytes += find_number(chunk, "bytes");
    }
    const cJSON* scene = cJSON_GetObjectItem(root, "scene");
    assert_true(bytes + find_number(scene, "padding_bytes") == find_number(root, "file_bytes"));
    assert_true(find_number(scene, "triangles") == LS_FIXTURE_TRIANGLES);
    assert_true(find_number(scene, "instanced_triangles") == 83);
    assert_true(find_number(scene, "cells") == 6 * 5 * 4 + 1);
    assert_true(find_number(scene, "depth") == 2);
    assert_true(find_number(scene, "shafts") == 15 * (1 + 16 + 1 + 1 + 81));
    // In file_fixture.c every third word of a table has all of its masks set.
    assert_true(find_number(scene, "filled_shafts") == 8 + 80 + 6 + 5 + 408);
    assert_true(find_number(cJSON_GetObjectItem(scene, "voxel_kinds"), "bvh") == 2);
    assert_true(find_number(scene, "pixels") == 5);
    assert_true(find_number(scene, "surfaces_with_holes") == 1);
    assert_true(find_number(scene, "objects_with_colors") == 2);
    assert_true(find_number(scene, "objects_with_texcoords_1") == 1);
    assert_true(find_number(scene, "corners_without_normal") == 1);
    assert_true(find_number(scene, "animated_nodes") == 2);
    assert_true(find_number(scene, "longest_animation_seconds") == 4);
    assert_true(find_number(cJSON_GetObjectItem(scene, "lamp_kinds"), "spot") == 1);
    const cJSON* optional = cJSON_GetObjectItem(root, "optional_features");
    assert_int_equal(cJSON_GetArraySize(optional), 7);
    assert_string_equal(cJSON_GetArrayItem(optional, 6)->valuestring, "animations");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(root, "left_out")), 0);
    cJSON_Delete(root);
}

// A scene of one list: what is not there is named, with the reason.
static void test_what_is_left_out(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    fixture.triangles[1].material = 0;
    LsFileDesc desc = {
        .objects = fixture.objects,
        .OBJECTS_count = 1,
        .instances = fixture.instances,
        .INSTANCES_count = 1,
        .materials = fixture.materials,
        .MATERIALS_count = 1,
        .triangles = fixture.triangles,
        .TRIANGLES_count = 2,
    };
    fixture.instances[0].node = LS_NONE;
    char path[LS_SCRATCH_PATH + 32];
    snprintf(path, sizeof(path), "%s/list.lspace", directory);
    assert_int_equal(ls_file_write(&desc, path, NULL), LS_OK);
    Run run = run_lsinfo(NULL, path, NULL, NULL);
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "  top level: one object, one instance, the identity\n"));
    assert_non_null(strstr(run.out, "  lights: no emissive triangle\n"));
    assert_non_null(strstr(run.out, "  grids: every object is a list of few triangles\n"));
    assert_non_null(strstr(run.out, ".lspace 0.1, for readers from 0.1 on, "));
    assert_non_null(
        strstr(run.out, "  surfaces: no material has transmission, holes or textures\n"));
    assert_non_null(strstr(run.out, "  lamps: the input has none\n"));
    assert_non_null(strstr(run.out, "  keys: there are no animations\n"));
    assert_null(strstr(run.out, "absent"));
    run = run_lsinfo(NULL, path, "--json", NULL);
    cJSON* root = cJSON_Parse(run.out);
    assert_non_null(root);
    const cJSON* absent = cJSON_GetObjectItem(root, "left_out");
    assert_int_equal(cJSON_GetArraySize(absent), LS_CHUNK_COUNT - 4);
    assert_string_equal(cJSON_GetObjectItem(absent, "LIGHTS")->valuestring,
                        "lights: no emissive triangle");
    cJSON_Delete(root);
}

static void write_edited(const char* path, const LsFixtureBytes* bytes)
{
    assert_int_equal(ls_bytes_write(bytes->bytes, bytes->size, path, NULL), LS_OK);
}

static int set_up(void** state)
{
    (void)state;
    ls_scratch_create(directory);
    snprintf(scene_path, sizeof(scene_path), "%s/scene.lspace", directory);
    snprintf(broken_path, sizeof(broken_path), "%s/broken.lspace", directory);
    snprintf(damaged_path, sizeof(damaged_path), "%s/damaged.lspace", directory);
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    assert_int_equal(ls_file_write(&fixture.desc, scene_path, NULL), LS_OK);
    LsFixtureBytes bytes = ls_fixture_read(scene_path);
    LsFile file;
    assert_int_equal(ls_file_open(&file, bytes.bytes, bytes.size, "", NULL), LS_OK);
    LsMaterial* material = (LsMaterial*)file.materials;
    material->base_color.x = 0.25f;
    write_edited(damaged_path, &bytes);
    material->base_color.x = 2;
    ls_fixture_rehash(&bytes);
    write_edited(broken_path, &bytes);
    ls_fixture_free(&bytes);
    return 0;
}

static int tear_down(void** state)
{
    (void)state;
    ls_scratch_remove(directory);
    return 0;
}

int main(int argument_count, char** arguments)
{
    if (argument_count < 2)
    {
        fprintf(stderr, "usage: test_lsinfo PATH_OF_LSINFO\n");
        return 1;
    }
    program = arguments[1];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_help_and_version),
        cmocka_unit_test(test_usage_errors),
        cmocka_unit_test(test_input_errors),
        cmocka_unit_test(test_check),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_exact_masks),
        cmocka_unit_test(test_scene_shafts),
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_what_is_left_out),
    };
    return cmocka_run_group_tests_name("lsinfo", tests, set_up, tear_down);
}
