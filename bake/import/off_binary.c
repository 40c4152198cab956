// off_binary.c - the records of binary OFF files: words of four bytes, the highest first.
//
// As Geomview has it: three counts; per vertex its floats, colours always four; per face the number
// of its corners, the corners, the number of the parts of its colour, and those as floats.

#include "off_binary.h"

#include "byte_reader.h"

#include <stdlib.h>
#include <string.h>

static bool read_word(LsByteReader* reader, uint32_t* word)
{
    uint8_t bytes[4];
    if (!ls_byte_reader_copy(reader, bytes, sizeof bytes))
        return false;
    *word =
        (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
    return true;
}

static bool read_floats(LsByteReader* reader, float* numbers, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
    {
        uint32_t word;
        if (!read_word(reader, &word))
            return false;
        memcpy(&numbers[i], &word, sizeof word);
    }
    return true;
}

static LsResult fail_cut(const LsOff* off, const LsByteReader* reader)
{
    const LsResult result = ls_byte_reader_check(reader);
    if (result != LS_OK)
        return result;
    return ls_error_set(
        off->error, LS_MESSAGE_OFF_CUT,
        "%s: ends before its %llu vertices and %llu faces do; it was cut short: copy "
        "or export it again",
        off->path, (unsigned long long)off->vertex_count, (unsigned long long)off->face_count);
}

static LsResult read_counts(LsOff* off, LsByteReader* reader)
{
    uint32_t counts[3];
    for (int i = 0; i < 3; i++)
        if (!read_word(reader, &counts[i]))
            return fail_cut(off, reader);
    if (off->mesh && (off->vertex_count != counts[0] || off->face_count != counts[1]))
        return ls_byte_reader_fail_change(reader);
    off->vertex_count = counts[0];
    off->face_count = counts[1];
    return ls_off_check_counts(off);
}

static LsResult read_face(LsOff* off, LsByteReader* reader, uint64_t face)
{
    const uint64_t first_triangle = off->triangle_count;
    uint32_t count = 0;
    if (!read_word(reader, &count))
        return fail_cut(off, reader);
    ls_off_begin_face(off, face, count);
    for (uint32_t i = 0; i < count; i++)
    {
        uint32_t word = 0;
        if (!read_word(reader, &word))
            return fail_cut(off, reader);
        const LsResult result = ls_off_add_corner(off, face, i, word);
        if (result != LS_OK)
            return result;
    }
    float color[4];
    if (!read_word(reader, &count))
        return fail_cut(off, reader);
    if (count > 4)
        return ls_off_fail_face(off, LS_MESSAGE_OFF_NUMBER, face,
                                "its colour has more than four parts; export it again");
    if (!read_floats(reader, color, count))
        return fail_cut(off, reader);
    if (count == 1 || count == 2)
    {
        const LsResult result = ls_input_warn(
            off->input, off->error, LS_MESSAGE_OFF_REST,
            "%s: colours of faces that are numbers of a list are left out", off->path);
        if (result != LS_OK)
            return result;
        count = 0;
    }
    ls_off_color_face(off, face, first_triangle, color, count);
    return LS_OK;
}

static LsResult read_pass(LsOff* off, LsByteReader* reader, uint64_t header_bytes)
{
    LsResult result = ls_byte_reader_begin(reader);
    if (result == LS_OK && !ls_byte_reader_skip(reader, header_bytes))
        result = fail_cut(off, reader);
    if (result == LS_OK)
        result = read_counts(off, reader);
    const uint32_t numbers_count =
        3 + (off->has_normals ? 3 : 0) + (off->has_colors ? 4 : 0) + (off->has_texcoords ? 2 : 0);
    for (uint64_t i = 0; result == LS_OK && i < off->vertex_count; i++)
    {
        float numbers[12];
        if (!read_floats(reader, numbers, numbers_count))
            return fail_cut(off, reader);
        ls_off_add_vertex(off, i, numbers, 4);
    }
    for (uint64_t i = 0; result == LS_OK && i < off->face_count; i++)
        result = read_face(off, reader, i);
    return result;
}

LsResult ls_off_read_binary(LsOff* off, uint64_t header_bytes)
{
    LsByteReader reader = {.file = fopen(off->path, "rb"),
                           .path = off->path,
                           .error = off->error,
                           .input = off->input,
                           .pass_count = 2};
    LsResult result = read_pass(off, &reader, header_bytes);
    if (result == LS_OK && ls_byte_reader_left(&reader))
        result = ls_input_warn(off->input, off->error, LS_MESSAGE_OFF_REST,
                               "%s: more stands behind its last face; it is left out", off->path);
    if (result == LS_OK)
        result = ls_off_create_mesh(off);
    if (result == LS_OK && off->mesh)
    {
        reader.pass = 1;
        result = read_pass(off, &reader, header_bytes);
        if (result == LS_OK && off->triangle_count != off->mesh->triangle_count)
            result = ls_byte_reader_fail_change(&reader);
    }
    ls_byte_reader_close(&reader);
    return result;
}
