// test_view.c - the path tracer against its reference and against closed forms, its average, and
// lsview itself.

#include "box_scene.h"
#include "gpu.h"
#include "ls_bake.h"
#include "ls_write.h"
#include "reference/ref_path.h"
#include "render.h"

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stb_image.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <tinyexr.h>
#include <unistd.h>

#define PI 3.14159265358979323846
#define WIDTH 160u
#define HEIGHT 90u
#define TILE 16u
#define FOLDER LS_BINARY_DIR "/test_view/"

extern char** environ;

static LsGpu gpu;

// A file on the device with a path tracer on it.
typedef struct View
{
    LsGpuScene scene;
    LsRender* render;
    LsRenderSettings settings;
} View;

static int open_gpu(void** state)
{
    (void)state;
    mkdir(FOLDER, 0777);
    ls_gpu_open(&gpu);
    return 0;
}

static int close_gpu(void** state)
{
    (void)state;
    ls_gpu_close(&gpu);
    return 0;
}

static void expect_ok(LsResult result, const LsError* error)
{
    if (result != LS_OK)
    {
        fail_msg("%s", error->text);
    }
}

static void set_view(View* view)
{
    LsError error = {0};
    expect_ok(ls_render_set(view->render, &view->settings, NULL, &error), &error);
}

static void open_view(View* view, const char* path, uint32_t width, uint32_t height, uint32_t depth)
{
    LsError error = {0};
    ls_gpu_scene_open(&gpu, &view->scene, path);
    expect_ok(
        ls_render_create(&gpu.device, view->scene.scene, &view->scene.file, &view->render, &error),
        &error);
    view->settings = (LsRenderSettings){
        .camera = ls_render_camera(&view->scene.file, (double)width / height),
        .width = width,
        .height = height,
        .depth = depth,
    };
    set_view(view);
}

static void open_box(View* view, LsBoxScene scene, float scale, uint32_t width, uint32_t height,
                     uint32_t depth)
{
    LsError error = {0};
    char path[500];
    snprintf(path, sizeof path, FOLDER "box%d_%g.lspace", (int)scene, (double)scale);
    expect_ok(ls_box_scene_write(scene, scale, path, &error), &error);
    open_view(view, path, width, height, depth);
}

static void close_view(View* view)
{
    ls_render_destroy(view->render);
    ls_gpu_scene_close(&view->scene);
}

// Renders up to `sample_count` samples; the caller frees the picture.
static float* render_view(View* view, uint32_t sample_count)
{
    LsError error = {0};
    float* rgba = malloc((size_t)view->settings.width * view->settings.height * sizeof(LsVec4));
    expect_ok(ls_render_run(view->render, sample_count, NULL, NULL, &error), &error);
    expect_ok(ls_render_read(view->render, rgba, &error), &error);
    assert_int_equal(ls_render_stats(view->render).sample_count, sample_count);
    assert_int_equal(ls_render_stats(view->render).invalid_samples, 0);
    return rgba;
}

static float* render_reference(const View* view, uint32_t sample_count, uint64_t* ray_count)
{
    const LsRenderSettings* settings = &view->settings;
    float* rgba = malloc((size_t)settings->width * settings->height * sizeof(LsVec4));
    LsRefPath* path = ls_ref_path_create(&view->scene.file);
    assert_non_null(path);
    *ray_count = ls_ref_path_render(path, &settings->camera, settings->width, settings->height,
                                    sample_count, settings->depth, settings->seed, rgba);
    ls_ref_path_destroy(path);
    return rgba;
}

static double clip(float x)
{
    return fmin(fmax(x, 0.0), 1.0);
}

static double measure_psnr(const float* a, const float* b, uint32_t width, uint32_t height)
{
    double sum = 0.0;
    for (size_t i = 0; i < (size_t)width * height; i++)
    {
        for (int c = 0; c < 3; c++)
        {
            double difference = clip(a[4 * i + c]) - clip(b[4 * i + c]);
            sum += difference * difference;
        }
    }
    return -10.0 * log10(sum / (3.0 * width * height));
}

