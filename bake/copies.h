// copies.h - triangles that are there more than once.

#ifndef LS_COPIES_H
#define LS_COPIES_H

#include "mesh.h"

// One byte a triangle of the mesh, which the caller frees: whether an earlier one has the same
// three corners, bit for bit and in the same order. Its test finds the same t for every ray and its
// primitive is greater, so it never answers (SPEC 7.4). NULL when out of memory: 9 to 17 bytes a
// triangle.
uint8_t* ls_find_copies(const LsMesh* mesh);

#endif
