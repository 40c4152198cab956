#include "ref_path.h"

#include "ref_sampling.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define ROULETTE_SEGMENTS 5

struct LsRefPath
{
    const LsFile* file;
    RTCDevice device;
    RTCScene* objects; // one scene an object
    double light_density;
    uint64_t ray_count;
};

typedef struct Hit
{
    double t;
    double weights[2];
    uint32_t instance; // LS_NONE: none
    uint32_t triangle; // of the object's part of TRIANGLES
} Hit;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double luminance(LsVec3 c)
{
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

static const LsTriangle* find_triangle(const LsFile* file, uint32_t instance, uint32_t triangle)
{
    return &file->triangles[file->objects[file->instances[instance].object].first_triangle +
                            triangle];
}

static RTCScene build_object(RTCDevice device, const LsFile* file, const LsObject* object)
{
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    size_t count = object->triangle_count;
    float* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                              RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * count);
    uint32_t* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), count);
    for (size_t i = 0; i < count; i++)
    {
        const LsTriangle* triangle = &file->triangles[object->first_triangle + i];
        const LsVec3 corners[3] = {triangle->v0, triangle->v1, triangle->v2};
        memcpy(&vertices[9 * i], corners, sizeof corners);
        for (uint32_t k = 0; k < 3; k++)
        {
            indices[3 * i + k] = (uint32_t)(3 * i + k);
        }
    }
    rtcCommitGeometry(geometry);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

LsRefPath* ls_ref_path_create(const LsFile* file)
{
    LsRefPath* path = calloc(1, sizeof(LsRefPath));
    path->file = file;
    path->device = rtcNewDevice("threads=1");
    path->objects = calloc(ls_file_count(file, LS_CHUNK_OBJECTS), sizeof(RTCScene));
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_OBJECTS); i++)
    {
        path->objects[i] = build_object(path->device, file, &file->objects[i]);
    }
    double power = 0.0;
    for (uint32_t i = 0; i < ls_file_count(file, LS_CHUNK_LIGHTS); i++)
    {
        const LsLight* light = &file->lights[i];
        uint32_t material = find_triangle(file, light->instance, light->triangle)->material;
        power += light->area * luminance(file->materials[material].emission);
    }
    path->light_density = power > 0.0 ? 1.0 / power : 0.0;
    if (rtcGetDeviceError(path->device) != RTC_ERROR_NONE)
    {
        ls_ref_path_destroy(path);
        return NULL;
    }
    return path;
}

void ls_ref_path_destroy(LsRefPath* path)
{
    for (uint32_t i = 0; i < ls_file_count(path->file, LS_CHUNK_OBJECTS); i++)
    {
        rtcReleaseScene(path->objects[i]);
    }
    rtcReleaseDevice(path->device);
    free(path->objects);
    free(path);
}

// The nearest hit over all instances; each gets the ray in its own space, where t keeps its
// meaning.
static Hit trace(LsRefPath* path, const double origin[3], const double direction[3], float tmax)
{
    Hit best = {.t = INFINITY, .instance = LS_NONE};
    const float o[3] = {(float)origin[0], (float)origin[1], (float)origin[2]};
    const float d[3] = {(float)direction[0], (float)direction[1], (float)direction[2]};
    path->ray_count++;
    for (uint32_t i = 0; i < ls_file_count(path->file, LS_CHUNK_INSTANCES); i++)
    {
        const LsInstance* instance = &path->file->instances[i];
        float local[6];
        for (int k = 0; k < 3; k++)
        {
            const LsVec4* row = &instance->object_from_world[k];
            local[k] = row->x * o[0] + row->y * o[1] + row->z * o[2] + row->w;
            local[3 + k] = row->x * d[0] + row->y * d[1] + row->z * d[2];
        }
        struct RTCRayHit ray = {
            .ray = {.org_x = local[0],
                    .org_y = local[1],
                    .org_z = local[2],
                    .dir_x = local[3],
                    .dir_y = local[4],
                    .dir_z = local[5],
                    .tfar = tmax,
                    .mask = UINT32_MAX},
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
        };
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(path->objects[instance->object], &context, &ray);
        if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID && ray.ray.tfar < best.t)
        {
            best = (Hit){.t = ray.ray.tfar,
                         .weights = {ray.hit.u, ray.hit.v},
                         .instance = i,
                         .triangle = ray.hit.primID};
        }
    }
    return best;
}

