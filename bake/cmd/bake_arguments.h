// bake_arguments.h - lsbake's command line: a table of options, each read into its field.

#ifndef LS_BAKE_ARGUMENTS_H
#define LS_BAKE_ARGUMENTS_H

#include "ls_bake.h"

// Everything the command line says.
typedef struct BakeArguments
{
    LsBakeDesc desc;
    LsBakeInput* inputs; // owned; desc.inputs points there
    bool quiet;
    bool json;
    bool help;
    bool version;
} BakeArguments;

extern const char ls_bake_help[];

// Strings are the arguments' own. After an error too, `arguments` is to be destroyed. Errors:
// ARGUMENT, MEMORY.
LsResult ls_bake_arguments_parse(BakeArguments* arguments, int argc, char** argv, LsError* error);
void ls_bake_arguments_destroy(BakeArguments* arguments);

#endif
