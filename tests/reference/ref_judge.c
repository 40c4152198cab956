#include "ref_judge.h"

#include "ref_layout.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define U (1.0 / 16777216.0)

const char* ls_verdict_text(LsVerdict verdict)
{
    static const char* const texts[] = {
#define LS_VERDICT_TEXT(name, text) text,
        LS_VERDICT_LIST(LS_VERDICT_TEXT)
#undef LS_VERDICT_TEXT
    };
    return texts[verdict];
}

const char* ls_exception_text(LsException exception)
{
    static const char* const texts[] = {
#define LS_EXCEPTION_TEXT(name, text) text,
        LS_EXCEPTION_LIST(LS_EXCEPTION_TEXT)
#undef LS_EXCEPTION_TEXT
    };
    return texts[exception];
}

// ---- Triangles in double, with margins ----------------------------------------------------------

// A ray in double from its carried origin, with a frame across it: two unit vectors at right angles
// to it.
typedef struct LsWideRay
{
    double origin[3], direction[3];
    double length; // of direction
    double across[2][3];
    double smin, smax;
    double moved; // largest length of a moved origin's coordinates, to which moving rounds; or 0
    int exponent;
} LsWideRay;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static LsWideRay widen_ray(const LsObject* object, const LsObjectRay* ray, const LsRay* world)
{
    LsWideRay wide = {.smin = ldexp(world->tmin, ray->exponent),
                      .smax = ldexp(fmin(world->tmax, FLT_MAX), ray->exponent),
                      .exponent = ray->exponent};
    uint32_t smallest = 0;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        wide.origin[axis] = ray->carried[axis];
        wide.direction[axis] = ray->direction[axis];
        smallest = fabsf(ray->direction[axis]) < fabsf(ray->direction[smallest]) ? axis : smallest;
    }
    wide.length = sqrt(dot(wide.direction, wide.direction));
    if (ray->far)
    {
        // Wherever in the box a device moves the origin to.
        const LsVec3 l = object->lower, u = object->upper;
        const double farthest[3] = {fmax(fabs(l.x), fabs(u.x)), fmax(fabs(l.y), fabs(u.y)),
                                    fmax(fabs(l.z), fabs(u.z))};
        wide.moved = sqrt(dot(farthest, farthest));
    }
    double axis_vector[3] = {smallest == 0, smallest == 1, smallest == 2};
    cross(wide.direction, axis_vector, wide.across[0]);
    double scale = 1.0 / sqrt(dot(wide.across[0], wide.across[0]));
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        wide.across[0][axis] *= scale;
    }
    cross(wide.direction, wide.across[0], wide.across[1]);
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        wide.across[1][axis] /= wide.length;
    }
    return wide;
}

// Distance of the origin of the plane from the segment p q, and from its line.
static void measure_edge(const double p[2], const double q[2], double* segment, double* line)
{
    double e[2] = {q[0] - p[0], q[1] - p[1]};
    double squared = e[0] * e[0] + e[1] * e[1];
    double along = squared > 0.0 ? -(p[0] * e[0] + p[1] * e[1]) / squared : 0.0;
    double clamped = fmin(fmax(along, 0.0), 1.0);
    *segment = hypot(p[0] + clamped * e[0], p[1] + clamped * e[1]);
    *line = squared > 0.0 ? fabs(p[0] * q[1] - p[1] * q[0]) / sqrt(squared) : *segment;
}

typedef struct LsCandidate
{
    LsReferenceMargin margin;
    double farthest_line; // of the three edge lines from the ray's line
    double s, s_bound;
    uint32_t instance, primitive;
    bool possible; // some device may return it
    bool certain;  // no device may overlook it
} LsCandidate;

