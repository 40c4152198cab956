// pipeline.c - shader module to pipelines, specialized by method and features.

#include "pipeline.h"

#include "trace_spv.h"

static LsResult create_module(const LsContext* context, VkShaderModule* module, LsError* error)
{
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = sizeof(trace_spv),
        .pCode = trace_spv,
    };
    VkResult code = context->vk.CreateShaderModule(context->device, &info, NULL, module);
    return ls_vulkan_result(code, "vkCreateShaderModule", error);
}

static LsResult create_layout(const LsContext* context, VkPipelineLayout* layout, LsError* error)
{
    VkPushConstantRange push = {
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        .size = sizeof(LsTraceParams),
    };
    VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
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

static LsResult create_pipeline(const LsContext* context, VkShaderModule module,
                                VkPipelineLayout layout, uint64_t features, LsMethod method,
                                VkPipeline* pipeline, LsError* error)
{
    // By constant id: the method, one per feature bit in order, the work group's size.
    enum
    {
        METHOD,
        FIRST_FEATURE,
        GROUP_SIZE = 7,
        COUNT
    };
    uint32_t values[COUNT];
    VkSpecializationMapEntry entries[COUNT];
    values[METHOD] = method;
    for (uint32_t i = FIRST_FEATURE; i < GROUP_SIZE; i++)
    {
        values[i] = (uint32_t)(features >> (i - FIRST_FEATURE) & 1u);
    }
    values[GROUP_SIZE] = LS_TRACE_GROUP_SIZE;
    for (uint32_t i = 0; i < COUNT; i++)
    {
        entries[i] =
            (VkSpecializationMapEntry){i, i * (uint32_t)sizeof(uint32_t), sizeof(uint32_t)};
    }
    VkSpecializationInfo specialization = {
        .mapEntryCount = COUNT,
        .pMapEntries = entries,
        .dataSize = sizeof(values),
        .pData = values,
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
    VkResult code = context->vk.CreateComputePipelines(context->device, VK_NULL_HANDLE, 1, &info,
                                                       NULL, pipeline);
    if (code != VK_SUCCESS)
    {
        *pipeline = VK_NULL_HANDLE;
        return ls_vulkan_result(code, "vkCreateComputePipelines", error);
    }
    return LS_OK;
}

LsResult ls_trace_kernel_create(const LsContext* context, uint64_t features, LsTraceKernel* kernel,
                                LsError* error)
{
    *kernel = (LsTraceKernel){0};
    VkShaderModule module;
    LsResult result = create_module(context, &module, error);
    if (result != LS_OK)
    {
        return result;
    }
    result = create_layout(context, &kernel->layout, error);
    // Both methods now rather than at their first use, which may be on any thread.
    for (LsMethod method = LS_TRACE_EXACT; method <= LS_TRACE_BRUTE && result == LS_OK; method++)
    {
        result = create_pipeline(context, module, kernel->layout, features, method,
                                 &kernel->pipelines[method], error);
    }
    context->vk.DestroyShaderModule(context->device, module, NULL);
    if (result != LS_OK)
    {
        ls_trace_kernel_destroy(context, kernel);
    }
    return result;
}

void ls_trace_kernel_destroy(const LsContext* context, LsTraceKernel* kernel)
{
    for (LsMethod method = LS_TRACE_EXACT; method <= LS_TRACE_BRUTE; method++)
    {
        context->vk.DestroyPipeline(context->device, kernel->pipelines[method], NULL);
    }
    context->vk.DestroyPipelineLayout(context->device, kernel->layout, NULL);
    *kernel = (LsTraceKernel){0};
}
