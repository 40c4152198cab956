// upload.h - host bytes to scene buffers, byte for byte.
//
// Where memory is unified the bytes are copied straight into the buffer. Elsewhere they go through
// a ring of staging slots, so that the host fills one while the device empties the others.

#ifndef LS_UPLOAD_H
#define LS_UPLOAD_H

#include "buffer.h"

#define LS_UPLOAD_SLOTS 3
#define LS_UPLOAD_SLOT_BYTES ((VkDeviceSize)4 << 20)

typedef struct LsUpload
{
    const LsContext* context;
    LsBuffer staging; // all slots, one after the other; unused where memory is unified
    VkDeviceSize slot_bytes;
    VkCommandPool pool;
    VkCommandBuffer commands[LS_UPLOAD_SLOTS];
    VkFence fences[LS_UPLOAD_SLOTS];
    bool busy[LS_UPLOAD_SLOTS]; // submitted and not yet waited for
    uint32_t next;
} LsUpload;

// Prepares uploads. `largest_bytes` is about what the largest takes: slots of the ring are no
// larger, and what is goes in pieces. `name` is for messages. After a failure, too,
// ls_upload_end must be called. Errors: DEVICE_MEMORY, DEVICE, MEMORY.
LsResult ls_upload_begin(LsUpload* upload, const LsContext* context, VkDeviceSize largest_bytes,
                         const char* name, LsError* error);

// Copies `size` bytes to the beginning of a scene buffer; `bytes` may go away after the call.
// Errors: DEVICE_MEMORY, DEVICE_LOST, DEVICE, MEMORY.
LsResult ls_upload_copy(LsUpload* upload, const LsBuffer* buffer, const void* bytes,
                        VkDeviceSize size, LsError* error);

// Waits for all copies and releases everything, whether or not it reports a failure. The bytes are
// then visible to later compute shader reads on the same queue. Errors: as ls_upload_copy.
LsResult ls_upload_end(LsUpload* upload, LsError* error);

#endif
