#include "embree_rays.h"

#ifdef LS_HAS_EMBREE

#include <embree3/rtcore.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

bool ls_embree_rays_are_built(void)
{
    return true;
}

struct LsEmbreeRays
{
    RTCDevice device;
    RTCScene scene;
    uint32_t threads;
};

static LsVec3 carry(const LsInstance* instance, LsVec3 p)
{
    const LsVec4* row = instance->world_from_object;
    return (LsVec3){
        row[0].x * p.x + row[0].y * p.y + row[0].z * p.z + row[0].w,
        row[1].x * p.x + row[1].y * p.y + row[1].z * p.z + row[1].w,
        row[2].x * p.x + row[2].y * p.y + row[2].z * p.z + row[2].w,
    };
}

static bool attach_instance(LsEmbreeRays* embree, const LsFile* file, const LsInstance* instance)
{
    const LsObject* object = &file->objects[instance->object];
    const size_t count = object->triangle_count;
    RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    LsVec3* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                               RTC_FORMAT_FLOAT3, sizeof(LsVec3), 3 * count);
    uint32_t* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), count);
    for (size_t i = 0; vertices != NULL && indices != NULL && i < count; i++)
    {
        const LsTriangle* triangle = &file->triangles[object->first_triangle + i];
        vertices[3 * i] = carry(instance, triangle->v0);
        vertices[3 * i + 1] = carry(instance, triangle->v1);
        vertices[3 * i + 2] = carry(instance, triangle->v2);
        for (uint32_t corner = 0; corner < 3; corner++)
        {
            indices[3 * i + corner] = (uint32_t)(3 * i) + corner;
        }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree->scene, geometry);
    rtcReleaseGeometry(geometry);
    return rtcGetDeviceError(embree->device) == RTC_ERROR_NONE;
}

LsEmbreeRays* ls_embree_rays_create(const LsFile* file, uint32_t threads)
{
    LsEmbreeRays* embree = calloc(1, sizeof *embree);
    if (embree == NULL)
    {
        return NULL;
    }
    char config[32];
    snprintf(config, sizeof config, "threads=%u", threads);
    embree->threads = threads;
    embree->device = rtcNewDevice(config);
    embree->scene = embree->device != NULL ? rtcNewScene(embree->device) : NULL;
    bool complete = embree->scene != NULL;
    for (uint32_t i = 0; complete && i < ls_file_count(file, LS_CHUNK_INSTANCES); i++)
    {
        complete = attach_instance(embree, file, &file->instances[i]);
    }
    if (complete)
    {
        rtcCommitScene(embree->scene);
        complete = rtcGetDeviceError(embree->device) == RTC_ERROR_NONE;
    }
    if (!complete)
    {
        ls_embree_rays_destroy(embree);
        return NULL;
    }
    return embree;
}

void ls_embree_rays_destroy(LsEmbreeRays* embree)
{
    if (embree == NULL)
    {
        return;
    }
    if (embree->scene != NULL)
    {
        rtcReleaseScene(embree->scene);
    }
    if (embree->device != NULL)
    {
        rtcReleaseDevice(embree->device);
    }
    free(embree);
}

static bool trace_one(RTCScene scene, const LsRay* ray, bool any)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit query = {
        .ray =
            {
                .org_x = ray->origin.x,
                .org_y = ray->origin.y,
                .org_z = ray->origin.z,
                .tnear = ray->tmin,
                .dir_x = ray->direction.x,
                .dir_y = ray->direction.y,
                .dir_z = ray->direction.z,
                .tfar = ray->tmax,
                .mask = UINT32_MAX,
            },
        .hit.geomID = RTC_INVALID_GEOMETRY_ID,
    };
    if (any)
    {
        rtcOccluded1(scene, &context, &query.ray);
        return query.ray.tfar < 0.0f;
    }
    rtcIntersect1(scene, &context, &query);
    return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

double ls_embree_rays_trace(const LsEmbreeRays* embree, const LsRay* rays, uint32_t count, bool any,
                            uint32_t* hit_count)
{
    uint32_t hits = 0;
    const double begin = omp_get_wtime();
#pragma omp parallel for schedule(dynamic, 1024) num_threads(embree->threads) reduction(+ : hits)
    for (uint32_t i = 0; i < count; i++)
    {
        hits += trace_one(embree->scene, &rays[i], any);
    }
    *hit_count = hits;
    return omp_get_wtime() - begin;
}

#else

bool ls_embree_rays_are_built(void)
{
    return false;
}

LsEmbreeRays* ls_embree_rays_create(const LsFile* file, uint32_t threads)
{
    (void)file;
    (void)threads;
    return NULL;
}

void ls_embree_rays_destroy(LsEmbreeRays* embree)
{
    (void)embree;
}

double ls_embree_rays_trace(const LsEmbreeRays* embree, const LsRay* rays, uint32_t count, bool any,
                            uint32_t* hit_count)
{
    (void)embree;
    (void)rays;
    (void)count;
    (void)any;
    *hit_count = 0;
    return 0.0;
}

#endif
