#include "ref_trace.h"

#include "ref_layout.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define RAYS_PER_BLOCK 32

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__)
#define WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDE
#endif

LsHit ls_reference_miss(void)
{
    return (LsHit){.t = -1.0f,
                   .instance = LS_NONE,
                   .object = LS_NONE,
                   .primitive = LS_NONE,
                   .material = LS_NONE};
}

// ---- SPEC 7.1 and 7.2 ---------------------------------------------------------------------------

static float largest_component(LsVec3 v)
{
    return fmaxf(fmaxf(fabsf(v.x), fabsf(v.y)), fabsf(v.z));
}

static bool is_finite(LsVec3 v)
{
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool is_legal(const LsRay* ray)
{
    return is_finite(ray->origin) && is_finite(ray->direction) &&
           largest_component(ray->direction) >= 0x1p-100f && ray->tmin >= 0.0f &&
           ray->tmax > ray->tmin && ray->tmax >= 0x1p-126f;
}

static float distance_outside(const LsObject* object, const float origin[3])
{
    float largest = 0.0f;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        largest = fmaxf(largest, component(object->lower, axis) - origin[axis]);
        largest = fmaxf(largest, origin[axis] - component(object->upper, axis));
    }
    return largest;
}

// One step of a far origin towards the box. False: the ray misses the box.
static bool move_origin(const LsObject* object, float outside, LsObjectRay* ray)
{
    float pad = outside * 0x1p-19f;
    float entry = -INFINITY;
    float exit = INFINITY;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        float lower = component(object->lower, axis) - pad;
        float upper = component(object->upper, axis) + pad;
        float o = ray->origin[axis];
        float d = ray->direction[axis];
        if (fabsf(d) < 0x1p-60f)
        {
            if (o < lower || o > upper)
            {
                return false;
            }
            continue;
        }
        float inverse = 1.0f / d;
        float s_lower = (lower - o) * inverse;
        float s_upper = (upper - o) * inverse;
        entry = fmaxf(entry, fminf(s_lower, s_upper));
        exit = fminf(exit, fmaxf(s_lower, s_upper));
    }
    if (entry > exit || exit < 0.0f)
    {
        return false;
    }
    float step = fmaxf(entry, 0.0f);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        ray->origin[axis] = ray->origin[axis] + ray->direction[axis] * step;
    }
    ray->s0 += step;
    return true;
}

// The exponent that scales a direction, from its largest component.
static int scale_exponent(float largest)
{
    return ilogbf(largest) < 126 ? ilogbf(largest) : 126;
}

// Moves a far origin, in at most two steps. False: the ray misses the object.
static bool move_far_origin(const LsObject* object, LsObjectRay* carried)
{
    for (uint32_t step = 0; step < 2; step++)
    {
        float outside = distance_outside(object, carried->origin);
        if (!(outside > object->reach))
        {
            return true;
        }
        carried->far = true;
        if (!move_origin(object, outside, carried))
        {
            return false;
        }
    }
    return !(distance_outside(object, carried->origin) > object->reach);
}

