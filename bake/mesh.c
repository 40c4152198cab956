// mesh.c - checks an input mesh, welds it, finds its faults, and keeps the triangles that have an
// area.

#include "mesh.h"

#include "weld.h"

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
                return ls_error_set(error, LS_MESSAGE_MESH_NOT_FINITE,
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
            error, LS_MESSAGE_MESH_FAR,
            "%s: coordinates reach %g but the mesh is only %g long, which leaves float no shape; "
            "move the mesh to its origin and place it by a node translation",
            name, largest, extent);
    }
    if (extent < 1e-9 || extent > 1e12)
    {
        return ls_error_set(
            error, LS_MESSAGE_MESH_EXTENT,
            "%s: the mesh is %g long; extents from 1e-9 to 1e12 are supported, scale it by a node",
            name, extent);
    }
    return LS_OK;
}

// ---- Faces without area -------------------------------------------------------------------------

static double squared_length(LsVec3 a, LsVec3 b)
{
    double x = (double)b.x - a.x, y = (double)b.y - a.y, z = (double)b.z - a.z;
    return x * x + y * y + z * z;
}

// Of three corners on a line the one between the others moves to the nearer. With two corners
// alike, two of the triangle test's U, V, W are each other's opposite and the third is 0, to the
// last bit; three different corners leave rounding something to hit.
static void collapse(LsTriangle* triangle)
{
    LsVec3* corners[3] = {&triangle->v0, &triangle->v1, &triangle->v2};
    double opposite[3];
    int middle = 0;
    for (int k = 0; k < 3; k++)
    {
        opposite[k] = squared_length(*corners[(k + 1) % 3], *corners[(k + 2) % 3]);
        middle = opposite[k] > opposite[middle] ? k : middle;
    }
    int next = (middle + 1) % 3, last = (middle + 2) % 3;
    *corners[middle] = opposite[last] <= opposite[next] ? *corners[next] : *corners[last];
}

// ---- The stage ----------------------------------------------------------------------------------

// What is known of a mesh while its stage lasts.
typedef struct Work
{
    LsInputMesh* source;
    const char* name; // of the file
    uint32_t* corners;
    uint8_t* flat;
    uint32_t vertex_count; // welded
} Work;

static LsResult report_memory(const Work* work, LsError* error)
{
    return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY,
                        "%s: out of memory for a mesh of %u triangles", work->name,
                        work->source->triangle_count);
}

static LsResult weld_corners(Work* work, bool no_weld, LsError* error)
{
    const LsInputMesh* source = work->source;
    uint64_t corner_count = 3ull * source->triangle_count;
    work->corners = malloc((corner_count + 1) * sizeof *work->corners);
    if (work->corners == NULL)
    {
        return report_memory(work, error);
    }
    work->vertex_count = source->vertex_count;
    if (no_weld)
    {
        memcpy(work->corners, source->indices, corner_count * sizeof *work->corners);
        return LS_OK;
    }
    uint32_t* ids = malloc((source->vertex_count + 1ull) * sizeof *ids);
    bool ok =
        ids != NULL && ls_weld(source->positions, source->vertex_count, ids, &work->vertex_count);
    for (uint64_t c = 0; c < corner_count && ok; c++)
    {
        work->corners[c] = ids[source->indices[c]];
    }
    free(ids);
    return ok ? LS_OK : report_memory(work, error);
}

static LsResult find_flat_faces(Work* work, LsError* error)
{
    const LsInputMesh* source = work->source;
    work->flat = malloc(source->triangle_count + 1ull);
    if (work->flat == NULL)
    {
        return report_memory(work, error);
    }
    for (uint32_t i = 0; i < source->triangle_count; i++)
    {
        const uint32_t* v = source->indices + 3 * (size_t)i;
        work->flat[i] = !has_area(read_position(source, v[0]), read_position(source, v[1]),
                                  read_position(source, v[2]));
    }
    return LS_OK;
}

