#include "array.h"

#include <stdlib.h>

uint64_t ls_array_segment_records(uint32_t stride, uint32_t segment_log2)
{
    uint32_t stride_log2 = 0;
    while (1u << stride_log2 < stride)
    {
        stride_log2++;
    }
    return UINT64_C(1) << (segment_log2 - stride_log2);
}

static LsResult create_buffer(LsUpload* upload, const LsArrayDesc* desc, const void* bytes,
                              uint64_t size, LsArray* array, LsBuffer* buffer, LsError* error)
{
    const LsResult result = ls_buffer_create(upload->context, LS_BUFFER_SCENE, size, desc->name,
                                             desc->what, buffer, error);
    if (result != LS_OK)
    {
        return result;
    }
    array->device_bytes += size;
    return ls_upload_copy(upload, buffer, bytes, size, error);
}

static LsResult create_segments(LsUpload* upload, const LsArrayDesc* desc, uint64_t segment_records,
                                LsArray* array, LsError* error)
{
    const uint64_t segment_bytes = segment_records * desc->stride;
    const uint64_t bytes = desc->count * desc->stride;
    LsResult result = LS_OK;
    for (uint64_t first = 0; first < bytes && result == LS_OK; first += segment_bytes)
    {
        const uint64_t left = bytes - first;
        result = create_buffer(upload, desc, (const uint8_t*)desc->records + first,
                               left < segment_bytes ? left : segment_bytes, array,
                               &array->segments[array->segment_count++], error);
    }
    return result;
}

static LsResult create_table(LsUpload* upload, const LsArrayDesc* desc, LsArray* array,
                             LsError* error)
{
    LsAddress* addresses = malloc(array->segment_count * sizeof *addresses);
    if (!addresses)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s: out of memory for the segments of %s", desc->name, desc->what);
    }
    for (uint32_t i = 0; i < array->segment_count; i++)
    {
        addresses[i] = array->segments[i].address;
    }
    const LsResult result =
        create_buffer(upload, desc, addresses, array->segment_count * sizeof *addresses, array,
                      &array->table, error);
    free(addresses);
    return result;
}

LsResult ls_array_create(LsUpload* upload, const LsArrayDesc* desc, LsArray* array, LsError* error)
{
    *array = (LsArray){0};
    const bool is_cut = desc->segment_log2 != 0;
    const uint64_t segment_records =
        is_cut ? ls_array_segment_records(desc->stride, desc->segment_log2) : desc->count;
    const uint64_t segment_count = (desc->count + segment_records - 1) / segment_records;
    array->segments = calloc(segment_count, sizeof *array->segments);
    if (!array->segments)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s: out of memory for the segments of %s", desc->name, desc->what);
    }
    LsResult result = create_segments(upload, desc, segment_records, array, error);
    if (result == LS_OK && is_cut)
    {
        result = create_table(upload, desc, array, error);
    }
    array->address = is_cut ? array->table.address : array->segments[0].address;
    return result;
}

void ls_array_destroy(const LsContext* context, LsArray* array)
{
    for (uint32_t i = 0; i < array->segment_count; i++)
    {
        ls_buffer_destroy(context, &array->segments[i]);
    }
    free(array->segments);
    ls_buffer_destroy(context, &array->table);
    *array = (LsArray){0};
}
