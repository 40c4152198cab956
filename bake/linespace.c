// linespace.c - the separable shaft test.
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

#include "linespace.h"

#include "ls_layout.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// A triangle clipped by six planes has at most nine corners.
#define MAX_CORNERS 9
#define MAX_FACE_PATCHES (LS_MAX_PATCHES * LS_MAX_PATCHES)

// Added to the bound, per largest coordinate, against the rounding of double.
static const double SLACK = 1e-13;

// An interval of patch indices, empty if first > last.
typedef struct PatchRange
{
    int16_t first, last;
} PatchRange;

// Where segments that begin on a side, in interval y, end in a zone: zone N is the opposite side.
typedef struct ZoneTable
{
    PatchRange range[LS_MAX_PATCHES]
                    [LS_MAX_PATCHES + 1]; // [y][zone]: patch intervals of c that are reached
    uint8_t sides[LS_MAX_PATCHES]
                 [LS_MAX_PATCHES + 1]; // [y][zone]: bit 0: c = 0 is reached, bit 1: c = 1
} ZoneTable;

struct LsShaftScratch
{
    ZoneTable zones[3][2][3];           // [a][side][c], a != c
    uint8_t above[6][MAX_FACE_PATCHES]; // patch wholly on the positive side of the plane
    uint8_t below[6][MAX_FACE_PATCHES];
    uint32_t rows[MAX_FACE_PATCHES];                 // combined candidates of one row of shafts
    uint32_t by_p[LS_MAX_PATCHES][MAX_FACE_PATCHES]; // drop c: depends on p and r
    uint32_t by_q[LS_MAX_PATCHES][MAX_FACE_PATCHES]; // drop b: on q, r and s
};

LsShaftScratch* ls_shaft_scratch_create(void)
{
    return malloc(sizeof(LsShaftScratch));
}

void ls_shaft_scratch_destroy(LsShaftScratch* scratch)
{
    free(scratch);
}

typedef struct Polygon
{
    double p[MAX_CORNERS + 1][3];
    int count;
} Polygon;

