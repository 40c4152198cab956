// measure_scene_shafts.c - what the scene Line Space saves: cells that rays walk with and without signatures.
//
//     measure_scene_shafts SCENE GRID [WIDTH HEIGHT [THREADS]]
//
// Rays are those of lsbench: camera, shadow and diffuse rays in a Cornell box, [-1,1]^3 and open at z = 1, in which
// the first object stands, 1.2 long and centred on the floor. The grid is that object's, without sub-grids. Rays
// are walked in double, cell by cell and from empty cube to empty cube, as the shaders walk. Writes nothing. Rows:
//
//     grid      without signatures
//     M = ...   with those of M x M patches a face, as lsbake makes them
//     line      with a signature of the ray's own line, of 32, 64 and then any number of intervals: what no
//               choice of M can beat

#include "compose.h"
#include "linespace.h"
#include "scene_shafts.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_INTERVALS 64

typedef enum RayClass
{
    CAMERA,
    SHADOW,
    DIFFUSE,
    CLASS_COUNT
} RayClass;

typedef enum Method
{
    GRID,
    SHAFTS,  // the signature of the ray's shaft
    LINE,    // of its line
    ENDLESS, // cells that are filled alone
} Method;

typedef struct Ray
{
    double o[3], d[3];
    double tmin, tmax;
} Ray;

typedef struct Tally
{
    uint64_t rays;
    uint64_t met;    // rays that meet the grid's box
    uint64_t empty;  // of these: those that meet no filled cell
    uint64_t ended;  // of the empty ones: those that end without a step
    uint64_t cells;  // walked, empty cubes included
    uint64_t filled; // of these: filled cells
    uint64_t jumps;  // over intervals; the one to the first included
    uint64_t hits;
} Tally;

typedef struct Measure
{
    LsInput input;
    LsMesh mesh;
    LsVoxels voxels;
    LsSceneShafts shafts;
    double scale, offset[3]; // grid = box * scale + offset
    uint32_t width, height, threads;
} Measure;

// ---- Rays -------------------------------------------------------------------------------------------

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

static void scale_to(double v[3], double length)
{
    const double factor = length / sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
    {
        v[i] *= factor;
    }
}

// The camera's ray of a pixel, in box space.
static Ray make_camera_ray(const Measure* measure, uint32_t pixel)
{
    const double step = 2.0 * 0.38 / measure->height;
    Ray ray = {.o = {0.0, 0.0, 3.2},
               .d = {(pixel % measure->width + 0.5 - 0.5 * measure->width) * step,
                     (0.5 * measure->height - pixel / measure->width - 0.5) * step, -1.0},
               .tmax = INFINITY};
    scale_to(ray.d, 1.0);
    return ray;
}

// Where a ray from outside or inside meets the walls, INFINITY if it goes by; with the wall's normal. From outside
// it must come in by the open face.
static double meet_walls(const Ray* ray, double normal[3])
{
    double nearest = INFINITY;
    for (int axis = 0; axis < 3; axis++)
    {
        for (int side = -1; side <= (axis == 2 ? -1 : 1); side += 2) // z = 1 is open
        {
            const double t = (side - ray->o[axis]) / ray->d[axis];
            bool is_on = t > ray->tmin && t < nearest;
            for (int i = 0; i < 3 && is_on; i++)
            {
                is_on = i == axis || fabs(ray->o[i] + t * ray->d[i]) <= 1.0;
            }
            if (is_on)
            {
                nearest = t;
                for (int i = 0; i < 3; i++)
                {
                    normal[i] = i == axis ? -side : 0.0;
                }
            }
        }
    }
    return nearest;
}

