// gltf_extensions.cpp - which extensions a file may require, and which it uses in vain.

#include "gltf_import.h"

#include <algorithm>
#include <set>

namespace
{

const char* const SUPPORTED[] = {
    "KHR_lights_punctual",        "KHR_materials_emissive_strength", "KHR_materials_ior",
    "KHR_materials_transmission", "KHR_mesh_quantization",           "KHR_texture_transform",
};

// Nothing is lost where the data is there in plain form too, and else it is an error of its own
// (gltf_meshes.cpp, gltf_buffers.cpp).
const char* const COMPRESSION[] = {
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
};

constexpr size_t MAX_WARNINGS = 32; // so that a file of a million names gives no million warnings

template <size_t SIZE> bool is_among(const char* const (&names)[SIZE], const std::string& name)
{
    return std::any_of(names, names + SIZE, [&](const char* known) { return name == known; });
}

// Whether a scene without it is still the same scene, in other dress: extensions of materials, and
// those that only describe.
bool is_left_out_safely(const std::string& name)
{
    return name.rfind("KHR_materials_", 0) == 0 || name == "KHR_xmp" || name == "KHR_xmp_json_ld";
}

std::string describe(const std::string& name)
{
    return "the extension " + gltf_quote(name) + " is not supported";
}

constexpr const char* REMEDY = "what it adds will be missing";

} // namespace

void ls_gltf_check_extensions(GltfImport& import)
{
    const cJSON* required = gltf_get_member(import.root.get(), "extensionsRequired");
    for (const cJSON* item = required ? required->child : nullptr; item; item = item->next)
    {
        const std::string name = item->valuestring;
        import.is_quantized = import.is_quantized || name == "KHR_mesh_quantization";
        if (!is_among(SUPPORTED, name) && !is_left_out_safely(name))
            throw Failure{LS_MESSAGE_GLTF_EXTENSION,
                          "requires the extension " + gltf_quote(name) +
                              ", which is not supported; export the scene without it"};
    }
    std::set<std::string> noted;
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
    {
        const cJSON* used = gltf_get_member(import.root.get(), list);
        for (const cJSON* item = used ? used->child : nullptr; item; item = item->next)
        {
            const std::string name = item->valuestring;
            import.is_quantized = import.is_quantized || name == "KHR_mesh_quantization";
            if (is_among(SUPPORTED, name) || is_among(COMPRESSION, name) ||
                !noted.insert(name).second)
                continue;
            if (noted.size() <= MAX_WARNINGS)
                ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_EXTENSION, describe(name), "", REMEDY);
            else
                ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_EXTENSION,
                             "further extensions are not supported", gltf_quote(name),
                             "what they add will be missing");
        }
    }
}

void ls_gltf_note_extension(GltfImport& import, const std::string& name, const std::string& thing)
{
    if (is_among(SUPPORTED, name) || is_among(COMPRESSION, name))
        return;
    if (import.notice_numbers.count({LS_MESSAGE_GLTF_WARN_EXTENSION, describe(name)}))
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_EXTENSION, describe(name), thing, REMEDY);
    else
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_UNDECLARED,
                     "extensions that the file does not declare are not supported",
                     gltf_quote(name) + " of " + thing, REMEDY);
}
