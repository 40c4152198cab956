// ls_write.h - the write side of .lspace files. Not linked into the runtime.
//
// A file is written in one go: fill an LsFileDesc with arrays, call ls_file_write. The writer
// derives header, directory, feature bits, alignment and hashes, so equal arrays give equal bytes.

#ifndef LS_WRITE_H
#define LS_WRITE_H

#include "ls_format.h"

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

    // Writes `path` atomically: a temporary file in the same directory, zero in place of the magic
    // until all else is on disk, fsync, rename, fsync of the directory. On failure nothing is left
    // behind and an older file of that name is untouched. A path that names a directory or a device
    // is refused; a link is followed. Errors: OUTPUT, OUTPUT_FULL, INPUT_LIMIT.
    LsResult ls_file_write(const LsFileDesc* desc, const char* path, LsError* error);

    // Whether `path` can become an output: no directory nor other thing that is no file, in a folder that
    // may be written to. For programs that had better know before hours of work. Errors: OUTPUT.
    LsResult ls_output_check(const char* path, LsError* error);

    // Writes bytes to `path` with the same care; for pictures and reports.
    LsResult ls_bytes_write(const void* bytes, uint64_t size, const char* path, LsError* error);

#ifdef __cplusplus
}
#endif

#endif
