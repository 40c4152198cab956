#include "ref_trace.h"

#include <float.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define LANES 256 // triangles tested in one go; corners of so many stay in the first-level cache
#define RAYS_PER_BLOCK 32
#define CLUSTER 32 // triangles under one bounding sphere; divides LANES

#define U (1.0 / 16777216.0)

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__)
#define WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDE
#endif

typedef struct LsReferenceSphere
{
    double center[3];
    double radius;
} LsReferenceSphere;

// Triangles in an order that keeps neighbours together, padded to a multiple of LANES with
// triangles that are a point.
typedef struct LsReferenceObject
{
    uint32_t slot_count;
    float* corners[3][3]; // [corner][axis][slot]
    uint32_t* triangles;  // of each slot: index in the object's part of TRIANGLES, or LS_NONE
    LsReferenceSphere* spheres;
    uint32_t* slot_of_primitive; // face_count
} LsReferenceObject;

struct LsReference
{
    const LsFile* file;
    LsReferenceObject* objects;
    uint32_t object_count;
    bool top_level;
};

const char* ls_verdict_text(LsVerdict verdict)
{
    static const char* const texts[] = {
#define LS_VERDICT_TEXT(name, text) text,
        LS_VERDICT_LIST(LS_VERDICT_TEXT)
#undef LS_VERDICT_TEXT
    };
    return texts[verdict];
}

const char* ls_exception_text(LsException exception)
{
    static const char* const texts[] = {
#define LS_EXCEPTION_TEXT(name, text) text,
        LS_EXCEPTION_LIST(LS_EXCEPTION_TEXT)
#undef LS_EXCEPTION_TEXT
    };
    return texts[exception];
}

LsHit ls_reference_miss(void)
{
    return (LsHit){.t = -1.0f,
                   .instance = LS_NONE,
                   .object = LS_NONE,
                   .primitive = LS_NONE,
                   .material = LS_NONE};
}

static float component(LsVec3 v, uint32_t axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// ---- Layout -------------------------------------------------------------------------------------

typedef struct LsSortKey
{
    uint32_t code, triangle;
} LsSortKey;

static int compare_keys(const void* a, const void* b)
{
    const LsSortKey* x = a;
    const LsSortKey* y = b;
    if (x->code != y->code)
    {
        return x->code < y->code ? -1 : 1;
    }
    return x->triangle < y->triangle ? -1 : x->triangle > y->triangle;
}

static uint32_t spread_bits(uint32_t x)
{
    uint32_t result = 0;
    for (uint32_t bit = 0; bit < 10; bit++)
    {
        result |= (x >> bit & 1u) << (3 * bit);
    }
    return result;
}

static uint32_t curve_code(const LsTriangle* triangle, const LsObject* object)
{
    uint32_t code = 0;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double lower = component(object->lower, axis);
        double extent = component(object->upper, axis) - lower;
        double sum = (double)component(triangle->v0, axis) + component(triangle->v1, axis) +
                     component(triangle->v2, axis);
        double middle = sum / 3.0 - lower;
        double cell = extent > 0.0 ? middle / extent * 1023.0 : 0.0;
        code |= spread_bits((uint32_t)fmin(fmax(cell, 0.0), 1023.0)) << axis;
    }
    return code;
}

static LsReferenceSphere bound_cluster(const LsReferenceObject* object, uint32_t first)
{
    double lower[3] = {INFINITY, INFINITY, INFINITY};
    double upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t slot = first; slot < first + CLUSTER; slot++)
    {
        for (uint32_t corner = 0; corner < 3 && object->triangles[slot] != LS_NONE; corner++)
        {
            for (uint32_t axis = 0; axis < 3; axis++)
            {
                lower[axis] = fmin(lower[axis], object->corners[corner][axis][slot]);
                upper[axis] = fmax(upper[axis], object->corners[corner][axis][slot]);
            }
        }
    }
    if (lower[0] > upper[0])
    {
        return (LsReferenceSphere){.radius = -1.0};
    }
    LsReferenceSphere sphere = {.radius = 0.0};
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        sphere.center[axis] = 0.5 * (lower[axis] + upper[axis]);
        sphere.radius += 0.25 * (upper[axis] - lower[axis]) * (upper[axis] - lower[axis]);
    }
    sphere.radius = sqrt(sphere.radius) * (1.0 + 1e-12);
    return sphere;
}

