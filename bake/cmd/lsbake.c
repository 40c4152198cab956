// lsbake.c - arguments to a desc, one call, a report.

#include "ls_bake.h"
#include "ls_messages.h"
#include "ls_write.h"
#include "report.h"

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

static int fail(const LsError* error)
{
    fprintf(stderr, "lsbake: %s\n", error->text);
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
        LsBakeReport report = {0};
        result = ls_bake_run(&arguments.desc, &report, &error);
        if (result == LS_OK && arguments.json)
        {
            result = ls_report_print_json(&report, arguments.desc.output)
                         ? LS_OK
                         : ls_error_set(&error, LS_MESSAGE_OUT_OF_MEMORY,
                                        "out of memory for the report; the bake itself is done");
        }
        else if (result == LS_OK && !arguments.quiet)
        {
            ls_report_print_text(&report, arguments.desc.output);
        }
        ls_bake_report_destroy(&report);
    }
    free(inputs);
    if (result == LS_OK && (fflush(stdout) != 0 || ferror(stdout)))
    {
        result = ls_error_set(&error, LS_ERROR_OUTPUT,
                              "standard output cannot be written; is the disk full?");
    }
    return result == LS_OK ? 0 : fail(&error);
}
