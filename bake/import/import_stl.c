// import_stl.c - STL files, text and binary: three vertices a facet.
//
// A reader of our own: OpenMesh 9's merges vertices that are equal and leaves out the facets that
// then have equal corners, before any importer sees them, so numbers of facets shift. Here each
// facet has three vertices of its own. Normals of facets are left: they say what the corners say.
// All solids of a file are one mesh, named after the first.
//
// The size tells binary files, not the word "solid": many binary headers begin with it.

#include "byte_reader.h"
#include "import.h"
#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define HEADER_BYTES 84 // 80 of any kind, then the number of facets
#define FACET_BYTES 50  // normal, three positions, two bytes of attributes

// Appends a mesh of so many facets with its indices set; positions are left to the caller.
static LsResult add_mesh(LsInput* input, const char* path, uint64_t facet_count, LsInputMesh** mesh,
                         LsError* error)
{
    if (facet_count > INT_MAX / 3)
        return ls_error_set(error, LS_MESSAGE_LIMIT_MESH, "%s: more than %d facets; split the mesh",
                            path, INT_MAX / 3);
    // Positions of three vertices, three indices and a material.
    const LsResult result = ls_input_reserve(input, path, facet_count * 52, facet_count, error);
    if (result != LS_OK)
        return result;
    *mesh = ls_input_add_plain_mesh(input, 3 * (uint32_t)facet_count, (uint32_t)facet_count);
    if (!*mesh)
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory while reading it",
                            path);
    for (uint32_t i = 0; i < 3 * (uint32_t)facet_count; i++)
        (*mesh)->indices[i] = i;
    return LS_OK;
}

// ---- Binary -------------------------------------------------------------------------------------

static uint32_t get_u32(const uint8_t bytes[4])
{
    return (uint32_t)bytes[3] << 24 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[1] << 8 | bytes[0];
}

// Reads the facets behind the header; the file has been found to be no shorter than they are.
static LsResult read_binary(LsByteReader* reader, uint32_t facet_count, LsInput* input)
{
    LsInputMesh* mesh = NULL;
    LsResult result = add_mesh(input, reader->path, facet_count, &mesh, reader->error);
    if (result != LS_OK)
        return result;
    bool has_attributes = false;
    for (uint32_t i = 0; i < facet_count; i++)
    {
        uint8_t facet[FACET_BYTES];
        if (!ls_byte_reader_copy(reader, facet, sizeof facet))
        {
            result = ls_byte_reader_check(reader);
            return result != LS_OK ? result : ls_byte_reader_fail_change(reader);
        }
        for (size_t k = 0; k < 9; k++)
        {
            const uint32_t word = get_u32(facet + 12 + 4 * k);
            memcpy(&mesh->positions[9 * (size_t)i + k], &word, sizeof word);
        }
        has_attributes |= facet[48] || facet[49];
    }
    return has_attributes
               ? ls_input_warn(input, reader->error, LS_MESSAGE_STL_COLORS,
                               "%s: the attribute bytes of its facets, where some programs store "
                               "colours, are left out; convert it to PLY to keep colours",
                               reader->path)
               : LS_OK;
}

static LsResult import_binary(LsByteReader* reader, const uint8_t* header, LsInput* input)
{
    const uint32_t facet_count = get_u32(header + 80);
    const uint64_t expected = HEADER_BYTES + (uint64_t)facet_count * FACET_BYTES;
    if (reader->size < expected || (facet_count == 0 && reader->size > expected))
        return ls_error_set(reader->error, LS_MESSAGE_STL_SIZE,
                            "%s: %u facets in binary need %llu bytes, but the file has %llu; it "
                            "was cut short or is no STL file: copy or export it again",
                            reader->path, facet_count, (unsigned long long)expected,
                            (unsigned long long)reader->size);
    LsResult result = LS_OK;
    if (reader->size > expected)
        result =
            ls_input_warn(input, reader->error, LS_MESSAGE_STL_TRAILING,
                          "%s: %llu bytes stand behind the %u facets that its header counts; "
                          "they are left out",
                          reader->path, (unsigned long long)(reader->size - expected), facet_count);
    return result == LS_OK && facet_count ? read_binary(reader, facet_count, input) : result;
}

// ---- Text ---------------------------------------------------------------------------------------

// The lines of a facet in their order.
static const char* const facet_lines[] = {
    "facet", "outer loop", "vertex", "vertex", "vertex", "endloop", "endfacet",
};
#define FACET_LINES (sizeof facet_lines / sizeof *facet_lines)
#define FIRST_VERTEX_LINE 2

// Whether the line begins with the words, in either case and with any space between; what follows
// them is at *rest.
static bool begins_with(const char* line, const char* words, const char** rest)
{
    while (*words)
    {
        const size_t length = strcspn(words, " ");
        if (strncasecmp(line, words, length) ||
            (line[length] && !isspace((unsigned char)line[length])))
            return false;
        line = ls_text_skip_word(line);
        words += length + (words[length] == ' ');
    }
    *rest = line;
    return true;
}

