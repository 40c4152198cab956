// lstrace.c - a file of rays in, a file of hits out.

#include "app_scene.h"
#include "app_trace.h"
#include "out_file.h"

#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char HELP[] =
    "Usage: lstrace FILE.lspace --rays RAYS.bin -o HITS.bin [OPTION]...\n"
    "Traces a file of rays through a baked scene into a file of hits.\n"
    "\n"
    "A ray is 8 little-endian floats, 32 bytes: origin, tmin, direction, tmax; in world space,\n"
    "t in units of the direction. A hit is 32 bytes, one per ray in order: floats t, u, v, then\n"
    "unsigned 32-bit numbers instance, object, triangle, material, 0. A miss has t = -1 and the\n"
    "first four numbers 4294967295. Either file may be \"-\", standard input or output.\n"
    "\n"
    "  --rays FILE        rays to trace\n"
    "  -o, --output FILE  hits to write; whole or not at all\n"
    "  --any              any hit will do: t is 0, the numbers are those of some hit\n"
    "  --method METHOD    exact: through the Line Space (default); grid: the same cells without\n"
    "                     shafts; brute: all triangles. The answers are the same\n"
    "  --repeat N         trace N times; print median and spread of the GPU's time\n"
    "  --batch N          rays at a time: 1048576, fewer where memory is short\n"
    "  --device NAME      the device whose name contains NAME, not the fastest kind\n"
    "  --quiet            no progress and no summary\n"
    "  --help, --version\n"
    "\n"
    "Exit codes: 0 done, 1 wrong usage, 2 bad rays or missing file, 3 output failed,\n"
    "4 bad .lspace file, 5 no device or a failing one, 6 out of memory.\n";

enum
{
    DEFAULT_BATCH = 1 << 20,
    SMALLEST_BATCH = 1 << 10, // smaller buffers than for this are not worth another try
    MAX_REPEATS = 1000,
};

typedef struct Options
{
    const char* scene_path;
    const char* rays_path;
    const char* hits_path;
    const char* device_name;
    LsMethod method;
    uint32_t flags;
    uint32_t repeats; // 0: once, and print no times
    uint32_t batch;
    bool quiet;
} Options;

typedef struct RayFile
{
    const char* name;
    int descriptor;
    uint64_t ray_count; // UINT64_MAX when it is known only at the end
} RayFile;

// Everything that lives while rays are traced.
typedef struct Trace
{
    LsAppScene scene;
    RayFile rays;
    LsOutFile hits;
    LsAppTracer tracer;
    uint64_t traced_count;
    uint64_t hit_count;
    double seconds[MAX_REPEATS]; // GPU time of each repeat over all batches
} Trace;

// ---- Arguments ---------------------------------------------------------------------------------

static bool parse_count(const char* text, unsigned long limit, uint32_t* count)
{
    char* end;
    errno = 0;
    unsigned long value = strtoul(text, &end, 10);
    *count = (uint32_t)value;
    return text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0 && value >= 1 &&
           value <= limit;
}

static LsExit report(const LsError* error)
{
    fprintf(stderr, "lstrace: error %u: %s\n", error->message, error->text);
    return ls_result_exit_code(error->result);
}

static LsExit refuse_usage(LsMessage message, const char* problem, const char* argument)
{
    LsError error;
    ls_error_set(&error, message, "%s%s; see lstrace --help", problem, argument);
    return report(&error);
}

static const char* const METHODS[] = {
    [LS_TRACE_EXACT] = "exact", [LS_TRACE_BRUTE] = "brute", [LS_TRACE_GRID] = "grid"};

static bool parse_method(const char* text, LsMethod* method)
{
    for (size_t i = 0; i < sizeof METHODS / sizeof *METHODS; i++)
    {
        if (strcmp(text, METHODS[i]) == 0)
        {
            *method = (LsMethod)i;
            return true;
        }
    }
    return false;
}

