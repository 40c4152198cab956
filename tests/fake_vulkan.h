// fake_vulkan.h - Vulkan as a test wants it: calls that fail, devices that lack things, live
// objects counted.
//
// The functions stand between a library and the driver: hand ls_fake_get_instance_proc_addr to
// ls_context_create. Of the functions that programs link, vkEnumeratePhysicalDevices and those that ask
// a physical device for features, properties and queue families are replaced. What is not faked goes straight to the driver. One test at a time.

#ifndef LS_TEST_FAKE_VULKAN_H
#define LS_TEST_FAKE_VULKAN_H

#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

// Set before a test; zero means: as the driver says.
typedef struct LsFakeVulkan
{
    bool count_down;          // the call that finds remaining_calls at 0 fails with failure
    uint32_t remaining_calls; // calls that can fail and still shall succeed
    VkResult failure;
    const char* missing_function; // not found by name
    bool no_buffer_address;       // the feature bufferDeviceAddress is not there
    bool no_compute;              // no queue family computes
    bool no_devices;              // programs find no device at all
    bool no_memory;               // there is no kind of memory
    VkDriverId driver;
    uint32_t api_version;
    uint32_t max_group_count;
    VkDeviceSize max_allocation_bytes;
    uint32_t lanes, least_lanes, most_lanes; // of a subgroup; all or none
    bool separate_memory; // device memory that the host does not see, as a graphics card has

    // Observed.
    const char* failed_call; // the one that was made to fail
    int64_t live_objects;    // created and not destroyed
    uint32_t dispatch_count;
    uint32_t copy_count;
    uint64_t copied_bytes;
    uint32_t submit_count;
} LsFakeVulkan;

extern LsFakeVulkan ls_fake_vulkan;

PFN_vkVoidFunction VKAPI_CALL ls_fake_get_instance_proc_addr(VkInstance instance, const char* name);

#endif