// A shadow or diffuse ray from the end of a camera ray, or from a place of its own if that hits nothing.
static Ray make_second_ray(RayClass class, uint32_t pixel, const Ray* camera, double t,
                           const double normal[3])
{
    double random[4], place[4];
    draw_numbers(pixel, 0, random);
    draw_numbers(pixel, 1, place);
    Ray ray = {.o = {0.5 * place[0], -1.0 + 0.5 * place[1], 0.5 * place[2]},
               .tmin = 1e-4,
               .tmax = INFINITY};
    double n[3] = {0.0, 0.0, 1.0};
    for (int i = 0; i < 3 && t < INFINITY; i++)
    {
        n[i] = normal[i];
        ray.o[i] = camera->o[i] + t * camera->d[i] + 1e-4 * normal[i];
    }
    if (class == SHADOW)
    {
        const double target[3] = {0.25 * (2.0 * random[0] - 1.0), 0.989,
                                  0.25 * (2.0 * random[1] - 1.0)};
        double square = 0.0;
        for (int i = 0; i < 3; i++)
        {
            ray.d[i] = target[i] - ray.o[i];
            square += ray.d[i] * ray.d[i];
        }
        ray.tmax = sqrt(square);
    }
    else
    {
        // The normal and a point of the unit sphere: distributed by the cosine.
        const double z = 2.0 * random[2] - 1.0, radius = sqrt(1.0 - z * z);
        const double angle = 6.283185307179586 * random[3];
        ray.d[0] = n[0] + radius * cos(angle);
        ray.d[1] = n[1] + radius * sin(angle);
        ray.d[2] = n[2] + z;
    }
    scale_to(ray.d, 1.0);
    return ray;
}

// ---- Signatures -------------------------------------------------------------------------------------

// A ray in grid space and what of its line lies in the grid.
typedef struct Line
{
    double o[3], d[3];
    double enter, leave;
    uint32_t face_in, face_out;
} Line;

static bool clip_line(const LsGridFrame* frame, Line* line)
{
    line->enter = -INFINITY;
    line->leave = INFINITY;
    for (uint32_t axis = 0; axis < 3; axis++)
    {
        if (line->d[axis] == 0.0)
        {
            continue; // such rays are none of lsbench's
        }
        const uint32_t falling = line->d[axis] < 0.0;
        const double low = -line->o[axis] / line->d[axis];
        const double high = (frame->cells[axis] - line->o[axis]) / line->d[axis];
        const double near = falling ? high : low, far = falling ? low : high;
        if (near > line->enter)
        {
            line->enter = near;
            line->face_in = 2 * axis + falling;
        }
        if (far < line->leave)
        {
            line->leave = far;
            line->face_out = 2 * axis + 1 - falling;
        }
    }
    return line->enter < line->leave;
}

static uint32_t find_patch(const Measure* measure, const Line* line, uint32_t face, double s)
{
    const uint32_t patches = measure->shafts.patches;
    uint32_t place[2];
    for (uint32_t k = 0; k < 2; k++)
    {
        const uint32_t axis = ((face >> 1) + 1 + k) % 3;
        const double at =
            (line->o[axis] + s * line->d[axis]) * patches / measure->voxels.frame.cells[axis];
        place[k] = (uint32_t)fmin(fmax(at, 0.0), patches - 1.0);
    }
    return place[0] * patches + place[1];
}

static uint64_t get_signature(const Measure* measure, const Line* line)
{
    uint32_t face[2] = {line->face_in, line->face_out};
    uint32_t patch[2] = {find_patch(measure, line, line->face_in, line->enter),
                         find_patch(measure, line, line->face_out, line->leave)};
    const uint32_t a = face[0] < face[1] ? 0 : 1, b = 1 - a;
    const uint32_t count = measure->shafts.patches * measure->shafts.patches;
    const uint32_t pair = face[a] * 5 - face[a] * (face[a] - 1) / 2 + face[b] - face[a] - 1;
    const uint32_t word = measure->shafts.words[(pair * count + patch[a]) * count + patch[b]];
    uint64_t signature = 0;
    for (int k = 0; k < LS_SIGNATURE_INTERVALS; k++)
    {
        signature |= (uint64_t)(word >> (a == 0 ? k : LS_SIGNATURE_INTERVALS - 1 - k) & 1) << k;
    }
    return signature;
}

// ---- The walk ---------------------------------------------------------------------------------------

// What stands at a cell: a voxel, or an empty cube that grows into the octant.
static bool find_cell(const LsVoxels* voxels, const int64_t cell[3], uint32_t octant,
                      int64_t base[3], int64_t* side, uint32_t* voxel)
{
    const uint32_t blocks_x = (voxels->frame.cells[0] + 3) / 4;
    const uint32_t blocks_y = (voxels->frame.cells[1] + 3) / 4;
    memcpy(base, cell, 3 * sizeof *base);
    *side = 1;
    uint32_t word =
        voxels->blocks[cell[0] / 4 + blocks_x * (cell[1] / 4 + blocks_y * (cell[2] / 4))];
    if ((word & 15) != 0)
    {
        for (int i = 0; i < 3; i++)
        {
            base[i] = cell[i] / 4 * 4;
        }
        *side = 4;
    }
    else
    {
        word = voxels->cell_blocks[word >> 4]
                   .cells[cell[0] % 4 + 4 * (cell[1] % 4) + 16 * (cell[2] % 4)];
    }
    *voxel = word >> 4;
    const int64_t distance = word >> 4 * octant & 15;
    for (int i = 0; i < 3 && (word & 15) != 0; i++)
    {
        base[i] -= (octant >> i & 1) != 0 ? (distance - 1) * *side : 0;
    }
    *side *= (word & 15) != 0 ? distance : 1;
    return (word & 15) == 0;
}

