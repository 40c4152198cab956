// import_obj.c - OBJ files: polygons with normals, texture coordinates and colours.
//
// A reader of our own, because numbers of faces must stay those of the file: OpenMesh 9's OBJ
// reader takes repeated corners out of faces and skips faces that become too small, and skips
// vertices that it cannot parse, before any importer sees them; it also rounds colours to 8 bits.
// Faces come as they are, polygons fanned; all groups of a file are one mesh, named after the first
// o or g. Texture coordinates have v = 0 at the bottom in the file, at the top in the mesh. Colours
// behind positions ("v x y z r g b") are sRGB, as the programs that write them show them.
//
// The file is read twice: once to count and to read the material libraries, so that a usemtl finds
// its material wherever the mtllib stands, and once to fill the arrays.

#define _GNU_SOURCE // memmem

#include "import.h"
#include "import_mtl.h"
#include "input_files.h"
#include "srgb.h"
#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

// Warnings of one kind about names of a file; then one more, and no more.
#define MAX_NAMED_WARNINGS 64

typedef struct Counts
{
    uint64_t positions;
    uint64_t texcoords;
    uint64_t normals;
    uint64_t triangles;
} Counts;

// A file being read.
typedef struct Obj
{
    LsTextLines lines;
    LsInput* input;
    LsMtl mtl;
    Counts counts; // of the whole file, found in the first pass
    bool uses_texcoords, uses_normals, has_colors;
    uint64_t small_face_count; // of fewer than three corners
    // Lines of the first of their kind; 0: there is none.
    uint64_t small_face_line, weight_line, rest_line, smoothing_line;
    LsNameTable statements; // not taken, with their first line
    char* name;             // owned
    LsInputMesh* mesh;
    Counts done;       // read so far in the second pass
    uint32_t material; // of the faces to come, or LS_NONE
    uint32_t unknown_material_count;
} Obj;

static LsResult fail(const Obj* obj, LsMessage message, const char* text)
{
    return ls_text_lines_fail(&obj->lines, message, text);
}

static LsResult fail_memory(const Obj* obj)
{
    return ls_error_set(obj->lines.error, LS_MESSAGE_OUT_OF_MEMORY,
                        "%s: out of memory while reading it", obj->lines.path);
}

// ---- Lines --------------------------------------------------------------------------------------

// Statements that are understood.
typedef enum Statement
{
    STATEMENT_NONE, // an empty line or a comment
    STATEMENT_POSITION,
    STATEMENT_TEXCOORD,
    STATEMENT_NORMAL,
    STATEMENT_FACE,
    STATEMENT_NAME,
    STATEMENT_LIBRARY,
    STATEMENT_MATERIAL,
    STATEMENT_SMOOTHING,
    STATEMENT_OTHER,
} Statement;

// What a line says, and what follows the keyword; behind numbers a comment is cut off.
static Statement read_statement(char* line, const char** keyword, const char** arguments)
{
    static const struct
    {
        const char* keyword;
        Statement statement;
    } statements[] = {
        {"v", STATEMENT_POSITION},  {"vt", STATEMENT_TEXCOORD},    {"vn", STATEMENT_NORMAL},
        {"f", STATEMENT_FACE},      {"o", STATEMENT_NAME},         {"g", STATEMENT_NAME},
        {"s", STATEMENT_SMOOTHING}, {"mtllib", STATEMENT_LIBRARY}, {"usemtl", STATEMENT_MATERIAL},
    };
    while (isspace((unsigned char)*line))
        line++;
    *keyword = line;
    if (!*line || *line == '#')
        return STATEMENT_NONE;
    size_t length = 0;
    while (line[length] && !isspace((unsigned char)line[length]))
        length++;
    *arguments = ls_text_skip_word(line);
    for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
    {
        if (strlen(statements[i].keyword) != length ||
            strncmp(line, statements[i].keyword, length) != 0)
            continue;
        if (statements[i].statement <= STATEMENT_FACE)
            line[strcspn(line, "#")] = 0;
        return statements[i].statement;
    }
    return STATEMENT_OTHER;
}

// ---- First pass ---------------------------------------------------------------------------------

