#include "box_rays.h"

#include <math.h>
#include <stdlib.h>

#define CAMERA_Z 3.2f
#define TAN_HALF_Y 0.38
#define OFFSET 1e-4f // along the normal, and tmin
#define LIGHT_HALF 0.25
#define LIGHT_Y 0.989

static const double PI = 3.14159265358979323846;

const char* ls_ray_class_name(LsRayClass class)
{
    static const char* const names[LS_RAY_CLASS_COUNT] = {"camera", "shadow", "diffuse"};
    return names[class];
}

void ls_box_camera_rays(LsRay* rays, uint32_t width, uint32_t height)
{
    const double step = 2.0 * TAN_HALF_Y / height;
    for (uint32_t y = 0; y < height; y++)
    {
        for (uint32_t x = 0; x < width; x++)
        {
            const double dx = (x + 0.5 - 0.5 * width) * step;
            const double dy = (0.5 * height - y - 0.5) * step;
            const double length = sqrt(dx * dx + dy * dy + 1.0);
            rays[(size_t)y * width + x] = (LsRay){
                .origin = {0.0f, 0.0f, CAMERA_Z},
                .direction = {(float)(dx / length), (float)(dy / length), (float)(-1.0 / length)},
                .tmax = INFINITY,
            };
        }
    }
}

// pcg4d (M. Jarzynski, M. Olano, JCGT 9(3), 2020) of the ray's number: four numbers in [0,1).
static void draw_numbers(uint32_t number, uint32_t dimension, double numbers[4])
{
    uint32_t v[4] = {number, dimension, 0, 0};
    for (int i = 0; i < 4; i++)
    {
        v[i] = v[i] * 1664525u + 1013904223u;
    }
    for (int round = 0; round < 2; round++)
    {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
        for (int i = 0; i < 4 && round == 0; i++)
        {
            v[i] ^= v[i] >> 16;
        }
    }
    for (int i = 0; i < 4; i++)
    {
        numbers[i] = (v[i] >> 8) * 0x1p-24;
    }
}

typedef struct Start
{
    double origin[3];
    double normal[3]; // unit
} Start;

static void carry_point(const LsInstance* instance, LsVec3 p, double out[3])
{
    for (int i = 0; i < 3; i++)
    {
        const LsVec4* row = &instance->world_from_object[i];
        out[i] = (double)row->x * p.x + (double)row->y * p.y + (double)row->z * p.z + row->w;
    }
}

// The triangle of each face of each object: grids reorder them.
typedef struct Faces
{
    const LsFile* file;
    uint32_t** triangles; // per object, face_count indices into its part of TRIANGLES
} Faces;

static void destroy_faces(Faces* faces)
{
    for (uint32_t i = 0;
         faces->triangles != NULL && i < ls_file_count(faces->file, LS_CHUNK_OBJECTS); i++)
    {
        free(faces->triangles[i]);
    }
    free(faces->triangles);
    *faces = (Faces){0};
}

// False when out of memory; destroy_faces is due either way.
static bool create_faces(Faces* faces, const LsFile* file)
{
    const uint32_t count = ls_file_count(file, LS_CHUNK_OBJECTS);
    *faces = (Faces){.file = file, .triangles = calloc(count, sizeof(uint32_t*))};
    for (uint32_t i = 0; faces->triangles != NULL && i < count; i++)
    {
        const LsObject* object = &file->objects[i];
        faces->triangles[i] = calloc((size_t)object->face_count + 1, sizeof(uint32_t));
        if (faces->triangles[i] == NULL)
        {
            return false;
        }
        for (uint32_t k = 0; k < object->triangle_count; k++)
        {
            faces->triangles[i][file->triangles[object->first_triangle + k].primitive] = k;
        }
    }
    return faces->triangles != NULL;
}

static const LsTriangle* find_triangle(const Faces* faces, const LsHit* hit)
{
    const LsObject* object = &faces->file->objects[hit->object];
    return &faces->file
                ->triangles[object->first_triangle + faces->triangles[hit->object][hit->primitive]];
}

