// material_file.c - reads the JSON, checks every key and value, sets them in the input's materials.

#include "material_file.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Where in the JSON something is wrong: shown as `source: material "name": key`.
typedef struct Place
{
    const char* source; // the file, or "--material"
    char material[80];  // "material \"gold\": ", or empty
    LsError* error;
} Place;

// A name for a message: short, one line.
static const char* shown(const char* name, char text[64])
{
    snprintf(text, 64, "%s", name);
    for (char* c = text; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 127)
            *c = '?';
    return text;
}

// ---- Text ---------------------------------------------------------------------------------------

bool ls_materials_are_inline(const char* materials)
{
    return materials[strspn(materials, " \t\r\n")] == '{';
}

static LsResult check_status(const char* path, const struct stat* status, LsError* error)
{
    if (S_ISDIR(status->st_mode))
        return ls_error_set(error, LS_MESSAGE_FILE_IS_FOLDER,
                            "%s: is a directory; name a JSON file of materials in it", path);
    if (!S_ISREG(status->st_mode))
        return ls_error_set(error, LS_MESSAGE_FILE_NOT_REGULAR,
                            "%s: not a regular file; copy the materials into one", path);
    if (status->st_size == 0)
        return ls_error_set(error, LS_MESSAGE_FILE_EMPTY,
                            "%s: the file is empty; write the materials again", path);
    if (status->st_size > (off_t)LS_MATERIAL_FILE_BYTES)
        return ls_error_set(
            error, LS_MESSAGE_MATERIAL_JSON,
            "%s: has %lld bytes, more than the %u that a file of materials may have; "
            "shorten it",
            path, (long long)status->st_size, LS_MATERIAL_FILE_BYTES);
    return LS_OK;
}

// Ends with a zero byte; `text` is to be freed.
static LsResult read_text(const char* path, char** text, LsError* error)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status;
    if (descriptor < 0)
    {
        if (errno == ENOENT || errno == ENOTDIR)
            return ls_error_set(error, LS_MESSAGE_FILE_MISSING,
                                "%s: no such file; check the path of the materials", path);
        return ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE, "%s: cannot be read: %s", path,
                            strerror(errno));
    }
    LsResult result = fstat(descriptor, &status)
                          ? ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE,
                                         "%s: cannot be read: %s", path, strerror(errno))
                          : check_status(path, &status, error);
    size_t size = 0;
    if (result == LS_OK && !(*text = calloc(LS_MATERIAL_FILE_BYTES + 1, 1)))
        result = ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory", path);
    while (result == LS_OK && size < LS_MATERIAL_FILE_BYTES)
    {
        const ssize_t got = read(descriptor, *text + size, LS_MATERIAL_FILE_BYTES - size);
        if (got == 0)
            break;
        if (got > 0)
            size += (size_t)got;
        else if (errno != EINTR)
            result = ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE, "%s: cannot be read: %s", path,
                                  strerror(errno));
    }
    close(descriptor);
    if (result == LS_OK && strlen(*text) != size)
        result = ls_error_set(error, LS_MESSAGE_MATERIAL_JSON,
                              "%s: is no JSON: there is a zero byte in it", path);
    return result;
}

// ---- Values -------------------------------------------------------------------------------------

// The fields of an override, in the order of `keys`.
typedef enum Field
{
    FIELD_BASE_COLOR,
    FIELD_METALLIC,
    FIELD_ROUGHNESS,
    FIELD_EMISSIVE,
    FIELD_STRENGTH,
    FIELD_ALPHA_MODE,
    FIELD_ALPHA_CUTOFF,
    FIELD_DOUBLE_SIDED,
    FIELD_IOR,
    FIELD_TRANSMISSION,
    FIELD_COUNT
} Field;

// What an override sets: numbers[field] where is_set[field].
typedef struct Override
{
    bool is_set[FIELD_COUNT];
    float numbers[FIELD_COUNT][4];
    bool has_alpha; // baseColorFactor has four numbers
} Override;