// Counts the corners of a face and sees which numbers they have.
static void count_face(Obj* obj, const char* corners)
{
    uint64_t count = 0;
    while (*corners)
    {
        int slash_count = 0;
        for (; *corners && !isspace((unsigned char)*corners); corners++)
        {
            if (*corners == '/')
                slash_count++;
            else if (slash_count == 1)
                obj->uses_texcoords = true;
            else if (slash_count == 2)
                obj->uses_normals = true;
        }
        while (isspace((unsigned char)*corners))
            corners++;
        count++;
    }
    if (count >= 3)
        obj->counts.triangles += count - 2;
    else if (obj->small_face_count++ == 0)
        obj->small_face_line = obj->lines.line_number;
}

static LsResult note_statement(Obj* obj, const char* keyword)
{
    char name[64];
    ls_text_quote(name, sizeof name, keyword);
    if (ls_name_table_find(&obj->statements, name) || obj->statements.count > MAX_NAMED_WARNINGS)
        return LS_OK;
    const uint64_t line = obj->lines.line_number;
    return ls_name_table_set(&obj->statements, name,
                             line < UINT32_MAX ? (uint32_t)line : UINT32_MAX)
               ? LS_OK
               : fail_memory(obj);
}

static void set_line(uint64_t* first, uint64_t line)
{
    if (*first == 0)
        *first = line;
}

static LsResult count_line(Obj* obj)
{
    const char* keyword = "";
    const char* arguments = "";
    uint32_t count;
    switch (read_statement(obj->lines.line, &keyword, &arguments))
    {
    case STATEMENT_POSITION:
        obj->counts.positions++;
        count = ls_text_count_words(arguments);
        obj->has_colors |= count == 6;
        if (count == 5 || count > 6)
            set_line(&obj->rest_line, obj->lines.line_number);
        break;
    case STATEMENT_TEXCOORD:
        obj->counts.texcoords++;
        break;
    case STATEMENT_NORMAL:
        obj->counts.normals++;
        break;
    case STATEMENT_FACE:
        count_face(obj, arguments);
        break;
    case STATEMENT_NAME:
        if (!obj->name && *arguments && !(obj->name = strdup(arguments)))
            return fail_memory(obj);
        break;
    case STATEMENT_LIBRARY:
        return ls_mtl_read_libraries(&obj->mtl, arguments);
    case STATEMENT_SMOOTHING:
        if (strcmp(arguments, "off") && strcmp(arguments, "0"))
            set_line(&obj->smoothing_line, obj->lines.line_number);
        break;
    case STATEMENT_OTHER:
        return note_statement(obj, keyword);
    case STATEMENT_NONE:
    case STATEMENT_MATERIAL:
        break;
    }
    return LS_OK;
}

static LsResult count_records(Obj* obj)
{
    for (;;)
    {
        bool is_end = false;
        LsResult result = ls_text_lines_next(&obj->lines, &is_end);
        if (result == LS_OK && is_end)
            break;
        if (result == LS_OK)
            result = count_line(obj);
        if (result != LS_OK)
            return result;
    }
    const Counts* counts = &obj->counts;
    if (counts->positions == 0 && counts->triangles == 0)
        return ls_error_set(obj->lines.error, LS_MESSAGE_OBJ_NOTHING,
                            "%s: no vertex and no face in it; is it an OBJ file?", obj->lines.path);
    if (counts->positions > INT_MAX || counts->texcoords >= LS_NONE || counts->normals >= LS_NONE ||
        counts->triangles >= LS_NONE)
        return ls_error_set(obj->lines.error, LS_MESSAGE_LIMIT_MESH,
                            "%s: more than 2147483647 vertices or 4294967294 triangles; split it",
                            obj->lines.path);
    return LS_OK;
}

// ---- Warnings -----------------------------------------------------------------------------------

static const char* explain_statement(const char* keyword)
{
    static const char* const free_forms[] = {"vp",    "cstype", "deg",  "bmat",  "step", "curv",
                                             "curv2", "surf",   "parm", "trim",  "hole", "scrv",
                                             "sp",    "end",    "con",  "ctech", "stech"};
    if (!strcmp(keyword, "p") || !strcmp(keyword, "l"))
        return ", it has no surface";
    for (size_t i = 0; i < sizeof free_forms / sizeof *free_forms; i++)
        if (!strcmp(keyword, free_forms[i]))
            return ", it belongs to free-form curves and surfaces; export them as polygons";
    return "";
}

