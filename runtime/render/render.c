#include "render.h"

#include "path_layout.h"
#include "path_spv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <vulkan/vulkan.h>

// Pixels of a work group; the smallest limit Vulkan allows devices is 128.
#define GROUP_SIZE 64u
#define GROUP_ROWS (GROUP_SIZE / LS_PATH_TILE_WIDTH)

// A dispatch takes as many samples as stay within this many segments of a path: more let threads
// whose paths are short go on without their neighbours, fewer keep clear of llvmpipe's bound of
// 65535 rounds of loops.
#define DISPATCH_SEGMENTS 32u

// Long enough to hide the cost of a submission, short enough for a progress bar and for drivers'
// watchdogs.
#define SUBMISSION_SECONDS 0.1

struct LsRender
{
    const LsAppDevice* device;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    LsAppBuffer image;    // vec4 per pixel, on the device
    LsAppBuffer readback; // the same, for the host
    LsAppBuffer counters; // LsPathCounters, on the device
    LsAppBuffer counters_readback;
    VkDeviceAddress scene;
    float light_density;
    LsRenderSettings settings;
    uint32_t sample_count;
};

static double now_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

LsCamera ls_render_camera(const LsFile* file, double aspect)
{
    if (ls_file_count(file, LS_CHUNK_CAMERAS) > 0)
    {
        return file->cameras[0];
    }
    const float* lower = file->header->lower;
    const float* upper = file->header->upper;
    double half[3];
    for (int i = 0; i < 3; i++)
    {
        half[i] = 0.5 * ((double)upper[i] - lower[i]);
    }

    // Far enough back for the sphere about the box to fit the narrower side of the picture.
    double radius = sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
    double tan_half_y = 0.4;
    double angle = atan(tan_half_y * fmin(1.0, aspect));
    double distance = radius / sin(angle);
    // From a little above and from the side: no plane of two axes is seen by its edge alone.
    double rise = 0.25;
    double turn = 0.3;
    double level = sqrt(1.0 - rise * rise);
    double ahead = sqrt(1.0 - turn * turn);
    double right[3] = {ahead, 0.0, -turn};
    double up[3] = {-turn * rise, level, -ahead * rise};
    double back[3] = {turn * level, rise, ahead * level};
    LsCamera camera = {.tan_half_y = (float)tan_half_y};
    for (int i = 0; i < 3; i++)
    {
        double center = 0.5 * ((double)lower[i] + upper[i]);
        const float row[4] = {(float)right[i], (float)up[i], (float)back[i],
                              (float)(center + distance * back[i])};
        memcpy(&camera.world_from_camera[i], row, sizeof row);
    }
    return camera;
}

// 1 / sum over lights of area times luminance: the density, per area and luminance, with which
// points of lights are drawn.
static float sum_light_density(const LsFile* file)
{
    double power = 0.0;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_LIGHTS); i++)
    {
        const LsLight* light = &file->lights[i];
        const LsObject* object = &file->objects[file->instances[light->instance].object];
        const LsTriangle* triangle = &file->triangles[object->first_triangle + light->triangle];
        LsVec3 emission = file->materials[triangle->material].emission;
        power += light->area * (0.2126 * emission.x + 0.7152 * emission.y + 0.0722 * emission.z);
    }
    return power > 0.0 ? (float)(1.0 / power) : 0.0f;
}

