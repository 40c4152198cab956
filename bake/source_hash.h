// source_hash.h - the hash by which a file tells whether it is of just these inputs and options.

#ifndef LS_SOURCE_HASH_H
#define LS_SOURCE_HASH_H

#include "import/import.h"
#include "ls_bake.h"

// Hashes all that decides the bytes of the file: the imported and placed scene, the options, and the
// versions of format and baker. `patches` is the N in use.
void ls_source_hash(const LsInput* input, const LsBakeDesc* desc, uint32_t patches,
                    uint8_t hash[16]);

#endif
