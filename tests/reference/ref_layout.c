#include "ref_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
