// lsview - renders an .lspace file; so far without a window.

#include "app_scene.h"
#include "image.h"
#include "ls_write.h"
#include "render.h"

#include <cjson/cJSON.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define DEFAULT_WIDTH 640
#define DEFAULT_HEIGHT 360
#define DEFAULT_SAMPLES 32
#define DEFAULT_DEPTH 5
#define MAX_SAMPLES 10000000

static const char HELP[] =
    "usage: lsview --headless FILE.lspace -o OUT.png [options]\n"
    "\n"
    "Path traces the scene in FILE.lspace and writes a picture.\n"
    "\n"
    "  --headless       render to files, without a window (a window comes in a later version)\n"
    "  -o, --output F   PNG to write: 8 bits, sRGB, clipped to [0,1]\n"
    "  --exr F          also write linear floats as EXR\n"
    "  --size WxH       pixels (default 640x360)\n"
    "  --samples N      paths per pixel (default 32)\n"
    "  --depth N        segments of a path: 1 sees lights alone, 2 direct light (default 5)\n"
    "  --seed N         seed of the random numbers (default 0)\n"
    "  --device NAME    part of the name of the Vulkan device to use (default: the best)\n"
    "  --report json    print the closing table as JSON on standard output\n"
    "  --quiet          no progress bar, no table\n"
    "  --help, --version\n"
    "\n"
    "Exit codes: 0 done, 1 usage, 3 output, 4 .lspace file, 2 its reading, 5 device, 6 memory.\n";

typedef struct Options
{
    const char* input;
    const char* png;
    const char* exr; // NULL: none
    const char* device_name;
    uint32_t width, height, samples, depth, seed;
    bool headless, quiet, json;
    bool done; // --help or --version was answered
} Options;

typedef struct Report
{
    double startup_seconds; // from main to the first traced frame, that frame included
    double render_seconds;  // all frames, without reading back and writing
    uint64_t scene_bytes;   // on the device
    LsRenderStats stats;
} Report;

// What the progress callback needs.
typedef struct Progress
{
    double program_begin;
    double startup_seconds; // 0 before the first frame
    uint32_t samples;
    bool bar;
} Progress;

static double now_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Reads a whole decimal number in [low, high]; false if `text` is anything else.
static bool read_number(const char* text, const char* stop, uint32_t low, uint32_t high,
                        uint32_t* number)
{
    uint64_t value = 0;
    if (text == stop)
    {
        return false;
    }
    for (; text != stop; text++)
    {
        if (*text < '0' || *text > '9')
        {
            return false;
        }
        value = 10 * value + (uint64_t)(*text - '0');
        if (value > high)
        {
            return false;
        }
    }
    *number = (uint32_t)value;
    return value >= low;
}

static bool read_size(const char* text, uint32_t* width, uint32_t* height)
{
    const char* cross = strchr(text, 'x');
    return cross && read_number(text, cross, 1, LS_RENDER_MAX_SIDE, width) &&
           read_number(cross + 1, text + strlen(text), 1, LS_RENDER_MAX_SIDE, height);
}

static bool read_whole(const char* text, uint32_t low, uint32_t high, uint32_t* number)
{
    return read_number(text, text + strlen(text), low, high, number);
}

