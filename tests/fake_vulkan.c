#define _GNU_SOURCE // RTLD_NEXT

#include "fake_vulkan.h"

#include <dlfcn.h>
#include <string.h>

LsFakeVulkan ls_fake_vulkan;

static PFN_vkGetDeviceProcAddr driver_device_proc_addr;

// Whether the call that is being made shall fail.
static bool shall_fail(const char* call)
{
    if (!ls_fake_vulkan.count_down)
    {
        return false;
    }
    if (ls_fake_vulkan.remaining_calls > 0)
    {
        ls_fake_vulkan.remaining_calls--;
        return false;
    }
    ls_fake_vulkan.count_down = false;
    ls_fake_vulkan.failed_call = call;
    return true;
}

// ---- Calls that can fail -----------------------------------------------------------------------

#define FAKE_CALL(name, parameters, arguments)                                            \
    static PFN_vk##name driver_##name;                                                    \
    static VkResult VKAPI_CALL fake_##name parameters                                     \
    {                                                                                     \
        return shall_fail("vk" #name) ? ls_fake_vulkan.failure : driver_##name arguments; \
    }

FAKE_CALL(BeginCommandBuffer, (VkCommandBuffer commands, const VkCommandBufferBeginInfo* info),
          (commands, info))
FAKE_CALL(BindBufferMemory,
          (VkDevice device, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize offset),
          (device, buffer, memory, offset))
FAKE_CALL(EndCommandBuffer, (VkCommandBuffer commands), (commands))
FAKE_CALL(MapMemory,
          (VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size,
           VkMemoryMapFlags flags, void** data),
          (device, memory, offset, size, flags, data))
FAKE_CALL(ResetFences, (VkDevice device, uint32_t count, const VkFence* fences),
          (device, count, fences))
FAKE_CALL(WaitForFences,
          (VkDevice device, uint32_t count, const VkFence* fences, VkBool32 all, uint64_t timeout),
          (device, count, fences, all, timeout))

static PFN_vkQueueSubmit driver_QueueSubmit;
static VkResult VKAPI_CALL fake_QueueSubmit(VkQueue queue, uint32_t count,
                                            const VkSubmitInfo* infos, VkFence fence)
{
    ls_fake_vulkan.submit_count++;
    return shall_fail("vkQueueSubmit") ? ls_fake_vulkan.failure
                                       : driver_QueueSubmit(queue, count, infos, fence);
}

static PFN_vkAllocateCommandBuffers driver_AllocateCommandBuffers;
static VkResult VKAPI_CALL fake_AllocateCommandBuffers(VkDevice device,
                                                       const VkCommandBufferAllocateInfo* info,
                                                       VkCommandBuffer* commands)
{
    return shall_fail("vkAllocateCommandBuffers")
               ? ls_fake_vulkan.failure
               : driver_AllocateCommandBuffers(device, info, commands);
}

static PFN_vkAllocateDescriptorSets driver_AllocateDescriptorSets;
static VkResult VKAPI_CALL fake_AllocateDescriptorSets(VkDevice device,
                                                       const VkDescriptorSetAllocateInfo* info,
                                                       VkDescriptorSet* sets)
{
    return shall_fail("vkAllocateDescriptorSets")
               ? ls_fake_vulkan.failure
               : driver_AllocateDescriptorSets(device, info, sets);
}

// ---- Creation and destruction ------------------------------------------------------------------

// A failed creation leaves rubbish in the handle, as Vulkan allows: nobody may use or destroy it.
static VkResult count_creation(VkResult code)
{
    ls_fake_vulkan.live_objects += code == VK_SUCCESS;
    return code;
}

#define FAKE_CREATE(name, Info, Object)                                                            \
    static PFN_vk##name driver_##name;                                                             \
    static VkResult VKAPI_CALL fake_##name(VkDevice device, const Info* info,                      \
                                           const VkAllocationCallbacks* callbacks, Object* object) \
    {                                                                                              \
        if (shall_fail("vk" #name))                                                                \
        {                                                                                          \
            memset(object, 0xDD, sizeof(*object));                                                 \
            return ls_fake_vulkan.failure;                                                         \
        }                                                                                          \
        return count_creation(driver_##name(device, info, callbacks, object));                     \
    }

#define FAKE_DESTROY(name, Object)                                             \
    static PFN_vk##name driver_##name;                                         \
    static void VKAPI_CALL fake_##name(VkDevice device, Object object,         \
                                       const VkAllocationCallbacks* callbacks) \
    {                                                                          \
        ls_fake_vulkan.live_objects -= object != VK_NULL_HANDLE;               \
        driver_##name(device, object, callbacks);                              \
    }

FAKE_CREATE(AllocateMemory, VkMemoryAllocateInfo, VkDeviceMemory)
FAKE_CREATE(CreateBuffer, VkBufferCreateInfo, VkBuffer)
FAKE_CREATE(CreateBufferView, VkBufferViewCreateInfo, VkBufferView)
FAKE_CREATE(CreateCommandPool, VkCommandPoolCreateInfo, VkCommandPool)
FAKE_CREATE(CreateDescriptorPool, VkDescriptorPoolCreateInfo, VkDescriptorPool)
FAKE_CREATE(CreateDescriptorSetLayout, VkDescriptorSetLayoutCreateInfo, VkDescriptorSetLayout)
FAKE_CREATE(CreateFence, VkFenceCreateInfo, VkFence)
FAKE_CREATE(CreatePipelineLayout, VkPipelineLayoutCreateInfo, VkPipelineLayout)
FAKE_CREATE(CreateShaderModule, VkShaderModuleCreateInfo, VkShaderModule)
FAKE_DESTROY(FreeMemory, VkDeviceMemory)
FAKE_DESTROY(DestroyBuffer, VkBuffer)
FAKE_DESTROY(DestroyBufferView, VkBufferView)
FAKE_DESTROY(DestroyCommandPool, VkCommandPool)
FAKE_DESTROY(DestroyDescriptorPool, VkDescriptorPool)
FAKE_DESTROY(DestroyDescriptorSetLayout, VkDescriptorSetLayout)
FAKE_DESTROY(DestroyFence, VkFence)
FAKE_DESTROY(DestroyPipeline, VkPipeline)
FAKE_DESTROY(DestroyPipelineLayout, VkPipelineLayout)
FAKE_DESTROY(DestroyShaderModule, VkShaderModule)

static PFN_vkCreateComputePipelines driver_CreateComputePipelines;
static VkResult VKAPI_CALL fake_CreateComputePipelines(VkDevice device, VkPipelineCache cache,
                                                       uint32_t count,
                                                       const VkComputePipelineCreateInfo* infos,
                                                       const VkAllocationCallbacks* callbacks,
                                                       VkPipeline* pipelines)
{
    if (shall_fail("vkCreateComputePipelines"))
    {
        memset(pipelines, 0xDD, count * sizeof(*pipelines));
        return ls_fake_vulkan.failure;
    }
    return count_creation(
        driver_CreateComputePipelines(device, cache, count, infos, callbacks, pipelines));
}

// ---- Calls that are counted --------------------------------------------------------------------

static PFN_vkCmdDispatch driver_CmdDispatch;
static void VKAPI_CALL fake_CmdDispatch(VkCommandBuffer commands, uint32_t x, uint32_t y,
                                        uint32_t z)
{
    ls_fake_vulkan.dispatch_count++;
    driver_CmdDispatch(commands, x, y, z);
}

static PFN_vkCmdCopyBuffer driver_CmdCopyBuffer;
static void VKAPI_CALL fake_CmdCopyBuffer(VkCommandBuffer commands, VkBuffer from, VkBuffer to,
                                          uint32_t count, const VkBufferCopy* regions)
{
    ls_fake_vulkan.copy_count++;
    for (uint32_t i = 0; i < count; i++)
    {
        ls_fake_vulkan.copied_bytes += regions[i].size;
    }
    driver_CmdCopyBuffer(commands, from, to, count, regions);
}

// ---- What the device is like -------------------------------------------------------------------

static PFN_vkGetPhysicalDeviceProperties2 driver_GetPhysicalDeviceProperties2;
static void VKAPI_CALL fake_GetPhysicalDeviceProperties2(VkPhysicalDevice physical_device,
                                                         VkPhysicalDeviceProperties2* properties)
{
    driver_GetPhysicalDeviceProperties2(physical_device, properties);
    if (ls_fake_vulkan.api_version)
    {
        properties->properties.apiVersion = ls_fake_vulkan.api_version;
    }
    if (ls_fake_vulkan.max_group_count)
    {
        properties->properties.limits.maxComputeWorkGroupCount[0] = ls_fake_vulkan.max_group_count;
    }
    for (VkBaseOutStructure* next = properties->pNext; next; next = next->pNext)
    {
        if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES &&
            ls_fake_vulkan.driver)
        {
            ((VkPhysicalDeviceDriverProperties*)next)->driverID = ls_fake_vulkan.driver;
        }
        if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES &&
            ls_fake_vulkan.max_allocation_bytes)
        {
            ((VkPhysicalDeviceMaintenance3Properties*)next)->maxMemoryAllocationSize =
                ls_fake_vulkan.max_allocation_bytes;
        }
        if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES &&
            ls_fake_vulkan.lanes)
        {
            ((VkPhysicalDeviceSubgroupProperties*)next)->subgroupSize = ls_fake_vulkan.lanes;
        }
        if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES &&
            ls_fake_vulkan.lanes)
        {
            VkPhysicalDeviceSubgroupSizeControlProperties* sizes = (void*)next;
            sizes->minSubgroupSize = ls_fake_vulkan.least_lanes;
            sizes->maxSubgroupSize = ls_fake_vulkan.most_lanes;
        }
    }
}

