// ply_header.c - the header of a PLY file: which elements stand in it, and of what they consist.

#include "ply_header.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LINE 1024

// A header being read. A line ends as the first one does: in binary files a byte that looks like
// half of a line end may follow the header.
typedef struct Lines
{
    LsByteReader* reader;
    LsInput* input;
    char text[MAX_LINE]; // the last line, without its end
    bool is_long;        // it did not fit
    bool ends_in_return; // lines end in \r alone
    uint64_t number;     // from 1
} Lines;

static LsResult fail_header(const Lines* lines, LsMessage message, const char* what)
{
    return ls_error_set(lines->reader->error, (int)message, "%s: line %llu of the header: %s",
                        lines->reader->path, (unsigned long long)lines->number, what);
}

// Reads a line, the last one also without its end; false behind it.
static bool next_line(Lines* lines)
{
    size_t length = 0;
    lines->number++;
    lines->is_long = false;
    for (;;)
    {
        const int byte = ls_byte_reader_next(lines->reader);
        if (byte < 0 && length == 0)
            return false;
        if (byte < 0 || byte == '\n')
            break;
        if (byte == '\r' && lines->number == 1)
        {
            // \r\n or \r alone: peek, which the one buffer always allows but at its end.
            const int next = ls_byte_reader_next(lines->reader);
            if (next == '\n' || next < 0)
                break;
            lines->ends_in_return = true;
            lines->reader->at--;
            break;
        }
        if (byte == '\r' && lines->ends_in_return)
            break;
        if (length < MAX_LINE - 1)
            lines->text[length++] = (char)byte;
        else
            lines->is_long = true;
    }
    while (length && isspace((unsigned char)lines->text[length - 1]))
        length--;
    lines->text[length] = 0;
    return true;
}

// Takes the next word of *text, which moves behind it; false without one, or if it is too long.
static bool take_word(const char** text, char word[LS_PLY_NAME_BYTES])
{
    const char* at = *text;
    while (isspace((unsigned char)*at))
        at++;
    size_t length = 0;
    while (at[length] && !isspace((unsigned char)at[length]))
        length++;
    *text = at + length;
    if (length == 0 || length >= LS_PLY_NAME_BYTES)
        return false;
    memcpy(word, at, length);
    word[length] = 0;
    return true;
}

// ---- Types and names ----------------------------------------------------------------------------

static LsPlyType find_type(const char* word)
{
    static const struct
    {
        const char* name;
        LsPlyType type;
    } types[] = {
        {"char", LS_PLY_INT8},       {"int8", LS_PLY_INT8},       {"uchar", LS_PLY_UINT8},
        {"uint8", LS_PLY_UINT8},     {"short", LS_PLY_INT16},     {"int16", LS_PLY_INT16},
        {"ushort", LS_PLY_UINT16},   {"uint16", LS_PLY_UINT16},   {"int", LS_PLY_INT32},
        {"int32", LS_PLY_INT32},     {"uint", LS_PLY_UINT32},     {"uint32", LS_PLY_UINT32},
        {"float", LS_PLY_FLOAT32},   {"float32", LS_PLY_FLOAT32}, {"double", LS_PLY_FLOAT64},
        {"float64", LS_PLY_FLOAT64},
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcmp(word, types[i].name))
            return types[i].type;
    return LS_PLY_NO_TYPE;
}

uint32_t ls_ply_type_bytes(LsPlyType type)
{
    static const uint32_t bytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return bytes[type];
}

static LsPlyKind find_kind(const char* name)
{
    if (!strcmp(name, "vertex"))
        return LS_PLY_VERTICES;
    if (!strcmp(name, "face"))
        return LS_PLY_FACES;
    return strcmp(name, "tristrips") ? LS_PLY_OTHERS : LS_PLY_STRIPS;
}

