// source_hash.h - the hash by which a file tells whether it is of just these inputs and options.

#ifndef LS_SOURCE_HASH_H
#define LS_SOURCE_HASH_H

#include "source_files.h"
#include "tables.h"

// Hashes all that decides the bytes of the file, without importing: the contents of the files in
// their order, whatever their names, the options, and the versions of format and baker. `choice` is
// that in use. A file that cannot be read counts as one that is not there: the import will say so.
// Does not depend on `threads`. Errors: OUT_OF_MEMORY.
LsResult ls_source_hash(const LsSourceFiles* files, const LsBakeDesc* desc,
                        const LsPatchesChoice* choice, uint32_t threads, uint8_t hash[16],
                        LsError* error);

#endif
