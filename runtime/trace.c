#include "scene.h"

static const uint32_t KNOWN_FLAGS =
    LS_RAY_FLAG_ANY_HIT | LS_RAY_FLAG_CULL_BACK_FACING | LS_RAY_FLAG_CULL_FRONT_FACING;

static const uint32_t MAX_GROUPS = (1u << 30) / (LS_TRACE_GROUP_SIZE * (uint32_t)sizeof(LsRay));

static LsResult check_desc(const LsTraceDesc* desc, LsError* error)
{
    if (desc->method != LS_TRACE_EXACT && desc->method != LS_TRACE_BRUTE)
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
    if (desc->rays % 16 != 0 || desc->hits % 16 != 0 || desc->masks % 4 != 0)
    {
        return ls_error_set(error, LS_MESSAGE_TRACE_ADDRESS,
                            "trace: rays and hits must be 16-byte aligned, masks 4-byte aligned");
    }
    return LS_OK;
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
    if (desc->method == LS_TRACE_BRUTE && scene->brute_rounds > context->max_loop_rounds)
    {
        return ls_error_set(error, LS_MESSAGE_DEVICE_LOOPS,
                            "trace: llvmpipe ends loops after 65535 rounds, too few for brute "
                            "force over this scene: "
                            "choose a GPU or trace exactly");
    }
    context->vk.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                                scene->kernel.pipelines[desc->method]);

    // One dispatch takes as many rays as the device allows work groups, but few enough that 32 bits
    // hold every byte offset in its arrays.
    uint32_t group_limit =
        context->max_group_count < MAX_GROUPS ? context->max_group_count : MAX_GROUPS;
    uint64_t limit = (uint64_t)group_limit * LS_TRACE_GROUP_SIZE;
    for (uint64_t first = 0; first < desc->ray_count; first += limit)
    {
        uint64_t rest = desc->ray_count - first;
        LsTraceParams params = {
            .scene = scene->trace,
            .rays = desc->rays + first * sizeof(LsRay),
            .hits = desc->hits + first * sizeof(LsHit),
            .masks = desc->masks ? desc->masks + first * sizeof(uint32_t) : 0,
            .ray_count = (uint32_t)(rest < limit ? rest : limit),
            .flags = desc->flags,
        };
        context->vk.CmdPushConstants(commands, scene->kernel.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                     sizeof(params), &params);
        uint32_t groups = (params.ray_count + LS_TRACE_GROUP_SIZE - 1) / LS_TRACE_GROUP_SIZE;
        context->vk.CmdDispatch(commands, groups, 1, 1);
    }
    return LS_OK;
}
