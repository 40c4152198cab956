// octahedral.h - unit vectors in 32 bits, as NORMALS stores them (SPEC R4.16).

#ifndef LS_OCTAHEDRAL_H
#define LS_OCTAHEDRAL_H

#include <stdint.h>

// The largest angle, in radians, between a vector and what its word decodes to.
#define LS_OCTAHEDRAL_ERROR 4.4e-5

// The word whose vector is nearest to `v`, which is finite and not zero but need not be of length
// 1. Never LS_NONE.
uint32_t ls_octahedral_encode(const double v[3]);

// The vector of a word other than LS_NONE, of length 1.
void ls_octahedral_decode(uint32_t word, double v[3]);

#endif