static LsRefSurface load_surface(const LsRefPath* path, uint32_t instance, uint32_t triangle,
                                 const double weights[2])
{
    return ls_ref_surface(find_triangle(path->file, instance, triangle),
                          &path->file->instances[instance], weights,
                          path->file->header->transform_bound);
}

static bool emits_against(const LsMaterial* material, const LsRefSurface* surface,
                          const double direction[3])
{
    return (material->flags & LS_MATERIAL_DOUBLE_SIDED) || dot(surface->normal, direction) < 0.0;
}

static void sample_lights(LsRefPath* path, const LsRefSurface* surface, const double normal[3],
                          const float random[4], double radiance[3])
{
    const LsFile* file = path->file;
    radiance[0] = radiance[1] = radiance[2] = 0.0;
    uint32_t index = 0;
    while (!(random[0] < file->lights[index].cumulative))
    {
        index++;
    }
    const LsLight* light = &file->lights[index];
    double before = index > 0 ? file->lights[index - 1].cumulative : 0.0;
    double probability = light->cumulative - before;
    float drawn[2];
    ls_ref_sample_triangle(&random[1], drawn);
    const double weights[2] = {drawn[0], drawn[1]};
    LsRefSurface emitter = load_surface(path, light->instance, light->triangle, weights);
    uint32_t number = find_triangle(file, light->instance, light->triangle)->material;
    const LsMaterial* material = &file->materials[number];

    double way[3];
    for (int i = 0; i < 3; i++)
    {
        way[i] = emitter.position[i] - surface->position[i];
    }
    double d2 = dot(way, way);
    double cosine = dot(normal, way) / sqrt(d2);
    double cosine_light = dot(emitter.normal, way) / sqrt(d2);
    if (cosine <= 0.0 || cosine_light == 0.0 || !emits_against(material, &emitter, way))
    {
        return;
    }
    double origin[3];
    double leg[3];
    for (int i = 0; i < 3; i++)
    {
        origin[i] = (float)(surface->position[i] + normal[i] * surface->error);
        double side = cosine_light < 0.0 ? 1.0 : -1.0;
        leg[i] = emitter.position[i] + side * emitter.normal[i] * emitter.error - origin[i];
    }
    if (trace(path, origin, leg, 1.0f - 0x1p-18f).instance != LS_NONE)
    {
        return;
    }

    // The textbook form: the light's density per solid angle, the bounce's, and the balance
    // heuristic.
    double solid = d2 / fabs(cosine_light);
    double density_chosen = probability / light->area * solid;
    double density_light = path->light_density * luminance(material->emission) * solid;
    double density_bounce = cosine / PI;
    double weight = density_light / (density_light + density_bounce);
    double scale = weight * cosine / PI / density_chosen;
    radiance[0] = material->emission.x * scale;
    radiance[1] = material->emission.y * scale;
    radiance[2] = material->emission.z * scale;
}

