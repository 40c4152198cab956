#include "pipeline.h"

#include "trace_spv.h"

LsResult ls_trace_shader_create(LsContext* context, LsError* error)
{
    VkShaderModuleCreateInfo module = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = sizeof(trace_spv),
        .pCode = trace_spv,
    };
    VkResult code =
        context->vk.CreateShaderModule(context->device, &module, NULL, &context->trace_shader);
    if (code != VK_SUCCESS)
    {
        context->trace_shader = VK_NULL_HANDLE;
        return ls_vulkan_result(code, "vkCreateShaderModule", error);
    }
    VkPushConstantRange push = {
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        .size = sizeof(LsTraceParams),
    };
    VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &push,
    };
    code = context->vk.CreatePipelineLayout(context->device, &layout, NULL, &context->trace_layout);
    if (code != VK_SUCCESS)
    {
        context->trace_layout = VK_NULL_HANDLE;
        ls_trace_shader_destroy(context);
        return ls_vulkan_result(code, "vkCreatePipelineLayout", error);
    }
    return LS_OK;
}

void ls_trace_shader_destroy(LsContext* context)
{
    context->vk.DestroyPipelineLayout(context->device, context->trace_layout, NULL);
    context->vk.DestroyShaderModule(context->device, context->trace_shader, NULL);
    context->trace_layout = VK_NULL_HANDLE;
    context->trace_shader = VK_NULL_HANDLE;
}

LsResult ls_trace_pipeline_create(const LsContext* context, uint64_t features, LsMethod method,
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
                .module = context->trace_shader,
                .pName = "main",
                .pSpecializationInfo = &specialization,
            },
        .layout = context->trace_layout,
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
