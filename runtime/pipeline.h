// pipeline.h - the embedded kernels as compute pipelines.

#ifndef LS_PIPELINE_H
#define LS_PIPELINE_H

#include "context.h"

// Rays per work group of the kernel that does all at once: one warp on the widest hardware in use; a CPU
// device likes it as well.
#define LS_TRACE_GROUP_SIZE 32u
// Of the first of two passes, whose rays do not wait for each other.
#define LS_LISTS_GROUP_SIZE 128u

#define LS_TRACE_METHOD_COUNT 4u // of LsMethod

// The kernels for the files of one set of features. All take push constants of 128 bytes.
typedef struct LsTraceKernel
{
    VkPipelineLayout layout;
    VkPipeline whole[LS_TRACE_METHOD_COUNT]; // by LsMethod: a ray a thread, LsTraceParams
    // Two passes for scenes with one grid, where the device can; else null. First LsListParams, then
    // LsGridParams in groups of context->shared_lanes.
    VkPipeline lists;
    VkPipeline grid[2]; // by whether lanes whose ray has ended take another
} LsTraceKernel;

// Compiles the kernels for files with these required features: what they do not use is not in them.
// `has_passes`: those of two passes as well. On failure all of it is null. Errors: DEVICE_MEMORY,
// DEVICE_LOST, DEVICE, MEMORY.
LsResult ls_trace_kernel_create(const LsContext* context, uint64_t features, bool has_passes,
                                LsTraceKernel* kernel, LsError* error);
void ls_trace_kernel_destroy(const LsContext* context, LsTraceKernel* kernel);

#endif
