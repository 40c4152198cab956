// out_file.h - an output that grows piece by piece and appears as a whole.
//
// A regular file is an LsOutput. "-" (standard output), devices and pipes are written directly.

#ifndef LS_OUT_FILE_H
#define LS_OUT_FILE_H

#include "ls_output.h"

#include <stdbool.h>
#include <stddef.h>

// Zero when closed.
typedef struct LsOutFile
{
    const char* name; // for messages: as given, borrowed, or "standard output"
    bool direct;
    int descriptor;  // written directly
    LsOutput output; // otherwise
    uint64_t size;   // written so far
} LsOutFile;

// Errors: OUTPUT, OUTPUT_FULL. On failure *file is zero.
LsResult ls_out_file_open(LsOutFile* file, const char* name, LsError* error);

// Appends. Errors: OUTPUT, OUTPUT_FULL.
LsResult ls_out_file_write(LsOutFile* file, const void* bytes, size_t size, LsError* error);

// Brings everything to disk, puts the file in its place and closes it; on failure it is dropped.
// Errors: OUTPUT, OUTPUT_FULL.
LsResult ls_out_file_commit(LsOutFile* file, LsError* error);

// Closes and removes what was written. A zero file is allowed.
void ls_out_file_drop(LsOutFile* file);

#endif
