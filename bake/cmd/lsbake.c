// lsbake.c - arguments to a desc, one call, a report.

#include "ls_bake.h"
#include "ls_write.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char HELP[] =
    "lsbake - bakes scenes into one .lspace file\n"
    "\n"
    "usage: lsbake SCENE... -o OUT.lspace [options]\n"
    "\n"
    "SCENE is a .gltf, .glb, .obj, .ply, .off or .stl file; several are put together as they\n"
    "lie, their objects numbered in order.\n"
    "\n"
    "  -o, --output FILE   where to write (required)\n"
    "      --grid G        cells along the longest side of each object's box, 1 to 4096\n"
    "                      (default: a quarter of the root of its triangle count, 4 to 512)\n"
    "      --patches N     patches along a voxel's edge, 1 to 16 (default 3)\n"
    "      --threads T     threads; the result does not depend on it (default: all processors)\n"
    "  -f, --force         bake although the output is up to date\n"
    "      --report json   print the report as JSON on standard output\n"
    "  -q, --quiet         print nothing but errors\n"
    "  -h, --help          this text\n"
    "      --version       version of program and format\n"
    "\n"
    "exit codes: 0 done, 1 usage, 2 input, 3 output, 6 out of memory\n";

// Everything the command line says.
typedef struct Arguments
{
    LsBakeDesc desc;
    bool quiet;
    bool json;
    bool done; // --help or --version was answered
} Arguments;

static LsResult parse_number(const char* option, const char* text, uint32_t smallest,
                             uint32_t largest, uint32_t* out, LsError* error)
{
    char* end = NULL;
    errno = 0;
    unsigned long value =
        text != NULL && text[0] >= '0' && text[0] <= '9' ? strtoul(text, &end, 10) : 0;
    if (end == NULL || *end != '\0' || errno != 0 || value < smallest || value > largest)
    {
        return ls_error_set(error, LS_ERROR_ARGUMENT,
                            "%s takes a whole number from %u to %u, not '%s'", option, smallest,
                            largest, text != NULL ? text : "");
    }
    *out = (uint32_t)value;
    return LS_OK;
}

static LsResult parse_option(Arguments* arguments, const char* option, const char* value,
                             LsError* error)
{
    LsBakeDesc* desc = &arguments->desc;
    if (strcmp(option, "-o") == 0 || strcmp(option, "--output") == 0)
    {
        desc->output = value;
        return value != NULL && value[0] != '\0'
                   ? LS_OK
                   : ls_error_set(error, LS_ERROR_ARGUMENT, "%s takes a file name", option);
    }
    if (strcmp(option, "--grid") == 0)
    {
        return parse_number(option, value, 1, LS_MAX_CELLS, &desc->grid, error);
    }
    if (strcmp(option, "--patches") == 0)
    {
        return parse_number(option, value, 1, LS_MAX_PATCHES, &desc->patches, error);
    }
    if (strcmp(option, "--threads") == 0)
    {
        return parse_number(option, value, 1, 1024, &desc->threads, error);
    }
    arguments->json = value != NULL && strcmp(value, "json") == 0;
    return arguments->json ? LS_OK
                           : ls_error_set(error, LS_ERROR_ARGUMENT, "--report takes 'json'");
}

static bool takes_value(const char* option)
{
    static const char* const options[] = {"-o",        "--output",  "--grid",
                                          "--patches", "--threads", "--report"};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
    {
        if (strcmp(option, options[i]) == 0)
        {
            return true;
        }
    }
    return false;
}

