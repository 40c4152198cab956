#include "upload.h"

#include <string.h>

LsResult ls_upload_begin(LsUpload* upload, const LsContext* context, VkDeviceSize largest_bytes,
                         const char* name, LsError* error)
{
    *upload = (LsUpload){.context = context};
    if (context->unified)
    {
        return LS_OK;
    }
    upload->slot_bytes =
        largest_bytes < LS_UPLOAD_SLOT_BYTES ? largest_bytes : LS_UPLOAD_SLOT_BYTES;
    LsResult result =
        ls_buffer_create(context, LS_BUFFER_STAGING, upload->slot_bytes * LS_UPLOAD_SLOTS, name,
                         "the staging ring", &upload->staging, error);
    if (result != LS_OK)
    {
        return result;
    }

    VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags =
            VK_COMMAND_POOL_CREATE_TRANSIENT_BIT | VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
        .queueFamilyIndex = context->queue_family,
    };
    VkResult code = context->vk.CreateCommandPool(context->device, &pool, NULL, &upload->pool);
    if (code != VK_SUCCESS)
    {
        upload->pool = VK_NULL_HANDLE;
        return ls_vulkan_result(code, "vkCreateCommandPool", error);
    }
    VkCommandBufferAllocateInfo commands = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = upload->pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = LS_UPLOAD_SLOTS,
    };
    code = context->vk.AllocateCommandBuffers(context->device, &commands, upload->commands);
    if (code != VK_SUCCESS)
    {
        return ls_vulkan_result(code, "vkAllocateCommandBuffers", error);
    }
    for (uint32_t i = 0; i < LS_UPLOAD_SLOTS; i++)
    {
        VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        code = context->vk.CreateFence(context->device, &fence, NULL, &upload->fences[i]);
        if (code != VK_SUCCESS)
        {
            upload->fences[i] = VK_NULL_HANDLE;
            return ls_vulkan_result(code, "vkCreateFence", error);
        }
    }
    return LS_OK;
}

static LsResult wait_slot(LsUpload* upload, uint32_t slot, LsError* error)
{
    if (!upload->busy[slot])
    {
        return LS_OK;
    }
    const LsContext* context = upload->context;
    VkResult code =
        context->vk.WaitForFences(context->device, 1, &upload->fences[slot], VK_TRUE, UINT64_MAX);
    if (code != VK_SUCCESS)
    {
        return ls_vulkan_result(code, "vkWaitForFences", error);
    }
    upload->busy[slot] = false;
    return ls_vulkan_result(context->vk.ResetFences(context->device, 1, &upload->fences[slot]),
                            "vkResetFences", error);
}

// Submits the copy of one slot's `bytes` to `target` at `offset`.
static LsResult submit_slot(LsUpload* upload, uint32_t slot, const LsBuffer* target,
                            VkDeviceSize offset, VkDeviceSize bytes, LsError* error)
{
    const LsContext* context = upload->context;
    VkCommandBuffer commands = upload->commands[slot];
    VkCommandBufferBeginInfo begin = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    VkResult code = context->vk.BeginCommandBuffer(commands, &begin);
    if (code != VK_SUCCESS)
    {
        return ls_vulkan_result(code, "vkBeginCommandBuffer", error);
    }
    VkBufferCopy copy = {
        .srcOffset = slot * upload->slot_bytes, .dstOffset = offset, .size = bytes};
    context->vk.CmdCopyBuffer(commands, upload->staging.handle, target->handle, 1, &copy);
    VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_SHADER_READ_BIT,
    };
    context->vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                   VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1, &barrier, 0, NULL, 0,
                                   NULL);
    code = context->vk.EndCommandBuffer(commands);
    if (code != VK_SUCCESS)
    {
        return ls_vulkan_result(code, "vkEndCommandBuffer", error);
    }
    VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = 1,
        .pCommandBuffers = &commands,
    };
    code = context->vk.QueueSubmit(context->queue, 1, &submit, upload->fences[slot]);
    upload->busy[slot] = code == VK_SUCCESS;
    return ls_vulkan_result(code, "vkQueueSubmit", error);
}

LsResult ls_upload_copy(LsUpload* upload, const LsBuffer* buffer, const void* bytes,
                        VkDeviceSize size, LsError* error)
{
    if (buffer->mapped)
    {
        memcpy(buffer->mapped, bytes, size);
        return LS_OK;
    }
    for (VkDeviceSize offset = 0; offset < size; offset += upload->slot_bytes)
    {
        VkDeviceSize piece =
            size - offset < upload->slot_bytes ? size - offset : upload->slot_bytes;
        uint32_t slot = upload->next;
        upload->next = (slot + 1) % LS_UPLOAD_SLOTS;
        LsResult result = wait_slot(upload, slot, error);
        if (result != LS_OK)
        {
            return result;
        }
        memcpy((uint8_t*)upload->staging.mapped + slot * upload->slot_bytes,
               (const uint8_t*)bytes + offset, piece);
        result = submit_slot(upload, slot, buffer, offset, piece, error);
        if (result != LS_OK)
        {
            return result;
        }
    }
    return LS_OK;
}

LsResult ls_upload_end(LsUpload* upload, LsError* error)
{
    const LsContext* context = upload->context;
    LsResult result = LS_OK;
    for (uint32_t i = 0; i < LS_UPLOAD_SLOTS; i++)
    {
        LsResult waited = wait_slot(upload, i, result == LS_OK ? error : NULL);
        result = result == LS_OK ? waited : result;
    }
    if (result != LS_OK)
    {
        // A wait that failed proves nothing, and what the device still uses must not be destroyed.
        context->vk.QueueWaitIdle(context->queue);
    }
    for (uint32_t i = 0; i < LS_UPLOAD_SLOTS; i++)
    {
        context->vk.DestroyFence(context->device, upload->fences[i], NULL);
    }
    context->vk.DestroyCommandPool(context->device, upload->pool, NULL);
    ls_buffer_destroy(context, &upload->staging);
    *upload = (LsUpload){0};
    return result;
}
