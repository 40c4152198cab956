// import_ply.c - PLY files: text and both byte orders, whatever elements and properties they have.
//
// A reader of our own. OpenMesh 9's loses its place without a word in legal files (lists other than
// the corners, lists counted in short or ushort, colours in double, properties before the corners,
// faces before vertices), never ends on a header that is cut, takes words of obj_info lines for
// keywords, builds vectors that grow by doubling, and drops tristrips.
//
// The file is read twice: once to count the triangles and to find its end, so that nothing is
// allocated for what is not there, and once to fill arrays of just that size. No second copy is
// held. Taken are positions, normals (nx ny nz), texture coordinates (u v, s t or texture_u
// texture_v, with v = 0 at the bottom of images) and colours (red green blue alpha: whole numbers up
// to 255, 65535 for the types of two bytes, or fractions; they are sRGB, as PLY's programs show
// them) of vertices, colours of faces where the vertices have none, faces and triangle strips.

#include "import.h"
#include "ply_header.h"
#include "srgb.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

// A file being read. In the first of the two passes there is no mesh.
typedef struct Ply
{
    LsByteReader reader;
    LsPlyHeader header;
    LsInput* input;
    LsInputMesh* mesh;
    uint64_t triangle_count;
    uint64_t small_face_count; // of fewer than three corners
    uint64_t first_small_face;
} Ply;

// Where a record stands, for messages.
typedef struct Place
{
    const LsPlyElement* element;
    uint64_t record;
} Place;

// ---- Failures -----------------------------------------------------------------------------------

static LsResult fail_cut(const Ply* ply, Place place)
{
    const LsResult result = ls_byte_reader_check(&ply->reader);
    if (result != LS_OK)
        return result;
    return ls_error_set(ply->reader.error, LS_MESSAGE_PLY_CUT,
                        "%s: ends in %s %llu of %llu; it was cut short: copy or export it again",
                        ply->reader.path, place.element->name, (unsigned long long)place.record,
                        (unsigned long long)place.element->count);
}

static LsResult fail_number(const Ply* ply, Place place, const char* what)
{
    char line[48] = "";
    if (ply->header.form == LS_PLY_ASCII)
        snprintf(line, sizeof line, "line %llu: ", (unsigned long long)ply->reader.line);
    return ls_error_set(ply->reader.error, LS_MESSAGE_PLY_NUMBER,
                        "%s: %s%s %llu: %s; export it again", ply->reader.path, line,
                        place.element->name, (unsigned long long)place.record, what);
}

static LsResult fail_index(const Ply* ply, Place place, double index)
{
    return ls_error_set(
        ply->reader.error, LS_MESSAGE_PLY_CORNER,
        "%s: %s %llu names vertex %.0f, but the file has %llu vertices, numbered from "
        "0; export it again",
        ply->reader.path, place.element->name, (unsigned long long)place.record, index,
        (unsigned long long)ls_ply_header_find(&ply->header, LS_PLY_VERTICES)->count);
}

static LsResult fail_limit(const Ply* ply)
{
    return ls_error_set(ply->reader.error, LS_MESSAGE_LIMIT_MESH,
                        "%s: more than 2147483647 vertices or 4294967294 triangles; split the mesh",
                        ply->reader.path);
}

// ---- Numbers ------------------------------------------------------------------------------------

static double get_binary(const uint8_t bytes[8], LsPlyType type, bool is_big)
{
    const uint32_t size = ls_ply_type_bytes(type);
    uint64_t word = 0;
    for (uint32_t i = 0; i < size; i++)
        word |= (uint64_t)bytes[is_big ? size - 1 - i : i] << 8 * i;
    const uint32_t low = (uint32_t)word;
    float single;
    double number;
    switch (type)
    {
    case LS_PLY_INT8:
        return low < 0x80 ? (double)low : (double)low - 0x100;
    case LS_PLY_INT16:
        return low < 0x8000 ? (double)low : (double)low - 0x10000;
    case LS_PLY_INT32:
        return low < 0x80000000u ? (double)low : (double)low - 4294967296.0;
    case LS_PLY_FLOAT32:
        memcpy(&single, &low, sizeof single);
        return (double)single;
    case LS_PLY_FLOAT64:
        memcpy(&number, &word, sizeof number);
        return number;
    default:
        return (double)low;
    }
}