// Inputs are gathered into `inputs`, which has room for all arguments.
static LsResult parse_arguments(Arguments* arguments, LsBakeInput* inputs, int argc, char** argv,
                                LsError* error)
{
    bool options_end = false;
    for (int i = 1; i < argc; i++)
    {
        const char* word = argv[i];
        if (options_end || word[0] != '-' || word[1] == '\0')
        {
            inputs[arguments->desc.input_count++].path = word;
        }
        else if (strcmp(word, "--") == 0)
        {
            options_end = true;
        }
        else if (takes_value(word))
        {
            i++;
            LsResult result = parse_option(arguments, word, i < argc ? argv[i] : NULL, error);
            if (result != LS_OK)
            {
                return result;
            }
        }
        else if (strcmp(word, "-f") == 0 || strcmp(word, "--force") == 0)
        {
            arguments->desc.force = true;
        }
        else if (strcmp(word, "-q") == 0 || strcmp(word, "--quiet") == 0)
        {
            arguments->quiet = true;
        }
        else if (strcmp(word, "-h") == 0 || strcmp(word, "--help") == 0)
        {
            fputs(HELP, stdout);
            arguments->done = true;
            return LS_OK;
        }
        else if (strcmp(word, "--version") == 0)
        {
            printf("lsbake %s, format %d.%d\n", LS_VERSION_TEXT, LS_FORMAT_MAJOR, LS_FORMAT_MINOR);
            arguments->done = true;
            return LS_OK;
        }
        else
        {
            return ls_error_set(error, LS_ERROR_ARGUMENT,
                                "unknown option '%s'; lsbake --help lists all", word);
        }
    }
    arguments->desc.inputs = inputs;
    if (arguments->desc.input_count == 0)
    {
        return ls_error_set(error, LS_ERROR_ARGUMENT, "no scene given; lsbake --help shows how");
    }
    if (arguments->desc.output == NULL)
    {
        return ls_error_set(error, LS_ERROR_ARGUMENT,
                            "no output given; name it with -o OUT.lspace");
    }
    return LS_OK;
}

static LsResult check_paths(const LsBakeDesc* desc, LsError* error)
{
    for (uint32_t i = 0; i < desc->input_count; i++)
    {
        if (ls_path_is_same(desc->inputs[i].path, desc->output))
        {
            return ls_error_set(error, LS_ERROR_ARGUMENT,
                                "%s: the output would replace the scene %s; choose another name",
                                desc->output, desc->inputs[i].path);
        }
    }
    return ls_output_check(desc->output, error);
}

// A bar on the terminal's last line, rewritten in place.
static void draw_progress(void* user, const char* stage, double fraction)
{
    int* last = user;
    int now = (int)(fraction * 30.0);
    if (now == *last)
    {
        return;
    }
    *last = now;
    fprintf(stderr, "\r%-10s [%-30.*s] %3d %%", stage, now, "##############################",
            (int)(fraction * 100.0));
    if (fraction >= 1.0)
    {
        fputs("\r\033[K", stderr);
    }
    fflush(stderr);
}

static double total_seconds(const LsBakeReport* report)
{
    double sum = 0.0;
    for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
    {
        sum += report->stage_seconds[i];
    }
    return sum;
}

static void print_text(const LsBakeReport* report, const char* output)
{
    if (report->up_to_date)
    {
        printf("%s is up to date (%.1f MB)\n", output, (double)report->file_bytes * 1e-6);
        return;
    }
    printf("%s: %.1f MB, baked in %.2f s\n", output, (double)report->file_bytes * 1e-6,
           total_seconds(report));
    printf("  objects %u (%llu as lists), instances %u, lights %u, cameras %u\n",
           report->object_count, (unsigned long long)report->list_object_count,
           report->instance_count, report->light_count, report->camera_count);
    printf("  triangles %llu of %llu", (unsigned long long)report->triangle_count,
           (unsigned long long)report->face_count);
    if (report->degenerate_count > 0)
    {
        printf(" (%llu dropped: they have no area)", (unsigned long long)report->degenerate_count);
    }
    printf("\n  voxels %llu in %llu cells: %llu lists, %llu with masks, %llu divided (depth %u), "
           "%llu BVHs\n",
           (unsigned long long)report->voxel_count, (unsigned long long)report->cell_count,
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_LIST],
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_MASKS],
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_SUBGRID], report->depth,
           (unsigned long long)report->voxel_kind_count[LS_VOXEL_BVH]);
    if (report->shaft_count > 0)
    {
        printf("  shafts %llu, %.1f %% filled\n", (unsigned long long)report->shaft_count,
               100.0 * (double)report->filled_shaft_count / (double)report->shaft_count);
    }
    printf("  largest condition number of a transform %.3g, peak memory %.0f MB\n ",
           report->max_condition, (double)report->peak_memory_bytes * 1e-6);
    for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
    {
        printf(" %s %.2f s%s", ls_bake_stage_text((LsBakeStage)i), report->stage_seconds[i],
               i + 1 < LS_BAKE_STAGE_COUNT ? "," : "\n");
    }
}

