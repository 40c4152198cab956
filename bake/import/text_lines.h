// text_lines.h - reads text files line by line, for the importers of text formats.

#ifndef LS_TEXT_LINES_H
#define LS_TEXT_LINES_H

#include "import.h"

#include <stddef.h>
#include <stdio.h>

// A file being read. Set `file` (owned from then on), `path`, `error`, `joins_lines`, and `input` and
// `pass_count` for progress to be shown, zero the rest; ls_text_lines_close frees it.
typedef struct LsTextLines
{
    FILE* file;
    const char* path;
    LsError* error;
    bool joins_lines; // a backslash at the end continues a line on the next
    const LsInput* input;
    uint32_t pass_count; // how often the file is read in all
    uint32_t pass;       // which of them this is; ls_text_lines_rewind counts on
    uint64_t size;       // of the file, once a line has been read
    uint64_t taken;      // bytes of the lines read
    uint64_t noted;      // `taken` when progress was last shown
    char* line;          // owned: the last line read, without the space around its end
    size_t line_capacity;
    char* part; // owned: what getline fills
    size_t part_capacity;
    uint64_t line_number; // of the last line read, from 1
} LsTextLines;

// Reads the next line; a byte order mark before the first is passed over. *is_end is set behind the
// last. Errors: FILE_UNREADABLE, OUT_OF_MEMORY, TEXT_ZERO_BYTE, which no text has.
LsResult ls_text_lines_next(LsTextLines* lines, bool* is_end);

// Begins again with the first line.
void ls_text_lines_rewind(LsTextLines* lines);
void ls_text_lines_close(LsTextLines* lines);

// Sets the error to "path: line N: text" and returns the result of `message`.
LsResult ls_text_lines_fail(const LsTextLines* lines, LsMessage message, const char* text);

// Sets the error to that of a file that cannot be read: FILE_UNREADABLE, by errno.
LsResult ls_text_lines_fail_read(const LsTextLines* lines);

// Sets the error to that of a file that differs between two readings of it: FILE_CHANGED.
LsResult ls_text_lines_fail_change(const LsTextLines* lines);

// Reads up to `limit` numbers with space between them and space or the end behind; NaN and infinity
// are numbers. Returns how many there are before the first word that is none.
uint32_t ls_text_read_floats(const char* text, float* numbers, uint32_t limit);

// Words in a text.
uint32_t ls_text_count_words(const char* text);

// Copies the first word, cut to fit, with what no terminal should be sent replaced: for messages.
void ls_text_quote(char* quoted, size_t quoted_bytes, const char* text);

// The text behind its first word and the space around that.
const char* ls_text_skip_word(const char* text);

#endif