// Reads a number. Text becomes a float at once where the type is one, so that it is rounded once.
static LsResult read_number(Ply* ply, Place place, LsPlyType type, double* number)
{
    if (ply->header.form != LS_PLY_ASCII)
    {
        uint8_t bytes[8];
        if (!ls_byte_reader_copy(&ply->reader, bytes, ls_ply_type_bytes(type)))
            return fail_cut(ply, place);
        *number = get_binary(bytes, type, ply->header.form == LS_PLY_BIG);
        return LS_OK;
    }
    char word[LS_WORD_BYTES];
    const size_t length = ls_byte_reader_word(&ply->reader, word);
    if (length == 0)
        return fail_cut(ply, place);
    char* end;
    *number = type >= LS_PLY_FLOAT32 ? (double)strtof(word, &end) : strtod(word, &end);
    // Not *end: the word may hold a zero byte.
    return length == LS_WORD_BYTES || end != word + length
               ? fail_number(ply, place, "what stands there is no number")
               : LS_OK;
}

static LsResult read_list_count(Ply* ply, Place place, LsPlyType type, uint64_t* count)
{
    double number = 0.0;
    const LsResult result = read_number(ply, place, type, &number);
    if (result != LS_OK)
        return result;
    if (!(number >= 0.0 && number <= (double)UINT32_MAX) || number != (double)(uint32_t)number)
        return fail_number(ply, place, "the count of a list is no whole number from 0 on");
    *count = (uint64_t)number;
    return LS_OK;
}

// Passes over so many numbers of a type.
static LsResult skip_numbers(Ply* ply, Place place, LsPlyType type, uint64_t count)
{
    if (ply->header.form != LS_PLY_ASCII)
        return ls_byte_reader_skip(&ply->reader, count * ls_ply_type_bytes(type))
                   ? LS_OK
                   : fail_cut(ply, place);
    char word[LS_WORD_BYTES];
    for (uint64_t i = 0; i < count; i++)
        if (ls_byte_reader_word(&ply->reader, word) == 0)
            return fail_cut(ply, place);
    return LS_OK;
}

static LsResult skip_property(Ply* ply, Place place, const LsPlyProperty* property)
{
    uint64_t count = 1;
    if (property->count_type != LS_PLY_NO_TYPE)
    {
        const LsResult result = read_list_count(ply, place, property->count_type, &count);
        if (result != LS_OK)
            return result;
    }
    return skip_numbers(ply, place, property->type, count);
}

// ---- Vertices -----------------------------------------------------------------------------------

static float get_color(double number, LsPlyType type)
{
    if (type == LS_PLY_INT16 || type == LS_PLY_UINT16)
        return (float)(number / 65535.0);
    return type >= LS_PLY_FLOAT32 ? (float)number : (float)(number / 255.0);
}

static void store_color(float color[4], LsPlyRole role, double number, LsPlyType type)
{
    const float value = get_color(number, type);
    if (role == LS_PLY_ALPHA)
        color[3] = value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f;
    else
        color[role - LS_PLY_RED] = ls_linear_from_srgb(value);
}

static void store_vertex(LsInputMesh* mesh, size_t vertex, const LsPlyProperty* property,
                         double number)
{
    const LsPlyRole role = property->role;
    if (role <= LS_PLY_Z)
        mesh->positions[3 * vertex + role] = (float)number;
    else if (role <= LS_PLY_NZ)
        mesh->streams[LS_STREAM_NORMAL].values[3 * vertex + (role - LS_PLY_NX)] = (float)number;
    else if (role == LS_PLY_U)
        mesh->streams[LS_STREAM_TEXCOORD_0].values[2 * vertex] = (float)number;
    else if (role == LS_PLY_V)
        mesh->streams[LS_STREAM_TEXCOORD_0].values[2 * vertex + 1] = 1.0f - (float)number;
    else
        store_color(&mesh->streams[LS_STREAM_COLOR].values[4 * vertex], role, number,
                    property->type);
}

