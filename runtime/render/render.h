// render.h - a progressive path tracer on an LsScene: samples are added to a running average on the
// device.
//
// Diffuse surfaces, emissive triangles as lights, white surroundings where a scene has no lights;
// docs/rendering.md tells the algorithm, shaders/path.comp.glsl is it. Calls on one render must not
// overlap.

#ifndef LS_RENDER_H
#define LS_RENDER_H

#include "app_device.h"

#include <stdbool.h>

typedef struct LsRender LsRender;

#define LS_RENDER_MAX_SIDE 16384u
#define LS_RENDER_MAX_DEPTH 1024u

// What decides a picture. Change of any of it begins the average anew.
typedef struct LsRenderSettings
{
    LsCamera camera; // its matrix and tan_half_y; `aspect` is not used
    uint32_t width;  // pixels, 1..LS_RENDER_MAX_SIDE
    uint32_t height;
    uint32_t depth; // most segments of a path: 1 sees lights alone, 2 direct light
    uint32_t seed;  // other seeds give other noise
} LsRenderSettings;

typedef struct LsRenderStats
{
    uint32_t sample_count;    // per pixel, in the picture now
    uint64_t ray_count;       // all rays traced since the picture began, shadow rays too
    uint32_t invalid_samples; // were not finite and counted as black; 0 unless something is wrong
} LsRenderStats;

// The file's first camera or, if it has none, one that looks at the scene's box: along -z, from a
// little above and from the right.
LsCamera ls_render_camera(const LsFile* file, double aspect);

// Compiles the pipeline for `scene`, made from `file`; `file` is needed only during the call.
// Device and scene are borrowed. Errors: DEVICE_MEMORY, DEVICE, MEMORY. On failure *render is NULL.
LsResult ls_render_create(const LsAppDevice* device, const LsScene* scene, const LsFile* file,
                          LsRender** render, LsError* error);
void ls_render_destroy(LsRender* render); // NULL is allowed

// Takes settings over; the picture begins anew if they differ from those before, and then *reset
// (may be NULL) is true. Errors: ARGUMENT, DEVICE_MEMORY, DEVICE, MEMORY; the call may then be made
// again, with these or other settings.
LsResult ls_render_set(LsRender* render, const LsRenderSettings* settings, bool* reset,
                       LsError* error);

// Adds `sample_count` samples to every pixel in one submission and waits. Errors: DEVICE_LOST,
// DEVICE_MEMORY, DEVICE, MEMORY.
LsResult ls_render_step(LsRender* render, uint32_t sample_count, LsError* error);

// Called by ls_render_run after each submission.
typedef void LsRenderProgress(void* user, const LsRender* render);

// Steps until the picture holds `sample_count` samples per pixel, in submissions of about a tenth
// of a second.
LsResult ls_render_run(LsRender* render, uint32_t sample_count, LsRenderProgress* progress,
                       void* user, LsError* error);

LsRenderStats ls_render_stats(const LsRender* render);

// Copies the picture: width * height linear RGBA, rows from the top. Errors: as ls_render_step.
LsResult ls_render_read(LsRender* render, float* rgba, LsError* error);

#endif