static bool lay_out_object(LsReferenceObject* out, const LsFile* file, const LsObject* object)
{
    const LsTriangle* triangles = file->triangles + object->first_triangle;
    uint32_t count = object->triangle_count;
    out->slot_count = (count + LANES - 1) / LANES * LANES;
    out->triangles = malloc(out->slot_count * sizeof(uint32_t));
    out->slot_of_primitive = malloc(object->face_count * sizeof(uint32_t));
    out->spheres = malloc(out->slot_count / CLUSTER * sizeof(LsReferenceSphere));
    LsSortKey* keys = malloc(count * sizeof(LsSortKey));
    bool complete = out->triangles && out->slot_of_primitive && out->spheres && keys;
    for (uint32_t array = 0; array < 9; array++)
    {
        float* lanes = aligned_alloc(64, out->slot_count * sizeof(float));
        out->corners[array / 3][array % 3] = lanes;
        complete = complete && lanes;
    }
    if (!complete)
    {
        free(keys);
        return false;
    }

    for (uint32_t i = 0; i < count; i++)
    {
        keys[i] = (LsSortKey){curve_code(&triangles[i], object), i};
    }
    qsort(keys, count, sizeof keys[0], compare_keys);
    memset(out->slot_of_primitive, 0xFF, object->face_count * sizeof(uint32_t));
    for (uint32_t slot = 0; slot < out->slot_count; slot++)
    {
        const LsTriangle* triangle = &triangles[keys[slot < count ? slot : 0].triangle];
        const LsVec3 corners[3] = {triangle->v0, triangle->v1, triangle->v2};
        for (uint32_t array = 0; array < 9; array++)
        {
            LsVec3 corner = corners[slot < count ? array / 3 : 0];
            out->corners[array / 3][array % 3][slot] = component(corner, array % 3);
        }
        out->triangles[slot] = slot < count ? keys[slot].triangle : LS_NONE;
        if (slot < count)
        {
            out->slot_of_primitive[triangle->primitive] = slot;
        }
    }
    for (uint32_t first = 0; first < out->slot_count; first += CLUSTER)
    {
        out->spheres[first / CLUSTER] = bound_cluster(out, first);
    }
    free(keys);
    return true;
}

LsReference* ls_reference_create(const LsFile* file)
{
    LsReference* reference = calloc(1, sizeof *reference);
    if (!reference)
    {
        return NULL;
    }
    reference->file = file;
    reference->object_count = ls_file_count(file, LS_CHUNK_OBJECTS);
    reference->top_level = (file->header->required_features & LS_FEATURE_TOP_LEVEL) != 0;
    reference->objects = calloc(reference->object_count, sizeof(LsReferenceObject));
    if (!reference->objects)
    {
        free(reference);
        return NULL;
    }
    for (uint32_t i = 0; i < reference->object_count; i++)
    {
        if (!lay_out_object(&reference->objects[i], file, &file->objects[i]))
        {
            ls_reference_destroy(reference);
            return NULL;
        }
    }
    return reference;
}

void ls_reference_destroy(LsReference* reference)
{
    if (!reference)
    {
        return;
    }
    for (uint32_t i = 0; i < reference->object_count; i++)
    {
        LsReferenceObject* object = &reference->objects[i];
        for (uint32_t array = 0; array < 9; array++)
        {
            free(object->corners[array / 3][array % 3]);
        }
        free(object->triangles);
        free(object->slot_of_primitive);
        free(object->spheres);
    }
    free(reference->objects);
    free(reference);
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

// ---- The same in double, with margins -----------------------------------------------------------

// A ray in double from its carried origin, with a frame across it: two unit vectors at right angles
// to it.
typedef struct LsWideRay
{
    double origin[3], direction[3];
    double length; // of direction
    double across[2][3];
    double smin, smax;
    double moved; // largest length of a moved origin's coordinates, to which moving rounds; or 0
    int exponent;
} LsWideRay;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static LsWideRay widen_ray(const LsObject* object, const LsObjectRay* ray, const LsRay* world)
{
    LsWideRay wide = {.smin = ldexp(world->tmin, ray->exponent),
                      .smax = ldexp(fmin(world->tmax, FLT_MAX), ray->exponent),
                      .exponent = ray->exponent};
    uint32_t smallest = 0;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        wide.origin[axis] = ray->carried[axis];
        wide.direction[axis] = ray->direction[axis];
        smallest = fabsf(ray->direction[axis]) < fabsf(ray->direction[smallest]) ? axis : smallest;
    }
    wide.length = sqrt(dot(wide.direction, wide.direction));
    if (ray->far)
    {
        // Wherever in the box a device moves the origin to.
        const LsVec3 l = object->lower, u = object->upper;
        const double farthest[3] = {fmax(fabs(l.x), fabs(u.x)), fmax(fabs(l.y), fabs(u.y)),
                                    fmax(fabs(l.z), fabs(u.z))};
        wide.moved = sqrt(dot(farthest, farthest));
    }
    double axis_vector[3] = {smallest == 0, smallest == 1, smallest == 2};
    cross(wide.direction, axis_vector, wide.across[0]);
    double scale = 1.0 / sqrt(dot(wide.across[0], wide.across[0]));
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        wide.across[0][axis] *= scale;
    }
    cross(wide.direction, wide.across[0], wide.across[1]);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        wide.across[1][axis] /= wide.length;
    }
    return wide;
}

