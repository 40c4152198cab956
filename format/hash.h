// hash.h - the file's hash: XXH3 with 128 bits and seed 0, in canonical (big-endian) bytes.

#ifndef LS_HASH_H
#define LS_HASH_H

#include "ls_format.h"

#define LS_HASH_BYTES 16

void ls_hash_bytes(const void* bytes, uint64_t size, uint8_t hash[LS_HASH_BYTES]);

// Hash of the header, its field `hash` taken as zero, followed by header->chunk_count entries.
void ls_hash_header(const LsHeader* header, const LsEntry* entries, uint8_t hash[LS_HASH_BYTES]);

#endif
