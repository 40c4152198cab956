// topology.h - how the faces of a mesh hang together: a table of its edges, and what is wrong
// there.
//
// Nothing is repaired. The table is the baker's own, since half-edge libraries cannot hold, or
// quietly mend, just the meshes that are of interest here.

#ifndef LS_TOPOLOGY_H
#define LS_TOPOLOGY_H

#include "ls_bake.h"

// A mesh by corners, three a face.
typedef struct LsFaces
{
    const uint32_t* corners; // welded vertices
    const uint32_t* indices; // the same corners as the input counts them, for examples
    const uint8_t* flat;     // per face: it has no area, and is left out of the table
    uint32_t face_count;     // < 2^31
    uint32_t vertex_count;   // welded
} LsFaces;

// The first faults of each kind, in the order of faces or of the edge table.
typedef struct LsMeshExamples
{
    LsMeshExample of[LS_MESH_FAULT_COUNT][LS_MESH_EXAMPLES];
    uint32_t count[LS_MESH_FAULT_COUNT];
} LsMeshExamples;

// Fills the counts of faults and edges in `report` (its other fields stay) and the examples.
// Neither depends on `threads`. False when out of memory: 8 bytes per edge of a face and 10 per
// face.
bool ls_topology_check(const LsFaces* faces, uint32_t threads, LsMeshReport* report,
                       LsMeshExamples* examples);

#endif