// Sets *done when there is nothing left to do: help was asked for, or the exit code is not
// LS_EXIT_OK.
static LsExit parse_options(int argc, char** argv, Options* options, bool* done)
{
    enum
    {
        RAYS = 256,
        ANY,
        METHOD,
        REPEAT,
        BATCH,
        DEVICE,
        QUIET,
        HELP_WANTED,
        VERSION
    };
    static const struct option names[] = {
        {"rays", required_argument, NULL, RAYS},
        {"output", required_argument, NULL, 'o'},
        {"any", no_argument, NULL, ANY},
        {"method", required_argument, NULL, METHOD},
        {"repeat", required_argument, NULL, REPEAT},
        {"batch", required_argument, NULL, BATCH},
        {"device", required_argument, NULL, DEVICE},
        {"quiet", no_argument, NULL, QUIET},
        {"help", no_argument, NULL, HELP_WANTED},
        {"version", no_argument, NULL, VERSION},
        {NULL, 0, NULL, 0},
    };
    *options = (Options){.method = LS_TRACE_EXACT, .batch = DEFAULT_BATCH};
    *done = true;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":o:", names, NULL)) != -1;)
    {
        switch (option)
        {
        case RAYS:
            options->rays_path = optarg;
            break;
        case 'o':
            options->hits_path = optarg;
            break;
        case ANY:
            options->flags |= LS_RAY_FLAG_ANY_HIT;
            break;
        case METHOD:
            if (!parse_method(optarg, &options->method))
            {
                return refuse_usage(LS_MESSAGE_LSTRACE_VALUE,
                                    "--method is exact, grid or brute, not ", optarg);
            }
            break;
        case REPEAT:
            if (!parse_count(optarg, MAX_REPEATS, &options->repeats))
            {
                return refuse_usage(LS_MESSAGE_LSTRACE_VALUE,
                                    "--repeat takes a number from 1 to 1000, not ", optarg);
            }
            break;
        case BATCH:
            if (!parse_count(optarg, 1ul << 26, &options->batch))
            {
                return refuse_usage(LS_MESSAGE_LSTRACE_VALUE,
                                    "--batch takes a number from 1 to 67108864, not ", optarg);
            }
            break;
        case DEVICE:
            options->device_name = optarg;
            break;
        case QUIET:
            options->quiet = true;
            break;
        case HELP_WANTED:
            fputs(HELP, stdout);
            return LS_EXIT_OK;
        case VERSION:
            puts("lstrace " LS_VERSION_TEXT);
            return LS_EXIT_OK;
        case ':':
            return refuse_usage(LS_MESSAGE_LSTRACE_OPTION, "a value is missing after ",
                                argv[optind - 1]);
        default:
            return refuse_usage(LS_MESSAGE_LSTRACE_OPTION, "unknown option ", argv[optind - 1]);
        }
    }
    if (argc - optind != 1)
    {
        return refuse_usage(LS_MESSAGE_LSTRACE_FILES, "one .lspace file is wanted", "");
    }
    options->scene_path = argv[optind];
    if (!options->rays_path)
    {
        return refuse_usage(LS_MESSAGE_LSTRACE_FILES, "--rays is missing", "");
    }
    if (!options->hits_path)
    {
        return refuse_usage(LS_MESSAGE_LSTRACE_FILES, "-o is missing", "");
    }
    if (strcmp(options->hits_path, "-") != 0 &&
        (ls_path_is_same(options->hits_path, options->scene_path) ||
         (strcmp(options->rays_path, "-") != 0 &&
          ls_path_is_same(options->hits_path, options->rays_path))))
    {
        return refuse_usage(LS_MESSAGE_LSTRACE_REPLACES,
                            "the hits would replace what is read: ", options->hits_path);
    }
    *done = false;
    return LS_EXIT_OK;
}

// ---- Rays --------------------------------------------------------------------------------------

static LsResult report_odd_bytes(const RayFile* rays, uint64_t odd, uint64_t whole, LsError* error)
{
    return ls_error_set(error, LS_MESSAGE_RAYS_CUT,
                        "%s: %" PRIu64 " bytes after the last whole ray (32 bytes each, %" PRIu64
                        " whole): the file was cut or is no ray file; write it again",
                        rays->name, odd, whole);
}