typedef enum Type
{
    TYPE_NUMBER,
    TYPE_NUMBERS,
    TYPE_BOOL,
    TYPE_MODE
} Type;

static const struct
{
    const char* name;
    const char* home; // the object of a glTF material that has it; NULL: the material itself
    Type type;
    int least, most; // numbers, for TYPE_NUMBERS
    double upper;    // of the numbers; the lower end is 0
} keys[FIELD_COUNT] = {
    [FIELD_BASE_COLOR] = {"baseColorFactor", "pbrMetallicRoughness", TYPE_NUMBERS, 3, 4, 1.0},
    [FIELD_METALLIC] = {"metallicFactor", "pbrMetallicRoughness", TYPE_NUMBER, 1, 1, 1.0},
    [FIELD_ROUGHNESS] = {"roughnessFactor", "pbrMetallicRoughness", TYPE_NUMBER, 1, 1, 1.0},
    [FIELD_EMISSIVE] = {"emissiveFactor", NULL, TYPE_NUMBERS, 3, 3, 1.0},
    [FIELD_STRENGTH] = {"emissiveStrength", "KHR_materials_emissive_strength", TYPE_NUMBER, 1, 1,
                        1e30},
    [FIELD_ALPHA_MODE] = {"alphaMode", NULL, TYPE_MODE, 1, 1, 1.0},
    [FIELD_ALPHA_CUTOFF] = {"alphaCutoff", NULL, TYPE_NUMBER, 1, 1, 1e30},
    [FIELD_DOUBLE_SIDED] = {"doubleSided", NULL, TYPE_BOOL, 1, 1, 1.0},
    [FIELD_IOR] = {"ior", "KHR_materials_ior", TYPE_NUMBER, 1, 1, 1e30},
    [FIELD_TRANSMISSION] = {"transmissionFactor", "KHR_materials_transmission", TYPE_NUMBER, 1, 1,
                            1.0},
};

static LsResult report_value(const Place* place, const char* key, const char* wanted)
{
    char text[64];
    return ls_error_set(place->error, LS_MESSAGE_MATERIAL_VALUE, "%s: %s%s takes %s", place->source,
                        place->material, shown(key, text), wanted);
}

static bool is_within(const cJSON* item, double upper)
{
    return cJSON_IsNumber(item) && item->valuedouble >= 0.0 && item->valuedouble <= upper;
}

static LsResult read_numbers(const Place* place, Field field, const cJSON* item, Override* override)
{
    const int count = cJSON_GetArraySize(item);
    bool is_good = cJSON_IsArray(item) && count >= keys[field].least && count <= keys[field].most;
    int i = 0;
    for (const cJSON* number = is_good ? item->child : NULL; number; number = number->next)
    {
        is_good = is_good && is_within(number, keys[field].upper);
        override->numbers[field][i++] = (float)(is_good ? number->valuedouble : 0.0);
    }
    override->has_alpha = override->has_alpha || count == 4;
    if (is_good)
        return LS_OK;
    return report_value(place, keys[field].name,
                        keys[field].most == 4
                            ? "an array of 3 or 4 numbers from 0 to 1"
                            : "an array of 3 numbers from 0 to 1; emissiveStrength scales them");
}

static LsResult read_value(const Place* place, Field field, const cJSON* item, Override* override)
{
    const char* key = keys[field].name;
    float* number = override->numbers[field];
    override->is_set[field] = true;
    switch (keys[field].type)
    {
    case TYPE_NUMBERS:
        return read_numbers(place, field, item, override);
    case TYPE_BOOL:
        *number = cJSON_IsTrue(item) ? 1.0f : 0.0f;
        return cJSON_IsBool(item) ? LS_OK : report_value(place, key, "true or false");
    case TYPE_MODE:
        *number = cJSON_IsString(item) && !strcmp(item->valuestring, "MASK") ? 1.0f : 0.0f;
        return *number == 1.0f || (cJSON_IsString(item) && !strcmp(item->valuestring, "OPAQUE"))
                   ? LS_OK
                   : report_value(place, key, "\"OPAQUE\" or \"MASK\"");
    case TYPE_NUMBER:
        break;
    }
    if (!is_within(item, keys[field].upper))
        return report_value(place, key,
                            keys[field].upper == 1.0 ? "a number from 0 to 1"
                                                     : "a number that is not negative");
    *number = (float)item->valuedouble;
    if (field == FIELD_IOR && *number < 1.0f && *number != 0.0f)
        return report_value(place, key, "a number of at least 1, or 0 for infinity");
    return LS_OK;
}