static LsResult create_pipeline(LsRender* render, const LsScene* scene, LsError* error)
{
    VkDevice device = render->device->device;
    VkPushConstantRange range = {
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        .size = sizeof(LsPathParams),
    };
    VkPipelineLayoutCreateInfo layout_info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &range,
    };
    VkResult code = vkCreatePipelineLayout(device, &layout_info, NULL, &render->layout);
    if (code != VK_SUCCESS)
    {
        render->layout = VK_NULL_HANDLE; // after a failure Vulkan leaves handles undefined
        return ls_app_vk_result(code, "vkCreatePipelineLayout", error);
    }

    VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = sizeof(path_spv),
        .pCode = path_spv,
    };
    VkShaderModule module;
    code = vkCreateShaderModule(device, &module_info, NULL, &module);
    if (code != VK_SUCCESS)
    {
        return ls_app_vk_result(code, "vkCreateShaderModule", error);
    }

    // Those of scene.glsl, the work group's size, and that of the path tracer.
    enum
    {
        GROUP = 1 + LS_FEATURE_COUNT,
        DEFERS,
        LIGHTS,
        SEGMENT,
        CONSTANTS
    };
    uint32_t values[CONSTANTS] = {LS_METHOD_EXACT};
    for (uint32_t i = 0; i < LS_FEATURE_COUNT; i++)
    {
        values[1 + i] = (ls_scene_features(scene) >> i) & 1;
    }
    values[GROUP] = GROUP_SIZE;
    values[DEFERS] = !render->device->is_cpu;
    values[LIGHTS] = render->light_density > 0.0f;
    values[SEGMENT] = ls_scene_segment_log2(scene);
    VkSpecializationMapEntry entries[CONSTANTS];
    for (uint32_t i = 0; i < CONSTANTS; i++)
    {
        entries[i] = (VkSpecializationMapEntry){.constantID = i, .offset = 4 * i, .size = 4};
    }
    entries[GROUP].constantID = LS_CONSTANT_GROUP_SIZE;
    entries[DEFERS].constantID = LS_CONSTANT_DEFERS;
    entries[LIGHTS].constantID = LS_CONSTANT_HAS_LIGHTS;
    entries[SEGMENT].constantID = LS_CONSTANT_SEGMENT_LOG2;
    VkSpecializationInfo specialization = {
        .mapEntryCount = CONSTANTS,
        .pMapEntries = entries,
        .dataSize = sizeof values,
        .pData = values,
    };
    VkComputePipelineCreateInfo pipeline_info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage =
            {
                .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module,
                .pName = "main",
                .pSpecializationInfo = &specialization,
            },
        .layout = render->layout,
    };
    code = vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &pipeline_info, NULL,
                                    &render->pipeline);
    vkDestroyShaderModule(device, module, NULL);
    return ls_app_vk_result(code, "vkCreateComputePipelines", error);
}

LsResult ls_render_create(const LsAppDevice* device, const LsScene* scene, const LsFile* file,
                          LsRender** render, LsError* error)
{
    *render = NULL;
    LsRender* created = calloc(1, sizeof(LsRender));
    if (!created)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "no memory for the path tracer");
    }
    created->device = device;
    created->scene = ls_scene_address(scene);
    created->light_density = sum_light_density(file);

    LsResult result = create_pipeline(created, scene, error);
    if (result == LS_OK)
    {
        result = ls_app_buffer_create(device, LS_APP_MEMORY_DEVICE, sizeof(LsPathCounters),
                                      &created->counters, error);
    }
    if (result == LS_OK)
    {
        result = ls_app_buffer_create(device, LS_APP_MEMORY_READBACK, sizeof(LsPathCounters),
                                      &created->counters_readback, error);
    }
    if (result != LS_OK)
    {
        ls_render_destroy(created);
        return result;
    }
    *render = created;
    return LS_OK;
}

void ls_render_destroy(LsRender* render)
{
    if (!render)
    {
        return;
    }
    ls_app_buffer_destroy(render->device, &render->counters_readback);
    ls_app_buffer_destroy(render->device, &render->counters);
    ls_app_buffer_destroy(render->device, &render->readback);
    ls_app_buffer_destroy(render->device, &render->image);
    vkDestroyPipeline(render->device->device, render->pipeline, NULL);
    vkDestroyPipelineLayout(render->device->device, render->layout, NULL);
    free(render);
}

static bool settings_equal(const LsRenderSettings* a, const LsRenderSettings* b)
{
    return memcmp(a->camera.world_from_camera, b->camera.world_from_camera,
                  sizeof a->camera.world_from_camera) == 0 &&
           a->camera.tan_half_y == b->camera.tan_half_y && a->width == b->width &&
           a->height == b->height && a->depth == b->depth && a->seed == b->seed;
}

static LsResult resize_image(LsRender* render, uint32_t width, uint32_t height, LsError* error)
{
    const LsAppDevice* device = render->device;
    VkDeviceSize bytes = (VkDeviceSize)width * height * sizeof(LsVec4);
    if (bytes == render->image.bytes)
    {
        return LS_OK;
    }
    ls_app_buffer_destroy(device, &render->readback);
    ls_app_buffer_destroy(device, &render->image);
    LsResult result =
        ls_app_buffer_create(device, LS_APP_MEMORY_DEVICE, bytes, &render->image, error);
    if (result == LS_OK)
    {
        result =
            ls_app_buffer_create(device, LS_APP_MEMORY_READBACK, bytes, &render->readback, error);
    }
    if (result != LS_OK)
    {
        ls_app_buffer_destroy(device, &render->image);
    }
    return result;
}

