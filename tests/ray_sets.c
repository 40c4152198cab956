#include "ray_sets.h"

#include "test_random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

const char* ls_ray_class_name(LsRayClass ray_class)
{
    static const char* const names[] = {
#define LS_RAY_CLASS_TEXT(name, text) text,
        LS_RAY_CLASS_LIST(LS_RAY_CLASS_TEXT)
#undef LS_RAY_CLASS_TEXT
    };
    return names[ray_class];
}

// Of each hundred rays.
static const uint8_t SHARES[LS_RAY_CLASS_COUNT] = {14, 11, 14, 10, 10, 11, 12, 6, 4, 3, 4, 1};

typedef struct LsRayMaker
{
    const LsFile* file;
    LsRandom random;
    double lower[3], upper[3]; // of the scene
    double size;
    // The instance of the ray being made.
    const LsInstance* instance;
    const LsObject* object;
    double object_size;
} LsRayMaker;

static double between(LsRayMaker* maker, double lower, double upper)
{
    return ls_random_between(&maker->random, lower, upper);
}

static uint32_t below(LsRayMaker* maker, uint32_t count)
{
    return ls_random_below(&maker->random, count);
}

static LsRay make_ray(const double origin[3], const double direction[3], double tmin, double tmax)
{
    return (LsRay){
        .origin = {(float)origin[0], (float)origin[1], (float)origin[2]},
        .tmin = (float)tmin,
        .direction = {(float)direction[0], (float)direction[1], (float)direction[2]},
        .tmax = (float)tmax,
    };
}

static void copy_vector(LsVec3 v, double out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

static void normalize(double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (uint32_t axis = 0; axis < 3 && length > 0.0; axis++)
    {
        v[axis] /= length;
    }
}

static void pick_direction(LsRayMaker* maker, double d[3])
{
    double squared;
    do
    {
        squared = 0.0;
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            d[axis] = between(maker, -1.0, 1.0);
            squared += d[axis] * d[axis];
        }
    } while (squared > 1.0 || squared < 1e-4);
    normalize(d);
}

// A point of the scene's box, stretched about its middle.
static void pick_point(LsRayMaker* maker, double stretch, double p[3])
{
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double middle = 0.5 * (maker->lower[axis] + maker->upper[axis]);
        double half = 0.5 * (maker->upper[axis] - maker->lower[axis]) + 0.01 * maker->size;
        p[axis] = middle + stretch * half * between(maker, -1.0, 1.0);
    }
}

// ---- Between object and world -------------------------------------------------------------------

static void move_point(const LsRayMaker* maker, double p[3])
{
    const LsVec4* m = maker->instance->world_from_object;
    const double q[3] = {p[0], p[1], p[2]};
    for (uint32_t row = 0; row < 3; row++)
    {
        p[row] = m[row].x * q[0] + m[row].y * q[1] + m[row].z * q[2] + m[row].w;
    }
}

static void move_vector(const LsRayMaker* maker, double v[3])
{
    const LsVec4* m = maker->instance->world_from_object;
    const double q[3] = {v[0], v[1], v[2]};
    for (uint32_t row = 0; row < 3; row++)
    {
        v[row] = m[row].x * q[0] + m[row].y * q[1] + m[row].z * q[2];
    }
}

// A ray that was made in object space. The identity leaves zeros their sign.
static LsRay carry_out(const LsRayMaker* maker, double origin[3], double direction[3], double tmin,
                       double tmax)
{
    if ((maker->instance->flags & LS_INSTANCE_IDENTITY) == 0)
    {
        move_point(maker, origin);
        move_vector(maker, direction);
    }
    return make_ray(origin, direction, tmin, tmax);
}

static void pick_instance(LsRayMaker* maker)
{
    uint32_t count = ls_file_count(maker->file, LS_CHUNK_INSTANCES);
    maker->instance = &maker->file->instances[below(maker, count)];
    maker->object = &maker->file->objects[maker->instance->object];
    maker->object_size = fmax(fmax((double)maker->object->upper.x - maker->object->lower.x,
                                   (double)maker->object->upper.y - maker->object->lower.y),
                              (double)maker->object->upper.z - maker->object->lower.z);
}

static const LsTriangle* pick_triangle(LsRayMaker* maker)
{
    const LsObject* object = maker->object;
    return &maker->file->triangles[object->first_triangle + below(maker, object->triangle_count)];
}

