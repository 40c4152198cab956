// scene_shaft_layout.h - for tests: the same file with scene shafts.

#ifndef LS_TEST_SCENE_SHAFT_LAYOUT_H
#define LS_TEST_SCENE_SHAFT_LAYOUT_H

#include "ls_write.h"

// `desc` with arrays of its own where they differ.
typedef struct LsSceneShaftLayout
{
    LsFileDesc desc;
    LsObject* objects;
    LsVoxel* voxels;
    uint32_t* shafts;
} LsSceneShaftLayout;

// Gives each grid of a file without scene shafts those of M = patches. Words are numbers that describe no geometry, every
// seventh 0. Other arrays stay those of `source`. Fails the calling cmocka test when out of memory.
LsSceneShaftLayout ls_scene_shaft_layout(const LsFileDesc* source, uint32_t patches);
void ls_scene_shaft_layout_destroy(LsSceneShaftLayout* layout);

#endif