static LsResult fail_line(const LsTextLines* lines, const char* expected)
{
    return ls_error_set(lines->error, LS_MESSAGE_STL_LINE,
                        "%s: line %llu: \"%s\" was expected here; export it again", lines->path,
                        (unsigned long long)lines->line_number, expected);
}

// Reads all facets. Without a mesh they are only counted, and the name of the first solid is kept.
static LsResult read_facets(LsTextLines* lines, LsInputMesh* mesh, char** name,
                            uint64_t* facet_count)
{
    bool is_inside = false; // of a solid
    size_t step = 0;        // line of the facet
    *facet_count = 0;
    for (;;)
    {
        bool is_end = false;
        const LsResult result = ls_text_lines_next(lines, &is_end);
        if (result != LS_OK)
            return result;
        if (is_end && is_inside)
            return ls_text_lines_fail(lines, LS_MESSAGE_STL_CUT,
                                      "the last line, but no endsolid; the file was cut short: "
                                      "copy or export it again");
        if (is_end)
            return LS_OK;
        const char* line = lines->line;
        while (isspace((unsigned char)*line))
            line++;
        const char* rest;
        if (!*line)
            continue;
        if (!is_inside)
        {
            if (!begins_with(line, "solid", &rest))
                return fail_line(lines, "solid");
            is_inside = true;
            if (!mesh && !*name && *rest && !(*name = strdup(rest)))
                return ls_text_lines_fail(lines, LS_MESSAGE_OUT_OF_MEMORY, "out of memory");
            continue;
        }
        if (step == 0 && begins_with(line, "endsolid", &rest))
        {
            is_inside = false;
            continue;
        }
        if (!begins_with(line, facet_lines[step], &rest))
            return fail_line(lines, facet_lines[step]);
        float position[3];
        if (!strcmp(facet_lines[step], "vertex"))
        {
            if (ls_text_read_floats(rest, position, 3) < 3)
                return ls_text_lines_fail(lines, LS_MESSAGE_STL_NUMBER,
                                          "a vertex needs three numbers; export it again");
            if (mesh && *facet_count >= mesh->triangle_count)
                return ls_text_lines_fail_change(lines);
            if (mesh)
                memcpy(&mesh->positions[9 * *facet_count + 3 * (step - FIRST_VERTEX_LINE)],
                       position, sizeof position);
        }
        step = (step + 1) % FACET_LINES;
        *facet_count += step == 0;
    }
}

static LsResult import_text(LsTextLines* lines, LsInput* input, char** name)
{
    uint64_t facet_count = 0;
    LsResult result = read_facets(lines, NULL, name, &facet_count);
    if (result != LS_OK || facet_count == 0)
        return result;
    LsInputMesh* mesh = NULL;
    result = add_mesh(input, lines->path, facet_count, &mesh, lines->error);
    if (result != LS_OK)
        return result;
    mesh->name = *name;
    *name = NULL;
    ls_text_lines_rewind(lines);
    result = read_facets(lines, mesh, name, &facet_count);
    if (result == LS_OK && facet_count != mesh->triangle_count)
        result = ls_text_lines_fail_change(lines);
    return result;
}

// ---- Either -------------------------------------------------------------------------------------

// Whether a file with such a header is binary. Text has no zero byte; a binary header of 80 bytes
// without one is followed by a count that has one, or that fits the size.
static bool is_binary(const uint8_t* header, size_t header_bytes, uint64_t size)
{
    if (header_bytes < HEADER_BYTES)
        return false;
    return size == HEADER_BYTES + (uint64_t)get_u32(header + 80) * FACET_BYTES ||
           memchr(header, 0, HEADER_BYTES);
}

LsResult ls_import_stl(LsInput* input, const char* path, LsError* error)
{
    uint8_t header[HEADER_BYTES] = {0};
    LsByteReader reader = {.file = fopen(path, "rb"), .path = path, .error = error, .input = input};
    LsResult result = ls_byte_reader_begin(&reader);
    const bool is_long = result == LS_OK && ls_byte_reader_copy(&reader, header, sizeof header);
    const bool reads_binary =
        result == LS_OK && is_binary(header, is_long ? sizeof header : 0, reader.size);
    if (reads_binary)
        result = import_binary(&reader, header, input);
    ls_byte_reader_close(&reader);
    if (result != LS_OK || reads_binary)
        return result;

    LsTextLines lines = {
        .file = fopen(path, "r"), .path = path, .error = error, .input = input, .pass_count = 2};
    char* name = NULL;
    result = lines.file ? import_text(&lines, input, &name) : ls_text_lines_fail_read(&lines);
    free(name);
    ls_text_lines_close(&lines);
    return result;
}
