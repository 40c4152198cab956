// array.h - an array of a file on the device: one buffer, or segments found by a table of their
// addresses.
//
// A device bounds its allocations, and 32 bits bound the offsets in a buffer. Larger arrays are cut
// into segments of a power-of-two number of records, so that a shift and a mask find one:
// shaders/scene.glsl reads them.

#ifndef LS_ARRAY_H
#define LS_ARRAY_H

#include "upload.h"

// Zeroed when destroyed.
typedef struct LsArray
{
    LsBuffer* segments;
    uint32_t segment_count;
    LsBuffer table;          // the segments' addresses, if the array is cut
    VkDeviceAddress address; // of the segment or the table
    uint64_t device_bytes;   // all of it
} LsArray;

// What is copied to the device. `name` (the file) and `what` (the array) are for messages.
typedef struct LsArrayDesc
{
    const void* records;
    uint64_t count; // >= 1
    uint32_t stride;
    uint32_t segment_log2; // of a segment's bytes, which may be fewer: 2^k records; 0: never cut
    const char* name;
    const char* what;
} LsArrayDesc;

// Records of a segment: as many as fill it if their size is rounded up to a power of two. The
// shaders know the same sizes.
uint64_t ls_array_segment_records(uint32_t stride, uint32_t segment_log2);

// Makes the array and queues the copy; the records may go away after the call. With a segment size
// there is a table even if one segment holds all. Whatever the result, ls_array_destroy must be
// called, once the upload has ended. Errors: DEVICE_MEMORY, DEVICE_LOST, DEVICE, MEMORY.
LsResult ls_array_create(LsUpload* upload, const LsArrayDesc* desc, LsArray* array, LsError* error);
void ls_array_destroy(const LsContext* context, LsArray* array); // a zero array is allowed

#endif