static LsResult find_faults(const Work* work, uint32_t threads, LsMeshFindings* findings,
                            LsError* error)
{
    const LsInputMesh* source = work->source;
    const LsFaces faces = {.corners = work->corners,
                           .indices = source->indices,
                           .flat = work->flat,
                           .face_count = source->triangle_count,
                           .vertex_count = work->vertex_count};
    findings->report.input_vertex_count = source->vertex_count;
    findings->report.vertex_count = work->vertex_count;
    findings->report.face_count = source->triangle_count;
    return ls_topology_check(&faces, threads, &findings->report, &findings->examples)
               ? LS_OK
               : report_memory(work, error);
}

static LsResult copy_triangles(LsMesh* mesh, const Work* work, bool keep_degenerate, LsError* error)
{
    const LsInputMesh* source = work->source;
    uint32_t count = source->triangle_count;
    for (uint32_t i = 0; i < count; i++)
    {
        mesh->degenerate_count += work->flat[i];
    }
    bool keep = keep_degenerate && mesh->degenerate_count < count;
    uint32_t kept = keep ? count : count - mesh->degenerate_count;
    if (kept == 0)
    {
        return LS_OK;
    }
    mesh->triangles = malloc(sizeof(LsTriangle) * (size_t)kept);
    if (mesh->triangles == NULL)
    {
        return report_memory(work, error);
    }
    for (int axis = 0; axis < 3; axis++)
    {
        mesh->lower[axis] = INFINITY;
        mesh->upper[axis] = -INFINITY;
    }
    for (uint32_t i = 0; i < count; i++)
    {
        if (work->flat[i] && !keep)
        {
            continue;
        }
        const uint32_t* corner = source->indices + 3 * (size_t)i;
        LsTriangle triangle = {.v0 = read_position(source, corner[0]),
                               .v1 = read_position(source, corner[1]),
                               .v2 = read_position(source, corner[2]),
                               .primitive = i,
                               .material = source->materials[i]};
        if (work->flat[i])
        {
            collapse(&triangle);
        }
        grow_bounds(mesh, triangle.v0);
        grow_bounds(mesh, triangle.v1);
        grow_bounds(mesh, triangle.v2);
        mesh->triangles[mesh->triangle_count++] = triangle;
    }
    return check_range(mesh, work->name, error);
}

LsResult ls_mesh_create(LsMesh* mesh, LsInput* input, uint32_t index, const LsBakeDesc* desc,
                        uint32_t threads, const LsStageProgress* progress, LsMeshFindings* findings,
                        LsError* error)
{
    Work work = {.source = &input->meshes[index]};
    work.name = input->paths[work.source->input_index];
    *mesh = (LsMesh){.face_count = work.source->triangle_count};
    *findings = (LsMeshFindings){0};
    if (mesh->face_count > LS_MAX_FACES)
    {
        return ls_error_set(error, LS_MESSAGE_LIMIT_RECORDS,
                            "%s: a mesh of %u triangles; an object has %u at most, split it",
                            work.name, mesh->face_count, LS_MAX_FACES);
    }
    // The shares of the time are those of a scanned model (the Stanford dragon).
    LsResult result = check_vertices(work.source, work.name, error);
    result = result == LS_OK ? weld_corners(&work, desc->no_weld, error) : result;
    ls_stage_note(progress, 0.3);
    result = result == LS_OK ? find_flat_faces(&work, error) : result;
    ls_stage_note(progress, 0.4);
    result = result == LS_OK ? find_faults(&work, threads, findings, error) : result;
    ls_stage_note(progress, 0.8);
    // Vertices that stay apart and faces without area are not compared there.
    mesh->may_have_copies =
        findings->report.duplicate_count > 0 || desc->no_weld || desc->keep_degenerate;
    result = result == LS_OK ? copy_triangles(mesh, &work, desc->keep_degenerate, error) : result;
    ls_stage_note(progress, 0.9);
    if (result == LS_OK)
    {
        const LsLooksSource source = {.corners = work.corners,
                                      .flat = work.flat,
                                      .vertex_count = work.vertex_count,
                                      .threads = threads};
        result = ls_looks_create(&mesh->looks, input, index, desc, &source, error);
    }
    free(work.corners);
    free(work.flat);
    if (result != LS_OK)
    {
        ls_mesh_destroy(mesh);
    }
    return result;
}

void ls_mesh_destroy(LsMesh* mesh)
{
    free(mesh->triangles);
    ls_looks_destroy(&mesh->looks);
    *mesh = (LsMesh){0};
}
