// linespace.c - the separable shaft test, for all triangles of a voxel at once.
//
// A shaft is the hull of two patches, grown to boxes by e. A triangle is tested against it by three
// projections along the voxel's axes and by its plane, each depending on few patch coordinates, so
// that tables are computed once per triangle and combined by bit operations.
//
// One primitive serves all projections. In the plane of axes a and c, let segments run from the
// side a = 0 (or a = 1, mirrored), where c lies in patch interval y, through the triangle's
// projection, to a zone of a: the interval of a patch on a face of another axis, or the opposite
// side. The ends' c then fills one interval, whose limits come from the vertices of the projection
// (and its chords at the zone's borders, since only what lies before the zone's end can be passed).
// A shaft whose end patch does not meet that interval is not hit.
//
// Triangles are the lanes of the arithmetic, eight at a time, all of them by the same steps; in the
// tables they are the bits of words. So the shafts are combined once for a voxel, not for each
// triangle: a word of a shaft is the AND of three words of tables. Vectors are those of gcc and
// clang, which become what the machine has; they give the same bits on every one.

#include "linespace.h"

#include "shaft_tables.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// Added to the bound, per largest coordinate, against the rounding of double.
static const double SLACK = 1e-13;

struct LsShaftScratch
{
    LsShaftTables tables;
    uint32_t by_p[LS_MAX_PATCHES][LS_MAX_FACE_PATCHES]; // drop c: depends on p and r
    uint32_t by_q[LS_MAX_PATCHES][LS_MAX_FACE_PATCHES]; // drop b: on q, r and s
    uint32_t row[LS_MAX_FACE_PATCHES];                  // drop a: on p, q and s
    LsShaftTablesFill* fill;                            // with the widest vectors of this machine
};

static LsShaftTablesFill* choose_fill(void)
{
#ifdef LS_HAS_X86_VARIANTS
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f"))
    {
        return ls_shaft_tables_fill_avx512;
    }
    if (__builtin_cpu_supports("avx2"))
    {
        return ls_shaft_tables_fill_avx2;
    }
#endif
    return ls_shaft_tables_fill;
}

uint64_t ls_shaft_scratch_bytes(void)
{
    return sizeof(LsShaftScratch);
}

LsShaftScratch* ls_shaft_scratch_create(void)
{
    LsShaftScratch* scratch = malloc(sizeof *scratch);
    if (scratch != NULL)
    {
        scratch->fill = choose_fill();
    }
    return scratch;
}

void ls_shaft_scratch_destroy(LsShaftScratch* scratch)
{
    free(scratch);
}

// ---- Clipping ---------------------------------------------------------------------------------------

typedef struct Polygon
{
    double p[LS_MAX_CORNERS + 1][3];
    int count;
} Polygon;

// Sutherland and Hodgman against one plane: keeps sign * (x[axis] - limit) <= 0.
static void clip_plane(Polygon* polygon, int axis, double sign, double limit)
{
    bool is_inside = true;
    for (int i = 0; i < polygon->count; i++)
    {
        is_inside = is_inside && sign * (polygon->p[i][axis] - limit) <= 0.0;
    }
    if (is_inside)
    {
        return;
    }
    Polygon out = {.count = 0};
    for (int i = 0; i < polygon->count; i++)
    {
        const double* a = polygon->p[i];
        const double* b = polygon->p[(i + 1) % polygon->count];
        double da = sign * (a[axis] - limit);
        double db = sign * (b[axis] - limit);
        if (da <= 0.0)
        {
            memcpy(out.p[out.count++], a, sizeof out.p[0]);
        }
        if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0))
        {
            double f = da / (da - db);
            for (int k = 0; k < 3; k++)
            {
                out.p[out.count][k] = a[k] + f * (b[k] - a[k]);
            }
            out.p[out.count++][axis] = limit;
        }
    }
    *polygon = out;
}

static void clip_to_voxel(Polygon* polygon, const double corners[3][3], double bound)
{
    polygon->count = 3;
    memcpy(polygon->p, corners, 9 * sizeof(double));
    for (int axis = 0; axis < 3 && polygon->count > 0; axis++)
    {
        clip_plane(polygon, axis, -1.0, -bound);
        clip_plane(polygon, axis, 1.0, 1.0 + bound);
    }
}

