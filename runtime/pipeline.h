// pipeline.h - the embedded kernel as compute pipelines.

#ifndef LS_PIPELINE_H
#define LS_PIPELINE_H

#include "context.h"

// Rays per work group: one warp on the widest hardware in use; a CPU device likes it as well.
#define LS_TRACE_GROUP_SIZE 32u

// Fills context->trace_shader and trace_layout. On failure both are null. Errors: DEVICE_MEMORY,
// DEVICE, MEMORY.
LsResult ls_trace_shader_create(LsContext* context, LsError* error);
void ls_trace_shader_destroy(LsContext* context);

// Compiles the kernel for files with these required features: what they do not use is not in it. On
// failure *pipeline is null. Errors: DEVICE_MEMORY, DEVICE, MEMORY.
LsResult ls_trace_pipeline_create(const LsContext* context, uint64_t features, LsMethod method,
                                  VkPipeline* pipeline, LsError* error);

#endif
