// gltf_import.h - what the stages of the glTF importer share; only its own files include this.
//
// The stages in the order of work: file, members, extensions, buffers, nodes, materials, meshes,
// animation. tinygltf gives the records; what it does not check is checked here, first of all every
// member that is read (gltf_members.cpp), since it takes a malformed one for a missing one. Stages
// throw Failure or Reported (failure.h). They have C linkage for the sake of their names alone.

#ifndef GLTF_IMPORT_H
#define GLTF_IMPORT_H

#include "failure.h"
#include "gltf_math.h"
#include "import.h"

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// The library's header has loops of its own that warn.
#include <cJSON.h>
#include <tiny_gltf.h>

// Bytes of a buffer: those of the GLB itself, or owned.
struct GltfBuffer
{
    const unsigned char* bytes = nullptr;
    size_t size = 0;
    bool is_there = false; // placeholders of compressed data have no bytes
    std::vector<unsigned char> owned;
};

// A mesh placed by the scene's nodes.
struct GltfPlacement
{
    size_t mesh;   // of the glTF
    uint32_t node; // of the LsInput
    GltfMatrix world_from_object;
};

// A warning that gathers the things it is about, so that a file of a million such things gives one.
struct GltfNotice
{
    LsMessage message;
    std::string what, remedy;
    std::vector<std::string> things; // the first few
    size_t count = 0;
};

struct GltfImport
{
    LsInput* input;
    LsError* error;
    std::string path;

    std::vector<unsigned char> file;
    std::string text;                      // the JSON
    const unsigned char* binary = nullptr; // the GLB's second chunk, within `file`
    size_t binary_size = 0;
    std::unique_ptr<cJSON, void (*)(cJSON*)> root{nullptr, cJSON_Delete};
    tinygltf::Model model; // without buffers and images

    bool is_quantized = false; // KHR_mesh_quantization is declared
    std::vector<GltfBuffer> buffers;
    std::vector<uint32_t> node_numbers; // of the LsInput for each node, LS_NONE if not shown
    std::vector<GltfPlacement> placements;
    uint32_t first_material = 0;
    std::vector<const cJSON*> images; // filled at the first use
    uint64_t temporary_bytes = 0;     // granted, and free again after the import

    std::vector<GltfNotice> notices;
    std::map<std::pair<int, std::string>, size_t> notice_numbers;
};

// What an accessor is for decides which types are legal.
enum class GltfUse
{
    POSITION,
    NORMAL,
    TEXCOORD,
    COLOR,
    INDICES,
    TIMES,
    VECTORS,   // translations and scales
    ROTATIONS, // quaternions
};

// The elements of an accessor, all within their buffers.
struct GltfElements
{
    size_t count = 0;
    unsigned width = 0; // numbers per element
    int component = 0;
    bool is_normalized = false;
    const unsigned char* bytes = nullptr; // null: all zero
    size_t stride = 0;
    size_t sparse_count = 0; // elements that are replaced
    int sparse_component = 0;
    const unsigned char* sparse_indices = nullptr;
    const unsigned char* sparse_values = nullptr;
};

extern "C"
{
    // ---- Stages ---------------------------------------------------------------------------------

    // gltf_file.cpp: reads the file, parts a GLB, parses the JSON twice: cJSON for the checks, tinygltf
    // for the records.
    void ls_gltf_read_file(GltfImport& import);
    void ls_gltf_read_model(GltfImport& import);
    // gltf_members.cpp: refuses members of wrong types, and required ones that are missing.
    void ls_gltf_check_members(GltfImport& import);
    // gltf_extensions.cpp: refuses required extensions that are not supported, notes used ones.
    void ls_gltf_check_extensions(GltfImport& import);
    // An extension that a thing has and that is not supported, for the warning about it.
    void ls_gltf_note_extension(GltfImport& import, const std::string& name,
                                const std::string& thing);
    // gltf_buffers.cpp
    void ls_gltf_read_buffers(GltfImport& import);
    // gltf_nodes.cpp: the scene's nodes, with their cameras and lamps (gltf_cameras.cpp).
    void ls_gltf_read_nodes(GltfImport& import);
    // gltf_materials.cpp, with gltf_textures.cpp and gltf_images.cpp
    void ls_gltf_read_materials(GltfImport& import);
    // gltf_meshes.cpp
    void ls_gltf_read_meshes(GltfImport& import);
    // gltf_animation.cpp
    void ls_gltf_read_animations(GltfImport& import);

    // ---- Parts of stages ------------------------------------------------------------------------

    // A camera or a lamp that a node carries.
    void ls_gltf_add_camera(GltfImport& import, size_t index, const GltfMatrix& world_from_node);
    void ls_gltf_add_lamp(GltfImport& import, size_t index, uint32_t node,
                          const GltfMatrix& world_from_node);

    // The path of the file that a URI names beside the scene; false if it names none.
    bool ls_gltf_find_file(const std::string& scene, const std::string& uri, std::string& path);

    // Bytes that a URI names: of a data URI, or of a file beside the scene, at most `limit` of them.
    // Returns false and says why in `problem` if they cannot be had.
    bool ls_gltf_load_uri(GltfImport& import, const std::string& uri, size_t limit,
                          std::vector<unsigned char>& bytes, std::string& problem);
    // Part of a buffer, checked; `owner` is named in the failure.
    const unsigned char* ls_gltf_find_bytes(const GltfImport& import, int view, size_t offset,
                                            size_t size, const std::string& owner);

    // Checks an accessor and finds its elements.
    void ls_gltf_find_elements(const GltfImport& import, int accessor, GltfUse use,
                               const std::string& owner, GltfElements& elements);
    // Elements as floats, `elements.width` each, normalized ones divided.
    void ls_gltf_read_numbers(const GltfElements& elements, const std::string& owner,
                              float* numbers);
    // Elements of a scalar accessor of unsigned integers.
    void ls_gltf_read_indices(const GltfElements& elements, const std::string& owner,
                              uint32_t* indices);

    // Index of the LsInput's image for an image of the glTF, or LS_NONE after a warning.
    uint32_t ls_gltf_find_image(GltfImport& import, size_t index);

    // ---- Grants and warnings (import_gltf.cpp) --------------------------------------------------

    // ls_input_reserve; `is_temporary` for what is free again after the import.
    void ls_gltf_reserve(GltfImport& import, uint64_t bytes, uint64_t triangles, bool is_temporary);
    // Adds a thing to a warning; `thing` may be empty.
    void ls_gltf_note(GltfImport& import, LsMessage message, const std::string& what,
                      const std::string& thing, const std::string& remedy);
}