bool ls_reference_carry(const LsReference* reference, uint32_t instance, const LsRay* ray,
                        uint32_t mask, LsObjectRay* carried)
{
    const LsInstance* placed = &reference->file->instances[instance];
    const LsObject* object = &reference->file->objects[placed->object];
    if (!is_legal(ray) || (placed->mask & mask) == 0)
    {
        return false;
    }

    const LsVec3 o = ray->origin;
    int world_exponent = scale_exponent(largest_component(ray->direction));
    float scaled[3];
    for (uint32_t i = 0; i < 3; i++)
    {
        float given = component(ray->direction, i);
        scaled[i] = fabsf(given) < 0x1p-126f ? 0.0f : ldexpf(given, -world_exponent);
    }
    const LsVec3 d = {scaled[0], scaled[1], scaled[2]};
    *carried = (LsObjectRay){.s0 = 0.0f};
    for (uint32_t i = 0; i < 3; i++)
    {
        const LsVec4 m = placed->object_from_world[i];
        carried->carried[i] =
            reference->top_level ? ((m.x * o.x + m.y * o.y) + m.z * o.z) + m.w : component(o, i);
        carried->direction[i] =
            reference->top_level ? (m.x * d.x + m.y * d.y) + m.z * d.z : component(d, i);
    }
    const float* c = carried->carried;
    LsVec3 direction = {carried->direction[0], carried->direction[1], carried->direction[2]};
    float largest = largest_component(direction);
    if (!is_finite((LsVec3){c[0], c[1], c[2]}) || !is_finite(direction) || largest < 0x1p-100f)
    {
        return false;
    }

    int object_exponent = scale_exponent(largest);
    for (uint32_t i = 0; i < 3; i++)
    {
        carried->direction[i] = ldexpf(carried->direction[i], -object_exponent);
        carried->origin[i] = carried->carried[i];
    }
    carried->smin = ldexpf(ldexpf(ray->tmin, world_exponent), object_exponent);
    carried->smax = ldexpf(ldexpf(fminf(ray->tmax, FLT_MAX), world_exponent), object_exponent);
    carried->exponent = world_exponent + object_exponent;
    carried->misses = !move_far_origin(object, carried);
    return true;
}

// ---- SPEC 7.4, in float -------------------------------------------------------------------------

// The projection of one ray: axes and what the test needs of it.
typedef struct LsProjection
{
    uint32_t kx, ky, kz;
    float dx, dy, dz;
    float ox, oy, oz;
    float s0, smin, smax;
    bool keep_front, keep_back;
} LsProjection;

static LsProjection project_ray(const LsObjectRay* ray, uint32_t flags, bool mirrored)
{
    const float* d = ray->direction;
    uint32_t kz = 0;
    for (uint32_t axis = 1; axis < 3; axis++)
    {
        kz = fabsf(d[axis]) > fabsf(d[kz]) ? axis : kz;
    }
    uint32_t kx = (kz + 1) % 3;
    uint32_t ky = (kx + 1) % 3;
    if (d[kz] < 0.0f)
    {
        uint32_t swap = kx;
        kx = ky;
        ky = swap;
    }
    bool keep_front = (flags & LS_RAY_FLAG_CULL_FRONT_FACING) == 0;
    bool keep_back = (flags & LS_RAY_FLAG_CULL_BACK_FACING) == 0;
    return (LsProjection){
        .kx = kx,
        .ky = ky,
        .kz = kz,
        .dx = d[kx],
        .dy = d[ky],
        .dz = d[kz],
        .ox = ray->origin[kx],
        .oy = ray->origin[ky],
        .oz = ray->origin[kz],
        .s0 = ray->s0,
        .smin = ray->smin,
        .smax = ray->smax,
        .keep_front = mirrored ? keep_back : keep_front,
        .keep_back = mirrored ? keep_front : keep_back,
    };
}

