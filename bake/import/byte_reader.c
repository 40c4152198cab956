// byte_reader.c - reads a file once from front to back, as bytes or as words of text.

#include "byte_reader.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

LsResult ls_byte_reader_begin(LsByteReader* reader)
{
    struct stat status;
    if (!reader->file || fstat(fileno(reader->file), &status) ||
        fseeko(reader->file, 0, SEEK_SET) != 0)
        return ls_error_set(reader->error, LS_MESSAGE_FILE_UNREADABLE, "%s: cannot be read: %s",
                            reader->path, strerror(errno));
    // The buffer here is all that is needed.
    setvbuf(reader->file, NULL, _IONBF, 0);
    reader->size = (uint64_t)status.st_size;
    reader->taken = 0;
    reader->at = reader->end = 0;
    reader->line = reader->next_line = 1;
    return LS_OK;
}

void ls_byte_reader_close(LsByteReader* reader)
{
    if (reader->file)
        fclose(reader->file);
    reader->file = NULL;
}

uint64_t ls_byte_reader_left(const LsByteReader* reader)
{
    const uint64_t behind_buffer = reader->size > reader->taken ? reader->size - reader->taken : 0;
    return behind_buffer + (reader->end - reader->at);
}

// Fills the buffer again; false behind the last byte.
static bool fill(LsByteReader* reader)
{
    reader->at = 0;
    reader->end = fread(reader->buffer, 1, sizeof reader->buffer, reader->file);
    reader->taken += reader->end;
    if (reader->end == 0 && ferror(reader->file))
        reader->is_failed = true;
    // Each mebibyte is often enough.
    if (reader->input && reader->size && reader->taken % (1u << 20) < sizeof reader->buffer)
    {
        const double done = (double)reader->taken / (double)reader->size;
        const double count = reader->pass_count ? reader->pass_count : 1;
        ls_input_note_progress(reader->input, (reader->pass + (done < 1.0 ? done : 1.0)) / count);
    }
    return reader->end > 0;
}

int ls_byte_reader_next(LsByteReader* reader)
{
    if (reader->at == reader->end && !fill(reader))
        return -1;
    return reader->buffer[reader->at++];
}

bool ls_byte_reader_copy(LsByteReader* reader, void* bytes, size_t count)
{
    uint8_t* target = bytes;
    while (count)
    {
        if (reader->at == reader->end && !fill(reader))
            return false;
        const size_t there = reader->end - reader->at;
        const size_t part = count < there ? count : there;
        memcpy(target, reader->buffer + reader->at, part);
        reader->at += part;
        target += part;
        count -= part;
    }
    return true;
}

bool ls_byte_reader_skip(LsByteReader* reader, uint64_t count)
{
    while (count)
    {
        if (reader->at == reader->end && !fill(reader))
            return false;
        const size_t there = reader->end - reader->at;
        const size_t part = count < there ? (size_t)count : there;
        reader->at += part;
        count -= part;
    }
    return true;
}

static bool is_space(int byte)
{
    return byte == ' ' || (byte >= '\t' && byte <= '\r');
}

size_t ls_byte_reader_word(LsByteReader* reader, char word[LS_WORD_BYTES])
{
    int byte;
    do
    {
        byte = ls_byte_reader_next(reader);
        reader->next_line += byte == '\n';
    } while (is_space(byte));
    size_t length = 0;
    reader->line = reader->next_line;
    while (byte >= 0 && !is_space(byte))
    {
        if (length < LS_WORD_BYTES)
            word[length++] = (char)byte;
        byte = ls_byte_reader_next(reader);
    }
    reader->next_line += byte == '\n';
    word[length < LS_WORD_BYTES ? length : LS_WORD_BYTES - 1] = 0;
    return length;
}

LsResult ls_byte_reader_check(const LsByteReader* reader)
{
    return reader->is_failed ? ls_error_set(reader->error, LS_MESSAGE_FILE_UNREADABLE,
                                            "%s: cannot be read: %s", reader->path, strerror(errno))
                             : LS_OK;
}

LsResult ls_byte_reader_fail_change(const LsByteReader* reader)
{
    return ls_error_set(reader->error, LS_MESSAGE_FILE_CHANGED,
                        "%s: changed while it was read; try again when nobody writes it",
                        reader->path);
}