static LsResult open_rays(RayFile* rays, const char* path, LsError* error)
{
    bool standard_input = strcmp(path, "-") == 0;
    rays->name = standard_input ? "standard input" : path;
    rays->descriptor = standard_input ? dup(STDIN_FILENO) : open(path, O_RDONLY | O_CLOEXEC);
    if (rays->descriptor < 0)
    {
        return errno == ENOENT
                   ? ls_error_set(error, LS_MESSAGE_FILE_MISSING,
                                  "%s: there is no such file of rays; check the path", path)
                   : ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE,
                                  "%s: cannot be read: %s; check its permissions and the disk",
                                  path, strerror(errno));
    }
    struct stat status;
    if (fstat(rays->descriptor, &status) != 0)
    {
        return ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE,
                            "%s: cannot be read: %s; check its permissions and the disk",
                            rays->name, strerror(errno));
    }
    if (S_ISDIR(status.st_mode))
    {
        return ls_error_set(error, LS_MESSAGE_FILE_IS_FOLDER,
                            "%s: is a directory; name a file of rays", rays->name);
    }
    rays->ray_count = UINT64_MAX;
    if (S_ISREG(status.st_mode) && !standard_input)
    {
        uint64_t bytes = (uint64_t)status.st_size;
        rays->ray_count = bytes / sizeof(LsRay);
        if (bytes % sizeof(LsRay) != 0)
        {
            return report_odd_bytes(rays, bytes % sizeof(LsRay), rays->ray_count, error);
        }
        if (bytes == 0)
        {
            return ls_error_set(error, LS_MESSAGE_FILE_EMPTY,
                                "%s: is empty; write rays of 32 bytes each to it", rays->name);
        }
    }
    return LS_OK;
}

// Reads up to `capacity` rays; *count is smaller only at the end.
static LsResult read_rays(const RayFile* rays, uint64_t rays_before, LsRay* into, uint32_t capacity,
                          uint32_t* count, LsError* error)
{
    size_t wanted = capacity * sizeof(LsRay);
    size_t got = 0;
    while (got < wanted)
    {
        ssize_t piece = read(rays->descriptor, (char*)into + got, wanted - got);
        if (piece < 0 && errno != EINTR)
        {
            return ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE,
                                "%s: cannot be read: %s; check its permissions and the disk",
                                rays->name, strerror(errno));
        }
        if (piece == 0)
        {
            break;
        }
        got += piece > 0 ? (size_t)piece : 0;
    }
    *count = (uint32_t)(got / sizeof(LsRay));
    if (got % sizeof(LsRay) != 0)
    {
        return report_odd_bytes(rays, got % sizeof(LsRay), rays_before + *count, error);
    }
    return LS_OK;
}

// ---- Tracing -----------------------------------------------------------------------------------

// As many rays at a time as were asked for, are there, and fit.
static LsResult create_tracer(Trace* trace, uint32_t batch, LsError* error)
{
    uint64_t capacity = trace->scene.device.max_buffer_bytes / LS_APP_TRACER_RAY_BYTES;
    capacity = batch < capacity ? batch : capacity;
    capacity = trace->rays.ray_count < capacity ? trace->rays.ray_count : capacity;
    for (;;)
    {
        LsResult result =
            ls_app_tracer_create(&trace->scene.device, (uint32_t)capacity, &trace->tracer, error);
        if (result != LS_ERROR_DEVICE_MEMORY || capacity / 2 < SMALLEST_BATCH)
        {
            return result;
        }
        capacity /= 2;
    }
}

static LsResult open_trace(Trace* trace, const Options* options, LsError* error)
{
    LsResult result = ls_out_file_open(&trace->hits, options->hits_path, error);
    if (result == LS_OK)
    {
        result = open_rays(&trace->rays, options->rays_path, error);
    }
    if (result == LS_OK)
    {
        result = ls_app_scene_open(&trace->scene, options->scene_path, options->device_name,
                                   options->method == LS_TRACE_GRID, error);
    }
    return result == LS_OK ? create_tracer(trace, options->batch, error) : result;
}

static void close_trace(Trace* trace)
{
    ls_app_tracer_destroy(&trace->scene.device, &trace->tracer);
    ls_app_scene_close(&trace->scene);
    ls_out_file_drop(&trace->hits);
    if (trace->rays.name && trace->rays.descriptor >= 0)
    {
        close(trace->rays.descriptor);
    }
}

static LsResult trace_batch(Trace* trace, const Options* options, uint32_t count, LsError* error)
{
    LsAppRun run = {.ray_count = count, .flags = options->flags, .method = options->method};
    uint32_t repeats = options->repeats ? options->repeats : 1;
    for (uint32_t i = 0; i < repeats; i++)
    {
        double seconds;
        LsResult result = ls_app_tracer_run(&trace->scene.device, &trace->tracer,
                                            trace->scene.scene, &run, &seconds, error);
        if (result != LS_OK)
        {
            return result;
        }
        trace->seconds[i] += seconds;
    }
    for (uint32_t i = 0; i < count; i++)
    {
        trace->hit_count += trace->tracer.hits[i].instance != LS_NONE;
    }
    trace->traced_count += count;
    return ls_out_file_write(&trace->hits, trace->tracer.hits, count * sizeof(LsHit), error);
}

