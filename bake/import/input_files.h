// input_files.h - which files an import reads, found out without importing.

#ifndef LS_INPUT_FILES_H
#define LS_INPUT_FILES_H

#include "name_table.h"

#ifdef __cplusplus
extern "C"
{
#endif

    // Adds the files that ls_import reads for the scene at `path`: itself, then those that it names, in
    // the order in which they are looked for; the numbers of the table mean nothing. Files that are
    // named but are not there belong to them, since the import goes by that too; so do images of a glTF
    // that no material uses. Of files that the import refuses, only some. Far faster than importing,
    // since meshes and images are passed over. False when out of memory.
    bool ls_input_list_files(const char* path, LsNameTable* files);

    // For the shims: the same of one format.
    bool ls_gltf_list_files(const char* path, LsNameTable* files);
    bool ls_obj_list_files(const char* path, LsNameTable* files);

#ifdef __cplusplus
}
#endif

#endif
