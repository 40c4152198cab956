// import_obj.c - OBJ files with the colours of their MTL.
//
// A reader of our own, because numbers of faces must stay those of the file: OpenMesh 9's OBJ
// reader takes repeated corners out of faces and skips faces that become too small, and skips
// vertices that it cannot parse, before any importer sees them; it also rounds colours to 8 bits.
// Faces come as they are, polygons fanned; all groups of a file are one mesh. Texture coordinates,
// normals, points, lines and curves are left.

#include "import.h"
#include "text_lines.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- Lines --------------------------------------------------------------------------------------

// What follows the keyword, or NULL if the line begins with another.
static char* find_arguments(char* line, const char* keyword)
{
    while (isspace((unsigned char)*line))
        line++;
    const size_t length = strlen(keyword);
    if (strncmp(line, keyword, length) || (line[length] && !isspace((unsigned char)line[length])))
        return NULL;
    line += length;
    while (isspace((unsigned char)*line))
        line++;
    return line;
}

// The corners of a face line without a comment behind them, or NULL.
static const char* find_corners(char* line)
{
    char* corners = find_arguments(line, "f");
    if (corners)
        corners[strcspn(corners, "#")] = 0;
    return corners;
}

static uint32_t count_words(const char* text)
{
    uint32_t count = 0;
    for (; *text; text = ls_text_skip_word(text))
        count++;
    return count;
}

// ---- Materials ----------------------------------------------------------------------------------

typedef struct NamedMaterial
{
    char* name; // owned
    uint32_t material;
} NamedMaterial;

typedef struct MaterialNames
{
    NamedMaterial* names;
    uint32_t count;
} MaterialNames;

static LsResult add_named_material(MaterialNames* names, LsInput* input, const char* name,
                                   const LsTextLines* reader)
{
    NamedMaterial* moved = realloc(names->names, (names->count + 1) * sizeof *moved);
    if (moved)
        names->names = moved;
    char* copy = strdup(name);
    const bool is_added = ls_input_add_material(input) != NULL;
    if (!moved || !copy || !is_added)
    {
        free(copy);
        return ls_text_lines_fail(reader, LS_ERROR_MEMORY, "out of memory");
    }
    names->names[names->count++] = (NamedMaterial){copy, input->material_count - 1};
    return LS_OK;
}

// The last definition of a name counts, as a later library overrides an earlier one.
static uint32_t find_material(const MaterialNames* names, const char* name)
{
    for (uint32_t i = names->count; i-- > 0;)
        if (!strcmp(names->names[i].name, name))
            return names->names[i].material;
    return LS_NONE;
}

static void destroy_names(MaterialNames* names)
{
    for (uint32_t i = 0; i < names->count; i++)
        free(names->names[i].name);
    free(names->names);
}

static LsResult read_mtl_line(LsTextLines* reader, LsInput* input, MaterialNames* names)
{
    const char* arguments = find_arguments(reader->line, "newmtl");
    if (arguments)
        return add_named_material(names, input, arguments, reader);
    const bool is_emission = find_arguments(reader->line, "Ke") != NULL;
    arguments = find_arguments(reader->line, is_emission ? "Ke" : "Kd");
    if (!arguments)
        return LS_OK;
    float color[3];
    if (names->count == 0)
        return ls_text_lines_fail(reader, LS_ERROR_INPUT_FORMAT,
                                  "a colour stands before any newmtl");
    if (!ls_text_read_floats(arguments, color))
        return ls_text_lines_fail(reader, LS_ERROR_INPUT_FORMAT, "a colour needs three numbers");
    for (int i = 0; i < 3; i++)
    {
        if (!isfinite(color[i]))
            return ls_text_lines_fail(reader, LS_ERROR_INPUT_FORMAT, "a colour is not finite");
        color[i] = fmaxf(color[i], 0.0f);
        if (!is_emission)
            color[i] = fminf(color[i], 1.0f);
    }
    LsMaterial* material = &input->materials[names->names[names->count - 1].material].core;
    if (!is_emission)
    {
        material->base_color = (LsVec3){color[0], color[1], color[2]};
        return LS_OK;
    }
    material->emission = (LsVec3){color[0], color[1], color[2]};
    material->flags &= ~LS_MATERIAL_EMISSIVE;
    if (color[0] > 0.0f || color[1] > 0.0f || color[2] > 0.0f)
        material->flags |= LS_MATERIAL_EMISSIVE;
    return LS_OK;
}

