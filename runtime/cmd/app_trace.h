// app_trace.h - traces batches of rays that lie in host memory: buffers, copies and clock around
// ls_trace_record. For programs that come with rays and want hits.

#ifndef LS_APP_TRACE_H
#define LS_APP_TRACE_H

#include "app_device.h"

// Room for one batch. Fill rays (and masks), call ls_app_tracer_run, read hits. Zeroed when
// destroyed.
typedef struct LsAppTracer
{
    uint32_t capacity; // rays of a batch
    LsRay* rays;       // capacity; the host writes
    uint32_t* masks;   // capacity; the host writes; used by runs that ask for masks
    const LsHit* hits; // capacity; the host reads
    LsAppBuffer input; // rays, then masks, as the host writes them
    LsAppBuffer output;
    LsAppBuffer device_input; // as the kernel sees them; zero where it sees the host's
    LsAppBuffer device_output;
    LsAppBuffer scratch; // for tracing in two passes; as large as a run has needed
} LsAppTracer;

// Bytes that input and output take together per ray.
#define LS_APP_TRACER_RAY_BYTES (sizeof(LsRay) + sizeof(uint32_t) + sizeof(LsHit))

// `capacity` >= 1. Errors: DEVICE_MEMORY, DEVICE, MEMORY. On failure *tracer is zero.
LsResult ls_app_tracer_create(const LsAppDevice* device, uint32_t capacity, LsAppTracer* tracer,
                              LsError* error);
void ls_app_tracer_destroy(const LsAppDevice* device,
                           LsAppTracer* tracer); // a zero tracer is allowed

// In how many passes exact rays are traced, where the scene and the device leave a choice.
typedef enum LsAppPasses
{
    LS_APP_PASSES_BEST, // two, but on CPUs, where one is faster
    LS_APP_ONE_PASS,
    LS_APP_TWO_PASSES,
} LsAppPasses;

// One run over the first `ray_count` rays, at most capacity.
typedef struct LsAppRun
{
    uint32_t ray_count;
    uint32_t flags; // LS_RAY_FLAG_*
    LsMethod method;
    bool use_masks;
    LsAppPasses passes;
} LsAppRun;

// Traces, waits, and says how long the kernel took by the GPU's clock, copies not counted;
// `seconds` may be NULL. Errors: DEVICE_MEMORY, DEVICE_LOST, DEVICE, MEMORY, ARGUMENT.
LsResult ls_app_tracer_run(const LsAppDevice* device, LsAppTracer* tracer, LsScene* scene,
                           const LsAppRun* run, double* seconds, LsError* error);

#endif
