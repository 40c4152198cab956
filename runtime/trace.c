#include "scene.h"

static const uint32_t KNOWN_FLAGS =
    LS_RAY_FLAG_ANY_HIT | LS_RAY_FLAG_CULL_BACK_FACING | LS_RAY_FLAG_CULL_FRONT_FACING;

static LsResult check_desc(const LsTraceDesc* desc, LsError* error)
{
    if ((uint32_t)desc->method >= LS_TRACE_METHOD_COUNT)
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_METHOD, "trace: unknown method %d",
                            (int)desc->method);
    }
    if ((desc->flags & ~KNOWN_FLAGS) != 0)
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_FLAGS, "trace: unknown ray flags 0x%X",
                            desc->flags & ~KNOWN_FLAGS);
    }
    if (desc->times != 0)
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_TIMES,
                            "trace: times must be 0, files have no motion yet");
    }
    if (desc->ray_count > 1u << 31)
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_COUNT,
                            "trace: %u rays are more than 2^31 in one call", desc->ray_count);
    }
    if (desc->ray_count != 0 && (desc->rays == 0 || desc->hits == 0))
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_ADDRESS, "trace: rays and hits need addresses");
    }
    if (desc->rays % 16 != 0 || desc->hits % 16 != 0 || desc->masks % 4 != 0 ||
        desc->scratch % 64 != 0)
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_ADDRESS,
                            "trace: rays and hits must be 16-byte aligned, masks 4-byte aligned, "
                            "scratch 64-byte aligned");
    }
    return LS_OK;
}

// Rays of one dispatch in groups of `group_size`: as many as the device allows groups, but few
// enough that 32 bits hold every byte offset in their arrays.
static uint64_t find_dispatch_limit(const LsContext* context, uint32_t group_size)
{
    const uint64_t by_groups = (uint64_t)context->max_group_count * group_size;
    const uint64_t by_bytes = (1u << 30) / sizeof(LsGridRay) / group_size * group_size;
    return by_groups < by_bytes ? by_groups : by_bytes;
}

static LsTraceParams slice_batch(const LsScene* scene, const LsTraceDesc* desc, uint64_t first,
                                 uint64_t limit)
{
    const uint64_t rest = desc->ray_count - first;
    return (LsTraceParams){
        .scene = scene->trace,
        .rays = desc->rays + first * sizeof(LsRay),
        .hits = desc->hits + first * sizeof(LsHit),
        .masks = desc->masks ? desc->masks + first * sizeof(uint32_t) : 0,
        .ray_count = (uint32_t)(rest < limit ? rest : limit),
        .flags = desc->flags,
    };
}

static void dispatch(const LsScene* scene, VkCommandBuffer commands, VkPipeline pipeline,
                     const void* params, uint32_t param_bytes, uint64_t group_count)
{
    const LsContext* context = scene->context;
    context->vk.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    if (scene->texels.set != VK_NULL_HANDLE)
    {
        context->vk.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                                          scene->kernel.layout, 0, 1, &scene->texels.set, 0, NULL);
    }
    context->vk.CmdPushConstants(commands, scene->kernel.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                 param_bytes, params);
    context->vk.CmdDispatch(commands, (uint32_t)group_count, 1, 1);
}

// What earlier dispatches wrote is seen by later ones, which may overwrite what those read.
static void await_dispatch(const LsScene* scene, VkCommandBuffer commands)
{
    const VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT,
    };
    scene->context->vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                          VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1, &barrier, 0,
                                          NULL, 0, NULL);
}

static void record_whole(const LsScene* scene, VkCommandBuffer commands, const LsTraceDesc* desc)
{
    const uint64_t limit = find_dispatch_limit(scene->context, LS_TRACE_GROUP_SIZE);
    for (uint64_t first = 0; first < desc->ray_count; first += limit)
    {
        const LsTraceParams params = slice_batch(scene, desc, first, limit);
        dispatch(scene, commands, scene->kernel.whole[desc->method], &params, sizeof params,
                 (params.ray_count + LS_TRACE_GROUP_SIZE - 1) / LS_TRACE_GROUP_SIZE);
    }
}