// Reads a material library beside the OBJ. One that cannot be opened leaves its materials unknown,
// and faces that use them get the default.
static LsResult read_mtl(const LsTextLines* obj, const char* name, LsInput* input,
                         MaterialNames* names)
{
    const char* slash = strrchr(obj->path, '/');
    const size_t folder_length = slash && name[0] != '/' ? (size_t)(slash + 1 - obj->path) : 0;
    char* path = malloc(folder_length + strlen(name) + 1);
    if (!path)
        return ls_text_lines_fail(obj, LS_ERROR_MEMORY, "out of memory");
    memcpy(path, obj->path, folder_length);
    strcpy(path + folder_length, name);

    LsResult result = LS_OK;
    LsTextLines reader = {
        .file = fopen(path, "r"), .path = path, .error = obj->error, .joins_lines = true};
    bool is_end = !reader.file;
    while (result == LS_OK && !is_end)
    {
        result = ls_text_lines_next(&reader, &is_end);
        if (result == LS_OK && !is_end)
            result = read_mtl_line(&reader, input, names);
    }
    ls_text_lines_close(&reader);
    free(path);
    return result;
}

// ---- Geometry -----------------------------------------------------------------------------------

// First pass: how much there is.
static LsResult count_records(LsTextLines* reader, uint32_t* vertex_count, uint32_t* triangle_count)
{
    uint64_t vertices = 0;
    uint64_t triangles = 0;
    for (;;)
    {
        bool is_end = false;
        const LsResult result = ls_text_lines_next(reader, &is_end);
        if (result != LS_OK)
            return result;
        if (is_end)
            break;
        const char* corners = find_corners(reader->line);
        if (corners)
        {
            const uint32_t count = count_words(corners);
            if (count < 3)
                return ls_text_lines_fail(
                    reader, LS_ERROR_INPUT_FORMAT,
                    "a face of fewer than three corners; remove it or export again");
            triangles += count - 2;
        }
        else if (find_arguments(reader->line, "v"))
            vertices++;
    }
    if (vertices == 0 && triangles == 0)
        return ls_error_set(reader->error, LS_ERROR_INPUT_FORMAT,
                            "%s: no vertex and no face in it; is it an OBJ file?", reader->path);
    if (vertices > INT_MAX || triangles >= LS_NONE)
        return ls_error_set(reader->error, LS_ERROR_INPUT_LIMIT,
                            "%s: more than 2147483647 vertices or 4294967294 triangles; split it",
                            reader->path);
    *vertex_count = (uint32_t)vertices;
    *triangle_count = (uint32_t)triangles;
    return LS_OK;
}

// The vertex of a corner "v", "v/vt", "v//vn" or "v/vt/vn": from 1, or backwards from -1.
static LsResult read_corner(const LsTextLines* reader, const char** text, uint32_t vertices_so_far,
                            uint32_t vertex_count, uint32_t* vertex)
{
    char* end;
    const long long number = strtoll(*text, &end, 10);
    if (end == *text || (*end && *end != '/' && !isspace((unsigned char)*end)))
        return ls_text_lines_fail(reader, LS_ERROR_INPUT_FORMAT,
                                  "a corner is no number; export it again");
    const long long index = number < 0 ? vertices_so_far + number : number - 1;
    if (index < 0 || index >= vertex_count)
        return ls_error_set(reader->error, LS_ERROR_INPUT_INDEX,
                            "%s: line %llu: a face names vertex %lld, but the file has %u "
                            "vertices; export it again",
                            reader->path, (unsigned long long)reader->line_number, number,
                            vertex_count);
    *vertex = (uint32_t)index;
    while (*end && !isspace((unsigned char)*end))
        end++;
    while (isspace((unsigned char)*end))
        end++;
    *text = end;
    return LS_OK;
}