// The largest difference of a tile's mean of one channel, as a fraction of b's.
static double measure_tiles(const float* a, const float* b, uint32_t width, uint32_t height)
{
    double worst = 0.0;
    for (uint32_t y0 = 0; y0 < height; y0 += TILE)
    {
        for (uint32_t x0 = 0; x0 < width; x0 += TILE)
        {
            double sum_a[3] = {0};
            double sum_b[3] = {0};
            for (uint32_t y = y0; y < y0 + TILE && y < height; y++)
            {
                for (uint32_t x = x0; x < x0 + TILE && x < width; x++)
                {
                    for (int c = 0; c < 3; c++)
                    {
                        sum_a[c] += clip(a[4 * ((size_t)y * width + x) + c]);
                        sum_b[c] += clip(b[4 * ((size_t)y * width + x) + c]);
                    }
                }
            }
            for (int c = 0; c < 3; c++)
            {
                const double difference = fabs(sum_a[c] - sum_b[c]);
                worst = fmax(worst, difference == 0.0 ? 0.0 : difference / sum_b[c]);
            }
        }
    }
    return worst;
}

static void compare_with_reference(View* view, uint32_t sample_count, const char* name)
{
    uint64_t reference_rays;
    float* picture = render_view(view, sample_count);
    float* reference = render_reference(view, sample_count, &reference_rays);
    double psnr = measure_psnr(picture, reference, view->settings.width, view->settings.height);
    double tiles = measure_tiles(picture, reference, view->settings.width, view->settings.height);
    uint64_t rays = ls_render_stats(view->render).ray_count;
    print_message("%s: PSNR %.1f dB, worst tile %.4f %%, %llu rays, reference %llu\n", name, psnr,
                  100.0 * tiles, (unsigned long long)rays, (unsigned long long)reference_rays);
    assert_true(psnr >= 45.0);
    assert_true(tiles <= 0.005);
    assert_true(fabs((double)rays / (double)reference_rays - 1.0) < 1e-3);
    free(reference);
    free(picture);
}

static void compare_box(LsBoxScene scene, float scale, uint32_t sample_count, uint32_t depth,
                        const char* name)
{
    View view;
    open_box(&view, scene, scale, WIDTH, HEIGHT, depth);
    compare_with_reference(&view, sample_count, name);
    close_view(&view);
}

static void test_reference_box(void** state)
{
    (void)state;
    compare_box(LS_BOX_CORNELL, 1.0f, 8, 5, "box");
}

static void test_reference_instances(void** state)
{
    (void)state;
    compare_box(LS_BOX_INSTANCES, 1.0f, 8, 5, "instances");
}

// The scene of the demo, baked as the demo bakes it.
static void test_reference_bunny(void** state)
{
    (void)state;
    static const LsBakeInput INPUTS[] = {{.path = LS_SOURCE_DIR "/scenes/cornell.gltf"},
                                         {.path = LS_SOURCE_DIR "/scenes/bunny.ply"}};
    LsError error = {0};
    LsBakeDesc desc = {
        .inputs = INPUTS, .input_count = 2, .output = FOLDER "cornell.lspace", .force = true};
    expect_ok(ls_bake_run(&desc, NULL, &error), &error);
    View view;
    open_view(&view, FOLDER "cornell.lspace", WIDTH, HEIGHT, 5);
    compare_with_reference(&view, 16, "box with bunny");
    close_view(&view);
}

static void test_reference_open(void** state)
{
    (void)state;
    compare_box(LS_BOX_OPEN, 1.0f, 16, 5, "open");
}

// Twelve segments, so that roulette decides in both alike.
static void test_reference_roulette(void** state)
{
    (void)state;
    compare_box(LS_BOX_CORNELL, 1.0f, 4, 12, "roulette");
}

static void test_reference_scales(void** state)
{
    (void)state;
    compare_box(LS_BOX_CORNELL, 1e-6f, 4, 5, "box at 1e-6");
    compare_box(LS_BOX_INSTANCES, 1e6f, 4, 5, "instances at 1e6");
}

