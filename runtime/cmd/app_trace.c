#include "app_trace.h"

static VkDeviceSize input_bytes(uint32_t capacity)
{
    return (VkDeviceSize)capacity * (sizeof(LsRay) + sizeof(uint32_t));
}

static VkDeviceSize output_bytes(uint32_t capacity)
{
    return (VkDeviceSize)capacity * sizeof(LsHit);
}

LsResult ls_app_tracer_create(const LsAppDevice* device, uint32_t capacity, LsAppTracer* tracer,
                              LsError* error)
{
    *tracer = (LsAppTracer){.capacity = capacity};
    LsResult result = ls_app_buffer_create(device, LS_APP_MEMORY_UPLOAD, input_bytes(capacity),
                                           &tracer->input, error);
    if (result == LS_OK)
    {
        result = ls_app_buffer_create(device, LS_APP_MEMORY_READBACK, output_bytes(capacity),
                                      &tracer->output, error);
    }
    // A CPU device works on the host's memory anyway.
    if (result == LS_OK && !device->is_cpu)
    {
        result = ls_app_buffer_create(device, LS_APP_MEMORY_DEVICE, input_bytes(capacity),
                                      &tracer->device_input, error);
        if (result == LS_OK)
        {
            result = ls_app_buffer_create(device, LS_APP_MEMORY_DEVICE, output_bytes(capacity),
                                          &tracer->device_output, error);
        }
    }
    if (result != LS_OK)
    {
        ls_app_tracer_destroy(device, tracer);
        return result;
    }
    tracer->rays = tracer->input.mapped;
    tracer->masks = (uint32_t*)(tracer->rays + capacity);
    tracer->hits = tracer->output.mapped;
    return LS_OK;
}

void ls_app_tracer_destroy(const LsAppDevice* device, LsAppTracer* tracer)
{
    ls_app_buffer_destroy(device, &tracer->input);
    ls_app_buffer_destroy(device, &tracer->output);
    ls_app_buffer_destroy(device, &tracer->device_input);
    ls_app_buffer_destroy(device, &tracer->device_output);
    ls_app_buffer_destroy(device, &tracer->scratch);
    *tracer = (LsAppTracer){0};
}

static bool takes_two_passes(const LsAppDevice* device, const LsAppRun* run)
{
    return run->passes == LS_APP_TWO_PASSES ||
           (run->passes == LS_APP_PASSES_BEST && !device->is_cpu);
}

static LsResult record_run(const LsAppDevice* device, LsAppTracer* tracer, LsScene* scene,
                           const LsAppRun* run, VkCommandBuffer commands, LsError* error)
{
    bool staged = !device->is_cpu && run->ray_count > 0;
    VkDeviceSize masks_offset = (VkDeviceSize)tracer->capacity * sizeof(LsRay);
    if (staged)
    {
        VkBufferCopy copies[2] = {
            {.size = (VkDeviceSize)run->ray_count * sizeof(LsRay)},
            {
                .srcOffset = masks_offset,
                .dstOffset = masks_offset,
                .size = (VkDeviceSize)run->ray_count * sizeof(uint32_t),
            },
        };
        vkCmdCopyBuffer(commands, tracer->input.buffer, tracer->device_input.buffer,
                        run->use_masks ? 2 : 1, copies);
    }
    ls_app_commands_barrier(commands);

    VkDeviceAddress input = staged ? tracer->device_input.address : tracer->input.address;
    LsTraceDesc trace = {
        .rays = input,
        .hits = staged ? tracer->device_output.address : tracer->output.address,
        .masks = run->use_masks ? input + masks_offset : 0,
        .ray_count = run->ray_count,
        .flags = run->flags,
        .method = run->method,
        .scratch = takes_two_passes(device, run) ? tracer->scratch.address : 0,
    };
    ls_app_clock_begin(device, commands);
    LsResult result = ls_trace_record(scene, commands, &trace, error);
    ls_app_clock_end(device, commands);
    ls_app_commands_barrier(commands);

    if (staged)
    {
        VkBufferCopy copy = {.size = (VkDeviceSize)run->ray_count * sizeof(LsHit)};
        vkCmdCopyBuffer(commands, tracer->device_output.buffer, tracer->output.buffer, 1, &copy);
        ls_app_commands_barrier(commands);
    }
    return result;
}

// No answer of a ray that the device gave up on passes for one.
static LsResult check_whole(const LsAppTracer* tracer, const LsAppRun* run, LsError* error)
{
    const LsHit* hits = tracer->output.mapped;
    for (uint32_t i = 0; i < run->ray_count; i++)
    {
        if ((hits[i].flags & LS_HIT_CUT) != 0)
        {
            return ls_error_set(
                error, LS_MESSAGE_DEVICE_LOOPS,
                "the device ended the loops of a ray before their time, as llvmpipe "
                "does after 65535 rounds; the scene needs another device");
        }
    }
    return LS_OK;
}

// Grows the scratch memory to what the run can use.
static LsResult provide_scratch(const LsAppDevice* device, LsAppTracer* tracer,
                                const LsScene* scene, const LsAppRun* run, LsError* error)
{
    const uint64_t bytes = ls_trace_scratch_bytes(scene, run->ray_count);
    if (!takes_two_passes(device, run) || bytes <= tracer->scratch.bytes)
    {
        return LS_OK;
    }
    ls_app_buffer_destroy(device, &tracer->scratch);
    return ls_app_buffer_create(device, LS_APP_MEMORY_DEVICE, bytes, &tracer->scratch, error);
}

LsResult ls_app_tracer_run(const LsAppDevice* device, LsAppTracer* tracer, LsScene* scene,
                           const LsAppRun* run, double* seconds, LsError* error)
{
    VkCommandBuffer commands;
    LsResult result = provide_scratch(device, tracer, scene, run, error);
    if (result == LS_OK)
    {
        result = ls_app_commands_begin(device, &commands, error);
    }
    if (result != LS_OK)
    {
        return result;
    }
    result = record_run(device, tracer, scene, run, commands, error);
    if (result != LS_OK)
    {
        ls_app_commands_drop(device, commands);
        return result;
    }
    result = ls_app_commands_submit(device, commands, error);
    double unused;
    result =
        result != LS_OK ? result : ls_app_clock_read(device, seconds ? seconds : &unused, error);
    return result != LS_OK ? result : check_whole(tracer, run, error);
}