static void get_corners(const LsTriangle* triangle, double corners[3][3])
{
    copy_vector(triangle->v0, corners[0]);
    copy_vector(triangle->v1, corners[1]);
    copy_vector(triangle->v2, corners[2]);
}

// A point of a triangle in object space and, if asked, its unit normal.
static void pick_surface(LsRayMaker* maker, double p[3], double n[3])
{
    double c[3][3], e1[3], e2[3];
    get_corners(pick_triangle(maker), c);
    double u = between(maker, 0.0, 1.0), v = between(maker, 0.0, 1.0);
    bool fold = u + v > 1.0;
    u = fold ? 1.0 - u : u;
    v = fold ? 1.0 - v : v;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        e1[axis] = c[1][axis] - c[0][axis];
        e2[axis] = c[2][axis] - c[0][axis];
        p[axis] = c[0][axis] + u * e1[axis] + v * e2[axis];
    }
    for (uint32_t axis = 0; axis < 3 && n; axis++)
    {
        uint32_t i = (axis + 1) % 3, j = (axis + 2) % 3;
        n[axis] = e1[i] * e2[j] - e1[j] * e2[i];
    }
    if (n)
    {
        normalize(n);
    }
}

// A point in and around the object's box.
static void pick_object_point(LsRayMaker* maker, double p[3])
{
    double lower[3], upper[3];
    copy_vector(maker->object->lower, lower);
    copy_vector(maker->object->upper, upper);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double margin = 0.3 * maker->object_size;
        p[axis] = between(maker, lower[axis] - margin, upper[axis] + margin);
    }
}

// A corner of the object's cells, at times of the quarters of cells; for lists, of eighths of the
// box.
static void pick_cell_corner(LsRayMaker* maker, double p[3], double* cell)
{
    const LsObject* object = maker->object;
    bool is_grid = object->kind == LS_OBJECT_GRID;
    double origin[3];
    copy_vector(is_grid ? object->grid_lower : object->lower, origin);
    *cell = is_grid ? 1.0 / object->inverse_cell : maker->object_size / 8.0;
    uint32_t parts = below(maker, 3) == 0 ? 4 : 1;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        uint32_t cells = is_grid ? object->cells[axis] : 8;
        p[axis] = origin[axis] + below(maker, cells * parts + 1) * *cell / parts;
    }
}

// ---- Classes ------------------------------------------------------------------------------------

static LsRay make_camera(LsRayMaker* maker)
{
    // Four eyes that never move.
    LsRandom eyes = {1000 + below(maker, 4)};
    double eye[3], target[3], d[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double side = ls_random_below(&eyes, 2) ? 1.0 : -1.0;
        eye[axis] = 0.5 * (maker->lower[axis] + maker->upper[axis]) +
                    side * ls_random_between(&eyes, 0.8, 1.5) * maker->size;
    }
    pick_point(maker, 1.0, target);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        d[axis] = target[axis] - eye[axis];
    }
    normalize(d);
    return make_ray(eye, d, 0.0, INFINITY);
}

// A surface point of the world, moved off the surface to one of its sides.
static void pick_start(LsRayMaker* maker, double p[3], double n[3])
{
    double tip[3];
    pick_surface(maker, p, n);
    double side = below(maker, 2) ? 1.0 : -1.0;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        n[axis] *= side;
        p[axis] += 1e-4 * maker->object_size * n[axis];
        tip[axis] = n[axis];
    }
    move_point(maker, p);
    move_vector(maker, tip);
    normalize(tip);
    memcpy(n, tip, sizeof tip);
}

static LsRay make_shadow(LsRayMaker* maker)
{
    double p[3], n[3], d[3];
    pick_start(maker, p, n);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double light =
            maker->upper[axis] + maker->size * (axis == 1 ? 0.5 : between(maker, -0.6, 0.2));
        d[axis] = light - p[axis];
    }
    if (below(maker, 2))
    {
        return make_ray(p, d, 0.0, 1.0);
    }
    double distance = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    normalize(d);
    return make_ray(p, d, 1e-4 * maker->size, distance);
}