static LsResult warn_of_statements(const Obj* obj)
{
    LsResult result = LS_OK;
    for (uint32_t i = 0; result == LS_OK && i < obj->statements.count; i++)
    {
        const LsNamedNumber* statement = &obj->statements.entries[i];
        if (i == MAX_NAMED_WARNINGS)
            result = ls_input_warn(obj->input, obj->lines.error, LS_MESSAGE_OBJ_STATEMENT,
                                   "%s: line %u: further statements are left out", obj->lines.path,
                                   statement->number);
        else
            result = ls_input_warn(obj->input, obj->lines.error, LS_MESSAGE_OBJ_STATEMENT,
                                   "%s: line %u: \"%s\" is left out%s", obj->lines.path,
                                   statement->number, statement->name,
                                   explain_statement(statement->name));
    }
    return result;
}

// Warns once of what has been seen first in a line; 0: never.
static LsResult warn_of_line(const Obj* obj, LsMessage message, uint64_t line, const char* text)
{
    return line == 0 ? LS_OK
                     : ls_input_warn(obj->input, obj->lines.error, message, "%s: line %llu: %s",
                                     obj->lines.path, (unsigned long long)line, text);
}

static LsResult warn_of_counted(const Obj* obj)
{
    LsResult result = warn_of_statements(obj);
    if (result == LS_OK)
        result = warn_of_line(obj, LS_MESSAGE_OBJ_VERTEX_REST, obj->rest_line,
                              "a vertex has numbers behind its position that are no weight and no "
                              "colour; they are left out");
    if (result == LS_OK && !obj->uses_normals)
        result =
            warn_of_line(obj, LS_MESSAGE_OBJ_SMOOTHING, obj->smoothing_line,
                         "smoothing groups are left out and there are no normals, so faces are "
                         "flat; export normals, or bake smooth ones");
    if (result == LS_OK && obj->small_face_count)
        result =
            ls_input_warn(obj->input, obj->lines.error, LS_MESSAGE_OBJ_SMALL_FACES,
                          "%s: line %llu: %llu faces have fewer than three corners, this is the "
                          "first; they are left out",
                          obj->lines.path, (unsigned long long)obj->small_face_line,
                          (unsigned long long)obj->small_face_count);
    if (result == LS_OK && obj->counts.triangles == 0)
        result = ls_input_warn(obj->input, obj->lines.error, LS_MESSAGE_OBJ_POINTS,
                               "%s: its %llu vertices are points without faces; they are left out",
                               obj->lines.path, (unsigned long long)obj->counts.positions);
    return result;
}

// ---- Second pass --------------------------------------------------------------------------------

static LsResult read_position(Obj* obj, const char* arguments)
{
    const uint64_t vertex = obj->done.positions++;
    float numbers[7]; // one more than a position with a colour has
    if (vertex >= obj->mesh->vertex_count)
        return ls_text_lines_fail_change(&obj->lines);
    const uint32_t count = ls_text_read_floats(arguments, numbers, 7);
    if (count < 3 || (count < 7 && count < ls_text_count_words(arguments)))
        return fail(obj, LS_MESSAGE_OBJ_NUMBER, "a vertex needs three numbers; export it again");
    memcpy(&obj->mesh->positions[3 * vertex], numbers, 3 * sizeof *numbers);
    if (count == 4 && numbers[3] != 1.0f)
        set_line(&obj->weight_line, obj->lines.line_number);
    if (!obj->has_colors)
        return LS_OK;
    float* color = &obj->mesh->streams[LS_STREAM_COLOR].values[4 * vertex];
    color[3] = 1.0f;
    for (int i = 0; i < 3; i++)
        color[i] = count == 6 ? ls_linear_from_srgb(numbers[3 + i]) : 1.0f;
    return LS_OK;
}