// Sutherland and Hodgman against one plane: keeps sign * (x[axis] - limit) <= 0.
static void clip_plane(Polygon* polygon, int axis, double sign, double limit)
{
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

static Polygon clip_to_voxel(const double corners[3][3], double bound)
{
    Polygon polygon = {.count = 3};
    memcpy(polygon.p, corners, 9 * sizeof(double));
    for (int axis = 0; axis < 3 && polygon.count > 0; axis++)
    {
        clip_plane(&polygon, axis, -1.0, -bound);
        clip_plane(&polygon, axis, 1.0, 1.0 + bound);
    }
    return polygon;
}

// Corners of the polygon in the plane of axes a and c, mirrored so that segments begin at a = 0.
typedef struct Projection
{
    double a[MAX_CORNERS], c[MAX_CORNERS];
    int count;
} Projection;

static void project(Projection* projection, const Polygon* polygon, int a, int side, int c)
{
    projection->count = polygon->count;
    for (int i = 0; i < polygon->count; i++)
    {
        projection->a[i] = side ? 1.0 - polygon->p[i][a] : polygon->p[i][a];
        projection->c[i] = polygon->p[i][c];
    }
}

// The chord of the projection on the line a = at; low > high where it does not cross.
static void find_chord(const Projection* projection, double at, double* low, double* high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (int i = 0; i < projection->count; i++)
    {
        int j = i + 1 < projection->count ? i + 1 : 0;
        double da = projection->a[i] - at, db = projection->a[j] - at;
        if ((da < 0.0) == (db < 0.0))
        {
            continue;
        }
        double c = projection->c[i] + da / (da - db) * (projection->c[j] - projection->c[i]);
        *low = c < *low ? c : *low;
        *high = c > *high ? c : *high;
    }
}

// Widens [low, high] by the c at which segments from [y_low, y_high] on |a| <= e through (va, vc)
// end, with a in [zone_low, zone_high], all grown by e. From y through v on to the end the segment
// is stretched by a factor between `least` and `most`; the end is y + (v - y) * factor.
static void widen_by_point(double va, double vc, double y_low, double y_high, double zone_low,
                           double zone_high, double e, double* low, double* high)
{
    double least = va + e > 0.0 ? zone_low / (va + e) : 1.0;
    least = least > 1.0 ? fmin(least, 1e30) : 1.0;
    double most = va - e > 0.0 ? zone_high / (va - e) : INFINITY;
    most = most > least ? most : least;
    double over = vc - y_low, under = vc - y_high;
    // A point within the start patch itself reaches everything (0 * inf would be NaN).
    double up = over > 0.0 ? y_low + over * most : y_low + over * least;
    double down = under < 0.0 ? y_high + under * most : y_high + under * least;
    up = over >= 0.0 && va <= e ? INFINITY : up;
    down = under <= 0.0 && va <= e ? -INFINITY : down;
    *high = up > *high ? up : *high;
    *low = down < *low ? down : *low;
}

// Patches of N whose interval, grown by e, meets [low, high].
static PatchRange patch_range(double low, double high, double e, int patches)
{
    // Patch k spans [k/N - e, (k+1)/N + e].
    double first = ceil((low - e) * patches - 1.0);
    double last = floor((high + e) * patches);
    PatchRange range;
    range.first = (int16_t)(first < 0.0 ? 0.0 : (first > patches ? patches : first));
    range.last = (int16_t)(last < -1.0 ? -1.0 : (last > patches - 1 ? patches - 1 : last));
    return range;
}

static void fill_zone_table(ZoneTable* table, const Polygon* polygon, int a, int side, int c,
                            double e, int patches)
{
    Projection projection;
    project(&projection, polygon, a, side, c);
    double step = 1.0 / patches;
    double near_low[LS_MAX_PATCHES + 1], near_high[LS_MAX_PATCHES + 1]; // chords at k/N - e
    double far_low[LS_MAX_PATCHES + 1], far_high[LS_MAX_PATCHES + 1];   // at k/N + e
    for (int k = 0; k <= patches; k++)
    {
        find_chord(&projection, k * step - e, &near_low[k], &near_high[k]);
        find_chord(&projection, k * step + e, &far_low[k], &far_high[k]);
    }
    for (int zone = 0; zone <= patches; zone++)
    {
        double zone_low = zone * step;
        int end = zone < patches ? zone + 1 : patches;
        double zone_high = end * step;
        double chord_low = near_low[zone] < far_low[end] ? near_low[zone] : far_low[end];
        double chord_high = near_high[zone] > far_high[end] ? near_high[zone] : far_high[end];
        for (int y = 0; y < patches; y++)
        {
            double low = chord_low, high = chord_high;
            for (int i = 0; i < projection.count; i++)
            {
                if (projection.a[i] <= zone_high + e)
                {
                    widen_by_point(projection.a[i], projection.c[i], y * step - e,
                                   (y + 1) * step + e, zone_low, zone_high, e, &low, &high);
                }
            }
            // Factors have no limit where a <= e, so that part counts by its own corners, which lie
            // on this chord.
            if (far_low[0] <= far_high[0])
            {
                widen_by_point(e, far_low[0], y * step - e, (y + 1) * step + e, zone_low, zone_high,
                               e, &low, &high);
                widen_by_point(e, far_high[0], y * step - e, (y + 1) * step + e, zone_low,
                               zone_high, e, &low, &high);
            }
            table->range[y][zone] = patch_range(low, high, e, patches);
            table->sides[y][zone] =
                (uint8_t)((low <= e && high >= -e) | (low <= 1.0 + e && high >= 1.0 - e) << 1);
        }
    }
}

// Patches that lie wholly on one side of the triangle's plane.
static void fill_plane_sides(LsShaftScratch* scratch, const double corners[3][3],
                             const double* point, double e, int patches)
{
    double u[3], v[3], n[3], longest = 0.0;
    for (int k = 0; k < 3; k++)
    {
        u[k] = corners[1][k] - corners[0][k];
        v[k] = corners[2][k] - corners[0][k];
        longest = fmax(longest, fmax(fabs(u[k]), fabs(v[k])));
    }
    for (int k = 0; k < 3; k++)
    {
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    }
    double margin = 1e-13 * longest * longest;
    double half = 0.5 / patches;
    for (int face = 0; face < 6; face++)
    {
        int a = face >> 1, b = (a + 1) % 3, c = (a + 2) % 3;
        double at_face = n[a] * ((face & 1) - point[a]);
        double radius = (fabs(n[b]) + fabs(n[c])) * (half + e) + fabs(n[a]) * e + margin;
        for (int i = 0; i < patches; i++)
        {
            for (int j = 0; j < patches; j++)
            {
                double centre = at_face + n[b] * ((2 * i + 1) * half - point[b]) +
                                n[c] * ((2 * j + 1) * half - point[c]);
                scratch->above[face][i * patches + j] = centre > radius;
                scratch->below[face][i * patches + j] = centre < -radius;
            }
        }
    }
}

static bool contains(PatchRange range, int patch)
{
    return patch >= range.first && patch <= range.last;
}

// ORs `bits` into one row of shafts, from patch `from` of a face to all patches of another, where
// `rows` is set.
static void mark_row(const LsShaftScratch* scratch, int face_a, int from, int face_b, int count,
                     uint32_t bits, uint32_t* words)
{
    if (scratch->above[face_a][from] || scratch->below[face_a][from])
    {
        const uint8_t* same =
            scratch->above[face_a][from] ? scratch->above[face_b] : scratch->below[face_b];
        for (int m = 0; m < count; m++)
        {
            words[m] |= same[m] ? 0u : scratch->rows[m] & bits;
        }
        return;
    }
    for (int m = 0; m < count; m++)
    {
        words[m] |= scratch->rows[m] & bits;
    }
}

static void mark_opposite(LsShaftScratch* scratch, int axis, int patches, uint32_t bits,
                          uint32_t* words)
{
    int count = patches * patches;
    const ZoneTable* by_i = &scratch->zones[axis][0][(axis + 1) % 3];
    const ZoneTable* by_j = &scratch->zones[axis][0][(axis + 2) % 3];
    for (int i = 0; i < patches; i++)
    {
        PatchRange range_i = by_i->range[i][patches];
        for (int j = 0; j < patches; j++)
        {
            PatchRange range_j = by_j->range[j][patches];
            if (range_i.first > range_i.last || range_j.first > range_j.last)
            {
                continue;
            }
            memset(scratch->rows, 0, sizeof(uint32_t) * (size_t)count);
            for (int k = range_i.first; k <= range_i.last; k++)
            {
                for (int m = range_j.first; m <= range_j.last; m++)
                {
                    scratch->rows[k * patches + m] = ~0u;
                }
            }
            int from = i * patches + j;
            mark_row(scratch, 2 * axis, from, 2 * axis + 1, count, bits, words + from * count);
        }
    }
}

// A on (axis a, side sa) at (p along b, q along c); B on (axis b, side sb) at (r along a, s along
// c).
static void mark_adjacent(LsShaftScratch* scratch, int face_a, int face_b, int patches,
                          uint32_t bits, uint32_t* words)
{
    int a = face_a >> 1, sa = face_a & 1, b = face_b >> 1, sb = face_b & 1, c = 3 - a - b;
    int count = patches * patches;
    int stride_p = b == (a + 1) % 3 ? patches : 1, stride_q = stride_p == 1 ? patches : 1;
    int stride_r = a == (b + 1) % 3 ? patches : 1, stride_s = stride_r == 1 ? patches : 1;
    const ZoneTable* drop_c = &scratch->zones[a][sa][b];
    const ZoneTable* drop_b = &scratch->zones[a][sa][c];
    const ZoneTable* drop_a = &scratch->zones[b][sb][c];

    for (int r = 0; r < patches; r++)
    {
        int zone = sa ? patches - 1 - r : r;
        for (int k = 0; k < patches; k++)
        {
            uint32_t corner = (drop_c->sides[k][zone] >> sb & 1) ? ~0u : 0u;
            PatchRange range = drop_b->range[k][zone];
            for (int s = 0; s < patches; s++)
            {
                scratch->by_p[k][r * stride_r + s * stride_s] = corner;
                scratch->by_q[k][r * stride_r + s * stride_s] = contains(range, s) ? ~0u : 0u;
            }
        }
    }
    for (int p = 0; p < patches; p++)
    {
        int zone = sb ? patches - 1 - p : p;
        for (int q = 0; q < patches; q++)
        {
            uint32_t any = 0;
            for (int s = 0; s < patches; s++)
            {
                uint32_t reached = contains(drop_a->range[s][zone], q) ? ~0u : 0u;
                for (int r = 0; r < patches; r++)
                {
                    int m = r * stride_r + s * stride_s;
                    scratch->rows[m] = reached & scratch->by_p[p][m] & scratch->by_q[q][m];
                    any |= scratch->rows[m];
                }
            }
            int from = p * stride_p + q * stride_q;
            if (any != 0)
            {
                mark_row(scratch, face_a, from, face_b, count, bits, words + from * count);
            }
        }
    }
}

void ls_shafts_mark(const double corners[3][3], double bound, uint32_t patches, uint32_t bits,
                    uint32_t* words, LsShaftScratch* scratch)
{
    double largest = 1.0;
    for (int i = 0; i < 9; i++)
    {
        largest = fmax(largest, fabs(corners[i / 3][i % 3]));
    }
    double e = bound + SLACK * largest;
    Polygon polygon = clip_to_voxel(corners, e);
    if (polygon.count == 0)
    {
        return;
    }
    int n = (int)patches;
    for (int a = 0; a < 3; a++)
    {
        for (int side = 0; side < 2; side++)
        {
            fill_zone_table(&scratch->zones[a][side][(a + 1) % 3], &polygon, a, side, (a + 1) % 3,
                            e, n);
            fill_zone_table(&scratch->zones[a][side][(a + 2) % 3], &polygon, a, side, (a + 2) % 3,
                            e, n);
        }
    }
    fill_plane_sides(scratch, corners, polygon.p[0], e, n);

    uint32_t* pair_words = words;
    for (int face_a = 0; face_a < 6; face_a++)
    {
        for (int face_b = face_a + 1; face_b < 6; face_b++)
        {
            if (face_a >> 1 == face_b >> 1)
            {
                mark_opposite(scratch, face_a >> 1, n, bits, pair_words);
            }
            else
            {
                mark_adjacent(scratch, face_a, face_b, n, bits, pair_words);
            }
            pair_words += n * n * n * n;
        }
    }
}
