// baked.h - test meshes baked into files and opened, as users would.

#ifndef LS_TEST_BAKED_H
#define LS_TEST_BAKED_H

#include "ls_bake.h"
#include "ls_format.h"
#include "meshes.h"

// How a mesh is placed.
typedef enum LsTestPlacement
{
    LS_TEST_ALONE,     // PLY: one object, the identity
    LS_TEST_INSTANCES, // glTF: four instances, turned, stretched and mirrored
} LsTestPlacement;

typedef struct LsBaked
{
    char path[512];
    LsMapping mapping;
    LsFile file;
    LsBakeReport report;
} LsBaked;

// Bakes into the build folder under a name made of the arguments, opens the file and checks it.
// grid and patches 0: the baker's default; threads 0: all. Failures fail the calling cmocka test
// with the error's text.
void ls_baked_open(LsBaked* baked, const LsTestMesh* mesh, const char* name,
                   LsTestPlacement placement, uint32_t grid, uint32_t patches, uint32_t threads);
// With all of a desc's options for the Line Space: grid, patches, choice, scene shafts and threads.
void ls_baked_open_desc(LsBaked* baked, const LsTestMesh* mesh, const char* name,
                        LsTestPlacement placement, const LsBakeDesc* options);
void ls_baked_close(LsBaked* baked); // removes the file

#endif
