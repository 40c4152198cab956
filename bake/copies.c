// copies.c - a hash table with open addressing over the corners.

#include "copies.h"

#include <stdlib.h>
#include <string.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

// The nine floats of a triangle without what stands between them.
static void get_corners(const LsTriangle* triangle, LsVec3 corners[3])
{
    corners[0] = triangle->v0;
    corners[1] = triangle->v1;
    corners[2] = triangle->v2;
}

static bool is_copy(const LsTriangle* a, const LsTriangle* b)
{
    LsVec3 x[3], y[3];
    get_corners(a, x);
    get_corners(b, y);
    return memcmp(x, y, sizeof x) == 0;
}

uint8_t* ls_find_copies(const LsMesh* mesh)
{
    if (!mesh->may_have_copies)
    {
        return calloc((size_t)mesh->triangle_count + 1, 1);
    }
    uint32_t slots = 16;
    while (slots < 2 * (uint64_t)mesh->triangle_count && slots < 1u << 31)
    {
        slots *= 2;
    }
    uint8_t* copies = calloc((size_t)mesh->triangle_count + 1, 1);
    uint32_t* table = malloc(sizeof(uint32_t) * (size_t)slots);
    if (copies == NULL || table == NULL)
    {
        free(copies);
        free(table);
        return NULL;
    }
    memset(table, 0xFF, sizeof(uint32_t) * (size_t)slots);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
    {
        LsVec3 corners[3];
        get_corners(&mesh->triangles[i], corners);
        uint32_t slot = (uint32_t)XXH3_64bits(corners, sizeof corners) & (slots - 1);
        while (table[slot] != LS_NONE &&
               !is_copy(&mesh->triangles[table[slot]], &mesh->triangles[i]))
        {
            slot = (slot + 1) & (slots - 1);
        }
        copies[i] = table[slot] != LS_NONE;
        table[slot] = copies[i] ? table[slot] : i;
    }
    free(table);
    return copies;
}