// Scaled by a power of two nothing rounds differently, so if no absolute length hides anywhere, no
// bit changes.
static void test_scale_bits(void** state)
{
    (void)state;
    static const float SCALES[] = {1.0f, 0x1p-20f, 0x1p20f};
    float* pictures[3];
    for (int i = 0; i < 3; i++)
    {
        View view;
        open_box(&view, LS_BOX_CORNELL, SCALES[i], 64, 64, 5);
        pictures[i] = render_view(&view, 4);
        close_view(&view);
    }
    assert_memory_equal(pictures[0], pictures[1], 64 * 64 * sizeof(LsVec4));
    assert_memory_equal(pictures[0], pictures[2], 64 * 64 * sizeof(LsVec4));
    for (int i = 0; i < 3; i++)
    {
        free(pictures[i]);
    }
}

// Mean of all values of a picture and the standard error of that mean; pixels are independent, and
// channels are equal.
static double average_picture(const float* rgba, uint32_t count, double* deviation)
{
    double sum = 0.0;
    double squares = 0.0;
    for (uint32_t i = 0; i < count; i++)
    {
        sum += rgba[4 * i];
        squares += (double)rgba[4 * i] * rgba[4 * i];
    }
    double mean = sum / count;
    *deviation = sqrt(fmax(squares / count - mean * mean, 0.0) / count);
    return mean;
}

static void check_mean(LsBoxScene scene, float scale, uint32_t sample_count, uint32_t depth,
                       double expected)
{
    View view;
    open_box(&view, scene, scale, 64, 64, depth);
    float* picture = render_view(&view, sample_count);
    double deviation;
    double mean = average_picture(picture, 64 * 64, &deviation);
    print_message("scale %g, %u segments: %.6f +- %.6f, expected %.6f\n", (double)scale, depth,
                  mean, deviation, expected);
    assert_true(fabs(mean - expected) < 4.0 * deviation + 1e-5 * expected);
    assert_true(deviation < 5e-3 * expected);
    free(picture);
    close_view(&view);
}

// In a closed room whose walls emit 1 and reflect half, each further segment adds half of what the
// one before added. A ray that slips out between walls or starts behind one would find black.
static void test_furnace(void** state)
{
    (void)state;
    static const float SCALES[] = {1.0f, 1e-6f, 1e6f};
    for (int i = 0; i < 3; i++)
    {
        check_mean(LS_BOX_FURNACE, SCALES[i], 8, 1, 1.0);
        check_mean(LS_BOX_FURNACE, SCALES[i], 8, 5, 2.0 - ldexp(1.0, -4));
    }
    check_mean(LS_BOX_FURNACE, 1.0f, 8, 40, 2.0);
}

// Light from a rectangle straight above: the form factor of a parallel rectangle, four corners of
// it.
static void test_rectangle_light(void** state)
{
    (void)state;
    double a = 0.5;
    double b = 0.25;
    double sa = sqrt(1.0 + a * a);
    double sb = sqrt(1.0 + b * b);
    double factor = 4.0 / (2.0 * PI) * (a / sa * atan(b / sa) + b / sb * atan(a / sb));
    check_mean(LS_BOX_RECTANGLE, 1.0f, 64, 2, factor);
    check_mean(LS_BOX_RECTANGLE, 1e-6f, 16, 2, factor);
    check_mean(LS_BOX_RECTANGLE, 1e6f, 16, 2, factor);
}

static void test_average_constant(void** state)
{
    (void)state;
    View view;
    open_box(&view, LS_BOX_FURNACE, 1.0f, 4, 2, 1);
    float* picture = render_view(&view, 100000);
    for (int i = 0; i < 4 * 2 * 4; i++)
    {
        assert_true(picture[i] == 1.0f);
    }
    free(picture);
    close_view(&view);
}