// T. Möller, B. Trumbore 1997, in grid space.
static double meet_triangle(const Measure* measure, const Line* line, uint32_t index)
{
    const LsTriangle* triangle = &measure->mesh.triangles[index];
    double a[3], b[3], c[3], p[3], q[3];
    ls_grid_point(&measure->voxels.frame, triangle->v0, a);
    ls_grid_point(&measure->voxels.frame, triangle->v1, b);
    ls_grid_point(&measure->voxels.frame, triangle->v2, c);
    double o[3];
    for (int i = 0; i < 3; i++)
    {
        b[i] -= a[i];
        c[i] -= a[i];
        o[i] = line->o[i] - a[i];
    }
    for (int i = 0; i < 3; i++)
    {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        p[i] = line->d[j] * c[k] - line->d[k] * c[j];
        q[i] = o[j] * b[k] - o[k] * b[j];
    }
    const double det = b[0] * p[0] + b[1] * p[1] + b[2] * p[2];
    const double u = (o[0] * p[0] + o[1] * p[1] + o[2] * p[2]) / det;
    const double v = (line->d[0] * q[0] + line->d[1] * q[1] + line->d[2] * q[2]) / det;
    const bool is_met = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    return is_met ? (c[0] * q[0] + c[1] * q[1] + c[2] * q[2]) / det : INFINITY;
}

// A ray's way through the grid.
typedef struct Walk
{
    Line line;
    double s, smin, smax;
    int64_t cell[3];
    uint32_t octant;
    uint32_t triangle; // of the best hit
    double stop;       // end of the run of filled intervals
    uint64_t signature;
    int intervals;
} Walk;

static void enter_cell(Walk* walk, const LsGridFrame* frame)
{
    for (int i = 0; i < 3; i++)
    {
        const double at = floor(walk->line.o[i] + walk->s * walk->line.d[i]);
        walk->cell[i] = (int64_t)fmin(fmax(at, 0.0), frame->cells[i] - 1.0);
    }
}

// Goes on in the next run of filled intervals. False if there is none.
static bool jump(Walk* walk, const LsGridFrame* frame, Tally* tally)
{
    const double step = (walk->line.leave - walk->line.enter) / walk->intervals;
    for (int k = 0; k < walk->intervals; k++)
    {
        int end = k;
        while (end < walk->intervals && (walk->signature >> end & 1) != 0)
        {
            end++;
        }
        const double begin = walk->line.enter + k * step;
        const double stop = walk->line.enter + end * step;
        if (end > k && (stop >= walk->s || end == walk->intervals))
        {
            walk->stop = end == walk->intervals ? INFINITY : stop;
            if (begin > walk->s)
            {
                walk->s = begin;
                enter_cell(walk, frame);
                tally->jumps++;
            }
            return true;
        }
        k = end > k ? end - 1 : k;
    }
    return false;
}

// One step. True if it is through a filled cell, with the hits in it.
static bool step(const Measure* measure, Walk* walk)
{
    int64_t base[3], side;
    uint32_t voxel;
    const bool filled = find_cell(&measure->voxels, walk->cell, walk->octant, base, &side, &voxel);
    const LsWorkVoxel* work = &measure->voxels.voxels[filled ? voxel : 0];
    for (uint32_t i = 0; filled && i < work->reference_count; i++)
    {
        const uint32_t index = measure->voxels.references[work->first_reference + i];
        const double s = meet_triangle(measure, &walk->line, index);
        if (s > walk->smin && s < walk->smax)
        {
            walk->smax = s;
            walk->triangle = index;
        }
    }
    double least = INFINITY;
    int axis_out = 0;
    for (int i = 0; i < 3; i++)
    {
        const int64_t plane = base[i] + (walk->line.d[i] > 0.0 ? side : 0);
        const double s =
            walk->line.d[i] == 0.0 ? INFINITY : ((double)plane - walk->line.o[i]) / walk->line.d[i];
        if (s < least)
        {
            least = s;
            axis_out = i;
        }
    }
    walk->s = fmax(walk->s, least);
    for (int i = 0; i < 3; i++)
    {
        const double at = floor(walk->line.o[i] + walk->s * walk->line.d[i]);
        walk->cell[i] =
            i == axis_out ? base[i] + (walk->line.d[i] > 0.0 ? side : -1)
                          : (int64_t)fmin(fmax(at, (double)base[i]), (double)(base[i] + side - 1));
    }
    return filled;
}