static LsResult read_texcoord(Obj* obj, const char* arguments)
{
    const uint64_t index = obj->done.texcoords++;
    float numbers[2] = {0.0f, 0.0f};
    if (ls_text_read_floats(arguments, numbers, 2) == 0)
        return fail(obj, LS_MESSAGE_OBJ_NUMBER,
                    "a texture coordinate needs one number or two; export it again");
    if (!obj->uses_texcoords)
        return LS_OK;
    LsInputStream* stream = &obj->mesh->streams[LS_STREAM_TEXCOORD_0];
    if (index >= stream->count)
        return ls_text_lines_fail_change(&obj->lines);
    stream->values[2 * index] = numbers[0];
    stream->values[2 * index + 1] = 1.0f - numbers[1];
    return LS_OK;
}

static LsResult read_normal(Obj* obj, const char* arguments)
{
    const uint64_t index = obj->done.normals++;
    float numbers[3];
    if (ls_text_read_floats(arguments, numbers, 3) < 3)
        return fail(obj, LS_MESSAGE_OBJ_NUMBER, "a normal needs three numbers; export it again");
    if (!obj->uses_normals)
        return LS_OK;
    LsInputStream* stream = &obj->mesh->streams[LS_STREAM_NORMAL];
    if (index >= stream->count)
        return ls_text_lines_fail_change(&obj->lines);
    memcpy(&stream->values[3 * index], numbers, sizeof numbers);
    return LS_OK;
}

// What a corner names, in the order of its numbers.
enum
{
    CORNER_POSITION,
    CORNER_TEXCOORD,
    CORNER_NORMAL,
    CORNER_NUMBERS
};

typedef struct Corner
{
    uint32_t index[CORNER_NUMBERS]; // LS_NONE: not given
} Corner;

// Reads one number of a corner: from 1, or backwards from -1, the last so far.
static LsResult read_index(const Obj* obj, const char** text, int which, uint32_t* index)
{
    static const char* const names[] = {"vertex", "texture coordinate", "normal"};
    const uint64_t counts[] = {obj->counts.positions, obj->counts.texcoords, obj->counts.normals};
    const uint64_t done[] = {obj->done.positions, obj->done.texcoords, obj->done.normals};
    char* end;
    const long long number = strtoll(*text, &end, 10);
    if (end == *text || (*end && *end != '/' && !isspace((unsigned char)*end)))
        return fail(obj, LS_MESSAGE_OBJ_NUMBER, "a corner is no number; export it again");
    const long long from_zero = number < 0 ? (long long)done[which] + number : number - 1;
    if (from_zero < 0 || (uint64_t)from_zero >= counts[which])
        return ls_error_set(obj->lines.error, LS_MESSAGE_OBJ_CORNER,
                            "%s: line %llu: a face names %s %lld, but the file has %llu, numbered "
                            "from 1; export it again",
                            obj->lines.path, (unsigned long long)obj->lines.line_number,
                            names[which], number, (unsigned long long)counts[which]);
    *index = (uint32_t)from_zero;
    *text = end;
    return LS_OK;
}

// Reads "v", "v/vt", "v//vn" or "v/vt/vn" and moves *text to the next corner.
static LsResult read_corner(const Obj* obj, const char** text, Corner* corner)
{
    *corner = (Corner){{LS_NONE, LS_NONE, LS_NONE}};
    LsResult result = read_index(obj, text, CORNER_POSITION, &corner->index[CORNER_POSITION]);
    for (int which = CORNER_TEXCOORD; result == LS_OK && which < CORNER_NUMBERS && **text == '/';
         which++)
    {
        (*text)++;
        if (**text && **text != '/' && !isspace((unsigned char)**text))
            result = read_index(obj, text, which, &corner->index[which]);
    }
    if (result == LS_OK && **text && !isspace((unsigned char)**text))
        return fail(obj, LS_MESSAGE_OBJ_NUMBER, "a corner has too many numbers; export it again");
    while (isspace((unsigned char)**text))
        (*text)++;
    return result;
}

static LsResult add_triangle(Obj* obj, const Corner* corners)
{
    LsInputMesh* mesh = obj->mesh;
    const uint64_t triangle = obj->done.triangles++;
    if (triangle >= mesh->triangle_count)
        return ls_text_lines_fail_change(&obj->lines);
    uint32_t* texcoords = mesh->streams[LS_STREAM_TEXCOORD_0].indices;
    uint32_t* normals = mesh->streams[LS_STREAM_NORMAL].indices;
    for (uint64_t i = 0; i < 3; i++)
    {
        mesh->indices[3 * triangle + i] = corners[i].index[CORNER_POSITION];
        if (texcoords)
            texcoords[3 * triangle + i] = corners[i].index[CORNER_TEXCOORD];
        if (normals)
            normals[3 * triangle + i] = corners[i].index[CORNER_NORMAL];
    }
    mesh->materials[triangle] = obj->material;
    return LS_OK;
}

