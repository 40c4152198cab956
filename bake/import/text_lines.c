// text_lines.c - reads text files line by line, for the importers of text formats.

#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

LsResult ls_text_lines_fail(const LsTextLines* lines, LsResult result, const char* text)
{
    return ls_error_set(lines->error, result, "%s: line %llu: %s", lines->path,
                        (unsigned long long)lines->line_number, text);
}

LsResult ls_text_lines_fail_change(const LsTextLines* lines)
{
    return ls_error_set(lines->error, LS_ERROR_FILE_READ,
                        "%s: changed while it was read; try again when nobody writes it",
                        lines->path);
}

LsResult ls_text_lines_next(LsTextLines* lines, bool* is_end)
{
    size_t length = 0;
    for (;;)
    {
        errno = 0;
        const ssize_t part_length = getline(&lines->part, &lines->part_capacity, lines->file);
        if (part_length < 0)
        {
            if (errno == ENOMEM)
                return ls_text_lines_fail(lines, LS_ERROR_MEMORY, "out of memory");
            if (ferror(lines->file))
                return ls_error_set(lines->error, LS_ERROR_FILE_READ, "%s: cannot be read: %s",
                                    lines->path, strerror(errno));
            *is_end = length == 0;
            return LS_OK;
        }
        lines->line_number++;
        if (memchr(lines->part, 0, (size_t)part_length))
            return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                      "holds a zero byte, so the file is no text; export it again");
        if (length + (size_t)part_length + 1 > lines->line_capacity)
        {
            const size_t capacity = 2 * (length + (size_t)part_length + 1);
            char* moved = realloc(lines->line, capacity);
            if (!moved)
                return ls_text_lines_fail(lines, LS_ERROR_MEMORY, "out of memory");
            lines->line = moved;
            lines->line_capacity = capacity;
        }
        memcpy(lines->line + length, lines->part, (size_t)part_length + 1);
        length += (size_t)part_length;

        while (length && isspace((unsigned char)lines->line[length - 1]))
            lines->line[--length] = 0;
        *is_end = false;
        if (!lines->joins_lines || length == 0 || lines->line[length - 1] != '\\')
            return LS_OK;
        lines->line[length - 1] = ' ';
    }
}

void ls_text_lines_rewind(LsTextLines* lines)
{
    rewind(lines->file);
    lines->line_number = 0;
}

void ls_text_lines_close(LsTextLines* lines)
{
    if (lines->file)
        fclose(lines->file);
    free(lines->line);
    free(lines->part);
}

bool ls_text_read_floats(const char* text, float numbers[3])
{
    for (int i = 0; i < 3; i++)
    {
        char* end;
        numbers[i] = strtof(text, &end);
        if (end == text || (*end && !isspace((unsigned char)*end)))
            return false;
        text = end;
    }
    return true;
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
