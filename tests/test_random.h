// test_random.h - a small generator of the tests' own: the same numbers everywhere, from a seed.

#ifndef LS_TEST_RANDOM_H
#define LS_TEST_RANDOM_H

#include <stdint.h>

// Zero is a legal seed. The generator is Steele, Lea and Flood's SplitMix64 (2014).
typedef struct LsRandom
{
    uint64_t state;
} LsRandom;

static inline uint32_t ls_random_word(LsRandom* random)
{
    random->state += 0x9E3779B97F4A7C15ull;
    uint64_t x = random->state;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return (uint32_t)((x ^ (x >> 31)) >> 32);
}

// 0 .. count - 1.
static inline uint32_t ls_random_below(LsRandom* random, uint32_t count)
{
    return (uint32_t)((uint64_t)ls_random_word(random) * count >> 32);
}

// [0, 1).
static inline double ls_random_unit(LsRandom* random)
{
    return ls_random_word(random) * 0x1p-32;
}

// [lower, upper).
static inline double ls_random_between(LsRandom* random, double lower, double upper)
{
    return lower + (upper - lower) * ls_random_unit(random);
}

#endif