// Fans a face from its first corner.
static LsResult read_face(Obj* obj, const char* arguments)
{
    if (obj->material == LS_NONE &&
        (obj->material = ls_input_default_material(obj->input)) == LS_NONE)
        return fail_memory(obj);
    Corner corners[3] = {{{0}}};
    LsResult result = LS_OK;
    for (uint64_t i = 0; result == LS_OK && *arguments; i++)
    {
        corners[1] = corners[2];
        result = read_corner(obj, &arguments, &corners[i == 0 ? 0 : 2]);
        if (result == LS_OK && i >= 2)
            result = add_triangle(obj, corners);
    }
    return result;
}

static LsResult use_material(Obj* obj, const char* name)
{
    const LsNamedNumber* known = ls_name_table_find(&obj->mtl.materials, name);
    obj->material = known ? known->number : LS_NONE;
    if (known)
        return LS_OK;
    if (!ls_name_table_set(&obj->mtl.materials, name, LS_NONE))
        return fail_memory(obj);
    if (++obj->unknown_material_count > MAX_NAMED_WARNINGS)
        return ls_input_warn(obj->input, obj->lines.error, LS_MESSAGE_OBJ_MATERIAL,
                             "%s: further materials are in no library; white is used instead",
                             obj->lines.path);
    return ls_input_warn(
        obj->input, obj->lines.error, LS_MESSAGE_OBJ_MATERIAL,
        "%s: line %llu: material \"%.200s\" is in no library; white is used instead",
        obj->lines.path, (unsigned long long)obj->lines.line_number, name);
}

static LsResult read_line(Obj* obj)
{
    const char* keyword = "";
    const char* arguments = "";
    switch (read_statement(obj->lines.line, &keyword, &arguments))
    {
    case STATEMENT_POSITION:
        return read_position(obj, arguments);
    case STATEMENT_TEXCOORD:
        return read_texcoord(obj, arguments);
    case STATEMENT_NORMAL:
        return read_normal(obj, arguments);
    case STATEMENT_FACE:
        return read_face(obj, arguments);
    case STATEMENT_MATERIAL:
        return use_material(obj, arguments);
    default: // all else the first pass has seen
        return LS_OK;
    }
}

// Fills the mesh with no more and no fewer records than the first pass counted.
static LsResult read_records(Obj* obj)
{
    for (;;)
    {
        bool is_end = false;
        LsResult result = ls_text_lines_next(&obj->lines, &is_end);
        if (result == LS_OK && !is_end)
            result = read_line(obj);
        if (result != LS_OK)
            return result;
        if (is_end)
            break;
    }
    const Counts* done = &obj->done;
    if (done->positions != obj->counts.positions || done->texcoords != obj->counts.texcoords ||
        done->normals != obj->counts.normals || done->triangles != obj->counts.triangles)
        return ls_text_lines_fail_change(&obj->lines);
    return warn_of_line(
        obj, LS_MESSAGE_OBJ_VERTEX_REST, obj->weight_line,
        "a vertex has a weight w other than 1, which polygons do not have; it is left "
        "out");
}

// ---- The file -----------------------------------------------------------------------------------