// Measures a triangle, or says that the ray's line stays more than 16 u L away from it.
static bool measure_triangle(const LsReferenceObject* object, uint32_t slot, const LsWideRay* ray,
                             bool keep_far, LsCandidate* out)
{
    double corners[3][3], flat[3][2];
    double farthest = 0.0;
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            corners[corner][axis] = object->corners[corner][axis][slot] - ray->origin[axis];
        }
        flat[corner][0] = dot(corners[corner], ray->across[0]);
        flat[corner][1] = dot(corners[corner], ray->across[1]);
        farthest = fmax(farthest, dot(corners[corner], corners[corner]));
    }
    double reach = fmax(sqrt(farthest), ray->moved);
    double bound = 16.0 * U * reach;
    for (uint32_t axis = 0; axis < 2 && !keep_far; axis++)
    {
        double lowest = fmin(fmin(flat[0][axis], flat[1][axis]), flat[2][axis]);
        double highest = fmax(fmax(flat[0][axis], flat[1][axis]), flat[2][axis]);
        if (lowest > bound || highest < -bound)
        {
            return false;
        }
    }

    double distance = INFINITY;
    out->farthest_line = 0.0;
    int below = 0, above = 0;
    for (uint32_t corner = 0; corner < 3; corner++)
    {
        const double* p = flat[corner];
        const double* q = flat[(corner + 1) % 3];
        double segment, line;
        measure_edge(p, q, &segment, &line);
        distance = fmin(distance, segment);
        out->farthest_line = fmax(out->farthest_line, line);
        double side = p[0] * q[1] - p[1] * q[0];
        below |= side < 0.0;
        above |= side > 0.0;
    }
    bool inside = !(below && above) && (below || above);
    if (!keep_far && !inside && distance > bound)
    {
        return false;
    }

    double e1[3], e2[3], n[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        e1[axis] = corners[1][axis] - corners[0][axis];
        e2[axis] = corners[2][axis] - corners[0][axis];
    }
    cross(e1, e2, n);
    double n_length = sqrt(dot(n, n));
    double n_d = dot(n, ray->direction);
    out->s = dot(n, corners[0]) / n_d;
    out->s_bound = n_d != 0.0 ? 16.0 * U * (fabs(out->s) + reach * n_length / fabs(n_d)) : INFINITY;
    out->margin = (LsReferenceMargin){
        .t = ldexp(out->s, -ray->exponent),
        .t_bound = ldexp(out->s_bound, -ray->exponent),
        .edge_distance = distance,
        .edge_bound = bound,
        .cosine = n_length > 0.0 ? fabs(n_d) / (n_length * ray->length) : 0.0,
        .inside = inside,
    };
    bool flat_on = isfinite(out->s_bound);
    out->possible =
        n_length > 0.0 && (inside || distance <= bound) &&
        (!flat_on || (out->s + out->s_bound > ray->smin && out->s - out->s_bound < ray->smax));
    out->certain = inside && flat_on && distance > bound && out->s - out->s_bound > ray->smin &&
                   out->s + out->s_bound < ray->smax;
    return true;
}

typedef struct LsCandidates
{
    LsCandidate* items;
    uint32_t count, capacity;
} LsCandidates;

static void add_candidate(LsCandidates* list, const LsCandidate* candidate)
{
    if (list->count == list->capacity)
    {
        list->capacity = list->capacity ? 2 * list->capacity : 64;
        list->items = realloc(list->items, list->capacity * sizeof(LsCandidate));
        if (!list->items)
        {
            abort();
        }
    }
    list->items[list->count++] = *candidate;
}

// Whether the ray's line can pass a triangle of the cluster closer than 16 u L.
static bool line_meets_sphere(const LsWideRay* ray, const LsReferenceSphere* sphere)
{
    double to_center[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        to_center[axis] = sphere->center[axis] - ray->origin[axis];
    }
    double x = dot(to_center, ray->across[0]);
    double y = dot(to_center, ray->across[1]);
    double distance = sqrt(dot(to_center, to_center));
    double reach = sphere->radius + 17.0 * U * fmax(distance + sphere->radius, ray->moved);
    return sphere->radius >= 0.0 && x * x + y * y <= reach * reach;
}

