// bake_warnings.h - the warnings of a bake: shown as they come, kept for the report.

#ifndef LS_BAKE_WARNINGS_H
#define LS_BAKE_WARNINGS_H

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdint.h>

#define LS_BAKE_WARNINGS_SHOWN 20

typedef struct BakeWarning
{
    uint32_t message;
    char* text; // owned
} BakeWarning;

// Zeroed but for `quiet` before the first; ls_bake_warnings_destroy frees it.
typedef struct BakeWarnings
{
    bool quiet; // none is shown
    BakeWarning* list;
    uint32_t count, capacity;
    bool is_cut; // memory ran out: some are missing
} BakeWarnings;

// An LsWarn; `user` is a BakeWarnings. The first LS_BAKE_WARNINGS_SHOWN go to standard error.
void ls_bake_warnings_take(void* user, uint32_t message, const char* text);

// Says on standard error how many were not shown.
void ls_bake_warnings_end(const BakeWarnings* warnings);

// "warnings": [{"number": 3870, "text": "..."}, ...]
void ls_bake_warnings_json(const BakeWarnings* warnings, cJSON* report);

void ls_bake_warnings_destroy(BakeWarnings* warnings);

#endif
