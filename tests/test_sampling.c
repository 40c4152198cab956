// test_sampling.c - what the shaders draw, against the same in C and against what it should be.

#include "gpu.h"
#include "reference/ref_sampling.h"
#include "sampling_probe.h"
#include "sampling_probe_spv.h"
#include "test_random.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

#define PROBE_COUNT 100000u
#define PI 3.14159265358979323846

static LsProbeInput* inputs;
static LsProbeOutput* outputs;

// Corners from 1e-9 to 1e6 in size, up to a thousand sizes from the origin, turned, stretched,
// mirrored.
static void fill_inputs(void)
{
    LsRandom random = {7};
    for (uint32_t i = 0; i < PROBE_COUNT; i++)
    {
        LsProbeInput* probe = &inputs[i];
        double size = pow(10.0, ls_random_between(&random, -9.0, 6.0));
        double away = size * pow(10.0, ls_random_between(&random, -3.0, 3.0));
        float corners[3][3];
        double normal[3];
        double length = 0.0;
        for (int k = 0; k < 3; k++)
        {
            double middle = ls_random_between(&random, -away, away);
            for (int c = 0; c < 3; c++)
            {
                corners[c][k] = (float)(middle + ls_random_between(&random, -size, size));
            }
            normal[k] = ls_random_between(&random, -1.0, 1.0);
            length += normal[k] * normal[k];
        }
        length = sqrt(length);
        probe->triangle.v0 = (LsVec3){corners[0][0], corners[0][1], corners[0][2]};
        probe->triangle.v1 = (LsVec3){corners[1][0], corners[1][1], corners[1][2]};
        probe->triangle.v2 = (LsVec3){corners[2][0], corners[2][1], corners[2][2]};
        probe->normal = (LsVec3){(float)(normal[0] / length), (float)(normal[1] / length),
                                 (float)(normal[2] / length)};
        double angle = ls_random_between(&random, 0.0, 2.0 * PI);
        double stretch = ls_random_between(&random, 0.5, 2.0);
        int mirrored = i % 2 == 1;
        float c = (float)(cos(angle) * stretch);
        float s = (float)(sin(angle) * stretch);
        probe->instance.world_from_object[0] = (LsVec4){mirrored ? -c : c, s, 0.0f, (float)size};
        probe->instance.world_from_object[1] = (LsVec4){mirrored ? s : -s, c, 0.0f, (float)-size};
        probe->instance.world_from_object[2] = (LsVec4){0.0f, 0.0f, 1.0f, 0.0f};
        probe->instance.flags = mirrored ? LS_INSTANCE_MIRRORED : 0;
        probe->transform_bound = i % 3 == 0 ? 1e-6f : 0.0f;
        for (int k = 0; k < 4; k++)
        {
            probe->place[k] = i < 64 ? i >> k : ls_random_word(&random);
        }
    }
    inputs[0].normal = (LsVec3){0.0f, 0.0f, 1.0f};
    inputs[1].normal = (LsVec3){0.0f, 0.0f, -1.0f};
    inputs[2].normal = (LsVec3){-0.0f, 1.0f, -0.0f};
    inputs[3].normal = (LsVec3){1.0f, 0.0f, 0.0f};
}

static void dispatch(const LsAppDevice* device, VkPipelineLayout layout, VkPipeline pipeline)
{
    LsError error = {0};
    LsAppBuffer in;
    LsAppBuffer out;
    VkDeviceSize in_bytes = PROBE_COUNT * sizeof(LsProbeInput);
    VkDeviceSize out_bytes = PROBE_COUNT * sizeof(LsProbeOutput);
    assert_int_equal(ls_app_buffer_create(device, LS_APP_MEMORY_UPLOAD, in_bytes, &in, &error),
                     LS_OK);
    assert_int_equal(ls_app_buffer_create(device, LS_APP_MEMORY_READBACK, out_bytes, &out, &error),
                     LS_OK);
    memcpy(in.mapped, inputs, in_bytes);
    LsProbeParams params = {.inputs = in.address, .outputs = out.address, .count = PROBE_COUNT};
    VkCommandBuffer commands;
    assert_int_equal(ls_app_commands_begin(device, &commands, &error), LS_OK);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof params, &params);
    vkCmdDispatch(commands, (PROBE_COUNT + 63) / 64, 1, 1);
    ls_app_commands_barrier(commands);
    assert_int_equal(ls_app_commands_submit(device, commands, &error), LS_OK);
    memcpy(outputs, out.mapped, out_bytes);
    ls_app_buffer_destroy(device, &out);
    ls_app_buffer_destroy(device, &in);
}