// Distance of the origin of the plane from the segment p q, and from its line.
static void measure_edge(const double p[2], const double q[2], double* segment, double* line)
{
    double e[2] = {q[0] - p[0], q[1] - p[1]};
    double squared = e[0] * e[0] + e[1] * e[1];
    double along = squared > 0.0 ? -(p[0] * e[0] + p[1] * e[1]) / squared : 0.0;
    double clamped = fmin(fmax(along, 0.0), 1.0);
    *segment = hypot(p[0] + clamped * e[0], p[1] + clamped * e[1]);
    *line = squared > 0.0 ? fabs(p[0] * q[1] - p[1] * q[0]) / sqrt(squared) : *segment;
}

typedef struct LsCandidate
{
    LsReferenceMargin margin;
    double farthest_line; // of the three edge lines from the ray's line
    double s, s_bound;
    uint32_t instance, primitive;
    bool possible; // some device may return it
    bool certain;  // no device may overlook it
} LsCandidate;

// Measures a triangle, or says that the ray's line stays more than 16 u L away from it.
static bool measure_triangle(const LsReferenceObject* object, uint32_t slot, const LsWideRay* ray,
                             bool keep_far, LsCandidate* out)
{
    double corners[3][3], flat[3][2];
    double farthest = 0.0;
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            corners[corner][axis] = object->corners[corner][axis][slot] - ray->origin[axis];
        }
        flat[corner][0] = dot(corners[corner], ray->across[0]);
        flat[corner][1] = dot(corners[corner], ray->across[1]);
        farthest = fmax(farthest, dot(corners[corner], corners[corner]));
    }
    double reach = fmax(sqrt(farthest), ray->moved);
    double bound = 16.0 * U * reach;
    for (uint32_t axis = 0; axis < 2 && !keep_far; axis++)
    {
        double lowest = fmin(fmin(flat[0][axis], flat[1][axis]), flat[2][axis]);
        double highest = fmax(fmax(flat[0][axis], flat[1][axis]), flat[2][axis]);
        if (lowest > bound || highest < -bound)
        {
            return false;
        }
    }

    double distance = INFINITY;
    out->farthest_line = 0.0;
    int below = 0, above = 0;
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        const double* p = flat[corner];
        const double* q = flat[(corner + 1) % 3];
        double segment, line;
        measure_edge(p, q, &segment, &line);
        distance = fmin(distance, segment);
        out->farthest_line = fmax(out->farthest_line, line);
        double side = p[0] * q[1] - p[1] * q[0];
        below |= side < 0.0;
        above |= side > 0.0;
    }
    bool inside = !(below && above) && (below || above);
    if (!keep_far && !inside && distance > bound)
    {
        return false;
    }

    double e1[3], e2[3], n[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        e1[axis] = corners[1][axis] - corners[0][axis];
        e2[axis] = corners[2][axis] - corners[0][axis];
    }
    cross(e1, e2, n);
    double n_length = sqrt(dot(n, n));
    double n_d = dot(n, ray->direction);
    out->s = dot(n, corners[0]) / n_d;
    out->s_bound = n_d != 0.0 ? 16.0 * U * (fabs(out->s) + reach * n_length / fabs(n_d)) : INFINITY;
    out->margin = (LsReferenceMargin){
        .t = ldexp(out->s, -ray->exponent),
        .t_bound = ldexp(out->s_bound, -ray->exponent),
        .edge_distance = distance,
        .edge_bound = bound,
        .cosine = n_length > 0.0 ? fabs(n_d) / (n_length * ray->length) : 0.0,
        .inside = inside,
    };
    bool flat_on = isfinite(out->s_bound);
    out->possible =
        n_length > 0.0 && (inside || distance <= bound) &&
        (!flat_on || (out->s + out->s_bound > ray->smin && out->s - out->s_bound < ray->smax));
    out->certain = inside && flat_on && distance > bound && out->s - out->s_bound > ray->smin &&
                   out->s + out->s_bound < ray->smax;
    return true;
}

