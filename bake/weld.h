// weld.h - vertices of equal position become one.

#ifndef LS_WELD_H
#define LS_WELD_H

#include <stdbool.h>
#include <stdint.h>

// Gives each vertex the number of its position: positions are numbered from 0 in the order in which
// they first appear, and equal ones (bit by bit, -0 taken for 0) have one number. positions: xyz
// per vertex, finite. ids: room for vertex_count. Stores the count of numbers. False when out of
// memory.
bool ls_weld(const float* positions, uint32_t vertex_count, uint32_t* ids,
             uint32_t* position_count);

#endif