static LsResult read_vertices(Ply* ply, const LsPlyElement* element)
{
    Place place = {element, 0};
    for (; place.record < element->count; place.record++)
    {
        if (element->roles & 1u << LS_PLY_RED)
            ply->mesh->streams[LS_STREAM_COLOR].values[4 * place.record + 3] = 1.0f;
        for (uint32_t k = 0; k < element->property_count; k++)
        {
            const LsPlyProperty* property = &ply->header.properties[element->first_property + k];
            double number = 0.0;
            LsResult result;
            if (property->role == LS_PLY_LEFT)
                result = skip_property(ply, place, property);
            else
                result = read_number(ply, place, property->type, &number);
            if (result != LS_OK)
                return result;
            if (property->role != LS_PLY_LEFT)
                store_vertex(ply->mesh, (size_t)place.record, property, number);
        }
    }
    return LS_OK;
}

// ---- Faces --------------------------------------------------------------------------------------

// Reads the number of a vertex; -1 is allowed where `separator` is given, which is then set.
static LsResult read_index(Ply* ply, Place place, LsPlyType type, uint32_t* index, bool* separator)
{
    double number = 0.0;
    const LsResult result = read_number(ply, place, type, &number);
    if (result != LS_OK)
        return result;
    if (separator)
        *separator = number == -1.0;
    if (separator && *separator)
        return LS_OK;
    const LsPlyElement* vertices = ls_ply_header_find(&ply->header, LS_PLY_VERTICES);
    if (!(number >= 0.0 && number < (double)vertices->count))
        return number == number ? fail_index(ply, place, number)
                                : fail_number(ply, place, "a corner is no number");
    *index = (uint32_t)number;
    return (double)*index == number ? LS_OK
                                    : fail_number(ply, place, "a corner is no whole number");
}

static LsResult add_triangle(Ply* ply, uint32_t a, uint32_t b, uint32_t c)
{
    LsInputMesh* mesh = ply->mesh;
    const uint64_t triangle = ply->triangle_count++;
    if (!mesh)
        return LS_OK;
    if (triangle >= mesh->triangle_count)
        return ls_byte_reader_fail_change(&ply->reader);
    uint32_t* corners = &mesh->indices[3 * triangle];
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
    return LS_OK;
}

// Fans a polygon from its first corner.
static LsResult read_polygon(Ply* ply, Place place, LsPlyType type, uint64_t corner_count)
{
    if (corner_count < 3)
    {
        if (ply->small_face_count++ == 0)
            ply->first_small_face = place.record;
        return skip_numbers(ply, place, type, corner_count);
    }
    if (!ply->mesh)
    {
        ply->triangle_count += corner_count - 2;
        return skip_numbers(ply, place, type, corner_count);
    }
    uint32_t corners[3] = {0};
    LsResult result = LS_OK;
    for (uint64_t i = 0; result == LS_OK && i < corner_count; i++)
    {
        corners[1] = corners[2];
        result = read_index(ply, place, type, &corners[i == 0 ? 0 : 2], NULL);
        if (result == LS_OK && i >= 2)
            result = add_triangle(ply, corners[0], corners[1], corners[2]);
    }
    return result;
}

// Strips with -1 between them; every second triangle of a strip is turned round.
static LsResult read_strips(Ply* ply, Place place, LsPlyType type, uint64_t count)
{
    uint32_t corners[3] = {0};
    uint64_t length = 0; // corners of the strip so far
    LsResult result = LS_OK;
    for (uint64_t i = 0; result == LS_OK && i < count; i++)
    {
        bool is_separator = false;
        uint32_t index = 0;
        result = read_index(ply, place, type, &index, &is_separator);
        if (is_separator)
        {
            length = 0;
            continue;
        }
        corners[0] = corners[1];
        corners[1] = corners[2];
        corners[2] = index;
        length++;
        if (result == LS_OK && length >= 3)
            result = length % 2 ? add_triangle(ply, corners[0], corners[1], corners[2])
                                : add_triangle(ply, corners[0], corners[2], corners[1]);
    }
    return result;
}

static void color_triangles(LsInputMesh* mesh, uint64_t first, uint64_t end, uint32_t color)
{
    LsInputStream* stream = &mesh->streams[LS_STREAM_COLOR];
    for (uint64_t i = 3 * first; stream->indices && i < 3 * end; i++)
        stream->indices[i] = color;
}

