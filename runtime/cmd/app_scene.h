// app_scene.h - from the name of an .lspace file to a scene on a device, for programs.

#ifndef LS_APP_SCENE_H
#define LS_APP_SCENE_H

#include "app_device.h"

// Read its fields; change none. Zeroed when closed.
typedef struct LsAppScene
{
    LsMapping mapping;
    LsFile file; // borrows the mapping
    LsAppDevice device;
    LsContext* context;
    LsScene* scene;
} LsAppScene;

// Maps and opens the file, then creates device, context and scene; `device_name` as in
// LsAppDeviceDesc, `measures` as in LsContextDesc. Errors: those of the calls it makes. After a
// failure, too, ls_app_scene_close must be called.
LsResult ls_app_scene_open(LsAppScene* scene, const char* path, const char* device_name,
                           bool measures, LsError* error);
void ls_app_scene_close(LsAppScene* scene); // a zero scene is allowed

#endif
