#include "app_device.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define MAX_DEVICES 16

LsResult ls_app_vk_result(VkResult code, const char* call, LsError* error)
{
    switch (code)
    {
    case VK_SUCCESS:
        return LS_OK;
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return ls_error_set(
            error, LS_MESSAGE_DEVICE_MEMORY_FULL,
            "%s found too little device memory: close other programs that use the GPU", call);
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s found too little memory: close other programs", call);
    case VK_ERROR_DEVICE_LOST:
        return ls_error_set(
            error, LS_MESSAGE_DEVICE_LOST,
            "%s lost the device: its driver was reset, often because one call took too long; "
            "try again with less work at a time",
            call);
    default:
        return ls_error_set(
            error, LS_MESSAGE_VULKAN_CALL,
            "%s failed with VkResult %d: update the driver or choose another device", call,
            (int)code);
    }
}

static LsResult create_instance(LsAppDevice* device, const LsAppDeviceDesc* desc, LsError* error)
{
    const char* wish = getenv("LS_VALIDATION");
    bool validation = desc->validation || (wish && strcmp(wish, "1") == 0);
    const char* layer = "VK_LAYER_KHRONOS_validation";
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pApplicationName = "linespace",
        .apiVersion =
            VK_API_VERSION_1_3, // the newest that may be asked about; 1.2 is what is needed
    };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pApplicationInfo = &application,
        .enabledLayerCount = validation ? 1 : 0,
        .ppEnabledLayerNames = &layer,
    };
    VkResult code = vkCreateInstance(&info, NULL, &device->instance);
    switch (code)
    {
    case VK_ERROR_INCOMPATIBLE_DRIVER:
        device->instance = VK_NULL_HANDLE;
        return ls_error_set(error, LS_MESSAGE_VULKAN_DRIVER,
                            "no Vulkan driver was found: install mesa-vulkan-drivers (it brings a "
                            "software device as "
                            "well) or your GPU's own driver");
    case VK_ERROR_LAYER_NOT_PRESENT:
        device->instance = VK_NULL_HANDLE;
        return ls_error_set(
            error, LS_MESSAGE_VULKAN_LAYER,
            "%s was not found: install vulkan-validationlayers or unset LS_VALIDATION", layer);
    default:
        device->instance = code == VK_SUCCESS ? device->instance : VK_NULL_HANDLE;
        return ls_app_vk_result(code, "vkCreateInstance", error);
    }
}

// The first queue family that computes; UINT32_MAX if there is none.
static uint32_t find_queue_family(VkPhysicalDevice physical_device, uint32_t* timestamp_bits)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = sizeof(families) / sizeof(families[0]);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device, &count, families);
    for (uint32_t i = 0; i < count; i++)
    {
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)
        {
            *timestamp_bits = families[i].timestampValidBits;
            return i;
        }
    }
    return UINT32_MAX;
}

// What a device lacks that we need; text NULL: nothing.
typedef struct Lack
{
    LsMessage message;
    const char* text;
} Lack;

static Lack find_lack(VkPhysicalDevice physical_device)
{
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical_device, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_2)
    {
        return (Lack){LS_MESSAGE_DEVICE_VERSION, "Vulkan 1.2"};
    }
    VkPhysicalDeviceVulkan12Features features12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
    };
    VkPhysicalDeviceFeatures2 features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
        .pNext = &features12,
    };
    vkGetPhysicalDeviceFeatures2(physical_device, &features);
    if (!features12.bufferDeviceAddress)
    {
        return (Lack){LS_MESSAGE_DEVICE_BUFFER_ADDRESS, "bufferDeviceAddress"};
    }
    uint32_t timestamp_bits;
    const bool computes = find_queue_family(physical_device, &timestamp_bits) != UINT32_MAX;
    return (Lack){LS_MESSAGE_DEVICE_COMPUTE, computes ? NULL : "a compute queue"};
}

static int rank_type(VkPhysicalDeviceType type)
{
    switch (type)
    {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return 1;
    default:
        return 0;
    }
}