typedef struct LsCandidates
{
    LsCandidate* items;
    uint32_t count, capacity;
} LsCandidates;

static void add_candidate(LsCandidates* list, const LsCandidate* candidate)
{
    if (list->count == list->capacity)
    {
        list->capacity = list->capacity ? 2 * list->capacity : 64;
        list->items = realloc(list->items, list->capacity * sizeof(LsCandidate));
        if (!list->items)
        {
            abort();
        }
    }
    list->items[list->count++] = *candidate;
}

// Whether the ray's line can pass a triangle of the cluster closer than 16 u L.
static bool line_meets_sphere(const LsWideRay* ray, const LsReferenceSphere* sphere)
{
    double to_center[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        to_center[axis] = sphere->center[axis] - ray->origin[axis];
    }
    double x = dot(to_center, ray->across[0]);
    double y = dot(to_center, ray->across[1]);
    double distance = sqrt(dot(to_center, to_center));
    double reach = sphere->radius + 17.0 * U * fmax(distance + sphere->radius, ray->moved);
    return sphere->radius >= 0.0 && x * x + y * y <= reach * reach;
}

static void gather_candidates(const LsReference* reference, const LsRay* world, uint32_t mask,
                              bool all, LsCandidates* list)
{
    const LsFile* file = reference->file;
    list->count = 0;
    for (uint32_t instance = 0; instance < ls_file_count(file, LS_CHUNK_INSTANCES); instance++)
    {
        uint32_t object_index = file->instances[instance].object;
        const LsReferenceObject* object = &reference->objects[object_index];
        const LsTriangle* triangles = file->triangles + file->objects[object_index].first_triangle;
        LsObjectRay carried;
        if (!ls_reference_carry(reference, instance, world, mask, &carried))
        {
            continue;
        }
        LsWideRay ray = widen_ray(&file->objects[object_index], &carried, world);
        for (uint32_t first = 0; first < object->slot_count; first += CLUSTER)
        {
            if (!all && !line_meets_sphere(&ray, &object->spheres[first / CLUSTER]))
            {
                continue;
            }
            for (uint32_t slot = first; slot < first + CLUSTER; slot++)
            {
                LsCandidate candidate = {.instance = instance};
                if (object->triangles[slot] != LS_NONE &&
                    measure_triangle(object, slot, &ray, false, &candidate) && candidate.possible)
                {
                    candidate.primitive = triangles[object->triangles[slot]].primitive;
                    add_candidate(list, &candidate);
                }
            }
        }
    }
}

static bool measure_hit(const LsReference* reference, const LsRay* world, uint32_t mask,
                        uint32_t instance, uint32_t primitive, LsCandidate* out)
{
    const LsFile* file = reference->file;
    if (instance >= ls_file_count(file, LS_CHUNK_INSTANCES))
    {
        return false;
    }
    uint32_t object_index = file->instances[instance].object;
    const LsReferenceObject* object = &reference->objects[object_index];
    LsObjectRay carried;
    if (primitive >= file->objects[object_index].face_count ||
        object->slot_of_primitive[primitive] == LS_NONE ||
        !ls_reference_carry(reference, instance, world, mask, &carried))
    {
        return false;
    }
    LsWideRay ray = widen_ray(&file->objects[object_index], &carried, world);
    *out = (LsCandidate){.instance = instance, .primitive = primitive};
    return measure_triangle(object, object->slot_of_primitive[primitive], &ray, true, out);
}

bool ls_reference_margin(const LsReference* reference, const LsRay* ray, uint32_t mask,
                         uint32_t instance, uint32_t primitive, LsReferenceMargin* margin)
{
    LsCandidate measured;
    bool found = measure_hit(reference, ray, mask, instance, primitive, &measured);
    if (found)
    {
        *margin = measured.margin;
    }
    return found;
}

