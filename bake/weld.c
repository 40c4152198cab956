// weld.c - a hash table with open addressing, of first vertices; vertices enter in their order.

#include "weld.h"

#include <stdlib.h>
#include <string.h>

#define FREE_SLOT UINT32_MAX
// Vertices hashed ahead of their turn, so that their slots come from memory meanwhile.
#define AHEAD 16

typedef struct Key
{
    uint32_t x, y, z;
} Key;

static uint32_t read_word(const float* value)
{
    float sum = *value + 0.0f; // -0 becomes 0
    uint32_t word;
    memcpy(&word, &sum, sizeof word);
    return word;
}

static Key read_key(const float* positions, uint32_t vertex)
{
    const float* p = positions + 3 * (size_t)vertex;
    return (Key){read_word(p), read_word(p + 1), read_word(p + 2)};
}

// Every bit of the key moves every bit of the result: grids of round numbers differ in few bits.
static uint64_t hash_key(Key key)
{
    uint64_t h = ((uint64_t)key.x << 32 | key.y) * 0x9E3779B97F4A7C15u;
    h = (h ^ h >> 32 ^ key.z) * 0xD6E8FEB86659FD93u;
    h = (h ^ h >> 32) * 0xD6E8FEB86659FD93u;
    return h ^ h >> 32;
}

static uint64_t table_size(uint32_t vertex_count)
{
    uint64_t size = 16;
    while (size < vertex_count + vertex_count / 2ull)
    {
        size *= 2;
    }
    return size;
}

bool ls_weld(const float* positions, uint32_t vertex_count, uint32_t* ids, uint32_t* position_count)
{
    uint64_t size = table_size(vertex_count);
    uint32_t* slots = malloc(size * sizeof *slots); // the first vertex of each position
    if (slots == NULL)
    {
        return false;
    }
    memset(slots, 0xFF, size * sizeof *slots);
    uint64_t hashes[AHEAD];
    uint32_t hashed = 0, count = 0;
    for (uint32_t v = 0; v < vertex_count; v++)
    {
        for (; hashed < vertex_count && hashed - v < AHEAD; hashed++)
        {
            uint64_t hash = hash_key(read_key(positions, hashed));
            hashes[hashed % AHEAD] = hash;
            __builtin_prefetch(&slots[hash & (size - 1)]);
        }
        Key key = read_key(positions, v);
        uint64_t slot = hashes[v % AHEAD] & (size - 1);
        while (slots[slot] != FREE_SLOT)
        {
            Key other = read_key(positions, slots[slot]);
            if (other.x == key.x && other.y == key.y && other.z == key.z)
            {
                break;
            }
            slot = (slot + 1) & (size - 1);
        }
        if (slots[slot] == FREE_SLOT)
        {
            slots[slot] = v;
            ids[v] = count++;
        }
        else
        {
            ids[v] = ids[slots[slot]];
        }
    }
    free(slots);
    *position_count = count;
    return true;
}