// Adds a triangle unless nothing of it is in the voxel.
static void add_triangle(LsShaftBatch* batch, const double corners[3][3], double bound,
                         uint32_t bit)
{
    double largest = 1.0;
    for (int i = 0; i < 9; i++)
    {
        double size = fabs(corners[i / 3][i % 3]);
        largest = size > largest ? size : largest;
    }
    Polygon polygon;
    const double e = bound + SLACK * largest;
    clip_to_voxel(&polygon, corners, e);
    if (polygon.count <= 0)
    {
        return;
    }
    const int lane = batch->lanes++;
    batch->e[lane] = e;
    batch->bits[lane] = bit;
    for (int i = 0; i < LS_MAX_CORNERS; i++)
    {
        const double* p = polygon.p[i < polygon.count ? i : polygon.count - 1];
        for (int axis = 0; axis < 3; axis++)
        {
            batch->p[axis][i][lane] = p[axis];
        }
    }
    batch->count = polygon.count > batch->count ? polygon.count : batch->count;

    double u[3], v[3], longest = 0.0;
    for (int k = 0; k < 3; k++)
    {
        u[k] = corners[1][k] - corners[0][k];
        v[k] = corners[2][k] - corners[0][k];
        longest = fmax(longest, fmax(fabs(u[k]), fabs(v[k])));
    }
    for (int k = 0; k < 3; k++)
    {
        batch->normal[k][lane] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    }
    batch->margin[lane] = 1e-13 * longest * longest;
}

// Lanes without a triangle compute what the first does; their bits are 0.
static void fill_lanes(LsShaftBatch* batch)
{
    for (int lane = batch->lanes; lane < LS_LANES; lane++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            for (int i = 0; i < LS_MAX_CORNERS; i++)
            {
                batch->p[axis][i][lane] = batch->p[axis][i][0];
            }
            batch->normal[axis][lane] = batch->normal[axis][0];
        }
        batch->e[lane] = batch->e[0];
        batch->margin[lane] = batch->margin[0];
        batch->bits[lane] = 0;
    }
}

// ---- Tables -----------------------------------------------------------------------------------------

// The part of the tables that N patches use, to zero.
static void clear_tables(LsShaftTables* tables, int patches)
{
    for (int a = 0; a < 3; a++)
    {
        for (int side = 0; side < 2; side++)
        {
            for (int c = 0; c < 3; c++)
            {
                LsZoneTable* table = &tables->zones[a][side][c];
                for (int y = 0; y < patches && c != a; y++)
                {
                    const size_t zones = (size_t)patches + 1;
                    memset(table->reached[y], 0, zones * sizeof table->reached[y][0]);
                    memset(table->sides[y], 0, zones * sizeof table->sides[y][0]);
                }
            }
        }
    }
    for (int face = 0; face < 6; face++)
    {
        memset(tables->above[face], 0, sizeof(uint32_t) * (size_t)(patches * patches));
        memset(tables->below[face], 0, sizeof(uint32_t) * (size_t)(patches * patches));
    }
}

// ---- Shafts -----------------------------------------------------------------------------------------

// Writes one row of shafts, from patch `from` of a face to all patches of another: those of `row`
// but for triangles whose plane has both patches on one side.
static inline __attribute__((always_inline)) void write_row(const LsShaftScratch* scratch,
                                                            int face_a, int from, int face_b,
                                                            int count, const uint32_t* restrict row,
                                                            uint32_t* restrict words)
{
    const uint32_t above = scratch->tables.above[face_a][from],
                   below = scratch->tables.below[face_a][from];
    const uint32_t* restrict all_above = scratch->tables.above[face_b];
    const uint32_t* restrict all_below = scratch->tables.below[face_b];
    for (int m = 0; m < count; m++)
    {
        words[m] = row[m] & ~((above & all_above[m]) | (below & all_below[m]));
    }
}