// What double precision answers: the nearest triangle that the line passes through, or NULL.
static const LsCandidate* find_winner(const LsCandidates* list, const LsRay* ray)
{
    const LsCandidate* winner = NULL;
    for (uint32_t i = 0; i < list->count; i++)
    {
        const LsCandidate* item = &list->items[i];
        if (item->margin.inside && item->margin.t > ray->tmin && item->margin.t < ray->tmax &&
            (!winner || item->margin.t < winner->margin.t))
        {
            winner = item;
        }
    }
    return winner;
}

static bool is_near_edge(const LsCandidate* item)
{
    return item->margin.edge_distance <= item->margin.edge_bound;
}

static LsVerdict judge_miss(const LsCandidates* list, const LsCandidate* winner)
{
    for (uint32_t i = 0; i < list->count; i++)
    {
        if (list->items[i].certain)
        {
            return LS_VERDICT_DEFECT;
        }
    }
    return !winner ? LS_VERDICT_RIGHT : is_near_edge(winner) ? LS_VERDICT_EDGE : LS_VERDICT_T_ERROR;
}

static LsVerdict judge_hit(const LsReference* reference, const LsRay* ray, uint32_t mask,
                           const LsCandidates* list, const LsCandidate* winner, const LsHit* hit)
{
    LsCandidate own;
    if (!measure_hit(reference, ray, mask, hit->instance, hit->primitive, &own))
    {
        return LS_VERDICT_DEFECT;
    }
    // Where t leaves the range of normal floats devices flush or overflow; it is held to no more
    // than that.
    double bound = own.margin.t_bound;
    bool held = isfinite(bound) ? fabs(hit->t - own.margin.t) <= bound : true;
    bool within = hit->t > ray->tmin && hit->t < ray->tmax;
    bool tiny = own.margin.t + bound < 0x1p-120 && hit->t < 0x1p-119f;
    bool huge = own.margin.t - bound > 0x1p127 && hit->t > 0x1p126f;
    if (!(held && within) && !tiny && !huge)
    {
        return LS_VERDICT_DEFECT;
    }
    bool is_winner =
        winner && winner->instance == hit->instance && winner->primitive == hit->primitive;
    if (is_winner)
    {
        return LS_VERDICT_RIGHT;
    }
    if (!own.possible)
    {
        return own.farthest_line <= own.margin.edge_bound ? LS_VERDICT_EDGE_ON : LS_VERDICT_DEFECT;
    }
    double latest = isfinite(own.margin.t_bound) ? own.margin.t - own.margin.t_bound : -INFINITY;
    for (uint32_t i = 0; i < list->count; i++)
    {
        const LsCandidate* item = &list->items[i];
        if (item->certain && item->margin.t + item->margin.t_bound < latest)
        {
            return LS_VERDICT_DEFECT;
        }
    }
    return is_near_edge(&own) || (winner && is_near_edge(winner)) ? LS_VERDICT_EDGE
                                                                  : LS_VERDICT_T_ERROR;
}

static LsVerdict judge_answer(const LsReference* reference, const LsRay* ray, uint32_t mask,
                              const LsCandidates* list, const LsHit* answer)
{
    const LsCandidate* winner = find_winner(list, ray);
    return answer->instance == LS_NONE ? judge_miss(list, winner)
                                       : judge_hit(reference, ray, mask, list, winner, answer);
}

void ls_reference_judge(const LsReference* reference, const LsRay* rays, const uint32_t* masks,
                        uint32_t ray_count, uint32_t answer_count, const LsHit* const* answers,
                        LsVerdict* const* verdicts)
{
#pragma omp parallel
    {
        LsCandidates list = {.items = NULL};
#pragma omp for schedule(dynamic, 64)
        for (uint32_t i = 0; i < ray_count; i++)
        {
            uint32_t mask = masks ? masks[i] : 255u;
            gather_candidates(reference, &rays[i], mask, false, &list);
            for (uint32_t a = 0; a < answer_count; a++)
            {
                verdicts[a][i] = judge_answer(reference, &rays[i], mask, &list, &answers[a][i]);
            }
        }
        free(list.items);
    }
}

LsVerdict ls_reference_judge_all(const LsReference* reference, const LsRay* ray, uint32_t mask,
                                 const LsHit* answer)
{
    LsCandidates list = {.items = NULL};
    gather_candidates(reference, ray, mask, true, &list);
    LsVerdict verdict = judge_answer(reference, ray, mask, &list, answer);
    free(list.items);
    return verdict;
}

// ---- The exception of SPEC 7.6 ------------------------------------------------------------------

