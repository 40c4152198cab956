// consumer_trace.c - links all of the runtime, and creates nothing: what a program needs that has no device.
#include "ls_runtime.h"

#include <stdio.h>

// What a program with a device would go through; called through a pointer that compilers cannot see through.
static LsResult trace(const LsContextDesc* desc, const LsFile* file, VkCommandBuffer commands,
                      const LsTraceDesc* batch)
{
    LsContext* context = NULL;
    LsScene* scene = NULL;
    LsResult result = ls_context_create(desc, &context, NULL);
    if (result == LS_OK)
    {
        result = ls_scene_create(context, file, "scene.lspace", &scene, NULL);
    }
    if (result == LS_OK)
    {
        result = ls_trace_record(scene, commands, batch, NULL);
    }
    ls_scene_destroy(scene);
    ls_context_destroy(context);
    return result;
}

int main(void)
{
    LsResult (*volatile linked)(const LsContextDesc*, const LsFile*, VkCommandBuffer,
                                const LsTraceDesc*) = trace;
    ls_scene_destroy(NULL);
    ls_context_destroy(NULL);
    puts(linked ? "linked" : "not linked");
    return ls_result_exit_code(LS_OK);
}