static inline __attribute__((always_inline)) void write_opposite(LsShaftScratch* scratch, int axis,
                                                                 int patches, uint32_t* words)
{
    const int count = patches * patches;
    const LsZoneTable* by_i = &scratch->tables.zones[axis][0][(axis + 1) % 3];
    const LsZoneTable* by_j = &scratch->tables.zones[axis][0][(axis + 2) % 3];
    for (int i = 0; i < patches; i++)
    {
        for (int j = 0; j < patches; j++)
        {
            for (int k = 0; k < patches; k++)
            {
                const uint32_t word = by_i->reached[i][patches][k];
                for (int m = 0; m < patches; m++)
                {
                    scratch->row[k * patches + m] = word & by_j->reached[j][patches][m];
                }
            }
            const int from = i * patches + j;
            write_row(scratch, 2 * axis, from, 2 * axis + 1, count, scratch->row,
                      words + from * count);
        }
    }
}

// A on (axis a, side sa) at (p along b, q along c); B on (axis b, side sb) at (r along a, s along
// c).
static void write_adjacent(LsShaftScratch* scratch, int face_a, int face_b, int patches,
                           uint32_t* words)
{
    const int a = face_a >> 1, sa = face_a & 1, b = face_b >> 1, sb = face_b & 1, c = 3 - a - b;
    const int count = patches * patches;
    const int stride_p = b == (a + 1) % 3 ? patches : 1, stride_q = stride_p == 1 ? patches : 1;
    const int stride_r = a == (b + 1) % 3 ? patches : 1, stride_s = stride_r == 1 ? patches : 1;
    const LsZoneTable* drop_c = &scratch->tables.zones[a][sa][b];
    const LsZoneTable* drop_b = &scratch->tables.zones[a][sa][c];
    const LsZoneTable* drop_a = &scratch->tables.zones[b][sb][c];

    for (int k = 0; k < patches; k++)
    {
        for (int r = 0; r < patches; r++)
        {
            const int zone = sa ? patches - 1 - r : r;
            for (int s = 0; s < patches; s++)
            {
                const int m = r * stride_r + s * stride_s;
                scratch->by_p[k][m] = drop_c->sides[k][zone][sb];
                scratch->by_q[k][m] = drop_b->reached[k][zone][s];
            }
        }
    }
    for (int p = 0; p < patches; p++)
    {
        const int zone = sb ? patches - 1 - p : p;
        for (int q = 0; q < patches; q++)
        {
            for (int s = 0; s < patches; s++)
            {
                const uint32_t word = drop_a->reached[s][zone][q];
                for (int r = 0; r < patches; r++)
                {
                    scratch->row[r * stride_r + s * stride_s] = word;
                }
            }
            for (int m = 0; m < count; m++)
            {
                scratch->row[m] &= scratch->by_p[p][m] & scratch->by_q[q][m];
            }
            const int from = p * stride_p + q * stride_q;
            write_row(scratch, face_a, from, face_b, count, scratch->row, words + from * count);
        }
    }
}

static void write_shafts(LsShaftScratch* scratch, int patches, uint32_t* words)
{
    for (int face_a = 0; face_a < 6; face_a++)
    {
        for (int face_b = face_a + 1; face_b < 6; face_b++)
        {
            if (face_a >> 1 == face_b >> 1)
            {
                write_opposite(scratch, face_a >> 1, patches, words);
            }
            else
            {
                write_adjacent(scratch, face_a, face_b, patches, words);
            }
            words += patches * patches * patches * patches;
        }
    }
}

void ls_shafts_mark(const double (*corners)[3][3], uint32_t count, double bound, uint32_t patches,
                    uint32_t* words, LsShaftScratch* scratch)
{
    const int n = (int)patches;
    clear_tables(&scratch->tables, n);
    LsShaftBatch batch = {.count = 0};
    for (uint32_t k = 0; k < count; k++)
    {
        add_triangle(&batch, corners[k], bound, 1u << k);
        if (batch.lanes == LS_LANES || (k + 1 == count && batch.lanes > 0))
        {
            fill_lanes(&batch);
            scratch->fill(&scratch->tables, &batch, n);
            batch.lanes = 0;
            batch.count = 0;
        }
    }
    write_shafts(scratch, n, words);
}