static Start start_at_hit(const Faces* faces, const LsRay* ray, const LsHit* hit)
{
    const LsInstance* instance = &faces->file->instances[hit->instance];
    const LsTriangle* triangle = find_triangle(faces, hit);
    double a[3], b[3], c[3];
    carry_point(instance, triangle->v0, a);
    carry_point(instance, triangle->v1, b);
    carry_point(instance, triangle->v2, c);
    Start start;
    for (int i = 0; i < 3; i++)
    {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        start.normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    }
    const double* n = start.normal;
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const double facing =
        n[0] * ray->direction.x + n[1] * ray->direction.y + n[2] * ray->direction.z;
    const double scale = (facing > 0.0 ? -1.0 : 1.0) / length;
    const float origin[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const float direction[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    for (int i = 0; i < 3; i++)
    {
        start.normal[i] *= scale;
        start.origin[i] =
            origin[i] + (double)hit->t * direction[i] + (double)OFFSET * start.normal[i];
    }
    return start;
}

static Start start_anywhere(const double random[4])
{
    return (Start){.origin = {0.5 * random[0], -1.0 + 0.5 * random[1], 0.5 * random[2]},
                   .normal = {0.0, 0.0, 1.0}};
}

static LsRay make_ray(const double origin[3], const double direction[3], float tmax)
{
    return (LsRay){
        .origin = {(float)origin[0], (float)origin[1], (float)origin[2]},
        .tmin = OFFSET,
        .direction = {(float)direction[0], (float)direction[1], (float)direction[2]},
        .tmax = tmax,
    };
}

static LsRay make_shadow_ray(const Start* start, const double random[4])
{
    const double target[3] = {LIGHT_HALF * (2.0 * random[0] - 1.0), LIGHT_Y,
                              LIGHT_HALF * (2.0 * random[1] - 1.0)};
    double way[3];
    double square = 0.0;
    for (int i = 0; i < 3; i++)
    {
        way[i] = target[i] - start->origin[i];
        square += way[i] * way[i];
    }
    const double distance = sqrt(square);
    for (int i = 0; i < 3; i++)
    {
        way[i] /= distance;
    }
    return make_ray(start->origin, way, (float)distance);
}

static LsRay make_diffuse_ray(const Start* start, const double random[4])
{
    // Frame of T. Duff et al., JCGT 6(1), 2017.
    const double* n = start->normal;
    const double sign = n[2] < 0.0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + n[2]);
    const double b = n[0] * n[1] * a;
    const double u[3] = {1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]};
    const double v[3] = {b, sign + n[1] * n[1] * a, -n[1]};
    const double radius = sqrt(random[2]);
    const double x = radius * cos(2.0 * PI * random[3]);
    const double y = radius * sin(2.0 * PI * random[3]);
    const double z = sqrt(1.0 - random[2]);
    double direction[3];
    for (int i = 0; i < 3; i++)
    {
        direction[i] = x * u[i] + y * v[i] + z * n[i];
    }
    return make_ray(start->origin, direction, INFINITY);
}

bool ls_box_second_rays(const LsFile* file, const LsRay* camera, const LsHit* hits, uint32_t count,
                        LsRay* shadow, LsRay* diffuse)
{
    Faces faces;
    const bool is_memory = create_faces(&faces, file);
    for (uint32_t i = 0; is_memory && i < count; i++)
    {
        double random[4], place[4];
        draw_numbers(i, 0, random);
        draw_numbers(i, 1, place);
        const Start start = hits[i].instance != LS_NONE ? start_at_hit(&faces, &camera[i], &hits[i])
                                                        : start_anywhere(place);
        shadow[i] = make_shadow_ray(&start, random);
        diffuse[i] = make_diffuse_ray(&start, random);
    }
    destroy_faces(&faces);
    return is_memory;
}
