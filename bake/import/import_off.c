// import_off.c - OFF files, text and binary: positions and polygons, normals, colours, texture
// coordinates.
//
// A reader of our own: OpenMesh 9's reads a stream of words, so a comment or the colour of a face
// shifts all that follows; counts behind "OFF" on its line give an empty mesh without a word; and a
// word that is no number leaves it adding the same vertex as often as the counts say.
//
// Text files mostly have a vertex and a face a line, and where the number of lines says so, the rest
// of a line tells what else the record has: colours of three numbers or four, colours of faces. Where
// records share lines or go over several, words are counted: vertices have what the header names,
// colours four numbers, faces have no colour, and nothing may be left over. Colours are whole numbers
// up to 255 if one is above 1, otherwise fractions; they are sRGB. v = 0 is at the bottom of images.

#include "import.h"
#include "off_binary.h"
#include "off_mesh.h"
#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// A text file being read.
typedef struct OffText
{
    LsTextLines lines;
    LsOff off;
    const char* rest;      // of the line, behind the last word taken
    bool is_free;          // records are not a line each
    bool is_binary;        // as the header says
    uint64_t header_lines; // up to and with the counts
} OffText;

static LsResult fail(const OffText* text, LsMessage message, const char* what)
{
    return ls_text_lines_fail(&text->lines, message, what);
}

static LsResult fail_cut(const OffText* text)
{
    return ls_error_set(
        text->lines.error, LS_MESSAGE_OFF_CUT,
        "%s: ends behind line %llu with fewer than %llu vertices and %llu faces; it "
        "was cut short: copy or export it again",
        text->lines.path, (unsigned long long)text->lines.line_number,
        (unsigned long long)text->off.vertex_count, (unsigned long long)text->off.face_count);
}

// ---- Words --------------------------------------------------------------------------------------

// Goes to the next line that holds more than space and a comment; text->rest is its first word.
static LsResult find_line(OffText* text, bool* is_end)
{
    for (;;)
    {
        const LsResult result = ls_text_lines_next(&text->lines, is_end);
        text->rest = "";
        if (result != LS_OK || *is_end)
            return result;
        char* line = text->lines.line;
        line[strcspn(line, "#")] = 0;
        while (isspace((unsigned char)*line))
            line++;
        text->rest = line;
        if (*line)
            return LS_OK;
    }
}

// Makes text->rest begin with a word: the next of the line, or of a later one where records are not
// a line each.
static LsResult find_word(OffText* text)
{
    if (*text->rest || !text->is_free)
        return LS_OK;
    bool is_end = false;
    const LsResult result = find_line(text, &is_end);
    return result == LS_OK && is_end ? fail_cut(text) : result;
}

// Before a record.
static LsResult begin_record(OffText* text)
{
    if (text->is_free)
        return LS_OK;
    bool is_end = false;
    const LsResult result = find_line(text, &is_end);
    return result == LS_OK && is_end ? fail_cut(text) : result;
}

static LsResult take_floats(OffText* text, float* numbers, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
    {
        const LsResult result = find_word(text);
        if (result != LS_OK)
            return result;
        if (!ls_text_read_floats(text->rest, &numbers[i], 1))
            return fail(text, LS_MESSAGE_OFF_NUMBER,
                        "a vertex lacks a number, or a word is none; export it again");
        text->rest = ls_text_skip_word(text->rest);
    }
    return LS_OK;
}

// Takes a whole number; *is_one is false if the word is something else. Numbers beyond int64_t
// become its ends.
static LsResult take_integer(OffText* text, int64_t* number, bool* is_one)
{
    const LsResult result = find_word(text);
    if (result != LS_OK)
        return result;
    char* end;
    *number = strtoll(text->rest, &end, 10);
    *is_one = end != text->rest && (!*end || isspace((unsigned char)*end));
    text->rest = ls_text_skip_word(text->rest);
    return LS_OK;
}

// ---- Header -------------------------------------------------------------------------------------

// Takes OFF and what says that more stands behind positions: ST, C, N. A file may begin with its
// counts instead.
static LsResult take_keyword(OffText* text)
{
    LsOff* off = &text->off;
    const char* word = text->rest;
    const size_t length = strcspn(word, " \t");
    const char* end = word + length;
    if (isdigit((unsigned char)*word) && word[length - 1] != 'F')
        return LS_OK;
    off->has_texcoords = !strncmp(word, "ST", 2);
    word += off->has_texcoords ? 2 : 0;
    off->has_colors = *word == 'C';
    word += off->has_colors;
    off->has_normals = *word == 'N';
    word += off->has_normals;
    const bool is_other = *word == '4' || *word == 'n';
    word += strspn(word, "4n");
    if (strncmp(word, "OFF", 3) || word + 3 != end)
        return fail(text, LS_MESSAGE_OFF_HEADER,
                    "not an OFF file: it does not begin with \"OFF\"; check its ending");
    text->rest = ls_text_skip_word(text->rest);
    if (is_other)
        return fail(text, LS_MESSAGE_OFF_DIMENSION,
                    "points of other than three coordinates; export it as plain OFF");
    text->is_binary = !strncmp(text->rest, "BINARY", 6);
    return LS_OK;
}

