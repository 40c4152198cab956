// pipeline.c - shader modules to pipelines, specialized by method and features.

#include "pipeline.h"

#include "trace_grid_spv.h"
#include "trace_lists_spv.h"
#include "trace_lockstep_spv.h"
#include "trace_spv.h"
#include "trace_texels_spv.h"

// The method, the features in bit order, then those that have ids of their own.
enum
{
    METHOD,
    FIRST_FEATURE,
    GROUP_SIZE = FIRST_FEATURE + LS_FEATURE_COUNT,
    DEFERS,
    REFILL,
    SEGMENT_LOG2,
    LANE_RAYS,
    CONSTANT_COUNT
};

static const uint32_t CONSTANT_IDS[CONSTANT_COUNT] = {
    [GROUP_SIZE] = LS_CONSTANT_GROUP_SIZE, [DEFERS] = LS_CONSTANT_DEFERS,
    [REFILL] = LS_CONSTANT_REFILL,         [SEGMENT_LOG2] = LS_CONSTANT_SEGMENT_LOG2,
    [LANE_RAYS] = LS_CONSTANT_LANE_RAYS,
};
static_assert(GROUP_SIZE <= LS_CONSTANT_GROUP_SIZE, "features run into the next constant");

// A kernel's SPIR-V and what it is specialized to.
typedef struct KernelDesc
{
    const uint32_t* code;
    size_t code_bytes;
    uint32_t constants[CONSTANT_COUNT];
} KernelDesc;

static LsResult create_layout(const LsContext* context, const LsTraceKernelDesc* scene,
                              VkPipelineLayout* layout, LsError* error)
{
    VkPushConstantRange push = {
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        .size = sizeof(LsTraceParams),
    };
    static_assert(sizeof(LsListParams) <= sizeof(LsTraceParams) &&
                      sizeof(LsGridParams) <= sizeof(LsTraceParams) &&
                      sizeof(LsLockstepParams) <= sizeof(LsTraceParams),
                  "one layout serves all kernels");
    VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = scene->texel_layout != VK_NULL_HANDLE,
        .pSetLayouts = &scene->texel_layout,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &push,
    };
    VkResult code = context->vk.CreatePipelineLayout(context->device, &info, NULL, layout);
    if (code != VK_SUCCESS)
    {
        *layout = VK_NULL_HANDLE;
    }
    return ls_vulkan_result(code, "vkCreatePipelineLayout", error);
}

static LsResult create_pipeline(const LsContext* context, const KernelDesc* desc,
                                VkPipelineLayout layout, VkPipeline* pipeline, LsError* error)
{
    VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = desc->code_bytes,
        .pCode = desc->code,
    };
    VkShaderModule module;
    VkResult code = context->vk.CreateShaderModule(context->device, &module_info, NULL, &module);
    if (code != VK_SUCCESS)
    {
        return ls_vulkan_result(code, "vkCreateShaderModule", error);
    }
    VkSpecializationMapEntry entries[CONSTANT_COUNT];
    for (uint32_t i = 0; i < CONSTANT_COUNT; i++)
    {
        entries[i] = (VkSpecializationMapEntry){
            .constantID = i < GROUP_SIZE ? i : CONSTANT_IDS[i],
            .offset = i * (uint32_t)sizeof(uint32_t),
            .size = sizeof(uint32_t),
        };
    }
    VkSpecializationInfo specialization = {
        .mapEntryCount = CONSTANT_COUNT,
        .pMapEntries = entries,
        .dataSize = sizeof(desc->constants),
        .pData = desc->constants,
    };
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage =
            {
                .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module,
                .pName = "main",
                .pSpecializationInfo = &specialization,
            },
        .layout = layout,
    };
    code = context->vk.CreateComputePipelines(context->device, VK_NULL_HANDLE, 1, &info, NULL,
                                              pipeline);
    context->vk.DestroyShaderModule(context->device, module, NULL);
    if (code != VK_SUCCESS)
    {
        *pipeline = VK_NULL_HANDLE;
    }
    return ls_vulkan_result(code, "vkCreateComputePipelines", error);
}

