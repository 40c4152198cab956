// shaft_tables.c - fills the tables of the shaft test, a triangle a lane.
//
// Compiled once for each kind of vectors, with LS_SUFFIX naming it. The arithmetic is exact to the
// bit in all of them: nothing is contracted, and no sum is taken across lanes.

#include "shaft_tables.h"

#include <math.h>

#ifdef LS_SUFFIX
#define LS_JOIN(name, suffix) name##suffix
#define LS_EXPAND(name, suffix) LS_JOIN(name, suffix)
#define LS_VARIANT(name) LS_EXPAND(name, LS_SUFFIX)
#else
#define LS_VARIANT(name) name
#endif

// Corners, and two points for a chord.
#define MAX_POINTS (LS_MAX_CORNERS + 2)

#define INLINE static inline __attribute__((always_inline))
#define CHOOSE(mask, a, b) ((LsLanes)(((LsLaneMask)(a) & (mask)) | ((LsLaneMask)(b) & ~(mask))))
#define EACH(number) ((number) - (LsLanes){0})
#define EACH_BITS(number) ((number) | (LsLaneMask){0})

// Points in the plane of axes a and c, mirrored so that segments begin at a = 0: the corners, then
// the ends of the chord on a = e, if it crosses; a is infinite where there is none.
typedef struct Points
{
    LsLanes a[MAX_POINTS], c[MAX_POINTS];
    int count; // of corners
} Points;

// The bits of all lanes, by halves.
INLINE uint32_t gather_bits(const LsLaneMask* bits)
{
    typedef int64_t Half __attribute__((vector_size(4 * LS_LANES)));
    typedef int64_t Quarter __attribute__((vector_size(2 * LS_LANES)));
    union
    {
        LsLaneMask all;
        Half halves[2];
    } eight = {*bits};
    union
    {
        Half all;
        Quarter halves[2];
    } four = {eight.halves[0] | eight.halves[1]};
    const Quarter two = four.halves[0] | four.halves[1];
    return (uint32_t)(two[0] | two[1]);
}

// The chord of the projection on the line a = at; low > high where it does not cross.
INLINE void find_chord(const Points* points, const LsLanes* at, LsLanes* low, LsLanes* high)
{
    *low = EACH(INFINITY);
    *high = EACH(-INFINITY);
    for (int i = 0; i < points->count; i++)
    {
        const int j = i + 1 < points->count ? i + 1 : 0;
        const LsLanes da = points->a[i] - *at, db = points->a[j] - *at;
        const LsLaneMask crosses = (da < 0.0) ^ (db < 0.0);
        const LsLanes c = points->c[i] + da / (da - db) * (points->c[j] - points->c[i]);
        *low = CHOOSE(crosses & (c < *low), c, *low);
        *high = CHOOSE(crosses & (c > *high), c, *high);
    }
}

// From y through a point on to the end in a zone a segment is stretched by a factor between `least`
// and `most`; the end is y + (v - y) * factor.
INLINE void find_stretch(const LsLanes* a, const LsLanes* e, double zone_low, double zone_high,
                         LsLanes* least, LsLanes* most)
{
    const LsLanes over = *a + *e, under = *a - *e;
    LsLanes low = zone_low / over, high = zone_high / under;
    low = CHOOSE(low > 1e30, EACH(1e30), low);
    low = CHOOSE((over > 0.0) & (low > 1.0), low, EACH(1.0));
    high = CHOOSE(under > 0.0, high, EACH(INFINITY));
    *least = low;
    *most = CHOOSE(high > low, high, low);
}

// Widens [low, high] by the c at which segments from [y_low, y_high] on |a| <= e through (a, c)
// end, with a in the zone, all grown by e. Points behind the zone's end are not passed.
INLINE void widen_by_point(const LsLanes* a, const LsLanes* c, const LsLanes* least,
                           const LsLanes* most, const LsLanes* e, double y_low, double y_high,
                           double zone_high, LsLanes* low, LsLanes* high)
{
    const LsLanes from = y_low - *e, to = y_high + *e;
    const LsLanes over = *c - from, under = *c - to;
    LsLanes up = from + over * CHOOSE(over > 0.0, *most, *least);
    LsLanes down = to + under * CHOOSE(under < 0.0, *most, *least);
    // A point within the start patch itself reaches everything (0 * inf would be NaN).
    const LsLaneMask is_start = *a <= *e;
    up = CHOOSE((over >= 0.0) & is_start, EACH(INFINITY), up);
    down = CHOOSE((under <= 0.0) & is_start, EACH(-INFINITY), down);
    const LsLaneMask is_passed = *a <= zone_high + *e;
    *high = CHOOSE(is_passed & (up > *high), up, *high);
    *low = CHOOSE(is_passed & (down < *low), down, *low);
}

