// pipeline.h - the embedded kernels as compute pipelines.

#ifndef LS_PIPELINE_H
#define LS_PIPELINE_H

#include "context.h"

// Rays per work group of the kernel that does all at once: one warp on the widest hardware in use;
// a CPU device likes it as well.
#define LS_TRACE_GROUP_SIZE 32u

#define LS_TRACE_METHOD_COUNT 4u // of LsMethod

// The kernels for the files of one set of features. All take push constants of 128 bytes.
typedef struct LsTraceKernel
{
    VkPipelineLayout layout;
    VkPipeline whole[LS_TRACE_METHOD_COUNT]; // by LsMethod: a ray a thread, LsTraceParams
    VkPipeline lockstep; // LsLockstepParams, in groups of context->shared_lanes; or null
    // Two passes for scenes with one grid, where the device can; else null. First LsListParams,
    // then LsGridParams, both in groups of context->shared_lanes.
    VkPipeline lists;
    VkPipeline grid;
} LsTraceKernel;

// What the kernels are compiled for: what scenes do not use is not in them.
typedef struct LsTraceKernelDesc
{
    uint64_t features;                  // required ones of the file
    uint32_t segment_log2;              // of the scene: 0 if no array is cut
    bool has_passes;                    // the kernels of two passes as well
    uint32_t lane_rays;                 // of the kernel in lockstep; 0: without it
    VkDescriptorSetLayout texel_layout; // of LsTexels, which all but two passes read; or null
} LsTraceKernelDesc;

// On failure all of it is null. Errors: DEVICE_MEMORY, DEVICE_LOST, DEVICE, MEMORY.
LsResult ls_trace_kernel_create(const LsContext* context, const LsTraceKernelDesc* scene,
                                LsTraceKernel* kernel, LsError* error);
void ls_trace_kernel_destroy(const LsContext* context, LsTraceKernel* kernel);

#endif
