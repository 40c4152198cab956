// import.h - C face of the import shims: a path in, arrays appended to an LsInput, a result out.
//
// Importers take every vertex and face as it comes: no welding, no dropping, no reordering.
// Polygons are fanned from their first corner. No C++ type and no exception crosses this header.

#ifndef LS_IMPORT_H
#define LS_IMPORT_H

#include "ls_base.h"
#include "ls_layout.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C"
{
#endif

    // A mesh of the input, in object space. Arrays are malloc'ed and owned by the LsInput.
    typedef struct LsInputMesh
    {
        float* positions; // xyz per vertex, as in the file (not yet checked for NaN)
        uint32_t vertex_count;
        uint32_t* indices; // three per triangle, < vertex_count: importers refuse others
        uint32_t triangle_count;
        uint32_t* materials;  // per triangle, index into LsInput.materials
        uint32_t input_index; // which input file it came from, for messages
    } LsInputMesh;

    // A placed mesh.
    typedef struct LsInputInstance
    {
        uint32_t mesh;
        uint32_t node;                  // index into LsInput.nodes, or LS_NONE
        double world_from_object[3][4]; // product of the node matrices, in double
    } LsInputInstance;

    // All inputs of one bake, put together. Zero it before the first import; ls_input_destroy frees
    // it.
    typedef struct LsInput
    {
        LsInputMesh* meshes;
        uint32_t mesh_count, mesh_capacity;
        LsInputInstance* instances;
        uint32_t instance_count, instance_capacity;
        LsSceneNode* nodes; // parents before children
        uint32_t node_count, node_capacity;
        LsMaterial* materials;
        uint32_t material_count, material_capacity;
        LsCamera* cameras;
        uint32_t camera_count, camera_capacity;
        uint32_t file_count;       // files imported so far
        uint32_t default_material; // index + 1 of the one of files without; 0: not there yet
    } LsInput;

    // Appends the scene of one file; the ending chooses: .gltf .glb .obj .ply .off .stl. Objects,
    // materials and nodes are numbered after those already there. A file without materials uses a white
    // diffuse one (base colour 0.8), shared by all such. A mesh without triangles is left out; that
    // is no error here: the bake refuses a scene that has no triangle at all. After an error the
    // input is good for nothing but ls_input_destroy. Errors, each naming the file: FILE_MISSING,
    // FILE_READ, FILE_EMPTY, FILE_IS_DIRECTORY, INPUT_FORMAT, INPUT_INDEX, INPUT_UNSUPPORTED,
    // INPUT_LIMIT, MEMORY.
    LsResult ls_import(LsInput* input, const char* path, LsError* error);
    void ls_input_destroy(LsInput* input);

    // For the shims: append zeroed records and return the first of them, or NULL when out of
    // memory.
    LsInputMesh* ls_input_add_mesh(LsInput* input, uint32_t vertex_count, uint32_t triangle_count);
    LsInputInstance* ls_input_add_instance(LsInput* input);
    LsSceneNode* ls_input_add_node(LsInput* input);
    LsMaterial* ls_input_add_material(LsInput* input);
    LsCamera* ls_input_add_camera(LsInput* input);

    // For the shims: index of the material that files without materials share, added at its first
    // use; LS_NONE when out of memory.
    uint32_t ls_input_default_material(LsInput* input);

    // For the shims: appends a mesh of the default material and an instance of it as it lies, and
    // returns the mesh, its positions and indices zero; NULL when out of memory.
    LsInputMesh* ls_input_add_plain_mesh(LsInput* input, uint32_t vertex_count,
                                         uint32_t triangle_count);

    // The shims: glTF and GLB through tinygltf, PLY through OpenMesh, OBJ, OFF and STL by readers
    // of our own (their files say why). `path` is a readable file that is not empty.
    LsResult ls_import_gltf(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_openmesh(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_obj(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_off(LsInput* input, const char* path, LsError* error);
    LsResult ls_import_stl(LsInput* input, const char* path, LsError* error);

#ifdef __cplusplus
}
#endif

#endif
