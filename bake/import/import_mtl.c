// import_mtl.c - MTL files: the materials of an OBJ.

#include "import_mtl.h"

#include "mtl_map.h"
#include "text_lines.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// Warnings about statements of one scene, each of another word; then one more, and no more.
#define MAX_STATEMENT_WARNINGS 64
// Of all kinds together: each is compared with those before it.
#define MAX_WARNINGS 256

// Maps that are taken.
typedef enum MapKind
{
    MAP_COLOR,
    MAP_EMISSION,
    MAP_NORMAL,
    MAP_ALPHA,
    MAP_COUNT
} MapKind;

// A material being read; what it says comes together at its end.
typedef struct Draft
{
    char* name; // owned; NULL: no newmtl yet
    LsVec3 diffuse;
    LsVec3 specular;
    LsVec3 emission;
    LsVec3 filter;
    float exponent, roughness, metallic, opacity, ior;
    int illumination;
    bool has_diffuse, has_specular, has_emission, has_filter, has_exponent, has_roughness,
        has_metallic, has_illumination;
    LsMtlMap maps[MAP_COUNT];
} Draft;

typedef struct Library
{
    LsMtl* mtl;
    LsTextLines lines;
    Draft draft;
} Library;

static LsResult fail_memory(const LsMtl* mtl)
{
    return ls_error_set(mtl->error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory while reading it",
                        mtl->obj_path);
}

LsResult ls_mtl_warn(LsMtl* mtl, LsMessage message, const char* format, ...)
{
    char text[sizeof mtl->error->text];
    if (mtl->warning_count > MAX_WARNINGS)
        return LS_OK;
    if (mtl->warning_count++ == MAX_WARNINGS)
        return ls_input_warn(mtl->input, mtl->error, message,
                             "%s: there is more to say of its materials than these warnings",
                             mtl->obj_path);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return ls_input_warn(mtl->input, mtl->error, message, "%s", text);
}

// ---- A material's end ---------------------------------------------------------------------------

static float luminance(LsVec3 color)
{
    return 0.2126f * color.x + 0.7152f * color.y + 0.0722f * color.z;
}

static LsVec3 clamp_color(LsVec3 color)
{
    return (LsVec3){fminf(fmaxf(color.x, 0.0f), 1.0f), fminf(fmaxf(color.y, 0.0f), 1.0f),
                    fminf(fmaxf(color.z, 0.0f), 1.0f)};
}

static float clamp_unit(float value)
{
    return fminf(fmaxf(value, 0.0f), 1.0f);
}

static void set_reflection(const Draft* draft, LsMaterial* core)
{
    const bool is_shiny = draft->has_specular && luminance(draft->specular) > 0.0f &&
                          (!draft->has_illumination || draft->illumination >= 2);
    const bool is_mirror = (draft->illumination == 3 || draft->illumination == 5) &&
                           luminance(draft->specular) > luminance(core->base_color);
    core->roughness = 1.0f;
    if (draft->has_roughness)
        core->roughness = clamp_unit(draft->roughness);
    else if (is_shiny && draft->has_exponent)
        core->roughness = sqrtf(sqrtf(2.0f / (fmaxf(draft->exponent, 0.0f) + 2.0f)));
    if (draft->has_metallic)
        core->metallic = clamp_unit(draft->metallic);
    else if (is_mirror)
    {
        core->metallic = 1.0f;
        core->base_color = clamp_color(draft->specular);
    }
}

static LsResult set_transparency(const Library* library, LsInputMaterial* material)
{
    const Draft* draft = &library->draft;
    const int illumination = draft->illumination;
    const bool is_refracting = illumination == 6 || illumination == 7;
    const bool is_glass = is_refracting || illumination == 4 || illumination == 9;
    const float opacity = clamp_unit(draft->opacity);
    if (is_glass || (opacity < 1.0f && draft->has_filter))
    {
        material->surface.transmission = opacity < 1.0f ? 1.0f - opacity : (float)is_refracting;
        if (material->surface.transmission > 0.0f && draft->has_filter)
            material->core.base_color = clamp_color(draft->filter);
    }
    else if (opacity < 1.0f)
        return ls_mtl_warn(
            library->mtl, LS_MESSAGE_MTL_BLEND,
            "%s: material \"%.200s\" is see-through (d %g), which is not blended: it "
            "is opaque; give it illum 7 to make it glass",
            library->lines.path, draft->name, (double)opacity);
    if (draft->ior > 1.0f)
        material->surface.ior = draft->ior;
    else if (material->surface.transmission > 0.0f && draft->ior > 0.0f)
        material->surface.ior = 1.0f;
    return LS_OK;
}