static void record_lockstep(const LsScene* scene, VkCommandBuffer commands, const LsTraceDesc* desc)
{
    const uint32_t group_rays = scene->context->shared_lanes * scene->lane_rays;
    const uint64_t limit = find_dispatch_limit(scene->context, group_rays);
    for (uint64_t first = 0; first < desc->ray_count; first += limit)
    {
        const LsTraceParams slice = slice_batch(scene, desc, first, limit);
        const LsLockstepParams params = {
            .grid_lower = scene->grid.grid_lower,
            .inverse_cell = scene->grid.inverse_cell,
            .cells = {scene->grid.cells[0], scene->grid.cells[1], scene->grid.cells[2]},
            .flags = scene->grid.flags | desc->flags,
            .rays = slice.rays,
            .hits = slice.hits,
            .masks = slice.masks,
            .ray_count = slice.ray_count,
            .instance_count = scene->trace.instance_count,
            .grid_instance = scene->grid.instance,
            .grid_object = scene->grid.object,
            .first_triangle = scene->grid.first_triangle,
        };
        dispatch(scene, commands, scene->kernel.lockstep, &params, sizeof params,
                 ((uint64_t)slice.ray_count + group_rays - 1) / group_rays);
        // Rays whose group ran out of rounds, which few do, once more by themselves.
        const uint32_t block = scene->context->shared_lanes * LS_BLOCK_LANE_RAYS;
        LsTraceParams rest = slice;
        rest.flags |= block << LS_TRACE_BLOCK;
        await_dispatch(scene, commands);
        const uint64_t block_count = ((uint64_t)rest.ray_count + block - 1) / block;
        dispatch(scene, commands, scene->kernel.whole[LS_TRACE_EXACT], &rest, sizeof rest,
                 (block_count + LS_TRACE_GROUP_SIZE - 1) / LS_TRACE_GROUP_SIZE);
    }
}

// Groups of lanes that refill: more than any device runs at a time; those that come late find no
// ray left.
#define MAX_REFILLING_GROUPS 8192u

static void record_passes(const LsScene* scene, VkCommandBuffer commands, const LsTraceDesc* desc)
{
    const bool refills = scene->context->max_loop_rounds == UINT64_MAX; // LS_REFILL
    const uint32_t lanes = scene->context->shared_lanes;
    const uint64_t limit = find_dispatch_limit(scene->context, lanes);
    for (uint64_t first = 0; first < desc->ray_count; first += limit)
    {
        const LsTraceParams slice = slice_batch(scene, desc, first, limit);
        LsListParams lists = {
            .instances = scene->lists.instances.address,
            .boxes = scene->lists.boxes.address,
            .triangles = scene->trace.triangles,
            .rays = slice.rays,
            .hits = slice.hits,
            .masks = slice.masks,
            .queue = desc->scratch,
            .ray_count = slice.ray_count,
            .flags = desc->flags,
            .list_count = scene->lists.list_count,
            .transform_bound = scene->lists.transform_bound,
            .begins = 1,
        };
        LsGridParams grid = scene->grid;
        grid.hits = slice.hits;
        grid.queue = desc->scratch;
        grid.flags |= desc->flags;
        const uint64_t group_count = ((uint64_t)slice.ray_count + lanes - 1) / lanes;
        if (first != 0)
        {
            await_dispatch(scene, commands);
        }
        dispatch(scene, commands, scene->kernel.lists, &lists, sizeof lists, 1); // empties it
        await_dispatch(scene, commands);
        lists.begins = 0;
        dispatch(scene, commands, scene->kernel.lists, &lists, sizeof lists, group_count);
        await_dispatch(scene, commands);
        dispatch(scene, commands, scene->kernel.grid, &grid, sizeof grid,
                 refills && group_count > MAX_REFILLING_GROUPS ? MAX_REFILLING_GROUPS
                                                               : group_count);
    }
}

uint64_t ls_trace_scratch_bytes(const LsScene* scene, uint32_t ray_count)
{
    if (!scene->has_passes || ray_count == 0)
    {
        return 0;
    }
    const uint64_t limit = find_dispatch_limit(scene->context, scene->context->shared_lanes);
    const uint64_t rays = ray_count < limit ? ray_count : limit;
    return sizeof(LsTraceQueue) + rays * sizeof(LsGridRay);
}

LsResult ls_trace_record(LsScene* scene, VkCommandBuffer commands, const LsTraceDesc* desc,
                         LsError* error)
{
    LsResult result = check_desc(desc, error);
    if (result != LS_OK)
    {
        return result;
    }
    const LsContext* context = scene->context;
    if (scene->kernel.whole[desc->method] == VK_NULL_HANDLE)
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_METHOD,
                            "trace: methods that measure need a context with `measures` set");
    }
    if (desc->method == LS_TRACE_BRUTE && scene->brute_rounds > context->max_loop_rounds)
    {
        return ls_error_set(error, LS_MESSAGE_DEVICE_LOOPS,
                            "trace: llvmpipe ends loops after 65535 rounds, too few for brute "
                            "force over this scene: "
                            "choose a GPU or trace exactly");
    }
    if (desc->method == LS_TRACE_EXACT && desc->scratch != 0 && scene->has_passes)
    {
        record_passes(scene, commands, desc);
    }
    else if (desc->method == LS_TRACE_EXACT && scene->lane_rays != 0)
    {
        record_lockstep(scene, commands, desc);
    }
    else
    {
        record_whole(scene, commands, desc);
    }
    return LS_OK;
}
