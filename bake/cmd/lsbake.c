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

// Before hours of work; that no input is replaced the bake itself sees to.
static LsResult check_outputs(const LsBakeDesc* desc, LsError* error)
{
    const char* depfile = desc->depfile;
    if (depfile != NULL &&
        (ls_path_is_same(depfile, desc->output) || strcmp(depfile, desc->output) == 0))
    {
        return ls_error_set(error, LS_MESSAGE_USAGE_OUTPUT_IS_INPUT,
                            "%s: the depfile would replace the output; choose another name",
                            depfile);
    }
    const LsResult result = ls_output_check(desc->output, error);
    return result == LS_OK && depfile != NULL ? ls_output_check(depfile, error) : result;
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
    LsResult result = check_outputs(&desc, error);
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
