// app_device.h - everything the runtime library refuses to own: Vulkan instance, device, queue,
// command buffers, buffers of the application, GPU clocks. Shared by lstrace, lsview, the benchmark
// and the tests.
//
// Step by step:
//     LsAppDevice device;  ls_app_device_create(&device, &(LsAppDeviceDesc){0}, &error);
//     LsContextDesc desc = ls_app_context_desc(&device);
//     ls_context_create(&desc, &context, &error);
//     LsAppBuffer rays;  ls_app_buffer_create(&device, LS_APP_MEMORY_UPLOAD, bytes, &rays, &error);
//     VkCommandBuffer commands;  ls_app_commands_begin(&device, &commands, &error);
//     ... record, with ls_app_commands_barrier between dependent steps ...
//     ls_app_commands_submit(&device, commands, &error);
//     ls_app_buffer_destroy(&device, &rays);  ls_app_device_destroy(&device);
//
// All calls on one device must come from one thread at a time. Programs link the Vulkan loader and
// may call vk functions directly.

#ifndef LS_APP_DEVICE_H
#define LS_APP_DEVICE_H

#include "ls_runtime.h"

#include <stdbool.h>

// Zero means default.
typedef struct LsAppDeviceDesc
{
    const char* device_name; // part of the wanted device's name, case ignored; NULL: the best
    bool validation;         // load the Khronos validation layer; LS_VALIDATION=1 does so too
} LsAppDeviceDesc;

// Read its fields; change none. Zeroed when destroyed.
typedef struct LsAppDevice
{
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    VkQueue queue; // compute and transfer
    uint32_t queue_family;
    VkCommandPool command_pool;
    VkQueryPool clock; // two timestamps; null when the queue has none
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize max_buffer_bytes; // largest single allocation and buffer of the device
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    bool is_cpu;              // a software device such as lavapipe
    double timestamp_seconds; // one tick; 0 when the queue has no timestamps
    uint64_t timestamp_mask;  // the valid bits of a timestamp
} LsAppDevice;

// Chooses the best device (discrete, then integrated, virtual, CPU; or by name) with
// bufferDeviceAddress and a compute queue. Errors: NO_VULKAN, NO_DEVICE, DEVICE_FEATURE, DEVICE,
// MEMORY. On failure *device is zero.
LsResult ls_app_device_create(LsAppDevice* device, const LsAppDeviceDesc* desc, LsError* error);
void ls_app_device_destroy(LsAppDevice* device); // a zero device is allowed

// What ls_context_create takes; borrows the device.
LsContextDesc ls_app_context_desc(const LsAppDevice* device);

// Fills `error` for a failed Vulkan call named by `call` ("vkQueueSubmit"). The result follows from
// `code`: DEVICE_MEMORY, MEMORY, DEVICE_LOST or DEVICE; VK_SUCCESS gives OK and leaves `error`
// alone.
LsResult ls_app_vk_result(VkResult code, const char* call, LsError* error);

// Where a buffer lies.
typedef enum LsAppMemory
{
    LS_APP_MEMORY_DEVICE,   // on the device; `mapped` is NULL unless the device is the CPU
    LS_APP_MEMORY_UPLOAD,   // mapped and coherent: the host writes, the device reads
    LS_APP_MEMORY_READBACK, // mapped and coherent, cached if possible: the host reads
} LsAppMemory;

// A storage buffer with an address, also source and target of transfers, with memory of its own.
typedef struct LsAppBuffer
{
    VkBuffer buffer;
    VkDeviceMemory memory;
    VkDeviceAddress address; // aligned to 256 bytes or better on all known devices, to 16 on any
    VkDeviceSize bytes;
    void* mapped; // NULL when the host cannot see it
} LsAppBuffer;

// `bytes` >= 1. Errors: DEVICE_MEMORY (also above max_buffer_bytes), DEVICE, MEMORY. On failure
// *buffer is zero.
LsResult ls_app_buffer_create(const LsAppDevice* device, LsAppMemory where, VkDeviceSize bytes,
                              LsAppBuffer* buffer, LsError* error);
// A zero buffer is allowed.
void ls_app_buffer_destroy(const LsAppDevice* device, LsAppBuffer* buffer);

// Begins a one-time command buffer. Errors: DEVICE_MEMORY, MEMORY, DEVICE. On failure *commands is
// null.
LsResult ls_app_commands_begin(const LsAppDevice* device, VkCommandBuffer* commands,
                               LsError* error);

// Ends, submits, waits and frees `commands`, also on failure. Errors: as above, DEVICE_LOST.
LsResult ls_app_commands_submit(const LsAppDevice* device, VkCommandBuffer commands,
                                LsError* error);

// Frees `commands` without submitting, for the way out after an error; null is allowed.
void ls_app_commands_drop(const LsAppDevice* device, VkCommandBuffer commands);

// Makes all writes so far (host, transfer, compute) visible to all later reads and writes of the
// same.
void ls_app_commands_barrier(VkCommandBuffer commands);

// A span on the GPU's clock, one per command buffer: begin and end are recorded, the span is read
// after submission. Without timestamps all three do nothing and the span is 0.
void ls_app_clock_begin(const LsAppDevice* device, VkCommandBuffer commands);
void ls_app_clock_end(const LsAppDevice* device, VkCommandBuffer commands);

// Seconds between begin and end of the last submission. Errors: DEVICE, DEVICE_LOST.
LsResult ls_app_clock_read(const LsAppDevice* device, double* seconds, LsError* error);

#endif
