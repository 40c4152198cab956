#include "context.h"

#include <stdlib.h>

LsResult ls_vulkan_result(VkResult code, const char* call, LsError* error)
{
    switch (code)
    {
    case VK_SUCCESS:
        return LS_OK;
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return ls_error_set(
            error, LS_MESSAGE_DEVICE_MEMORY_FULL,
            "%s found too little device memory: close other programs that use the GPU, or "
            "bake with a smaller --grid or --patches",
            call);
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s found too little memory: close other programs", call);
    case VK_ERROR_DEVICE_LOST:
        return ls_error_set(
            error, LS_MESSAGE_DEVICE_LOST,
            "%s lost the device: its driver was reset, often because one call took too long; "
            "try again with fewer rays at a time",
            call);
    default:
        return ls_error_set(
            error, LS_MESSAGE_VULKAN_CALL,
            "%s failed with VkResult %d: update the driver or choose another device", call,
            (int)code);
    }
}

// Functions that are asked about the physical device, needed while a context is created only.
typedef struct InstanceFunctions
{
    PFN_vkGetPhysicalDeviceProperties2 GetPhysicalDeviceProperties2;
    PFN_vkGetPhysicalDeviceFeatures2 GetPhysicalDeviceFeatures2;
    PFN_vkGetPhysicalDeviceMemoryProperties GetPhysicalDeviceMemoryProperties;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties GetPhysicalDeviceQueueFamilyProperties;
    PFN_vkGetDeviceProcAddr GetDeviceProcAddr;
} InstanceFunctions;