// ---- Keys ---------------------------------------------------------------------------------------

static LsResult report_key(const Place* place, const char* key)
{
    char text[64];
    const size_t length = strlen(key);
    if (length >= 7 && !strcmp(key + length - 7, "Texture"))
        return ls_error_set(
            place->error, LS_MESSAGE_MATERIAL_KEY,
            "%s: %s%s: textures cannot be set here, those of the scene stay; leave it "
            "out",
            place->source, place->material, shown(key, text));
    return ls_error_set(
        place->error, LS_MESSAGE_MATERIAL_KEY,
        "%s: %sunknown key %s; known are baseColorFactor, metallicFactor, roughnessFactor, "
        "emissiveFactor, emissiveStrength, alphaMode, alphaCutoff, doubleSided, ior, "
        "transmissionFactor, and glTF's objects around them",
        place->source, place->material, shown(key, text));
}

static LsResult report_twice(const Place* place, const char* key)
{
    return ls_error_set(place->error, LS_MESSAGE_MATERIAL_KEY,
                        "%s: %s%s is there twice; leave one out", place->source, place->material,
                        key);
}

static LsResult read_field(const Place* place, const cJSON* item, const char* home,
                           Override* override)
{
    for (int field = 0; field < FIELD_COUNT; field++)
    {
        const char* own = keys[field].home;
        if (strcmp(item->string, keys[field].name) || (home && (!own || strcmp(home, own))))
            continue;
        if (override->is_set[field])
            return report_twice(place, item->string);
        return read_value(place, (Field)field, item, override);
    }
    return report_key(place, item->string);
}

// The fields in one of glTF's objects within a material.
static LsResult read_home(const Place* place, const cJSON* object, Override* override)
{
    if (!cJSON_IsObject(object))
        return report_value(place, object->string, "an object");
    const cJSON* item = NULL;
    cJSON_ArrayForEach(item, object)
    {
        const LsResult result = read_field(place, item, object->string, override);
        if (result != LS_OK)
            return result;
    }
    return LS_OK;
}

static LsResult read_extensions(const Place* place, const cJSON* extensions, Override* override)
{
    if (!cJSON_IsObject(extensions))
        return report_value(place, extensions->string, "an object");
    const cJSON* extension = NULL;
    cJSON_ArrayForEach(extension, extensions)
    {
        bool is_known = false;
        for (int field = 0; field < FIELD_COUNT; field++)
            is_known = is_known || (keys[field].home && !strncmp(keys[field].home, "KHR_", 4) &&
                                    !strcmp(keys[field].home, extension->string));
        const LsResult result =
            is_known ? read_home(place, extension, override) : report_key(place, extension->string);
        if (result != LS_OK)
            return result;
    }
    return LS_OK;
}

static LsResult read_override(const Place* place, const cJSON* material, Override* override)
{
    *override = (Override){0};
    if (!cJSON_IsObject(material))
        return report_value(place, "a material", "an object");
    const cJSON* item = NULL;
    cJSON_ArrayForEach(item, material)
    {
        LsResult result = LS_OK;
        if (!strcmp(item->string, "pbrMetallicRoughness"))
            result = read_home(place, item, override);
        else if (!strcmp(item->string, "extensions"))
            result = read_extensions(place, item, override);
        else
            result = read_field(place, item, NULL, override);
        if (result != LS_OK)
            return result;
    }
    // The importers keep the product alone.
    if (override->is_set[FIELD_STRENGTH] && !override->is_set[FIELD_EMISSIVE])
        return report_value(place, "emissiveStrength", "an emissiveFactor beside it");
    return LS_OK;
}

