#include "texels.h"

static LsResult create_layout(const LsContext* context, LsTexels* texels, LsError* error)
{
    VkDescriptorSetLayoutBinding bindings[LS_TEXEL_ARRAY_COUNT];
    for (uint32_t i = 0; i < LS_TEXEL_ARRAY_COUNT; i++)
    {
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    }
    const VkDescriptorSetLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = LS_TEXEL_ARRAY_COUNT,
        .pBindings = bindings,
    };
    const VkResult code =
        context->vk.CreateDescriptorSetLayout(context->device, &info, NULL, &texels->layout);
    if (code != VK_SUCCESS)
    {
        texels->layout = VK_NULL_HANDLE; // after a failure Vulkan leaves handles undefined
    }
    return ls_vulkan_result(code, "vkCreateDescriptorSetLayout", error);
}

static LsResult create_set(const LsContext* context, LsTexels* texels, LsError* error)
{
    const VkDescriptorPoolSize size = {
        .type = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
        .descriptorCount = LS_TEXEL_ARRAY_COUNT,
    };
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1,
        .poolSizeCount = 1,
        .pPoolSizes = &size,
    };
    VkResult code = context->vk.CreateDescriptorPool(context->device, &pool, NULL, &texels->pool);
    if (code != VK_SUCCESS)
    {
        texels->pool = VK_NULL_HANDLE;
        return ls_vulkan_result(code, "vkCreateDescriptorPool", error);
    }
    const VkDescriptorSetAllocateInfo set = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = texels->pool,
        .descriptorSetCount = 1,
        .pSetLayouts = &texels->layout,
    };
    code = context->vk.AllocateDescriptorSets(context->device, &set, &texels->set);
    return ls_vulkan_result(code, "vkAllocateDescriptorSets", error);
}

static LsResult create_views(const LsContext* context,
                             const LsTexelArray arrays[LS_TEXEL_ARRAY_COUNT], LsTexels* texels,
                             LsError* error)
{
    VkWriteDescriptorSet writes[LS_TEXEL_ARRAY_COUNT];
    for (uint32_t i = 0; i < LS_TEXEL_ARRAY_COUNT; i++)
    {
        writes[i] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = texels->set,
            .dstBinding = i,
            .descriptorCount = 1,
            .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
            // What is absent is never read, but bound it must be.
            .pTexelBufferView = &texels->views[arrays[i].buffer ? i : 0],
        };
        if (!arrays[i].buffer)
        {
            continue;
        }
        const VkBufferViewCreateInfo info = {
            .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
            .buffer = arrays[i].buffer->handle,
            .format = arrays[i].is_words ? VK_FORMAT_R32_UINT : VK_FORMAT_R32G32B32A32_UINT,
            .range = VK_WHOLE_SIZE,
        };
        const VkResult code =
            context->vk.CreateBufferView(context->device, &info, NULL, &texels->views[i]);
        if (code != VK_SUCCESS)
        {
            texels->views[i] = VK_NULL_HANDLE;
            return ls_vulkan_result(code, "vkCreateBufferView", error);
        }
    }
    context->vk.UpdateDescriptorSets(context->device, LS_TEXEL_ARRAY_COUNT, writes, 0, NULL);
    return LS_OK;
}

LsResult ls_texels_create(const LsContext* context, const LsTexelArray arrays[LS_TEXEL_ARRAY_COUNT],
                          LsTexels* texels, LsError* error)
{
    *texels = (LsTexels){0};
    LsResult result = create_layout(context, texels, error);
    if (result == LS_OK)
    {
        result = create_set(context, texels, error);
    }
    if (result == LS_OK)
    {
        result = create_views(context, arrays, texels, error);
    }
    if (result != LS_OK)
    {
        ls_texels_destroy(context, texels);
    }
    return result;
}

void ls_texels_destroy(const LsContext* context, LsTexels* texels)
{
    context->vk.DestroyDescriptorPool(context->device, texels->pool, NULL);
    context->vk.DestroyDescriptorSetLayout(context->device, texels->layout, NULL);
    for (uint32_t i = 0; i < LS_TEXEL_ARRAY_COUNT; i++)
    {
        context->vk.DestroyBufferView(context->device, texels->views[i], NULL);
    }
    *texels = (LsTexels){0};
}
