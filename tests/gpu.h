// gpu.h - for tests: a device, a file on it, rays in arrays to hits in arrays.
//
// Failures fail the calling cmocka test with the error's text; what the caller wants to see fail it
// does by the library's own calls.

#ifndef LS_TEST_GPU_H
#define LS_TEST_GPU_H

#include "app_trace.h"

// A device with a context and room for batches. Zeroed when closed.
typedef struct LsGpu
{
    LsAppDevice device;
    LsContext* context;
    LsAppTracer tracer;
} LsGpu;

// Rays that one submission takes; ls_gpu_trace cuts longer arrays into such batches.
#define LS_GPU_BATCH (1u << 16)

// Fails the calling test with the error's text unless the result is LS_OK.
void ls_require(LsResult result, const LsError* error);

// Opens the device that programs would choose.
void ls_gpu_open(LsGpu* gpu);
void ls_gpu_close(LsGpu* gpu);

// A file mapped, opened and uploaded. Zeroed when closed.
typedef struct LsGpuScene
{
    LsMapping mapping;
    LsFile file;
    LsScene* scene;
} LsGpuScene;

void ls_gpu_scene_open(LsGpu* gpu, LsGpuScene* scene, const char* path);
void ls_gpu_scene_close(LsGpuScene* scene);

// Traces rays[count] into hits[count]; masks[count] may be NULL, flags are LS_RAY_FLAG_*. Exact
// tracing is done in one pass and, where it is possible, in two, whose answers must be equal. Returns
// the seconds that the kernel took by the GPU's clock.
double ls_gpu_trace(LsGpu* gpu, const LsGpuScene* scene, LsMethod method, uint32_t flags,
                    const LsRay* rays, const uint32_t* masks, uint64_t count, LsHit* hits);

#endif