static LsPlyRole find_role(LsPlyKind kind, const LsPlyProperty* property)
{
    static const struct
    {
        const char* name;
        LsPlyRole role;
    } roles[] = {
        {"x", LS_PLY_X},
        {"y", LS_PLY_Y},
        {"z", LS_PLY_Z},
        {"nx", LS_PLY_NX},
        {"ny", LS_PLY_NY},
        {"nz", LS_PLY_NZ},
        {"u", LS_PLY_U},
        {"v", LS_PLY_V},
        {"s", LS_PLY_U},
        {"t", LS_PLY_V},
        {"texture_u", LS_PLY_U},
        {"texture_v", LS_PLY_V},
        {"red", LS_PLY_RED},
        {"green", LS_PLY_GREEN},
        {"blue", LS_PLY_BLUE},
        {"alpha", LS_PLY_ALPHA},
        {"diffuse_red", LS_PLY_RED},
        {"diffuse_green", LS_PLY_GREEN},
        {"diffuse_blue", LS_PLY_BLUE},
    };
    if (property->count_type != LS_PLY_NO_TYPE)
    {
        const bool is_corners =
            (kind == LS_PLY_FACES || kind == LS_PLY_STRIPS) &&
            (!strcmp(property->name, "vertex_indices") || !strcmp(property->name, "vertex_index"));
        return is_corners ? LS_PLY_CORNERS : LS_PLY_LEFT;
    }
    for (size_t i = 0; i < sizeof roles / sizeof *roles; i++)
        if (!strcmp(property->name, roles[i].name) &&
            (kind == LS_PLY_VERTICES || (kind == LS_PLY_FACES && roles[i].role >= LS_PLY_RED)))
            return roles[i].role;
    return LS_PLY_LEFT;
}

// ---- Lines --------------------------------------------------------------------------------------

static LsResult read_format(LsPlyHeader* header, const Lines* lines, const char* text)
{
    char form[LS_PLY_NAME_BYTES] = "";
    char version[LS_PLY_NAME_BYTES] = "";
    const bool is_whole = take_word(&text, form) && take_word(&text, version);
    if (!is_whole || strcmp(version, "1.0"))
        return fail_header(lines, LS_MESSAGE_PLY_HEADER,
                           "a format line of version 1.0 was expected; export it again");
    if (!strcmp(form, "ascii"))
        header->form = LS_PLY_ASCII;
    else if (!strcmp(form, "binary_little_endian"))
        header->form = LS_PLY_LITTLE;
    else if (!strcmp(form, "binary_big_endian"))
        header->form = LS_PLY_BIG;
    else
        return fail_header(lines, LS_MESSAGE_PLY_HEADER,
                           "neither ascii nor binary_little_endian nor binary_big_endian; export "
                           "it again");
    return LS_OK;
}

static LsResult read_element(LsPlyHeader* header, const Lines* lines, const char* text)
{
    if (header->element_count == LS_PLY_MAX_ELEMENTS)
        return fail_header(lines, LS_MESSAGE_PLY_HEADER_LIMIT,
                           "more than 64 elements; export the mesh without those it does not need");
    LsPlyElement* element = &header->elements[header->element_count++];
    char count[LS_PLY_NAME_BYTES];
    *element = (LsPlyElement){.first_property = header->property_count};
    if (!take_word(&text, element->name) || !take_word(&text, count) ||
        strspn(count, "0123456789") != strlen(count))
        return fail_header(lines, LS_MESSAGE_PLY_HEADER,
                           "an element needs a name and a count; export it again");
    element->count = strtoull(count, NULL, 10);
    element->kind = find_kind(element->name);
    if (element->kind != LS_PLY_OTHERS && ls_ply_header_find(header, element->kind) != element)
        return fail_header(lines, LS_MESSAGE_PLY_HEADER,
                           "an element that was already there; export it again");
    return LS_OK;
}

static LsResult read_property(LsPlyHeader* header, const Lines* lines, const char* text)
{
    if (header->element_count == 0)
        return fail_header(lines, LS_MESSAGE_PLY_HEADER,
                           "a property before any element; export it again");
    if (header->property_count == LS_PLY_MAX_PROPERTIES)
        return fail_header(
            lines, LS_MESSAGE_PLY_HEADER_LIMIT,
            "more than 1024 properties; export the mesh without those it does not need");
    LsPlyElement* element = &header->elements[header->element_count - 1];
    LsPlyProperty* property = &header->properties[header->property_count++];
    char type[LS_PLY_NAME_BYTES] = "";
    char count_type[LS_PLY_NAME_BYTES] = "";
    bool is_whole = take_word(&text, type);
    const bool is_list = is_whole && !strcmp(type, "list");
    if (is_list)
        is_whole = take_word(&text, count_type) && take_word(&text, type);
    *property = (LsPlyProperty){.role = LS_PLY_LEFT};
    if (!is_whole || !take_word(&text, property->name))
        return fail_header(lines, LS_MESSAGE_PLY_HEADER,
                           "a property needs its type and a name; export it again");
    property->type = find_type(type);
    property->count_type = is_list ? find_type(count_type) : LS_PLY_NO_TYPE;
    if (property->type == LS_PLY_NO_TYPE || (is_list && property->count_type == LS_PLY_NO_TYPE))
        return ls_error_set(lines->reader->error, LS_MESSAGE_PLY_TYPE,
                            "%s: line %llu of the header: property \"%s\" is of a type that PLY "
                            "does not have, \"%s\"; export it with float, int or uchar",
                            lines->reader->path, (unsigned long long)lines->number, property->name,
                            property->type == LS_PLY_NO_TYPE ? type : count_type);
    if (is_list && property->count_type >= LS_PLY_FLOAT32)
        return ls_error_set(lines->reader->error, LS_MESSAGE_PLY_TYPE,
                            "%s: line %llu of the header: list \"%s\" is counted in \"%s\"; export "
                            "it with uchar or int",
                            lines->reader->path, (unsigned long long)lines->number, property->name,
                            count_type);
    const LsPlyRole role = find_role(element->kind, property);
    if (role != LS_PLY_LEFT && !(element->roles & 1u << role))
    {
        element->roles |= 1u << role;
        property->role = role;
    }
    element->property_count++;
    return LS_OK;
}

