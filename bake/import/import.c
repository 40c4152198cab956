// import.c - chooses the importer of a file and grows the arrays of an LsInput.

#include "import.h"

#include "input_files.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- Growth -------------------------------------------------------------------------------------

// Makes room for one more record and zeroes it; NULL when out of memory.
static void* add_record(void** records, uint32_t* count, uint32_t* capacity, size_t record_bytes)
{
    if (*count == *capacity)
    {
        const uint32_t grown = *capacity ? 2 * *capacity : 16;
        if (grown <= *capacity)
            return NULL;
        void* moved = realloc(*records, (size_t)grown * record_bytes);
        if (!moved)
            return NULL;
        *records = moved;
        *capacity = grown;
    }
    void* record = (char*)*records + (size_t)*count * record_bytes;
    memset(record, 0, record_bytes);
    *count += 1;
    return record;
}

LsInputMesh* ls_input_add_mesh(LsInput* input, uint32_t vertex_count, uint32_t triangle_count)
{
    LsInputMesh mesh = {
        // An array of no records still needs an address.
        .positions = calloc((size_t)vertex_count + 1, 3 * sizeof(float)),
        .vertex_count = vertex_count,
        .indices = calloc((size_t)triangle_count + 1, 3 * sizeof(uint32_t)),
        .triangle_count = triangle_count,
        .materials = calloc((size_t)triangle_count + 1, sizeof(uint32_t)),
        .input_index = input->file_count,
    };
    void* meshes = input->meshes;
    LsInputMesh* added = NULL;
    if (mesh.positions && mesh.indices && mesh.materials)
        added = add_record(&meshes, &input->mesh_count, &input->mesh_capacity, sizeof mesh);
    input->meshes = meshes;
    if (!added)
    {
        free(mesh.positions);
        free(mesh.indices);
        free(mesh.materials);
        return NULL;
    }
    *added = mesh;
    return added;
}

LsInputInstance* ls_input_add_instance(LsInput* input)
{
    void* records = input->instances;
    LsInputInstance* added =
        add_record(&records, &input->instance_count, &input->instance_capacity, sizeof *added);
    input->instances = records;
    return added;
}

LsSceneNode* ls_input_add_node(LsInput* input)
{
    void* records = input->nodes;
    LsSceneNode* added =
        add_record(&records, &input->node_count, &input->node_capacity, sizeof *added);
    input->nodes = records;
    return added;
}

LsInputMaterial* ls_input_add_material(LsInput* input)
{
    void* records = input->materials;
    LsInputMaterial* added =
        add_record(&records, &input->material_count, &input->material_capacity, sizeof *added);
    input->materials = records;
    if (added)
    {
        added->core.base_color = (LsVec3){0.8f, 0.8f, 0.8f};
        added->core.roughness = 1.0f;
        added->surface = (LsSurface)LS_SURFACE_DEFAULT;
        added->input_index = input->file_count;
    }
    return added;
}

LsTexture* ls_input_add_texture(LsInput* input)
{
    void* records = input->textures;
    LsTexture* added =
        add_record(&records, &input->texture_count, &input->texture_capacity, sizeof *added);
    input->textures = records;
    return added;
}

LsInputImage* ls_input_add_image(LsInput* input)
{
    void* records = input->images;
    LsInputImage* added =
        add_record(&records, &input->image_count, &input->image_capacity, sizeof *added);
    input->images = records;
    return added;
}

LsLamp* ls_input_add_lamp(LsInput* input)
{
    void* records = input->lamps;
    LsLamp* added = add_record(&records, &input->lamp_count, &input->lamp_capacity, sizeof *added);
    input->lamps = records;
    return added;
}

LsAnimation* ls_input_add_animation(LsInput* input)
{
    void* records = input->animations;
    LsAnimation* added =
        add_record(&records, &input->animation_count, &input->animation_capacity, sizeof *added);
    input->animations = records;
    return added;
}

LsChannel* ls_input_add_channel(LsInput* input)
{
    void* records = input->channels;
    LsChannel* added =
        add_record(&records, &input->channel_count, &input->channel_capacity, sizeof *added);
    input->channels = records;
    return added;
}

float* ls_input_add_keys(LsInput* input, uint32_t count)
{
    if (count > UINT32_MAX - input->key_count)
        return NULL;
    const uint32_t needed = input->key_count + count;
    if (needed > input->key_capacity)
    {
        const uint32_t grown = needed > UINT32_MAX / 2 ? UINT32_MAX : 2 * needed;
        float* moved = realloc(input->keys, (size_t)grown * sizeof *moved);
        if (!moved)
            return NULL;
        input->keys = moved;
        input->key_capacity = grown;
    }
    float* added = input->keys + input->key_count;
    memset(added, 0, (size_t)count * sizeof *added);
    input->key_count = needed;
    return added;
}

