#include "box_scene.h"

#include "ls_write.h"

#include <math.h>
#include <string.h>

enum
{
    WHITE,
    RED,
    GREEN,
    LAMP,  // emits from its front
    GLOW,  // emits 1 from its front, reflects half
    PAPER, // reflects all
    MATERIAL_COUNT
};

static const LsMaterial MATERIALS[MATERIAL_COUNT] = {
    [WHITE] = {.base_color = {0.75f, 0.75f, 0.75f}, .roughness = 1.0f},
    [RED] = {.base_color = {0.65f, 0.06f, 0.05f}, .roughness = 1.0f},
    [GREEN] = {.base_color = {0.12f, 0.48f, 0.1f}, .roughness = 1.0f},
    [LAMP] = {.base_color = {0.5f, 0.5f, 0.5f},
              .emission = {17.0f, 12.0f, 4.0f},
              .flags = LS_MATERIAL_EMISSIVE,
              .roughness = 1.0f},
    [GLOW] = {.base_color = {0.5f, 0.5f, 0.5f},
              .emission = {1.0f, 1.0f, 1.0f},
              .flags = LS_MATERIAL_EMISSIVE,
              .roughness = 1.0f},
    [PAPER] = {.base_color = {1.0f, 1.0f, 1.0f}, .roughness = 1.0f},
};

typedef struct Scene
{
    float scale;
    LsObject objects[2];
    uint32_t object_count;
    LsTriangle triangles[64];
    uint32_t triangle_count;
    LsInstance instances[2];
    LsBvhNode top_nodes[3];
    LsLight lights[64];
    uint32_t light_count;
    LsCamera camera;
} Scene;

static void grow(float lower[3], float upper[3], LsVec3 p)
{
    const float c[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; i++)
    {
        lower[i] = fminf(lower[i], c[i]);
        upper[i] = fmaxf(upper[i], c[i]);
    }
}

static void add_triangle(Scene* scene, LsVec3 a, LsVec3 b, LsVec3 c, uint32_t material)
{
    LsObject* object = &scene->objects[scene->object_count - 1];
    scene->triangles[scene->triangle_count++] = (LsTriangle){
        .v0 = a, .v1 = b, .v2 = c, .primitive = object->triangle_count++, .material = material};
    object->face_count++;
}

// Corners counter-clockwise seen from the front.
static void add_quad(Scene* scene, const float p[4][3], uint32_t material)
{
    LsVec3 v[4];
    for (int i = 0; i < 4; i++)
    {
        v[i] = (LsVec3){p[i][0] * scene->scale, p[i][1] * scene->scale, p[i][2] * scene->scale};
    }
    add_triangle(scene, v[0], v[1], v[2], material);
    add_triangle(scene, v[0], v[2], v[3], material);
}

// A face of a box with axis = face / 2 at the lower (even) or upper (odd) coordinate, its front
// inside or outside.
static void add_face(Scene* scene, const float lower[3], const float upper[3], int face,
                     int outside, uint32_t material)
{
    int axis = face / 2;
    int i = (axis + 1) % 3;
    int j = (axis + 2) % 3;
    int reversed = (face % 2) != outside;
    float p[4][3];
    for (int k = 0; k < 4; k++)
    {
        int turn = reversed ? 3 - k : k;
        p[k][axis] = face % 2 ? upper[axis] : lower[axis];
        p[k][i] = turn == 1 || turn == 2 ? upper[i] : lower[i];
        p[k][j] = turn >= 2 ? upper[j] : lower[j];
    }
    add_quad(scene, p, material);
}

static void begin_object(Scene* scene)
{
    scene->objects[scene->object_count++] =
        (LsObject){.kind = LS_OBJECT_LIST, .first_triangle = scene->triangle_count};
}

static void add_room(Scene* scene)
{
    const float lower[3] = {-1.0f, -1.0f, -1.0f};
    const float upper[3] = {1.0f, 1.0f, 1.0f};
    add_face(scene, lower, upper, 0, 0, RED);
    add_face(scene, lower, upper, 1, 0, GREEN);
    add_face(scene, lower, upper, 2, 0, WHITE);
    add_face(scene, lower, upper, 3, 0, WHITE);
    add_face(scene, lower, upper, 4, 0, WHITE);
    const float lamp_lower[3] = {-0.25f, 0.99f, -0.25f};
    const float lamp_upper[3] = {0.25f, 0.99f, 0.25f};
    add_face(scene, lamp_lower, lamp_upper, 3, 0, LAMP);
}

static void add_block(Scene* scene, const float lower[3], const float upper[3])
{
    for (int face = 0; face < 6; face++)
    {
        add_face(scene, lower, upper, face, 1, WHITE);
    }
}

static void set_camera(Scene* scene, float x, float y, float z, float tan_half_y)
{
    scene->camera = (LsCamera){
        .world_from_camera = {{1.0f, 0.0f, 0.0f, x * scene->scale},
                              {0.0f, 1.0f, 0.0f, y * scene->scale},
                              {0.0f, 0.0f, 1.0f, z * scene->scale}},
        .tan_half_y = tan_half_y,
    };
}

