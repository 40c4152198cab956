// mesh.c - checks an input mesh and keeps the triangles that have an area.

#include "mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static LsResult check_vertices(const LsInputMesh* input, const char* name, LsError* error)
{
    for (uint32_t v = 0; v < input->vertex_count; v++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            float value = input->positions[3 * (size_t)v + axis];
            if (!isfinite(value))
            {
                return ls_error_set(error, LS_ERROR_INPUT_NOT_FINITE,
                                    "%s: vertex %u has a coordinate that is %s; repair the mesh",
                                    name, v, isnan(value) ? "NaN" : "infinite");
            }
        }
    }
    return LS_OK;
}

static LsVec3 read_position(const LsInputMesh* input, uint32_t vertex)
{
    const float* p = input->positions + 3 * (size_t)vertex;
    return (LsVec3){p[0], p[1], p[2]};
}

// Whether a triangle has an area, by the cross product in double: exact for all but extreme shapes.
static bool has_area(LsVec3 a, LsVec3 b, LsVec3 c)
{
    double ux = (double)b.x - a.x, uy = (double)b.y - a.y, uz = (double)b.z - a.z;
    double vx = (double)c.x - a.x, vy = (double)c.y - a.y, vz = (double)c.z - a.z;
    return uy * vz - uz * vy != 0.0 || uz * vx - ux * vz != 0.0 || ux * vy - uy * vx != 0.0;
}

static void grow_bounds(LsMesh* mesh, LsVec3 p)
{
    const float q[3] = {p.x, p.y, p.z};
    for (int axis = 0; axis < 3; axis++)
    {
        mesh->lower[axis] = q[axis] < mesh->lower[axis] ? q[axis] : mesh->lower[axis];
        mesh->upper[axis] = q[axis] > mesh->upper[axis] ? q[axis] : mesh->upper[axis];
    }
}

static LsResult check_range(const LsMesh* mesh, const char* name, LsError* error)
{
    double extent = 0.0;
    double largest = 0.0;
    for (int axis = 0; axis < 3; axis++)
    {
        extent = fmax(extent, (double)mesh->upper[axis] - mesh->lower[axis]);
        largest = fmax(largest, fmax(fabs(mesh->lower[axis]), fabs(mesh->upper[axis])));
    }
    if (largest > extent * 1048576.0)
    {
        return ls_error_set(
            error, LS_ERROR_INPUT_RANGE,
            "%s: coordinates reach %g but the mesh is only %g long, which leaves float no shape; "
            "move the mesh to its origin and place it by a node translation",
            name, largest, extent);
    }
    if (extent < 1e-9 || extent > 1e12)
    {
        return ls_error_set(
            error, LS_ERROR_INPUT_RANGE,
            "%s: the mesh is %g long; extents from 1e-9 to 1e12 are supported, scale it by a node",
            name, extent);
    }
    return LS_OK;
}

LsResult ls_mesh_create(LsMesh* mesh, const LsInputMesh* input, const char* name, LsError* error)
{
    *mesh = (LsMesh){.face_count = input->triangle_count};
    LsResult result = check_vertices(input, name, error);
    if (result != LS_OK || input->triangle_count == 0)
    {
        return result;
    }
    mesh->triangles = malloc(sizeof(LsTriangle) * (size_t)input->triangle_count);
    if (mesh->triangles == NULL)
    {
        return ls_error_set(error, LS_ERROR_MEMORY, "%s: out of memory for %u triangles", name,
                            input->triangle_count);
    }
    for (int axis = 0; axis < 3; axis++)
    {
        mesh->lower[axis] = INFINITY;
        mesh->upper[axis] = -INFINITY;
    }
    for (uint32_t i = 0; i < input->triangle_count; i++)
    {
        const uint32_t* corner = input->indices + 3 * (size_t)i;
        LsTriangle triangle = {.v0 = read_position(input, corner[0]),
                               .v1 = read_position(input, corner[1]),
                               .v2 = read_position(input, corner[2]),
                               .primitive = i,
                               .material = input->materials[i]};
        if (!has_area(triangle.v0, triangle.v1, triangle.v2))
        {
            mesh->degenerate_count++;
            continue;
        }
        grow_bounds(mesh, triangle.v0);
        grow_bounds(mesh, triangle.v1);
        grow_bounds(mesh, triangle.v2);
        mesh->triangles[mesh->triangle_count++] = triangle;
    }
    if (mesh->triangle_count == 0)
    {
        memset(mesh->lower, 0, sizeof mesh->lower);
        memset(mesh->upper, 0, sizeof mesh->upper);
        return LS_OK;
    }
    return check_range(mesh, name, error);
}

void ls_mesh_destroy(LsMesh* mesh)
{
    free(mesh->triangles);
    *mesh = (LsMesh){0};
}
