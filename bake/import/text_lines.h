// text_lines.h - reads text files line by line, for the importers of text formats.

#ifndef LS_TEXT_LINES_H
#define LS_TEXT_LINES_H

#include "ls_base.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

// A file being read. Set `file` (owned from then on), `path`, `error` and `joins_lines`, zero the
// rest; ls_text_lines_close frees it.
typedef struct LsTextLines
{
    FILE* file;
    const char* path;
    LsError* error;
    bool joins_lines; // a backslash at the end continues a line on the next
    char* line;       // owned: the last line read, without the space around its end
    size_t line_capacity;
    char* part; // owned: what getline fills
    size_t part_capacity;
    uint64_t line_number; // of the last line read, from 1
} LsTextLines;

// Reads the next line. *is_end is set behind the last. Errors: FILE_READ, MEMORY, INPUT_FORMAT for
// a zero byte, which no text has.
LsResult ls_text_lines_next(LsTextLines* lines, bool* is_end);

// Begins again with the first line.
void ls_text_lines_rewind(LsTextLines* lines);
void ls_text_lines_close(LsTextLines* lines);

// Sets the error to "path: line N: text" and returns `result`.
LsResult ls_text_lines_fail(const LsTextLines* lines, LsResult result, const char* text);

// Sets the error to that of a file that differs between two readings of it: FILE_READ.
LsResult ls_text_lines_fail_change(const LsTextLines* lines);

// Reads three numbers with space between them and space or the end behind; NaN and infinity are
// numbers. False if `text` does not begin with such.
bool ls_text_read_floats(const char* text, float numbers[3]);

// The text behind its first word and the space around that.
const char* ls_text_skip_word(const char* text);

#endif
