// place.c - up, scale and flip in the vertices themselves; size, turn and at in a node above.

#include "place.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

LsInputPart ls_input_part(const LsInput* input)
{
    return (LsInputPart){
        .first_mesh = input->mesh_count,
        .first_instance = input->instance_count,
        .first_node = input->node_count,
        .first_material = input->material_count,
        .first_camera = input->camera_count,
        .first_lamp = input->lamp_count,
        .first_channel = input->channel_count,
        .first_key = input->key_count,
        .first_warning = input->warning_count,
    };
}

// ---- Conversion ---------------------------------------------------------------------------------

// x' = scale * P x with P a permutation of the axes with signs, a rotation. A matrix that leads
// from one converted space into another becomes P R P^T with the translation scale * P t.
typedef struct Conversion
{
    int axis[3];    // component i of P x is component axis[i] of x ...
    double sign[3]; // ... times this
    double scale;
    bool has_left_range;
} Conversion;

static Conversion make_conversion(const LsBakeInput* how)
{
    Conversion conversion = {.axis = {0, 1, 2}, .sign = {1.0, 1.0, 1.0}};
    if (how->up == LS_UP_Z)
        conversion = (Conversion){.axis = {0, 2, 1}, .sign = {1.0, 1.0, -1.0}};
    if (how->up == LS_UP_X)
        conversion = (Conversion){.axis = {1, 0, 2}, .sign = {-1.0, 1.0, 1.0}};
    conversion.scale = how->scale > 0.0 ? how->scale : 1.0;
    return conversion;
}

// Without making negative zeros of zeros.
static double with_sign(double sign, double x)
{
    return sign < 0.0 ? 0.0 - x : x;
}

static double scale_number(Conversion* conversion, double x)
{
    const double scaled = conversion->scale * x;
    conversion->has_left_range =
        conversion->has_left_range || (fabs(x) <= FLT_MAX && !(fabs(scaled) <= FLT_MAX));
    return scaled;
}

static void turn_vector(const Conversion* conversion, const double in[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = with_sign(conversion->sign[i], in[conversion->axis[i]]);
}

// Of `count` vectors of three floats.
static void turn_vectors(const Conversion* conversion, float* vectors, size_t count, double sign)
{
    for (size_t i = 0; i < count; i++)
    {
        float* v = vectors + 3 * i;
        double turned[3];
        turn_vector(conversion, (const double[]){v[0], v[1], v[2]}, turned);
        for (int k = 0; k < 3; k++)
            v[k] = (float)with_sign(sign, turned[k]);
    }
}

static void convert_points(Conversion* conversion, float* points, size_t count)
{
    turn_vectors(conversion, points, count, 1.0);
    if (conversion->scale != 1.0)
        for (size_t i = 0; i < 3 * count; i++)
            points[i] = (float)scale_number(conversion, points[i]);
}

static LsVec3 convert_vec3(Conversion* conversion, LsVec3 v, bool is_point)
{
    float numbers[3] = {v.x, v.y, v.z};
    if (is_point)
        convert_points(conversion, numbers, 1);
    else
        turn_vectors(conversion, numbers, 1, 1.0);
    return (LsVec3){numbers[0], numbers[1], numbers[2]};
}

static void load_rows(const LsVec4 rows[3], double matrix[3][4])
{
    for (int i = 0; i < 3; i++)
        memcpy(matrix[i], (const double[]){rows[i].x, rows[i].y, rows[i].z, rows[i].w},
               sizeof matrix[i]);
}

static void store_rows(const double matrix[3][4], LsVec4 rows[3])
{
    for (int i = 0; i < 3; i++)
        rows[i] = (LsVec4){(float)matrix[i][0], (float)matrix[i][1], (float)matrix[i][2],
                           (float)matrix[i][3]};
}

// From the left only when `from_left`: the space that the matrix leads from keeps its axes.
static void convert_matrix(Conversion* conversion, double matrix[3][4], bool from_left)
{
    double old[3][4];
    memcpy(old, matrix, sizeof old);
    for (int i = 0; i < 3; i++)
    {
        const double* row = old[conversion->axis[i]];
        const double sign = conversion->sign[i];
        for (int j = 0; j < 3; j++)
            matrix[i][j] = from_left
                               ? with_sign(sign, row[j])
                               : with_sign(sign * conversion->sign[j], row[conversion->axis[j]]);
        matrix[i][3] = scale_number(conversion, with_sign(sign, row[3]));
    }
}

static void convert_rows(Conversion* conversion, LsVec4 rows[3], bool from_left)
{
    double matrix[3][4];
    load_rows(rows, matrix);
    convert_matrix(conversion, matrix, from_left);
    store_rows(matrix, rows);
}

// Of the values of a channel. A rotation about an axis becomes one about the turned axis.
static void convert_values(Conversion* conversion, uint32_t path, float* values, size_t count)
{
    const size_t size = path == LS_PATH_ROTATION ? 4 : 3;
    for (size_t i = 0; i < count; i += size)
    {
        if (path == LS_PATH_TRANSLATION)
            convert_points(conversion, values + i, 1);
        if (path == LS_PATH_ROTATION)
            turn_vectors(conversion, values + i, 1, 1.0);
        if (path == LS_PATH_SCALE)
        {
            const float old[3] = {values[i], values[i + 1], values[i + 2]};
            for (int k = 0; k < 3; k++)
                values[i + (size_t)k] = old[conversion->axis[k]];
        }
    }
}

static uint32_t count_values(const LsChannel* channel)
{
    return channel->key_count * (channel->path == LS_PATH_ROTATION ? 4 : 3) *
           (channel->interpolation == LS_INTERPOLATION_CUBIC ? 3 : 1);
}

// Channels may share keys. Those of one path are converted together, once; where two paths share
// some, the second gets keys of its own.
static LsResult convert_channels(LsInput* input, const LsInputPart* part, Conversion* conversion,
                                 LsError* error)
{
    const size_t key_count = input->key_count - part->first_key;
    if (input->channel_count == part->first_channel || key_count == 0)
        return LS_OK;
    float* old = malloc(key_count * sizeof *old);
    uint8_t* done = calloc(key_count, 1); // 1 + path that a key was converted for, or 0
    LsResult result = old && done
                          ? LS_OK
                          : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                         "out of memory for %zu keys of an animation", key_count);
    if (result == LS_OK)
        memcpy(old, input->keys + part->first_key, key_count * sizeof *old);
    for (uint32_t i = part->first_channel; i < input->channel_count && result == LS_OK; i++)
    {
        LsChannel* channel = &input->channels[i];
        const uint32_t count = count_values(channel);
        const uint32_t first = channel->first_value - part->first_key;
        const uint8_t mark = (uint8_t)(1 + channel->path);
        uint32_t fresh = 0, shared = 0;
        for (uint32_t k = 0; k < count; k++)
        {
            fresh += done[first + k] == 0;
            shared += done[first + k] == mark;
        }
        if (shared == count)
            continue;
        float* values = input->keys + channel->first_value;
        if (fresh == count)
            memset(done + first, mark, count);
        else if ((values = ls_input_add_keys(input, count)) != NULL)
        {
            memcpy(values, old + first, count * sizeof *values);
            channel->first_value = (uint32_t)(values - input->keys);
        }
        else
            result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                                  "out of memory for %u keys of an animation", count);
        if (values)
            convert_values(conversion, channel->path, values, count);
    }
    free(old);
    free(done);
    return result;
}