static LsResult set_textures(LsMtl* mtl, const Draft* draft, LsInputMaterial* material)
{
    const LsMtlMap* maps = draft->maps;
    LsSurface* surface = &material->surface;
    bool has_holes = false;
    LsResult result = LS_OK;
    if (maps[MAP_ALPHA].file)
        result = ls_mtl_map_add_masked(mtl, &maps[MAP_COLOR], &maps[MAP_ALPHA],
                                       &surface->base_color_texture, &has_holes);
    else
        result =
            ls_mtl_map_add(mtl, &maps[MAP_COLOR], LS_TEXTURE_SRGB, &surface->base_color_texture);
    if (has_holes)
        surface->flags |= LS_SURFACE_MASK;
    if (result == LS_OK)
        result =
            ls_mtl_map_add(mtl, &maps[MAP_EMISSION], LS_TEXTURE_SRGB, &surface->emissive_texture);
    if (result == LS_OK)
        result = ls_mtl_map_add(mtl, &maps[MAP_NORMAL], 0, &surface->normal_texture);
    if (surface->normal_texture != LS_NONE)
        surface->normal_scale = maps[MAP_NORMAL].multiplier;
    return result;
}

static void destroy_draft(Draft* draft)
{
    free(draft->name);
    for (int i = 0; i < MAP_COUNT; i++)
        ls_mtl_map_destroy(&draft->maps[i]);
    *draft = (Draft){.opacity = 1.0f};
}

// Adds the material that has been read, if any.
static LsResult finish_material(Library* library)
{
    LsMtl* mtl = library->mtl;
    Draft* draft = &library->draft;
    if (!draft->name)
        return LS_OK;
    LsInputMaterial material = {.surface = LS_SURFACE_DEFAULT};
    material.core.base_color = (LsVec3){0.8f, 0.8f, 0.8f};
    if (draft->has_diffuse)
        material.core.base_color = clamp_color(draft->diffuse);
    set_reflection(draft, &material.core);
    LsResult result = set_transparency(library, &material);
    if (result == LS_OK)
        result = set_textures(mtl, draft, &material);
    LsVec3 emission = draft->emission;
    if (!draft->has_emission && material.surface.emissive_texture != LS_NONE)
        emission = (LsVec3){1.0f, 1.0f, 1.0f};
    material.core.emission =
        (LsVec3){fmaxf(emission.x, 0.0f), fmaxf(emission.y, 0.0f), fmaxf(emission.z, 0.0f)};
    if (emission.x > 0.0f || emission.y > 0.0f || emission.z > 0.0f)
        material.core.flags |= LS_MATERIAL_EMISSIVE;
    if (result == LS_OK)
        result = ls_input_reserve(mtl->input, library->lines.path,
                                  sizeof material + strlen(draft->name), 0, mtl->error);
    if (result == LS_OK)
    {
        LsInputMaterial* added = ls_input_add_material(mtl->input);
        if (!added ||
            !ls_name_table_set(&mtl->materials, draft->name, mtl->input->material_count - 1))
            return fail_memory(mtl);
        material.input_index = added->input_index;
        material.name = draft->name;
        draft->name = NULL;
        *added = material;
    }
    destroy_draft(draft);
    return result;
}

// ---- Statements ---------------------------------------------------------------------------------

static LsResult warn_of_statement(Library* library, const char* keyword, const char* what)
{
    LsMtl* mtl = library->mtl;
    char name[64];
    ls_text_quote(name, sizeof name, keyword);
    if (ls_name_table_find(&mtl->statements, name) ||
        mtl->statements.count > MAX_STATEMENT_WARNINGS)
        return LS_OK;
    if (!ls_name_table_set(&mtl->statements, name, 0))
        return fail_memory(mtl);
    if (mtl->statements.count > MAX_STATEMENT_WARNINGS)
        return ls_mtl_warn(mtl, LS_MESSAGE_MTL_STATEMENT,
                           "%s: line %llu: further statements are left out", library->lines.path,
                           (unsigned long long)library->lines.line_number);
    return ls_mtl_warn(mtl, LS_MESSAGE_MTL_STATEMENT, "%s: line %llu: \"%s\" is left out%s",
                       library->lines.path, (unsigned long long)library->lines.line_number, name,
                       what);
}