// ---- Setting ------------------------------------------------------------------------------------

static void set_flag(uint32_t* flags, uint32_t flag, bool is_set)
{
    *flags = is_set ? *flags | flag : *flags & ~flag;
}

static LsVec3 make_vec3(const float* numbers, float scale)
{
    return (LsVec3){scale * numbers[0], scale * numbers[1], scale * numbers[2]};
}

static void apply(const Override* override, LsInputMaterial* material)
{
    const float(*numbers)[4] = override->numbers;
    const bool* is_set = override->is_set;
    LsMaterial* core = &material->core;
    LsSurface* surface = &material->surface;
    if (is_set[FIELD_BASE_COLOR])
        core->base_color = make_vec3(numbers[FIELD_BASE_COLOR], 1.0f);
    if (override->has_alpha)
        surface->alpha = numbers[FIELD_BASE_COLOR][3];
    if (is_set[FIELD_METALLIC])
        core->metallic = numbers[FIELD_METALLIC][0];
    if (is_set[FIELD_ROUGHNESS])
        core->roughness = numbers[FIELD_ROUGHNESS][0];
    if (is_set[FIELD_EMISSIVE])
    {
        core->emission = make_vec3(numbers[FIELD_EMISSIVE],
                                   is_set[FIELD_STRENGTH] ? numbers[FIELD_STRENGTH][0] : 1.0f);
        const LsVec3 e = core->emission;
        set_flag(&core->flags, LS_MATERIAL_EMISSIVE, e.x > 0.0f || e.y > 0.0f || e.z > 0.0f);
    }
    if (is_set[FIELD_ALPHA_MODE])
        set_flag(&surface->flags, LS_SURFACE_MASK, numbers[FIELD_ALPHA_MODE][0] == 1.0f);
    if (is_set[FIELD_ALPHA_CUTOFF])
        surface->alpha_cutoff = numbers[FIELD_ALPHA_CUTOFF][0];
    if (is_set[FIELD_DOUBLE_SIDED])
        set_flag(&core->flags, LS_MATERIAL_DOUBLE_SIDED, numbers[FIELD_DOUBLE_SIDED][0] == 1.0f);
    if (is_set[FIELD_IOR])
        surface->ior = numbers[FIELD_IOR][0];
    if (is_set[FIELD_TRANSMISSION])
        surface->transmission = numbers[FIELD_TRANSMISSION][0];
}

// Whether the part uses the material that files without share; if `own` is one, it does no more.
static bool use_default(LsInput* input, const LsInputPart* part, uint32_t own)
{
    bool is_used = false;
    for (uint32_t i = part->first_mesh; input->default_material && i < input->mesh_count; i++)
    {
        const LsInputMesh* mesh = &input->meshes[i];
        for (uint32_t k = 0; k < mesh->triangle_count; k++)
            if (mesh->materials[k] == input->default_material - 1)
            {
                is_used = true;
                if (own != LS_NONE)
                    mesh->materials[k] = own;
            }
    }
    return is_used;
}

// So that other files keep the white that they share.
static LsResult own_default(LsInput* input, const LsInputPart* part, LsError* error)
{
    if (input->default_material > part->first_material)
        input->default_material = 0; // nobody else has it yet: this part's from now on
    else if (use_default(input, part, LS_NONE))
    {
        if (!ls_input_add_material(input))
            return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for a material");
        LsInputMaterial* own = &input->materials[input->material_count - 1];
        own->core = input->materials[input->default_material - 1].core;
        own->surface = input->materials[input->default_material - 1].surface;
        own->input_index = input->file_count - 1;
        use_default(input, part, input->material_count - 1);
    }
    return LS_OK;
}

static LsResult apply_to_all(LsInput* input, const LsInputPart* part, const Place* place,
                             const cJSON* material)
{
    Override override;
    LsResult result = read_override(place, material, &override);
    if (result == LS_OK)
        result = own_default(input, part, place->error);
    for (uint32_t i = part->first_material; i < input->material_count && result == LS_OK; i++)
        apply(&override, &input->materials[i]);
    return result;
}

