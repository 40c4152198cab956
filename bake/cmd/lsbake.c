// lsbake.c - arguments to a desc, one call, a report.

#include "bake_arguments.h"
#include "bake_warnings.h"
#include "bar.h"
#include "interrupt.h"
#include "ls_messages.h"
#include "ls_write.h"
#include "memory_net.h"
#include "report.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

static LsResult check_output(const LsBakeDesc* desc, const char* output, LsError* error)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < desc->input_count && result == LS_OK; i++)
    {
        const LsBakeInput* input = &desc->inputs[i];
        result = check_path(input->path, output, error);
        if (result == LS_OK && input->materials != NULL) // JSON is no file's name
        {
            result = check_path(input->materials, output, error);
        }
    }
    return result == LS_OK ? ls_output_check(output, error) : result;
}

static LsResult check_paths(const LsBakeDesc* desc, LsError* error)
{
    LsResult result = check_output(desc, desc->output, error);
    if (result == LS_OK && desc->depfile != NULL)
    {
        result = check_output(desc, desc->depfile, error);
        if (result == LS_OK && (ls_path_is_same(desc->depfile, desc->output) ||
                                strcmp(desc->depfile, desc->output) == 0))
        {
            result = ls_error_set(error, LS_MESSAGE_USAGE_OUTPUT_IS_INPUT,
                                  "%s: the depfile would replace the output; choose another name",
                                  desc->depfile);
        }
    }
    return result;
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
    Bar bar = {0};
    BakeWarnings warnings = {.quiet = arguments->quiet};
    desc.warn = ls_bake_warnings_take;
    desc.warn_user = &warnings;
    if (!arguments->quiet && isatty(STDERR_FILENO))
    {
        desc.progress = ls_bar_draw;
        desc.progress_user = &bar;
    }
    LsResult result = check_paths(&desc, error);
    if (result == LS_OK)
    {
        if (desc.max_memory > 0)
        {
            ls_memory_net_set(desc.max_memory, desc.threads);
        }
        LsBakeReport report = {0};
        result = ls_bake_run(&desc, &report, error);
        ls_bar_clear(&bar);
        ls_bake_warnings_end(&warnings);
        if (result == LS_OK && arguments->json)
        {
            if (!ls_report_print_json(&report, desc.output, &warnings))
            {
                result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                      "out of memory for the report; the bake itself is done");
            }
        }
        else if (result == LS_OK && !arguments->quiet)
        {
            ls_report_print_text(&report, desc.output);
        }
        ls_bake_report_destroy(&report);
    }
    ls_bake_warnings_destroy(&warnings);
    return result;
}

int main(int argc, char** argv)
{
    signal(SIGXFSZ, SIG_IGN); // a limit on the size of files makes writing fail instead
    ls_interrupt_begin();
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
