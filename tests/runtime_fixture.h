// runtime_fixture.h - a device, the smallest scenes as files, and rays at them: for the tests of the runtime.

#ifndef LS_TEST_RUNTIME_FIXTURE_H
#define LS_TEST_RUNTIME_FIXTURE_H

#include "gpu.h"
#include "small_scenes.h"

extern LsGpu gpu;
extern char folder[];                  // for files of the tests, which remove their own
extern char paths[LS_SMALL_COUNT][64]; // of the scenes in it

void open_fixture(void);
int close_fixture(void); // 0: done

// Maps and opens the file of a scene, under a name for messages.
void open_small_file(LsSmallScene id, const char* name, LsMapping* mapping, LsFile* file);

LsRay make_ray(LsVec3 origin, LsVec3 direction);

// Down onto (x,y) of the plane z = 0, from z = 1.
LsRay ray_down(float x, float y);

// All 32 bytes must be equal.
void check_hit(LsHit hit, LsHit expected);

#endif