static bool contains_ignoring_case(const char* text, const char* part)
{
    for (; *text || !*part; text++)
    {
        size_t i = 0;
        while (part[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
        {
            i++;
        }
        if (!part[i])
        {
            return true;
        }
        if (!*text)
        {
            break;
        }
    }
    return false;
}

static LsResult choose_device(LsAppDevice* device, const char* wanted, LsError* error)
{
    VkPhysicalDevice found[MAX_DEVICES];
    uint32_t count = MAX_DEVICES;
    VkResult code = vkEnumeratePhysicalDevices(device->instance, &count, found);
    if (code != VK_SUCCESS && code != VK_INCOMPLETE)
    {
        return ls_app_vk_result(code, "vkEnumeratePhysicalDevices", error);
    }

    char names[600] = ""; // of all devices, for the message
    char lacking_name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE] = "";
    Lack lack = {0};
    int best_rank = -1;
    for (uint32_t i = 0; i < count; i++)
    {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(found[i], &properties);
        size_t used = strlen(names);
        if (used + strlen(properties.deviceName) + 3 < sizeof(names))
        {
            strcat(strcat(names, used ? ", " : ""), properties.deviceName);
        }
        if (wanted && !contains_ignoring_case(properties.deviceName, wanted))
        {
            continue;
        }
        const Lack lacks = find_lack(found[i]);
        if (lacks.text)
        {
            lack = lacks;
            memcpy(lacking_name, properties.deviceName, sizeof(lacking_name));
        }
        else if (rank_type(properties.deviceType) > best_rank)
        {
            best_rank = rank_type(properties.deviceType);
            device->physical_device = found[i];
            device->is_cpu = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
            device->timestamp_seconds = (double)properties.limits.timestampPeriod * 1e-9;
            memcpy(device->name, properties.deviceName, sizeof(device->name));
        }
    }
    if (device->physical_device)
    {
        return LS_OK;
    }
    if (lack.text)
    {
        return ls_error_set(error, lack.message,
                            "GPU %s lacks %s: update its driver, or install mesa-vulkan-drivers "
                            "for a software device",
                            lacking_name, lack.text);
    }
    if (wanted && count > 0)
    {
        return ls_error_set(error, LS_MESSAGE_DEVICE_NAME,
                            "no Vulkan device is called \"%s\"; there are: %s", wanted, names);
    }
    return ls_error_set(
        error, LS_MESSAGE_DEVICE_NONE,
        "no Vulkan device was found: install mesa-vulkan-drivers for a software device");
}

static LsResult create_device(LsAppDevice* device, LsError* error)
{
    uint32_t timestamp_bits = 0;
    device->queue_family = find_queue_family(device->physical_device, &timestamp_bits);
    device->timestamp_mask = timestamp_bits >= 64 ? UINT64_MAX : (1ull << timestamp_bits) - 1;
    float priority = 1;
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = device->queue_family,
        .queueCount = 1,
        .pQueuePriorities = &priority,
    };
    VkPhysicalDeviceVulkan12Features features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
        .bufferDeviceAddress = VK_TRUE,
    };
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &features,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
    };
    VkResult code = vkCreateDevice(device->physical_device, &info, NULL, &device->device);
    if (code != VK_SUCCESS)
    {
        device->device = VK_NULL_HANDLE;
        return ls_app_vk_result(code, "vkCreateDevice", error);
    }
    vkGetDeviceQueue(device->device, device->queue_family, 0, &device->queue);

    VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
        .queueFamilyIndex = device->queue_family,
    };
    code = vkCreateCommandPool(device->device, &pool, NULL, &device->command_pool);
    if (code != VK_SUCCESS)
    {
        device->command_pool = VK_NULL_HANDLE;
        return ls_app_vk_result(code, "vkCreateCommandPool", error);
    }
    if (timestamp_bits == 0)
    {
        device->timestamp_seconds = 0;
        return LS_OK;
    }
    VkQueryPoolCreateInfo clock = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_TIMESTAMP,
        .queryCount = 2,
    };
    code = vkCreateQueryPool(device->device, &clock, NULL, &device->clock);
    device->clock = code == VK_SUCCESS ? device->clock : VK_NULL_HANDLE;
    return ls_app_vk_result(code, "vkCreateQueryPool", error);
}

static void read_limits(LsAppDevice* device)
{
    VkPhysicalDeviceMaintenance4Properties buffers = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES,
    };
    VkPhysicalDeviceMaintenance3Properties allocations = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
    };
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &allocations,
    };
    vkGetPhysicalDeviceProperties2(device->physical_device, &properties);
    if (properties.properties.apiVersion >= VK_API_VERSION_1_3)
    {
        allocations.pNext = &buffers;
        vkGetPhysicalDeviceProperties2(device->physical_device, &properties);
    }
    device->max_buffer_bytes = allocations.maxMemoryAllocationSize;
    if (buffers.maxBufferSize != 0 && buffers.maxBufferSize < device->max_buffer_bytes)
    {
        device->max_buffer_bytes = buffers.maxBufferSize;
    }
    vkGetPhysicalDeviceMemoryProperties(device->physical_device, &device->memory);
}