static void print_json(const LsBakeReport* report, const char* output)
{
    cJSON* root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "output", output);
    cJSON_AddBoolToObject(root, "up_to_date", report->up_to_date);
    cJSON_AddNumberToObject(root, "file_bytes", (double)report->file_bytes);
    if (!report->up_to_date)
    {
        const struct
        {
            const char* name;
            double value;
        } numbers[] = {
            {"seconds", total_seconds(report)},
            {"peak_memory_bytes", (double)report->peak_memory_bytes},
            {"objects", report->object_count},
            {"list_objects", (double)report->list_object_count},
            {"instances", report->instance_count},
            {"materials", report->material_count},
            {"lights", report->light_count},
            {"cameras", report->camera_count},
            {"faces", (double)report->face_count},
            {"degenerate_faces", (double)report->degenerate_count},
            {"triangles", (double)report->triangle_count},
            {"cells", (double)report->cell_count},
            {"cell_blocks", (double)report->cell_block_count},
            {"voxels", (double)report->voxel_count},
            {"voxels_list", (double)report->voxel_kind_count[LS_VOXEL_LIST]},
            {"voxels_masks", (double)report->voxel_kind_count[LS_VOXEL_MASKS]},
            {"voxels_subgrid", (double)report->voxel_kind_count[LS_VOXEL_SUBGRID]},
            {"voxels_bvh", (double)report->voxel_kind_count[LS_VOXEL_BVH]},
            {"subgrids", (double)report->subgrid_count},
            {"depth", report->depth},
            {"references", (double)report->reference_count},
            {"shafts", (double)report->shaft_count},
            {"filled_shafts", (double)report->filled_shaft_count},
            {"max_condition", report->max_condition},
        };
        for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        {
            cJSON_AddNumberToObject(root, numbers[i].name, numbers[i].value);
        }
        cJSON* stages = cJSON_AddObjectToObject(root, "stage_seconds");
        for (int i = 0; i < LS_BAKE_STAGE_COUNT; i++)
        {
            cJSON_AddNumberToObject(stages, ls_bake_stage_text((LsBakeStage)i),
                                    report->stage_seconds[i]);
        }
        cJSON* chunks = cJSON_AddObjectToObject(root, "chunk_bytes");
        for (int i = 0; i < LS_CHUNK_COUNT; i++)
        {
            cJSON_AddNumberToObject(chunks, ls_chunk_info((LsChunk)i).name,
                                    (double)report->chunk_bytes[i]);
        }
    }
    char* text = cJSON_Print(root);
    if (text != NULL)
    {
        puts(text);
    }
    free(text);
    cJSON_Delete(root);
}

static int fail(const LsError* error)
{
    fprintf(stderr, "lsbake: error %u: %s\n", error->message, error->text);
    return (int)ls_result_exit_code(error->result);
}

int main(int argc, char** argv)
{
    LsError error = {0};
    Arguments arguments = {0};
    LsBakeInput* inputs = calloc((size_t)argc, sizeof *inputs);
    if (inputs == NULL)
    {
        ls_error_set(&error, LS_ERROR_MEMORY, "out of memory");
        return fail(&error);
    }
    LsResult result = parse_arguments(&arguments, inputs, argc, argv, &error);
    if (result == LS_OK && !arguments.done)
    {
        result = check_paths(&arguments.desc, &error);
    }
    if (result == LS_OK && !arguments.done)
    {
        int last = -1;
        if (!arguments.quiet && isatty(STDERR_FILENO))
        {
            arguments.desc.progress = draw_progress;
            arguments.desc.progress_user = &last;
        }
        LsBakeReport report;
        result = ls_bake_run(&arguments.desc, &report, &error);
        if (result == LS_OK && arguments.json)
        {
            print_json(&report, arguments.desc.output);
        }
        else if (result == LS_OK && !arguments.quiet)
        {
            print_text(&report, arguments.desc.output);
        }
    }
    free(inputs);
    if (result == LS_OK && (fflush(stdout) != 0 || ferror(stdout)))
    {
        result = ls_error_set(&error, LS_ERROR_OUTPUT,
                              "standard output cannot be written; is the disk full?");
    }
    return result == LS_OK ? 0 : fail(&error);
}
