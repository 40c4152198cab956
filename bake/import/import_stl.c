// import_stl.c - STL files, text and binary: three vertices a facet.
//
// A reader of our own: OpenMesh 9's merges vertices that are equal and leaves out the facets that
// then have equal corners, before any importer sees them, so numbers of facets shift. Here each
// facet has three vertices of its own. Normals, colours in attribute bytes and the names of solids
// are left; all solids of a file are one mesh.

#include "import.h"
#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define HEADER_BYTES 84 // 80 of any kind, then the number of facets
#define FACET_BYTES 50  // normal, three positions, two bytes of attributes

static LsResult fail_limit(const char* path, LsError* error)
{
    return ls_error_set(error, LS_ERROR_INPUT_LIMIT, "%s: more than %d facets; split the mesh",
                        path, INT_MAX / 3);
}

// Appends a mesh of so many facets with its indices set; positions are left to the caller.
static LsResult add_mesh(LsInput* input, const char* path, uint32_t facet_count, LsInputMesh** mesh,
                         LsError* error)
{
    *mesh = ls_input_add_plain_mesh(input, 3 * facet_count, facet_count);
    if (!*mesh)
        return ls_error_set(error, LS_ERROR_MEMORY, "%s: out of memory while reading it", path);
    for (uint32_t i = 0; i < 3 * facet_count; i++)
        (*mesh)->indices[i] = i;
    return LS_OK;
}

// ---- Binary -------------------------------------------------------------------------------------

static uint32_t get_u32(const uint8_t bytes[4])
{
    return (uint32_t)bytes[3] << 24 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[1] << 8 | bytes[0];
}

// Reads the facets behind the header; the file has been found to be as long as they are.
static LsResult import_binary(FILE* file, uint32_t facet_count, LsInput* input, const char* path,
                              LsError* error)
{
    if (facet_count == 0)
        return LS_OK;
    if (facet_count > INT_MAX / 3)
        return fail_limit(path, error);
    LsInputMesh* mesh;
    const LsResult result = add_mesh(input, path, facet_count, &mesh, error);
    for (uint32_t i = 0; result == LS_OK && i < facet_count; i++)
    {
        uint8_t facet[FACET_BYTES];
        if (fread(facet, sizeof facet, 1, file) != 1)
            return ls_error_set(error, LS_ERROR_FILE_READ,
                                "%s: facet %u cannot be read; try again when nobody writes it",
                                path, i);
        for (size_t k = 0; k < 9; k++)
        {
            const uint32_t word = get_u32(facet + 12 + 4 * k);
            memcpy(&mesh->positions[9 * (size_t)i + k], &word, sizeof word);
        }
    }
    return result;
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
    return ls_error_set(lines->error, LS_ERROR_INPUT_FORMAT,
                        "%s: line %llu: \"%s\" was expected here; export it again", lines->path,
                        (unsigned long long)lines->line_number, expected);
}

// Reads all facets. Without a mesh they are only counted.
static LsResult read_facets(LsTextLines* lines, LsInputMesh* mesh, uint64_t* facet_count)
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
            return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
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
            if (!ls_text_read_floats(rest, position))
                return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
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

static LsResult import_text(LsTextLines* lines, LsInput* input)
{
    uint64_t facet_count = 0;
    LsResult result = read_facets(lines, NULL, &facet_count);
    if (result != LS_OK || facet_count == 0)
        return result;
    if (facet_count > INT_MAX / 3)
        return fail_limit(lines->path, lines->error);
    LsInputMesh* mesh;
    result = add_mesh(input, lines->path, (uint32_t)facet_count, &mesh, lines->error);
    if (result != LS_OK)
        return result;
    ls_text_lines_rewind(lines);
    result = read_facets(lines, mesh, &facet_count);
    if (result == LS_OK && facet_count != mesh->triangle_count)
        result = ls_text_lines_fail_change(lines);
    return result;
}

// ---- Either -------------------------------------------------------------------------------------

static LsResult import_file(LsTextLines* lines, LsInput* input)
{
    // The size tells binary files, not the word "solid": many binary headers begin with it.
    uint8_t header[HEADER_BYTES] = {0};
    struct stat status;
    if (fstat(fileno(lines->file), &status))
        return ls_error_set(lines->error, LS_ERROR_FILE_READ, "%s: cannot be read: %s", lines->path,
                            strerror(errno));
    const uint64_t size = (uint64_t)status.st_size;
    const size_t header_bytes = fread(header, 1, sizeof header, lines->file);
    const uint32_t facet_count = get_u32(header + 80);
    const uint64_t binary_size = HEADER_BYTES + (uint64_t)facet_count * FACET_BYTES;
    if (header_bytes == HEADER_BYTES && size == binary_size)
        return import_binary(lines->file, facet_count, input, lines->path, lines->error);

    const bool is_text = !memchr(header, 0, header_bytes);
    if (!is_text && header_bytes == HEADER_BYTES)
        return ls_error_set(lines->error, LS_ERROR_INPUT_FORMAT,
                            "%s: %u facets in binary need %llu bytes, but the file has %llu; it "
                            "was cut short or is no STL file: copy or export it again",
                            lines->path, facet_count, (unsigned long long)binary_size,
                            (unsigned long long)size);
    ls_text_lines_rewind(lines);
    return import_text(lines, input);
}

LsResult ls_import_stl(LsInput* input, const char* path, LsError* error)
{
    LsTextLines lines = {.file = fopen(path, "rb"), .path = path, .error = error};
    if (!lines.file)
        return ls_error_set(error, LS_ERROR_FILE_READ, "%s: cannot be read: %s", path,
                            strerror(errno));
    const LsResult result = import_file(&lines, input);
    ls_text_lines_close(&lines);
    return result;
}