// Fills `options`; false with one line in `error` on wrong usage.
static bool parse_options(int argc, char** argv, Options* options, LsError* error)
{
    enum
    {
        OPTION_HEADLESS = 256,
        OPTION_EXR,
        OPTION_SIZE,
        OPTION_SAMPLES,
        OPTION_DEPTH,
        OPTION_SEED,
        OPTION_DEVICE,
        OPTION_REPORT,
        OPTION_QUIET,
        OPTION_HELP,
        OPTION_VERSION,
    };
    static const struct option list[] = {
        {"headless", no_argument, NULL, OPTION_HEADLESS},
        {"output", required_argument, NULL, 'o'},
        {"exr", required_argument, NULL, OPTION_EXR},
        {"size", required_argument, NULL, OPTION_SIZE},
        {"samples", required_argument, NULL, OPTION_SAMPLES},
        {"depth", required_argument, NULL, OPTION_DEPTH},
        {"seed", required_argument, NULL, OPTION_SEED},
        {"device", required_argument, NULL, OPTION_DEVICE},
        {"report", required_argument, NULL, OPTION_REPORT},
        {"quiet", no_argument, NULL, OPTION_QUIET},
        {"help", no_argument, NULL, OPTION_HELP},
        {"version", no_argument, NULL, OPTION_VERSION},
        {NULL, 0, NULL, 0},
    };
    *options = (Options){
        .width = DEFAULT_WIDTH,
        .height = DEFAULT_HEIGHT,
        .samples = DEFAULT_SAMPLES,
        .depth = DEFAULT_DEPTH,
    };

    opterr = 0;
    int option;
    while ((option = getopt_long(argc, argv, ":o:", list, NULL)) != -1)
    {
        bool good = true;
        switch (option)
        {
        case OPTION_HEADLESS:
            options->headless = true;
            break;
        case 'o':
            options->png = optarg;
            break;
        case OPTION_EXR:
            options->exr = optarg;
            break;
        case OPTION_SIZE:
            good = read_size(optarg, &options->width, &options->height);
            break;
        case OPTION_SAMPLES:
            good = read_whole(optarg, 1, MAX_SAMPLES, &options->samples);
            break;
        case OPTION_DEPTH:
            good = read_whole(optarg, 1, LS_RENDER_MAX_DEPTH, &options->depth);
            break;
        case OPTION_SEED:
            good = read_whole(optarg, 0, UINT32_MAX, &options->seed);
            break;
        case OPTION_DEVICE:
            options->device_name = optarg;
            break;
        case OPTION_REPORT:
            options->json = true;
            good = strcmp(optarg, "json") == 0;
            break;
        case OPTION_QUIET:
            options->quiet = true;
            break;
        case OPTION_HELP:
            fputs(HELP, stdout);
            options->done = true;
            return true;
        case OPTION_VERSION:
            puts("lsview " LS_VERSION_TEXT);
            options->done = true;
            return true;
        case ':':
            ls_error_set(error, LS_MESSAGE_LSVIEW_OPTION,
                         "%s needs a value; lsview --help shows the options", argv[optind - 1]);
            return false;
        default:
            ls_error_set(error, LS_MESSAGE_LSVIEW_OPTION,
                         "unknown option %s; lsview --help shows the options", argv[optind - 1]);
            return false;
        }
        if (!good)
        {
            ls_error_set(error, LS_MESSAGE_LSVIEW_VALUE,
                         "'%s' is out of range or malformed; lsview --help shows the options",
                         optarg);
            return false;
        }
    }

    const char* complaint = NULL;
    LsMessage message = LS_MESSAGE_LSVIEW_FILES;
    if (optind + 1 != argc)
    {
        complaint = "give one .lspace file; lsview --help shows the options";
    }
    else if (!options->headless)
    {
        message = LS_MESSAGE_LSVIEW_WINDOW;
        complaint = "a window comes in a later version; use --headless FILE.lspace -o OUT.png";
    }
    else if (!options->png)
    {
        complaint = "say with -o OUT.png where the picture goes";
    }
    else if (options->exr && (strcmp(options->exr, options->png) == 0 ||
                              ls_path_is_same(options->exr, options->png)))
    {
        message = LS_MESSAGE_LSVIEW_REPLACES;
        complaint = "-o and --exr name the same file; choose another name for one";
    }
    if (complaint)
    {
        ls_error_set(error, message, "%s", complaint);
        return false;
    }
    options->input = argv[optind];
    return true;
}

static void show_progress(void* user, const LsRender* render)
{
    Progress* progress = user;
    if (progress->startup_seconds == 0.0)
    {
        progress->startup_seconds = now_seconds() - progress->program_begin;
    }
    if (progress->bar)
    {
        enum
        {
            WIDTH = 40
        };
        uint32_t done = ls_render_stats(render).sample_count;
        int filled = (int)((uint64_t)done * WIDTH / progress->samples);
        fprintf(stderr, "\rrender [%.*s%*s] %u/%u", filled,
                "########################################", WIDTH - filled, "", done,
                progress->samples);
        fflush(stderr);
    }
}

static LsResult write_pictures(LsRender* render, const Options* options, LsError* error)
{
    float* rgba = malloc((size_t)options->width * options->height * sizeof(LsVec4));
    if (!rgba)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "no memory for a picture of %ux%u",
                            options->width, options->height);
    }
    LsResult result = ls_render_read(render, rgba, error);
    if (result == LS_OK && options->exr)
    {
        result = ls_image_write_exr(rgba, options->width, options->height, options->exr, error);
    }
    if (result == LS_OK)
    {
        result = ls_image_write_png(rgba, options->width, options->height, options->png, error);
    }
    free(rgba);
    return result;
}

static LsResult render_scene(const LsAppDevice* device, const LsScene* scene, const LsFile* file,
                             const Options* options, double program_begin, Report* report,
                             LsError* error)
{
    LsRender* render;
    LsResult result = ls_render_create(device, scene, file, &render, error);
    if (result != LS_OK)
    {
        return result;
    }
    LsRenderSettings settings = {
        .camera = ls_render_camera(file, (double)options->width / options->height),
        .width = options->width,
        .height = options->height,
        .depth = options->depth,
        .seed = options->seed,
    };
    result = ls_render_set(render, &settings, NULL, error);
    if (result == LS_OK)
    {
        Progress progress = {
            .program_begin = program_begin,
            .samples = options->samples,
            .bar = !options->quiet && isatty(STDERR_FILENO),
        };
        double begin = now_seconds();
        result = ls_render_run(render, options->samples, show_progress, &progress, error);
        report->render_seconds = now_seconds() - begin;
        report->startup_seconds = progress.startup_seconds;
        report->stats = ls_render_stats(render);
        if (progress.bar)
        {
            fprintf(stderr, "\r\033[K");
        }
    }
    if (result == LS_OK)
    {
        result = write_pictures(render, options, error);
    }
    ls_render_destroy(render);
    return result;
}

