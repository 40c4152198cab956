// lsbench.c - times camera, shadow and diffuse rays in the Cornell box, and checks the answers.

#include "app_scene.h"
#include "app_trace.h"
#include "box_rays.h"
#include "embree_rays.h"
#include "ls_messages.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
    "Usage: lsbench FILE.lspace [OPTION]...\n"
    "Times rays through a model in the Cornell box (scenes/cornell.gltf with a model on its "
    "floor):\n"
    "one camera ray a pixel, from each hit one shadow and one diffuse ray.\n"
    "\n"
    "  --size WxH     pixels, so rays of each class: 1280x720\n"
    "  --repeat N     timed runs of each class, after one that is not timed: 21\n"
    "  --check N      compare the answers of N rays of each class, spread over all, with brute "
    "force\n"
    "                 on the same device: 20000; 0 compares none\n"
    "  --method M     exact (default), or grid: the same cells without shafts, the same answers\n"
    "  --passes N     2: lists of triangles first, then the grid; 1: all in one kernel (default: "
    "2,\n"
    "                 but on CPUs)\n"
    "  --embree N     trace the same rays by Embree too, on N threads, fast mode, one at a time\n"
    "  --device NAME  the device whose name contains NAME, not the fastest kind\n"
    "  --help, --version\n"
    "\n"
    "Times are the GPU's own. Shadow rays ask for any hit, the others for the closest. Cells (or\n"
    "empty cubes) walked with boxes of BVHs in them, shafts looked up and triangles tested are\n"
    "counted by exact tracing, by a ray on average.\n"
    "\n"
    "Exit codes: 0 done, 1 wrong usage, 2 missing file, 4 bad .lspace file, 5 no device, a "
    "failing\n"
    "one, or one whose answers differ from brute force, 6 out of memory.\n";

enum
{
    MAX_SIDE = 16384,
    MAX_REPEATS = 1000,
};

typedef struct Options
{
    const char* scene_path;
    const char* device_name;
    uint32_t width, height;
    uint32_t repeats;
    uint32_t checks;
    LsMethod method;
    LsAppPasses passes;
    uint32_t embree_threads; // 0: without
} Options;

// What one class of rays took, and how its answers compare.
typedef struct Row
{
    double seconds[MAX_REPEATS]; // rising
    double median_seconds;
    uint32_t ray_count;
    uint32_t hit_count;
    uint32_t checked_count;
    uint32_t differing_count;
    double embree_median_seconds;
    uint32_t embree_hit_count;
    double cells, shafts, tests; // walked, looked up, tested by a ray on average
} Row;

typedef struct Bench
{
    LsAppScene scene;
    LsAppTracer tracer;
    LsRay* rays[LS_RAY_CLASS_COUNT];
    LsHit* hits; // of the class at hand
    Row rows[LS_RAY_CLASS_COUNT];
} Bench;

// ---- Arguments ---------------------------------------------------------------------------------

static LsExit report(const LsError* error)
{
    fprintf(stderr, "lsbench: error %u: %s\n", error->message, error->text);
    return ls_result_exit_code(error->result);
}

static LsExit refuse_usage(LsMessage message, const char* problem, const char* argument)
{
    LsError error;
    ls_error_set(&error, message, "%s%s; see lsbench --help", problem, argument);
    return report(&error);
}

// A number up to `largest` that ends at `end`.
static bool parse_number(const char* text, char end, uint32_t largest, uint32_t* number,
                         const char** rest)
{
    char* stop;
    errno = 0;
    const unsigned long value = strtoul(text, &stop, 10);
    *number = (uint32_t)value;
    *rest = stop + (*stop != '\0');
    return text[0] >= '0' && text[0] <= '9' && errno == 0 && value <= largest && *stop == end;
}

