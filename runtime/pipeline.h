// pipeline.h - the embedded kernel as compute pipelines.

#ifndef LS_PIPELINE_H
#define LS_PIPELINE_H

#include "context.h"

// Rays per work group: one warp on the widest hardware in use; a CPU device likes it as well.
#define LS_TRACE_GROUP_SIZE 32u

// The kernel for the files of one set of features.
typedef struct LsTraceKernel
{
    VkPipelineLayout layout;
    VkPipeline pipelines[2]; // by LsMethod
} LsTraceKernel;

// Compiles the kernel for files with these required features: what they do not use is not in it. On
// failure all of it is null. Errors: DEVICE_MEMORY, DEVICE_LOST, DEVICE, MEMORY.
LsResult ls_trace_kernel_create(const LsContext* context, uint64_t features, LsTraceKernel* kernel,
                                LsError* error);
void ls_trace_kernel_destroy(const LsContext* context, LsTraceKernel* kernel);

#endif
