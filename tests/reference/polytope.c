#include "polytope.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static void add_plane(LsPolytope* body, const double normal[3], double offset)
{
    assert(body->plane_count < LS_POLYTOPE_MAX_PLANES);
    double* plane = body->planes[body->plane_count++];
    plane[0] = normal[0];
    plane[1] = normal[1];
    plane[2] = normal[2];
    plane[3] = offset;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LsPolytope ls_polytope_box(const LsBox* box, double grow)
{
    LsPolytope body = {.plane_count = 0};
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double normal[3] = {0.0, 0.0, 0.0};
        normal[axis] = 1.0;
        add_plane(&body, normal, box->upper[axis] + grow);
        normal[axis] = -1.0;
        add_plane(&body, normal, -(box->lower[axis] - grow));
    }
    return body;
}

static bool has_plane(const LsPolytope* body, const double normal[3], double offset)
{
    for (uint32_t i = 0; i < body->plane_count; i++)
    {
        const double* plane = body->planes[i];
        double difference = fabs(plane[0] - normal[0]) + fabs(plane[1] - normal[1]) +
                            fabs(plane[2] - normal[2]) + fabs(plane[3] - offset);
        if (difference < 1e-12)
        {
            return true;
        }
    }
    return false;
}

// The unit normal of the plane through three points; false where they are too close to a line.
static bool span_plane(const double* p, const double* q, const double* r, double normal[3])
{
    double e1[3], e2[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        e1[axis] = q[axis] - p[axis];
        e2[axis] = r[axis] - p[axis];
    }
    normal[0] = e1[1] * e2[2] - e1[2] * e2[1];
    normal[1] = e1[2] * e2[0] - e1[0] * e2[2];
    normal[2] = e1[0] * e2[1] - e1[1] * e2[0];
    double length = sqrt(dot(normal, normal));
    if (length < 1e-14)
    {
        return false;
    }
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        normal[axis] /= length;
    }
    return true;
}

LsPolytope ls_polytope_hull(const LsBox* a, const LsBox* b)
{
    double points[16][3];
    for (uint32_t i = 0; i < 16; i++)
    {
        const LsBox* box = i < 8 ? a : b;
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            points[i][axis] = i >> axis & 1u ? box->upper[axis] : box->lower[axis];
        }
    }

    LsPolytope body = {.plane_count = 0};
    for (uint32_t i = 0; i < 16; i++)
    {
        for (uint32_t j = i + 1; j < 16; j++)
        {
            for (uint32_t k = j + 1; k < 16; k++)
            {
                double normal[3];
                if (!span_plane(points[i], points[j], points[k], normal))
                {
                    continue;
                }
                double offset = dot(normal, points[i]);
                bool below = true, above = true;
                for (uint32_t p = 0; p < 16; p++)
                {
                    double distance = dot(normal, points[p]) - offset;
                    below = below && distance < 1e-13;
                    above = above && distance > -1e-13;
                }
                if (above && !below)
                {
                    normal[0] = -normal[0];
                    normal[1] = -normal[1];
                    normal[2] = -normal[2];
                    offset = -offset;
                }
                if (above != below && !has_plane(&body, normal, offset))
                {
                    add_plane(&body, normal, offset);
                }
            }
        }
    }
    return body;
}

LsShaftEnds ls_polytope_shaft_ends(uint32_t shaft, uint32_t patches)
{
    uint32_t square = patches * patches;
    uint32_t patch_b = shaft % square;
    uint32_t patch_a = shaft / square % square;
    uint32_t pair = shaft / (square * square);
    uint32_t index = 0;
    for (uint32_t face_a = 0; face_a < 6; face_a++)
    {
        for (uint32_t face_b = face_a + 1; face_b < 6; face_b++)
        {
            if (index++ == pair)
            {
                return (LsShaftEnds){
                    .face = {face_a, face_b},
                    .i = {patch_a / patches, patch_b / patches},
                    .j = {patch_a % patches, patch_b % patches},
                };
            }
        }
    }
    assert(false);
    return (LsShaftEnds){.face = {0, 0}};
}

LsPolytope ls_polytope_shaft(uint32_t shaft, uint32_t patches, double bound)
{
    LsShaftEnds ends = ls_polytope_shaft_ends(shaft, patches);
    LsBox boxes[2];
    for (uint32_t end = 0; end < 2; end++)
    {
        uint32_t axis = ends.face[end] / 2;
        uint32_t axis_i = (axis + 1) % 3;
        uint32_t axis_j = (axis + 2) % 3;
        double side = ends.face[end] % 2;
        boxes[end].lower[axis] = side - bound;
        boxes[end].upper[axis] = side + bound;
        boxes[end].lower[axis_i] = (double)ends.i[end] / patches - bound;
        boxes[end].upper[axis_i] = (double)(ends.i[end] + 1) / patches + bound;
        boxes[end].lower[axis_j] = (double)ends.j[end] / patches - bound;
        boxes[end].upper[axis_j] = (double)(ends.j[end] + 1) / patches + bound;
    }
    return ls_polytope_hull(&boxes[0], &boxes[1]);
}

// Sutherland and Hodgman's clipping, each plane moved inwards by `shrink`.
static uint32_t clip_polygon(const LsPolytope* body, double shrink, const double corners[3][3],
                             double out[LS_POLYTOPE_MAX_CORNERS][3])
{
    double buffer[LS_POLYTOPE_MAX_CORNERS][3];
    uint32_t count = 3;
    memcpy(out, corners, 9 * sizeof(double));
    for (uint32_t p = 0; p < body->plane_count && count > 0; p++)
    {
        const double* plane = body->planes[p];
        double offset = plane[3] - shrink;
        uint32_t kept = 0;
        for (uint32_t i = 0; i < count; i++)
        {
            const double* from = out[i];
            const double* to = out[(i + 1) % count];
            double d_from = dot(plane, from) - offset;
            double d_to = dot(plane, to) - offset;
            if (d_from <= 0.0)
            {
                memcpy(buffer[kept++], from, sizeof buffer[0]);
            }
            if ((d_from < 0.0 && d_to > 0.0) || (d_from > 0.0 && d_to < 0.0))
            {
                double where = d_from / (d_from - d_to);
                for (uint32_t axis = 0; axis < 3; axis++)
                {
                    buffer[kept][axis] = from[axis] + where * (to[axis] - from[axis]);
                }
                kept++;
            }
        }
        count = kept;
        memcpy(out, buffer, count * sizeof buffer[0]);
    }
    return count;
}

uint32_t ls_polytope_clip(const LsPolytope* body, const double corners[3][3],
                          double out[LS_POLYTOPE_MAX_CORNERS][3])
{
    return clip_polygon(body, 0.0, corners, out);
}

bool ls_polytope_meets(const LsPolytope* body, const double corners[3][3])
{
    double out[LS_POLYTOPE_MAX_CORNERS][3];
    return clip_polygon(body, LS_POLYTOPE_SLACK, corners, out) > 0;
}