static LsResult read_faces(Ply* ply, const LsPlyElement* element)
{
    Place place = {element, 0};
    const bool is_colored = element->roles & 1u << LS_PLY_RED;
    for (; place.record < element->count; place.record++)
    {
        const uint64_t first = ply->triangle_count;
        float color[4] = {0.0f, 0.0f, 0.0f, 1.0f};
        for (uint32_t k = 0; k < element->property_count; k++)
        {
            const LsPlyProperty* property = &ply->header.properties[element->first_property + k];
            uint64_t count = 0;
            double number = 0.0;
            LsResult result;
            if (property->role == LS_PLY_CORNERS)
            {
                result = read_list_count(ply, place, property->count_type, &count);
                if (result == LS_OK)
                    result = element->kind == LS_PLY_STRIPS
                                 ? read_strips(ply, place, property->type, count)
                                 : read_polygon(ply, place, property->type, count);
            }
            else if (property->role == LS_PLY_LEFT)
                result = skip_property(ply, place, property);
            else
            {
                result = read_number(ply, place, property->type, &number);
                store_color(color, property->role, number, property->type);
            }
            if (result != LS_OK)
                return result;
        }
        if (ply->mesh)
            color_triangles(ply->mesh, first, ply->triangle_count,
                            is_colored ? (uint32_t)place.record : LS_NONE);
        if (ply->mesh && is_colored)
            memcpy(&ply->mesh->streams[LS_STREAM_COLOR].values[4 * place.record], color,
                   sizeof color);
    }
    return LS_OK;
}

// ---- The file -----------------------------------------------------------------------------------

static LsResult skip_records(Ply* ply, const LsPlyElement* element)
{
    Place place = {element, 0};
    if (ply->header.form != LS_PLY_ASCII && element->fixed_bytes)
    {
        const uint64_t left = ls_byte_reader_left(&ply->reader);
        place.record = left / element->fixed_bytes;
        return place.record >= element->count &&
                       ls_byte_reader_skip(&ply->reader, element->count * element->fixed_bytes)
                   ? LS_OK
                   : fail_cut(ply, place);
    }
    for (; place.record < element->count; place.record++)
        for (uint32_t k = 0; k < element->property_count; k++)
        {
            const LsResult result =
                skip_property(ply, place, &ply->header.properties[element->first_property + k]);
            if (result != LS_OK)
                return result;
        }
    return LS_OK;
}

// One pass over all elements.
static LsResult read_elements(Ply* ply)
{
    LsResult result = LS_OK;
    ply->triangle_count = 0;
    ply->small_face_count = 0;
    for (uint32_t i = 0; result == LS_OK && i < ply->header.element_count; i++)
    {
        const LsPlyElement* element = &ply->header.elements[i];
        if (element->property_count == 0) // takes no room, however many there are
            continue;
        if (element->kind == LS_PLY_FACES || element->kind == LS_PLY_STRIPS)
            result = read_faces(ply, element);
        else if (element->kind == LS_PLY_VERTICES && ply->mesh)
            result = read_vertices(ply, element);
        else
            result = skip_records(ply, element);
    }
    return result;
}

static LsResult check_rest(Ply* ply)
{
    LsResult result = LS_OK;
    char word[LS_WORD_BYTES];
    const bool has_more = ply->header.form == LS_PLY_ASCII
                              ? ls_byte_reader_word(&ply->reader, word) != 0
                              : ls_byte_reader_left(&ply->reader) != 0;
    if (has_more)
        result = ls_input_warn(ply->input, ply->reader.error, LS_MESSAGE_PLY_TRAILING,
                               "%s: more stands behind the last of the elements that its header "
                               "counts; it is left out",
                               ply->reader.path);
    if (result == LS_OK && ply->small_face_count)
        result = ls_input_warn(ply->input, ply->reader.error, LS_MESSAGE_PLY_SMALL_FACES,
                               "%s: %llu of its faces have fewer than three corners, the first is "
                               "face %llu; they are left out",
                               ply->reader.path, (unsigned long long)ply->small_face_count,
                               (unsigned long long)ply->first_small_face);
    const uint64_t vertex_count = ls_ply_header_find(&ply->header, LS_PLY_VERTICES)->count;
    if (result == LS_OK && ply->triangle_count == 0 && vertex_count)
        result = ls_input_warn(ply->input, ply->reader.error, LS_MESSAGE_PLY_POINTS,
                               "%s: its %llu vertices are points without faces; they are left out",
                               ply->reader.path, (unsigned long long)vertex_count);
    return result;
}