// Three numbers, or one that stands for three. Other ways to give a colour are warned of.
static LsResult read_color(Library* library, const char* keyword, const char* text, LsVec3* color,
                           bool* is_given)
{
    float numbers[3];
    if (!strncmp(text, "spectral", 8) || !strncmp(text, "xyz", 3))
        return warn_of_statement(library, keyword,
                                 ": only colours of red, green and blue are read");
    const uint32_t count = ls_text_read_floats(text, numbers, 3);
    if (count != 3 && (count != 1 || ls_text_count_words(text) != 1))
        return ls_text_lines_fail(&library->lines, LS_MESSAGE_MTL_NUMBER,
                                  "a colour needs three numbers; correct the line");
    if (count == 1)
        numbers[1] = numbers[2] = numbers[0];
    if (!isfinite(numbers[0]) || !isfinite(numbers[1]) || !isfinite(numbers[2]))
        return ls_text_lines_fail(&library->lines, LS_MESSAGE_MTL_NUMBER,
                                  "a colour is not finite; correct the line");
    *color = (LsVec3){numbers[0], numbers[1], numbers[2]};
    *is_given = true;
    return LS_OK;
}

static LsResult read_number(Library* library, const char* text, float* number, bool* is_given)
{
    if (ls_text_read_floats(text, number, 1) != 1 || !isfinite(*number))
        return ls_text_lines_fail(&library->lines, LS_MESSAGE_MTL_NUMBER,
                                  "a finite number was expected here; correct the line");
    *is_given = true;
    return LS_OK;
}

static LsResult begin_material(Library* library, const char* name)
{
    const LsResult result = finish_material(library);
    if (result != LS_OK)
        return result;
    destroy_draft(&library->draft);
    library->draft.name = strdup(name);
    return library->draft.name ? LS_OK : fail_memory(library->mtl);
}

// Whether the first word of a line is this one; capitals do not matter, as in map_Kd and map_kd.
static bool is_keyword(const char* line, const char* keyword)
{
    while (*keyword && tolower((unsigned char)*line) == tolower((unsigned char)*keyword))
    {
        line++;
        keyword++;
    }
    return !*keyword && (!*line || isspace((unsigned char)*line));
}

static LsResult read_color_statement(Library* library, const char* line, const char* arguments,
                                     bool* is_known)
{
    Draft* draft = &library->draft;
    const struct
    {
        const char* keyword;
        LsVec3* color;
        bool* is_given;
    } colors[] = {{"Kd", &draft->diffuse, &draft->has_diffuse},
                  {"Ks", &draft->specular, &draft->has_specular},
                  {"Ke", &draft->emission, &draft->has_emission},
                  {"Tf", &draft->filter, &draft->has_filter}};
    for (size_t i = 0; i < sizeof colors / sizeof *colors; i++)
        if ((*is_known = is_keyword(line, colors[i].keyword)))
            return read_color(library, colors[i].keyword, arguments, colors[i].color,
                              colors[i].is_given);
    return LS_OK;
}

static LsResult read_number_statement(Library* library, const char* line, const char* arguments,
                                      bool* is_known)
{
    Draft* draft = &library->draft;
    bool is_given = false;
    const struct
    {
        const char* keyword;
        float* number;
        bool* is_given;
    } numbers[] = {{"Ns", &draft->exponent, &draft->has_exponent},
                   {"Pr", &draft->roughness, &draft->has_roughness},
                   {"Pm", &draft->metallic, &draft->has_metallic},
                   {"Ni", &draft->ior, &is_given}};
    *is_known = true;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (is_keyword(line, numbers[i].keyword))
            return read_number(library, arguments, numbers[i].number, numbers[i].is_given);
    float number = 0.0f;
    const bool is_transparency = is_keyword(line, "Tr");
    if (is_transparency || is_keyword(line, "d"))
    {
        if (!strncmp(arguments, "-halo", 5))
            return warn_of_statement(library, "d -halo", "");
        const LsResult result = read_number(library, arguments, &number, &is_given);
        draft->opacity = is_transparency ? 1.0f - number : number;
        return result;
    }
    if (is_keyword(line, "illum"))
    {
        const LsResult result = read_number(library, arguments, &number, &draft->has_illumination);
        draft->illumination = number >= 0.0f && number <= 10.0f ? (int)number : 0;
        return result;
    }
    *is_known = false;
    return LS_OK;
}

static LsResult read_map_statement(Library* library, const char* line, const char* arguments,
                                   bool* is_known)
{
    static const struct
    {
        const char* keyword;
        MapKind kind;
    } maps[] = {{"map_Kd", MAP_COLOR},
                {"map_Ke", MAP_EMISSION},
                {"norm", MAP_NORMAL},
                {"map_d", MAP_ALPHA}};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
        if ((*is_known = is_keyword(line, maps[i].keyword)))
            return ls_mtl_map_parse(library->mtl, &library->lines, maps[i].keyword, arguments,
                                    &library->draft.maps[maps[i].kind]);
    return LS_OK;
}