static int run_probe(void** state)
{
    (void)state;
    inputs = calloc(PROBE_COUNT, sizeof(LsProbeInput));
    outputs = calloc(PROBE_COUNT, sizeof(LsProbeOutput));
    fill_inputs();

    LsGpu gpu;
    ls_gpu_open(&gpu);
    VkDevice device = gpu.device.device;
    VkPushConstantRange range = {.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
                                 .size = sizeof(LsProbeParams)};
    VkPipelineLayoutCreateInfo layout_info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .pushConstantRangeCount = 1,
        .pPushConstantRanges = &range,
    };
    VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = sizeof sampling_probe_spv,
        .pCode = sampling_probe_spv,
    };
    VkPipelineLayout layout;
    VkShaderModule module;
    VkPipeline pipeline;
    assert_int_equal(vkCreatePipelineLayout(device, &layout_info, NULL, &layout), VK_SUCCESS);
    assert_int_equal(vkCreateShaderModule(device, &module_info, NULL, &module), VK_SUCCESS);
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main"},
        .layout = layout,
    };
    assert_int_equal(vkCreateComputePipelines(device, VK_NULL_HANDLE, 1, &info, NULL, &pipeline),
                     VK_SUCCESS);
    dispatch(&gpu.device, layout, pipeline);
    vkDestroyPipeline(device, pipeline, NULL);
    vkDestroyShaderModule(device, module, NULL);
    vkDestroyPipelineLayout(device, layout, NULL);
    ls_gpu_close(&gpu);
    return 0;
}

static int free_probe(void** state)
{
    (void)state;
    free(outputs);
    free(inputs);
    return 0;
}

static void test_random_bits_equal(void** state)
{
    (void)state;
    for (uint32_t i = 0; i < PROBE_COUNT; i++)
    {
        uint32_t bits[4];
        float random[4];
        const uint32_t* place = inputs[i].place;
        ls_ref_random_bits(place[0], place[1], place[2], place[3], bits);
        ls_ref_random(place[0], place[1], place[2], place[3], random);
        assert_memory_equal(bits, outputs[i].bits, sizeof bits);
        assert_memory_equal(random, &outputs[i].random, sizeof random);
        for (int k = 0; k < 4; k++)
        {
            assert_true(random[k] >= 0.0f && random[k] < 1.0f);
        }
    }
}

static void test_cos_sin_equal(void** state)
{
    (void)state;
    double worst = 0.0;
    for (uint32_t i = 0; i < PROBE_COUNT; i++)
    {
        float turn = outputs[i].random.y;
        float cos_sin[2];
        ls_ref_cos_sin_turn(turn, cos_sin);
        assert_memory_equal(&cos_sin[0], &outputs[i].cosine, sizeof(float));
        assert_memory_equal(&cos_sin[1], &outputs[i].sine, sizeof(float));
        worst = fmax(worst, fabs(cos_sin[0] - cos(2.0 * PI * turn)));
        worst = fmax(worst, fabs(cos_sin[1] - sin(2.0 * PI * turn)));
    }
    print_message("sine and cosine of turns: largest error %.3g\n", worst);
    assert_true(worst < 0x1.8p-24);
}

// All multiples of 2^-24 that a random number can be would take a while; the ends and the quarter
// turns must hold.
static void test_cos_sin_at_quarters(void** state)
{
    (void)state;
    static const float TURNS[] = {0.0f,   0.125f, 0.25f,  0.375f,         0.5f,
                                  0.625f, 0.75f,  0.875f, 0x1.fffffep-1f, 1.0f};
    for (size_t i = 0; i < sizeof TURNS / sizeof TURNS[0]; i++)
    {
        float cos_sin[2];
        ls_ref_cos_sin_turn(TURNS[i], cos_sin);
        assert_true(fabs(cos_sin[0] - cos(2.0 * PI * TURNS[i])) < 0x1.8p-24);
        assert_true(fabs(cos_sin[1] - sin(2.0 * PI * TURNS[i])) < 0x1.8p-24);
    }
}

