// buffer.h - buffers with memory of their own.

#ifndef LS_BUFFER_H
#define LS_BUFFER_H

#include "context.h"

typedef enum LsBufferKind
{
    LS_BUFFER_SCENE,   // on the device, with an address; mapped too where memory is unified
    LS_BUFFER_STAGING, // mapped, source of copies
} LsBufferKind;

// Zeroed when destroyed.
typedef struct LsBuffer
{
    VkBuffer handle;
    VkDeviceMemory memory;
    VkDeviceAddress address; // 0 for staging
    VkDeviceSize bytes;
    void* mapped; // NULL when the host cannot see it
} LsBuffer;

// Creates a buffer of `bytes` >= 1. `name` (the file) and `what` (the array) are for messages. On
// failure *buffer is zero. Errors: DEVICE_MEMORY, DEVICE, MEMORY.
LsResult ls_buffer_create(const LsContext* context, LsBufferKind kind, VkDeviceSize bytes,
                          const char* name, const char* what, LsBuffer* buffer, LsError* error);
void ls_buffer_destroy(const LsContext* context, LsBuffer* buffer); // a zero buffer is allowed

#endif
