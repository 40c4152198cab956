// path.comp.glsl - a progressive path tracer over diffuse surfaces; docs/rendering.md tells the
// algorithm.

#version 460
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_GOOGLE_include_directive : require

#include "ls_layout.h"

LsTraceScene ls_scene;
LsDeviceScene device_scene;

#include "linespace.glsl"
#include "path_layout.h"
#include "sampling.glsl"

layout(local_size_x_id = LS_CONSTANT_GROUP_SIZE) in;
layout(constant_id = LS_CONSTANT_HAS_LIGHTS) const uint LS_HAS_LIGHTS = 1;

layout(push_constant) uniform LsPush
{
    LsPathParams params;
};

layout(buffer_reference, std430, buffer_reference_align = 16) buffer LsPicture
{
    vec4 at[];
};

layout(buffer_reference, std430, buffer_reference_align = 16) buffer LsCounters
{
    LsPathCounters counters;
};

// Segments of a path before roulette may end it.
const uint LS_ROULETTE_SEGMENTS = 5u;

// Shadow rays end before the light by this much of their length, more than t errs by (SPEC 7.6).
const float LS_SHADOW_END = 1.0 - 1.0 / 262144.0;

shared uint group_rays;
uint ray_count;

LsHit trace(vec3 origin, vec3 direction, float tmax, uint flags)
{
    ray_count++;
    return ls_trace_ray(LsRay(origin, 0.0, direction, tmax), 0xFFu, flags);
}

LsHitSurface load_surface(uint instance_index, uint triangle_index, vec2 weights)
{
    LsInstanceArray instances = LsInstanceArray(ls_scene.instances);
    uint object = instances.at[instance_index].object;
    uint first_triangle = LsObjectArray(ls_scene.objects).at[object].first_triangle;
    uint flags = instances.at[instance_index].flags;
    vec4 rows[3] =
        vec4[3](vec4(1.0, 0.0, 0.0, 0.0), vec4(0.0, 1.0, 0.0, 0.0), vec4(0.0, 0.0, 1.0, 0.0));
    if (LS_HAS_TOP_LEVEL != 0u && (flags & LS_INSTANCE_IDENTITY) == 0u)
    {
        rows = instances.at[instance_index].world_from_object;
    }
    uint index = first_triangle + triangle_index;
    LsTriangleArray triangles = ls_find_triangle(ls_scene.triangles, index);
    return ls_surface(triangles.at[index], rows, (flags & LS_INSTANCE_MIRRORED) != 0u, weights,
                      ls_scene.transform_bound);
}