// Sets *done when there is nothing left to do: help was asked for, or the exit code is not
// LS_EXIT_OK.
static LsExit parse_options(int argc, char** argv, Options* options, bool* done)
{
    enum
    {
        SIZE = 256,
        REPEAT,
        CHECK,
        METHOD,
        PASSES,
        EMBREE,
        DEVICE,
        HELP_WANTED,
        VERSION
    };
    static const struct option names[] = {
        {"size", required_argument, NULL, SIZE},     {"repeat", required_argument, NULL, REPEAT},
        {"check", required_argument, NULL, CHECK},   {"method", required_argument, NULL, METHOD},
        {"passes", required_argument, NULL, PASSES}, {"embree", required_argument, NULL, EMBREE},
        {"device", required_argument, NULL, DEVICE}, {"help", no_argument, NULL, HELP_WANTED},
        {"version", no_argument, NULL, VERSION},     {NULL, 0, NULL, 0},
    };
    *options = (Options){.width = 1280, .height = 720, .repeats = 21, .checks = 20000};
    *done = true;
    const char* rest;
    for (int option; (option = getopt_long(argc, argv, ":", names, NULL)) != -1;)
    {
        switch (option)
        {
        case SIZE:
            if (!parse_number(optarg, 'x', MAX_SIDE, &options->width, &rest) ||
                !parse_number(rest, '\0', MAX_SIDE, &options->height, &rest) ||
                options->width == 0 || options->height == 0)
            {
                return refuse_usage(LS_MESSAGE_LSBENCH_VALUE, "--size takes WIDTHxHEIGHT, not ",
                                    optarg);
            }
            break;
        case REPEAT:
            if (!parse_number(optarg, '\0', MAX_REPEATS, &options->repeats, &rest) ||
                options->repeats == 0)
            {
                return refuse_usage(LS_MESSAGE_LSBENCH_VALUE,
                                    "--repeat takes a number from 1 to 1000, not ", optarg);
            }
            break;
        case CHECK:
            if (!parse_number(optarg, '\0', UINT32_MAX, &options->checks, &rest))
            {
                return refuse_usage(LS_MESSAGE_LSBENCH_VALUE, "--check takes a number, not ",
                                    optarg);
            }
            break;
        case METHOD:
            if (strcmp(optarg, "exact") != 0 && strcmp(optarg, "grid") != 0)
            {
                return refuse_usage(LS_MESSAGE_LSBENCH_VALUE, "--method takes exact or grid, not ",
                                    optarg);
            }
            options->method = optarg[0] == 'g' ? LS_TRACE_GRID : LS_TRACE_EXACT;
            break;
        case PASSES:
            if (strcmp(optarg, "1") != 0 && strcmp(optarg, "2") != 0)
            {
                return refuse_usage(LS_MESSAGE_LSBENCH_VALUE, "--passes takes 1 or 2, not ",
                                    optarg);
            }
            options->passes = optarg[0] == '1' ? LS_APP_ONE_PASS : LS_APP_TWO_PASSES;
            break;
        case EMBREE:
            if (!parse_number(optarg, '\0', 1024, &options->embree_threads, &rest) ||
                options->embree_threads == 0)
            {
                return refuse_usage(LS_MESSAGE_LSBENCH_VALUE,
                                    "--embree takes a number of threads from 1 to 1024, not ",
                                    optarg);
            }
            if (!ls_embree_rays_are_built())
            {
                return refuse_usage(LS_MESSAGE_LSBENCH_VALUE,
                                    "--embree needs an lsbench that was built with Embree", "");
            }
            break;
        case DEVICE:
            options->device_name = optarg;
            break;
        case HELP_WANTED:
            fputs(HELP, stdout);
            return LS_EXIT_OK;
        case VERSION:
            puts("lsbench " LS_VERSION_TEXT);
            return LS_EXIT_OK;
        case ':':
            return refuse_usage(LS_MESSAGE_LSBENCH_OPTION, "a value is missing after ",
                                argv[optind - 1]);
        default:
            return refuse_usage(LS_MESSAGE_LSBENCH_OPTION, "unknown option ", argv[optind - 1]);
        }
    }
    if (argc - optind != 1)
    {
        return refuse_usage(LS_MESSAGE_LSBENCH_FILES, "one .lspace file is wanted", "");
    }
    options->scene_path = argv[optind];
    *done = false;
    return LS_EXIT_OK;
}

// ---- Runs --------------------------------------------------------------------------------------