static LsResult read_statement(Library* library)
{
    const char* line = library->lines.line;
    while (isspace((unsigned char)*line))
        line++;
    if (!*line || *line == '#')
        return LS_OK;
    const char* arguments = ls_text_skip_word(line);
    if (is_keyword(line, "newmtl"))
        return begin_material(library, arguments);
    // Say nothing about light that is traced.
    if (is_keyword(line, "Ka") || is_keyword(line, "sharpness"))
        return LS_OK;
    if (!library->draft.name)
        return ls_text_lines_fail(&library->lines, LS_MESSAGE_MTL_NUMBER,
                                  "stands before any newmtl; it is no MTL file, or damaged");
    bool is_known = false;
    LsResult result = read_color_statement(library, line, arguments, &is_known);
    if (!is_known)
        result = read_number_statement(library, line, arguments, &is_known);
    if (!is_known)
        result = read_map_statement(library, line, arguments, &is_known);
    if (is_known)
        return result;
    if (is_keyword(line, "bump") || is_keyword(line, "map_bump"))
        return warn_of_statement(
            library, line, ": it is a map of heights; convert it to one of normals, \"norm\"");
    return warn_of_statement(library, line, "");
}

// ---- Libraries ----------------------------------------------------------------------------------

static LsResult read_library(LsMtl* mtl, const char* path)
{
    Library library = {
        .mtl = mtl,
        .lines = {.file = fopen(path, "r"), .path = path, .error = mtl->error, .joins_lines = true},
        .draft = {.opacity = 1.0f}};
    LsResult result = library.lines.file ? LS_OK : ls_text_lines_fail_read(&library.lines);
    bool is_end = false;
    while (result == LS_OK && !is_end)
    {
        result = ls_text_lines_next(&library.lines, &is_end);
        if (result == LS_OK && !is_end)
            result = read_statement(&library);
    }
    if (result == LS_OK)
        result = finish_material(&library);
    destroy_draft(&library.draft);
    ls_text_lines_close(&library.lines);
    return result;
}

// Reads one library; *is_there tells whether there is such a file.
static LsResult find_library(LsMtl* mtl, const char* name, bool* is_there)
{
    char* path = ls_mtl_find_file(mtl, name);
    if (!path)
        return fail_memory(mtl);
    LsResult result = LS_OK;
    struct stat status;
    if (mtl->files && !ls_name_table_set(mtl->files, path, 0))
        result = fail_memory(mtl);
    // Nothing but regular files: opening a pipe could wait for ever.
    *is_there = !stat(path, &status) && S_ISREG(status.st_mode);
    if (result == LS_OK && *is_there && !ls_name_table_find(&mtl->libraries, path))
    {
        if (ls_name_table_set(&mtl->libraries, path, 0))
            result = read_library(mtl, path);
        else
            result = fail_memory(mtl);
    }
    free(path);
    return result;
}

static LsResult find_library_or_warn(LsMtl* mtl, const char* name)
{
    bool is_there = false;
    const LsResult result = find_library(mtl, name, &is_there);
    if (result != LS_OK || is_there || ls_name_table_find(&mtl->libraries, name))
        return result;
    if (!ls_name_table_set(&mtl->libraries, name, 0))
        return fail_memory(mtl);
    if (mtl->libraries.count > MAX_STATEMENT_WARNINGS)
        return LS_OK;
    return ls_mtl_warn(mtl, LS_MESSAGE_OBJ_LIBRARY,
                       "%s: its material library \"%.200s\" is not there; put it beside the OBJ",
                       mtl->obj_path, name);
}

LsResult ls_mtl_read_libraries(LsMtl* mtl, const char* names)
{
    bool is_there = false;
    LsResult result = find_library(mtl, names, &is_there);
    if (result != LS_OK || is_there)
        return result;
    char* copy = strdup(names);
    if (!copy)
        return fail_memory(mtl);
    // Several names, if the first of them is there; else one name with spaces that is not there.
    char* rest = NULL;
    char* name = strtok_r(copy, " \t", &rest);
    if (name)
        result = find_library(mtl, name, &is_there);
    if (!is_there && result == LS_OK)
        result = find_library_or_warn(mtl, names);
    while (is_there && result == LS_OK && (name = strtok_r(NULL, " \t", &rest)))
        result = find_library_or_warn(mtl, name);
    free(copy);
    return result;
}

void ls_mtl_destroy(LsMtl* mtl)
{
    ls_name_table_destroy(&mtl->materials);
    ls_name_table_destroy(&mtl->libraries);
    ls_name_table_destroy(&mtl->images);
    ls_name_table_destroy(&mtl->statements);
}
