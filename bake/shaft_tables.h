// shaft_tables.h - the tables of the shaft test: what of a voxel the triangles' projections reach.
//
// Private to the shaft test; linespace.c tells the method.

#ifndef LS_SHAFT_TABLES_H
#define LS_SHAFT_TABLES_H

#include "ls_layout.h"

// Triangles that go through the arithmetic together.
#define LS_LANES 8

// A triangle clipped by six planes has at most nine corners.
#define LS_MAX_CORNERS 9
#define LS_MAX_FACE_PATCHES (LS_MAX_PATCHES * LS_MAX_PATCHES)

// A number of each lane; and what comparing them gives: all bits or none. Read and written through
// pointers alone, since how vectors are passed depends on the machine.
typedef double LsLanes __attribute__((vector_size(8 * LS_LANES)));
typedef int64_t LsLaneMask __attribute__((vector_size(8 * LS_LANES)));

// Up to LS_LANES triangles, clipped to the voxel.
typedef struct LsShaftBatch
{
    LsLanes p[3][LS_MAX_CORNERS]; // corners by axis; the last is repeated up to `count`
    LsLanes e;                    // bound and slack
    LsLanes normal[3];            // of the triangle's plane, not of unit length
    LsLanes margin;               // of the distances from it
    LsLaneMask bits;              // of each in words of shafts; 0 in lanes without one
    int count;                    // corners
    int lanes;                    // triangles that are left
} LsShaftBatch;

// Where segments that begin on a side, in interval y, end in a zone: zone N is the opposite side.
// Bits are triangles.
typedef struct LsZoneTable
{
    // [y][zone][patch]: the patch's interval of c is reached
    uint32_t reached[LS_MAX_PATCHES][LS_MAX_PATCHES + 1][LS_MAX_PATCHES];
    uint32_t sides[LS_MAX_PATCHES][LS_MAX_PATCHES + 1][2]; // [y][zone]: c = 0, c = 1 is reached
} LsZoneTable;

// All tables of a voxel.
typedef struct LsShaftTables
{
    LsZoneTable zones[3][2][3]; // [a][side][c], a != c
    // [face][patch]: the patch lies wholly on the positive or negative side of the plane
    uint32_t above[6][LS_MAX_FACE_PATCHES];
    uint32_t below[6][LS_MAX_FACE_PATCHES];
} LsShaftTables;

// ORs a batch of triangles into the tables of N = patches.
typedef void LsShaftTablesFill(LsShaftTables* tables, const LsShaftBatch* batch, int patches);

// The same function for each kind of vectors; all give the same bits.
LsShaftTablesFill ls_shaft_tables_fill;
#ifdef LS_HAS_X86_VARIANTS
LsShaftTablesFill ls_shaft_tables_fill_avx2;
LsShaftTablesFill ls_shaft_tables_fill_avx512;
#endif

#endif