static int compare_doubles(const void* a, const void* b)
{
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

// Sorts the times of all runs.
static double find_median(double* seconds, uint32_t count)
{
    qsort(seconds, count, sizeof *seconds, compare_doubles);
    return 0.5 * (seconds[(count - 1) / 2] + seconds[count / 2]);
}

static LsResult open_bench(Bench* bench, const Options* options, LsError* error)
{
    LsResult result =
        ls_app_scene_open(&bench->scene, options->scene_path, options->device_name, true, error);
    const uint32_t count = options->width * options->height;
    bench->hits = malloc(count * sizeof *bench->hits);
    bool is_memory = bench->hits != NULL;
    for (int class = 0; class < LS_RAY_CLASS_COUNT; class ++)
    {
        bench->rays[class] = malloc(count * sizeof(LsRay));
        is_memory = is_memory && bench->rays[class] != NULL;
    }
    if (result == LS_OK && !is_memory)
    {
        result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for %u rays", count);
    }
    return result == LS_OK
               ? ls_app_tracer_create(&bench->scene.device, count, &bench->tracer, error)
               : result;
}

static void close_bench(Bench* bench)
{
    ls_app_tracer_destroy(&bench->scene.device, &bench->tracer);
    ls_app_scene_close(&bench->scene);
    for (int class = 0; class < LS_RAY_CLASS_COUNT; class ++)
    {
        free(bench->rays[class]);
    }
    free(bench->hits);
}

static LsResult time_class(Bench* bench, LsRayClass class, const Options* options, LsError* error)
{
    Row* row = &bench->rows[class];
    row->ray_count = options->width * options->height;
    memcpy(bench->tracer.rays, bench->rays[class], row->ray_count * sizeof(LsRay));
    const LsAppRun run = {.ray_count = row->ray_count,
                          .flags = class == LS_SHADOW_RAYS ? LS_RAY_FLAG_ANY_HIT : 0,
                          .method = options->method,
                          .passes = options->passes};
    LsResult result = LS_OK;
    double seconds = 0.0;
    for (uint32_t i = 0; i <= options->repeats && result == LS_OK; i++)
    {
        result = ls_app_tracer_run(&bench->scene.device, &bench->tracer, bench->scene.scene, &run,
                                   &seconds, error);
        row->seconds[i == 0 ? 0 : i - 1] = seconds; // the first is overwritten
    }
    if (result == LS_OK)
    {
        row->median_seconds = find_median(row->seconds, options->repeats);
        memcpy(bench->hits, bench->tracer.hits, row->ray_count * sizeof(LsHit));
        for (uint32_t i = 0; i < row->ray_count; i++)
        {
            row->hit_count += bench->hits[i].instance != LS_NONE;
        }
    }
    return result;
}

// Of any-hit rays only whether there is a hit can be compared.
static bool is_same(const LsHit* a, const LsHit* b, LsRayClass class)
{
    return class == LS_SHADOW_RAYS ? (a->instance == LS_NONE) == (b->instance == LS_NONE)
                                   : memcmp(a, b, sizeof *a) == 0;
}

static LsResult check_class(Bench* bench, LsRayClass class, const Options* options, LsError* error)
{
    Row* row = &bench->rows[class];
    row->checked_count = options->checks < row->ray_count ? options->checks : row->ray_count;
    if (row->checked_count == 0)
    {
        return LS_OK;
    }
    const uint32_t stride = row->ray_count / row->checked_count;
    for (uint32_t i = 0; i < row->checked_count; i++)
    {
        bench->tracer.rays[i] = bench->rays[class][(size_t)i * stride];
    }
    const LsAppRun run = {.ray_count = row->checked_count,
                          .flags = class == LS_SHADOW_RAYS ? LS_RAY_FLAG_ANY_HIT : 0,
                          .method = LS_TRACE_BRUTE};
    const LsResult result = ls_app_tracer_run(&bench->scene.device, &bench->tracer,
                                              bench->scene.scene, &run, NULL, error);
    for (uint32_t i = 0; i < row->checked_count && result == LS_OK; i++)
    {
        row->differing_count +=
            !is_same(&bench->tracer.hits[i], &bench->hits[(size_t)i * stride], class);
    }
    return result;
}

// What the rays of a class have to do. Rays of any hit stop at their first.
static LsResult count_work(Bench* bench, LsRayClass class, LsError* error)
{
    Row* row = &bench->rows[class];
    memcpy(bench->tracer.rays, bench->rays[class], row->ray_count * sizeof(LsRay));
    const LsAppRun run = {.ray_count = row->ray_count,
                          .flags = class == LS_SHADOW_RAYS ? LS_RAY_FLAG_ANY_HIT : 0,
                          .method = LS_TRACE_COUNT};
    const LsResult result = ls_app_tracer_run(&bench->scene.device, &bench->tracer,
                                              bench->scene.scene, &run, NULL, error);
    for (uint32_t i = 0; i < row->ray_count && result == LS_OK; i++)
    {
        const LsHit* work = &bench->tracer.hits[i];
        row->cells += (double)work->instance / row->ray_count;
        row->shafts += (double)work->object / row->ray_count;
        row->tests += (double)work->primitive / row->ray_count;
    }
    return result;
}

// As often as the device's runs are timed, after one that is not.
static LsResult time_embree(Bench* bench, const Options* options, LsError* error)
{
    LsEmbreeRays* embree = ls_embree_rays_create(&bench->scene.file, options->embree_threads);
    if (embree == NULL)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for Embree");
    }
    for (int class = 0; class < LS_RAY_CLASS_COUNT; class ++)
    {
        Row* row = &bench->rows[class];
        static double seconds[MAX_REPEATS];
        for (uint32_t i = 0; i <= options->repeats; i++)
        {
            seconds[i == 0 ? 0 : i - 1] =
                ls_embree_rays_trace(embree, bench->rays[class], row->ray_count,
                                     class == LS_SHADOW_RAYS, &row->embree_hit_count);
        }
        row->embree_median_seconds = find_median(seconds, options->repeats);
    }
    ls_embree_rays_destroy(embree);
    return LS_OK;
}

