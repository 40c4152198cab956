// import_off.c - OFF files in text: positions and polygons.
//
// A reader of our own: OpenMesh 9's reads a stream of words, so a comment or the colour of a face
// shifts all that follows; counts behind "OFF" on its line give an empty mesh without a word; and a
// word that is no number leaves it adding the same vertex as often as the counts say.
//
// A vertex and a face are a line each, as every known writer does it. Then what stands behind the
// position (normals, colours, texture coordinates) or behind the corners (colours) needs no
// understanding, and the number of lines tells a file that is laid out otherwise.

#include "import.h"
#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct Counts
{
    uint64_t vertices;
    uint64_t faces;
} Counts;

// Reads on to the next line that holds more than space and a comment; *text is its first word.
// *is_end as ls_text_lines_next sets it.
static LsResult find_line(LsTextLines* lines, const char** text, bool* is_end)
{
    for (;;)
    {
        const LsResult result = ls_text_lines_next(lines, is_end);
        if (result != LS_OK || *is_end)
            return result;
        char* line = lines->line;
        line[strcspn(line, "#")] = 0;
        while (isspace((unsigned char)*line))
            line++;
        *text = line;
        if (*line)
            return LS_OK;
    }
}

// ---- Header -------------------------------------------------------------------------------------

// Reads a number that is not negative and moves *text behind it. What does not fit is the largest.
static bool read_count(const char** text, uint64_t* count)
{
    char* end;
    if (!isdigit((unsigned char)**text))
        return false;
    *count = strtoull(*text, &end, 10);
    if (*end && !isspace((unsigned char)*end))
        return false;
    *text = ls_text_skip_word(*text);
    return true;
}

// Takes OFF and what says that more stands behind positions: ST, C, N. The line goes on at *text.
static LsResult check_keyword(const LsTextLines* lines, const char** text)
{
    const size_t length = strcspn(*text, " \t");
    const char* word = *text + strspn(*text, "STCN");
    const bool is_other = *word == '4' || *word == 'n';
    word += strspn(word, "4n");
    if (strncmp(word, "OFF", 3) || word + 3 != *text + length)
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                  "not an OFF file: it does not begin with \"OFF\"");
    *text = ls_text_skip_word(*text);
    if (is_other)
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_UNSUPPORTED,
                                  "points of other than three coordinates; export it as plain OFF");
    if (!strncmp(*text, "BINARY", 6))
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_UNSUPPORTED,
                                  "binary OFF; export it as text");
    return LS_OK;
}

static LsResult read_header(LsTextLines* lines, Counts* counts)
{
    const char* text = "";
    bool is_end = false;
    LsResult result = find_line(lines, &text, &is_end);
    if (result == LS_OK)
        result = check_keyword(lines, &text);
    if (result == LS_OK && !*text)
        result = find_line(lines, &text, &is_end);
    if (result != LS_OK)
        return result;
    if (is_end || !read_count(&text, &counts->vertices) || !read_count(&text, &counts->faces))
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                  "the header needs the numbers of vertices and faces; export it "
                                  "again");
    return LS_OK;
}

// The counts against what the file can hold at most.
static LsResult check_counts(const LsTextLines* lines, const Counts* counts)
{
    // "0 0 0" and "3 0 0 0" with their line ends; the last may lack it.
    enum
    {
        VERTEX_BYTES = 6,
        FACE_BYTES = 8
    };
    struct stat status;
    if (fstat(fileno(lines->file), &status))
        return ls_error_set(lines->error, LS_ERROR_FILE_READ, "%s: cannot be read: %s", lines->path,
                            strerror(errno));
    const uint64_t size = (uint64_t)status.st_size;
    if (counts->vertices > size || counts->faces > size ||
        counts->vertices * VERTEX_BYTES + counts->faces * FACE_BYTES > size + 1)
        return ls_error_set(lines->error, LS_ERROR_INPUT_FORMAT,
                            "%s: line %llu: %llu vertices and %llu faces do not fit into the %llu "
                            "bytes of the file; it was cut short: copy or export it again",
                            lines->path, (unsigned long long)lines->line_number,
                            (unsigned long long)counts->vertices, (unsigned long long)counts->faces,
                            (unsigned long long)size);
    if (counts->vertices > INT_MAX)
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_LIMIT,
                                  "more than 2147483647 vertices; split the mesh");
    return LS_OK;
}

// ---- Records ------------------------------------------------------------------------------------

static LsResult fail_cut(const LsTextLines* lines, const Counts* counts)
{
    return ls_error_set(lines->error, LS_ERROR_INPUT_FORMAT,
                        "%s: ends behind line %llu with fewer than %llu vertices and %llu faces, "
                        "one a line; it was cut short: copy or export it again",
                        lines->path, (unsigned long long)lines->line_number,
                        (unsigned long long)counts->vertices, (unsigned long long)counts->faces);
}

// Reads the corner count of a face and moves *text to the first corner. It is no larger than the
// line has room for.
static LsResult read_corner_count(const LsTextLines* lines, const char** text, uint64_t* count)
{
    if (!read_count(text, count))
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                  "a face does not begin with its number of corners; export it "
                                  "again, a vertex and a face a line");
    if (*count < 3)
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                  "a face of fewer than three corners; remove it or export again");
    if (*count > strlen(*text) / 2 + 1)
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                  "a face with fewer corners than it counts; export it again");
    return LS_OK;
}

