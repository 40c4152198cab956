// lstrace as its users run it. The first argument is the program.

#define _XOPEN_SOURCE 700 // realpath

#include "small_scenes.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum
{
    RAY_COUNT = 1000
};

static char program[4096];
static char folder[] = "/tmp/ls_test_lstrace_XXXXXX";
static char output[4096]; // of the last run, standard output
static char errors[4096]; // and standard error

// ---- Files and runs ----------------------------------------------------------------------------

static size_t read_bytes(const char* name, void* bytes, size_t size)
{
    FILE* file = fopen(name, "rb");
    assert_non_null(file);
    size_t got = fread(bytes, 1, size, file);
    fclose(file);
    return got;
}

static void read_text(const char* name, char* text, size_t size)
{
    text[read_bytes(name, text, size - 1)] = '\0';
}

static void write_bytes(const char* name, const void* bytes, size_t size)
{
    FILE* file = fopen(name, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static int count_files(void)
{
    DIR* directory = opendir(".");
    assert_non_null(directory);
    int count = 0;
    while (readdir(directory))
    {
        count++;
    }
    closedir(directory);
    return count;
}

// Runs lstrace with arguments as the shell takes them; %s stands for the program. Returns its exit
// code; the texts are in `output` and `errors`.
static int run_shell(const char* format)
{
    char command[8192];
    int used = snprintf(command, sizeof(command), "{ ");
    used += snprintf(command + used, sizeof(command) - (size_t)used, format, program);
    snprintf(command + used, sizeof(command) - (size_t)used, "; } >stdout.txt 2>stderr.txt");
    int status = system(command);
    assert_true(WIFEXITED(status));
    read_text("stdout.txt", output, sizeof(output));
    read_text("stderr.txt", errors, sizeof(errors));
    return WEXITSTATUS(status);
}

// The scene's hits as LS_SMALL_INSTANCES has them: quads in cells 0, 10, 11 and 20 of x.
static LsRay make_ray(uint32_t i)
{
    LsRay ray = {
        .origin = {(float)(i % 22) + 0.75f, 0.25f, 1}, .direction = {0, 0, -1}, .tmax = INFINITY};
    if (i % 50 == 49)
    {
        ray.tmin = NAN;
    }
    return ray;
}

static uint32_t expect_instance(uint32_t i)
{
    uint32_t cell = i % 22;
    if (i % 50 == 49)
    {
        return LS_NONE;
    }
    return cell == 0 ? 0 : cell == 10 || cell == 11 ? 1 : cell == 20 ? 2 : LS_NONE;
}

static int set_up(void** state)
{
    (void)state;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    ls_small_scene_write(LS_SMALL_INSTANCES, "scene.lspace");
    LsRay rays[RAY_COUNT];
    for (uint32_t i = 0; i < RAY_COUNT; i++)
    {
        rays[i] = make_ray(i);
    }
    write_bytes("rays.bin", rays, sizeof(rays));
    char odd[sizeof(rays) + 7] = {0};
    memcpy(odd, rays, sizeof(rays));
    write_bytes("odd.bin", odd, sizeof(odd));
    write_bytes("empty.bin", odd, 0);
    write_bytes("foreign.lspace", rays, sizeof(rays));
    char scene[65536];
    size_t size = read_bytes("scene.lspace", scene, sizeof(scene));
    write_bytes("cut.lspace", scene, size - 1);
    assert_int_equal(mkdir("folder", 0777), 0);
    // Their places, so that the number of files tells what a run has left.
    write_bytes("stdout.txt", "", 0);
    write_bytes("stderr.txt", "", 0);
    return 0;
}

static int tear_down(void** state)
{
    (void)state;
    assert_int_equal(chdir("/"), 0);
    char command[128];
    snprintf(command, sizeof(command), "rm -r %s", folder);
    return system(command);
}

// ---- What it does ------------------------------------------------------------------------------

static void test_help_and_version(void** state)
{
    (void)state;
    assert_int_equal(run_shell("%s --help"), LS_EXIT_OK);
    const char* options[] = {"--rays",   "-o",      "--any",    "--method",
                             "--repeat", "--batch", "--device", "--quiet"};
    for (size_t i = 0; i < sizeof(options) / sizeof(options[0]); i++)
    {
        assert_non_null(strstr(output, options[i]));
    }
    assert_string_equal(errors, "");
    assert_int_equal(run_shell("%s --version"), LS_EXIT_OK);
    assert_string_equal(output, "lstrace " LS_VERSION_TEXT "\n");
}

static void test_hits(void** state)
{
    (void)state;
    assert_int_equal(run_shell("%s scene.lspace --rays rays.bin -o hits.bin"), LS_EXIT_OK);
    assert_string_equal(errors, "");
    LsHit hits[RAY_COUNT + 1];
    assert_int_equal(read_bytes("hits.bin", hits, sizeof(hits)), RAY_COUNT * sizeof(LsHit));
    uint32_t hit_count = 0;
    for (uint32_t i = 0; i < RAY_COUNT; i++)
    {
        uint32_t instance = expect_instance(i);
        bool hit = instance != LS_NONE;
        hit_count += hit;
        assert_int_equal(hits[i].instance, instance);
        assert_float_equal(hits[i].t, hit ? 1 : -1, 0);
        assert_int_equal(hits[i].object, hit ? 0 : LS_NONE);
        assert_true(hits[i].primitive == LS_NONE ? !hit : hit);
        assert_int_equal(hits[i].flags, 0);
    }
    char text[64];
    snprintf(text, sizeof(text), "%d rays, %u hits", RAY_COUNT, hit_count);
    assert_non_null(strstr(output, text));
    unlink("hits.bin");
}

// Every way of streaming gives the same bytes.
static void test_streaming(void** state)
{
    (void)state;
    static const char* const RUNS[] = {
        "%s scene.lspace --rays rays.bin -o other.bin --batch 7",
        "%s scene.lspace --rays rays.bin -o other.bin --batch 1000",
        "%s scene.lspace --rays rays.bin -o other.bin --method brute",
        "%s scene.lspace --rays rays.bin -o other.bin --method exact --repeat 2 --batch 999",
        "cat rays.bin | %s scene.lspace --rays - -o other.bin --batch 300",
        "%s scene.lspace --rays rays.bin -o - > other.bin",
        "cat rays.bin | %s --rays - scene.lspace --output - | cat > other.bin",
    };
    assert_int_equal(run_shell("%s scene.lspace --rays rays.bin -o hits.bin --quiet"), LS_EXIT_OK);
    assert_string_equal(output, "");
    assert_string_equal(errors, "");
    LsHit hits[RAY_COUNT];
    assert_int_equal(read_bytes("hits.bin", hits, sizeof(hits)), sizeof(hits));
    for (size_t i = 0; i < sizeof(RUNS) / sizeof(RUNS[0]); i++)
    {
        assert_int_equal(run_shell(RUNS[i]), LS_EXIT_OK);
        LsHit other[RAY_COUNT + 1];
        assert_int_equal(read_bytes("other.bin", other, sizeof(other)), sizeof(hits));
        assert_memory_equal(other, hits, sizeof(hits));
        unlink("other.bin");
    }
    unlink("hits.bin");
}

static void test_any_hit(void** state)
{
    (void)state;
    assert_int_equal(run_shell("%s scene.lspace --rays rays.bin -o hits.bin --any"), LS_EXIT_OK);
    LsHit hits[RAY_COUNT];
    assert_int_equal(read_bytes("hits.bin", hits, sizeof(hits)), sizeof(hits));
    for (uint32_t i = 0; i < RAY_COUNT; i++)
    {
        uint32_t instance = expect_instance(i);
        assert_int_equal(hits[i].instance, instance);
        float t = instance == LS_NONE ? -1 : 0; // the macro would cast a part of the expression
        assert_float_equal(hits[i].t, t, 0);
        assert_float_equal(hits[i].u, 0, 0);
        assert_float_equal(hits[i].v, 0, 0);
    }
    unlink("hits.bin");
}

static void test_repeat_prints_times(void** state)
{
    (void)state;
    assert_int_equal(run_shell("%s scene.lspace --rays rays.bin -o hits.bin --repeat 4 --quiet"),
                     LS_EXIT_OK);
    double median, least, most, speed;
    int repeats;
    assert_int_equal(sscanf(output,
                            "GPU time: median %lf ms, min %lf ms, max %lf ms of %d; %lf Mrays/s",
                            &median, &least, &most, &repeats, &speed),
                     5);
    assert_int_equal(repeats, 4);
    assert_true(0 < least && least <= median && median <= most);
    assert_true(fabs(speed - RAY_COUNT / median * 1e-3) <=
                0.01 + 0.01 * speed); // both were rounded for print
    assert_string_equal(strchr(output, '\n'), "\n");
    unlink("hits.bin");
}

static void test_output_keeps_its_place(void** state)
{
    (void)state;
    // A link stays a link, and what it names is replaced; the new file has the mode of a new file.
    assert_int_equal(symlink("folder/target.bin", "link.bin"), 0);
    write_bytes("folder/target.bin", "old", 3);
    assert_int_equal(run_shell("umask 027; %s scene.lspace --rays rays.bin -o link.bin"),
                     LS_EXIT_OK);
    struct stat status;
    assert_int_equal(lstat("link.bin", &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(stat("link.bin", &status), 0);
    assert_int_equal(status.st_size, RAY_COUNT * sizeof(LsHit));
    assert_int_equal(status.st_mode & 0777, 0640);
    unlink("link.bin");
    unlink("folder/target.bin");
    // Devices are written to, not replaced.
    assert_int_equal(run_shell("%s scene.lspace --rays rays.bin -o /dev/null"), LS_EXIT_OK);
    assert_int_equal(stat("/dev/null", &status), 0);
    assert_true(S_ISCHR(status.st_mode));
}

// A summary that cannot be printed is an error; the hits are whole by then.
static void test_full_standard_output(void** state)
{
    (void)state;
    assert_int_equal(run_shell("%s scene.lspace --rays rays.bin -o hits.bin >/dev/full"),
                     LS_EXIT_OUTPUT);
    assert_string_equal(errors, "lstrace: error 4004: standard output cannot be written; "
                                "is the disk full?\n");
    LsHit hits[RAY_COUNT];
    assert_int_equal(read_bytes("hits.bin", hits, sizeof(hits)), sizeof(hits));
    unlink("hits.bin");
}

// ---- What it refuses ---------------------------------------------------------------------------

// One line on standard error with the message's number that names `named`, nothing on standard output, no file left behind,
// and the older output as it was.
static void check_refused(const char* format, LsMessage message, const char* named)
{
    char start[32];
    snprintf(start, sizeof(start), "lstrace: error %d: ", (int)message);
    write_bytes("hits.bin", "older", 5);
    int files = count_files();
    assert_int_equal(run_shell(format), ls_result_exit_code((LsResult)(message / 100)));
    assert_string_equal(output, "");
    if (!strstr(errors, named) || strncmp(errors, start, strlen(start)) != 0 ||
        strchr(errors, '\n') != errors + strlen(errors) - 1)
    {
        fail_msg("%s\nsaid: %s", format, errors);
    }
    assert_int_equal(count_files(), files);
    char kept[6];
    read_text("hits.bin", kept, sizeof(kept));
    assert_string_equal(kept, "older");
}

static void test_wrong_usage(void** state)
{
    (void)state;
    static const struct
    {
        LsMessage message;
        const char* command;
        const char* named;
    } CASES[] = {
        {LS_MESSAGE_LSTRACE_FILES, "%s", ".lspace"},
        {LS_MESSAGE_LSTRACE_FILES, "%s scene.lspace", "--rays"},
        {LS_MESSAGE_LSTRACE_FILES, "%s scene.lspace --rays rays.bin", "-o"},
        {LS_MESSAGE_LSTRACE_FILES, "%s --rays rays.bin -o hits.bin", ".lspace"},
        {LS_MESSAGE_LSTRACE_FILES, "%s scene.lspace scene.lspace --rays rays.bin -o hits.bin",
         ".lspace"},
        {LS_MESSAGE_LSTRACE_VALUE, "%s scene.lspace --rays rays.bin -o hits.bin --method fast",
         "fast"},
        {LS_MESSAGE_LSTRACE_VALUE, "%s scene.lspace --rays rays.bin -o hits.bin --repeat 0",
         "--repeat"},
        {LS_MESSAGE_LSTRACE_VALUE, "%s scene.lspace --rays rays.bin -o hits.bin --repeat 1001",
         "--repeat"},
        {LS_MESSAGE_LSTRACE_VALUE, "%s scene.lspace --rays rays.bin -o hits.bin --repeat -1",
         "--repeat"},
        {LS_MESSAGE_LSTRACE_VALUE, "%s scene.lspace --rays rays.bin -o hits.bin --batch 3x", "3x"},
        {LS_MESSAGE_LSTRACE_VALUE,
         "%s scene.lspace --rays rays.bin -o hits.bin --batch 99999999999999999999", "--batch"},
        {LS_MESSAGE_LSTRACE_OPTION, "%s scene.lspace --rays rays.bin -o hits.bin --fast", "--fast"},
        {LS_MESSAGE_LSTRACE_OPTION, "%s scene.lspace --rays rays.bin -o hits.bin -x", "-x"},
        {LS_MESSAGE_LSTRACE_OPTION, "%s scene.lspace --rays rays.bin -o", "missing after -o"},
        {LS_MESSAGE_LSTRACE_REPLACES, "%s scene.lspace --rays rays.bin -o scene.lspace",
         "scene.lspace"},
        {LS_MESSAGE_LSTRACE_REPLACES, "%s scene.lspace --rays hits.bin -o ./hits.bin",
         "./hits.bin"},
    };
    for (size_t i = 0; i < sizeof(CASES) / sizeof(CASES[0]); i++)
    {
        check_refused(CASES[i].command, CASES[i].message, CASES[i].named);
    }
}

static void test_wrong_rays(void** state)
{
    (void)state;
    const char* const odd = "7 bytes after the last whole ray (32 bytes each, 1000 whole)";
    check_refused("%s scene.lspace --rays odd.bin -o hits.bin", LS_MESSAGE_RAYS_CUT, odd);
    check_refused("%s scene.lspace --rays odd.bin -o hits.bin", LS_MESSAGE_RAYS_CUT, "odd.bin: ");
    check_refused("%s scene.lspace --rays - -o hits.bin --batch 100 < odd.bin", LS_MESSAGE_RAYS_CUT,
                  odd);
    check_refused("cat odd.bin | %s scene.lspace --rays - -o hits.bin", LS_MESSAGE_RAYS_CUT,
                  "standard input: ");
    check_refused("%s scene.lspace --rays nowhere.bin -o hits.bin", LS_MESSAGE_FILE_MISSING,
                  "nowhere.bin");
    check_refused("%s scene.lspace --rays empty.bin -o hits.bin", LS_MESSAGE_FILE_EMPTY,
                  "empty.bin: is empty");
    check_refused("%s scene.lspace --rays - -o hits.bin < empty.bin", LS_MESSAGE_FILE_EMPTY,
                  "standard input: is empty");
    check_refused("%s scene.lspace --rays folder -o hits.bin", LS_MESSAGE_FILE_IS_FOLDER,
                  "folder: is a directory");
}

static void test_wrong_scenes(void** state)
{
    (void)state;
    check_refused("%s nowhere.lspace --rays rays.bin -o hits.bin", LS_MESSAGE_FILE_MISSING,
                  "nowhere.lspace");
    check_refused("%s folder --rays rays.bin -o hits.bin", LS_MESSAGE_FILE_IS_FOLDER, "folder");
    check_refused("%s empty.bin --rays rays.bin -o hits.bin", LS_MESSAGE_FILE_EMPTY, "empty.bin");
    check_refused("%s foreign.lspace --rays rays.bin -o hits.bin", LS_MESSAGE_LSPACE_FOREIGN,
                  "foreign.lspace");
    check_refused("%s cut.lspace --rays rays.bin -o hits.bin", LS_MESSAGE_LSPACE_CUT, "cut.lspace");
}

static void test_wrong_outputs(void** state)
{
    (void)state;
    check_refused("%s scene.lspace --rays rays.bin -o folder", LS_MESSAGE_OUTPUT_IS_FOLDER,
                  "folder: is a directory");
    check_refused("%s scene.lspace --rays rays.bin -o nowhere/hits.bin",
                  LS_MESSAGE_OUTPUT_UNWRITABLE, "nowhere/hits.bin");
    check_refused("%s scene.lspace --rays rays.bin -o ''", LS_MESSAGE_OUTPUT_UNWRITABLE,
                  "cannot be written");
    check_refused("%s scene.lspace --rays rays.bin -o /dev/full", LS_MESSAGE_OUTPUT_FULL,
                  "/dev/full: no space left");
    // A file that may not grow so far: the same error in the middle of the work.
    check_refused(
        "trap '' XFSZ; ulimit -f 20; %s scene.lspace --rays rays.bin -o hits.bin --batch 500",
        LS_MESSAGE_OUTPUT_FULL, "hits.bin: no space left");
}

static void test_no_device(void** state)
{
    (void)state;
    check_refused("VK_DRIVER_FILES=/nowhere.json VK_ICD_FILENAMES=/nowhere.json "
                  "%s scene.lspace --rays rays.bin -o hits.bin",
                  LS_MESSAGE_VULKAN_DRIVER,
                  "no Vulkan driver was found: install mesa-vulkan-drivers");
    check_refused("LS_VALIDATION=1 VK_LAYER_PATH=/nowhere "
                  "%s scene.lspace --rays rays.bin -o hits.bin",
                  LS_MESSAGE_VULKAN_LAYER, "install vulkan-validationlayers");
    check_refused("%s scene.lspace --rays rays.bin -o hits.bin --device 'no such GPU'",
                  LS_MESSAGE_DEVICE_NAME, "\"no such GPU\"; there are: ");
}

int main(int argc, char** argv)
{
    if (argc != 2 || !realpath(argv[1], program))
    {
        fprintf(stderr, "usage: test_lstrace PROGRAM\n");
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_help_and_version),
        cmocka_unit_test(test_hits),
        cmocka_unit_test(test_streaming),
        cmocka_unit_test(test_any_hit),
        cmocka_unit_test(test_repeat_prints_times),
        cmocka_unit_test(test_output_keeps_its_place),
        cmocka_unit_test(test_full_standard_output),
        cmocka_unit_test(test_wrong_usage),
        cmocka_unit_test(test_wrong_rays),
        cmocka_unit_test(test_wrong_scenes),
        cmocka_unit_test(test_wrong_outputs),
        cmocka_unit_test(test_no_device),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