static void convert_lamp(Conversion* conversion, LsLamp* lamp)
{
    if (lamp->kind != LS_LAMP_DIRECTIONAL)
        lamp->position = convert_vec3(conversion, lamp->position, true);
    if (lamp->kind != LS_LAMP_POINT)
        lamp->direction = convert_vec3(conversion, lamp->direction, false);
    lamp->range = (float)scale_number(conversion, lamp->range);
}

static LsResult convert_part(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                             LsError* error)
{
    Conversion conversion = make_conversion(how);
    for (uint32_t i = part->first_mesh; i < input->mesh_count; i++)
    {
        convert_points(&conversion, input->meshes[i].positions, input->meshes[i].vertex_count);
        const LsInputStream* normals = &input->meshes[i].streams[LS_STREAM_NORMAL];
        if (normals->values)
            turn_vectors(&conversion, normals->values, normals->count, 1.0);
    }
    for (uint32_t i = part->first_node; i < input->node_count; i++)
        convert_rows(&conversion, input->nodes[i].parent_from_node, false);
    for (uint32_t i = part->first_instance; i < input->instance_count; i++)
        convert_matrix(&conversion, input->instances[i].world_from_object, false);
    for (uint32_t i = part->first_camera; i < input->camera_count; i++)
        convert_rows(&conversion, input->cameras[i].world_from_camera, true);
    for (uint32_t i = part->first_lamp; i < input->lamp_count; i++)
        convert_lamp(&conversion, &input->lamps[i]);
    const LsResult result = convert_channels(input, part, &conversion, error);
    if (result == LS_OK && conversion.has_left_range)
        return ls_error_set(error, LS_MESSAGE_PLACE_RANGE,
                            "%s: scaled by %g, it leaves the range of float; choose another scale",
                            how->path, conversion.scale);
    return result;
}

// ---- Flip ---------------------------------------------------------------------------------------

static void flip_corners(uint32_t* indices, uint32_t triangle_count)
{
    for (size_t i = 0; indices && i < triangle_count; i++)
    {
        const uint32_t second = indices[3 * i + 1];
        indices[3 * i + 1] = indices[3 * i + 2];
        indices[3 * i + 2] = second;
    }
}

// Streams of the positions' indices turn with them.
static void flip_mesh(LsInputMesh* mesh)
{
    const Conversion none = {.axis = {0, 1, 2}, .sign = {1.0, 1.0, 1.0}, .scale = 1.0};
    flip_corners(mesh->indices, mesh->triangle_count);
    for (int kind = 0; kind < LS_STREAM_COUNT; kind++)
        flip_corners(mesh->streams[kind].indices, mesh->triangle_count);
    const LsInputStream* normals = &mesh->streams[LS_STREAM_NORMAL];
    if (normals->values)
        turn_vectors(&none, normals->values, normals->count, -1.0);
}

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

// World space, grown by the triangles of all instances. An instance whose transformed box lies within
// what is there already is not looked at more closely: thousands of instances stay cheap.
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
    store_rows(matrix, nodes[0].parent_from_node);
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
    load_rows(camera->world_from_camera, matrix);
    multiply(root, matrix);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[i][j] /= scale;
    store_rows(matrix, camera->world_from_camera);
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
    LsResult result = LS_OK;
    if (how->up != LS_UP_Y || (how->scale > 0.0 && how->scale != 1.0))
        result = convert_part(input, part, how, error);
    for (uint32_t i = part->first_mesh; how->flip && i < input->mesh_count; i++)
        flip_mesh(&input->meshes[i]);
    if (result == LS_OK && (how->size > 0.0 || how->turn != 0.0 || how->is_at))
        result = place_part(input, part, how, error);
    return result;
}
