// report.h - what a bake did, as lines for a person or as JSON for a program.

#ifndef LS_REPORT_H
#define LS_REPORT_H

#include "bake_warnings.h"
#include "ls_bake.h"

// Both print on standard output; the caller looks for errors there.
void ls_report_print_text(const LsBakeReport* report, const char* output);
// False when out of memory.
bool ls_report_print_json(const LsBakeReport* report, const char* output,
                          const BakeWarnings* warnings);

#endif