// Tests LANES triangles: s where hit, infinity elsewhere, and the weights' numerators. Returns
// whether some s is at most `best`.
WIDE static int test_lanes(const LsReferenceObject* object, uint32_t first, const LsProjection* ray,
                           float best, float* restrict s_out)
{
    const float* restrict ax_in = object->corners[0][ray->kx] + first;
    const float* restrict ay_in = object->corners[0][ray->ky] + first;
    const float* restrict az_in = object->corners[0][ray->kz] + first;
    const float* restrict bx_in = object->corners[1][ray->kx] + first;
    const float* restrict by_in = object->corners[1][ray->ky] + first;
    const float* restrict bz_in = object->corners[1][ray->kz] + first;
    const float* restrict cx_in = object->corners[2][ray->kx] + first;
    const float* restrict cy_in = object->corners[2][ray->ky] + first;
    const float* restrict cz_in = object->corners[2][ray->kz] + first;
    const float ox = ray->ox, oy = ray->oy, oz = ray->oz;
    const float dx = ray->dx, dy = ray->dy, dz = ray->dz;
    const float s0 = ray->s0, smin = ray->smin, smax = ray->smax;
    const int keep_front = ray->keep_front, keep_back = ray->keep_back;
    int found = 0;
    for (uint32_t i = 0; i < LANES; i++)
    {
        float az = az_in[i] - oz;
        float bz = bz_in[i] - oz;
        float cz = cz_in[i] - oz;
        float ax = (ax_in[i] - ox) * dz - dx * az;
        float ay = (ay_in[i] - oy) * dz - dy * az;
        float bx = (bx_in[i] - ox) * dz - dx * bz;
        float by = (by_in[i] - oy) * dz - dy * bz;
        float cx = (cx_in[i] - ox) * dz - dx * cz;
        float cy = (cy_in[i] - oy) * dz - dy * cz;
        float u = cx * by - cy * bx;
        float v = ax * cy - ay * cx;
        float w = bx * ay - by * ax;
        float det = (u + v) + w;
        float ab_x = bx - ax, ab_y = by - ay, ab = ab_x * ab_x + ab_y * ab_y;
        float bc_x = cx - bx, bc_y = cy - by, bc = bc_x * bc_x + bc_y * bc_y;
        float ca_x = ax - cx, ca_y = ay - cy, ca = ca_x * ca_x + ca_y * ca_y;
        int second = bc > ab;
        float l = second ? bc : ab;
        int third = ca > l;
        l = third ? ca : l;
        float ex = third ? ca_x : second ? bc_x : ab_x;
        float ey = third ? ca_y : second ? bc_y : ab_y;
        float ez = third ? az - cz : second ? cz - bz : bz - az;
        float rx = ((u * ax + v * bx) + w * cx) / det;
        float ry = ((u * ay + v * by) + w * cy) / det;
        float k = (rx * ex + ry * ey) / l;
        float s = (((u * az + v * bz) + w * cz) / det - k * ez) / dz + s0;
        int beside_x =
            ((ax > 0.0f) & (bx > 0.0f) & (cx > 0.0f)) | ((ax < 0.0f) & (bx < 0.0f) & (cx < 0.0f));
        int beside_y =
            ((ay > 0.0f) & (by > 0.0f) & (cy > 0.0f)) | ((ay < 0.0f) & (by < 0.0f) & (cy < 0.0f));
        int beside = beside_x | beside_y;
        int below = (u < 0.0f) | (v < 0.0f) | (w < 0.0f);
        int above = (u > 0.0f) | (v > 0.0f) | (w > 0.0f);
        int faced = ((det > 0.0f) & keep_front) | ((det < 0.0f) & keep_back);
        int hit = ((below & above) ^ 1) & (beside ^ 1) & faced & (s > smin) & (s < smax);
        s_out[i] = hit ? s : INFINITY;
        found |= hit & (s <= best);
    }
    return found;
}

// The weights of the second and third corner, by the same operations as test_lanes.
static void weigh_corners(const LsReferenceObject* object, uint32_t slot, const LsProjection* ray,
                          float* u_out, float* v_out)
{
    const float d[3] = {ray->dx, ray->dy, ray->dz};
    const float o[3] = {ray->ox, ray->oy, ray->oz};
    const uint32_t k[3] = {ray->kx, ray->ky, ray->kz};
    float x[3], y[3];
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        float z = object->corners[corner][k[2]][slot] - o[2];
        x[corner] = (object->corners[corner][k[0]][slot] - o[0]) * d[2] - d[0] * z;
        y[corner] = (object->corners[corner][k[1]][slot] - o[1]) * d[2] - d[1] * z;
    }
    float u = x[2] * y[1] - y[2] * x[1];
    float v = x[0] * y[2] - y[0] * x[2];
    float w = x[1] * y[0] - y[1] * x[0];
    float det = (u + v) + w;
    *u_out = v / det;
    *v_out = w / det;
}

