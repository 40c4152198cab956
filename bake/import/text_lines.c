// text_lines.c - reads text files line by line, for the importers of text formats.

#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

LsResult ls_text_lines_fail(const LsTextLines* lines, LsMessage message, const char* text)
{
    return ls_error_set(lines->error, (int)message, "%s: line %llu: %s", lines->path,
                        (unsigned long long)lines->line_number, text);
}

LsResult ls_text_lines_fail_read(const LsTextLines* lines)
{
    return ls_error_set(lines->error, LS_MESSAGE_FILE_UNREADABLE, "%s: cannot be read: %s",
                        lines->path, strerror(errno));
}

LsResult ls_text_lines_fail_change(const LsTextLines* lines)
{
    return ls_error_set(lines->error, LS_MESSAGE_FILE_CHANGED,
                        "%s: changed while it was read; try again when nobody writes it",
                        lines->path);
}

static void note_progress(LsTextLines* lines)
{
    enum
    {
        STEP = 1 << 20
    };
    if (!lines->input || lines->size == 0 || lines->taken - lines->noted < STEP)
        return;
    lines->noted = lines->taken;
    const double done = (double)lines->taken / (double)lines->size;
    ls_input_note_progress(lines->input, (lines->pass + (done < 1.0 ? done : 1.0)) /
                                             (lines->pass_count ? lines->pass_count : 1));
}

static LsResult learn_size(LsTextLines* lines)
{
    struct stat status;
    if (fstat(fileno(lines->file), &status))
        return ls_text_lines_fail_read(lines);
    lines->size = (uint64_t)status.st_size;
    return LS_OK;
}

// Takes the byte order mark of UTF-8 from the first line, and says by name that UTF-16 is not read.
static LsResult check_mark(LsTextLines* lines, size_t* length)
{
    const uint8_t* bytes = (const uint8_t*)lines->part;
    if (*length >= 2 &&
        ((bytes[0] == 0xFE && bytes[1] == 0xFF) || (bytes[0] == 0xFF && bytes[1] == 0xFE)))
        return ls_text_lines_fail(lines, LS_MESSAGE_TEXT_ZERO_BYTE,
                                  "the text is in UTF-16; save it as UTF-8");
    if (*length >= 3 && bytes[0] == 0xEF && bytes[1] == 0xBB && bytes[2] == 0xBF)
    {
        *length -= 3;
        memmove(lines->part, lines->part + 3, *length + 1);
    }
    return LS_OK;
}

LsResult ls_text_lines_next(LsTextLines* lines, bool* is_end)
{
    size_t length = 0;
    for (;;)
    {
        errno = 0;
        ssize_t got = getline(&lines->part, &lines->part_capacity, lines->file);
        if (got < 0)
        {
            if (errno == ENOMEM)
                return ls_text_lines_fail(lines, LS_MESSAGE_OUT_OF_MEMORY, "out of memory");
            if (ferror(lines->file))
                return ls_text_lines_fail_read(lines);
            *is_end = length == 0;
            return LS_OK;
        }
        size_t part_length = (size_t)got;
        lines->line_number++;
        lines->taken += part_length;
        if (lines->line_number == 1)
        {
            LsResult result = learn_size(lines);
            if (result == LS_OK)
                result = check_mark(lines, &part_length);
            if (result != LS_OK)
                return result;
        }
        note_progress(lines);
        if (memchr(lines->part, 0, part_length))
            return ls_text_lines_fail(lines, LS_MESSAGE_TEXT_ZERO_BYTE,
                                      "holds a zero byte, so the file is no text; export it again");
        if (length + part_length + 1 > lines->line_capacity)
        {
            const size_t capacity = 2 * (length + part_length + 1);
            char* moved = realloc(lines->line, capacity);
            if (!moved)
                return ls_text_lines_fail(lines, LS_MESSAGE_OUT_OF_MEMORY, "out of memory");
            lines->line = moved;
            lines->line_capacity = capacity;
        }
        memcpy(lines->line + length, lines->part, part_length + 1);
        length += part_length;

        while (length && isspace((unsigned char)lines->line[length - 1]))
            lines->line[--length] = 0;
        *is_end = false;
        // A comment ends with its line: paths of Windows end in a backslash too.
        if (!lines->joins_lines || length == 0 || lines->line[length - 1] != '\\' ||
            lines->line[strspn(lines->line, " \t")] == '#')
            return LS_OK;
        lines->line[length - 1] = ' ';
    }
}

void ls_text_lines_rewind(LsTextLines* lines)
{
    rewind(lines->file);
    lines->line_number = lines->taken = lines->noted = 0;
    lines->pass++;
}

void ls_text_lines_close(LsTextLines* lines)
{
    if (lines->file)
        fclose(lines->file);
    free(lines->line);
    free(lines->part);
}

uint32_t ls_text_read_floats(const char* text, float* numbers, uint32_t limit)
{
    for (uint32_t i = 0; i < limit; i++)
    {
        char* end;
        numbers[i] = strtof(text, &end);
        if (end == text || (*end && !isspace((unsigned char)*end)))
            return i;
        text = end;
    }
    return limit;
}

uint32_t ls_text_count_words(const char* text)
{
    uint32_t count = 0;
    while (isspace((unsigned char)*text))
        text++;
    for (; *text; text = ls_text_skip_word(text))
        count++;
    return count;
}

void ls_text_quote(char* quoted, size_t quoted_bytes, const char* text)
{
    size_t length = 0;
    for (; length + 1 < quoted_bytes && *text && !isspace((unsigned char)*text); text++)
        quoted[length++] = iscntrl((unsigned char)*text) ? '?' : *text;
    quoted[length] = 0;
}

const char* ls_text_skip_word(const char* text)
{
    while (isspace((unsigned char)*text))
        text++;
    while (*text && !isspace((unsigned char)*text))
        text++;
    while (isspace((unsigned char)*text))
        text++;
    return text;
}