uint32_t ls_stream_size(LsStreamKind kind)
{
    static const uint32_t sizes[LS_STREAM_COUNT] = {3, 2, 2, 4};
    return sizes[kind];
}

bool ls_input_stream_create(LsInputMesh* mesh, LsStreamKind kind, uint32_t count, bool has_indices)
{
    LsInputStream* stream = &mesh->streams[kind];
    stream->count = count;
    stream->values = calloc((size_t)count + 1, ls_stream_size(kind) * sizeof(float));
    if (has_indices)
        stream->indices = calloc((size_t)mesh->triangle_count + 1, 3 * sizeof(uint32_t));
    return stream->values && (!has_indices || stream->indices);
}

// ---- Limits and warnings ------------------------------------------------------------------------

LsResult ls_input_reserve(LsInput* input, const char* path, uint64_t bytes, uint64_t triangles,
                          LsError* error)
{
    const LsImportOptions* options = &input->options;
    if (options->max_triangles && (input->triangle_count > options->max_triangles ||
                                   triangles > options->max_triangles - input->triangle_count))
        return ls_error_set(error, LS_MESSAGE_LIMIT_TRIANGLES,
                            "%s: with its %llu triangles the scene has more than the %llu that "
                            "--max-triangles allows; raise it or bake fewer",
                            path, (unsigned long long)triangles,
                            (unsigned long long)options->max_triangles);
    if (options->max_memory && (input->memory_bytes > options->max_memory ||
                                bytes > options->max_memory - input->memory_bytes))
        return ls_error_set(error, LS_MESSAGE_LIMIT_MEMORY,
                            "%s: reading it takes %.1f MB beside the %.1f MB in use, more than the "
                            "%.1f MB that --max-memory allows; raise it or bake less",
                            path, (double)bytes * 1e-6, (double)input->memory_bytes * 1e-6,
                            (double)options->max_memory * 1e-6);
    input->memory_bytes += bytes;
    input->triangle_count += triangles;
    return LS_OK;
}

void ls_input_note_progress(const LsInput* input, double fraction)
{
    if (input->options.progress)
        input->options.progress(input->options.progress_user, fraction);
}

static bool is_known(const LsInput* input, LsMessage message, const char* text)
{
    for (uint32_t i = 0; i < input->warning_count; i++)
        if (input->warnings[i].message == (uint32_t)message &&
            !strcmp(input->warnings[i].text, text))
            return true;
    return false;
}

LsResult ls_input_warn(LsInput* input, LsError* error, LsMessage message, const char* format, ...)
{
    char words[sizeof error->text];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    if (input->options.strict)
        return ls_error_set(error, (int)message, "%s", words);
    LsError plain; // without what no terminal should be sent
    ls_error_set(&plain, (int)message, "%s", words);
    const char* text = plain.text;
    if (is_known(input, message, text))
        return LS_OK;
    void* records = input->warnings;
    LsInputWarning* added =
        add_record(&records, &input->warning_count, &input->warning_capacity, sizeof *added);
    input->warnings = records;
    char* copy = strdup(text);
    if (!added || !copy)
    {
        input->warning_count -= added != NULL;
        free(copy);
        return ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "out of memory for a warning");
    }
    *added = (LsInputWarning){(uint32_t)message, input->file_count, copy};
    return LS_OK;
}

LsCamera* ls_input_add_camera(LsInput* input)
{
    void* records = input->cameras;
    LsCamera* added =
        add_record(&records, &input->camera_count, &input->camera_capacity, sizeof *added);
    input->cameras = records;
    return added;
}

uint32_t ls_input_default_material(LsInput* input)
{
    if (!input->default_material)
    {
        if (!ls_input_add_material(input))
            return LS_NONE;
        input->default_material = input->material_count;
    }
    return input->default_material - 1;
}

LsInputMesh* ls_input_add_plain_mesh(LsInput* input, uint32_t vertex_count, uint32_t triangle_count)
{
    const uint32_t material = ls_input_default_material(input);
    LsInputMesh* mesh = ls_input_add_mesh(input, vertex_count, triangle_count);
    LsInputInstance* instance = ls_input_add_instance(input);
    if (material == LS_NONE || !mesh || !instance)
        return NULL;
    for (uint32_t i = 0; i < triangle_count; i++)
        mesh->materials[i] = material;
    instance->mesh = input->mesh_count - 1;
    instance->node = LS_NONE;
    for (size_t i = 0; i < 3; i++)
        instance->world_from_object[i][i] = 1.0;
    return mesh;
}