static void take_features(VkPhysicalDeviceFeatures2* features)
{
    for (VkBaseOutStructure* next = features->pNext; next; next = next->pNext)
    {
        if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES &&
            ls_fake_vulkan.no_buffer_address)
        {
            ((VkPhysicalDeviceVulkan12Features*)next)->bufferDeviceAddress = VK_FALSE;
        }
    }
}

static PFN_vkGetPhysicalDeviceFeatures2 driver_GetPhysicalDeviceFeatures2;
static void VKAPI_CALL fake_GetPhysicalDeviceFeatures2(VkPhysicalDevice physical_device,
                                                       VkPhysicalDeviceFeatures2* features)
{
    driver_GetPhysicalDeviceFeatures2(physical_device, features);
    take_features(features);
}

// In the place of the loader's functions of these names.
#define FIND_LOADER(name) \
    PFN_##name loader;    \
    *(void**)&loader = dlsym(RTLD_NEXT, #name)

VKAPI_ATTR VkResult VKAPI_CALL vkEnumeratePhysicalDevices(VkInstance instance, uint32_t* count,
                                                          VkPhysicalDevice* devices)
{
    if (ls_fake_vulkan.no_devices)
    {
        *count = 0;
        return VK_SUCCESS;
    }
    FIND_LOADER(vkEnumeratePhysicalDevices);
    return loader(instance, count, devices);
}

VKAPI_ATTR void VKAPI_CALL vkGetPhysicalDeviceProperties(VkPhysicalDevice physical_device,
                                                         VkPhysicalDeviceProperties* properties)
{
    FIND_LOADER(vkGetPhysicalDeviceProperties);
    loader(physical_device, properties);
    if (ls_fake_vulkan.api_version)
    {
        properties->apiVersion = ls_fake_vulkan.api_version;
    }
}

VKAPI_ATTR void VKAPI_CALL vkGetPhysicalDeviceFeatures2(VkPhysicalDevice physical_device,
                                                        VkPhysicalDeviceFeatures2* features)
{
    FIND_LOADER(vkGetPhysicalDeviceFeatures2);
    loader(physical_device, features);
    take_features(features);
}

static void take_compute(uint32_t count, VkQueueFamilyProperties* families)
{
    for (uint32_t i = 0; families && ls_fake_vulkan.no_compute && i < count; i++)
    {
        families[i].queueFlags &= ~(VkQueueFlags)VK_QUEUE_COMPUTE_BIT;
    }
}

VKAPI_ATTR void VKAPI_CALL vkGetPhysicalDeviceQueueFamilyProperties(
    VkPhysicalDevice physical_device, uint32_t* count, VkQueueFamilyProperties* families)
{
    FIND_LOADER(vkGetPhysicalDeviceQueueFamilyProperties);
    loader(physical_device, count, families);
    take_compute(*count, families);
}

static PFN_vkGetPhysicalDeviceQueueFamilyProperties driver_GetPhysicalDeviceQueueFamilyProperties;
static void VKAPI_CALL fake_GetPhysicalDeviceQueueFamilyProperties(
    VkPhysicalDevice physical_device, uint32_t* count, VkQueueFamilyProperties* families)
{
    driver_GetPhysicalDeviceQueueFamilyProperties(physical_device, count, families);
    take_compute(*count, families);
}

// Separate memory: type 0 is the driver's type 0 of which the host sees nothing, type 1 the same
// again in a heap that is far from the device. Needs a driver whose type 0 the host can map, as a
// CPU device's.
static PFN_vkGetPhysicalDeviceMemoryProperties driver_GetPhysicalDeviceMemoryProperties;
static void VKAPI_CALL fake_GetPhysicalDeviceMemoryProperties(
    VkPhysicalDevice physical_device, VkPhysicalDeviceMemoryProperties* memory)
{
    driver_GetPhysicalDeviceMemoryProperties(physical_device, memory);
    if (ls_fake_vulkan.separate_memory)
    {
        memory->memoryTypeCount = 2;
        memory->memoryTypes[0] = (VkMemoryType){VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
        memory->memoryTypes[1] = (VkMemoryType){
            VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, 1};
        memory->memoryHeapCount = 2;
        memory->memoryHeaps[1] = (VkMemoryHeap){memory->memoryHeaps[0].size, 0};
    }
    if (ls_fake_vulkan.no_memory)
    {
        memory->memoryTypeCount = 0;
    }
}

static PFN_vkGetBufferMemoryRequirements driver_GetBufferMemoryRequirements;
static void VKAPI_CALL fake_GetBufferMemoryRequirements(VkDevice device, VkBuffer buffer,
                                                        VkMemoryRequirements* needs)
{
    driver_GetBufferMemoryRequirements(device, buffer, needs);
    if (ls_fake_vulkan.separate_memory)
    {
        needs->memoryTypeBits = 3;
    }
}

// Memory of the made-up type 1 comes from type 0.
static VkResult VKAPI_CALL allocate_memory(VkDevice device, const VkMemoryAllocateInfo* info,
                                           const VkAllocationCallbacks* callbacks,
                                           VkDeviceMemory* memory)
{
    VkMemoryAllocateInfo changed = *info;
    changed.memoryTypeIndex = ls_fake_vulkan.separate_memory ? 0 : info->memoryTypeIndex;
    return fake_AllocateMemory(device, &changed, callbacks, memory);
}

// ---- By name -----------------------------------------------------------------------------------

#define FAKE_DEVICE_LIST(X)        \
    X(AllocateCommandBuffers)      \
    X(AllocateDescriptorSets)      \
    X(BeginCommandBuffer)          \
    X(BindBufferMemory)            \
    X(CmdCopyBuffer)               \
    X(CmdDispatch)                 \
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
    X(GetBufferMemoryRequirements) \
    X(MapMemory)                   \
    X(QueueSubmit)                 \
    X(ResetFences)                 \
    X(WaitForFences)

#define FAKE_INSTANCE_LIST(X)            \
    X(GetPhysicalDeviceFeatures2)        \
    X(GetPhysicalDeviceMemoryProperties) \
    X(GetPhysicalDeviceProperties2)      \
    X(GetPhysicalDeviceQueueFamilyProperties)

static bool is_missing(const char* name)
{
    return ls_fake_vulkan.missing_function && strcmp(ls_fake_vulkan.missing_function, name) == 0;
}

static PFN_vkVoidFunction VKAPI_CALL get_device_proc_addr(VkDevice device, const char* name)
{
    PFN_vkVoidFunction driver = is_missing(name) ? NULL : driver_device_proc_addr(device, name);
    if (!driver)
    {
        return NULL;
    }
    if (strcmp(name, "vkAllocateMemory") == 0)
    {
        driver_AllocateMemory = (PFN_vkAllocateMemory)driver;
        return (PFN_vkVoidFunction)allocate_memory;
    }
#define REPLACE(function)                             \
    if (strcmp(name, "vk" #function) == 0)            \
    {                                                 \
        driver_##function = (PFN_vk##function)driver; \
        return (PFN_vkVoidFunction)fake_##function;   \
    }
    FAKE_DEVICE_LIST(REPLACE)
    return driver;
}

PFN_vkVoidFunction VKAPI_CALL ls_fake_get_instance_proc_addr(VkInstance instance, const char* name)
{
    PFN_vkVoidFunction driver = is_missing(name) ? NULL : vkGetInstanceProcAddr(instance, name);
    if (!driver)
    {
        return NULL;
    }
    if (strcmp(name, "vkGetDeviceProcAddr") == 0)
    {
        driver_device_proc_addr = (PFN_vkGetDeviceProcAddr)driver;
        return (PFN_vkVoidFunction)get_device_proc_addr;
    }
    FAKE_INSTANCE_LIST(REPLACE)
#undef REPLACE
    return driver;
}
