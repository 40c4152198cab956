// check.h - what the parts of the structural check share; one file a chapter of the SPEC.

#ifndef LS_CHECK_H
#define LS_CHECK_H

#include "ls_format.h"

#include <float.h>
#include <math.h>
#include <string.h>

// One run of ls_file_check.
typedef struct LsCheck
{
    const LsFile* file;
    const char* name;
    LsError* error;
} LsCheck;

// Reports a broken rule: file, rule, chunk, record, what is wrong with it. Returns LS_ERROR_RULE.
LsResult ls_check_report(const LsCheck* check, const char* rule, LsChunk chunk, uint64_t record,
                         const char* format, ...) LS_PRINTF(5, 6);

// Chapters 2 and 4, in an order in which each step may follow the indices that those before checked.
LsResult ls_check_scene(const LsCheck* check);
LsResult ls_check_lights(const LsCheck* check); // after the triangles of all objects
LsResult ls_check_triangles(const LsCheck* check, uint32_t object);
LsResult ls_check_looks(const LsCheck* check); // after the triangles: corners have attributes
LsResult ls_check_animations(const LsCheck* check);

// Chapter 5 and 6 for one object, whose record is sound.
LsResult ls_check_grid(const LsCheck* check, uint32_t object);
LsResult ls_check_voxels(const LsCheck* check, uint32_t object);

// R4.7 for the `count` nodes from record `first` of a chunk.
LsResult ls_check_bvh(const LsCheck* check, LsChunk chunk, const LsBvhNode* nodes, uint32_t first,
                      uint32_t count);

// An object's part of an array that may be absent.
#define PART(array, first) ((array) != NULL ? (array) + (first) : NULL)

static inline uint32_t count_records(const LsCheck* check, LsChunk chunk)
{
    return ls_file_count(check->file, chunk);
}

static inline bool is_zero(const void* bytes, uint64_t size)
{
    const uint8_t* first = bytes;
    return size == 0 || (*first == 0 && memcmp(first, first + 1, size - 1) == 0);
}

// Comparisons with NaN are false, so these need no separate test for it.
static inline bool is_fraction(float value)
{
    return value >= 0 && value <= 1;
}

static inline bool is_finite_point(LsVec3 point)
{
    return isfinite(point.x) && isfinite(point.y) && isfinite(point.z);
}

// Whether a vector of that squared length counts as of unit length.
static inline bool is_unit(double squared_length)
{
    return squared_length >= 1 - 0x1p-10 && squared_length <= 1 + 0x1p-10;
}

static inline uint32_t count_blocks_along(const LsObject* object, int axis)
{
    return (object->cells[axis] + LS_BLOCK_SIDE - 1) / LS_BLOCK_SIDE;
}

#endif
