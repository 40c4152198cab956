#include "gpu.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <string.h>

void ls_require(LsResult result, const LsError* error)
{
    if (result != LS_OK)
    {
        fail_msg("%s", error->text);
    }
}

void ls_gpu_open(LsGpu* gpu)
{
    *gpu = (LsGpu){0};
    LsError error;
    LsAppDeviceDesc desc = {0};
    ls_require(ls_app_device_create(&gpu->device, &desc, &error), &error);
    LsContextDesc context = ls_app_context_desc(&gpu->device);
    context.measures = true;
    ls_require(ls_context_create(&context, &gpu->context, &error), &error);
    ls_require(ls_app_tracer_create(&gpu->device, LS_GPU_BATCH, &gpu->tracer, &error), &error);
}

void ls_gpu_close(LsGpu* gpu)
{
    ls_app_tracer_destroy(&gpu->device, &gpu->tracer);
    ls_context_destroy(gpu->context);
    ls_app_device_destroy(&gpu->device);
    *gpu = (LsGpu){0};
}

void ls_gpu_scene_open(LsGpu* gpu, LsGpuScene* scene, const char* path)
{
    *scene = (LsGpuScene){0};
    LsError error;
    ls_require(ls_mapping_open(&scene->mapping, path, &error), &error);
    ls_require(ls_file_open(&scene->file, scene->mapping.bytes, scene->mapping.size, path, &error),
               &error);
    ls_require(ls_scene_create(gpu->context, &scene->file, path, &scene->scene, &error), &error);
}

void ls_gpu_scene_close(LsGpuScene* scene)
{
    ls_scene_destroy(scene->scene);
    ls_mapping_close(&scene->mapping);
    *scene = (LsGpuScene){0};
}

// Exact tracing must answer alike in one pass and in two. Of rays that take any hit only whether
// there is one can be compared.
static void require_same_in_passes(LsGpu* gpu, const LsGpuScene* scene, const LsAppRun* whole,
                                   const LsHit* hits)
{
    if (ls_trace_scratch_bytes(scene->scene, whole->ray_count) == 0)
    {
        return;
    }
    LsAppRun run = *whole;
    run.passes = LS_APP_TWO_PASSES;
    LsError error;
    ls_require(ls_app_tracer_run(&gpu->device, &gpu->tracer, scene->scene, &run, NULL, &error),
               &error);
    for (uint32_t i = 0; i < run.ray_count; i++)
    {
        const LsHit* other = &gpu->tracer.hits[i];
        const bool same = (run.flags & LS_RAY_FLAG_ANY_HIT) != 0
                              ? (other->instance == LS_NONE) == (hits[i].instance == LS_NONE)
                              : memcmp(other, &hits[i], sizeof *other) == 0;
        if (!same)
        {
            fail_msg("ray %u: t %g of primitive %u in two passes, %g of %u in one", i, other->t,
                     other->primitive, hits[i].t, hits[i].primitive);
        }
    }
}

double ls_gpu_trace(LsGpu* gpu, const LsGpuScene* scene, LsMethod method, uint32_t flags,
                    const LsRay* rays, const uint32_t* masks, uint64_t count, LsHit* hits)
{
    double total = 0;
    for (uint64_t first = 0; first < count; first += LS_GPU_BATCH)
    {
        uint32_t batch = count - first < LS_GPU_BATCH ? (uint32_t)(count - first) : LS_GPU_BATCH;
        memcpy(gpu->tracer.rays, rays + first, batch * sizeof(LsRay));
        if (masks)
        {
            memcpy(gpu->tracer.masks, masks + first, batch * sizeof(uint32_t));
        }
        LsAppRun run = {.ray_count = batch,
                        .flags = flags,
                        .method = method,
                        .use_masks = masks != NULL,
                        .passes = LS_APP_ONE_PASS};
        double seconds;
        LsError error;
        ls_require(
            ls_app_tracer_run(&gpu->device, &gpu->tracer, scene->scene, &run, &seconds, &error),
            &error);
        memcpy(hits + first, gpu->tracer.hits, batch * sizeof(LsHit));
        if (method == LS_TRACE_EXACT)
        {
            require_same_in_passes(gpu, scene, &run, hits + first);
        }
        total += seconds;
    }
    return total;
}