static void gather_candidates(const LsReference* reference, const LsRay* world, uint32_t mask,
                              bool all, LsCandidates* list)
{
    const LsFile* file = reference->file;
    list->count = 0;
    for (uint32_t instance = 0; instance < ls_file_count(file, LS_CHUNK_INSTANCES); instance++)
    {
        uint32_t object_index = file->instances[instance].object;
        const LsReferenceObject* object = &reference->objects[object_index];
        const LsTriangle* triangles = file->triangles + file->objects[object_index].first_triangle;
        LsObjectRay carried;
        if (!ls_reference_carry(reference, instance, world, mask, &carried))
        {
            continue;
        }
        LsWideRay ray = widen_ray(&file->objects[object_index], &carried, world);
        for (uint32_t first = 0; first < object->slot_count; first += CLUSTER)
        {
            if (!all && !line_meets_sphere(&ray, &object->spheres[first / CLUSTER]))
            {
                continue;
            }
            for (uint32_t slot = first; slot < first + CLUSTER; slot++)
            {
                LsCandidate candidate = {.instance = instance};
                if (object->triangles[slot] != LS_NONE &&
                    measure_triangle(object, slot, &ray, false, &candidate) && candidate.possible)
                {
                    candidate.primitive = triangles[object->triangles[slot]].primitive;
                    add_candidate(list, &candidate);
                }
            }
        }
    }
}

static bool measure_hit(const LsReference* reference, const LsRay* world, uint32_t mask,
                        uint32_t instance, uint32_t primitive, LsCandidate* out)
{
    const LsFile* file = reference->file;
    if (instance >= ls_file_count(file, LS_CHUNK_INSTANCES))
    {
        return false;
    }
    uint32_t object_index = file->instances[instance].object;
    const LsReferenceObject* object = &reference->objects[object_index];
    LsObjectRay carried;
    if (primitive >= file->objects[object_index].face_count ||
        object->slot_of_primitive[primitive] == LS_NONE ||
        !ls_reference_carry(reference, instance, world, mask, &carried))
    {
        return false;
    }
    LsWideRay ray = widen_ray(&file->objects[object_index], &carried, world);
    *out = (LsCandidate){.instance = instance, .primitive = primitive};
    return measure_triangle(object, object->slot_of_primitive[primitive], &ray, true, out);
}

bool ls_reference_margin(const LsReference* reference, const LsRay* ray, uint32_t mask,
                         uint32_t instance, uint32_t primitive, LsReferenceMargin* margin)
{
    LsCandidate measured;
    bool found = measure_hit(reference, ray, mask, instance, primitive, &measured);
    if (found)
    {
        *margin = measured.margin;
    }
    return found;
}

// What double precision answers: the nearest triangle that the line passes through, or NULL.
static const LsCandidate* find_winner(const LsCandidates* list, const LsRay* ray)
{
    const LsCandidate* winner = NULL;
    for (uint32_t i = 0; i < list->count; i++)
    {
        const LsCandidate* item = &list->items[i];
        if (item->margin.inside && item->margin.t > ray->tmin && item->margin.t < ray->tmax &&
            (!winner || item->margin.t < winner->margin.t))
        {
            winner = item;
        }
    }
    return winner;
}

static bool is_near_edge(const LsCandidate* item)
{
    return item->margin.edge_distance <= item->margin.edge_bound;
}

static LsVerdict judge_miss(const LsCandidates* list, const LsCandidate* winner)
{
    for (uint32_t i = 0; i < list->count; i++)
    {
        if (list->items[i].certain)
        {
            return LS_VERDICT_DEFECT;
        }
    }
    return !winner ? LS_VERDICT_RIGHT : is_near_edge(winner) ? LS_VERDICT_EDGE : LS_VERDICT_T_ERROR;
}