static LsResult fail_counts(const OffText* text)
{
    return fail(text, LS_MESSAGE_OFF_HEADER,
                "the header needs the numbers of vertices and faces; export it again");
}

static LsResult take_count(OffText* text, uint64_t* count)
{
    bool is_end = false;
    if (!*text->rest)
    {
        const LsResult result = find_line(text, &is_end);
        if (result != LS_OK)
            return result;
    }
    int64_t number = 0;
    bool is_one = false;
    if (is_end || !isdigit((unsigned char)*text->rest))
        return fail_counts(text);
    const LsResult result = take_integer(text, &number, &is_one);
    if (result == LS_OK && !is_one)
        return fail_counts(text);
    *count = (uint64_t)number;
    return result;
}

static LsResult read_header(OffText* text)
{
    LsOff* off = &text->off;
    bool is_end = false;
    text->is_free = false;
    LsResult result = find_line(text, &is_end);
    if (result == LS_OK)
        result = take_keyword(text);
    if (result != LS_OK || text->is_binary)
        return result;
    result = take_count(text, &off->vertex_count);
    const uint64_t line = text->lines.line_number;
    if (result == LS_OK)
        result = take_count(text, &off->face_count);
    // The number of edges may be missing; nobody needs it.
    uint64_t edge_count;
    if (result == LS_OK && (*text->rest || line != text->lines.line_number))
        result = take_count(text, &edge_count);
    text->header_lines = text->lines.line_number;
    return result;
}

// The counts against what the file can hold at most.
static LsResult check_counts(const OffText* text)
{
    // "0 0 0" and "0" with their line ends; the last may lack it.
    enum
    {
        VERTEX_BYTES = 6,
        FACE_BYTES = 2
    };
    const LsOff* off = &text->off;
    const uint64_t size = text->lines.size;
    const LsResult result = ls_off_check_counts(off);
    if (result != LS_OK)
        return result;
    if (off->vertex_count > size || off->face_count > size ||
        off->vertex_count * VERTEX_BYTES + off->face_count * FACE_BYTES > size + 1)
        return ls_error_set(text->lines.error, LS_MESSAGE_OFF_CUT,
                            "%s: line %llu: %llu vertices and %llu faces do not fit into the %llu "
                            "bytes of the file; it was cut short: copy or export it again",
                            text->lines.path, (unsigned long long)text->lines.line_number,
                            (unsigned long long)off->vertex_count,
                            (unsigned long long)off->face_count, (unsigned long long)size);
    return LS_OK;
}

// ---- Records ------------------------------------------------------------------------------------

static LsResult warn_of_rest(OffText* text, const char* what)
{
    // The first pass has seen them all.
    if (text->off.mesh)
        return LS_OK;
    return ls_input_warn(text->off.input, text->lines.error, LS_MESSAGE_OFF_REST,
                         "%s: numbers behind %s, which its header does not name, are left out",
                         text->lines.path, what);
}

static LsResult read_vertex(OffText* text, uint64_t vertex)
{
    LsOff* off = &text->off;
    float numbers[12];
    uint32_t color_count = off->has_colors ? 4 : 0;
    const uint32_t position_count = off->has_normals ? 6 : 3;
    const uint32_t texcoord_count = off->has_texcoords ? 2 : 0;
    LsResult result = begin_record(text);
    if (result == LS_OK)
        result = take_floats(text, numbers, position_count);
    // The line tells how many numbers a colour has.
    if (result == LS_OK && off->has_colors && !text->is_free &&
        ls_text_count_words(text->rest) == 3 + texcoord_count)
        color_count = 3;
    if (result == LS_OK)
        result = take_floats(text, numbers + position_count, color_count + texcoord_count);
    if (result != LS_OK)
        return result;
    if (!text->is_free && *text->rest && (result = warn_of_rest(text, "positions")) != LS_OK)
        return result;
    ls_off_add_vertex(off, vertex, numbers, color_count);
    return LS_OK;
}

// What stands behind the corners of a face, where a face is a line.
static LsResult read_face_color(OffText* text, uint64_t face, uint64_t first_triangle)
{
    float color[4] = {0.0f};
    uint32_t count = ls_text_count_words(text->rest);
    if (count > 4 || ls_text_read_floats(text->rest, color, count) < count ||
        (count != 3 && count != 4))
    {
        const LsResult result =
            count ? warn_of_rest(text, "faces, no colour of three or four,") : LS_OK;
        if (result != LS_OK)
            return result;
        count = 0;
    }
    ls_off_color_face(&text->off, face, first_triangle, color, count);
    return LS_OK;
}