// ---- Helpers ------------------------------------------------------------------------------------

// What a file says, fit for one line of a message.
inline std::string gltf_quote(const std::string& word)
{
    std::string text = word.substr(0, 64);
    while (text.size() == 64 && !text.empty() && (text.back() & 0x80))
        text.pop_back(); // not in the middle of a character
    for (char& letter : text)
        if (static_cast<unsigned char>(letter) < 32 || letter == 127)
            letter = '?';
    return text;
}

// "mesh 3 (\"walls\")"
inline std::string gltf_describe(const char* kind, size_t index, const std::string& name)
{
    std::string text = std::string(kind) + " " + std::to_string(index);
    if (!name.empty())
        text += " (\"" + gltf_quote(name) + "\")";
    return text;
}

[[noreturn]] inline void gltf_fail(LsMessage message, const std::string& text)
{
    throw Failure{message, text + "; export the scene again"};
}

// The record that `index` names, or a failure that says who named it.
template <class Record>
const Record& gltf_find(const std::vector<Record>& records, int index, const char* kind,
                        const std::string& owner)
{
    if (index < 0 || static_cast<size_t>(index) >= records.size())
        gltf_fail(LS_MESSAGE_GLTF_INDEX, owner + " names " + kind + " " + std::to_string(index) +
                                             ", but there are " + std::to_string(records.size()));
    return records[static_cast<size_t>(index)];
}

template <class Record> Record* gltf_check_memory(Record* record)
{
    if (!record)
        throw std::bad_alloc();
    return record;
}

// A double of the file as a float.
inline float gltf_narrow(double number, const std::string& owner)
{
    if (!(std::fabs(number) <= static_cast<double>(std::numeric_limits<float>::max())))
        gltf_fail(LS_MESSAGE_GLTF_RANGE, owner + " has a number that float cannot hold");
    return static_cast<float>(number);
}

inline void gltf_store_rows(const GltfMatrix& matrix, const std::string& owner, LsVec4 (&rows)[3])
{
    for (size_t i = 0; i < 3; i++)
        rows[i] = {gltf_narrow(matrix[i][0], owner), gltf_narrow(matrix[i][1], owner),
                   gltf_narrow(matrix[i][2], owner), gltf_narrow(matrix[i][3], owner)};
}

// The unit quaternion along (x, y, z, w); false if there is none. Returns the length in `length`.
inline bool gltf_normalize(double (&q)[4], double& length)
{
    length = std::sqrt(((q[0] * q[0] + q[1] * q[1]) + q[2] * q[2]) + q[3] * q[3]);
    if (!(length > 0.0 && length < std::numeric_limits<double>::infinity()))
        return false;
    for (double& number : q)
        number /= length;
    return true;
}

// A member of the JSON, or null.
inline const cJSON* gltf_get_member(const cJSON* object, const char* name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

// An extension's object, or null. Asked of the JSON: tinygltf cuts whole numbers of extensions to 32
// bits and leaves out what is empty.
inline const cJSON* gltf_get_extension(const cJSON* object, const char* name)
{
    return gltf_get_member(gltf_get_member(object, "extensions"), name);
}

// A number, or `otherwise`; the members are checked.
inline double gltf_get_number(const cJSON* object, const char* name, double otherwise)
{
    const cJSON* member = gltf_get_member(object, name);
    return member ? member->valuedouble : otherwise;
}

inline int gltf_get_index(const cJSON* object, const char* name, int otherwise)
{
    const cJSON* member = gltf_get_member(object, name);
    return member ? static_cast<int>(member->valuedouble) : otherwise;
}

inline std::string gltf_get_text(const cJSON* object, const char* name)
{
    const cJSON* member = gltf_get_member(object, name);
    return member && member->valuestring ? member->valuestring : "";
}

#endif
