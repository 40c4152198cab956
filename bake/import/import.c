// import.c - chooses the importer of a file and grows the arrays of an LsInput.

#include "import.h"

#include <errno.h>
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

LsMaterial* ls_input_add_material(LsInput* input)
{
    void* records = input->materials;
    LsMaterial* added =
        add_record(&records, &input->material_count, &input->material_capacity, sizeof *added);
    input->materials = records;
    return added;
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
        LsMaterial* material = ls_input_add_material(input);
        if (!material)
            return LS_NONE;
        material->base_color = (LsVec3){0.8f, 0.8f, 0.8f};
        material->roughness = 1.0f;
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
    }
    free(input->meshes);
    free(input->instances);
    free(input->nodes);
    free(input->materials);
    free(input->cameras);
    *input = (LsInput){0};
}

// ---- Dispatch -----------------------------------------------------------------------------------

static LsResult check_readable(const char* path, LsError* error)
{
    struct stat status;
    if (stat(path, &status))
    {
        if (errno == ENOENT || errno == ENOTDIR)
            return ls_error_set(error, LS_ERROR_FILE_MISSING,
                                "%s: no such file; check the path of the scene", path);
        return ls_error_set(error, LS_ERROR_FILE_READ, "%s: cannot be read: %s", path,
                            strerror(errno));
    }
    if (S_ISDIR(status.st_mode))
        return ls_error_set(error, LS_ERROR_FILE_IS_DIRECTORY,
                            "%s: is a directory; name a scene file in it", path);
    if (access(path, R_OK))
        return ls_error_set(error, LS_ERROR_FILE_READ, "%s: cannot be read: %s", path,
                            strerror(errno));
    if (!S_ISREG(status.st_mode))
        return ls_error_set(error, LS_ERROR_FILE_READ,
                            "%s: not a regular file; copy the scene into one", path);
    if (status.st_size == 0)
        return ls_error_set(error, LS_ERROR_FILE_EMPTY, "%s: the file is empty; export it again",
                            path);
    return LS_OK;
}

typedef LsResult Importer(LsInput* input, const char* path, LsError* error);

static Importer* find_importer(const char* path)
{
    static const struct
    {
        const char* ending;
        Importer* importer;
    } importers[] = {
        {".gltf", ls_import_gltf},    {".glb", ls_import_gltf}, {".obj", ls_import_obj},
        {".ply", ls_import_openmesh}, {".off", ls_import_off},  {".stl", ls_import_stl},
    };
    const char* name = strrchr(path, '/');
    const char* ending = strrchr(name ? name : path, '.');
    for (size_t i = 0; ending && i < sizeof importers / sizeof *importers; i++)
        if (!strcasecmp(ending, importers[i].ending))
            return importers[i].importer;
    return NULL;
}

LsResult ls_import(LsInput* input, const char* path, LsError* error)
{
    const LsResult readable = check_readable(path, error);
    if (readable != LS_OK)
        return readable;
    Importer* importer = find_importer(path);
    if (!importer)
        return ls_error_set(
            error, LS_ERROR_INPUT_UNSUPPORTED,
            "%s: unknown ending; scenes end in .gltf, .glb, .obj, .ply, .off or .stl", path);
    const LsResult result = importer(input, path, error);
    input->file_count += 1;
    return result;
}
