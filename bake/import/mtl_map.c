// mtl_map.c - the textures of MTL materials: options, files, and the images they become.

#include "mtl_map.h"

#include "image_file.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static LsResult fail_memory(const LsMtl* mtl)
{
    return ls_error_set(mtl->error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory while reading it",
                        mtl->obj_path);
}

// ---- Statements ---------------------------------------------------------------------------------

void ls_mtl_map_destroy(LsMtlMap* map)
{
    free(map->file);
    *map = (LsMtlMap){0};
}

// Reads the one to three numbers of an option, as many as there are, and moves *text behind them. A
// last word is the file, even if it looks like a number.
static uint32_t take_numbers(const char** text, float numbers[3])
{
    uint32_t count = 0;
    while (count < 3 && *ls_text_skip_word(*text) &&
           ls_text_read_floats(*text, &numbers[count], 1) && isfinite(numbers[count]))
    {
        *text = ls_text_skip_word(*text);
        count++;
    }
    return count;
}

static bool is_word(const char* text, const char* word)
{
    const size_t length = strlen(word);
    return !strncmp(text, word, length) && (!text[length] || isspace((unsigned char)text[length]));
}

// Options with how many words follow them; 0: one to three numbers.
static const struct
{
    const char* name;
    uint32_t word_count;
} options[] = {
    {"-s", 0},       {"-o", 0},      {"-t", 0},     {"-clamp", 1}, {"-bm", 1},
    {"-blendu", 1},  {"-blendv", 1}, {"-boost", 1}, {"-mm", 2},    {"-texres", 1},
    {"-imfchan", 1}, {"-cc", 1},     {"-type", 1},
};

// Takes the option at *text, which moves behind it; *is_taken is false if there is none.
static LsResult take_option(LsMtl* mtl, const LsTextLines* lines, const char* keyword,
                            const char** text, LsMtlMap* map, bool* is_taken)
{
    size_t i = 0;
    while (i < sizeof options / sizeof *options && !is_word(*text, options[i].name))
        i++;
    *is_taken = i < sizeof options / sizeof *options;
    if (!*is_taken)
        return LS_OK;
    const char* name = options[i].name;
    *text = ls_text_skip_word(*text);
    const char* value = *text;
    float numbers[3] = {0.0f, 0.0f, 0.0f};
    uint32_t count = 0;
    if (options[i].word_count == 0 || !strcmp(name, "-bm"))
        count = take_numbers(text, numbers);
    else
        for (uint32_t k = 0; k < options[i].word_count; k++)
            *text = ls_text_skip_word(*text);
    if (!strcmp(name, "-s") && count)
    {
        map->scale[0] = numbers[0];
        map->scale[1] = count > 1 ? numbers[1] : 1.0f;
    }
    else if (!strcmp(name, "-o") && count)
    {
        map->offset[0] = numbers[0];
        map->offset[1] = count > 1 ? numbers[1] : 0.0f;
    }
    else if (!strcmp(name, "-bm") && count)
        map->multiplier = numbers[0];
    else if (!strcmp(name, "-clamp") && (is_word(value, "on") || is_word(value, "off")))
        map->is_clamped = is_word(value, "on");
    else
        return ls_mtl_warn(mtl, LS_MESSAGE_MTL_OPTION, "%s: line %llu: option %s of %s is left out",
                           lines->path, (unsigned long long)lines->line_number, name, keyword);
    return LS_OK;
}

LsResult ls_mtl_map_parse(LsMtl* mtl, const LsTextLines* lines, const char* keyword,
                          const char* arguments, LsMtlMap* map)
{
    ls_mtl_map_destroy(map);
    map->scale[0] = map->scale[1] = map->multiplier = 1.0f;
    for (bool is_taken = true; is_taken;)
    {
        const LsResult result = take_option(mtl, lines, keyword, &arguments, map, &is_taken);
        if (result != LS_OK)
            return result;
    }
    if (!*arguments)
        return ls_mtl_warn(mtl, LS_MESSAGE_MTL_IMAGE,
                           "%s: line %llu: %s names no file; it is left out", lines->path,
                           (unsigned long long)lines->line_number, keyword);
    map->file = strdup(arguments);
    return map->file ? LS_OK : fail_memory(mtl);
}

// ---- Files --------------------------------------------------------------------------------------

char* ls_mtl_find_file(const LsMtl* mtl, const char* name)
{
    const char* slash = strrchr(mtl->obj_path, '/');
    const size_t folder_length = slash && *name != '/' ? (size_t)(slash + 1 - mtl->obj_path) : 0;
    char* path = malloc(folder_length + strlen(name) + 1);
    if (!path)
        return NULL;
    memcpy(path, mtl->obj_path, folder_length);
    strcpy(path + folder_length, name);
    struct stat status;
    if (stat(path, &status) && strchr(name, '\\'))
        for (char* at = path + folder_length; *at; at++)
            if (*at == '\\')
                *at = '/';
    return path;
}

// The image at a path as an index into LsInput.images, LS_NONE if it is left out.
static LsResult find_image(LsMtl* mtl, const char* file, uint32_t* index)
{
    char* path = ls_mtl_find_file(mtl, file);
    if (!path)
        return fail_memory(mtl);
    const LsNamedNumber* known = ls_name_table_find(&mtl->images, path);
    LsResult result = LS_OK;
    *index = known ? known->number : LS_NONE;
    if (mtl->files)
        result = ls_name_table_set(mtl->files, path, 0) ? LS_OK : fail_memory(mtl);
    else if (!known)
    {
        LsInputImage image;
        const char* why = NULL;
        result = ls_image_file_read(mtl->input, path, &image, &why, mtl->error);
        if (result == LS_OK && why)
            result =
                ls_mtl_warn(mtl, LS_MESSAGE_MTL_IMAGE, "%s: its texture \"%.200s\" is left out: %s",
                            mtl->obj_path, file, why);
        else if (result == LS_OK)
        {
            LsInputImage* added = ls_input_add_image(mtl->input);
            if (added)
                *added = image;
            else
                free(image.pixels);
            *index = mtl->input->image_count - 1;
            result = added ? LS_OK : fail_memory(mtl);
        }
        if (result == LS_OK && !ls_name_table_set(&mtl->images, path, *index))
            result = fail_memory(mtl);
    }
    free(path);
    return result;
}