static LsResult read_face(OffText* text, uint64_t face)
{
    LsOff* off = &text->off;
    const uint64_t first_triangle = off->triangle_count;
    int64_t count = 0;
    bool is_one = false;
    LsResult result = begin_record(text);
    if (result == LS_OK)
        result = take_integer(text, &count, &is_one);
    if (result == LS_OK && (!is_one || count < 0))
        result = fail(text, LS_MESSAGE_OFF_NUMBER,
                      "a face does not begin with its number of corners; export it again");
    if (result == LS_OK)
        ls_off_begin_face(off, face, (uint64_t)count);
    for (int64_t i = 0; result == LS_OK && i < count; i++)
    {
        int64_t vertex = 0;
        result = take_integer(text, &vertex, &is_one);
        if (result == LS_OK && !is_one)
            result =
                fail(text, LS_MESSAGE_OFF_NUMBER,
                     "a face has fewer corners than it counts, or one that is no whole number; "
                     "export it again");
        if (result == LS_OK)
            result = ls_off_add_corner(off, face, (uint64_t)i, vertex);
    }
    if (result == LS_OK)
        result = text->is_free ? LS_OK : read_face_color(text, face, first_triangle);
    return result;
}

static LsResult read_records(OffText* text)
{
    const LsOff* off = &text->off;
    LsResult result = LS_OK;
    for (uint64_t i = 0; result == LS_OK && i < off->vertex_count; i++)
        result = read_vertex(text, i);
    for (uint64_t i = 0; result == LS_OK && i < off->face_count; i++)
        result = read_face(text, i);
    return result;
}

// ---- The file -----------------------------------------------------------------------------------

// Goes back behind the header.
static LsResult begin_again(OffText* text)
{
    const LsOff before = text->off;
    const bool is_free = text->is_free;
    ls_text_lines_rewind(&text->lines);
    const LsResult result = read_header(text);
    text->is_free = is_free;
    if (result == LS_OK && (text->off.vertex_count != before.vertex_count ||
                            text->off.face_count != before.face_count))
        return ls_text_lines_fail_change(&text->lines);
    return result;
}

// Counts the lines that hold records, and goes back behind the header.
static LsResult count_lines(OffText* text, uint64_t* line_count)
{
    for (*line_count = 0;; *line_count += 1)
    {
        bool is_end = false;
        const LsResult result = find_line(text, &is_end);
        if (result != LS_OK)
            return result;
        if (is_end)
            return begin_again(text);
    }
}

// Whether nothing follows the last record.
static LsResult find_rest(OffText* text, bool* has_rest)
{
    bool is_end = false;
    LsResult result = LS_OK;
    if (!*text->rest || !text->is_free)
        result = find_line(text, &is_end);
    *has_rest = !is_end;
    return result;
}

// First pass over the records, laid out as text->is_free says.
static LsResult count_records(OffText* text)
{
    bool has_rest = false;
    LsResult result = read_records(text);
    if (result == LS_OK)
        result = find_rest(text, &has_rest);
    if (result != LS_OK || !has_rest)
        return result;
    if (text->is_free)
        return fail(
            text, LS_MESSAGE_OFF_LAYOUT,
            "more stands here than the header counts vertices and faces; export it again, a "
            "vertex and a face a line");
    return ls_input_warn(text->off.input, text->lines.error, LS_MESSAGE_OFF_TRAILING,
                         "%s: line %llu: more stands here than the header counts vertices and "
                         "faces; it is left out",
                         text->lines.path, (unsigned long long)text->lines.line_number);
}

// Finds how records are laid out, and what they hold.
static LsResult find_layout(OffText* text)
{
    const bool shares_line = *text->rest;
    const uint64_t record_count = text->off.vertex_count + text->off.face_count;
    uint64_t line_count = 0;
    LsResult result = count_lines(text, &line_count);
    if (result != LS_OK)
        return result;
    text->is_free = shares_line || line_count != record_count;
    const LsOff before = text->off;
    result = count_records(text);
    if (result == LS_OK || shares_line || line_count <= record_count)
        return result;
    // More lines than records, which do not go over several: what is too much is left out.
    text->is_free = false;
    text->off = before;
    result = begin_again(text);
    return result == LS_OK ? count_records(text) : result;
}

static LsResult import_text(OffText* text)
{
    LsOff* off = &text->off;
    LsResult result = check_counts(text);
    if (result == LS_OK)
        result = find_layout(text);
    if (result == LS_OK)
        result = ls_off_create_mesh(off);
    if (result != LS_OK || !off->mesh)
        return result;
    result = begin_again(text);
    if (result == LS_OK)
        result = read_records(text);
    if (result == LS_OK && off->triangle_count != off->mesh->triangle_count)
        result = ls_text_lines_fail_change(&text->lines);
    return result;
}

LsResult ls_import_off(LsInput* input, const char* path, LsError* error)
{
    OffText text = {
        .lines = {.file = fopen(path, "r"),
                  .path = path,
                  .error = error,
                  .input = input,
                  .pass_count = 3},
        .off = {.input = input, .path = path, .error = error},
        .rest = "",
    };
    if (!text.lines.file)
        return ls_text_lines_fail_read(&text.lines);
    LsResult result = read_header(&text);
    if (result == LS_OK)
        result =
            text.is_binary ? ls_off_read_binary(&text.off, text.lines.taken) : import_text(&text);
    ls_text_lines_close(&text.lines);
    return result;
}