static void test_hemisphere(void** state)
{
    (void)state;
    double worst = 0.0;
    for (uint32_t i = 0; i < PROBE_COUNT; i++)
    {
        LsVec3 n = inputs[i].normal;
        const double normal[3] = {n.x, n.y, n.z};
        const float random[2] = {outputs[i].random.x, outputs[i].random.y};
        double direction[3];
        ls_ref_sample_hemisphere(normal, random, direction);
        LsVec3 d = outputs[i].direction;
        worst = fmax(worst, fmax(fmax(fabs(d.x - direction[0]), fabs(d.y - direction[1])),
                                 fabs(d.z - direction[2])));
        double cosine = d.x * normal[0] + d.y * normal[1] + d.z * normal[2];
        assert_true(fabs(cosine - sqrt(1.0 - random[0])) < 1e-6);
        assert_true(fabs((double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z - 1.0) < 2e-6);
    }
    print_message("hemisphere: largest difference of a component %.3g\n", worst);
    assert_true(worst < 1e-6);
}

// The mean of z^2 under cos / pi is 1/2, that of the disk's x, y is 0, x^2 + y^2 is uniform: five
// sigma of the means.
static void test_hemisphere_moments(void** state)
{
    (void)state;
    const double normal[3] = {0.0, 0.0, 1.0};
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < PROBE_COUNT; i++)
    {
        float random[4];
        double d[3];
        ls_ref_random(i, 0, 2, 0, random);
        ls_ref_sample_hemisphere(normal, random, d);
        sum[0] += d[0];
        sum[1] += d[1];
        sum[2] += d[2] * d[2];
    }
    double root = sqrt((double)PROBE_COUNT);
    assert_true(fabs(sum[0] / PROBE_COUNT) < 5.0 * 0.5 / root);
    assert_true(fabs(sum[1] / PROBE_COUNT) < 5.0 * 0.5 / root);
    assert_true(fabs(sum[2] / PROBE_COUNT - 0.5) < 5.0 * sqrt(1.0 / 12.0) / root);
}

static void test_triangle_weights(void** state)
{
    (void)state;
    double sum[2] = {0.0, 0.0};
    for (uint32_t i = 64; i < PROBE_COUNT; i++)
    {
        const float random[2] = {outputs[i].random.z, outputs[i].random.w};
        float weights[2];
        ls_ref_sample_triangle(random, weights);
        assert_memory_equal(weights, outputs[i].weights, sizeof weights);
        assert_true(weights[0] >= 0.0f && weights[1] >= 0.0f && weights[0] + weights[1] <= 1.0f);
        sum[0] += weights[0];
        sum[1] += weights[1];
    }
    double count = PROBE_COUNT - 64;
    assert_true(fabs(sum[0] / count - 1.0 / 3.0) < 5.0 * sqrt(1.0 / 18.0) / sqrt(count));
    assert_true(fabs(sum[1] / count - 1.0 / 3.0) < 5.0 * sqrt(1.0 / 18.0) / sqrt(count));
}

// The point lies off the exact triangle, along its exact normal, by less than half the distance
// kept from it.
static void test_surface(void** state)
{
    (void)state;
    double worst_off = 0.0;
    double worst_error = 0.0;
    for (uint32_t i = 0; i < PROBE_COUNT; i++)
    {
        const double weights[2] = {outputs[i].weights[0], outputs[i].weights[1]};
        LsRefSurface surface = ls_ref_surface(&inputs[i].triangle, &inputs[i].instance, weights,
                                              inputs[i].transform_bound);
        LsVec3 p = outputs[i].position;
        LsVec3 n = outputs[i].normal;
        double off = (p.x - surface.position[0]) * surface.normal[0] +
                     (p.y - surface.position[1]) * surface.normal[1] +
                     (p.z - surface.position[2]) * surface.normal[2];
        double along = n.x * surface.normal[0] + n.y * surface.normal[1] + n.z * surface.normal[2];
        assert_true(along > 0.999);
        worst_off = fmax(worst_off, fabs(off) / surface.error);
        worst_error = fmax(worst_error, fabs(outputs[i].error / surface.error - 1.0));
    }
    print_message("surface: off by at most %.3g of the distance kept, which differs by %.3g\n",
                  worst_off, worst_error);
    assert_true(worst_off < 0.5);
    assert_true(worst_error < 1e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_bits_equal),
        cmocka_unit_test(test_cos_sin_equal),
        cmocka_unit_test(test_cos_sin_at_quarters),
        cmocka_unit_test(test_hemisphere),
        cmocka_unit_test(test_hemisphere_moments),
        cmocka_unit_test(test_triangle_weights),
        cmocka_unit_test(test_surface),
    };
    return cmocka_run_group_tests(tests, run_probe, free_probe);
}
