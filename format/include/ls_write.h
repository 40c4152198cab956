// ls_write.h - the write side of .lspace files. Not linked into the runtime.
//
// A file is written in one go: fill an LsFileDesc with arrays, call ls_file_write. The writer
// derives header, directory, feature bits, alignment and hashes, so equal arrays give equal bytes.

#ifndef LS_WRITE_H
#define LS_WRITE_H

#include "ls_format.h"
#include "ls_output.h"

#ifdef __cplusplus
extern "C"
{
#endif

    // Arrays to write, one per chunk type; count 0 leaves the chunk out. Borrowed during the call.
    typedef struct LsFileDesc
    {
#define LS_CHUNK_FIELD(NAME, field, type, code) \
    const type* field;                          \
    uint32_t NAME##_count;
        LS_CHUNK_LIST(LS_CHUNK_FIELD)
#undef LS_CHUNK_FIELD
        float lower[3]; // world bounds
        float upper[3];
        float transform_bound;
        uint8_t source_hash[16];
    } LsFileDesc;

    // The desc that writes an opened file again, byte for byte (SPEC 2.6). Borrows the file's
    // arrays.
    LsFileDesc ls_file_desc(const LsFile* file);

    // Bytes that ls_file_write would write, for budgets and for checking space.
    uint64_t ls_file_desc_bytes(const LsFileDesc* desc);

    // Checks arrays by the rules that ls_file_open and ls_file_check would hold the written file to, so
    // that nobody publishes what readers refuse. Errors: RULE.
    LsResult ls_file_desc_check(const LsFileDesc* desc, const char* name, LsError* error);

    // Writes `path` as an output (ls_output.h), whole or not at all; zero stands in place of the magic
    // until all else is on disk. Errors: OUTPUT, OUTPUT_FULL, INPUT_LIMIT.
    LsResult ls_file_write(const LsFileDesc* desc, const char* path, LsError* error);

#ifdef __cplusplus
}
#endif

#endif