static void trace_path(LsRefPath* path, const LsCamera* camera, uint32_t width, uint32_t height,
                       uint32_t x, uint32_t y, uint32_t sample, uint32_t depth, uint32_t seed,
                       double radiance[3])
{
    const LsFile* file = path->file;
    bool lit = path->light_density > 0.0;
    uint32_t pixel = y * width + x;
    float random[4];
    ls_ref_random(pixel, sample, 0, seed, random);
    const double way[3] = {(2.0 * (x + (double)random[0]) - width) / height * camera->tan_half_y,
                           (height - 2.0 * (y + (double)random[1])) / height * camera->tan_half_y,
                           -1.0};
    double origin[3];
    double direction[3];
    for (int i = 0; i < 3; i++)
    {
        const LsVec4* row = &camera->world_from_camera[i];
        origin[i] = row->w;
        direction[i] = row->x * way[0] + row->y * way[1] + row->z * way[2];
    }
    double throughput[3] = {1.0, 1.0, 1.0};
    double density_bounce = 0.0;
    radiance[0] = radiance[1] = radiance[2] = 0.0;

    for (uint32_t segment = 1;; segment++)
    {
        Hit hit = trace(path, origin, direction, INFINITY);
        if (hit.instance == LS_NONE)
        {
            for (int i = 0; i < 3; i++)
            {
                radiance[i] += lit ? 0.0 : throughput[i];
            }
            return;
        }
        LsRefSurface surface = load_surface(path, hit.instance, hit.triangle, hit.weights);
        uint32_t number = find_triangle(file, hit.instance, hit.triangle)->material;
        const LsMaterial* material = &file->materials[number];
        const double color[3] = {material->base_color.x, material->base_color.y,
                                 material->base_color.z};
        const double emission[3] = {material->emission.x, material->emission.y,
                                    material->emission.z};
        double side = dot(surface.normal, direction) < 0.0 ? 1.0 : -1.0;
        const double normal[3] = {side * surface.normal[0], side * surface.normal[1],
                                  side * surface.normal[2]};

        if (lit && (material->flags & LS_MATERIAL_EMISSIVE) &&
            emits_against(material, &surface, direction))
        {
            double weight = 1.0;
            if (segment > 1)
            {
                double d2 = hit.t * hit.t * dot(direction, direction);
                double cosine_light =
                    fabs(dot(normal, direction)) / sqrt(dot(direction, direction));
                double density_light =
                    path->light_density * luminance(material->emission) * d2 / cosine_light;
                weight = density_bounce / (density_bounce + density_light);
            }
            for (int i = 0; i < 3; i++)
            {
                radiance[i] += throughput[i] * weight * emission[i];
            }
        }
        if (segment >= depth)
        {
            return;
        }

        ls_ref_random(pixel, sample, 2 * segment - 1, seed, random);
        double direct[3] = {0.0, 0.0, 0.0};
        if (lit)
        {
            sample_lights(path, &surface, normal, random, direct);
        }
        for (int i = 0; i < 3; i++)
        {
            throughput[i] *= color[i];
            radiance[i] += throughput[i] * direct[i];
        }
        double survival = fmax(fmax(throughput[0], throughput[1]), throughput[2]);
        if (segment >= ROULETTE_SEGMENTS)
        {
            survival = fmin(survival, 1.0);
            if (random[3] >= survival)
            {
                return;
            }
            for (int i = 0; i < 3; i++)
            {
                throughput[i] /= survival;
            }
        }
        else if (survival == 0.0)
        {
            return;
        }

        ls_ref_random(pixel, sample, 2 * segment, seed, random);
        ls_ref_sample_hemisphere(normal, random, direction);
        density_bounce = sqrt(1.0 - random[0]) / PI;
        for (int i = 0; i < 3; i++)
        {
            origin[i] = surface.position[i] + normal[i] * surface.error;
        }
    }
}

uint64_t ls_ref_path_render(const LsRefPath* path, const LsCamera* camera, uint32_t width,
                            uint32_t height, uint32_t sample_count, uint32_t depth, uint32_t seed,
                            float* rgba)
{
    LsRefPath state = *path;
    state.ray_count = 0;
    for (uint32_t y = 0; y < height; y++)
    {
        for (uint32_t x = 0; x < width; x++)
        {
            double sum[3] = {0.0, 0.0, 0.0};
            for (uint32_t s = 0; s < sample_count; s++)
            {
                double radiance[3];
                trace_path(&state, camera, width, height, x, y, s, depth, seed, radiance);
                for (int i = 0; i < 3; i++)
                {
                    sum[i] += radiance[i];
                }
            }
            float* out = &rgba[4 * ((size_t)y * width + x)];
            for (int i = 0; i < 3; i++)
            {
                out[i] = (float)(sum[i] / sample_count);
            }
            out[3] = 1.0f;
        }
    }
    return state.ray_count;
}