// ORs the bits of triangles that reach the patches whose interval, grown by e, meets [low, high].
INLINE void mark_reached(const LsLanes* low, const LsLanes* high, const LsLanes* e,
                         const LsLaneMask* bits, int patches, uint32_t* reached, uint32_t* sides)
{
    // Patch k spans [k/N - e, (k+1)/N + e]; ceil(first) <= k and floor(last) >= k, said without
    // rounding.
    const LsLanes first = (*low - *e) * (double)patches - 1.0;
    const LsLanes last = (*high + *e) * (double)patches;
    for (int k = 0; k < patches; k++)
    {
        const LsLaneMask hit = (first <= (double)k) & (last >= (double)k) & *bits;
        reached[k] |= gather_bits(&hit);
    }
    const LsLaneMask begin = (*low <= *e) & (*high >= -*e) & *bits;
    const LsLaneMask end = (*low <= 1.0 + *e) & (*high >= 1.0 - *e) & *bits;
    sides[0] |= gather_bits(&begin);
    sides[1] |= gather_bits(&end);
}

INLINE void fill_zone_table(LsZoneTable* table, const LsShaftBatch* batch, int a, int side, int c,
                            int patches)
{
    Points points;
    points.count = batch->count;
    for (int i = 0; i < batch->count; i++)
    {
        points.a[i] = side ? 1.0 - batch->p[a][i] : batch->p[a][i];
        points.c[i] = batch->p[c][i];
    }
    const double step = 1.0 / patches;
    LsLanes near_low[LS_MAX_PATCHES + 1], near_high[LS_MAX_PATCHES + 1]; // chords at k/N - e
    LsLanes far_low[LS_MAX_PATCHES + 1], far_high[LS_MAX_PATCHES + 1];   // at k/N + e
    for (int k = 0; k <= patches; k++)
    {
        const LsLanes near = k * step - batch->e, far = k * step + batch->e;
        find_chord(&points, &near, &near_low[k], &near_high[k]);
        find_chord(&points, &far, &far_low[k], &far_high[k]);
    }
    // Factors have no limit where a <= e, so that part counts by its own corners, which lie on the
    // chord at e.
    const int point_count = points.count + 2;
    const LsLaneMask crosses = far_low[0] <= far_high[0];
    for (int i = points.count; i < point_count; i++)
    {
        points.a[i] = CHOOSE(crosses, batch->e, EACH(INFINITY));
        points.c[i] = CHOOSE(crosses, i == points.count ? far_low[0] : far_high[0], EACH(0.0));
    }
    for (int zone = 0; zone <= patches; zone++)
    {
        const double zone_low = zone * step;
        const int end = zone < patches ? zone + 1 : patches;
        const double zone_high = end * step;
        const LsLanes chord_low =
            CHOOSE(near_low[zone] < far_low[end], near_low[zone], far_low[end]);
        const LsLanes chord_high =
            CHOOSE(near_high[zone] > far_high[end], near_high[zone], far_high[end]);
        LsLanes least[MAX_POINTS], most[MAX_POINTS];
        for (int i = 0; i < point_count; i++)
        {
            find_stretch(&points.a[i], &batch->e, zone_low, zone_high, &least[i], &most[i]);
        }
        for (int y = 0; y < patches; y++)
        {
            LsLanes low = chord_low, high = chord_high;
            for (int i = 0; i < point_count; i++)
            {
                widen_by_point(&points.a[i], &points.c[i], &least[i], &most[i], &batch->e, y * step,
                               (y + 1) * step, zone_high, &low, &high);
            }
            mark_reached(&low, &high, &batch->e, &batch->bits, patches, table->reached[y][zone],
                         table->sides[y][zone]);
        }
    }
}

// Patches that lie wholly on one side of a triangle's plane.
INLINE void fill_plane_sides(LsShaftTables* tables, const LsShaftBatch* batch, int patches)
{
    const double half = 0.5 / patches;
    const LsLaneMask no_sign = EACH_BITS(INT64_MAX);
    for (int face = 0; face < 6; face++)
    {
        const int a = face >> 1, b = (a + 1) % 3, c = (a + 2) % 3;
        const LsLanes* n = batch->normal;
        const LsLanes size_a = (LsLanes)((LsLaneMask)n[a] & no_sign),
                      size_b = (LsLanes)((LsLaneMask)n[b] & no_sign);
        const LsLanes size_c = (LsLanes)((LsLaneMask)n[c] & no_sign);
        const LsLanes at_face = n[a] * ((double)(face & 1) - batch->p[a][0]);
        const LsLanes radius =
            (size_b + size_c) * (half + batch->e) + size_a * batch->e + batch->margin;
        for (int i = 0; i < patches; i++)
        {
            for (int j = 0; j < patches; j++)
            {
                const LsLanes centre = at_face + n[b] * ((2 * i + 1) * half - batch->p[b][0]) +
                                       n[c] * ((2 * j + 1) * half - batch->p[c][0]);
                const LsLaneMask above = (centre > radius) & batch->bits;
                const LsLaneMask below = (centre < -radius) & batch->bits;
                tables->above[face][i * patches + j] |= gather_bits(&above);
                tables->below[face][i * patches + j] |= gather_bits(&below);
            }
        }
    }
}

void LS_VARIANT(ls_shaft_tables_fill)(LsShaftTables* tables, const LsShaftBatch* batch, int patches)
{
    for (int a = 0; a < 3; a++)
    {
        for (int side = 0; side < 2; side++)
        {
            for (int other = 1; other < 3; other++)
            {
                const int c = (a + other) % 3;
                fill_zone_table(&tables->zones[a][side][c], batch, a, side, c, patches);
            }
        }
    }
    fill_plane_sides(tables, batch, patches);
}