static bool is_over(const Walk* walk, const LsGridFrame* frame)
{
    bool outside = false;
    for (int i = 0; i < 3; i++)
    {
        outside = outside || walk->cell[i] < 0 || walk->cell[i] >= frame->cells[i];
    }
    return outside || walk->smax < walk->s;
}

// Walks on to the end; `line_signature` gathers the intervals of the line that lie in filled cells.
static void walk_on(const Measure* measure, Walk* walk, bool ends_at_hit, uint64_t* line_signature,
                    Tally* tally)
{
    const LsGridFrame* frame = &measure->voxels.frame;
    bool over = is_over(walk, frame) || !jump(walk, frame, tally);
    over = over || is_over(walk, frame);
    while (!over)
    {
        const double begin = walk->s;
        const bool filled = step(measure, walk);
        tally->cells++;
        tally->filled += filled;
        if (filled && line_signature != NULL)
        {
            const double scale = walk->intervals / (walk->line.leave - walk->line.enter);
            const int first = (int)fmax((begin - walk->line.enter) * scale, 0.0);
            const int last = (int)fmin((walk->s - walk->line.enter) * scale, walk->intervals - 1.0);
            for (int k = first; k <= last; k++)
            {
                *line_signature |= 1ull << k;
            }
        }
        walk->smax = ends_at_hit ? walk->smax : INFINITY;
        over = is_over(walk, frame) ||
               (walk->s > walk->stop && (!jump(walk, frame, tally) || is_over(walk, frame)));
    }
}

// Carries a ray of box space into the grid. False if it misses it.
static bool begin_walk(const Measure* measure, const Ray* ray, double tmax, Walk* walk)
{
    const LsGridFrame* frame = &measure->voxels.frame;
    *walk = (Walk){.smin = ray->tmin, .smax = tmax, .triangle = LS_NONE, .stop = INFINITY};
    for (int i = 0; i < 3; i++)
    {
        walk->line.o[i] = ray->o[i] * measure->scale + measure->offset[i];
        walk->line.d[i] = ray->d[i] * measure->scale;
        walk->octant |= walk->line.d[i] < 0.0 ? 1u << i : 0;
    }
    if (!clip_line(frame, &walk->line) || walk->line.leave < ray->tmin || walk->line.enter > tmax)
    {
        return false;
    }
    walk->s = fmax(walk->line.enter, ray->tmin);
    enter_cell(walk, frame);
    return true;
}

// Traces a ray by a method; `intervals` of a line's signature. Returns its t in the object, and the triangle.
static double trace(const Measure* measure, const Ray* ray, double tmax, Method method,
                    int intervals, uint32_t* triangle, Tally* tally)
{
    Walk walk;
    *triangle = LS_NONE;
    tally->rays++;
    if (!begin_walk(measure, ray, tmax, &walk))
    {
        return INFINITY;
    }
    // Of the whole line, to know what there is to be met.
    const Walk first = walk;
    uint64_t line_signature = 0;
    Tally whole = {0};
    walk.s = walk.line.enter;
    walk.signature = ~0ull;
    walk.intervals = intervals;
    walk.smax = INFINITY;
    enter_cell(&walk, &measure->voxels.frame);
    walk_on(measure, &walk, false, &line_signature, &whole);

    walk = first;
    walk.signature = method == GRID || method == ENDLESS ? ~0ull
                     : method == SHAFTS                  ? get_signature(measure, &walk.line)
                                                         : line_signature;
    walk.intervals = method == SHAFTS ? LS_SIGNATURE_INTERVALS : intervals;
    const uint64_t cells = tally->cells, filled = tally->filled;
    walk_on(measure, &walk, true, NULL, tally);
    if (method == ENDLESS)
    {
        tally->cells = cells + tally->filled - filled;
    }
    tally->met++;
    tally->empty += whole.filled == 0;
    tally->ended += whole.filled == 0 && tally->cells == cells;
    tally->hits += walk.triangle != LS_NONE;
    *triangle = walk.triangle;
    return walk.smax;
}

