// world.c - transforms and their error bounds, top level, lights.

#include "world.h"

#include "bvh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CONDITION 1e6
// Largest magnitude of a stored matrix element and of world bounds: squares and sums of a few stay
// finite in float.
#define MAX_ELEMENT 1e18

typedef struct Matrix
{
    double m[3][4];
} Matrix;

static double norm(const Matrix* matrix)
{
    double largest = 0.0;
    for (int i = 0; i < 3; i++)
    {
        largest =
            fmax(largest, fabs(matrix->m[i][0]) + fabs(matrix->m[i][1]) + fabs(matrix->m[i][2]));
    }
    return largest;
}

static double determinant(const Matrix* a)
{
    return a->m[0][0] * (a->m[1][1] * a->m[2][2] - a->m[1][2] * a->m[2][1]) -
           a->m[0][1] * (a->m[1][0] * a->m[2][2] - a->m[1][2] * a->m[2][0]) +
           a->m[0][2] * (a->m[1][0] * a->m[2][1] - a->m[1][1] * a->m[2][0]);
}

// The inverse of an affine map; the caller has seen that the determinant is not 0.
static Matrix invert(const Matrix* a)
{
    Matrix out;
    double d = determinant(a);
    for (int i = 0; i < 3; i++)
    {
        for (int j = 0; j < 3; j++)
        {
            int p = (j + 1) % 3, q = (j + 2) % 3, r = (i + 1) % 3, s = (i + 2) % 3;
            out.m[i][j] = (a->m[p][r] * a->m[q][s] - a->m[p][s] * a->m[q][r]) / d;
        }
    }
    for (int i = 0; i < 3; i++)
    {
        out.m[i][3] =
            -(out.m[i][0] * a->m[0][3] + out.m[i][1] * a->m[1][3] + out.m[i][2] * a->m[2][3]);
    }
    return out;
}

static void apply(const Matrix* matrix, const double p[3], double out[3])
{
    for (int i = 0; i < 3; i++)
    {
        const double* row = matrix->m[i];
        out[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    }
}

static void store_rows(const Matrix* matrix, LsVec4 rows[3])
{
    for (int i = 0; i < 3; i++)
    {
        rows[i] = (LsVec4){(float)matrix->m[i][0], (float)matrix->m[i][1], (float)matrix->m[i][2],
                           (float)matrix->m[i][3]};
    }
}

static Matrix load_rows(const LsVec4 rows[3])
{
    Matrix matrix;
    for (int i = 0; i < 3; i++)
    {
        matrix.m[i][0] = rows[i].x;
        matrix.m[i][1] = rows[i].y;
        matrix.m[i][2] = rows[i].z;
        matrix.m[i][3] = rows[i].w;
    }
    return matrix;
}

static bool is_identity(const Matrix* matrix)
{
    for (int i = 0; i < 3; i++)
    {
        for (int j = 0; j < 4; j++)
        {
            if (matrix->m[i][j] != (i == j ? 1.0 : 0.0))
            {
                return false;
            }
        }
    }
    return true;
}

static bool is_storable(const Matrix* matrix)
{
    for (int i = 0; i < 12; i++)
    {
        if (!(fabs(matrix->m[i / 4][i % 4]) <= MAX_ELEMENT))
        {
            return false;
        }
    }
    return true;
}

static LsResult place_instance(LsWorld* world, const LsInput* input, uint32_t index, LsError* error)
{
    const LsInputInstance* source = &input->instances[index];
    const char* name = input->paths[input->meshes[source->mesh].input_index];
    LsInstance* instance = &world->instances[index];
    Matrix placed;
    memcpy(placed.m, source->world_from_object, sizeof placed.m);
    double d = determinant(&placed);
    if (!isfinite(d) || d == 0.0)
    {
        return ls_error_set(error, LS_MESSAGE_TRANSFORM_SINGULAR,
                            "%s: instance %u has a transform that cannot be inverted; give its "
                            "node a scale other than 0",
                            name, index);
    }
    Matrix inverse = invert(&placed);
    double condition = norm(&placed) * norm(&inverse);
    if (!(condition <= MAX_CONDITION))
    {
        return ls_error_set(error, LS_MESSAGE_TRANSFORM_CONDITION,
                            "%s: instance %u has a transform of condition number %.3g, above 1e6; "
                            "scale its axes more alike",
                            name, index, condition);
    }
    if (!is_storable(&placed) || !is_storable(&inverse))
    {
        return ls_error_set(error, LS_MESSAGE_TRANSFORM_RANGE,
                            "%s: instance %u has a transform with numbers beyond 1e18, or its "
                            "inverse has; scale the scene",
                            name, index);
    }
    world->max_condition = fmax(world->max_condition, condition);
    *instance = (LsInstance){.object = source->mesh, .node = source->node, .mask = 255};
    store_rows(&placed, instance->world_from_object);
    store_rows(&inverse, instance->object_from_world);
    if (is_identity(&placed))
    {
        // Without the negative zeros of the inversion.
        memcpy(instance->object_from_world, instance->world_from_object,
               sizeof instance->object_from_world);
        instance->flags |= LS_INSTANCE_IDENTITY;
    }
    instance->flags |= d < 0.0 ? LS_INSTANCE_MIRRORED : 0u;
    return LS_OK;
}

// World box of an instance, true to the stored inverse, and grown by what rounding can move a ray
// that starts within the scene's coordinates: the transform's error and the triangle test's. The
// first is relative to the coordinates in the world and, for objects that lie far from their own
// origin, in object space; 2^-19 is more than twice the sum of both, so the larger is enough
// (docs/exactness.md).
static LsBox instance_box(LsWorld* world, const LsInstance* instance, const LsMesh* mesh)
{
    Matrix stored = load_rows(instance->object_from_world);
    Matrix placed = invert(&stored);
    LsBox box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int corner = 0; corner < 8; corner++)
    {
        double p[3], q[3];
        for (int axis = 0; axis < 3; axis++)
        {
            p[axis] = corner >> axis & 1 ? mesh->upper[axis] : mesh->lower[axis];
        }
        apply(&placed, p, q);
        for (int axis = 0; axis < 3; axis++)
        {
            box.lower[axis] = fmin(box.lower[axis], q[axis]);
            box.upper[axis] = fmax(box.upper[axis], q[axis]);
        }
    }
    double condition = norm(&placed) * norm(&stored);
    double largest = 0.0, longest = 0.0, largest_object = 0.0;
    for (int axis = 0; axis < 3; axis++)
    {
        largest = fmax(largest, fmax(fabs(box.lower[axis]), fabs(box.upper[axis])));
        largest_object =
            fmax(largest_object, fmax(fabs(mesh->lower[axis]), fabs(mesh->upper[axis])));
        longest = fmax(longest, box.upper[axis] - box.lower[axis]);
    }
    double moved = fmax(condition * largest, norm(&placed) * largest_object);
    double grow = moved * 0x1p-19 + longest * 0x1p-15;
    for (int axis = 0; axis < 3; axis++)
    {
        if (mesh->triangle_count > 0)
        {
            world->lower[axis] = fminf(world->lower[axis], ls_float_below(box.lower[axis]));
            world->upper[axis] = fmaxf(world->upper[axis], ls_float_above(box.upper[axis]));
        }
        box.lower[axis] -= grow;
        box.upper[axis] += grow;
    }
    world->transform_bound = fmaxf(world->transform_bound, ls_float_above(condition * 0x1p-19));
    return box;
}

