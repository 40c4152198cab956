// normals.c - G. Thürmer, C. Wüthrich, "Computing Vertex Normals from Polygonal Facets", JGT 3(1),
// 1998: weights by angle do not depend on how a surface is cut into triangles.

#include "normals.h"

#include "ls_layout.h"
#include "octahedral.h"

#include <math.h>
#include <stdlib.h>

static void read_edge(const float* positions, uint32_t from, uint32_t to, double edge[3])
{
    for (int axis = 0; axis < 3; axis++)
    {
        edge[axis] = (double)positions[3 * (size_t)to + axis] - positions[3 * (size_t)from + axis];
    }
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
    {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        out[axis] = a[u] * b[v] - a[v] * b[u];
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void ls_face_normal(const float* positions, const uint32_t indices[3], double normal[3])
{
    double a[3], b[3];
    read_edge(positions, indices[0], indices[1], a);
    read_edge(positions, indices[0], indices[2], b);
    cross(a, b, normal);
    // The largest first: squares of what 1e-38 long edges give leave the range of double.
    double largest = fmax(fabs(normal[0]), fmax(fabs(normal[1]), fabs(normal[2])));
    for (int axis = 0; axis < 3; axis++)
    {
        normal[axis] /= largest;
    }
    double length = sqrt(dot(normal, normal));
    for (int axis = 0; axis < 3; axis++)
    {
        normal[axis] /= length;
    }
}

static double corner_angle(const LsSmoothFaces* faces, uint32_t face, uint32_t corner)
{
    const uint32_t* v = faces->indices + 3 * (size_t)face;
    double a[3], b[3], n[3];
    read_edge(faces->positions, v[corner], v[(corner + 1) % 3], a);
    read_edge(faces->positions, v[corner], v[(corner + 2) % 3], b);
    cross(a, b, n);
    return atan2(sqrt(dot(n, n)), dot(a, b));
}

// Lists the corners of each vertex, in the order of faces: first[v] .. first[v + 1].
static void list_corners(const LsSmoothFaces* faces, uint64_t* first, uint64_t* corners)
{
    for (uint64_t c = 0; c < 3ull * faces->face_count; c++)
    {
        first[faces->corners[c] + 2ull] += !faces->flat[c / 3];
    }
    for (uint64_t v = 2; v < faces->vertex_count + 2ull; v++)
    {
        first[v] += first[v - 1];
    }
    for (uint64_t c = 0; c < 3ull * faces->face_count; c++)
    {
        if (!faces->flat[c / 3])
        {
            corners[first[faces->corners[c] + 1ull]++] = c;
        }
    }
}

// The word of a corner of `face` from all those at its vertex.
static uint32_t smooth_corner(const double (*normals)[3], const uint64_t* around,
                              const double* angles, uint64_t count, uint32_t face, double least)
{
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint64_t i = 0; i < count; i++)
    {
        uint32_t other = (uint32_t)(around[i] / 3);
        if (other != face && dot(normals[face], normals[other]) < least)
        {
            continue;
        }
        for (int axis = 0; axis < 3; axis++)
        {
            sum[axis] += angles[i] * normals[other][axis];
        }
    }
    return sum[0] != 0.0 || sum[1] != 0.0 || sum[2] != 0.0 ? ls_octahedral_encode(sum) : LS_NONE;
}

static void smooth_vertex(const LsSmoothFaces* faces, const double (*normals)[3],
                          const uint64_t* around, uint64_t count, double least, uint32_t* words)
{
    double angles[LS_SMOOTH_FACES];
    for (uint64_t i = 0; i < count && count <= LS_SMOOTH_FACES; i++)
    {
        angles[i] = corner_angle(faces, (uint32_t)(around[i] / 3), (uint32_t)(around[i] % 3));
    }
    for (uint64_t i = 0; i < count; i++)
    {
        uint32_t face = (uint32_t)(around[i] / 3);
        words[around[i]] = count <= LS_SMOOTH_FACES
                               ? smooth_corner(normals, around, angles, count, face, least)
                               : ls_octahedral_encode(normals[face]);
    }
}

bool ls_normals_smooth(const LsSmoothFaces* faces, double degrees, uint32_t threads,
                       uint32_t* words)
{
    uint64_t corner_count = 3ull * faces->face_count;
    double(*normals)[3] = malloc((faces->face_count + 1ull) * sizeof *normals);
    uint64_t* first = calloc(faces->vertex_count + 2ull, sizeof *first);
    uint64_t* corners = malloc((corner_count + 1) * sizeof *corners);
    bool ok = normals != NULL && first != NULL && corners != NULL;
    if (ok)
    {
        list_corners(faces, first, corners);
        // Rounding must not part faces that differ by just the angle.
        double least = cos(degrees * (3.14159265358979323846 / 180.0)) - 1e-9;
#pragma omp parallel num_threads(threads)
        {
#pragma omp for schedule(static)
            for (uint32_t face = 0; face < faces->face_count; face++)
            {
                for (int k = 0; k < 3; k++)
                {
                    words[3 * (size_t)face + k] = LS_NONE;
                }
                if (!faces->flat[face])
                {
                    ls_face_normal(faces->positions, faces->indices + 3 * (size_t)face,
                                   normals[face]);
                }
            }
#pragma omp for schedule(dynamic, 1024)
            for (uint32_t v = 0; v < faces->vertex_count; v++)
            {
                smooth_vertex(faces, (const double(*)[3])normals, corners + first[v],
                              first[v + 1] - first[v], least, words);
            }
        }
    }
    free(normals);
    free(first);
    free(corners);
    return ok;
}
