#include "ref_embree.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>

struct LsEmbree
{
    const LsFile* file;
    const LsReference* reference;
    RTCDevice device;
    RTCScene* scenes; // per object
    uint32_t scene_count;
};

static bool fill_scene(LsEmbree* embree, uint32_t index)
{
    const LsObject* object = &embree->file->objects[index];
    const LsTriangle* triangles = embree->file->triangles + object->first_triangle;
    RTCScene scene = rtcNewScene(embree->device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    LsVec3* vertices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(LsVec3), (size_t)object->triangle_count * 3);
    uint32_t* indices =
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(uint32_t), object->triangle_count);
    for (uint32_t i = 0; vertices && indices && i < object->triangle_count; i++)
    {
        vertices[3 * i] = triangles[i].v0;
        vertices[3 * i + 1] = triangles[i].v1;
        vertices[3 * i + 2] = triangles[i].v2;
        indices[3 * i] = 3 * i;
        indices[3 * i + 1] = 3 * i + 1;
        indices[3 * i + 2] = 3 * i + 2;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    embree->scenes[index] = scene;
    return rtcGetDeviceError(embree->device) == RTC_ERROR_NONE;
}

LsEmbree* ls_embree_create(const LsFile* file, const LsReference* reference)
{
    LsEmbree* embree = calloc(1, sizeof *embree);
    if (!embree)
    {
        return NULL;
    }
    embree->file = file;
    embree->reference = reference;
    embree->scene_count = ls_file_count(file, LS_CHUNK_OBJECTS);
    embree->scenes = calloc(embree->scene_count, sizeof *embree->scenes);
    embree->device = rtcNewDevice("threads=2");
    bool complete = embree->scenes && embree->device;
    for (uint32_t i = 0; i < embree->scene_count && complete; i++)
    {
        complete = fill_scene(embree, i);
    }
    if (!complete)
    {
        ls_embree_destroy(embree);
        return NULL;
    }
    return embree;
}

void ls_embree_destroy(LsEmbree* embree)
{
    for (uint32_t i = 0; embree->scenes && i < embree->scene_count; i++)
    {
        if (embree->scenes[i])
        {
            rtcReleaseScene(embree->scenes[i]);
        }
    }
    if (embree->device)
    {
        rtcReleaseDevice(embree->device);
    }
    free(embree->scenes);
    free(embree);
}

static LsHit trace_ray(const LsEmbree* embree, const LsRay* world, uint32_t mask)
{
    const LsFile* file = embree->file;
    LsHit hit = ls_reference_miss();
    for (uint32_t instance = 0; instance < ls_file_count(file, LS_CHUNK_INSTANCES); instance++)
    {
        LsObjectRay ray;
        if (!ls_reference_carry(embree->reference, instance, world, mask, &ray) || ray.misses)
        {
            continue;
        }
        uint32_t object_index = file->instances[instance].object;
        struct RTCRayHit query = {
            .ray = {.org_x = ray.origin[0],
                    .org_y = ray.origin[1],
                    .org_z = ray.origin[2],
                    .tnear = fmaxf(ray.smin - ray.s0, 0.0f),
                    .dir_x = ray.direction[0],
                    .dir_y = ray.direction[1],
                    .dir_z = ray.direction[2],
                    .tfar = ray.smax - ray.s0,
                    .mask = ~0u},
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .primID = RTC_INVALID_GEOMETRY_ID},
        };
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(embree->scenes[object_index], &context, &query);
        float t = ldexpf(query.ray.tfar + ray.s0, -ray.exponent);
        if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID && (hit.instance == LS_NONE || t < hit.t))
        {
            const LsTriangle* triangle =
                &file->triangles[file->objects[object_index].first_triangle + query.hit.primID];
            hit = (LsHit){.t = t,
                          .u = query.hit.u,
                          .v = query.hit.v,
                          .instance = instance,
                          .object = object_index,
                          .primitive = triangle->primitive,
                          .material = triangle->material};
        }
    }
    return hit;
}

void ls_embree_trace(const LsEmbree* embree, const LsRay* rays, const uint32_t* masks,
                     uint32_t ray_count, LsHit* hits)
{
#pragma omp parallel for schedule(dynamic, 256)
    for (uint32_t i = 0; i < ray_count; i++)
    {
        hits[i] = trace_ray(embree, &rays[i], masks ? masks[i] : 255u);
    }
}
