// lsbake.c - arguments to a desc, one call, a report.

#include "bake_arguments.h"
#include "bake_warnings.h"
#include "ls_messages.h"
#include "ls_write.h"
#include "memory_net.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static LsResult check_path(const char* input, const char* output, LsError* error)
{
    if (!ls_path_is_same(input, output))
    {
        return LS_OK;
    }
    return ls_error_set(error, LS_MESSAGE_USAGE_OUTPUT_IS_INPUT,
                        "%s: the output would replace the input %s; choose another name", output,
                        input);
}

static LsResult check_paths(const LsBakeDesc* desc, LsError* error)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < desc->input_count && result == LS_OK; i++)
    {
        const LsBakeInput* input = &desc->inputs[i];
        result = check_path(input->path, desc->output, error);
        if (result == LS_OK && input->materials != NULL && input->materials[0] != '{')
        {
            result = check_path(input->materials, desc->output, error);
        }
    }
    return result == LS_OK ? ls_output_check(desc->output, error) : result;
}

// The state of the bar.
typedef struct Bar
{
    int percent;
    double drawn; // when, in seconds
} Bar;

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// A bar on the terminal's last line, rewritten in place, ten times a second at most.
static void draw_progress(void* user, const char* stage, double fraction)
{
    Bar* bar = user;
    const int percent = (int)(fraction * 100.0);
    const bool is_end = fraction >= 1.0;
    const double time = now();
    if (percent == bar->percent || (!is_end && fraction > 0.0 && time < bar->drawn + 0.1))
    {
        return;
    }
    *bar = (Bar){.percent = percent, .drawn = time};
    if (is_end)
    {
        fputs("\r\033[K", stderr);
    }
    else
    {
        fprintf(stderr, "\r%-10s [%-30.*s] %3d %%", stage, percent * 30 / 100,
                "##############################", percent);
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

static void print_json(const LsBakeReport* report, const char* output, const BakeWarnings* warnings)
{
    cJSON* root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "output", output);
    cJSON_AddBoolToObject(root, "up_to_date", report->up_to_date);
    cJSON_AddNumberToObject(root, "file_bytes", (double)report->file_bytes);
    ls_bake_warnings_json(warnings, root);
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

static int fail(const LsError* error, const LsBakeDesc* desc)
{
    fprintf(stderr, "lsbake: error %u: %s", error->message, error->text);
    if (error->result == LS_ERROR_MEMORY && desc->max_memory > 0)
    {
        fprintf(stderr, "; --max-memory allows %.1f MB: raise it, or bake less",
                (double)desc->max_memory * 1e-6);
    }
    fputc('\n', stderr);
    return (int)ls_result_exit_code(error->result);
}

static LsResult bake(const BakeArguments* arguments, LsError* error)
{
    LsBakeDesc desc = arguments->desc;
    Bar bar = {.percent = -1};
    BakeWarnings warnings = {.quiet = arguments->quiet};
    desc.warn = ls_bake_warnings_take;
    desc.warn_user = &warnings;
    if (!arguments->quiet && isatty(STDERR_FILENO))
    {
        desc.progress = draw_progress;
        desc.progress_user = &bar;
    }
    LsResult result = check_paths(&desc, error);
    if (result == LS_OK)
    {
        if (desc.max_memory > 0)
        {
            ls_memory_net_set(desc.max_memory, desc.threads);
        }
        LsBakeReport report;
        result = ls_bake_run(&desc, &report, error);
        ls_bake_warnings_end(&warnings);
        if (result == LS_OK && arguments->json)
        {
            print_json(&report, desc.output, &warnings);
        }
        else if (result == LS_OK && !arguments->quiet)
        {
            print_text(&report, desc.output);
        }
    }
    ls_bake_warnings_destroy(&warnings);
    return result;
}

int main(int argc, char** argv)
{
    LsError error = {0};
    BakeArguments arguments;
    LsResult result = ls_bake_arguments_parse(&arguments, argc, argv, &error);
    if (result == LS_OK && arguments.help)
    {
        fputs(ls_bake_help, stdout);
    }
    else if (result == LS_OK && arguments.version)
    {
        printf("lsbake %s, format %d.%d\n", LS_VERSION_TEXT, LS_FORMAT_MAJOR, LS_FORMAT_MINOR);
    }
    else if (result == LS_OK)
    {
        result = bake(&arguments, &error);
    }
    if (result == LS_OK && (fflush(stdout) != 0 || ferror(stdout)))
    {
        result = ls_error_set(&error, LS_MESSAGE_OUTPUT_STANDARD,
                              "standard output cannot be written; is the disk full?");
    }
    const int code = result == LS_OK ? 0 : fail(&error, &arguments.desc);
    ls_bake_arguments_destroy(&arguments);
    return code;
}
