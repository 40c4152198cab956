// gltf_materials.cpp - materials: the core's factors and textures, transmission, index of
// refraction, emissive strength, alpha masks. What else they have is noted.

#include "gltf_textures.h"

#include <algorithm>
#include <cstring>

namespace
{

// glTF's own schema holds factors to [0,1]; a file that does not is held to it here.
float clamp_factor(double factor)
{
    return static_cast<float>(std::min(std::max(factor, 0.0), 1.0));
}

void set_core(const tinygltf::Material& material, const cJSON* json, const std::string& name,
              LsMaterial& core)
{
    const std::vector<double>& color = material.pbrMetallicRoughness.baseColorFactor;
    const std::vector<double>& emissive = material.emissiveFactor;
    const double strength = gltf_get_number(
        gltf_get_extension(json, "KHR_materials_emissive_strength"), "emissiveStrength", 1.0);
    if (!(strength >= 0.0))
        gltf_fail(LS_MESSAGE_GLTF_MEMBER, name + " has a negative emissiveStrength");
    core.base_color = {clamp_factor(color[0]), clamp_factor(color[1]), clamp_factor(color[2])};
    core.emission = {gltf_narrow(std::max(emissive[0], 0.0) * strength, name),
                     gltf_narrow(std::max(emissive[1], 0.0) * strength, name),
                     gltf_narrow(std::max(emissive[2], 0.0) * strength, name)};
    core.metallic = clamp_factor(material.pbrMetallicRoughness.metallicFactor);
    core.roughness = clamp_factor(material.pbrMetallicRoughness.roughnessFactor);
    if (core.emission.x > 0.0f || core.emission.y > 0.0f || core.emission.z > 0.0f)
        core.flags |= LS_MATERIAL_EMISSIVE;
    if (material.doubleSided)
        core.flags |= LS_MATERIAL_DOUBLE_SIDED;
}

void set_alpha(GltfImport& import, const tinygltf::Material& material, const std::string& name,
               LsSurface& surface)
{
    if (material.alphaMode == "MASK")
    {
        surface.flags |= LS_SURFACE_MASK;
        surface.alpha = clamp_factor(material.pbrMetallicRoughness.baseColorFactor[3]);
        surface.alpha_cutoff = gltf_narrow(material.alphaCutoff, name);
        if (!(surface.alpha_cutoff >= 0.0f))
            gltf_fail(LS_MESSAGE_GLTF_MEMBER, name + " has a negative alphaCutoff");
    }
    else if (material.alphaMode == "BLEND")
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_BLEND, "alphaMode BLEND is not supported", name,
                     "such materials are opaque; use MASK or KHR_materials_transmission");
    else if (material.alphaMode != "OPAQUE")
        gltf_fail(LS_MESSAGE_GLTF_MEMBER,
                  name + " has the unknown alphaMode \"" + gltf_quote(material.alphaMode) + "\"");
}

void set_surface(GltfImport& import, GltfTextures& textures, const cJSON* json,
                 const std::string& name, LsSurface& surface)
{
    const cJSON* rough = gltf_get_member(json, "pbrMetallicRoughness");
    const cJSON* transmission = gltf_get_extension(json, "KHR_materials_transmission");
    const auto find = [&](const cJSON* object, const char* member, bool is_srgb, uint32_t* texture)
    { ls_gltf_find_texture(import, textures, object, member, is_srgb, name, texture); };
    find(rough, "baseColorTexture", true, &surface.base_color_texture);
    find(rough, "metallicRoughnessTexture", false, &surface.metallic_roughness_texture);
    find(json, "normalTexture", false, &surface.normal_texture);
    find(json, "emissiveTexture", true, &surface.emissive_texture);
    find(transmission, "transmissionTexture", false, &surface.transmission_texture);
    if (surface.normal_texture != LS_NONE)
        surface.normal_scale = gltf_narrow(
            gltf_get_number(gltf_get_member(json, "normalTexture"), "scale", 1.0), name);
    surface.transmission = clamp_factor(gltf_get_number(transmission, "transmissionFactor", 0.0));

    const double ior = gltf_get_number(gltf_get_extension(json, "KHR_materials_ior"), "ior", 1.5);
    if (!(ior == 0.0 || ior >= 1.0))
        gltf_fail(LS_MESSAGE_GLTF_MEMBER, name + " has an ior that is neither 0 nor at least 1");
    surface.ior = gltf_narrow(ior, name);
}

void note_rest(GltfImport& import, const cJSON* json, const std::string& name)
{
    if (gltf_get_member(json, "occlusionTexture"))
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_OCCLUSION, "occlusion textures are left out",
                     name, "occlusion is traced");
    const cJSON* extensions = gltf_get_member(json, "extensions");
    for (const cJSON* item = extensions ? extensions->child : nullptr; item; item = item->next)
        ls_gltf_note_extension(import, item->string, name);
}

} // namespace

void ls_gltf_read_materials(GltfImport& import)
{
    const std::vector<tinygltf::Material>& materials = import.model.materials;
    ls_gltf_reserve(import, materials.size() * sizeof(LsInputMaterial), 0, false);
    import.first_material = import.input->material_count;
    GltfTextures textures;
    const cJSON* list = gltf_get_member(import.root.get(), "materials");
    const cJSON* json = list ? list->child : nullptr;
    for (size_t i = 0; i < materials.size() && json; i++, json = json->next)
    {
        const std::string name = gltf_describe("material", i, materials[i].name);
        LsInputMaterial made = *gltf_check_memory(ls_input_add_material(import.input));
        set_core(materials[i], json, name, made.core);
        set_alpha(import, materials[i], name, made.surface);
        set_surface(import, textures, json, name, made.surface);
        note_rest(import, json, name);
        LsInputMaterial* added = &import.input->materials[import.first_material + i];
        *added = made;
        if (!materials[i].name.empty())
            added->name = gltf_check_memory(strdup(materials[i].name.c_str()));
        ls_input_note_progress(import.input, 0.2 + 0.2 * static_cast<double>(i + 1) /
                                                       static_cast<double>(materials.size()));
    }
}