static LsResult make_top_level(LsWorld* world, const LsMesh* meshes, uint32_t object_count,
                               LsError* error)
{
    uint32_t count = world->instance_count;
    LsBox* boxes = malloc(sizeof(LsBox) * count);
    uint32_t* order = malloc(sizeof(uint32_t) * count);
    world->top_nodes = malloc(sizeof(LsBvhNode) * 2 * count);
    if (boxes == NULL || order == NULL || world->top_nodes == NULL)
    {
        free(boxes);
        free(order);
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "out of memory for the top level over %u instances", count);
    }
    for (int axis = 0; axis < 3; axis++)
    {
        world->lower[axis] = INFINITY;
        world->upper[axis] = -INFINITY;
    }
    for (uint32_t i = 0; i < count; i++)
    {
        boxes[i] = instance_box(world, &world->instances[i], &meshes[world->instances[i].object]);
        order[i] = i;
    }
    if (object_count > 1 || count > 1 || (world->instances[0].flags & LS_INSTANCE_IDENTITY) == 0)
    {
        world->top_node_count = ls_bvh_build(boxes, order, count, 1, world->top_nodes);
        for (uint32_t i = 0; i < world->top_node_count; i++)
        {
            LsBvhNode* node = &world->top_nodes[i];
            node->leaf = node->leaf != 0 ? order[node->leaf >> 4] << 4 | 1u : 0u;
        }
    }
    else
    {
        world->transform_bound = 0.0f;
    }
    free(boxes);
    free(order);
    return LS_OK;
}

