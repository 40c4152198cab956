// ls_output.h - a file that appears whole or not at all.
//
// It is written without a name, or where the file system cannot do that under a temporary one beside its
// place, and named or renamed at the end: a failure leaves what stood there before and nothing beside it. So
// does a program that is killed, but for the temporary name: one that is told to end calls
// ls_output_abandon_all. A link stays a link; what it names is replaced. A directory, a device or a pipe
// is refused.

#ifndef LS_OUTPUT_H
#define LS_OUTPUT_H

#include "ls_base.h"

#ifdef __cplusplus
extern "C"
{
#endif

#define LS_OUTPUT_PATH 4096

    // A file on its way to its place. Zero when closed.
    typedef struct LsOutput
    {
        const char* name;          // as the caller gave it, for messages; borrowed
        int descriptor;            // of the temporary file
        char path[LS_OUTPUT_PATH]; // links followed
        char directory[LS_OUTPUT_PATH];
        char temporary[LS_OUTPUT_PATH + 64]; // empty while the file has no name
        struct LsOutput* next;               // of the open ones with such a name
    } LsOutput;

    // Opens the temporary file and sets room of `size` zero bytes aside in it; more may be put. On failure
    // *output is zero. Errors: OUTPUT, OUTPUT_FULL.
    LsResult ls_output_open(LsOutput* output, const char* path, uint64_t size, LsError* error);

    // Puts bytes at an offset. After an error the output is good for nothing but ls_output_drop. Errors:
    // OUTPUT, OUTPUT_FULL.
    LsResult ls_output_put(LsOutput* output, const void* bytes, uint64_t size, uint64_t offset,
                           LsError* error);

    // Brings what was put to disk; for writers whose last bytes declare the rest whole. Errors: OUTPUT,
    // OUTPUT_FULL.
    LsResult ls_output_sync(LsOutput* output, LsError* error);

    // Brings all to disk, puts the file in its place and closes it; on failure it is dropped. Errors:
    // OUTPUT, OUTPUT_FULL.
    LsResult ls_output_commit(LsOutput* output, LsError* error);

    // Closes and removes what was written. A zero output is allowed.
    void ls_output_drop(LsOutput* output);

    // Removes the temporary files of all outputs that this process has open, and stops every thread that goes
    // on to name, commit or drop one: the last call before the process ends. Not for handlers of
    // signals, but for a thread that waits for them.
    void ls_output_abandon_all(void);

    // Whether `path` can become an output: no directory nor other thing that is no file, in a folder
    // that may be written to. For programs that had better know before hours of work. Errors: OUTPUT.
    LsResult ls_output_check(const char* path, LsError* error);

    // Fills `error` for an errno of writing `name`. Errors: OUTPUT, OUTPUT_FULL.
    LsResult ls_output_report(const char* name, int reason, LsError* error);

    // Writes bytes to `path` in one go; for pictures and reports. Errors: OUTPUT, OUTPUT_FULL.
    LsResult ls_bytes_write(const void* bytes, uint64_t size, const char* path, LsError* error);

#ifdef __cplusplus
}
#endif

#endif