static LsResult report_name(const LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                            const Place* place)
{
    char names[400] = "";
    char text[64];
    uint32_t count = 0;
    for (uint32_t i = part->first_material; i < input->material_count; i++)
    {
        const size_t length = strlen(names);
        if (input->materials[i].name && length < sizeof names - 70)
            snprintf(names + length, sizeof names - length, "%s\"%s\"", count++ ? ", " : "",
                     shown(input->materials[i].name, text));
    }
    return ls_error_set(place->error, LS_MESSAGE_MATERIAL_NAME,
                        "%s: %s%s has none of that name%s%s", place->source, place->material,
                        how->path, count ? ", but " : "; its materials have no names, so use \"*\"",
                        names);
}

static LsResult apply_by_name(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                              const Place* place, const cJSON* material)
{
    Override override;
    const LsResult result = read_override(place, material, &override);
    if (result != LS_OK)
        return result;
    bool is_found = false;
    for (uint32_t i = part->first_material; i < input->material_count; i++)
        if (input->materials[i].name && !strcmp(input->materials[i].name, material->string))
        {
            apply(&override, &input->materials[i]);
            is_found = true;
        }
    return is_found ? LS_OK : report_name(input, part, how, place);
}

// `is_all`: the one for all; else those by name.
static LsResult apply_list(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                           Place* place, const cJSON* list, bool is_all)
{
    if (!cJSON_IsObject(list))
        return report_value(place, "materials", "an object of materials by name");
    const cJSON* material = NULL;
    cJSON_ArrayForEach(material, list)
    {
        if (is_all != !strcmp(material->string, "*"))
            continue;
        char text[64];
        shown(material->string, text);
        // By searching, but only as long as all names are some that the part has.
        if (cJSON_GetObjectItemCaseSensitive(list, material->string) != material)
            return report_twice(place, text);
        snprintf(place->material, sizeof place->material, "material \"%s\": ", text);
        const LsResult result = is_all ? apply_to_all(input, part, place, material)
                                       : apply_by_name(input, part, how, place, material);
        place->material[0] = '\0';
        if (result != LS_OK)
            return result;
    }
    return LS_OK;
}

static LsResult apply_root(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                           Place* place, const cJSON* root)
{
    const cJSON* list = root->child;
    if (!list || strcmp(list->string, "materials"))
        return apply_to_all(input, part, place, root);
    if (list->next)
        return ls_error_set(place->error, LS_MESSAGE_MATERIAL_KEY,
                            "%s: beside \"materials\" nothing else may stand; leave the rest out",
                            place->source);
    const LsResult result = apply_list(input, part, how, place, list, true);
    return result == LS_OK ? apply_list(input, part, how, place, list, false) : result;
}

LsResult ls_input_override(LsInput* input, const LsInputPart* part, const LsBakeInput* how,
                           LsError* error)
{
    if (!how->materials)
        return LS_OK;
    const bool is_inline = ls_materials_are_inline(how->materials);
    Place place = {.source = is_inline ? "--material" : how->materials, .error = error};
    char* read = NULL;
    LsResult result = is_inline ? LS_OK : read_text(how->materials, &read, error);
    const char* text = is_inline ? how->materials : read;
    if (result == LS_OK)
    {
        const char* end = NULL;
        cJSON* root = cJSON_ParseWithLengthOpts(text, strlen(text) + 1, &end, true);
        if (!root)
            result = ls_error_set(error, LS_MESSAGE_MATERIAL_JSON,
                                  "%s: is no JSON from byte %lld on; mend it there", place.source,
                                  end ? (long long)(end - text) : 0ll);
        else if (!cJSON_IsObject(root))
            result = ls_error_set(error, LS_MESSAGE_MATERIAL_JSON,
                                  "%s: holds no object; begin it with {", place.source);
        else
            result = apply_root(input, part, how, &place, root);
        cJSON_Delete(root);
    }
    free(read);
    return result;
}