static double world_area(const Matrix* placed, const LsTriangle* t)
{
    double corners[3][3] = {
        {t->v0.x, t->v0.y, t->v0.z}, {t->v1.x, t->v1.y, t->v1.z}, {t->v2.x, t->v2.y, t->v2.z}};
    double p[3][3];
    for (int k = 0; k < 3; k++)
    {
        apply(placed, corners[k], p[k]);
    }
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
    {
        int u = (i + 1) % 3, v = (i + 2) % 3;
        double n =
            (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
        sum += n * n;
    }
    return 0.5 * sqrt(sum);
}

// Rec. 709 luminance.
static double luminance(LsVec3 c)
{
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

// Calls `take` for every emissive triangle with an area that float can hold.
static void visit_lights(LsWorld* world, const LsInput* input, const LsMesh* meshes,
                         void (*take)(LsWorld* world, LsLight light, double power, double* sum),
                         double* sum)
{
    for (uint32_t i = 0; i < world->instance_count; i++)
    {
        const LsInstance* instance = &world->instances[i];
        const LsMesh* mesh = &meshes[instance->object];
        Matrix placed = load_rows(instance->world_from_object);
        for (uint32_t k = 0; k < mesh->triangle_count; k++)
        {
            const LsMaterial* material = &input->materials[mesh->triangles[k].material].core;
            if ((material->flags & LS_MATERIAL_EMISSIVE) == 0)
            {
                continue;
            }
            double area = world_area(&placed, &mesh->triangles[k]);
            if (area >= FLT_MIN && area <= FLT_MAX)
            {
                LsLight light = {.instance = i, .triangle = k, .area = (float)area};
                take(world, light, area * luminance(material->emission), sum);
            }
        }
    }
}

static void count_light(LsWorld* world, LsLight light, double power, double* sum)
{
    (void)light;
    world->light_count++;
    sum[0] += power;
}

// sum[0]: of all powers; sum[1]: of those so far.
static void store_light(LsWorld* world, LsLight light, double power, double* sum)
{
    sum[1] += power;
    double cumulative = sum[1] / sum[0];
    light.cumulative =
        cumulative < FLT_MIN ? FLT_MIN : (cumulative < 1.0 ? (float)cumulative : 1.0f);
    world->lights[world->light_count++] = light;
}

// Whether the emissive triangles of all instances can be counted, before they are visited one by
// one.
static LsResult bound_lights(const LsWorld* world, const LsInput* input, const LsMesh* meshes,
                             LsError* error)
{
    uint32_t* emissive = calloc(input->mesh_count + 1ull, sizeof *emissive);
    if (emissive == NULL)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for %u objects",
                            input->mesh_count);
    }
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        for (uint32_t k = 0; k < meshes[i].triangle_count; k++)
        {
            const LsMaterial* material = &input->materials[meshes[i].triangles[k].material].core;
            emissive[i] += (material->flags & LS_MATERIAL_EMISSIVE) != 0;
        }
    }
    uint64_t count = 0; // of fewer than 2^32 instances with fewer than 2^32 each
    uint32_t last = 0;
    for (uint32_t i = 0; i < world->instance_count && count <= UINT32_MAX; i++)
    {
        last = world->instances[i].object;
        count += emissive[last];
    }
    free(emissive);
    return count <= UINT32_MAX
               ? LS_OK
               : ls_error_set(error, LS_MESSAGE_LIMIT_RECORDS,
                              "%s: its emissive triangles, with all instances, are more than "
                              "4294967295 lights; place fewer, or make them dark",
                              input->paths[input->meshes[last].input_index]);
}

// Lists the lights; selection by power.
static LsResult list_lights(LsWorld* world, const LsInput* input, const LsMesh* meshes,
                            LsError* error)
{
    LsResult result = bound_lights(world, input, meshes, error);
    if (result != LS_OK)
    {
        return result;
    }
    double sum[2] = {0.0, 0.0};
    visit_lights(world, input, meshes, count_light, sum);
    if (world->light_count == 0)
    {
        return LS_OK;
    }
    world->lights = malloc(sizeof(LsLight) * world->light_count);
    if (world->lights == NULL)
    {
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                            "out of memory for %u emissive triangles", world->light_count);
    }
    world->light_count = 0;
    visit_lights(world, input, meshes, store_light, sum);
    world->lights[world->light_count - 1].cumulative = 1.0f;
    return LS_OK;
}

LsResult ls_world_create(LsWorld* world, const LsInput* input, const LsMesh* meshes, LsError* error)
{
    *world = (LsWorld){.instance_count = input->instance_count};
    world->instances = malloc(sizeof(LsInstance) * (input->instance_count + 1ull));
    LsResult result = world->instances != NULL
                          ? LS_OK
                          : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                         "out of memory for %u instances", input->instance_count);
    for (uint32_t i = 0; i < input->instance_count && result == LS_OK; i++)
    {
        result = place_instance(world, input, i, error);
    }
    result = result == LS_OK ? make_top_level(world, meshes, input->mesh_count, error) : result;
    result = result == LS_OK ? list_lights(world, input, meshes, error) : result;
    if (result != LS_OK)
    {
        ls_world_destroy(world);
    }
    return result;
}

void ls_world_destroy(LsWorld* world)
{
    free(world->instances);
    free(world->top_nodes);
    free(world->lights);
    *world = (LsWorld){0};
}