static LsVerdict judge_hit(const LsReference* reference, const LsRay* ray, uint32_t mask,
                           const LsCandidates* list, const LsCandidate* winner, const LsHit* hit)
{
    LsCandidate own;
    if (!measure_hit(reference, ray, mask, hit->instance, hit->primitive, &own))
    {
        return LS_VERDICT_DEFECT;
    }
    // Where t leaves the range of normal floats devices flush or overflow; it is held to no more
    // than that.
    double bound = own.margin.t_bound;
    bool held = isfinite(bound) ? fabs(hit->t - own.margin.t) <= bound : true;
    bool within = hit->t > ray->tmin && hit->t < ray->tmax;
    bool tiny = own.margin.t + bound < 0x1p-120 && hit->t < 0x1p-119f;
    bool huge = own.margin.t - bound > 0x1p127 && hit->t > 0x1p126f;
    if (!(held && within) && !tiny && !huge)
    {
        return LS_VERDICT_DEFECT;
    }
    bool is_winner =
        winner && winner->instance == hit->instance && winner->primitive == hit->primitive;
    if (is_winner)
    {
        return LS_VERDICT_RIGHT;
    }
    if (!own.possible)
    {
        return own.farthest_line <= own.margin.edge_bound ? LS_VERDICT_EDGE_ON : LS_VERDICT_DEFECT;
    }
    double latest = isfinite(own.margin.t_bound) ? own.margin.t - own.margin.t_bound : -INFINITY;
    for (uint32_t i = 0; i < list->count; i++)
    {
        const LsCandidate* item = &list->items[i];
        if (item->certain && item->margin.t + item->margin.t_bound < latest)
        {
            return LS_VERDICT_DEFECT;
        }
    }
    return is_near_edge(&own) || (winner && is_near_edge(winner)) ? LS_VERDICT_EDGE
                                                                  : LS_VERDICT_T_ERROR;
}

static LsVerdict judge_answer(const LsReference* reference, const LsRay* ray, uint32_t mask,
                              const LsCandidates* list, const LsHit* answer)
{
    const LsCandidate* winner = find_winner(list, ray);
    return answer->instance == LS_NONE ? judge_miss(list, winner)
                                       : judge_hit(reference, ray, mask, list, winner, answer);
}

void ls_reference_judge(const LsReference* reference, const LsRay* rays, const uint32_t* masks,
                        uint32_t ray_count, uint32_t answer_count, const LsHit* const* answers,
                        LsVerdict* const* verdicts)
{
#pragma omp parallel
    {
        LsCandidates list = {.items = NULL};
#pragma omp for schedule(dynamic, 64)
        for (uint32_t i = 0; i < ray_count; i++)
        {
            uint32_t mask = masks ? masks[i] : 255u;
            gather_candidates(reference, &rays[i], mask, false, &list);
            for (uint32_t a = 0; a < answer_count; a++)
            {
                verdicts[a][i] = judge_answer(reference, &rays[i], mask, &list, &answers[a][i]);
            }
        }
        free(list.items);
    }
}

LsVerdict ls_reference_judge_all(const LsReference* reference, const LsRay* ray, uint32_t mask,
                                 const LsHit* answer)
{
    LsCandidates list = {.items = NULL};
    gather_candidates(reference, ray, mask, true, &list);
    LsVerdict verdict = judge_answer(reference, ray, mask, &list, answer);
    free(list.items);
    return verdict;
}

// ---- The exception of SPEC 7.6 ------------------------------------------------------------------