// ---- Textures -----------------------------------------------------------------------------------

// OBJ counts v from the bottom: v' = s v + o becomes, with w = 1 - v, w' = s w + 1 - s - o.
static LsResult add_texture(LsMtl* mtl, const LsMtlMap* map, uint32_t image, uint32_t flags,
                            uint32_t* texture)
{
    LsTexture* added = ls_input_add_texture(mtl->input);
    if (!added)
        return fail_memory(mtl);
    added->row_u = (LsVec4){map->scale[0], 0.0f, map->offset[0], 0.0f};
    added->row_v = (LsVec4){0.0f, map->scale[1], 1.0f - map->scale[1] - map->offset[1], 0.0f};
    added->image = image;
    added->flags = flags | (map->is_clamped ? LS_TEXTURE_CLAMP_U | LS_TEXTURE_CLAMP_V : 0);
    *texture = mtl->input->texture_count - 1;
    return LS_OK;
}

LsResult ls_mtl_map_add(LsMtl* mtl, const LsMtlMap* map, uint32_t texture_flags, uint32_t* texture)
{
    if (!map->file)
        return LS_OK;
    uint32_t image = LS_NONE;
    *texture = LS_NONE;
    const LsResult result = find_image(mtl, map->file, &image);
    return result == LS_OK && image != LS_NONE
               ? add_texture(mtl, map, image, texture_flags, texture)
               : result;
}

static bool has_alpha(const LsInputImage* image)
{
    for (size_t i = 0; i < (size_t)image->width * image->height; i++)
        if (image->pixels[i] >> 24 != 255)
            return true;
    return false;
}

// Alpha of a pixel of a map_d: its own, or how bright it is.
static uint32_t get_alpha(uint32_t pixel, bool uses_alpha)
{
    if (uses_alpha)
        return pixel >> 24;
    return (54 * (pixel & 255) + 183 * (pixel >> 8 & 255) + 19 * (pixel >> 16 & 255)) / 256;
}

static LsResult add_masked_image(LsMtl* mtl, uint32_t color, uint32_t alpha, uint32_t* index)
{
    const LsInputImage alpha_image = mtl->input->images[alpha];
    const size_t count = (size_t)alpha_image.width * alpha_image.height;
    const LsResult result =
        ls_input_reserve(mtl->input, mtl->obj_path, 4 * (uint64_t)count, 0, mtl->error);
    if (result != LS_OK)
        return result;
    uint32_t* pixels = malloc(4 * count);
    LsInputImage* added = pixels ? ls_input_add_image(mtl->input) : NULL;
    if (!added)
    {
        free(pixels);
        return fail_memory(mtl);
    }
    const uint32_t* colors = color == LS_NONE ? NULL : mtl->input->images[color].pixels;
    const bool uses_alpha = has_alpha(&alpha_image);
    for (size_t i = 0; i < count; i++)
        pixels[i] = (colors ? colors[i] & 0xFFFFFF : 0xFFFFFF) |
                    get_alpha(alpha_image.pixels[i], uses_alpha) << 24;
    *added = (LsInputImage){alpha_image.width, alpha_image.height, pixels};
    *index = mtl->input->image_count - 1;
    return LS_OK;
}

static bool are_placed_alike(const LsMtlMap* a, const LsMtlMap* b)
{
    return a->scale[0] == b->scale[0] && a->scale[1] == b->scale[1] &&
           a->offset[0] == b->offset[0] && a->offset[1] == b->offset[1] &&
           a->is_clamped == b->is_clamped;
}

LsResult ls_mtl_map_add_masked(LsMtl* mtl, const LsMtlMap* color, const LsMtlMap* alpha,
                               uint32_t* texture, bool* has_holes)
{
    uint32_t color_image = LS_NONE;
    uint32_t alpha_image = LS_NONE;
    *has_holes = false;
    LsResult result = find_image(mtl, alpha->file, &alpha_image);
    if (result == LS_OK && color->file)
        result = find_image(mtl, color->file, &color_image);
    if (result != LS_OK)
        return result;
    if (alpha_image == LS_NONE)
        return ls_mtl_map_add(mtl, color, LS_TEXTURE_SRGB, texture);
    const LsInputImage* images = mtl->input->images;
    if (color_image != LS_NONE && (!are_placed_alike(color, alpha) ||
                                   images[color_image].width != images[alpha_image].width ||
                                   images[color_image].height != images[alpha_image].height))
    {
        result = ls_mtl_warn(mtl, LS_MESSAGE_MTL_ALPHA_MAP,
                             "%s: map_d \"%.200s\" is left out, since its size or place differs "
                             "from that of map_Kd \"%.200s\"",
                             mtl->obj_path, alpha->file, color->file);
        return result == LS_OK ? ls_mtl_map_add(mtl, color, LS_TEXTURE_SRGB, texture) : result;
    }
    uint32_t image = color_image;
    if (color_image != alpha_image || !has_alpha(&images[color_image]))
        result = add_masked_image(mtl, color_image, alpha_image, &image);
    *has_holes = result == LS_OK;
    return result == LS_OK
               ? add_texture(mtl, color->file ? color : alpha, image, LS_TEXTURE_SRGB, texture)
               : result;
}