// The end of a camera ray, on the object or on a wall, and the normal there that faces the camera.
static double find_start(const Measure* measure, const Ray* ray, double normal[3])
{
    uint32_t triangle;
    Tally unused = {0};
    const double t_wall = meet_walls(ray, normal);
    const double t = trace(measure, ray, t_wall, GRID, 1, &triangle, &unused);
    if (triangle == LS_NONE)
    {
        return t_wall;
    }
    double corners[3][3];
    const LsTriangle* hit = &measure->mesh.triangles[triangle];
    ls_grid_point(&measure->voxels.frame, hit->v0, corners[0]);
    ls_grid_point(&measure->voxels.frame, hit->v1, corners[1]);
    ls_grid_point(&measure->voxels.frame, hit->v2, corners[2]);
    for (int i = 0; i < 3; i++)
    {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = (corners[1][j] - corners[0][j]) * (corners[2][k] - corners[0][k]) -
                    (corners[1][k] - corners[0][k]) * (corners[2][j] - corners[0][j]);
    }
    const double facing = normal[0] * ray->d[0] + normal[1] * ray->d[1] + normal[2] * ray->d[2];
    scale_to(normal, facing > 0.0 ? -1.0 : 1.0);
    return t;
}

static void add_tally(Tally* sum, const Tally* tally)
{
    sum->rays += tally->rays;
    sum->met += tally->met;
    sum->empty += tally->empty;
    sum->ended += tally->ended;
    sum->cells += tally->cells;
    sum->filled += tally->filled;
    sum->jumps += tally->jumps;
    sum->hits += tally->hits;
}

static void run_method(const Measure* measure, Method method, int intervals,
                       Tally tallies[CLASS_COUNT])
{
    memset(tallies, 0, CLASS_COUNT * sizeof *tallies);
#pragma omp parallel for num_threads(measure->threads) schedule(dynamic, 64)
    for (uint32_t pixel = 0; pixel < measure->width * measure->height; pixel++)
    {
        Tally own[CLASS_COUNT] = {0};
        double normal[3], unused[3];
        const Ray camera = make_camera_ray(measure, pixel);
        const double t = find_start(measure, &camera, normal);
        for (int class = 0; class < CLASS_COUNT; class ++)
        {
            const Ray ray =
                class == CAMERA ? camera : make_second_ray(class, pixel, &camera, t, normal);
            const double wall = class == SHADOW ? ray.tmax : meet_walls(&ray, unused);
            uint32_t triangle;
            trace(measure, &ray, wall, method, intervals, &triangle, &own[class]);
        }
#pragma omp critical
        for (int class = 0; class < CLASS_COUNT; class ++)
        {
            add_tally(&tallies[class], &own[class]);
        }
    }
}

static void print_row(const char* name, uint64_t bytes, const Tally tallies[CLASS_COUNT])
{
    printf("%-9s %12llu", name, (unsigned long long)bytes);
    for (int class = 0; class < CLASS_COUNT; class ++)
    {
        const Tally* t = &tallies[class];
        printf(" | %6.3f %6.3f %5.1f%% %6.3f %7llu", (double)t->cells / (double)t->rays,
               (double)t->filled / (double)t->rays,
               t->empty > 0 ? 100.0 * (double)(t->empty - t->ended) / (double)t->empty : 0.0,
               (double)t->jumps / (double)t->rays, (unsigned long long)t->hits);
    }
    printf("\n");
    fflush(stdout);
}

