// import.h - C face of the import shims: a path in, arrays appended to an LsInput, a result out.
//
// Importers take every vertex and face as it comes: no welding, no dropping, no reordering.
// Polygons are fanned from their first corner. No C++ type and no exception crosses this header.

#ifndef LS_IMPORT_H
#define LS_IMPORT_H

#include "ls_base.h"
#include "ls_layout.h"
#include "ls_messages.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C"
{
#endif

    // Values at corners, of one kind. Arrays are malloc'ed and owned by the LsInputMesh.
    typedef struct LsInputStream
    {
        float* values;     // so many numbers per element as the kind has; NULL: the mesh has none
        uint32_t count;    // elements
        uint32_t* indices; // three per triangle, < count, or LS_NONE for a corner without; NULL: as
                           // the positions', then count == vertex_count
    } LsInputStream;

    // Kinds of streams, and numbers per element.
    typedef enum LsStreamKind
    {
        LS_STREAM_NORMAL,     // 3: object space, of any length; 0 0 0 for none
        LS_STREAM_TEXCOORD_0, // 2: v = 0 at the top of images, as glTF has it
        LS_STREAM_TEXCOORD_1, // 2
        LS_STREAM_COLOR,      // 4: linear red, green, blue, alpha, clamped to [0,1]
        LS_STREAM_COUNT
    } LsStreamKind;

    // A mesh of the input, in object space. Arrays are malloc'ed and owned by the LsInput.
    typedef struct LsInputMesh
    {
        char* name;       // as the file has it, for messages and reports; NULL without
        float* positions; // xyz per vertex, as in the file (not yet checked for NaN)
        uint32_t vertex_count;
        uint32_t* indices; // three per triangle, < vertex_count: importers refuse others
        uint32_t triangle_count;
        uint32_t* materials;  // per triangle, index into LsInput.materials
        uint32_t input_index; // which input file it came from, for messages
        LsInputStream streams[LS_STREAM_COUNT];
    } LsInputMesh;

    // A placed mesh.
    typedef struct LsInputInstance
    {
        uint32_t mesh;
        uint32_t node;                  // index into LsInput.nodes, or LS_NONE
        double world_from_object[3][4]; // product of the node matrices, in double
    } LsInputInstance;

    // A material of the input.
    typedef struct LsInputMaterial
    {
        LsMaterial core;   // its `surface` is left 0; the pack stage numbers surfaces
        LsSurface surface; // LS_SURFACE_DEFAULT without any of it; textures index LsInput.textures
        char* name;        // as the file has it, owned; NULL without
        uint32_t input_index; // which input file it came from
    } LsInputMaterial;

// A surface that adds nothing to its material.
#define LS_SURFACE_DEFAULT                                                          \
    {                                                                               \
        .transmission = 0.0f, .ior = 1.5f, .alpha = 1.0f, .alpha_cutoff = 0.5f,     \
        .normal_scale = 1.0f, .flags = 0, .base_color_texture = LS_NONE,            \
        .metallic_roughness_texture = LS_NONE, .normal_texture = LS_NONE,           \
        .emissive_texture = LS_NONE, .transmission_texture = LS_NONE, .reserved = 0 \
    }

    // A decoded image.
    typedef struct LsInputImage
    {
        uint32_t width, height;
        uint32_t* pixels; // as PIXELS, owned
    } LsInputImage;

    // Something that the scene has and the file will not: one line for a person.
    typedef struct LsInputWarning
    {
        uint32_t message; // an LsMessage of the 38xx
        uint32_t input_index;
        char* text; // owned
    } LsInputWarning;

    // Called as a file is read, with the fraction in [0,1] of it.
    typedef void LsImportProgress(void* user, double fraction);

    // Zero means default.
    typedef struct LsImportOptions
    {
        bool strict;            // a warning is an error
        uint32_t scene;         // of the next file, a glTF: number of the scene to take, plus 1
        uint64_t max_memory;    // bytes that the input may take; 0: no limit
        uint64_t max_triangles; // of all inputs together; 0: no limit
        LsImportProgress* progress;
        void* progress_user;
    } LsImportOptions;

    // All inputs of one bake, put together. Zero it before the first import, but for the options;
    // ls_input_destroy frees it.
    typedef struct LsInput
    {
        LsImportOptions options;
        LsInputMesh* meshes;
        uint32_t mesh_count, mesh_capacity;
        LsInputInstance* instances;
        uint32_t instance_count, instance_capacity;
        LsSceneNode* nodes; // parents before children
        uint32_t node_count, node_capacity;
        LsInputMaterial* materials;
        uint32_t material_count, material_capacity;
        LsTexture* textures;
        uint32_t texture_count, texture_capacity;
        LsInputImage* images;
        uint32_t image_count, image_capacity;
        LsLamp* lamps;
        uint32_t lamp_count, lamp_capacity;
        LsAnimation* animations;
        uint32_t animation_count, animation_capacity;
        LsChannel* channels;
        uint32_t channel_count, channel_capacity;
        float* keys;
        uint32_t key_count, key_capacity;
        LsInputWarning* warnings;
        uint32_t warning_count, warning_capacity;
        LsCamera* cameras;
        uint32_t camera_count, camera_capacity;
        char** paths; // of the files imported so far, owned
        uint32_t file_count, path_capacity;
        uint32_t default_material; // index + 1 of the one of files without; 0: not there yet
        uint64_t triangle_count;   // of all meshes
        uint64_t memory_bytes;     // what has been granted by ls_input_reserve
    } LsInput;

    // Appends the scene of one file; the ending chooses: .gltf .glb .obj .ply .off .stl. Objects,
    // materials and nodes are numbered after those already there. A file without materials uses a white
    // diffuse one (base colour 0.8), shared by all such. A mesh without triangles is left out; that
    // is no error here: the bake refuses a scene that has no triangle at all. After an error the
    // input is good for nothing but ls_input_destroy. Errors, each naming the file: the messages
    // of files and of the format (ls_messages.h), LIMIT_*, OUT_OF_MEMORY.
    LsResult ls_import(LsInput* input, const char* path, LsError* error);
    void ls_input_destroy(LsInput* input);

    // A number for each way to read files, by the ending; 0 for none.
    uint32_t ls_import_kind(const char* path);

    // For the shims: append zeroed records and return the first of them, or NULL when out of
    // memory.
    LsInputMesh* ls_input_add_mesh(LsInput* input, uint32_t vertex_count, uint32_t triangle_count);
    LsInputInstance* ls_input_add_instance(LsInput* input);
    LsSceneNode* ls_input_add_node(LsInput* input);
    LsInputMaterial* ls_input_add_material(LsInput* input); // white, diffuse, no surface
    LsTexture* ls_input_add_texture(LsInput* input);
    LsInputImage* ls_input_add_image(LsInput* input);
    LsLamp* ls_input_add_lamp(LsInput* input);
    LsAnimation* ls_input_add_animation(LsInput* input);
    LsChannel* ls_input_add_channel(LsInput* input);
    float* ls_input_add_keys(LsInput* input, uint32_t count); // `count` floats in a row

    // Numbers per element of a kind of stream.
    uint32_t ls_stream_size(LsStreamKind kind);

    // For the shims: zeroed room for `count` elements, and for indices if asked; false when out of
    // memory.
    bool ls_input_stream_create(LsInputMesh* mesh, LsStreamKind kind, uint32_t count,
                                bool has_indices);

    // For the shims, before they allocate: whether `bytes` more and `triangles` more are within the
    // limits. Errors: LIMIT_TRIANGLES, LIMIT_MEMORY.
    LsResult ls_input_reserve(LsInput* input, const char* path, uint64_t bytes, uint64_t triangles,
                              LsError* error);

    // For the shims: reports the fraction in [0,1] of the file that has been read.
    void ls_input_note_progress(const LsInput* input, double fraction);

    // For the shims: notes a warning about the file being read; `message` is one of the 38xx. The same
    // text is kept once. Returns OK, or under --strict INPUT_WARNING, with the warning as the error.
    LsResult ls_input_warn(LsInput* input, LsError* error, LsMessage message, const char* format,
                           ...) LS_PRINTF(4, 5);
    LsCamera* ls_input_add_camera(LsInput* input);

    // For the shims: index of the material that files without materials share, added at its first
    // use; LS_NONE when out of memory.
    uint32_t ls_input_default_material(LsInput* input);

    // For the shims: appends a mesh of the default material and an instance of it as it lies, and
    // returns the mesh, its positions and indices zero; NULL when out of memory.
    LsInputMesh* ls_input_add_plain_mesh(LsInput* input, uint32_t vertex_count,
                                         uint32_t triangle_count);

    // The shims: glTF and GLB through tinygltf, the others by readers of our own (their files say
    // why). `path` is a readable file that is not empty.
    LsResult ls_import_gltf(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_ply(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_obj(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_off(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_stl(LsInput* input, const char* path, LsError* error);

#ifdef __cplusplus
}
#endif

#endif