static void test_average_noise(void** state)
{
    (void)state;
    View view;
    open_box(&view, LS_BOX_RECTANGLE, 1.0f, 4, 2, 2);
    uint64_t rays;
    float* picture = render_view(&view, 100000);
    float* reference = render_reference(&view, 100000, &rays);
    double worst = 0.0;
    for (int i = 0; i < 4 * 2 * 4; i++)
    {
        worst = fmax(worst, fabs(picture[i] / (double)reference[i] - 1.0));
    }
    print_message("after 100000 frames the average in float is off by %.3g\n", worst);
    assert_true(worst < 1e-4);
    free(reference);
    free(picture);
    close_view(&view);
}

static void test_average_steps(void** state)
{
    (void)state;
    View view;
    LsError error = {0};
    open_box(&view, LS_BOX_CORNELL, 1.0f, 40, 30, 5);
    float* whole = malloc(40 * 30 * sizeof(LsVec4));
    expect_ok(ls_render_step(view.render, 8, &error), &error);
    expect_ok(ls_render_read(view.render, whole, &error), &error);
    uint64_t rays = ls_render_stats(view.render).ray_count;

    view.settings.seed = 1;
    set_view(&view);
    view.settings.seed = 0;
    set_view(&view);
    static const uint32_t STEPS[] = {1, 3, 4};
    for (int i = 0; i < 3; i++)
    {
        expect_ok(ls_render_step(view.render, STEPS[i], &error), &error);
    }
    float* steps = render_view(&view, 8);
    assert_memory_equal(whole, steps, 40 * 30 * sizeof(LsVec4));
    assert_true(ls_render_stats(view.render).ray_count == rays);
    free(steps);
    free(whole);
    close_view(&view);
}

static void expect_reset(View* view, bool expected)
{
    LsError error = {0};
    bool reset = !expected;
    expect_ok(ls_render_step(view->render, 1, &error), &error);
    expect_ok(ls_render_set(view->render, &view->settings, &reset, &error), &error);
    assert_int_equal(reset, expected);
    uint32_t count = ls_render_stats(view->render).sample_count;
    assert_true(expected ? count == 0 : count > 0);
}

static void test_reset(void** state)
{
    (void)state;
    View view;
    open_box(&view, LS_BOX_CORNELL, 1.0f, 40, 30, 5);
    expect_reset(&view, false);
    view.settings.camera.world_from_camera[0].w += 0.01f;
    expect_reset(&view, true);
    expect_reset(&view, false);
    view.settings.camera.tan_half_y *= 1.5f;
    expect_reset(&view, true);
    view.settings.depth++;
    expect_reset(&view, true);
    view.settings.seed++;
    expect_reset(&view, true);
    view.settings.width = 50;
    expect_reset(&view, true);
    view.settings.height = 20;
    expect_reset(&view, true);
    view.settings.camera.aspect = 2.0f; // does not matter to the picture
    expect_reset(&view, false);

    // What is left after all that is the picture of the last settings alone.
    float* after = render_view(&view, 5);
    View fresh;
    open_box(&fresh, LS_BOX_CORNELL, 1.0f, 50, 20, 6);
    fresh.settings = view.settings;
    set_view(&fresh);
    float* clean = render_view(&fresh, 5);
    assert_memory_equal(after, clean, 50 * 20 * sizeof(LsVec4));

    LsError error = {0};
    view.settings.depth = 0;
    assert_int_equal(ls_render_set(view.render, &view.settings, NULL, &error), LS_ERROR_ARGUMENT);
    assert_int_equal(error.message, LS_MESSAGE_PICTURE_SETTINGS);
    free(clean);
    free(after);
    close_view(&fresh);
    close_view(&view);
}