static LsResult create_mesh(Obj* obj)
{
    const Counts* counts = &obj->counts;
    uint64_t bytes = 12 * counts->positions + 16 * counts->triangles;
    if (obj->has_colors)
        bytes += 16 * counts->positions;
    if (obj->uses_texcoords)
        bytes += 8 * counts->texcoords + 12 * counts->triangles;
    if (obj->uses_normals)
        bytes += 12 * counts->normals + 12 * counts->triangles;
    const LsResult result =
        ls_input_reserve(obj->input, obj->lines.path, bytes, counts->triangles, obj->lines.error);
    if (result != LS_OK)
        return result;
    LsInputMesh* mesh =
        ls_input_add_mesh(obj->input, (uint32_t)counts->positions, (uint32_t)counts->triangles);
    LsInputInstance* instance = mesh ? ls_input_add_instance(obj->input) : NULL;
    if (!instance)
        return fail_memory(obj);
    obj->mesh = mesh;
    mesh->name = obj->name;
    obj->name = NULL;
    instance->mesh = obj->input->mesh_count - 1;
    instance->node = LS_NONE;
    for (int i = 0; i < 3; i++)
        instance->world_from_object[i][i] = 1.0;
    if ((obj->has_colors &&
         !ls_input_stream_create(mesh, LS_STREAM_COLOR, mesh->vertex_count, false)) ||
        (obj->uses_texcoords &&
         !ls_input_stream_create(mesh, LS_STREAM_TEXCOORD_0, (uint32_t)counts->texcoords, true)) ||
        (obj->uses_normals &&
         !ls_input_stream_create(mesh, LS_STREAM_NORMAL, (uint32_t)counts->normals, true)))
        return fail_memory(obj);
    return LS_OK;
}

static LsResult import_mesh(Obj* obj)
{
    LsResult result = count_records(obj);
    if (result == LS_OK)
        result = warn_of_counted(obj);
    if (result != LS_OK || obj->counts.triangles == 0)
        return result;
    result = create_mesh(obj);
    if (result != LS_OK)
        return result;
    ls_text_lines_rewind(&obj->lines);
    obj->material = LS_NONE;
    return read_records(obj);
}

LsResult ls_import_obj(LsInput* input, const char* path, LsError* error)
{
    Obj obj = {
        .lines = {.file = fopen(path, "r"),
                  .path = path,
                  .error = error,
                  .joins_lines = true,
                  .input = input,
                  .pass_count = 2},
        .input = input,
        .mtl = {.input = input, .obj_path = path, .error = error},
    };
    if (!obj.lines.file)
        return ls_text_lines_fail_read(&obj.lines);
    const LsResult result = import_mesh(&obj);
    ls_mtl_destroy(&obj.mtl);
    ls_name_table_destroy(&obj.statements);
    free(obj.name);
    ls_text_lines_close(&obj.lines);
    return result;
}

// ---- Its files ----------------------------------------------------------------------------------

// Behind the last mention of mtllib, so that the lines of a large mesh need not be parted; 0: there is none.
static uint64_t find_last_library(FILE* file)
{
    static const char keyword[] = "mtllib";
    enum
    {
        KEYWORD = sizeof keyword - 1
    };
    char block[65536];
    uint64_t begin = 0; // of the block in the file
    uint64_t last = 0;
    size_t kept = 0; // what may be the beginning of the keyword
    for (size_t got; (got = fread(block + kept, 1, sizeof block - kept, file)) > 0;)
    {
        const size_t size = kept + got;
        const char* at = block;
        while ((at = memmem(at, (size_t)(block + size - at), keyword, KEYWORD)))
        {
            at += KEYWORD;
            last = begin + (uint64_t)(at - block);
        }
        kept = size < KEYWORD - 1 ? size : KEYWORD - 1;
        memmove(block, block + size - kept, kept);
        begin += size - kept;
    }
    rewind(file);
    return last;
}

bool ls_obj_list_files(const char* path, LsNameTable* files)
{
    LsInput scratch = {0}; // takes materials and warnings, which nobody asks for
    LsError error = {0};
    LsTextLines lines = {
        .file = fopen(path, "r"), .path = path, .error = &error, .joins_lines = true};
    if (!lines.file)
        return true;
    LsMtl mtl = {.input = &scratch, .obj_path = path, .error = &error, .files = files};
    const uint64_t last = find_last_library(lines.file);
    LsResult result = LS_OK;
    bool is_end = false;
    while (result == LS_OK && !is_end && lines.taken < last)
    {
        const char* keyword = "";
        const char* arguments = "";
        result = ls_text_lines_next(&lines, &is_end);
        if (result == LS_OK && !is_end &&
            read_statement(lines.line, &keyword, &arguments) == STATEMENT_LIBRARY)
            result = ls_mtl_read_libraries(&mtl, arguments);
    }
    ls_mtl_destroy(&mtl);
    ls_text_lines_close(&lines);
    ls_input_destroy(&scratch);
    return result != LS_ERROR_MEMORY;
}