static LsResult run_bench(Bench* bench, const Options* options, LsError* error)
{
    LsResult result = open_bench(bench, options, error);
    if (result != LS_OK)
    {
        return result;
    }
    ls_box_camera_rays(bench->rays[LS_CAMERA_RAYS], options->width, options->height);
    for (int class = 0; class < LS_RAY_CLASS_COUNT && result == LS_OK; class ++)
    {
        result = time_class(bench, class, options, error);
        if (result == LS_OK && class == LS_CAMERA_RAYS &&
            !ls_box_second_rays(&bench->scene.file, bench->rays[LS_CAMERA_RAYS], bench->hits,
                                bench->rows[class].ray_count, bench->rays[LS_SHADOW_RAYS],
                                bench->rays[LS_DIFFUSE_RAYS]))
        {
            result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for rays");
        }
        result = result == LS_OK ? check_class(bench, class, options, error) : result;
        result = result == LS_OK ? count_work(bench, class, error) : result;
    }
    if (result == LS_OK && options->embree_threads != 0)
    {
        result = time_embree(bench, options, error);
    }
    return result;
}

// ---- Report ------------------------------------------------------------------------------------

// Returns how many answers differ.
static uint32_t print_report(const Bench* bench, const Options* options)
{
    const LsAppScene* scene = &bench->scene;
    printf("%s: file %.1f MB, on the device %.1f MB; %s\n", options->scene_path,
           (double)scene->file.size * 1e-6, (double)ls_scene_device_bytes(scene->scene) * 1e-6,
           scene->device.name);
    if (scene->device.timestamp_seconds == 0)
    {
        puts("the device has no timestamps: no times");
    }
    printf("%-8s %9s %7s %11s %9s %9s %9s %7s %7s %7s   %s\n", "rays", "count", "hits", "Mrays/s",
           "median ms", "min ms", "max ms", "cells", "shafts", "tests",
           "differing from brute force");
    uint32_t differing = 0;
    for (int class = 0; class < LS_RAY_CLASS_COUNT; class ++)
    {
        const Row* row = &bench->rows[class];
        const uint32_t n = options->repeats;
        printf("%-8s %9u %5.1f %% %11.2f %9.3f %9.3f %9.3f %7.2f %7.2f %7.2f   %u of %u\n",
               ls_ray_class_name((LsRayClass) class), row->ray_count,
               100.0 * row->hit_count / row->ray_count, row->ray_count / row->median_seconds * 1e-6,
               row->median_seconds * 1e3, row->seconds[0] * 1e3, row->seconds[n - 1] * 1e3,
               row->cells, row->shafts, row->tests, row->differing_count, row->checked_count);
        differing += row->differing_count;
    }
    for (int class = 0; class < LS_RAY_CLASS_COUNT && options->embree_threads != 0; class ++)
    {
        const Row* row = &bench->rows[class];
        printf("embree   %-8s %u threads: %.1f %% hits, %.2f Mrays/s\n",
               ls_ray_class_name((LsRayClass) class), options->embree_threads,
               100.0 * row->embree_hit_count / row->ray_count,
               row->ray_count / row->embree_median_seconds * 1e-6);
    }
    return differing;
}

int main(int argc, char** argv)
{
    static Bench bench;
    Options options;
    bool done;
    LsExit code = parse_options(argc, argv, &options, &done);
    LsError error;
    if (!done)
    {
        LsResult result = run_bench(&bench, &options, &error);
        const uint32_t differing = result == LS_OK ? print_report(&bench, &options) : 0;
        if (differing > 0)
        {
            result = ls_error_set(&error, LS_MESSAGE_ANSWERS_DIFFER,
                                  "%s: %u answers differ from brute force; lsinfo check --full "
                                  "tells whether the file is damaged",
                                  options.scene_path, differing);
        }
        code = result == LS_OK ? LS_EXIT_OK : report(&error);
        close_bench(&bench);
    }
    if (code == LS_EXIT_OK && (fflush(stdout) != 0 || ferror(stdout)))
    {
        ls_error_set(&error, LS_MESSAGE_OUTPUT_STANDARD,
                     "standard output cannot be written; is the disk full?");
        code = report(&error);
    }
    return code;
}