// Arrays of just the size that the first pass found.
static LsResult create_mesh(Ply* ply)
{
    const LsPlyElement* vertices = ls_ply_header_find(&ply->header, LS_PLY_VERTICES);
    const LsPlyElement* faces = ls_ply_header_find(&ply->header, LS_PLY_FACES);
    if (ply->triangle_count >= LS_NONE)
        return fail_limit(ply);
    const uint64_t vertex_count = vertices->count;
    const uint64_t triangle_count = ply->triangle_count;
    const bool has_normals = vertices->roles & 1u << LS_PLY_NX;
    const bool has_texcoords = vertices->roles & 1u << LS_PLY_U;
    const bool has_colors = vertices->roles & 1u << LS_PLY_RED;
    const bool has_face_colors = !has_colors && faces && faces->roles & 1u << LS_PLY_RED;
    const uint64_t vertex_bytes =
        12 + (has_normals ? 12u : 0u) + (has_texcoords ? 8u : 0u) + (has_colors ? 16u : 0u);
    uint64_t bytes = vertex_count * vertex_bytes + triangle_count * 16;
    if (has_face_colors)
        bytes += faces->count * 16 + triangle_count * 12;
    const LsResult result =
        ls_input_reserve(ply->input, ply->reader.path, bytes, triangle_count, ply->reader.error);
    if (result != LS_OK)
        return result;
    LsInputMesh* mesh =
        ls_input_add_plain_mesh(ply->input, (uint32_t)vertex_count, (uint32_t)triangle_count);
    ply->mesh = mesh;
    if (!mesh ||
        (has_normals &&
         !ls_input_stream_create(mesh, LS_STREAM_NORMAL, (uint32_t)vertex_count, false)) ||
        (has_texcoords &&
         !ls_input_stream_create(mesh, LS_STREAM_TEXCOORD_0, (uint32_t)vertex_count, false)) ||
        (has_colors &&
         !ls_input_stream_create(mesh, LS_STREAM_COLOR, (uint32_t)vertex_count, false)) ||
        (has_face_colors &&
         !ls_input_stream_create(mesh, LS_STREAM_COLOR, (uint32_t)faces->count, true)))
        return ls_error_set(ply->reader.error, LS_MESSAGE_OUT_OF_MEMORY,
                            "%s: out of memory while reading it", ply->reader.path);
    return LS_OK;
}

static LsResult import_file(Ply* ply)
{
    LsByteReader* reader = &ply->reader;
    LsResult result = ls_byte_reader_begin(reader);
    if (result == LS_OK)
        result = ls_ply_header_read(&ply->header, reader, ply->input);
    if (result != LS_OK)
        return result;
    for (uint32_t i = 0; i < ply->header.element_count; i++)
        if ((ply->header.elements[i].kind == LS_PLY_VERTICES &&
             ply->header.elements[i].count > INT_MAX) ||
            (ply->header.elements[i].kind == LS_PLY_FACES &&
             ply->header.elements[i].count >= LS_NONE))
            return fail_limit(ply);
    const uint64_t body = reader->size - ls_byte_reader_left(reader);
    const uint64_t body_line = reader->next_line;
    result = read_elements(ply);
    if (result == LS_OK)
        result = check_rest(ply);
    if (result != LS_OK || ply->triangle_count == 0)
        return result;

    result = create_mesh(ply);
    if (result == LS_OK)
        result = ls_byte_reader_begin(reader);
    if (result != LS_OK)
        return result;
    reader->pass = 1;
    if (!ls_byte_reader_skip(reader, body))
        return ls_byte_reader_fail_change(reader);
    reader->next_line = body_line;
    result = read_elements(ply);
    if (result == LS_OK && ply->triangle_count != ply->mesh->triangle_count)
        result = ls_byte_reader_fail_change(reader);
    return result;
}

LsResult ls_import_ply(LsInput* input, const char* path, LsError* error)
{
    Ply* ply = calloc(1, sizeof *ply);
    if (!ply)
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory while reading it",
                            path);
    ply->reader = (LsByteReader){
        .file = fopen(path, "rb"), .path = path, .error = error, .input = input, .pass_count = 2};
    ply->input = input;
    const LsResult result = import_file(ply);
    ls_byte_reader_close(&ply->reader);
    free(ply);
    return result;
}