static LsRay make_diffuse(LsRayMaker* maker)
{
    double p[3], n[3], d[3];
    pick_start(maker, p, n);
    pick_direction(maker, d);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        d[axis] = 1.0001 * n[axis] + d[axis];
    }
    normalize(d);
    return make_ray(p, d, below(maker, 2) ? 0.0 : 1e-4 * maker->size, INFINITY);
}

static LsRay make_random(LsRayMaker* maker)
{
    double p[3], d[3];
    pick_point(maker, 1.5, p);
    pick_direction(maker, d);
    return make_ray(p, d, 0.0, INFINITY);
}

static LsRay make_axis(LsRayMaker* maker)
{
    double p[3], d[3], cell;
    uint32_t kind = below(maker, 4);
    if (kind == 0)
    {
        pick_cell_corner(maker, p, &cell);
    }
    else if (kind == 1)
    {
        pick_surface(maker, p, NULL);
    }
    else
    {
        pick_object_point(maker, p);
    }
    uint32_t axis = below(maker, 3);
    for (uint32_t i = 0; i < 3; i++)
    {
        d[i] = below(maker, 2) ? 0.0 : -0.0;
    }
    d[axis] = below(maker, 2) ? 1.0 : -1.0;
    if (below(maker, 3) == 0)
    {
        d[(axis + 1) % 3] = below(maker, 2) ? d[axis] : between(maker, -1.0, 1.0);
    }
    if (below(maker, 2))
    {
        p[axis] -= d[axis] * between(maker, 0.0, 1.5) * maker->object_size;
    }
    return carry_out(maker, p, d, 0.0, INFINITY);
}

static LsRay make_cell(LsRayMaker* maker)
{
    double p[3], q[3], d[3], cell;
    pick_cell_corner(maker, p, &cell);
    uint32_t axis = below(maker, 3);
    switch (below(maker, 4))
    {
    case 0: // through a corner from anywhere
        pick_object_point(maker, q);
        for (uint32_t i = 0; i < 3; i++)
        {
            d[i] = p[i] - q[i];
        }
        return carry_out(maker, q, d, 0.0, INFINITY);
    case 1: // from corner to corner
        pick_cell_corner(maker, q, &cell);
        for (uint32_t i = 0; i < 3; i++)
        {
            d[i] = p[i] - q[i];
            q[i] -= d[i];
        }
        if (d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0)
        {
            d[axis] = 1.0;
        }
        return carry_out(maker, q, d, 0.0, INFINITY);
    case 2: // in the plane of a face
        pick_direction(maker, d);
        d[axis] = 0.0;
        for (uint32_t i = 0; i < 3; i++)
        {
            p[i] -= d[i] * maker->object_size;
        }
        return carry_out(maker, p, d, 0.0, INFINITY);
    default: // along diagonals of cells and of their faces
        for (uint32_t i = 0; i < 3; i++)
        {
            d[i] = below(maker, 2) ? 1.0 : -1.0;
        }
        d[axis] *= below(maker, 3) == 0 ? 0.0 : 1.0;
        double steps = below(maker, 64);
        for (uint32_t i = 0; i < 3; i++)
        {
            p[i] -= d[i] * steps * cell;
        }
        return carry_out(maker, p, d, 0.0, INFINITY);
    }
}

static LsRay make_corner(LsRayMaker* maker)
{
    double c[3][3], p[3], q[3], d[3];
    get_corners(pick_triangle(maker), c);
    uint32_t corner = below(maker, 3);
    const double* a = c[corner];
    const double* b = c[(corner + 1) % 3];
    uint32_t kind = below(maker, 8);
    double along = kind < 4 ? 0.0 : kind == 4 ? 0.5 : between(maker, 0.0, 1.0);
    if (below(maker, 2))
    {
        pick_object_point(maker, p);
    }
    else
    {
        pick_surface(maker, p, NULL);
    }
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        q[axis] = a[axis] + along * (b[axis] - a[axis]);
        if (kind == 7) // along the edge
        {
            p[axis] = a[axis] - 1.5 * (b[axis] - a[axis]);
            q[axis] = b[axis];
        }
        d[axis] = q[axis] - p[axis];
    }
    return carry_out(maker, p, d, 0.0, INFINITY);
}

