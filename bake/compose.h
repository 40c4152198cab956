// compose.h - the import stage: several files put together into one LsInput.

#ifndef LS_COMPOSE_H
#define LS_COMPOSE_H

#include "import/import.h"
#include "ls_bake.h"

// Whether the inputs of the desc ask for what can be done. Errors: USAGE_NO_SCENE, USAGE_CHOICE,
// USAGE_NUMBER, USAGE_NOT_GLTF.
LsResult ls_compose_check(const LsBakeDesc* desc, LsError* error);

// Imports the files in order; of each the materials are overridden and the whole is placed before
// the next is read, and its warnings go to desc->warn. `progress` hears the fraction of all files'
// bytes. The input is to be destroyed whatever comes back. Errors: those of ls_import,
// ls_input_override and ls_input_place, SCENE_NO_TRIANGLES, LIMIT_TRIANGLES.
LsResult ls_compose(LsInput* input, const LsBakeDesc* desc, LsImportProgress* progress,
                    void* progress_user, LsError* error);

#endif
