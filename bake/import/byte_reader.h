// byte_reader.h - reads a file once from front to back, as bytes or as words of text.
//
// Holds one small buffer, never the file: memory does not grow with it.

#ifndef LS_BYTE_READER_H
#define LS_BYTE_READER_H

#include "import.h"

#include <stddef.h>
#include <stdio.h>

// Longest word that is no nonsense, with the zero behind it.
#define LS_WORD_BYTES 64

// Set `file` (owned from then on), `path`, `error` and `input` (may be NULL: no progress is shown),
// zero the rest, then ls_byte_reader_begin; ls_byte_reader_close frees it.
typedef struct LsByteReader
{
    FILE* file;
    const char* path;
    LsError* error;
    const LsInput* input;
    uint32_t pass_count; // how often the file is read in all, for progress; 0: once
    uint32_t pass;       // which of them this is
    uint64_t size;       // of the file
    uint64_t taken;      // bytes that have been taken from the file, those in `buffer` too
    size_t at, end;      // what is left in `buffer`
    uint64_t line;       // where the last word stands, from 1; counted by ls_byte_reader_word
    uint64_t next_line;  // where the next may stand
    bool is_failed;      // the file could not be read, which differs from its end
    uint8_t buffer[32768];
} LsByteReader;

// Learns the size and goes to the first byte. Errors: FILE_UNREADABLE.
LsResult ls_byte_reader_begin(LsByteReader* reader);
void ls_byte_reader_close(LsByteReader* reader);

// The bytes not read yet.
uint64_t ls_byte_reader_left(const LsByteReader* reader);

// The next byte, or -1 behind the last.
int ls_byte_reader_next(LsByteReader* reader);

// Copies `count` bytes; false if there are fewer.
bool ls_byte_reader_copy(LsByteReader* reader, void* bytes, size_t count);

// Passes over `count` bytes; false if there are fewer.
bool ls_byte_reader_skip(LsByteReader* reader, uint64_t count);

// Copies the next word, whatever space stands before it, and returns its length: 0 at the end of the
// file, LS_WORD_BYTES for a word too long, of which only the beginning is copied.
size_t ls_byte_reader_word(LsByteReader* reader, char word[LS_WORD_BYTES]);

// FILE_UNREADABLE if the file could not be read, otherwise OK: what to ask behind a short read.
LsResult ls_byte_reader_check(const LsByteReader* reader);

// Sets the error to that of a file that differs between two readings of it: FILE_CHANGED.
LsResult ls_byte_reader_fail_change(const LsByteReader* reader);

#endif
