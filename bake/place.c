// place.c - size, turn and at in a node above the file's own.

#include "place.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

// ---- Bounding box -------------------------------------------------------------------------------

typedef struct Box
{
    double lower[3], upper[3];
} Box;

static const Box NO_BOX = {.lower = {INFINITY, INFINITY, INFINITY},
                           .upper = {-INFINITY, -INFINITY, -INFINITY}};

// Points that are not finite are left to the mesh stage, which names them.
static void grow_box(Box* box, const double p[3])
{
    if (!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
        return;
    for (int i = 0; i < 3; i++)
    {
        box->lower[i] = fmin(box->lower[i], p[i]);
        box->upper[i] = fmax(box->upper[i], p[i]);
    }
}

static bool is_within(const Box* inner, const Box* outer)
{
    for (int i = 0; i < 3; i++)
        if (inner->lower[i] < outer->lower[i] || inner->upper[i] > outer->upper[i])
            return false;
    return true;
}

static void transform(const double matrix[3][4], const double p[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = ((matrix[i][0] * p[0] + matrix[i][1] * p[1]) + matrix[i][2] * p[2]) + matrix[i][3];
}

// Of the vertices that triangles use; in object space where `matrix` is NULL.
static Box find_mesh_box(const LsInputMesh* mesh, const double matrix[3][4])
{
    Box box = NO_BOX;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
    {
        const float* position = mesh->positions + 3 * (size_t)mesh->indices[i];
        double p[3] = {position[0], position[1], position[2]};
        if (matrix)
            transform(matrix, (const double[]){p[0], p[1], p[2]}, p);
        grow_box(&box, p);
    }
    return box;
}

// The box around a transformed box: larger than that of what is in it.
static Box transform_box(const Box* box, const double matrix[3][4])
{
    Box grown = NO_BOX;
    for (int corner = 0; corner < 8; corner++)
    {
        double p[3];
        for (int i = 0; i < 3; i++)
            p[i] = corner >> i & 1 ? box->upper[i] : box->lower[i];
        double moved[3];
        transform(matrix, p, moved);
        grow_box(&grown, moved);
    }
    return grown;
}

// World space, grown by the triangles of all instances. An instance whose transformed box lies
// within what is there already is not looked at more closely: thousands of instances stay cheap.
static LsResult find_part_box(const LsInput* input, const LsInputPart* part, Box* box,
                              LsError* error)
{
    const uint32_t mesh_count = input->mesh_count - part->first_mesh;
    Box* objects = malloc((mesh_count + 1ull) * sizeof *objects);
    if (!objects)
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for %u boxes",
                            mesh_count);
    for (uint32_t i = 0; i < mesh_count; i++)
        objects[i] = find_mesh_box(&input->meshes[part->first_mesh + i], NULL);
    for (uint32_t i = part->first_instance; i < input->instance_count; i++)
    {
        const LsInputInstance* instance = &input->instances[i];
        const Box* object = &objects[instance->mesh - part->first_mesh];
        const Box rough = transform_box(object, instance->world_from_object);
        if (is_within(&rough, box))
            continue;
        const Box exact =
            find_mesh_box(&input->meshes[instance->mesh], instance->world_from_object);
        grow_box(box, exact.lower);
        grow_box(box, exact.upper);
    }
    free(objects);
    return LS_OK;
}

// ---- Placement ----------------------------------------------------------------------------------

// Sine and cosine by their series, of the same bits from every C library, since they reach the
// file; exact for quarters.
static void find_turn(double degrees, double* sine, double* cosine)
{
    const double rest = fmod(degrees, 360.0);
    const double quarters = round(rest / 90.0);
    const double angle = (rest - 90.0 * quarters) * (3.14159265358979323846 / 180.0);
    const double square = angle * angle;
    double s = 1.0, c = 1.0;
    for (int k = 20; k > 0; k -= 2)
    {
        s = 1.0 - square * s / (k * (k + 1));
        c = 1.0 - square * c / (k * (k - 1));
    }
    s *= angle;
    const double sines[4] = {s, c, 0.0 - s, 0.0 - c};
    const unsigned quarter = (unsigned)((int)quarters + 4) % 4;
    *sine = sines[quarter];
    *cosine = sines[(quarter + 1) % 4];
}

// Scaled and turned about the middle of the box's bottom, which goes to `at`, or stays.
static void find_placement(const Box* box, const LsBakeInput* how, double scale, double root[3][4])
{
    const double anchor[3] = {0.5 * (box->lower[0] + box->upper[0]), box->lower[1],
                              0.5 * (box->lower[2] + box->upper[2])};
    const double* at = how->is_at ? how->at : anchor;
    double sine, cosine;
    find_turn(how->turn, &sine, &cosine);
    const double linear[3][3] = {{cosine, 0.0, sine}, {0.0, 1.0, 0.0}, {0.0 - sine, 0.0, cosine}};
    for (int i = 0; i < 3; i++)
    {
        for (int j = 0; j < 3; j++)
            root[i][j] = scale * linear[i][j];
        root[i][3] =
            at[i] - ((root[i][0] * anchor[0] + root[i][1] * anchor[1]) + root[i][2] * anchor[2]);
    }
}

static void multiply(const double a[3][4], double b[3][4])
{
    double product[3][4];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            product[i][j] = ((a[i][0] * b[0][j] + a[i][1] * b[1][j]) + a[i][2] * b[2][j]) +
                            (j == 3 ? a[i][3] : 0.0);
    memcpy(b, product, sizeof product);
}

// Whether no node of the part has LS_MAX_NODE_DEPTH - 1 nodes above it.
static bool has_level_left(const LsInput* input, const LsInputPart* part)
{
    for (uint32_t i = part->first_node; i < input->node_count; i++)
    {
        uint32_t levels = 1;
        for (uint32_t node = i; input->nodes[node].parent != LS_NONE && levels < LS_MAX_NODE_DEPTH;
             levels++)
            node = input->nodes[node].parent;
        if (levels == LS_MAX_NODE_DEPTH)
            return false;
    }
    return true;
}

static void move_link(uint32_t* node, uint32_t root, bool is_top)
{
    if (*node != LS_NONE)
        *node += 1;
    else if (is_top)
        *node = root;
}

// A node before the part's own; parents stay before children.
static LsResult insert_root(LsInput* input, const LsInputPart* part, const double matrix[3][4],
                            LsError* error)
{
    const uint32_t root = part->first_node;
    if (!ls_input_add_node(input))
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for a node");
    LsSceneNode* nodes = input->nodes + root;
    memmove(nodes + 1, nodes, (input->node_count - 1 - root) * sizeof *nodes);
    nodes[0] = (LsSceneNode){.parent = LS_NONE};
    ls_rows_store(matrix, nodes[0].parent_from_node);
    for (uint32_t i = root + 1; i < input->node_count; i++)
        move_link(&input->nodes[i].parent, root, true);
    for (uint32_t i = part->first_instance; i < input->instance_count; i++)
        move_link(&input->instances[i].node, root, true);
    for (uint32_t i = part->first_lamp; i < input->lamp_count; i++)
        move_link(&input->lamps[i].node, root, true);
    for (uint32_t i = part->first_channel; i < input->channel_count; i++)
        move_link(&input->channels[i].node, root, false);
    return LS_OK;
}

static void move_camera(LsCamera* camera, const double root[3][4], double scale)
{
    double matrix[3][4];
    ls_rows_load(camera->world_from_camera, matrix);
    multiply(root, matrix);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[i][j] /= scale;
    ls_rows_store(matrix, camera->world_from_camera);
}

static void move_lamp(LsLamp* lamp, const double root[3][4], double scale)
{
    double p[3];
    if (lamp->kind != LS_LAMP_DIRECTIONAL)
    {
        transform(root, (const double[]){lamp->position.x, lamp->position.y, lamp->position.z}, p);
        lamp->position = (LsVec3){(float)p[0], (float)p[1], (float)p[2]};
    }
    if (lamp->kind != LS_LAMP_POINT)
    {
        const LsVec3 d = lamp->direction;
        for (int i = 0; i < 3; i++)
            p[i] = ((root[i][0] * d.x + root[i][1] * d.y) + root[i][2] * d.z) / scale;
        lamp->direction = (LsVec3){(float)p[0], (float)p[1], (float)p[2]};
    }
    lamp->range = (float)(scale * lamp->range);
}

static bool is_storable(const LsInput* input, const LsInputPart* part, const double root[3][4])
{
    bool is_good = true;
    for (int i = 0; i < 12; i++)
        is_good = is_good && fabs(root[i / 4][i % 4]) <= FLT_MAX;
    for (uint32_t i = part->first_camera; i < input->camera_count; i++)
        for (int k = 0; k < 3; k++)
            is_good = is_good && isfinite(input->cameras[i].world_from_camera[k].w);
    for (uint32_t i = part->first_lamp; i < input->lamp_count; i++)
    {
        const LsLamp* lamp = &input->lamps[i];
        is_good = is_good && isfinite(lamp->position.x) && isfinite(lamp->position.y) &&
                  isfinite(lamp->position.z) && isfinite(lamp->range);
    }
    return is_good;
}

static LsResult place_part(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                           LsError* error)
{
    Box box = NO_BOX;
    LsResult result = find_part_box(input, part, &box, error);
    if (result != LS_OK)
        return result;
    if (!(box.lower[0] <= box.upper[0]))
        return ls_error_set(error, LS_MESSAGE_PLACE_NO_BOX,
                            "%s: has no triangle, so there is no box to place by --size, --turn or "
                            "--at; leave them out",
                            how->path);
    const double longest = fmax(fmax(box.upper[0] - box.lower[0], box.upper[1] - box.lower[1]),
                                box.upper[2] - box.lower[2]);
    if (how->size > 0.0 && !(longest > 0.0))
        return ls_error_set(
            error, LS_MESSAGE_PLACE_NO_BOX,
            "%s: all its triangles lie in a point, which --size cannot make larger; "
            "leave it out",
            how->path);
    if (!has_level_left(input, part))
        return ls_error_set(
            error, LS_MESSAGE_PLACE_DEPTH,
            "%s: its nodes have %d levels already, which leaves none for the node of "
            "--size, --turn and --at; flatten the hierarchy",
            how->path, LS_MAX_NODE_DEPTH);
    const double scale = how->size > 0.0 ? how->size / longest : 1.0;
    double root[3][4];
    find_placement(&box, how, scale, root);
    result = insert_root(input, part, root, error);
    if (result != LS_OK)
        return result;
    for (uint32_t i = part->first_instance; i < input->instance_count; i++)
        multiply(root, input->instances[i].world_from_object);
    for (uint32_t i = part->first_camera; i < input->camera_count; i++)
        move_camera(&input->cameras[i], root, scale);
    for (uint32_t i = part->first_lamp; i < input->lamp_count; i++)
        move_lamp(&input->lamps[i], root, scale);
    if (!is_storable(input, part, root))
        return ls_error_set(error, LS_MESSAGE_PLACE_RANGE,
                            "%s: placed, it leaves the range of float; choose another --size or "
                            "--at",
                            how->path);
    return LS_OK;
}

LsResult ls_input_place(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                        LsError* error)
{
    const LsResult result = ls_input_convert(input, part, how, error);
    if (result == LS_OK && (how->size > 0.0 || how->turn != 0.0 || how->is_at))
        return place_part(input, part, how, error);
    return result;
}
