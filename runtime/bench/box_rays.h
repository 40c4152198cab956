// box_rays.h - the benchmark's rays: camera, shadow and diffuse, in the Cornell box.
//
// The box is [-1,1]^3, open at z = 1, with a light of 0.5 x 0.5 at y = 0.99 (scenes/cornell.gltf); a
// model stands in it. From a camera at (0, 0, 3.2) one ray a pixel, through its middle. From each
// hit, moved 1e-4 along the normal that faces the camera, one shadow ray to a random point of the
// light, at y = 0.989, and one diffuse ray, distributed by the cosine; a pixel that misses starts
// both, likewise, at a random point of [0,0.5] x [-1,-0.5] x [0,0.5] with normal (0,0,1).

#ifndef BOX_RAYS_H
#define BOX_RAYS_H

#include "ls_format.h"

#include <stdbool.h>

typedef enum LsRayClass
{
    LS_CAMERA_RAYS,
    LS_SHADOW_RAYS, // directions of unit length, tmax the distance to the light
    LS_DIFFUSE_RAYS,
    LS_RAY_CLASS_COUNT
} LsRayClass;

const char* ls_ray_class_name(LsRayClass class);

// Fills `rays`, width * height of them, row by row from the top.
void ls_box_camera_rays(LsRay* rays, uint32_t width, uint32_t height);

// Fills `shadow` and `diffuse`, one each per camera ray and its hit. `file` is the scene that was
// traced. Equal inputs give equal rays. False when out of memory.
bool ls_box_second_rays(const LsFile* file, const LsRay* camera, const LsHit* hits, uint32_t count,
                        LsRay* shadow, LsRay* diffuse);

#endif