void ls_input_destroy(LsInput* input)
{
    for (uint32_t i = 0; i < input->mesh_count; i++)
    {
        free(input->meshes[i].positions);
        free(input->meshes[i].indices);
        free(input->meshes[i].materials);
        free(input->meshes[i].name);
        for (int kind = 0; kind < LS_STREAM_COUNT; kind++)
        {
            free(input->meshes[i].streams[kind].values);
            free(input->meshes[i].streams[kind].indices);
        }
    }
    for (uint32_t i = 0; i < input->material_count; i++)
        free(input->materials[i].name);
    for (uint32_t i = 0; i < input->image_count; i++)
        free(input->images[i].pixels);
    for (uint32_t i = 0; i < input->warning_count; i++)
        free(input->warnings[i].text);
    free(input->meshes);
    free(input->instances);
    free(input->nodes);
    free(input->materials);
    free(input->cameras);
    free(input->textures);
    free(input->images);
    free(input->lamps);
    free(input->animations);
    free(input->channels);
    free(input->keys);
    free(input->warnings);
    for (uint32_t i = 0; i < input->file_count; i++)
        free(input->paths[i]);
    free(input->paths);
    *input = (LsInput){0};
}

// ---- Dispatch -----------------------------------------------------------------------------------

static LsResult check_readable(const char* path, LsError* error)
{
    struct stat status;
    if (stat(path, &status))
    {
        if (errno == ENOENT || errno == ENOTDIR)
            return ls_error_set(error, LS_MESSAGE_FILE_MISSING,
                                "%s: no such file; check the path of the scene", path);
        return ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE, "%s: cannot be read: %s", path,
                            strerror(errno));
    }
    if (S_ISDIR(status.st_mode))
        return ls_error_set(error, LS_MESSAGE_FILE_IS_FOLDER,
                            "%s: is a directory; name a scene file in it", path);
    if (access(path, R_OK))
        return ls_error_set(error, LS_MESSAGE_FILE_UNREADABLE, "%s: cannot be read: %s", path,
                            strerror(errno));
    if (!S_ISREG(status.st_mode))
        return ls_error_set(error, LS_MESSAGE_FILE_NOT_REGULAR,
                            "%s: not a regular file; copy the scene into one", path);
    if (status.st_size == 0)
        return ls_error_set(error, LS_MESSAGE_FILE_EMPTY, "%s: the file is empty; export it again",
                            path);
    return LS_OK;
}

// How files of an ending are read. Without `list_files` a file is all by itself.
typedef struct Format
{
    const char* ending;
    uint32_t kind; // equal for endings that are read alike
    LsResult (*import)(LsInput* input, const char* path, LsError* error);
    bool (*list_files)(const char* path, LsNameTable* files);
} Format;

static const Format* find_format(const char* path)
{
    static const Format formats[] = {
        {".gltf", 1, ls_import_gltf, ls_gltf_list_files},
        {".glb", 1, ls_import_gltf, ls_gltf_list_files},
        {".obj", 2, ls_import_obj, ls_obj_list_files},
        {".ply", 3, ls_import_ply, NULL},
        {".off", 4, ls_import_off, NULL},
        {".stl", 5, ls_import_stl, NULL},
    };
    const char* name = strrchr(path, '/');
    const char* ending = strrchr(name ? name : path, '.');
    for (size_t i = 0; ending && i < sizeof formats / sizeof *formats; i++)
        if (!strcasecmp(ending, formats[i].ending))
            return &formats[i];
    return NULL;
}

uint32_t ls_import_kind(const char* path)
{
    const Format* format = find_format(path);
    return format ? format->kind : 0;
}

bool ls_input_list_files(const char* path, LsNameTable* files)
{
    if (!ls_name_table_set(files, path, 0))
        return false;
    const Format* format = find_format(path);
    struct stat status;
    // Opening a pipe could wait for ever.
    return !format || !format->list_files || stat(path, &status) || !S_ISREG(status.st_mode) ||
           format->list_files(path, files);
}

static LsResult add_path(LsInput* input, const char* path, LsError* error)
{
    void* records = input->paths;
    char** added = add_record(&records, &input->file_count, &input->path_capacity, sizeof *added);
    input->paths = records;
    if (added)
        *added = strdup(path);
    return added && *added
               ? LS_OK
               : ls_error_set(error, LS_MESSAGE_OUT_OF_MEMORY, "%s: out of memory", path);
}

LsResult ls_import(LsInput* input, const char* path, LsError* error)
{
    const LsResult readable = check_readable(path, error);
    if (readable != LS_OK)
        return readable;
    const Format* format = find_format(path);
    if (!format)
        return ls_error_set(
            error, LS_MESSAGE_INPUT_ENDING,
            "%s: unknown ending; scenes end in .gltf, .glb, .obj, .ply, .off or .stl", path);
    const LsResult result = format->import(input, path, error);
    return result == LS_OK ? add_path(input, path, error) : result;
}