static void print_table(const LsAppDevice* device, const Options* options, const Report* report)
{
    double samples = (double)options->width * options->height * report->stats.sample_count;
    printf("picture        %s\n", options->png);
    if (options->exr)
    {
        printf("linear         %s\n", options->exr);
    }
    printf("size           %ux%u, %u samples per pixel, paths of %u segments\n", options->width,
           options->height, report->stats.sample_count, options->depth);
    printf("device         %s%s\n", device->name,
           device->is_cpu ? " (the CPU: no GPU was found or chosen)" : "");
    printf("scene          %.1f MB on the device\n", 1e-6 * (double)report->scene_bytes);
    printf("start-up       %.3f s to the first frame\n", report->startup_seconds);
    printf("rendering      %.3f s\n", report->render_seconds);
    printf("samples        %.3f M/s\n", 1e-6 * samples / report->render_seconds);
    printf("rays           %.3f M/s\n",
           1e-6 * (double)report->stats.ray_count / report->render_seconds);
}

static bool print_json(const LsAppDevice* device, const Options* options, const Report* report)
{
    double samples = (double)options->width * options->height * report->stats.sample_count;
    cJSON* root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "picture", options->png);
    if (options->exr)
    {
        cJSON_AddStringToObject(root, "exr", options->exr);
    }
    cJSON_AddStringToObject(root, "device", device->name);
    cJSON_AddBoolToObject(root, "device_is_cpu", device->is_cpu);
    cJSON_AddNumberToObject(root, "width", options->width);
    cJSON_AddNumberToObject(root, "height", options->height);
    cJSON_AddNumberToObject(root, "samples_per_pixel", report->stats.sample_count);
    cJSON_AddNumberToObject(root, "depth", options->depth);
    cJSON_AddNumberToObject(root, "seed", options->seed);
    cJSON_AddNumberToObject(root, "scene_device_bytes", (double)report->scene_bytes);
    cJSON_AddNumberToObject(root, "startup_seconds", report->startup_seconds);
    cJSON_AddNumberToObject(root, "render_seconds", report->render_seconds);
    cJSON_AddNumberToObject(root, "samples_per_second", samples / report->render_seconds);
    cJSON_AddNumberToObject(root, "rays", (double)report->stats.ray_count);
    cJSON_AddNumberToObject(root, "rays_per_second",
                            (double)report->stats.ray_count / report->render_seconds);
    cJSON_AddNumberToObject(root, "invalid_samples", report->stats.invalid_samples);
    char* text = cJSON_Print(root);
    cJSON_Delete(root);
    if (text)
    {
        puts(text);
    }
    free(text);
    return text != NULL;
}

// The scene stays what it is, whatever the pictures are called.
static LsResult check_picture(const char* path, const char* scene_path, LsError* error)
{
    if (ls_path_is_same(path, scene_path))
    {
        return ls_error_set(error, LS_MESSAGE_LSVIEW_REPLACES,
                            "%s: the picture would replace the scene; choose another name", path);
    }
    return ls_output_check(path, error);
}

static LsResult run(const Options* options, double program_begin, LsError* error)
{
    LsResult result = check_picture(options->png, options->input, error);
    if (result == LS_OK && options->exr)
    {
        result = check_picture(options->exr, options->input, error);
    }
    if (result != LS_OK)
    {
        return result;
    }

    LsAppScene scene;
    Report report = {0};
    result = ls_app_scene_open(&scene, options->input, options->device_name, false, error);
    if (result == LS_OK)
    {
        report.scene_bytes = ls_scene_device_bytes(scene.scene);
        result = render_scene(&scene.device, scene.scene, &scene.file, options, program_begin,
                              &report, error);
    }
    if (result == LS_OK && report.stats.invalid_samples > 0)
    {
        fprintf(
            stderr,
            "lsview: warning %d: %s: %u samples were not finite and count as black; its lights are "
            "too bright for float\n",
            (int)LS_MESSAGE_PICTURE_NOT_FINITE, options->input, report.stats.invalid_samples);
    }
    if (result == LS_OK && options->json && !print_json(&scene.device, options, &report))
    {
        result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "no memory for the report");
    }
    else if (result == LS_OK && !options->json && !options->quiet)
    {
        print_table(&scene.device, options, &report);
    }
    ls_app_scene_close(&scene);
    return result;
}

int main(int argc, char** argv)
{
    signal(SIGXFSZ, SIG_IGN); // a limit on the size of files makes writing fail instead
    double program_begin = now_seconds();
    Options options;
    LsError error = {0};
    LsResult result = LS_ERROR_ARGUMENT;
    if (parse_options(argc, argv, &options, &error))
    {
        result = options.done ? LS_OK : run(&options, program_begin, &error);
    }
    if (result == LS_OK && (fflush(stdout) != 0 || ferror(stdout)))
    {
        result = ls_error_set(&error, LS_MESSAGE_OUTPUT_STANDARD,
                              "standard output cannot be written; is the disk full?");
    }
    if (result != LS_OK)
    {
        fprintf(stderr, "lsview: error %u: %s\n", error.message, error.text);
    }
    return (int)ls_result_exit_code(result);
}
