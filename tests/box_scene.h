// box_scene.h - small scenes of lists made by code, written as .lspace files without the baker.

#ifndef LS_BOX_SCENE_H
#define LS_BOX_SCENE_H

#include "ls_base.h"

typedef enum LsBoxScene
{
    LS_BOX_CORNELL, // [-1,1]^3 open at +z, red and green walls, a light below the ceiling, a block
    LS_BOX_INSTANCES, // the same, the block a second object: turned, stretched, mirrored
    LS_BOX_OPEN,      // floor and block, no lights, no camera
    LS_BOX_FURNACE, // a closed cube whose walls all emit 1 inwards and reflect half; camera inside
    LS_BOX_RECTANGLE, // a floor of albedo 1 seen from above, 1 below a rectangle light facing it
} LsBoxScene;

// Writes the scene with all lengths times `scale`. Errors: as ls_file_write.
LsResult ls_box_scene_write(LsBoxScene scene, float scale, const char* path, LsError* error);

#endif