// Runs lsview with `arguments` (NULL-terminated, without the program's name), output to FOLDER
// "log"; returns its exit code.
static int run_lsview(const char* const* arguments)
{
    char* argv[20] = {"lsview"};
    for (int i = 0; arguments[i]; i++)
    {
        argv[i + 1] = (char*)(uintptr_t)arguments[i];
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, FOLDER "log", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    pid_t child;
    assert_int_equal(
        posix_spawn(&child, LS_BINARY_DIR "/bin/lsview", &actions, NULL, argv, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

#define RUN(...) run_lsview((const char* const[]){__VA_ARGS__, NULL})

// What lsview printed, at most 4095 bytes.
static const char* read_log(void)
{
    static char text[4096];
    FILE* log = fopen(FOLDER "log", "rb");
    assert_non_null(log);
    text[fread(text, 1, sizeof text - 1, log)] = 0;
    fclose(log);
    return text;
}

static bool is_one_line(const char* text)
{
    const char* end = strchr(text, '\n');
    return end && end[1] == 0;
}

static void test_program_pictures(void** state)
{
    (void)state;
    LsError error = {0};
    View view;
    open_box(&view, LS_BOX_CORNELL, 1.0f, 90, 60, 4);
    view.settings.seed = 3;
    set_view(&view);
    float* expected = render_view(&view, 6);
    expect_ok(ls_box_scene_write(LS_BOX_CORNELL, 1.0f, FOLDER "scene.lspace", &error), &error);
    remove(FOLDER "out.png");
    assert_int_equal(RUN("--headless", FOLDER "scene.lspace", "-o", FOLDER "out.png", "--exr",
                         FOLDER "out.exr", "--size", "90x60", "--samples", "6", "--depth", "4",
                         "--seed", "3", "--report", "json"),
                     LS_EXIT_OK);
    const char* report = read_log();
    assert_non_null(strstr(report, "\"samples_per_pixel\":\t6"));
    assert_non_null(strstr(report, "\"rays_per_second\""));

    float* linear;
    int width;
    int height;
    const char* complaint = NULL;
    assert_int_equal(LoadEXR(&linear, &width, &height, FOLDER "out.exr", &complaint),
                     TINYEXR_SUCCESS);
    assert_int_equal(width, 90);
    assert_int_equal(height, 60);
    assert_memory_equal(linear, expected, 90 * 60 * sizeof(LsVec4));

    int channels;
    unsigned char* bytes = stbi_load(FOLDER "out.png", &width, &height, &channels, 0);
    assert_non_null(bytes);
    assert_int_equal(width, 90);
    assert_int_equal(height, 60);
    assert_int_equal(channels, 3);
    for (int i = 0; i < 90 * 60 * 3; i++)
    {
        double x = clip(expected[4 * (i / 3) + i % 3]);
        double y = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
        assert_true(fabs(bytes[i] - 255.0 * y) <= 0.501);
    }
    stbi_image_free(bytes);
    free(linear);
    free(expected);
    close_view(&view);
}

// Light beyond the range of float is black, and said so.
static void test_program_warns(void** state)
{
    (void)state;
    LsError error = {0};
    const char* path = FOLDER "bright.lspace";
    expect_ok(ls_box_scene_write(LS_BOX_FURNACE, 1e-3f, path, &error), &error);
    LsMapping mapping;
    LsFile file;
    expect_ok(ls_mapping_open(&mapping, path, &error), &error);
    expect_ok(ls_file_open(&file, mapping.bytes, mapping.size, path, &error), &error);
    LsFileDesc desc = ls_file_desc(&file);
    LsMaterial* materials = malloc(desc.MATERIALS_count * sizeof(LsMaterial));
    assert_non_null(materials);
    memcpy(materials, desc.materials, desc.MATERIALS_count * sizeof(LsMaterial));
    for (uint32_t i = 0; i < desc.MATERIALS_count; i++)
    {
        if ((materials[i].flags & LS_MATERIAL_EMISSIVE) != 0)
        {
            materials[i].emission = (LsVec3){3e38f, 3e38f, 3e38f};
        }
    }
    desc.materials = materials;
    expect_ok(ls_file_write(&desc, path, &error), &error);
    ls_mapping_close(&mapping);
    free(materials);
    assert_int_equal(RUN("--headless", path, "-o", FOLDER "bright.png", "--size", "8x8",
                         "--samples", "2", "--quiet"),
                     LS_EXIT_OK);
    assert_true(is_one_line(read_log()));
    char start[32];
    snprintf(start, sizeof start, "lsview: warning %d: ", (int)LS_MESSAGE_PICTURE_NOT_FINITE);
    assert_memory_equal(read_log(), start, strlen(start));
    assert_non_null(strstr(read_log(), "bright.lspace: 128 samples were not finite"));
}

static void test_program_errors(void** state)
{
    (void)state;
    LsError error = {0};
    const char* scene = FOLDER "scene.lspace";
    const char* png = FOLDER "none.png";
    expect_ok(ls_box_scene_write(LS_BOX_CORNELL, 1.0f, scene, &error), &error);
    FILE* cut = fopen(FOLDER "cut.lspace", "wb");
    fwrite("not a scene", 1, 11, cut);
    fclose(cut);
    remove(png);

    assert_int_equal(RUN("--help"), LS_EXIT_OK);
    assert_non_null(strstr(read_log(), "--samples"));
    assert_int_equal(RUN("--version"), LS_EXIT_OK);
    assert_true(is_one_line(read_log()));

    const struct
    {
        const char* arguments[8];
        LsMessage message;
    } cases[] = {
        {{scene}, LS_MESSAGE_LSVIEW_WINDOW},
        {{"--headless", scene}, LS_MESSAGE_LSVIEW_FILES},
        {{"--headless", "-o", png}, LS_MESSAGE_LSVIEW_FILES},
        {{"--headless", scene, "-o"}, LS_MESSAGE_LSVIEW_OPTION},
        {{"--headless", scene, "-o", png, "--wrong"}, LS_MESSAGE_LSVIEW_OPTION},
        {{"--headless", scene, "-o", png, "--size", "0x10"}, LS_MESSAGE_LSVIEW_VALUE},
        {{"--headless", scene, "-o", png, "--samples", "12x"}, LS_MESSAGE_LSVIEW_VALUE},
        {{"--headless", scene, "-o", png, "--report", "xml"}, LS_MESSAGE_LSVIEW_VALUE},
        {{"--headless", scene, "-o", png, "--exr", png}, LS_MESSAGE_LSVIEW_REPLACES},
        {{"--headless", scene, "-o", scene}, LS_MESSAGE_LSVIEW_REPLACES},
        {{"--headless", FOLDER "missing.lspace", "-o", png}, LS_MESSAGE_FILE_MISSING},
        {{"--headless", FOLDER "cut.lspace", "-o", png}, LS_MESSAGE_LSPACE_FOREIGN},
        {{"--headless", scene, "-o", FOLDER}, LS_MESSAGE_OUTPUT_IS_FOLDER},
        {{"--headless", scene, "-o", "/dev/null"}, LS_MESSAGE_OUTPUT_NOT_REGULAR},
        {{"--headless", scene, "-o", FOLDER "no/such/folder.png"}, LS_MESSAGE_OUTPUT_UNWRITABLE},
        {{"--headless", scene, "-o", png, "--device", "no such device"}, LS_MESSAGE_DEVICE_NAME},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
    {
        char start[32];
        snprintf(start, sizeof start, "lsview: error %d: ", (int)cases[i].message);
        assert_int_equal(run_lsview(cases[i].arguments),
                         ls_result_exit_code((LsResult)(cases[i].message / 100)));
        assert_true(is_one_line(read_log()));
        assert_memory_equal(read_log(), start, strlen(start));
        assert_int_equal(access(png, F_OK), -1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reference_box),
        cmocka_unit_test(test_reference_instances),
        cmocka_unit_test(test_reference_bunny),
        cmocka_unit_test(test_reference_open),
        cmocka_unit_test(test_reference_roulette),
        cmocka_unit_test(test_reference_scales),
        cmocka_unit_test(test_scale_bits),
        cmocka_unit_test(test_furnace),
        cmocka_unit_test(test_rectangle_light),
        cmocka_unit_test(test_average_constant),
        cmocka_unit_test(test_average_noise),
        cmocka_unit_test(test_average_steps),
        cmocka_unit_test(test_reset),
        cmocka_unit_test(test_program_pictures),
        cmocka_unit_test(test_program_warns),
        cmocka_unit_test(test_program_errors),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
