// hash.c - XXH3, inlined from its header so that no symbol of it leaves this file.

#include "hash.h"

#define XXH_INLINE_ALL
#include <string.h>
#include <xxhash.h>

static void store_canonical(XXH128_hash_t value, uint8_t hash[LS_HASH_BYTES])
{
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, value);
    memcpy(hash, canonical.digest, LS_HASH_BYTES);
}

void ls_hash_bytes(const void* bytes, uint64_t size, uint8_t hash[LS_HASH_BYTES])
{
    store_canonical(XXH3_128bits(bytes, size), hash);
}

void ls_hash_header(const LsHeader* header, const LsEntry* entries, uint8_t hash[LS_HASH_BYTES])
{
    LsHeader unhashed = *header;
    memset(unhashed.hash, 0, sizeof(unhashed.hash));
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    XXH3_128bits_update(&state, &unhashed, sizeof(unhashed));
    XXH3_128bits_update(&state, entries, header->chunk_count * sizeof(LsEntry));
    store_canonical(XXH3_128bits_digest(&state), hash);
}