static void show_progress(const Trace* trace)
{
    if (trace->rays.ray_count == UINT64_MAX)
    {
        fprintf(stderr, "\rlstrace: %" PRIu64 " rays", trace->traced_count);
    }
    else
    {
        fprintf(stderr, "\rlstrace: %3.0f %% of %" PRIu64 " rays",
                100.0 * (double)trace->traced_count / (double)trace->rays.ray_count,
                trace->rays.ray_count);
    }
    fflush(stderr);
}

static LsResult trace_rays(Trace* trace, const Options* options, LsError* error)
{
    bool progress = !options->quiet && isatty(STDERR_FILENO);
    uint32_t count = 0;
    LsResult result;
    do
    {
        result = read_rays(&trace->rays, trace->traced_count, trace->tracer.rays,
                           trace->tracer.capacity, &count, error);
        if (result == LS_OK && count > 0)
        {
            result = trace_batch(trace, options, count, error);
        }
        if (result == LS_OK && progress)
        {
            show_progress(trace);
        }
    } while (result == LS_OK && count == trace->tracer.capacity);
    if (progress)
    {
        fputs("\n", stderr);
    }
    if (result == LS_OK && trace->traced_count == 0)
    {
        result = ls_error_set(error, LS_MESSAGE_FILE_EMPTY,
                              "%s: is empty; write rays of 32 bytes each to it", trace->rays.name);
    }
    return result == LS_OK ? ls_out_file_commit(&trace->hits, error) : result;
}

// ---- Report ------------------------------------------------------------------------------------

static int compare_doubles(const void* a, const void* b)
{
    double x = *(const double*)a;
    double y = *(const double*)b;
    return (x > y) - (x < y);
}

// To standard output, or beside it when the hits go there.
static void print_summary(Trace* trace, const Options* options)
{
    FILE* stream = strcmp(options->hits_path, "-") == 0 ? stderr : stdout;
    double rays = (double)trace->traced_count;
    if (!options->quiet)
    {
        fprintf(stream, "%" PRIu64 " rays, %" PRIu64 " hits (%.2f %%), %s, %s, on %s\n",
                trace->traced_count, trace->hit_count, 100.0 * (double)trace->hit_count / rays,
                options->method == LS_TRACE_BRUTE ? "brute force" : METHODS[options->method],
                options->flags & LS_RAY_FLAG_ANY_HIT ? "any hit" : "closest hit",
                trace->scene.device.name);
    }
    if (options->repeats && trace->scene.device.timestamp_seconds == 0)
    {
        fprintf(stream, "GPU time: unknown, the device has no timestamps\n");
    }
    else if (options->repeats)
    {
        uint32_t n = options->repeats;
        double* s = trace->seconds;
        qsort(s, n, sizeof(*s), compare_doubles);
        double median = (s[(n - 1) / 2] + s[n / 2]) / 2;
        fprintf(stream, "GPU time: median %.3f ms, min %.3f ms, max %.3f ms of %u; %.2f Mrays/s\n",
                median * 1e3, s[0] * 1e3, s[n - 1] * 1e3, n, rays / median * 1e-6);
    }
}

static LsExit run(const Options* options)
{
    static Trace trace;
    LsError error;
    LsResult result = open_trace(&trace, options, &error);
    if (result == LS_OK)
    {
        result = trace_rays(&trace, options, &error);
    }
    if (result == LS_OK)
    {
        print_summary(&trace, options);
    }
    else
    {
        report(&error);
    }
    close_trace(&trace);
    return ls_result_exit_code(result);
}

int main(int argc, char** argv)
{
    signal(SIGXFSZ, SIG_IGN); // a limit on the size of files makes writing fail instead
    Options options;
    bool done;
    LsExit code = parse_options(argc, argv, &options, &done);
    if (!done)
    {
        code = run(&options);
    }
    if (code == LS_EXIT_OK && (fflush(stdout) != 0 || ferror(stdout)))
    {
        LsError error;
        ls_error_set(&error, LS_MESSAGE_OUTPUT_STANDARD,
                     "standard output cannot be written; is the disk full?");
        code = report(&error);
    }
    return code;
}
