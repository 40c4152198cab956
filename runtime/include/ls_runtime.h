// ls_runtime.h - loads an .lspace file onto a Vulkan device and traces rays through it.
//
// The application owns instance, device, queue and command buffers and passes handles in. The
// library needs Vulkan 1.2 with bufferDeviceAddress and nothing else; no extension, no 64-bit
// integers, no 8- or 16-bit storage.
//
// Step by step:
//     LsContext* context;  ls_context_create(&(LsContextDesc){...}, &context, &error);
//     LsScene* scene;      ls_scene_create(context, &file, "scene.lspace", &scene, &error);
//     LsTraceDesc batch = {.rays = ..., .hits = ..., .ray_count = n};
//     ls_trace_record(scene, command_buffer, &batch, &error);
//     ... submit, wait; the hits are in the buffer ...
//     ls_scene_destroy(scene);  ls_context_destroy(context);
//
// What it does not do: create windows, instances or devices; import meshes; edit a baked file; keep
// global state. Calls on one context must not overlap; ls_trace_record may be called from any
// thread that owns its command buffer.

#ifndef LS_RUNTIME_H
#define LS_RUNTIME_H

#include "ls_format.h"

#include <stdbool.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C"
{
#endif

    typedef struct LsContext LsContext;
    typedef struct LsScene LsScene;

    // Handles borrowed for the context's life. The device must have been created with the features
    // bufferDeviceAddress (Vulkan 1.2) enabled; queue_family must support compute.
    typedef struct LsContextDesc
    {
        VkPhysicalDevice physical_device;
        VkDevice device;
        VkQueue queue; // used for uploads in ls_scene_create; externally synchronised by the caller
        uint32_t queue_family;
        // Both as the loader gave them; the library links no loader.
        VkInstance instance;
        PFN_vkGetInstanceProcAddr get_instance_proc_addr;
        // Scenes get LS_TRACE_GRID and LS_TRACE_COUNT too, and CPUs the kernels of two passes,
        // which takes time to compile.
        bool measures;
        // Arrays that grow with triangles and cells are cut into segments if they are larger than
        // so many bytes, rounded down to a power of two from 1 KiB to 1 GiB that the device can
        // allocate; each has memory of its own, of which devices may allow no more than 4096. 0:
        // the most.
        uint64_t segment_bytes;
    } LsContextDesc;

    // Errors: DEVICE_FEATURE, DEVICE_MEMORY, DEVICE, MEMORY. On failure *context is NULL.
    LsResult ls_context_create(const LsContextDesc* desc, LsContext** context, LsError* error);
    void ls_context_destroy(LsContext* context); // NULL is allowed

    // Checks the file's contents (ls_file_check), uploads it and compiles the pipelines its
    // features need. `file` and its bytes are needed only during the call. Blocks until the data is
    // on the device. `name` is for messages. Errors: RULE, DEVICE_MEMORY, DEVICE_LOST, DEVICE,
    // MEMORY. On failure *scene is NULL.
    LsResult ls_scene_create(LsContext* context, const LsFile* file, const char* name,
                             LsScene** scene, LsError* error);
    void ls_scene_destroy(LsScene* scene); // the device must be done with it; NULL is allowed

    // What shaders that include linespace.glsl trace by: to push, or to put into a uniform buffer.
    LsTraceScene ls_scene_trace(const LsScene* scene);

    // Device address of the scene's LsDeviceScene: the same and what shading reads.
    VkDeviceAddress ls_scene_address(const LsScene* scene);

    // Required features of the scene's file (LS_FEATURE_*), which are specialization constants of
    // shaders on it.
    uint64_t ls_scene_features(const LsScene* scene);

    // LS_CONSTANT_SEGMENT_LOG2 of shaders on the scene: 0 if no array is cut, else the log2 of a
    // segment's bytes.
    uint32_t ls_scene_segment_log2(const LsScene* scene);

    // Bytes of device memory that the scene holds.
    uint64_t ls_scene_device_bytes(const LsScene* scene);

    typedef enum LsMethod
    {
        LS_TRACE_EXACT = LS_METHOD_EXACT, // through the Line Space
        LS_TRACE_BRUTE = LS_METHOD_BRUTE, // all triangles, same test; slow
        // Of contexts with LsContextDesc.measures: the cells without shafts, to compare; and exact,
        // but hits tell the work (LS_METHOD_COUNT).
        LS_TRACE_GRID = LS_METHOD_GRID,
        LS_TRACE_COUNT = LS_METHOD_COUNT,
    } LsMethod;

    // One batch of rays. Buffers are device addresses from buffers with SHADER_DEVICE_ADDRESS
    // usage.
    typedef struct LsTraceDesc
    {
        VkDeviceAddress rays;  // LsRay[ray_count], 16-byte aligned
        VkDeviceAddress hits;  // LsHit[ray_count], 16-byte aligned
        VkDeviceAddress masks; // uint32_t[ray_count] of instance masks, or 0
        VkDeviceAddress times; // reserved: must be 0 until files with motion exist
        uint32_t ray_count;    // at most 2^31
        uint32_t flags;        // LS_RAY_FLAG_*
        LsMethod method;
        // Room of ls_trace_scratch_bytes for exact tracing in two passes, which is faster on scenes
        // with one grid; 64-byte aligned. Batches that share it need a barrier between them, from
        // compute shader reads and writes to the same. 0: one pass.
        VkDeviceAddress scratch;
    } LsTraceDesc;

    // Bytes of scratch memory that a batch of `ray_count` rays can use; 0 where the scene (more
    // than one instance with a grid, or none) or the device (subgroups that cannot share work;
    // CPUs, but for contexts that measure) has no use for it. It need not be initialised.
    uint64_t ls_trace_scratch_bytes(const LsScene* scene, uint32_t ray_count);

    // Records dispatches that trace the batch, and with them compute pipelines, push constants and,
    // on llvmpipe, descriptor set 0 of the compute bind point. The caller synchronises: rays must
    // be visible to compute shader reads before, hits are compute shader writes. Errors: ARGUMENT;
    // DEVICE_FEATURE for brute force on a scene larger than the device can loop over (llvmpipe:
    // half a million triangles).
    LsResult ls_trace_record(LsScene* scene, VkCommandBuffer commands, const LsTraceDesc* desc,
                             LsError* error);

#ifdef __cplusplus
}
#endif

#endif