static LsResult measure_all(Measure* measure, LsError* error)
{
    Tally tallies[CLASS_COUNT];
    run_method(measure, GRID, 1, tallies);
    printf("grid %u x %u x %u, voxels %u, %u rays a class; meet the box: camera %.1f %%, shadow "
           "%.1f %%, diffuse %.1f %%\n",
           measure->voxels.frame.cells[0], measure->voxels.frame.cells[1],
           measure->voxels.frame.cells[2], measure->voxels.voxel_count,
           measure->width * measure->height,
           100.0 * (double)tallies[CAMERA].met / (double)tallies[CAMERA].rays,
           100.0 * (double)tallies[SHADOW].met / (double)tallies[SHADOW].rays,
           100.0 * (double)tallies[DIFFUSE].met / (double)tallies[DIFFUSE].rays);
    printf(
        "each for camera | shadow | diffuse: cells a ray, filled ones of them, rays that meet no "
        "filled cell and walk all the same, jumps a ray, hits\n");
    print_row("grid", 0, tallies);
    static const uint32_t patches[] = {4, 8, 16, 32};
    for (size_t i = 0; i < sizeof patches / sizeof *patches; i++)
    {
        const double begin = omp_get_wtime();
        const LsResult result = ls_scene_shafts_create(&measure->shafts, &measure->voxels,
                                                       patches[i], measure->threads, error);
        if (result != LS_OK)
        {
            return result;
        }
        const double seconds = omp_get_wtime() - begin;
        char name[16];
        snprintf(name, sizeof name, "M = %u", patches[i]);
        run_method(measure, SHAFTS, LS_SIGNATURE_INTERVALS, tallies);
        print_row(name, 4ull * measure->shafts.word_count, tallies);
        printf("          made in %.2f s, %.1f %% of the shafts filled\n", seconds,
               100.0 * (double)measure->shafts.filled_count / measure->shafts.word_count);
        ls_scene_shafts_destroy(&measure->shafts);
    }
    run_method(measure, LINE, 32, tallies);
    print_row("line, 32", 0, tallies);
    run_method(measure, LINE, MAX_INTERVALS, tallies);
    print_row("line, 64", 0, tallies);
    run_method(measure, ENDLESS, 1, tallies);
    print_row("line, any", 0, tallies);
    return LS_OK;
}

static LsResult run(Measure* measure, const LsBakeDesc* desc, LsError* error)
{
    LsMeshFindings findings;
    LsResult result = ls_compose(&measure->input, desc, NULL, NULL, error);
    result = result == LS_OK ? ls_mesh_create(&measure->mesh, &measure->input, 0, desc,
                                              measure->threads, NULL, &findings, error)
                             : result;
    result = result == LS_OK ? ls_voxels_create(&measure->voxels, &measure->mesh, desc->grid, 0,
                                                measure->threads, NULL, error)
                             : result;
    if (result != LS_OK)
    {
        return result;
    }
    double longest = 0.0;
    for (int i = 0; i < 3; i++)
    {
        longest = fmax(longest, (double)measure->mesh.upper[i] - measure->mesh.lower[i]);
    }
    const LsGridFrame* frame = &measure->voxels.frame;
    const double object_per_box = longest / 1.2;
    measure->scale = object_per_box * frame->inverse_cell;
    for (int i = 0; i < 3; i++)
    {
        const double centre = 0.5 * ((double)measure->mesh.upper[i] + measure->mesh.lower[i]);
        const double origin = i == 1 ? measure->mesh.lower[i] + object_per_box : centre;
        measure->offset[i] = (origin - frame->lower[i]) * frame->inverse_cell;
    }
    return measure_all(measure, error);
}

int main(int argc, char** argv)
{
    static Measure measure;
    uint32_t numbers[4] = {0, 320, 180, 2};
    for (int i = 2; i < argc && i < 6; i++)
    {
        numbers[i - 2] = (uint32_t)strtoul(argv[i], NULL, 10);
    }
    const LsBakeInput input = {.path = argc > 1 ? argv[1] : NULL};
    const LsBakeDesc desc = {.inputs = &input, .input_count = 1, .grid = numbers[0]};
    measure.width = numbers[1];
    measure.height = numbers[2];
    measure.threads = numbers[3];
    if (argc < 3 || argc == 4 || argc > 6 || desc.grid < 1 || desc.grid > LS_MAX_CELLS ||
        measure.width < 1 || measure.width > 65535 || measure.height < 1 ||
        measure.height > 65535 || measure.threads < 1)
    {
        fputs("usage: measure_scene_shafts SCENE GRID [WIDTH HEIGHT [THREADS]]\n", stderr);
        return EXIT_FAILURE;
    }
    LsError error;
    const LsResult result = run(&measure, &desc, &error);
    if (result != LS_OK)
    {
        fprintf(stderr, "measure_scene_shafts: %s\n", error.text);
    }
    ls_voxels_destroy(&measure.voxels);
    ls_mesh_destroy(&measure.mesh);
    ls_input_destroy(&measure.input);
    return result == LS_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