float luminance(vec3 color)
{
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

// Radiance that leaves the surface against `direction`, the way a ray came.
vec3 emitted(LsMaterial material, LsHitSurface surface, vec3 direction)
{
    bool both = (material.flags & LS_MATERIAL_DOUBLE_SIDED) != 0u;
    bool seen = both || dot(surface.normal, direction) < 0.0;
    return seen ? material.emission : vec3(0.0);
}

// The first light whose cumulative probability passes `random`.
uint choose_light(float random)
{
    LsLightArray lights = LsLightArray(device_scene.lights);
    uint first = 0u;
    uint last = device_scene.light_count - 1u;
    while (first < last)
    {
        uint middle = (first + last) / 2u;
        bool passed = random < lights.at[middle].cumulative;
        first = passed ? first : middle + 1u;
        last = passed ? middle : last;
    }
    return first;
}

// Light that reaches a diffuse surface of albedo 1 from one point of one light, weighed against
// what a bounce would find there by the balance heuristic. With k = density * luminance the light
// is sampled by k d^2 / cos_light, the bounce by cos / pi; the estimate is arranged so that it
// stays finite as d goes to 0.
vec3 sample_lights(LsHitSurface surface, vec3 normal, vec3 random)
{
    LsLightArray lights = LsLightArray(device_scene.lights);
    uint index = choose_light(random.x);
    LsLight light = lights.at[index];
    float probability = light.cumulative - (index == 0u ? 0.0 : lights.at[index - 1u].cumulative);
    LsHitSurface emitter =
        load_surface(light.instance, light.triangle, ls_sample_triangle(random.yz));
    uint object = LsInstanceArray(ls_scene.instances).at[light.instance].object;
    uint triangle = LsObjectArray(ls_scene.objects).at[object].first_triangle + light.triangle;
    LsTriangleArray triangles = ls_find_triangle(ls_scene.triangles, triangle);
    uint material_index = triangles.at[triangle].material;
    LsMaterial material = LsMaterialArray(device_scene.materials).at[material_index];

    vec3 way = emitter.position - surface.position;
    float distance_squared = dot(way, way);
    float inverse_distance = inversesqrt(distance_squared);
    float cosine = dot(normal, way) * inverse_distance;
    float cosine_light = dot(emitter.normal, way) * inverse_distance;
    vec3 radiance = emitted(material, emitter, way);
    if (!(cosine > 0.0) || cosine_light == 0.0 || radiance == vec3(0.0))
    {
        return vec3(0.0);
    }

    vec3 origin = surface.position + normal * surface.error;
    float side = cosine_light < 0.0 ? 1.0 : -1.0;
    vec3 target = emitter.position + emitter.normal * (side * emitter.error);
    if (trace(origin, target - origin, LS_SHADOW_END, LS_RAY_FLAG_ANY_HIT).t >= 0.0)
    {
        return vec3(0.0);
    }
    float k = params.light_density * luminance(material.emission);
    float density_bounce = cosine / LS_PI;
    return radiance * (density_bounce * (light.area / probability) /
                       (distance_squared / abs(cosine_light) + density_bounce / k));
}

vec3 camera_direction(uvec2 pixel, vec2 jitter)
{
    vec2 size = vec2(params.width, params.height);
    vec2 at = (vec2(pixel) + jitter) * 2.0 - size;
    vec3 way = vec3(at.x, -at.y, -1.0) * vec3(vec2(params.tan_half_y / size.y), 1.0);
    return vec3(dot(params.world_from_camera[0].xyz, way),
                dot(params.world_from_camera[1].xyz, way),
                dot(params.world_from_camera[2].xyz, way));
}

// A path under way.
struct LsPath
{
    vec3 origin;
    vec3 direction; // unit from the second segment on
    vec3 throughput;
    vec3 radiance;
    float density_bounce; // with which `direction` was drawn
    uint segment;         // number of the segment to trace next, from 1
};

LsPath begin_path(uvec2 pixel, uint number, uint sample_index)
{
    LsPath path;
    path.origin = vec3(params.world_from_camera[0].w, params.world_from_camera[1].w,
                       params.world_from_camera[2].w);
    path.direction = camera_direction(pixel, ls_random(number, sample_index, 0u, params.seed).xy);
    path.throughput = vec3(1.0);
    path.radiance = vec3(0.0);
    path.density_bounce = 0.0;
    path.segment = 1u;
    return path;
}

// Traces the next segment and what light reaches its end. False if the path ends there.
bool extend_path(inout LsPath path, uint number, uint sample_index)
{
    LsHit hit = trace(path.origin, path.direction, LS_INFINITY, 0u);
    if (hit.instance == LS_NONE)
    {
        // Without lights the surroundings are white, with lights they are black.
        path.radiance += LS_HAS_LIGHTS != 0u ? vec3(0.0) : path.throughput;
        return false;
    }
    LsHitSurface surface = load_surface(hit.instance, ls_hit_triangle, vec2(hit.u, hit.v));
    LsMaterial material = LsMaterialArray(device_scene.materials).at[hit.material];
    vec3 normal = dot(surface.normal, path.direction) < 0.0 ? surface.normal : -surface.normal;

    if (LS_HAS_LIGHTS != 0u && (material.flags & LS_MATERIAL_EMISSIVE) != 0u)
    {
        float weight = 1.0;
        if (path.segment > 1u)
        {
            // Against k d^2 / cos_light, as in sample_lights.
            float k = params.light_density * luminance(material.emission);
            float bounce = path.density_bounce * abs(dot(normal, path.direction));
            weight = bounce / (bounce + k * hit.t * hit.t);
        }
        path.radiance += path.throughput * weight * emitted(material, surface, path.direction);
    }
    if (path.segment >= params.depth)
    {
        return false;
    }

    vec4 random = ls_random(number, sample_index, 2u * path.segment - 1u, params.seed);
    path.throughput *= material.base_color;
    if (LS_HAS_LIGHTS != 0u)
    {
        path.radiance += path.throughput * sample_lights(surface, normal, random.xyz);
    }
    float survival = min(max(path.throughput.x, max(path.throughput.y, path.throughput.z)), 1.0);
    if (path.segment >= LS_ROULETTE_SEGMENTS)
    {
        if (!(random.w < survival))
        {
            return false;
        }
        path.throughput /= survival;
    }

    random = ls_random(number, sample_index, 2u * path.segment, params.seed);
    path.direction = ls_sample_hemisphere(normal, random.xy);
    path.density_bounce = sqrt(1.0 - random.x) / LS_PI;
    path.origin = surface.position + normal * surface.error;
    path.segment++;
    return survival > 0.0;
}

// The running average of F.-L. Schröder 2017, equation 8, C' = s/(s+1) C + 1/(s+1) C_trace, written
// so that a constant stays itself. A sample that is not finite counts as black and is reported.
vec3 average(vec3 mean, vec3 value, uint count)
{
    if (!ls_is_finite(value))
    {
        atomicAdd(LsCounters(params.counters).counters.invalid_samples, 1u);
        value = vec3(0.0);
    }
    return mean + (value - mean) / float(count + 1u);
}

// One loop over the segments of all paths: who has ended a path begins the next while neighbours go
// on. Samples that are missing after it were cut off by the driver (llvmpipe bounds the rounds of
// loops).
void add_samples(uvec2 pixel)
{
    LsPicture image = LsPicture(params.image);
    uint number = pixel.y * params.width + pixel.x;
    uint sample_index = params.first_sample;
    uint left = params.sample_count;
    vec3 mean = sample_index == 0u ? vec3(0.0) : image.at[number].rgb;
    LsPath path = begin_path(pixel, number, sample_index);
    while (left > 0u)
    {
        if (!extend_path(path, number, sample_index))
        {
            mean = average(mean, path.radiance, sample_index);
            sample_index++;
            left--;
            path = begin_path(pixel, number, sample_index);
        }
    }
    if (left > 0u)
    {
        atomicAdd(LsCounters(params.counters).counters.invalid_samples, left);
    }
    image.at[number] = vec4(mean, 1.0);
}

void main()
{
    if (gl_LocalInvocationIndex == 0u)
    {
        group_rays = 0u;
    }
    barrier();

    device_scene = LsSceneReference(params.scene).scene;
    ls_scene = device_scene.trace;
    ray_count = 0u;
    uvec2 tile = uvec2(LS_PATH_TILE_WIDTH, gl_WorkGroupSize.x / LS_PATH_TILE_WIDTH);
    uvec2 pixel = gl_WorkGroupID.xy * tile +
                  uvec2(gl_LocalInvocationIndex % tile.x, gl_LocalInvocationIndex / tile.x);
    if (pixel.x < params.width && pixel.y < params.height)
    {
        add_samples(pixel);
    }

    atomicAdd(group_rays, ray_count);
    barrier();
    if (gl_LocalInvocationIndex == 0u)
    {
        uint before = atomicAdd(LsCounters(params.counters).counters.rays_low, group_rays);
        if (before + group_rays < before)
        {
            atomicAdd(LsCounters(params.counters).counters.rays_high, 1u);
        }
    }
}
