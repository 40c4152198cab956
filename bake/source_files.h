// source_files.h - the files that a bake reads: what its hash and its depfile go by.

#ifndef LS_SOURCE_FILES_H
#define LS_SOURCE_FILES_H

#include "ls_bake.h"

#include <sys/stat.h>

typedef struct LsSourceFile
{
    char* path;     // owned
    uint32_t input; // which of the bake's inputs reads it
    bool is_there;  // as a regular file
    struct stat status;
} LsSourceFile;

// Zero it before use; ls_source_files_destroy frees it.
typedef struct LsSourceFiles
{
    LsSourceFile* list; // by input: the scene, what it names, its file of materials
    uint32_t count, capacity;
} LsSourceFiles;

// Lists the files of all inputs, those too that are named and not there. Errors: OUT_OF_MEMORY.
LsResult ls_source_files_list(LsSourceFiles* files, const LsBakeDesc* desc, LsError* error);

// Whether all are still as they were when they were listed, by size and time: else what has been
// read need not be what has been hashed. Errors: FILE_CHANGED.
LsResult ls_source_files_check(const LsSourceFiles* files, LsError* error);

// Whether a file may be written at `path`: not over one of these. Errors: USAGE_OUTPUT_IS_INPUT.
LsResult ls_source_files_spare(const LsSourceFiles* files, const char* path, LsError* error);

void ls_source_files_destroy(LsSourceFiles* files);

#endif