// The leaf cell that a point of grid space lies in: its lower corner and width, in cells of the
// grid.
static bool find_cell(const LsFile* file, const LsObject* object, const double p[3],
                      double lower[3], double* width)
{
    uint32_t blocks[3], cell[3];
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        if (!(p[axis] >= 0.0 && p[axis] < object->cells[axis]))
        {
            return false;
        }
        cell[axis] = (uint32_t)p[axis];
        lower[axis] = cell[axis];
        blocks[axis] = (object->cells[axis] + 3) / 4;
    }
    *width = 1.0;
    uint32_t word = file->blocks[object->first_block + cell[0] / 4 +
                                 blocks[0] * (cell[1] / 4 + blocks[1] * (cell[2] / 4))];
    while ((word & 15u) == 0)
    {
        const LsCellBlock* block = &file->cell_blocks[object->first_cell_block + (word >> 4)];
        word = block->cells[cell[0] % 4 + 4 * (cell[1] % 4 + 4 * (cell[2] % 4))];
        if ((word & 15u) != 0)
        {
            break;
        }
        const LsVoxel* voxel = &file->voxels[object->first_voxel + (word >> 4)];
        if ((voxel->shape & 255u) != LS_VOXEL_SUBGRID)
        {
            break;
        }
        word = voxel->table << 4;
        *width *= 0.25;
        for (uint32_t axis = 0; axis < 3; axis++)
        {
            cell[axis] = (uint32_t)fmin((p[axis] - lower[axis]) / *width, 3.0);
            lower[axis] += cell[axis] * *width;
        }
    }
    return true;
}

// Whether [s - reach, s + reach] leaves the cell in which the ray is at s.
static bool leaves_cell(const LsFile* file, const LsObject* object, const LsWideRay* ray, double s,
                        double reach)
{
    if (object->kind != LS_OBJECT_GRID)
    {
        return false;
    }
    double o[3], d[3], p[3], lower[3], width;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        o[axis] = (ray->origin[axis] - component(object->grid_lower, axis)) * object->inverse_cell;
        d[axis] = ray->direction[axis] * object->inverse_cell;
        p[axis] = o[axis] + d[axis] * s;
    }
    if (!find_cell(file, object, p, lower, &width))
    {
        return true; // the hit itself has left the grid
    }
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        double from = p[axis] - fabs(d[axis]) * reach;
        double to = p[axis] + fabs(d[axis]) * reach;
        if (!(from >= lower[axis] && to <= lower[axis] + width))
        {
            return true;
        }
    }
    return false;
}

LsException ls_reference_explain(const LsReference* reference, const LsRay* ray, uint32_t mask,
                                 const LsHit* all, const LsHit* exact, double* cosine)
{
    LsCandidate overtaken, other;
    *cosine = 1.0;
    if (!measure_hit(reference, ray, mask, all->instance, all->primitive, &overtaken))
    {
        return LS_EXCEPTION_NONE;
    }
    bool is_hit = exact->instance != LS_NONE;
    bool same = exact->instance == all->instance && exact->primitive == all->primitive;
    if (same || (is_hit && exact->t < all->t))
    {
        return LS_EXCEPTION_NONE; // a hit that testing all triangles does not find, or other bits
    }

    *cosine = overtaken.margin.cosine;
    double bound = isfinite(overtaken.margin.t_bound) ? overtaken.margin.t_bound : INFINITY;
    if (*cosine <= LS_EDGE_ON_COSINE)
    {
        if (is_hit && all->t + bound >= exact->t)
        {
            return LS_EXCEPTION_OTHER_HIT;
        }
        if (all->t + bound >= ray->tmax)
        {
            return LS_EXCEPTION_TMAX;
        }
        const LsObject* object =
            &reference->file->objects[reference->file->instances[all->instance].object];
        LsObjectRay carried;
        if (ls_reference_carry(reference, all->instance, ray, mask, &carried))
        {
            LsWideRay wide = widen_ray(object, &carried, ray);
            if (leaves_cell(reference->file, object, &wide, ldexp(all->t, wide.exponent),
                            ldexp(bound, wide.exponent)))
            {
                return LS_EXCEPTION_CELL_END;
            }
        }
    }
    if (is_hit && measure_hit(reference, ray, mask, exact->instance, exact->primitive, &other) &&
        other.margin.cosine <= LS_EDGE_ON_COSINE &&
        exact->t - (isfinite(other.margin.t_bound) ? other.margin.t_bound : INFINITY) <= all->t)
    {
        *cosine = other.margin.cosine;
        return LS_EXCEPTION_OTHER_HIT;
    }
    return LS_EXCEPTION_NONE;
}
