// bake_warnings.c - a list that grows, and two ways to print it.

#include "bake_warnings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void keep(BakeWarnings* warnings, uint32_t message, const char* text)
{
    if (warnings->count == warnings->capacity)
    {
        const uint32_t grown = warnings->capacity ? 2 * warnings->capacity : 16;
        BakeWarning* moved = realloc(warnings->list, grown * sizeof *moved);
        if (moved)
        {
            warnings->list = moved;
            warnings->capacity = grown;
        }
    }
    char* copy = warnings->count < warnings->capacity ? strdup(text) : NULL;
    if (copy)
        warnings->list[warnings->count++] = (BakeWarning){message, copy};
    else
        warnings->is_cut = true;
}

void ls_bake_warnings_take(void* user, uint32_t message, const char* text)
{
    BakeWarnings* warnings = user;
    // The bar, if there is one, is on this line.
    if (!warnings->quiet && warnings->count < LS_BAKE_WARNINGS_SHOWN)
        fprintf(stderr, "%slsbake: warning %u: %s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "",
                message, text);
    keep(warnings, message, text);
}

void ls_bake_warnings_end(const BakeWarnings* warnings)
{
    if (!warnings->quiet && warnings->count > LS_BAKE_WARNINGS_SHOWN)
        fprintf(stderr, "lsbake: and %u more warnings (all in --report json)\n",
                warnings->count - LS_BAKE_WARNINGS_SHOWN);
    if (!warnings->quiet && warnings->is_cut)
        fputs("lsbake: there are more warnings, for which memory ran out\n", stderr);
}

void ls_bake_warnings_json(const BakeWarnings* warnings, cJSON* report)
{
    cJSON* list = cJSON_AddArrayToObject(report, "warnings");
    for (uint32_t i = 0; i < warnings->count; i++)
    {
        cJSON* warning = cJSON_CreateObject();
        cJSON_AddNumberToObject(warning, "number", warnings->list[i].message);
        cJSON_AddStringToObject(warning, "text", warnings->list[i].text);
        cJSON_AddItemToArray(list, warning);
    }
}

void ls_bake_warnings_destroy(BakeWarnings* warnings)
{
    for (uint32_t i = 0; i < warnings->count; i++)
        free(warnings->list[i].text);
    free(warnings->list);
    *warnings = (BakeWarnings){0};
}