// Second pass: vertices, faces and their materials, no more and no fewer than the first counted.
static LsResult read_records(LsTextLines* reader, LsInput* input, LsInputMesh* mesh,
                             MaterialNames* names)
{
    uint32_t vertex = 0;
    uint32_t triangle = 0;
    uint32_t material = LS_NONE;
    for (;;)
    {
        bool is_end = false;
        LsResult result = ls_text_lines_next(reader, &is_end);
        if (result != LS_OK)
            return result;
        if (is_end)
            return vertex == mesh->vertex_count && triangle == mesh->triangle_count
                       ? LS_OK
                       : ls_text_lines_fail_change(reader);
        const char* arguments;
        if ((arguments = find_arguments(reader->line, "v")))
        {
            if (vertex == mesh->vertex_count)
                return ls_text_lines_fail_change(reader);
            if (!ls_text_read_floats(arguments, &mesh->positions[3 * (size_t)vertex]))
                return ls_text_lines_fail(reader, LS_ERROR_INPUT_FORMAT,
                                          "a vertex needs three numbers; export it again");
            vertex++;
        }
        else if ((arguments = find_corners(reader->line)))
        {
            if (material == LS_NONE && (material = ls_input_default_material(input)) == LS_NONE)
                return ls_text_lines_fail(reader, LS_ERROR_MEMORY, "out of memory");
            uint32_t corners[3] = {0};
            for (uint32_t i = 0; *arguments; i++)
            {
                corners[1] = corners[2];
                result = read_corner(reader, &arguments, vertex, mesh->vertex_count,
                                     &corners[i == 0 ? 0 : 2]);
                if (result != LS_OK)
                    return result;
                if (i < 2)
                    continue;
                if (triangle == mesh->triangle_count)
                    return ls_text_lines_fail_change(reader);
                memcpy(&mesh->indices[3 * (size_t)triangle], corners, sizeof corners);
                mesh->materials[triangle++] = material;
            }
        }
        else if ((arguments = find_arguments(reader->line, "mtllib")))
        {
            result = read_mtl(reader, arguments, input, names);
            if (result != LS_OK)
                return result;
        }
        else if ((arguments = find_arguments(reader->line, "usemtl")))
            material = find_material(names, arguments);
    }
}

static LsResult import_mesh(LsTextLines* reader, LsInput* input, MaterialNames* names)
{
    uint32_t vertex_count = 0;
    uint32_t triangle_count = 0;
    const LsResult result = count_records(reader, &vertex_count, &triangle_count);
    if (result != LS_OK || triangle_count == 0)
        return result;
    ls_text_lines_rewind(reader);

    LsInputMesh* mesh = ls_input_add_mesh(input, vertex_count, triangle_count);
    LsInputInstance* instance = mesh ? ls_input_add_instance(input) : NULL;
    if (!instance)
        return ls_error_set(reader->error, LS_ERROR_MEMORY, "%s: out of memory while reading it",
                            reader->path);
    instance->mesh = input->mesh_count - 1;
    instance->node = LS_NONE;
    for (int i = 0; i < 3; i++)
        instance->world_from_object[i][i] = 1.0;
    return read_records(reader, input, mesh, names);
}

LsResult ls_import_obj(LsInput* input, const char* path, LsError* error)
{
    LsTextLines reader = {
        .file = fopen(path, "r"), .path = path, .error = error, .joins_lines = true};
    if (!reader.file)
        return ls_error_set(error, LS_ERROR_FILE_READ, "%s: cannot be read: %s", path,
                            strerror(errno));
    MaterialNames names = {0};
    const LsResult result = import_mesh(&reader, input, &names);
    destroy_names(&names);
    ls_text_lines_close(&reader);
    return result;
}
