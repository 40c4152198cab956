// check.c - how the parts of the check report a broken rule.

#include "check.h"

#include <stdarg.h>
#include <stdio.h>

LsResult ls_check_report(const LsCheck* check, const char* rule, LsChunk chunk, uint64_t record,
                         const char* format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    return ls_error_set(check->error, LS_MESSAGE_LSPACE_RULE,
                        "%s: %s: %s record %llu: %s; bake it again", check->name, rule,
                        ls_chunk_info(chunk).name, (unsigned long long)record, text);
}