static bool is_filler(const char* word)
{
    return !strcmp(word, "comment") || !strcmp(word, "obj_info");
}

static LsResult read_line(LsPlyHeader* header, const Lines* lines, const char* keyword,
                          const char* arguments)
{
    if (!strcmp(keyword, "element"))
        return read_element(header, lines, arguments);
    if (!strcmp(keyword, "property"))
        return read_property(header, lines, arguments);
    char word[LS_PLY_NAME_BYTES];
    if (is_filler(keyword))
    {
        if (take_word(&arguments, word) && !strcmp(word, "TextureFile"))
            return ls_input_warn(lines->input, lines->reader->error, LS_MESSAGE_PLY_TEXTURE,
                                 "%s: its texture \"%.200s\" is left out; convert the scene to "
                                 "OBJ or glTF to keep it",
                                 lines->reader->path, arguments + (*arguments == ' '));
        return LS_OK;
    }
    return ls_input_warn(lines->input, lines->reader->error, LS_MESSAGE_PLY_HEADER_LINE,
                         "%s: line %llu of the header begins with \"%s\", which PLY does not have; "
                         "the line is left out",
                         lines->reader->path, (unsigned long long)lines->number, keyword);
}

// ---- What is there, and what is left ------------------------------------------------------------

static void count_bytes(LsPlyHeader* header)
{
    for (uint32_t i = 0; i < header->element_count; i++)
    {
        LsPlyElement* element = &header->elements[i];
        for (uint32_t k = 0; k < element->property_count; k++)
        {
            const LsPlyProperty* property = &header->properties[element->first_property + k];
            if (property->count_type != LS_PLY_NO_TYPE)
            {
                element->fixed_bytes = 0;
                break;
            }
            element->fixed_bytes += ls_ply_type_bytes(property->type);
        }
    }
}

// Takes the roles of `group` from an element that has not all of `needed`.
static void drop_roles(LsPlyHeader* header, LsPlyElement* element, uint32_t needed, uint32_t group)
{
    if ((element->roles & needed) == needed)
        return;
    element->roles &= ~group;
    for (uint32_t k = 0; k < element->property_count; k++)
    {
        LsPlyProperty* property = &header->properties[element->first_property + k];
        if (group & 1u << property->role)
            property->role = LS_PLY_LEFT;
    }
}

// Names in one warning what an element has and we do not take.
static LsResult warn_of_left(const LsPlyHeader* header, const LsPlyElement* element,
                             const Lines* lines)
{
    char names[640] = "";
    size_t length = 0;
    uint32_t unnamed_count = 0;
    uint32_t left_count = 0;
    for (uint32_t k = 0; k < element->property_count; k++)
    {
        const LsPlyProperty* property = &header->properties[element->first_property + k];
        if (property->role != LS_PLY_LEFT)
            continue;
        left_count++;
        if (length + strlen(property->name) + 8 > sizeof names)
            unnamed_count++;
        else
            length += (size_t)snprintf(names + length, sizeof names - length, "%s\"%s\"",
                                       length ? ", " : "", property->name);
    }
    if (left_count == 0 || element->count == 0)
        return LS_OK;
    char more[32] = "";
    if (unnamed_count)
        snprintf(more, sizeof more, " and %u more", unnamed_count);
    return ls_input_warn(lines->input, lines->reader->error, LS_MESSAGE_PLY_PROPERTIES_LEFT,
                         "%s: element \"%s\": its properties %s%s are left out",
                         lines->reader->path, element->name, names, more);
}