static LsRay make_origin(LsRayMaker* maker)
{
    double c[3][3], p[3], d[3], cell;
    get_corners(pick_triangle(maker), c);
    pick_direction(maker, d);
    switch (below(maker, 4))
    {
    case 0:
        memcpy(p, c[below(maker, 3)], sizeof p);
        break;
    case 1:
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            p[axis] = 0.5 * (c[0][axis] + c[1][axis]);
        }
        break;
    case 2:
        pick_surface(maker, p, NULL);
        break;
    default:
        pick_cell_corner(maker, p, &cell);
        break;
    }
    return carry_out(maker, p, d, 0.0, INFINITY);
}

static LsRay make_far(LsRayMaker* maker)
{
    double p[3], d[3];
    pick_surface(maker, p, NULL);
    move_point(maker, p);
    pick_direction(maker, d);
    double distance = maker->size * pow(10.0, between(maker, 3.0, 7.0));
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        p[axis] -= distance * d[axis];
    }
    return make_ray(p, d, 0.0, INFINITY);
}

static LsRay make_scaled(LsRayMaker* maker)
{
    static const double scales[] = {1e-28, 1e-20, 1e-6, 1e6, 1e20, 1e37};
    LsRay ray = below(maker, 2) ? make_random(maker) : make_camera(maker);
    double scale = scales[below(maker, 6)];
    ray.direction.x = (float)(ray.direction.x * scale);
    ray.direction.y = (float)(ray.direction.y * scale);
    ray.direction.z = (float)(ray.direction.z * scale);
    if (below(maker, 2))
    {
        double tmax = 2.0 * maker->size / scale;
        ray.tmax = tmax < 3e38 ? (float)tmax : INFINITY;
    }
    return ray;
}

static LsRay make_cut(LsRayMaker* maker)
{
    double p[3], q[3], d[3];
    pick_surface(maker, q, NULL);
    pick_object_point(maker, p);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        d[axis] = q[axis] - p[axis];
    }
    static const double offsets[] = {0.0, 1e-7, -1e-7, 1e-4, -1e-4, 0.2, -0.2};
    double cut = 1.0 + offsets[below(maker, 7)];
    bool at_start = below(maker, 2) != 0;
    return carry_out(maker, p, d, at_start ? cut : 0.0, at_start ? INFINITY : cut);
}

static LsRay make_illegal(LsRayMaker* maker)
{
    LsRay ray = make_camera(maker);
    switch (below(maker, 8))
    {
    case 0:
        ray.origin.y = NAN;
        break;
    case 1:
        ray.direction.x = NAN;
        break;
    case 2:
        ray.direction = (LsVec3){0.0f, -0.0f, 0.0f};
        break;
    case 3:
        ray.direction.z = -INFINITY;
        break;
    case 4:
        ray.tmin = -1.0f;
        break;
    case 5:
        ray.tmax = ray.tmin;
        break;
    case 6:
        ray.tmax = NAN;
        break;
    default:
        ray.origin.x = INFINITY;
        break;
    }
    return ray;
}

typedef LsRay LsRayClassMaker(LsRayMaker* maker);

static LsRayClassMaker* const MAKERS[LS_RAY_CLASS_COUNT] = {
    make_camera, make_shadow, make_diffuse, make_random, make_axis, make_cell,
    make_corner, make_origin, make_far,     make_scaled, make_cut,  make_illegal,
};

LsRaySet ls_ray_set_make(const LsFile* file, uint32_t count, uint64_t seed)
{
    LsRaySet set = {.count = count};
    set.rays = malloc(count * sizeof *set.rays);
    set.classes = malloc(count);
    assert_true(set.rays && set.classes);
    LsRayMaker maker = {.file = file, .random = {seed}};
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        maker.lower[axis] = file->header->lower[axis];
        maker.upper[axis] = file->header->upper[axis];
        maker.size = fmax(maker.size, maker.upper[axis] - maker.lower[axis]);
    }
    for (uint32_t i = 0; i < count; i++)
    {
        uint32_t ticket = i % 100;
        uint8_t ray_class = 0;
        while (ticket >= SHARES[ray_class])
        {
            ticket -= SHARES[ray_class++];
        }
        pick_instance(&maker);
        set.classes[i] = ray_class;
        set.rays[i] = MAKERS[ray_class](&maker);
    }
    return set;
}

void ls_ray_set_destroy(LsRaySet* set)
{
    free(set->rays);
    free(set->classes);
    *set = (LsRaySet){.rays = NULL};
}