LsResult ls_app_device_create(LsAppDevice* device, const LsAppDeviceDesc* desc, LsError* error)
{
    *device = (LsAppDevice){0};
    LsResult result = create_instance(device, desc, error);
    if (result == LS_OK)
    {
        result = choose_device(device, desc->device_name, error);
    }
    if (result == LS_OK)
    {
        read_limits(device);
        result = create_device(device, error);
    }
    if (result != LS_OK)
    {
        ls_app_device_destroy(device);
    }
    return result;
}

void ls_app_device_destroy(LsAppDevice* device)
{
    if (device->device)
    {
        vkDestroyQueryPool(device->device, device->clock, NULL);
        vkDestroyCommandPool(device->device, device->command_pool, NULL);
        vkDestroyDevice(device->device, NULL);
    }
    if (device->instance)
    {
        vkDestroyInstance(device->instance, NULL);
    }
    *device = (LsAppDevice){0};
}

LsContextDesc ls_app_context_desc(const LsAppDevice* device)
{
    return (LsContextDesc){
        .physical_device = device->physical_device,
        .device = device->device,
        .queue = device->queue,
        .queue_family = device->queue_family,
        .instance = device->instance,
        .get_instance_proc_addr = vkGetInstanceProcAddr,
    };
}

// The first memory type among `allowed` with all of `flags`; UINT32_MAX if there is none.
static uint32_t find_memory_type(const LsAppDevice* device, uint32_t allowed,
                                 VkMemoryPropertyFlags flags)
{
    for (uint32_t i = 0; i < device->memory.memoryTypeCount; i++)
    {
        if ((allowed >> i & 1u) && (device->memory.memoryTypes[i].propertyFlags & flags) == flags)
        {
            return i;
        }
    }
    return UINT32_MAX;
}

// Chooses by what the memory is for; *map says whether the host sees it.
static uint32_t choose_memory_type(const LsAppDevice* device, LsAppMemory where, uint32_t allowed,
                                   bool* map)
{
    const VkMemoryPropertyFlags mapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    *map = where != LS_APP_MEMORY_DEVICE || device->is_cpu;
    uint32_t type = UINT32_MAX;
    if (where == LS_APP_MEMORY_DEVICE)
    {
        return find_memory_type(device, allowed,
                                VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | (*map ? mapped : 0));
    }
    if (where == LS_APP_MEMORY_READBACK)
    {
        type = find_memory_type(device, allowed, mapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
    }
    return type != UINT32_MAX ? type : find_memory_type(device, allowed, mapped);
}

static LsResult fill_buffer(const LsAppDevice* device, LsAppMemory where, LsAppBuffer* buffer,
                            LsError* error)
{
    const double mib = 1024.0 * 1024.0;
    if (buffer->bytes > device->max_buffer_bytes)
    {
        return ls_error_set(error, LS_MESSAGE_DEVICE_BUFFER_LIMIT,
                            "a buffer of %.1f MiB was asked for, but the largest of %s is %.1f "
                            "MiB: ask for less at a time",
                            (double)buffer->bytes / mib, device->name,
                            (double)device->max_buffer_bytes / mib);
    }
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = buffer->bytes,
        .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
    };
    VkResult code = vkCreateBuffer(device->device, &info, NULL, &buffer->buffer);
    if (code != VK_SUCCESS)
    {
        buffer->buffer = VK_NULL_HANDLE; // after a failure Vulkan leaves handles undefined
        return ls_app_vk_result(code, "vkCreateBuffer", error);
    }

    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device->device, buffer->buffer, &needs);
    bool map;
    VkMemoryAllocateFlagsInfo flags = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
        .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT,
    };
    VkMemoryAllocateInfo memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .pNext = &flags,
        .allocationSize = needs.size,
        .memoryTypeIndex = choose_memory_type(device, where, needs.memoryTypeBits, &map),
    };
    if (memory.memoryTypeIndex == UINT32_MAX)
    {
        return ls_error_set(error, LS_MESSAGE_DEVICE_MEMORY_KIND,
                            "GPU %s has no kind of memory fit for a buffer: choose another device",
                            device->name);
    }
    code = vkAllocateMemory(device->device, &memory, NULL, &buffer->memory);
    if (code != VK_SUCCESS)
    {
        buffer->memory = VK_NULL_HANDLE;
        return ls_app_vk_result(code, "vkAllocateMemory", error);
    }
    code = vkBindBufferMemory(device->device, buffer->buffer, buffer->memory, 0);
    if (code != VK_SUCCESS)
    {
        return ls_app_vk_result(code, "vkBindBufferMemory", error);
    }
    if (map)
    {
        code = vkMapMemory(device->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped);
    }
    VkBufferDeviceAddressInfo address = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
        .buffer = buffer->buffer,
    };
    buffer->address = vkGetBufferDeviceAddress(device->device, &address);
    return ls_app_vk_result(code, "vkMapMemory", error);
}