static LsInstance identity_instance(uint32_t object)
{
    return (LsInstance){
        .object_from_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
        .world_from_object = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
        .object = object,
        .node = LS_NONE,
        .mask = 255,
        .flags = LS_INSTANCE_IDENTITY,
    };
}

// Turned by 0.4 about y, stretched by (1, 1.5, 0.7), mirrored in x, moved onto the floor of the
// room.
static LsInstance turned_instance(uint32_t object, float scale)
{
    LsInstance instance = {
        .object = object, .node = LS_NONE, .mask = 255, .flags = LS_INSTANCE_MIRRORED};
    const double stretch[3] = {-1.0, 1.5, 0.7};
    const double turn[3][3] = {
        {cos(0.4), 0.0, sin(0.4)}, {0.0, 1.0, 0.0}, {-sin(0.4), 0.0, cos(0.4)}};
    const double move[3] = {0.2 * scale, -1.0 * scale, 0.1 * scale};
    double forward[3][4];
    double inverse[3][4];
    for (int i = 0; i < 3; i++)
    {
        inverse[i][3] = 0.0;
        for (int j = 0; j < 3; j++)
        {
            forward[i][j] = turn[i][j] * stretch[j];
            inverse[i][j] = turn[j][i] / stretch[i];
            inverse[i][3] -= inverse[i][j] * move[j];
        }
        forward[i][3] = move[i];
    }
    for (int i = 0; i < 3; i++)
    {
        instance.world_from_object[i] = (LsVec4){(float)forward[i][0], (float)forward[i][1],
                                                 (float)forward[i][2], (float)forward[i][3]};
        instance.object_from_world[i] = (LsVec4){(float)inverse[i][0], (float)inverse[i][1],
                                                 (float)inverse[i][2], (float)inverse[i][3]};
    }
    return instance;
}

static LsVec3 transform_point(const LsVec4 rows[3], LsVec3 p)
{
    float r[3];
    for (int i = 0; i < 3; i++)
    {
        r[i] = rows[i].x * p.x + rows[i].y * p.y + rows[i].z * p.z + rows[i].w;
    }
    return (LsVec3){r[0], r[1], r[2]};
}