static LsResult finish(LsPlyHeader* header, const Lines* lines)
{
#define ROLE(name) (1u << LS_PLY_##name)
    const uint32_t position = ROLE(X) | ROLE(Y) | ROLE(Z);
    const uint32_t normal = ROLE(NX) | ROLE(NY) | ROLE(NZ);
    const uint32_t texcoord = ROLE(U) | ROLE(V);
    const uint32_t color = ROLE(RED) | ROLE(GREEN) | ROLE(BLUE);
    const LsPlyElement* vertices = ls_ply_header_find(header, LS_PLY_VERTICES);
    bool is_colored = false;
    LsResult result = LS_OK;
    if (!vertices || (vertices->roles & position) != position)
        return ls_error_set(lines->reader->error, LS_MESSAGE_PLY_NO_POSITIONS,
                            "%s: its vertices lack x, y and z; export it again",
                            lines->reader->path);
    is_colored = (vertices->roles & color) == color;
    for (uint32_t i = 0; result == LS_OK && i < header->element_count; i++)
    {
        LsPlyElement* element = &header->elements[i];
        drop_roles(header, element, normal, normal);
        drop_roles(header, element, texcoord, texcoord);
        drop_roles(header, element, color, color | ROLE(ALPHA));
        // Colours of vertices go before those of faces.
        if (element->kind == LS_PLY_FACES && is_colored)
            drop_roles(header, element, UINT32_MAX, color | ROLE(ALPHA));
        const bool has_corners = element->roles & ROLE(CORNERS);
        if ((element->kind == LS_PLY_FACES || element->kind == LS_PLY_STRIPS) && element->count &&
            !has_corners)
            return ls_error_set(lines->reader->error, LS_MESSAGE_PLY_NO_CORNERS,
                                "%s: element \"%s\" has no list vertex_indices; export it again",
                                lines->reader->path, element->name);
        if (element->kind != LS_PLY_OTHERS)
            result = warn_of_left(header, element, lines);
        else if (element->count)
            result = ls_input_warn(lines->input, lines->reader->error, LS_MESSAGE_PLY_ELEMENT_LEFT,
                                   "%s: its %llu elements \"%s\" are left out", lines->reader->path,
                                   (unsigned long long)element->count, element->name);
    }
#undef ROLE
    count_bytes(header);
    return result;
}

LsResult ls_ply_header_read(LsPlyHeader* header, LsByteReader* reader, LsInput* input)
{
    Lines lines = {.reader = reader, .input = input};
    bool has_format = false;
    while (next_line(&lines))
    {
        const char* arguments = lines.text;
        char keyword[LS_PLY_NAME_BYTES] = "";
        const bool is_short = take_word(&arguments, keyword);
        if (lines.number == 1)
        {
            if (strcmp(keyword, "ply") && strcmp(keyword, "PLY"))
                return ls_error_set(reader->error, LS_MESSAGE_PLY_HEADER,
                                    "%s: not a PLY file: it does not begin with \"ply\"; check its "
                                    "ending",
                                    reader->path);
            continue;
        }
        if (!*lines.text || is_filler(keyword))
            ;
        else if (!is_short || lines.is_long)
            return fail_header(&lines, LS_MESSAGE_PLY_HEADER,
                               "too long; the file is damaged or of another kind");
        LsResult result = LS_OK;
        if (!strcmp(keyword, "end_header") && has_format)
        {
            reader->next_line = lines.number + 1;
            return finish(header, &lines);
        }
        if (!strcmp(keyword, "format") && !has_format)
        {
            has_format = true;
            result = read_format(header, &lines, arguments);
        }
        else if (!has_format && !is_filler(keyword) && *keyword)
            result = fail_header(&lines, LS_MESSAGE_PLY_HEADER,
                                 "the format line was expected; export it again");
        else if (*keyword)
            result = read_line(header, &lines, keyword, arguments);
        if (result != LS_OK)
            return result;
    }
    const LsResult result = ls_byte_reader_check(reader);
    return result != LS_OK
               ? result
               : ls_error_set(reader->error, LS_MESSAGE_PLY_HEADER_CUT,
                              "%s: its header has no end; the file was cut short or is of another "
                              "kind: copy or export it again",
                              reader->path);
}

const LsPlyElement* ls_ply_header_find(const LsPlyHeader* header, LsPlyKind kind)
{
    for (uint32_t i = 0; i < header->element_count; i++)
        if (header->elements[i].kind == kind)
            return &header->elements[i];
    return NULL;
}