static KernelDesc describe(const LsContext* context, const uint32_t* code, size_t code_bytes,
                           const LsTraceKernelDesc* scene, LsMethod method, uint32_t group_size)
{
    KernelDesc desc = {.code = code, .code_bytes = code_bytes};
    desc.constants[METHOD] = method;
    for (uint32_t i = FIRST_FEATURE; i < GROUP_SIZE; i++)
    {
        desc.constants[i] = (uint32_t)(scene->features >> (i - FIRST_FEATURE) & 1u);
    }
    desc.constants[GROUP_SIZE] = group_size;
    // The loops of lanes that refill would be too long where loops are bounded.
    desc.constants[REFILL] = context->max_loop_rounds == UINT64_MAX;
    desc.constants[SEGMENT_LOG2] = scene->segment_log2;
    desc.constants[DEFERS] = !context->is_cpu;
    desc.constants[LANE_RAYS] = scene->lane_rays;
    return desc;
}

static LsResult create_passes(const LsContext* context, const LsTraceKernelDesc* scene,
                              LsTraceKernel* kernel, LsError* error)
{
    const KernelDesc lists = describe(context, trace_lists_spv, sizeof(trace_lists_spv), scene,
                                      LS_TRACE_EXACT, context->shared_lanes);
    const LsResult result = create_pipeline(context, &lists, kernel->layout, &kernel->lists, error);
    if (result != LS_OK)
    {
        return result;
    }
    const KernelDesc grid = describe(context, trace_grid_spv, sizeof(trace_grid_spv), scene,
                                     LS_TRACE_EXACT, context->shared_lanes);
    return create_pipeline(context, &grid, kernel->layout, &kernel->grid, error);
}

static LsResult create_whole(const LsContext* context, const LsTraceKernelDesc* scene,
                             LsMethod method, LsTraceKernel* kernel, LsError* error)
{
    const bool has_texels = scene->texel_layout != VK_NULL_HANDLE;
    const KernelDesc desc = describe(context, has_texels ? trace_texels_spv : trace_spv,
                                     has_texels ? sizeof(trace_texels_spv) : sizeof(trace_spv),
                                     scene, method, LS_TRACE_GROUP_SIZE);
    return create_pipeline(context, &desc, kernel->layout, &kernel->whole[method], error);
}

LsResult ls_trace_kernel_create(const LsContext* context, const LsTraceKernelDesc* scene,
                                LsTraceKernel* kernel, LsError* error)
{
    *kernel = (LsTraceKernel){0};
    LsResult result = create_layout(context, scene, &kernel->layout, error);
    // All methods now rather than at their first use, which may be on any thread.
    const uint32_t method_count = context->measures ? LS_TRACE_METHOD_COUNT : LS_TRACE_GRID;
    for (uint32_t method = 0; method < method_count && result == LS_OK; method++)
    {
        result = create_whole(context, scene, (LsMethod)method, kernel, error);
    }
    if (result == LS_OK && scene->lane_rays != 0)
    {
        const KernelDesc desc = describe(context, trace_lockstep_spv, sizeof(trace_lockstep_spv),
                                         scene, LS_TRACE_EXACT, context->shared_lanes);
        result = create_pipeline(context, &desc, kernel->layout, &kernel->lockstep, error);
    }
    if (result == LS_OK && scene->has_passes)
    {
        result = create_passes(context, scene, kernel, error);
    }
    if (result != LS_OK)
    {
        ls_trace_kernel_destroy(context, kernel);
    }
    return result;
}

void ls_trace_kernel_destroy(const LsContext* context, LsTraceKernel* kernel)
{
    for (uint32_t method = 0; method < LS_TRACE_METHOD_COUNT; method++)
    {
        context->vk.DestroyPipeline(context->device, kernel->whole[method], NULL);
    }
    context->vk.DestroyPipeline(context->device, kernel->lockstep, NULL);
    context->vk.DestroyPipeline(context->device, kernel->lists, NULL);
    context->vk.DestroyPipeline(context->device, kernel->grid, NULL);
    context->vk.DestroyPipelineLayout(context->device, kernel->layout, NULL);
    *kernel = (LsTraceKernel){0};
}
