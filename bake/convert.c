// convert.c - up, scale and flip of all that has a place or a direction.

#include "convert.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

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
    ls_rows_load(rows, matrix);
    convert_matrix(conversion, matrix, from_left);
    ls_rows_store(matrix, rows);
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

LsResult ls_input_convert(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                          LsError* error)
{
    LsResult result = LS_OK;
    if (how->up != LS_UP_Y || (how->scale > 0.0 && how->scale != 1.0))
        result = convert_part(input, part, how, error);
    for (uint32_t i = part->first_mesh; how->flip && i < input->mesh_count; i++)
        flip_mesh(&input->meshes[i]);
    return result;
}