LsResult ls_app_buffer_create(const LsAppDevice* device, LsAppMemory where, VkDeviceSize bytes,
                              LsAppBuffer* buffer, LsError* error)
{
    *buffer = (LsAppBuffer){.bytes = bytes};
    LsResult result = fill_buffer(device, where, buffer, error);
    if (result != LS_OK)
    {
        ls_app_buffer_destroy(device, buffer);
    }
    return result;
}

void ls_app_buffer_destroy(const LsAppDevice* device, LsAppBuffer* buffer)
{
    if (buffer->buffer)
    {
        vkDestroyBuffer(device->device, buffer->buffer, NULL);
        vkFreeMemory(device->device, buffer->memory, NULL);
    }
    *buffer = (LsAppBuffer){0};
}

LsResult ls_app_commands_begin(const LsAppDevice* device, VkCommandBuffer* commands, LsError* error)
{
    VkCommandBufferAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = device->command_pool,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1,
    };
    VkResult code = vkAllocateCommandBuffers(device->device, &info, commands);
    if (code != VK_SUCCESS)
    {
        *commands = VK_NULL_HANDLE;
        return ls_app_vk_result(code, "vkAllocateCommandBuffers", error);
    }
    VkCommandBufferBeginInfo begin = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
    };
    code = vkBeginCommandBuffer(*commands, &begin);
    if (code != VK_SUCCESS)
    {
        ls_app_commands_drop(device, *commands);
        *commands = VK_NULL_HANDLE;
    }
    return ls_app_vk_result(code, "vkBeginCommandBuffer", error);
}

static LsResult submit_and_wait(const LsAppDevice* device, VkCommandBuffer commands, LsError* error)
{
    VkResult code = vkEndCommandBuffer(commands);
    if (code != VK_SUCCESS)
    {
        return ls_app_vk_result(code, "vkEndCommandBuffer", error);
    }
    VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = 1,
        .pCommandBuffers = &commands,
    };
    code = vkQueueSubmit(device->queue, 1, &submit, VK_NULL_HANDLE);
    if (code != VK_SUCCESS)
    {
        return ls_app_vk_result(code, "vkQueueSubmit", error);
    }
    return ls_app_vk_result(vkQueueWaitIdle(device->queue), "vkQueueWaitIdle", error);
}

LsResult ls_app_commands_submit(const LsAppDevice* device, VkCommandBuffer commands, LsError* error)
{
    LsResult result = submit_and_wait(device, commands, error);
    ls_app_commands_drop(device, commands);
    return result;
}

void ls_app_commands_drop(const LsAppDevice* device, VkCommandBuffer commands)
{
    if (commands)
    {
        vkFreeCommandBuffers(device->device, device->command_pool, 1, &commands);
    }
}

void ls_app_commands_barrier(VkCommandBuffer commands)
{
    const VkPipelineStageFlags stages = VK_PIPELINE_STAGE_HOST_BIT |
                                        VK_PIPELINE_STAGE_TRANSFER_BIT |
                                        VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
    VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
    };
    vkCmdPipelineBarrier(commands, stages, stages, 0, 1, &barrier, 0, NULL, 0, NULL);
}

void ls_app_clock_begin(const LsAppDevice* device, VkCommandBuffer commands)
{
    if (device->clock)
    {
        vkCmdResetQueryPool(commands, device->clock, 0, 2);
        vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, device->clock, 0);
    }
}

void ls_app_clock_end(const LsAppDevice* device, VkCommandBuffer commands)
{
    if (device->clock)
    {
        vkCmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, device->clock, 1);
    }
}

LsResult ls_app_clock_read(const LsAppDevice* device, double* seconds, LsError* error)
{
    *seconds = 0;
    if (!device->clock)
    {
        return LS_OK;
    }
    uint64_t ticks[2];
    VkResult code =
        vkGetQueryPoolResults(device->device, device->clock, 0, 2, sizeof(ticks), ticks,
                              sizeof(ticks[0]), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    if (code == VK_SUCCESS)
    {
        *seconds =
            (double)((ticks[1] - ticks[0]) & device->timestamp_mask) * device->timestamp_seconds;
    }
    return ls_app_vk_result(code, "vkGetQueryPoolResults", error);
}