// The nearest hit of one ray with one object so far.
typedef struct LsNearest
{
    float s;
    uint32_t slot, primitive;
} LsNearest;

static void take_nearest(LsNearest* nearest, const LsReferenceObject* object,
                         const LsTriangle* triangles, uint32_t first, const float* s)
{
    for (uint32_t i = 0; i < LANES; i++)
    {
        if (s[i] > nearest->s || s[i] == INFINITY)
        {
            continue;
        }
        uint32_t primitive = triangles[object->triangles[first + i]].primitive;
        if (s[i] < nearest->s || primitive < nearest->primitive)
        {
            *nearest = (LsNearest){s[i], first + i, primitive};
        }
    }
}

static void trace_block(const LsReference* reference, const LsRay* rays, const uint32_t* masks,
                        uint32_t count, uint32_t flags, LsHit* hits)
{
    const LsFile* file = reference->file;
    for (uint32_t i = 0; i < count; i++)
    {
        hits[i] = ls_reference_miss();
    }
    for (uint32_t instance = 0; instance < ls_file_count(file, LS_CHUNK_INSTANCES); instance++)
    {
        const LsInstance* placed = &file->instances[instance];
        const LsReferenceObject* object = &reference->objects[placed->object];
        const LsTriangle* triangles =
            file->triangles + file->objects[placed->object].first_triangle;
        bool mirrored = (placed->flags & LS_INSTANCE_MIRRORED) != 0;
        LsObjectRay carried[RAYS_PER_BLOCK];
        LsProjection projections[RAYS_PER_BLOCK];
        LsNearest nearest[RAYS_PER_BLOCK];
        bool reaches[RAYS_PER_BLOCK];
        for (uint32_t i = 0; i < count; i++)
        {
            uint32_t mask = masks ? masks[i] : 255u;
            reaches[i] = ls_reference_carry(reference, instance, &rays[i], mask, &carried[i]) &&
                         !carried[i].misses;
            nearest[i] = (LsNearest){INFINITY, LS_NONE, LS_NONE};
            if (reaches[i])
            {
                projections[i] = project_ray(&carried[i], flags, mirrored);
            }
        }
        for (uint32_t first = 0; first < object->slot_count; first += LANES)
        {
            for (uint32_t i = 0; i < count; i++)
            {
                float s[LANES];
                if (reaches[i] && test_lanes(object, first, &projections[i], nearest[i].s, s))
                {
                    take_nearest(&nearest[i], object, triangles, first, s);
                }
            }
        }
        for (uint32_t i = 0; i < count; i++)
        {
            if (nearest[i].slot == LS_NONE)
            {
                continue;
            }
            float t = ldexpf(nearest[i].s, -carried[i].exponent);
            if (hits[i].instance == LS_NONE || t < hits[i].t)
            {
                const LsTriangle* triangle = &triangles[object->triangles[nearest[i].slot]];
                hits[i] = (LsHit){.t = t,
                                  .instance = instance,
                                  .object = placed->object,
                                  .primitive = triangle->primitive,
                                  .material = triangle->material};
                weigh_corners(object, nearest[i].slot, &projections[i], &hits[i].u, &hits[i].v);
            }
        }
    }
}

void ls_reference_trace(const LsReference* reference, const LsRay* rays, const uint32_t* masks,
                        uint32_t ray_count, uint32_t flags, LsHit* hits)
{
    uint32_t block_count = (ray_count + RAYS_PER_BLOCK - 1) / RAYS_PER_BLOCK;
#pragma omp parallel for schedule(dynamic)
    for (uint32_t block = 0; block < block_count; block++)
    {
        uint32_t first = block * RAYS_PER_BLOCK;
        uint32_t count = ray_count - first < RAYS_PER_BLOCK ? ray_count - first : RAYS_PER_BLOCK;
        trace_block(reference, rays + first, masks ? masks + first : NULL, count, flags,
                    hits + first);
    }
}