// First pass, behind the header: how many triangles there are, and that nothing is left over.
static LsResult count_triangles(LsTextLines* lines, const Counts* counts, uint32_t* triangle_count)
{
    uint64_t triangles = 0;
    const char* text;
    bool is_end = false;
    for (uint64_t i = 0; i < counts->vertices + counts->faces; i++)
    {
        uint64_t corners = 0;
        LsResult result = find_line(lines, &text, &is_end);
        if (result == LS_OK && is_end)
            return fail_cut(lines, counts);
        if (result == LS_OK && i >= counts->vertices)
        {
            result = read_corner_count(lines, &text, &corners);
            triangles += corners - 2;
        }
        if (result != LS_OK)
            return result;
    }
    const LsResult result = find_line(lines, &text, &is_end);
    if (result != LS_OK)
        return result;
    if (!is_end)
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                  "more lines than the header counts vertices and faces; export it "
                                  "again, a vertex and a face a line");
    if (triangles >= LS_NONE)
        return ls_error_set(lines->error, LS_ERROR_INPUT_LIMIT,
                            "%s: more than 4294967294 triangles; split the mesh", lines->path);
    *triangle_count = (uint32_t)triangles;
    return LS_OK;
}

static LsResult read_corner(const LsTextLines* lines, const char** text, uint32_t vertex_count,
                            uint32_t* vertex)
{
    char* end;
    const long long number = strtoll(*text, &end, 10);
    if (end == *text || (*end && !isspace((unsigned char)*end)))
        return ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                  "a corner is missing or no number; export it again");
    if (number < 0 || number >= vertex_count)
        return ls_error_set(lines->error, LS_ERROR_INPUT_INDEX,
                            "%s: line %llu: a face names vertex %lld, but the file has %u "
                            "vertices, numbered from 0; export it again",
                            lines->path, (unsigned long long)lines->line_number, number,
                            vertex_count);
    *vertex = (uint32_t)number;
    *text = ls_text_skip_word(*text);
    return LS_OK;
}

// Fans the face of the line at `text` into triangles from *triangle on.
static LsResult read_face(const LsTextLines* lines, const char* text, LsInputMesh* mesh,
                          uint32_t* triangle)
{
    uint64_t corner_count = 0;
    LsResult result = read_corner_count(lines, &text, &corner_count);
    if (result == LS_OK && corner_count - 2 > mesh->triangle_count - *triangle)
        result = ls_text_lines_fail_change(lines);
    uint32_t corners[3] = {0};
    for (uint64_t i = 0; result == LS_OK && i < corner_count; i++)
    {
        corners[1] = corners[2];
        result = read_corner(lines, &text, mesh->vertex_count, &corners[i == 0 ? 0 : 2]);
        if (result == LS_OK && i >= 2)
        {
            memcpy(&mesh->indices[3 * (size_t)*triangle], corners, sizeof corners);
            *triangle += 1;
        }
    }
    return result;
}

// Second pass, behind the header: fills the mesh.
static LsResult read_records(LsTextLines* lines, const Counts* counts, LsInputMesh* mesh)
{
    uint32_t triangle = 0;
    for (uint64_t i = 0; i < counts->vertices + counts->faces; i++)
    {
        const char* text;
        bool is_end = false;
        LsResult result = find_line(lines, &text, &is_end);
        if (result == LS_OK && is_end)
            result = ls_text_lines_fail_change(lines);
        else if (result == LS_OK && i >= counts->vertices)
            result = read_face(lines, text, mesh, &triangle);
        else if (result == LS_OK && !ls_text_read_floats(text, &mesh->positions[3 * i]))
            result = ls_text_lines_fail(lines, LS_ERROR_INPUT_FORMAT,
                                        "a vertex needs three numbers; export it again, a vertex "
                                        "a line");
        if (result != LS_OK)
            return result;
    }
    return triangle == mesh->triangle_count ? LS_OK : ls_text_lines_fail_change(lines);
}

static LsResult import_mesh(LsTextLines* lines, LsInput* input)
{
    Counts counts = {0};
    uint32_t triangle_count = 0;
    LsResult result = read_header(lines, &counts);
    if (result == LS_OK)
        result = check_counts(lines, &counts);
    if (result == LS_OK)
        result = count_triangles(lines, &counts, &triangle_count);
    if (result != LS_OK || triangle_count == 0)
        return result;

    LsInputMesh* mesh = ls_input_add_plain_mesh(input, (uint32_t)counts.vertices, triangle_count);
    if (!mesh)
        return ls_error_set(lines->error, LS_ERROR_MEMORY, "%s: out of memory while reading it",
                            lines->path);
    ls_text_lines_rewind(lines);
    Counts again = {0};
    result = read_header(lines, &again);
    if (result == LS_OK && (again.vertices != counts.vertices || again.faces != counts.faces))
        result = ls_text_lines_fail_change(lines);
    return result == LS_OK ? read_records(lines, &counts, mesh) : result;
}

LsResult ls_import_off(LsInput* input, const char* path, LsError* error)
{
    LsTextLines lines = {.file = fopen(path, "r"), .path = path, .error = error};
    if (!lines.file)
        return ls_error_set(error, LS_ERROR_FILE_READ, "%s: cannot be read: %s", path,
                            strerror(errno));
    const LsResult result = import_mesh(&lines, input);
    ls_text_lines_close(&lines);
    return result;
}