static LsResult load_functions(const LsContextDesc* desc, InstanceFunctions* instance,
                               LsDeviceFunctions* device, LsError* error)
{
#define LOAD_INSTANCE_FUNCTION(name)                                                             \
    instance->name = (PFN_vk##name)desc->get_instance_proc_addr(desc->instance, "vk" #name);     \
    if (!instance->name)                                                                         \
    {                                                                                            \
        return ls_error_set(error, LS_MESSAGE_VULKAN_FUNCTION,                                   \
                            "the Vulkan instance has no vk" #name ": create it for Vulkan 1.2"); \
    }
    LOAD_INSTANCE_FUNCTION(GetPhysicalDeviceProperties2)
    LOAD_INSTANCE_FUNCTION(GetPhysicalDeviceFeatures2)
    LOAD_INSTANCE_FUNCTION(GetPhysicalDeviceMemoryProperties)
    LOAD_INSTANCE_FUNCTION(GetPhysicalDeviceQueueFamilyProperties)
    LOAD_INSTANCE_FUNCTION(GetDeviceProcAddr)
#undef LOAD_INSTANCE_FUNCTION

#define LOAD_DEVICE_FUNCTION(name)                                                      \
    device->name = (PFN_vk##name)instance->GetDeviceProcAddr(desc->device, "vk" #name); \
    if (!device->name)                                                                  \
    {                                                                                   \
        return ls_error_set(error, LS_MESSAGE_VULKAN_FUNCTION,                          \
                            "the Vulkan device has no vk" #name ": update its driver"); \
    }
    LS_DEVICE_FUNCTION_LIST(LOAD_DEVICE_FUNCTION)
#undef LOAD_DEVICE_FUNCTION
    return LS_OK;
}

static bool family_computes(const InstanceFunctions* vk, VkPhysicalDevice physical_device,
                            uint32_t family)
{
    VkQueueFamilyProperties families[64]; // more than any device has; Vulkan fills what fits
    uint32_t count = sizeof(families) / sizeof(families[0]);
    vk->GetPhysicalDeviceQueueFamilyProperties(physical_device, &count, families);
    return family < count && (families[family].queueFlags & VK_QUEUE_COMPUTE_BIT) != 0;
}

static bool memory_is_unified(const VkPhysicalDeviceMemoryProperties* memory)
{
    for (uint32_t i = 0; i < memory->memoryHeapCount; i++)
    {
        if (!(memory->memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT))
        {
            return false;
        }
    }
    const VkMemoryPropertyFlags near = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                       VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                       VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (uint32_t i = 0; i < memory->memoryTypeCount; i++)
    {
        if ((memory->memoryTypes[i].propertyFlags & near) == near)
        {
            return true;
        }
    }
    return false;
}

// Lanes of a subgroup, if the two-pass kernels can use it: 32 at most, since they keep a bit a lane
// in a word, and always as many, since they take a group of that size for one subgroup. Devices
// before Vulkan 1.3 do not say whether it is so; `sizes` is zero for them.
static uint32_t count_shared_lanes(const VkPhysicalDeviceSubgroupProperties* subgroups,
                                   const VkPhysicalDeviceSubgroupSizeControlProperties* sizes)
{
    const VkSubgroupFeatureFlags wanted =
        VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_VOTE_BIT |
        VK_SUBGROUP_FEATURE_ARITHMETIC_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT |
        VK_SUBGROUP_FEATURE_SHUFFLE_BIT;
    const uint32_t size = subgroups->subgroupSize;
    const bool is_able = (subgroups->supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
                         (subgroups->supportedOperations & wanted) == wanted &&
                         sizes->minSubgroupSize == size && sizes->maxSubgroupSize == size;
    return is_able && size >= 4 && size <= 32 && (size & (size - 1)) == 0 ? size : 0;
}

// Segments are at most 1 GiB, for shaders to compute offsets in 32 bits, and at least 1 KiB.
static uint32_t choose_segment(uint64_t wanted_bytes, uint64_t most_bytes)
{
    const uint64_t bytes =
        wanted_bytes != 0 && wanted_bytes < most_bytes ? wanted_bytes : most_bytes;
    uint32_t log2 = 30;
    while (log2 > 10 && UINT64_C(1) << log2 > bytes)
    {
        log2--;
    }
    return log2;
}

// Fills the facts of the device and refuses one that cannot run the kernel.
static LsResult inspect_device(const LsContextDesc* desc, const InstanceFunctions* vk,
                               LsContext* context, LsError* error)
{
    VkPhysicalDeviceSubgroupSizeControlProperties subgroup_sizes = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES,
    };
    VkPhysicalDeviceMaintenance4Properties buffers = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES,
        .pNext = &subgroup_sizes,
    };
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES,
    };
    VkPhysicalDeviceMaintenance3Properties allocations = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &allocations,
    };
    vk->GetPhysicalDeviceProperties2(desc->physical_device, &properties);
    const char* device_name = properties.properties.deviceName;
    uint32_t version = properties.properties.apiVersion;
    if (version < VK_API_VERSION_1_2)
    {
        return ls_error_set(error, LS_MESSAGE_DEVICE_VERSION,
                            "GPU %s has Vulkan %u.%u, but 1.2 is needed: update its driver",
                            device_name, VK_API_VERSION_MAJOR(version),
                            VK_API_VERSION_MINOR(version));
    }
    VkPhysicalDeviceSubgroupProperties subgroups = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
    };
    allocations.pNext = &driver;
    driver.pNext = &subgroups;
    subgroups.pNext = version >= VK_API_VERSION_1_3 ? &buffers : NULL;
    vk->GetPhysicalDeviceProperties2(desc->physical_device, &properties);
    context->max_buffer_bytes = allocations.maxMemoryAllocationSize;
    if (buffers.maxBufferSize != 0 && buffers.maxBufferSize < context->max_buffer_bytes)
    {
        context->max_buffer_bytes = buffers.maxBufferSize;
    }
    context->segment_log2 = choose_segment(desc->segment_bytes, context->max_buffer_bytes);
    // llvmpipe leaves loops after so many rounds without a word (Mesa 22.3: measured).
    const bool is_llvmpipe = driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE;
    context->max_loop_rounds = is_llvmpipe ? 65535 : UINT64_MAX;
    context->max_texels = is_llvmpipe ? properties.properties.limits.maxTexelBufferElements : 0;
    context->is_cpu = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    context->shared_lanes = count_shared_lanes(&subgroups, &subgroup_sizes);
    context->max_group_count = properties.properties.limits.maxComputeWorkGroupCount[0];

    // The device must have been created with it; that it could have been is all one can ask
    // afterwards.
    VkPhysicalDeviceVulkan12Features features12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
    };
    VkPhysicalDeviceFeatures2 features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
        .pNext = &features12,
    };
    vk->GetPhysicalDeviceFeatures2(desc->physical_device, &features);
    if (!features12.bufferDeviceAddress)
    {
        return ls_error_set(
            error, LS_MESSAGE_DEVICE_BUFFER_ADDRESS,
            "GPU %s lacks bufferDeviceAddress: update its driver or choose another device",
            device_name);
    }
    if (!family_computes(vk, desc->physical_device, desc->queue_family))
    {
        return ls_error_set(error, LS_MESSAGE_DEVICE_COMPUTE,
                            "queue family %u of GPU %s cannot compute: choose another family",
                            desc->queue_family, device_name);
    }
    vk->GetPhysicalDeviceMemoryProperties(desc->physical_device, &context->memory);
    context->unified = memory_is_unified(&context->memory);
    return LS_OK;
}

static LsResult fill_context(const LsContextDesc* desc, LsContext* context, LsError* error)
{
    InstanceFunctions instance;
    LsResult result = load_functions(desc, &instance, &context->vk, error);
    if (result != LS_OK)
    {
        return result;
    }
    return inspect_device(desc, &instance, context, error);
}

LsResult ls_context_create(const LsContextDesc* desc, LsContext** context, LsError* error)
{
    *context = NULL;
    LsContext* made = calloc(1, sizeof(*made));
    if (!made)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for a runtime context");
    }
    made->device = desc->device;
    made->queue = desc->queue;
    made->queue_family = desc->queue_family;
    made->measures = desc->measures;
    LsResult result = fill_context(desc, made, error);
    if (result != LS_OK)
    {
        free(made);
        return result;
    }
    *context = made;
    return LS_OK;
}

void ls_context_destroy(LsContext* context)
{
    free(context);
}