LsResult ls_render_set(LsRender* render, const LsRenderSettings* settings, bool* reset,
                       LsError* error)
{
    if (settings->width < 1 || settings->width > LS_RENDER_MAX_SIDE || settings->height < 1 ||
        settings->height > LS_RENDER_MAX_SIDE || settings->depth < 1 ||
        settings->depth > LS_RENDER_MAX_DEPTH)
    {
        return ls_error_set(error, LS_MESSAGE_PICTURE_SETTINGS,
                            "a picture has 1 to %u pixels a side and paths of 1 to %u segments",
                            LS_RENDER_MAX_SIDE, LS_RENDER_MAX_DEPTH);
    }
    bool same = settings_equal(settings, &render->settings);
    if (reset)
    {
        *reset = !same;
    }
    if (same)
    {
        return LS_OK;
    }
    // No settings equal these: after a failure the same call tries again.
    render->settings = (LsRenderSettings){0};
    render->sample_count = 0;
    memset(render->counters_readback.mapped, 0, sizeof(LsPathCounters));
    LsResult result = resize_image(render, settings->width, settings->height, error);
    if (result == LS_OK)
    {
        render->settings = *settings;
    }
    return result;
}

LsResult ls_render_step(LsRender* render, uint32_t sample_count, LsError* error)
{
    const LsRenderSettings* settings = &render->settings;
    LsPathParams params = {
        .scene = render->scene,
        .image = render->image.address,
        .counters = render->counters.address,
        .width = settings->width,
        .height = settings->height,
        .seed = settings->seed,
        .depth = settings->depth,
        .tan_half_y = settings->camera.tan_half_y,
        .light_density = render->light_density,
    };
    memcpy(params.world_from_camera, settings->camera.world_from_camera,
           sizeof params.world_from_camera);

    VkCommandBuffer commands;
    LsResult result = ls_app_commands_begin(render->device, &commands, error);
    if (result != LS_OK)
    {
        return result;
    }
    if (render->sample_count == 0)
    {
        vkCmdFillBuffer(commands, render->counters.buffer, 0, sizeof(LsPathCounters), 0);
        ls_app_commands_barrier(commands);
    }
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, render->pipeline);
    uint32_t most = settings->depth < DISPATCH_SEGMENTS ? DISPATCH_SEGMENTS / settings->depth : 1;
    for (uint32_t done = 0; done < sample_count; done += params.sample_count)
    {
        params.first_sample = render->sample_count + done;
        params.sample_count = sample_count - done < most ? sample_count - done : most;
        vkCmdPushConstants(commands, render->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof params,
                           &params);
        vkCmdDispatch(commands, (settings->width + LS_PATH_TILE_WIDTH - 1) / LS_PATH_TILE_WIDTH,
                      (settings->height + GROUP_ROWS - 1) / GROUP_ROWS, 1);
        ls_app_commands_barrier(commands);
    }
    VkBufferCopy region = {.size = sizeof(LsPathCounters)};
    vkCmdCopyBuffer(commands, render->counters.buffer, render->counters_readback.buffer, 1,
                    &region);
    ls_app_commands_barrier(commands);
    result = ls_app_commands_submit(render->device, commands, error);
    if (result == LS_OK)
    {
        render->sample_count += sample_count;
    }
    return result;
}

LsResult ls_render_run(LsRender* render, uint32_t sample_count, LsRenderProgress* progress,
                       void* user, LsError* error)
{
    uint32_t batch = 1;
    while (render->sample_count < sample_count)
    {
        uint32_t left = sample_count - render->sample_count;
        double begin = now_seconds();
        LsResult result = ls_render_step(render, batch < left ? batch : left, error);
        if (result != LS_OK)
        {
            return result;
        }
        double seconds = now_seconds() - begin;
        batch = seconds < 0.5 * SUBMISSION_SECONDS && batch < 1024 ? 2 * batch
                : seconds > 2.0 * SUBMISSION_SECONDS && batch > 1  ? batch / 2
                                                                   : batch;
        if (progress)
        {
            progress(user, render);
        }
    }
    return LS_OK;
}

LsRenderStats ls_render_stats(const LsRender* render)
{
    const LsPathCounters* counters = render->counters_readback.mapped;
    return (LsRenderStats){
        .sample_count = render->sample_count,
        .ray_count = (uint64_t)counters->rays_high << 32 | counters->rays_low,
        .invalid_samples = counters->invalid_samples,
    };
}

LsResult ls_render_read(LsRender* render, float* rgba, LsError* error)
{
    VkCommandBuffer commands;
    LsResult result = ls_app_commands_begin(render->device, &commands, error);
    if (result != LS_OK)
    {
        return result;
    }
    VkBufferCopy region = {.size = render->image.bytes};
    vkCmdCopyBuffer(commands, render->image.buffer, render->readback.buffer, 1, &region);
    ls_app_commands_barrier(commands);
    result = ls_app_commands_submit(render->device, commands, error);
    if (result == LS_OK)
    {
        memcpy(rgba, render->readback.mapped, render->image.bytes);
    }
    return result;
}
