// context.h - the borrowed device: its functions, its memory types and its limits, looked up once.

#ifndef LS_CONTEXT_H
#define LS_CONTEXT_H

#include "ls_runtime.h"

// Every Vulkan function that the library calls on a device, without the prefix vk.
#define LS_DEVICE_FUNCTION_LIST(X) \
    X(AllocateCommandBuffers)      \
    X(AllocateDescriptorSets)      \
    X(AllocateMemory)              \
    X(BeginCommandBuffer)          \
    X(BindBufferMemory)            \
    X(CmdBindDescriptorSets)       \
    X(CmdBindPipeline)             \
    X(CmdCopyBuffer)               \
    X(CmdDispatch)                 \
    X(CmdPipelineBarrier)          \
    X(CmdPushConstants)            \
    X(CreateBuffer)                \
    X(CreateBufferView)            \
    X(CreateCommandPool)           \
    X(CreateComputePipelines)      \
    X(CreateDescriptorPool)        \
    X(CreateDescriptorSetLayout)   \
    X(CreateFence)                 \
    X(CreatePipelineLayout)        \
    X(CreateShaderModule)          \
    X(DestroyBuffer)               \
    X(DestroyBufferView)           \
    X(DestroyCommandPool)          \
    X(DestroyDescriptorPool)       \
    X(DestroyDescriptorSetLayout)  \
    X(DestroyFence)                \
    X(DestroyPipeline)             \
    X(DestroyPipelineLayout)       \
    X(DestroyShaderModule)         \
    X(EndCommandBuffer)            \
    X(FreeMemory)                  \
    X(GetBufferDeviceAddress)      \
    X(GetBufferMemoryRequirements) \
    X(MapMemory)                   \
    X(QueueSubmit)                 \
    X(QueueWaitIdle)               \
    X(ResetFences)                 \
    X(UpdateDescriptorSets)        \
    X(WaitForFences)

typedef struct LsDeviceFunctions
{
#define LS_DEVICE_FUNCTION_FIELD(name) PFN_vk##name name;
    LS_DEVICE_FUNCTION_LIST(LS_DEVICE_FUNCTION_FIELD)
#undef LS_DEVICE_FUNCTION_FIELD
} LsDeviceFunctions;

struct LsContext
{
    VkDevice device;
    VkQueue queue;
    uint32_t queue_family;
    LsDeviceFunctions vk;
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize max_buffer_bytes; // largest buffer with memory of its own
    uint32_t segment_log2;         // of the bytes of a segment of a cut array
    uint32_t max_group_count;      // work groups of one dispatch
    uint64_t max_loop_rounds;      // of one shader invocation, all loops together
    uint32_t shared_lanes;         // of a subgroup, if lanes can share work: 4, 8, 16 or 32; else 0
    bool is_cpu;                   // software
    uint32_t max_texels;           // of a texel buffer, if these are the faster way to read; else 0
    bool measures;                 // LsContextDesc
    bool unified;                  // all memory is near the device and the host maps it
};

// Fills `error` for a failed Vulkan call ("vkQueueSubmit") and returns what `code` stands for:
// DEVICE_MEMORY, MEMORY, DEVICE_LOST or DEVICE. VK_SUCCESS gives OK and leaves `error` alone.
LsResult ls_vulkan_result(VkResult code, const char* call, LsError* error);

#endif
