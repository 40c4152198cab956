#include "buffer.h"

static const double MIB = 1024.0 * 1024.0;

// The first type among `allowed` with all of `required`, if possible with all of `preferred`;
// UINT32_MAX if there is none. Vulkan lists better types first.
static uint32_t find_memory_type(const VkPhysicalDeviceMemoryProperties* memory, uint32_t allowed,
                                 VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred)
{
    uint32_t found = UINT32_MAX;
    for (uint32_t i = memory->memoryTypeCount; i-- > 0;)
    {
        VkMemoryPropertyFlags flags = memory->memoryTypes[i].propertyFlags;
        if ((allowed >> i & 1u) && (flags & required) == required)
        {
            bool better = (flags & preferred) == preferred;
            bool found_better = found != UINT32_MAX &&
                                (memory->memoryTypes[found].propertyFlags & preferred) == preferred;
            found = better || !found_better ? i : found;
        }
    }
    return found;
}

static LsResult allocate_memory(const LsContext* context, LsBufferKind kind, const char* name,
                                const char* what, LsBuffer* buffer, LsError* error)
{
    const VkMemoryPropertyFlags mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    bool map = kind == LS_BUFFER_STAGING || context->unified;
    VkMemoryRequirements needs;
    context->vk.GetBufferMemoryRequirements(context->device, buffer->handle, &needs);
    uint32_t type =
        kind == LS_BUFFER_STAGING
            ? find_memory_type(&context->memory, needs.memoryTypeBits, mapped, mapped)
            : find_memory_type(&context->memory, needs.memoryTypeBits,
                               VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | (map ? mapped : 0), 0);
    if (type == UINT32_MAX)
    {
        return ls_error_set(
            error, LS_MESSAGE_DEVICE_MEMORY_KIND,
            "%s: the device has no kind of memory fit for %s: choose another device", name, what);
    }
    VkMemoryAllocateFlagsInfo flags = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
        .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT,
    };
    VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .pNext = kind == LS_BUFFER_SCENE ? &flags : NULL,
        .allocationSize = needs.size,
        .memoryTypeIndex = type,
    };
    VkResult code = context->vk.AllocateMemory(context->device, &info, NULL, &buffer->memory);
    if (code == VK_ERROR_OUT_OF_DEVICE_MEMORY)
    {
        buffer->memory = VK_NULL_HANDLE;
        return ls_error_set(
            error, LS_MESSAGE_DEVICE_MEMORY_FULL,
            "%s: vkAllocateMemory found no %.1f MiB of device memory for %s: close other programs "
            "that use the GPU, or bake with a smaller --grid or --patches",
            name, (double)needs.size / MIB, what);
    }
    if (code != VK_SUCCESS)
    {
        buffer->memory = VK_NULL_HANDLE;
        return ls_vulkan_result(code, "vkAllocateMemory", error);
    }
    code = context->vk.BindBufferMemory(context->device, buffer->handle, buffer->memory, 0);
    if (code != VK_SUCCESS)
    {
        return ls_vulkan_result(code, "vkBindBufferMemory", error);
    }
    if (map)
    {
        code = context->vk.MapMemory(context->device, buffer->memory, 0, VK_WHOLE_SIZE, 0,
                                     &buffer->mapped);
    }
    return ls_vulkan_result(code, "vkMapMemory", error);
}

static LsResult fill_buffer(const LsContext* context, LsBufferKind kind, const char* name,
                            const char* what, LsBuffer* buffer, LsError* error)
{
    const VkBufferUsageFlags texels =
        context->max_texels != 0 ? VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT : 0;
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = buffer->bytes,
        .usage = kind == LS_BUFFER_STAGING
                     ? VK_BUFFER_USAGE_TRANSFER_SRC_BIT
                     : VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                           VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | texels,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
    };
    VkResult code = context->vk.CreateBuffer(context->device, &info, NULL, &buffer->handle);
    if (code != VK_SUCCESS)
    {
        buffer->handle = VK_NULL_HANDLE; // after a failure Vulkan leaves handles undefined
        return ls_vulkan_result(code, "vkCreateBuffer", error);
    }
    LsResult result = allocate_memory(context, kind, name, what, buffer, error);
    if (result == LS_OK && kind == LS_BUFFER_SCENE)
    {
        VkBufferDeviceAddressInfo address = {
            .sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
            .buffer = buffer->handle,
        };
        buffer->address = context->vk.GetBufferDeviceAddress(context->device, &address);
    }
    return result;
}

LsResult ls_buffer_create(const LsContext* context, LsBufferKind kind, VkDeviceSize bytes,
                          const char* name, const char* what, LsBuffer* buffer, LsError* error)
{
    *buffer = (LsBuffer){.bytes = bytes};
    LsResult result;
    if (bytes > context->max_buffer_bytes)
    {
        result =
            ls_error_set(error, LS_MESSAGE_DEVICE_BUFFER_LIMIT,
                         "%s: %s takes %.1f MiB, but the device's largest buffer is %.1f MiB: bake "
                         "fewer objects, "
                         "instances and lights into a file",
                         name, what, (double)bytes / MIB, (double)context->max_buffer_bytes / MIB);
    }
    else
    {
        result = fill_buffer(context, kind, name, what, buffer, error);
    }
    if (result != LS_OK)
    {
        ls_buffer_destroy(context, buffer);
    }
    return result;
}

void ls_buffer_destroy(const LsContext* context, LsBuffer* buffer)
{
    // Freeing memory unmaps it.
    context->vk.DestroyBuffer(context->device, buffer->handle, NULL);
    context->vk.FreeMemory(context->device, buffer->memory, NULL);
    *buffer = (LsBuffer){0};
}