static void finish_objects(Scene* scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++)
    {
        LsObject* object = &scene->objects[i];
        float lower[3] = {INFINITY, INFINITY, INFINITY};
        float upper[3] = {-INFINITY, -INFINITY, -INFINITY};
        for (uint32_t k = 0; k < object->triangle_count; k++)
        {
            const LsTriangle* triangle = &scene->triangles[object->first_triangle + k];
            grow(lower, upper, triangle->v0);
            grow(lower, upper, triangle->v1);
            grow(lower, upper, triangle->v2);
        }
        object->lower = (LsVec3){lower[0], lower[1], lower[2]};
        object->upper = (LsVec3){upper[0], upper[1], upper[2]};
        float side = fmaxf(fmaxf(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
        object->reach = 2.0f * side;
    }
}

static void add_lights(Scene* scene)
{
    double areas[64];
    double power = 0.0;
    const LsObject* object = &scene->objects[0];
    for (uint32_t k = 0; k < object->triangle_count; k++)
    {
        const LsTriangle* t = &scene->triangles[object->first_triangle + k];
        const LsMaterial* material = &MATERIALS[t->material];
        if (material->flags & LS_MATERIAL_EMISSIVE)
        {
            double b[3] = {(double)t->v1.x - t->v0.x, (double)t->v1.y - t->v0.y,
                           (double)t->v1.z - t->v0.z};
            double c[3] = {(double)t->v2.x - t->v0.x, (double)t->v2.y - t->v0.y,
                           (double)t->v2.z - t->v0.z};
            double area =
                0.5 * sqrt(pow(b[1] * c[2] - b[2] * c[1], 2) + pow(b[2] * c[0] - b[0] * c[2], 2) +
                           pow(b[0] * c[1] - b[1] * c[0], 2));
            LsVec3 e = material->emission;
            areas[scene->light_count] = area * (0.2126 * e.x + 0.7152 * e.y + 0.0722 * e.z);
            power += areas[scene->light_count];
            scene->lights[scene->light_count++] = (LsLight){.triangle = k, .area = (float)area};
        }
    }
    double sum = 0.0;
    for (uint32_t i = 0; i < scene->light_count; i++)
    {
        sum += areas[i];
        scene->lights[i].cumulative = i + 1 == scene->light_count ? 1.0f : (float)(sum / power);
    }
}

// A root and a leaf for each instance, with boxes a little too large.
static void build_top(Scene* scene, float lower[3], float upper[3])
{
    float pad = 1e-5f * scene->scale;
    for (uint32_t i = 0; i < scene->object_count; i++)
    {
        float low[3] = {INFINITY, INFINITY, INFINITY};
        float high[3] = {-INFINITY, -INFINITY, -INFINITY};
        const LsObject* object = &scene->objects[scene->instances[i].object];
        for (uint32_t k = 0; k < object->triangle_count; k++)
        {
            const LsTriangle* t = &scene->triangles[object->first_triangle + k];
            const LsVec4* rows = scene->instances[i].world_from_object;
            grow(low, high, transform_point(rows, t->v0));
            grow(low, high, transform_point(rows, t->v1));
            grow(low, high, transform_point(rows, t->v2));
        }
        scene->top_nodes[1 + i] = (LsBvhNode){
            .lower = {low[0] - pad, low[1] - pad, low[2] - pad},
            .upper = {high[0] + pad, high[1] + pad, high[2] + pad},
            .escape = 2 + i,
            .leaf = i << 4 | 1,
        };
        grow(lower, upper, scene->top_nodes[1 + i].lower);
        grow(lower, upper, scene->top_nodes[1 + i].upper);
    }
    scene->top_nodes[0] = (LsBvhNode){
        .lower = {lower[0], lower[1], lower[2]},
        .upper = {upper[0], upper[1], upper[2]},
        .escape = 1 + scene->object_count,
    };
}

static void build_scene(LsBoxScene kind, Scene* scene)
{
    const float room_lower[3] = {-1.0f, -1.0f, -1.0f};
    const float room_upper[3] = {1.0f, 1.0f, 1.0f};
    const float block_lower[3] = {-0.5f, -1.0f, -0.6f};
    const float block_upper[3] = {0.1f, -0.2f, 0.0f};
    const float unit_lower[3] = {-0.3f, 0.0f, -0.3f};
    const float unit_upper[3] = {0.3f, 0.6f, 0.3f};
    const float floor_lower[3] = {-4.0f, 0.0f, -4.0f};
    const float floor_upper[3] = {4.0f, 0.0f, 4.0f};
    const float lamp_lower[3] = {-0.5f, 1.0f, -0.25f};
    const float lamp_upper[3] = {0.5f, 1.0f, 0.25f};

    begin_object(scene);
    scene->instances[0] = identity_instance(0);
    set_camera(scene, 0.0f, 0.0f, 3.2f, 0.38f);
    switch (kind)
    {
    case LS_BOX_CORNELL:
        add_room(scene);
        add_block(scene, block_lower, block_upper);
        break;
    case LS_BOX_INSTANCES:
        add_room(scene);
        begin_object(scene);
        add_block(scene, unit_lower, unit_upper);
        scene->instances[1] = turned_instance(1, scene->scale);
        break;
    case LS_BOX_OPEN:
        add_face(scene, room_lower, room_upper, 2, 0, WHITE);
        add_block(scene, block_lower, block_upper);
        break;
    case LS_BOX_FURNACE:
        for (int face = 0; face < 6; face++)
        {
            add_face(scene, room_lower, room_upper, face, 0, GLOW);
        }
        set_camera(scene, 0.0f, 0.0f, 0.0f, 1.0f);
        break;
    case LS_BOX_RECTANGLE:
        add_face(scene, floor_lower, floor_upper, 2, 0, PAPER);
        add_face(scene, lamp_lower, lamp_upper, 3, 0, GLOW);
        set_camera(scene, 0.0f, 0.5f, 0.0f, 1e-4f);
        scene->camera.world_from_camera[1].y = 0.0f; // turned to look down
        scene->camera.world_from_camera[1].z = 1.0f;
        scene->camera.world_from_camera[2].y = -1.0f;
        scene->camera.world_from_camera[2].z = 0.0f;
        break;
    }
    finish_objects(scene);
    add_lights(scene);
}

LsResult ls_box_scene_write(LsBoxScene kind, float scale, const char* path, LsError* error)
{
    Scene scene = {.scale = scale};
    build_scene(kind, &scene);
    LsFileDesc desc = {
        .lower = {INFINITY, INFINITY, INFINITY},
        .upper = {-INFINITY, -INFINITY, -INFINITY},
        .objects = scene.objects,
        .OBJECTS_count = scene.object_count,
        .instances = scene.instances,
        .INSTANCES_count = scene.object_count,
        .materials = MATERIALS,
        .MATERIALS_count = MATERIAL_COUNT,
        .triangles = scene.triangles,
        .TRIANGLES_count = scene.triangle_count,
        .lights = scene.lights,
        .LIGHTS_count = scene.light_count,
        .cameras = &scene.camera,
        .CAMERAS_count = kind != LS_BOX_OPEN,
    };
    build_top(&scene, desc.lower, desc.upper);
    if (scene.object_count > 1)
    {
        desc.top_nodes = scene.top_nodes;
        desc.TOP_NODES_count = 1 + scene.object_count;
        desc.transform_bound = 1e-6f;
    }
    return ls_file_write(&desc, path, error);
}
