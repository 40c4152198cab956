// base.c - result texts, exit codes and the filling of an LsError.

#include "ls_base.h"

#include <assert.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

// Words of a file may hold what moves a terminal's cursor; a message is one line of plain text.
static void make_plain(char* text)
{
    for (; *text != '\0'; text++)
    {
        const unsigned char letter = (unsigned char)*text;
        if (letter < 0x20 || letter == 0x7F)
        {
            *text = '?';
        }
    }
}

LsResult ls_error_set(LsError* error, int message, const char* format, ...)
{
    assert(message >= 1000); // an LsResult has two digits
    const LsResult result = (LsResult)(message / 100);
    if (error != NULL)
    {
        error->result = result;
        error->message = (uint32_t)message;
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof(error->text), format, arguments);
        va_end(arguments);
        make_plain(error->text);
    }
    return result;
}

const char* ls_result_text(LsResult result)
{
    switch (result)
    {
#define LS_RESULT_CASE(name, number, text) \
    case LS_##name:                        \
        return text;
        LS_RESULT_LIST(LS_RESULT_CASE)
#undef LS_RESULT_CASE
    }
    return "unknown result";
}

LsExit ls_result_exit_code(LsResult result)
{
    switch (result / 10)
    {
    case 0:
        return LS_EXIT_OK;
    case 1:
        return LS_EXIT_USAGE;
    case 2:
    case 3:
        return LS_EXIT_INPUT;
    case 4:
        return LS_EXIT_OUTPUT;
    case 5:
        return LS_EXIT_LSPACE;
    case 6:
        return LS_EXIT_DEVICE;
    default:
        return LS_EXIT_MEMORY;
    }
}
