// small_scenes.h - the smallest .lspace files, put together by hand so that every hit is known.
// They exercise the runtime without the baker.
//
// The quad is the unit square of the plane z = 0, two triangles that face +z: primitive 0
// (0,0)(1,0)(1,1) of material 0 and primitive 2 (0,0)(1,1)(0,1) of material 1 (1 was dropped).

#ifndef LS_TEST_SMALL_SCENES_H
#define LS_TEST_SMALL_SCENES_H

#include "ls_write.h"

typedef enum LsSmallScene
{
    LS_SMALL_LIST,      // the quad as an object of kind list, one identity instance
    LS_SMALL_GRID,      // the quad at z = 0 and at z = -1 (3 and 5), one voxel with masks
    LS_SMALL_INSTANCES, // three instances of the quad: see below
    LS_SMALL_LARGE, // LS_LARGE_SIDE^2 triangles in a list: more than the staging ring holds at once
    LS_SMALL_MANY,  // LS_MANY_INSTANCES of the quad's first half
    LS_SMALL_COUNT,
} LsSmallScene;

// LS_SMALL_INSTANCES: 0 at z = 0 as it is, mask 1; 1 scaled by two and moved to (10,0,0), mask 2;
// 2 mirrored along x and moved to (21,0,0), so that it covers x in [20,21], mask 4.

// LS_SMALL_LARGE: triangle k is (x,y)(x+1,y)(x,y+1) at z = 0 with x = k % side, y = k / side.
#define LS_LARGE_SIDE 576u

// LS_SMALL_MANY: a ray down onto (0.25, 0.75) meets the boxes of all instances and hits the last
// alone, which is moved to (-0.6,0,0).
#define LS_MANY_INSTANCES 20000u

// Writes the scene to `path`; fails the calling test if it cannot.
void ls_small_scene_write(LsSmallScene scene, const char* path);

#endif
