#include "app_scene.h"

LsResult ls_app_scene_open(LsAppScene* scene, const char* path, const char* device_name,
                           bool measures, LsError* error)
{
    *scene = (LsAppScene){0};
    LsResult result = ls_mapping_open(&scene->mapping, path, error);
    if (result == LS_OK)
    {
        result = ls_file_open(&scene->file, scene->mapping.bytes, scene->mapping.size, path, error);
    }
    if (result == LS_OK)
    {
        const LsAppDeviceDesc desc = {.device_name = device_name};
        result = ls_app_device_create(&scene->device, &desc, error);
    }
    if (result == LS_OK)
    {
        LsContextDesc desc = ls_app_context_desc(&scene->device);
        desc.measures = measures;
        result = ls_context_create(&desc, &scene->context, error);
    }
    return result == LS_OK
               ? ls_scene_create(scene->context, &scene->file, path, &scene->scene, error)
               : result;
}

void ls_app_scene_close(LsAppScene* scene)
{
    ls_scene_destroy(scene->scene);
    ls_context_destroy(scene->context);
    ls_app_device_destroy(&scene->device);
    ls_mapping_close(&scene->mapping);
    *scene = (LsAppScene){0};
}