// The leaf cell that a point of grid space lies in: its lower corner and width, in cells of the
// grid.
static bool find_cell(const LsFile* file, const LsObject* object, const double p[3],
                      double lower[3], double* width)
{
    uint32_t blocks[3], cell[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        if (!(p[axis] >= 0.0 && p[axis] < object->cells[axis]))
        {
            return false;
        }
        cell[axis] = (uint32_t)p[axis];
        lower[axis] = cell[axis];
        blocks[axis] = (object->cells[axis] + 3) / 4;
    }
    *width = 1.0;
    uint32_t word = file->blocks[object->first_block + cell[0] / 4 +
                                 blocks[0] * (cell[1] / 4 + blocks[1] * (cell[2] / 4))];
    while ((word & 15u) == 0)
    {
        const LsCellBlock* block = &file->cell_blocks[object->first_cell_block + (word >> 4)];
        word = block->cells[cell[0] % 4 + 4 * (cell[1] % 4 + 4 * (cell[2] % 4))];
        if ((word & 15u) != 0)
        {
            break;
        }
        const LsVoxel* voxel = &file->voxels[object->first_voxel + (word >> 4)];
        if ((voxel->shape & 255u) != LS_VOXEL_SUBGRID)
        {
            break;
        }
        word = voxel->table << 4;
        *width *= 0.25;
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            cell[axis] = (uint32_t)fmin((p[axis] - lower[axis]) / *width, 3.0);
            lower[axis] += cell[axis] * *width;
        }
    }
    return true;
}

// Whether [s - reach, s + reach] leaves the cell in which the ray is at s.
static bool leaves_cell(const LsFile* file, const LsObject* object, const LsWideRay* ray, double s,
                        double reach)
{
    if (object->kind != LS_OBJECT_GRID)
    {
        return false;
    }
    double o[3], d[3], p[3], lower[3], width;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        o[axis] = (ray->origin[axis] - component(object->grid_lower, axis)) * object->inverse_cell;
        d[axis] = ray->direction[axis] * object->inverse_cell;
        p[axis] = o[axis] + d[axis] * s;
    }
    if (!find_cell(file, object, p, lower, &width))
    {
        return true; // the hit itself has left the grid
    }
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double from = p[axis] - fabs(d[axis]) * reach;
        double to = p[axis] + fabs(d[axis]) * reach;
        if (!(from >= lower[axis] && to <= lower[axis] + width))
        {
            return true;
        }
    }
    return false;
}

LsException ls_reference_explain(const LsReference* reference, const LsRay* ray, uint32_t mask,
                                 const LsHit* all, const LsHit* exact, double* cosine)
{
    LsCandidate overtaken, other;
    *cosine = 1.0;
    if (!measure_hit(reference, ray, mask, all->instance, all->primitive, &overtaken))
    {
        return LS_EXCEPTION_NONE;
    }
    bool is_hit = exact->instance != LS_NONE;
    bool same = exact->instance == all->instance && exact->primitive == all->primitive;
    if (same || (is_hit && exact->t < all->t))
    {
        return LS_EXCEPTION_NONE; // a hit that testing all triangles does not find, or other bits
    }

    *cosine = overtaken.margin.cosine;
    double bound = isfinite(overtaken.margin.t_bound) ? overtaken.margin.t_bound : INFINITY;
    if (*cosine <= LS_EDGE_ON_COSINE)
    {
        if (is_hit && all->t + bound >= exact->t)
        {
            return LS_EXCEPTION_OTHER_HIT;
        }
        if (all->t + bound >= ray->tmax)
        {
            return LS_EXCEPTION_TMAX;
        }
        const LsObject* object =
            &reference->file->objects[reference->file->instances[all->instance].object];
        LsObjectRay carried;
        if (ls_reference_carry(reference, all->instance, ray, mask, &carried))
        {
            LsWideRay wide = widen_ray(object, &carried, ray);
            if (leaves_cell(reference->file, object, &wide, ldexp(all->t, wide.exponent),
                            ldexp(bound, wide.exponent)))
            {
                return LS_EXCEPTION_CELL_END;
            }
        }
    }
    if (is_hit && measure_hit(reference, ray, mask, exact->instance, exact->primitive, &other) &&
        other.margin.cosine <= LS_EDGE_ON_COSINE &&
        exact->t - (isfinite(other.margin.t_bound) ? other.margin.t_bound : INFINITY) <= all->t)
    {
        *cosine = other.margin.cosine;
        return LS_EXCEPTION_OTHER_HIT;
    }
    return LS_EXCEPTION_NONE;
}
