// depfile.h - what a bake read, as a rule of make: for build systems.

#ifndef LS_DEPFILE_H
#define LS_DEPFILE_H

#include "source_files.h"

// Writes "output: file file ..." to desc->depfile, with the output's name as the desc has it and
// each file that is there once; escaped as gcc -MD escapes names. Errors: OUTPUT_UNWRITABLE (also
// for names with a line break, which no such rule can hold), OUTPUT_*, OUT_OF_MEMORY.
LsResult ls_depfile_write(const LsSourceFiles* files, const LsBakeDesc* desc, LsError* error);

#endif
