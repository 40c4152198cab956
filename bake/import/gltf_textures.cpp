// gltf_textures.cpp - texture infos of materials: image, sampler, KHR_texture_transform.

#include "gltf_textures.h"

namespace
{

// The row vectors of u' = translation * rotation * scale. The extension turns counter-clockwise as
// seen on the image, whose v runs down.
void set_transform(const cJSON* info, const std::string& owner, LsTexture& texture)
{
    double offset[2] = {0, 0}, scale[2] = {1, 1};
    const cJSON* transform = gltf_get_extension(info, "KHR_texture_transform");
    const auto read_pair = [&](const char* name, double(&pair)[2])
    {
        const cJSON* member = gltf_get_member(transform, name);
        if (member)
            pair[0] = member->child->valuedouble, pair[1] = member->child->next->valuedouble;
    };
    read_pair("offset", offset);
    read_pair("scale", scale);
    const GltfSineCosine turn = gltf_find_sine_cosine(gltf_get_number(transform, "rotation", 0.0));
    texture.row_u = {gltf_narrow(turn.cosine * scale[0], owner),
                     gltf_narrow(turn.sine * scale[1], owner), gltf_narrow(offset[0], owner), 0.0f};
    texture.row_v = {gltf_narrow(-turn.sine * scale[0], owner),
                     gltf_narrow(turn.cosine * scale[1], owner), gltf_narrow(offset[1], owner),
                     0.0f};
    for (float* number : {&texture.row_u.x, &texture.row_u.y, &texture.row_u.z, &texture.row_v.x,
                          &texture.row_v.y, &texture.row_v.z})
        *number += 0.0f; // no -0, by which equal textures would differ
}

void set_sampler(const GltfImport& import, int index, const std::string& owner, LsTexture& texture)
{
    if (index == -1)
        return;
    const tinygltf::Sampler& sampler = gltf_find(import.model.samplers, index, "sampler", owner);
    const auto set_wrap = [&](int wrap, uint32_t clamp, uint32_t mirror)
    {
        if (wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE)
            texture.flags |= clamp;
        else if (wrap == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT)
            texture.flags |= mirror;
        else if (wrap != TINYGLTF_TEXTURE_WRAP_REPEAT)
            gltf_fail(LS_MESSAGE_GLTF_MEMBER, "sampler " + std::to_string(index) +
                                                  " has the unknown wrap mode " +
                                                  std::to_string(wrap));
    };
    set_wrap(sampler.wrapS, LS_TEXTURE_CLAMP_U, LS_TEXTURE_MIRROR_U);
    set_wrap(sampler.wrapT, LS_TEXTURE_CLAMP_V, LS_TEXTURE_MIRROR_V);
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
        texture.flags |= LS_TEXTURE_NEAREST;
    else if (sampler.magFilter != -1 && sampler.magFilter != TINYGLTF_TEXTURE_FILTER_LINEAR)
        gltf_fail(LS_MESSAGE_GLTF_MEMBER, "sampler " + std::to_string(index) +
                                              " has the unknown magFilter " +
                                              std::to_string(sampler.magFilter));
}

} // namespace

void ls_gltf_find_texture(GltfImport& import, GltfTextures& textures, const cJSON* object,
                          const char* name, bool is_srgb, const std::string& owner,
                          uint32_t* texture)
{
    *texture = LS_NONE;
    const cJSON* info = gltf_get_member(object, name);
    if (!info)
        return;
    const int index = gltf_get_index(info, "index", -1);
    const tinygltf::Texture& record = gltf_find(import.model.textures, index, "texture", owner);
    const std::string described =
        gltf_describe("texture", static_cast<size_t>(index), record.name) + ", " + name + " of " +
        owner;
    for (const auto& extension : record.extensions) // images of other formats
        ls_gltf_note_extension(import, extension.first, described);

    LsTexture made = {};
    const int texcoord = gltf_get_index(gltf_get_extension(info, "KHR_texture_transform"),
                                        "texCoord", gltf_get_index(info, "texCoord", 0));
    if (texcoord > 1)
    {
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_TEXTURE,
                     "textures at texture coordinates other than 0 and 1", described,
                     "they are left out");
        return;
    }
    if (record.source == -1)
    {
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_TEXTURE, "textures without a PNG or JPEG",
                     described, "they are left out");
        return;
    }
    made.texcoord = static_cast<uint32_t>(texcoord);
    made.flags = is_srgb ? LS_TEXTURE_SRGB : 0;
    set_transform(info, described, made);
    set_sampler(import, record.sampler, described, made);

    const size_t source = static_cast<size_t>(record.source);
    const auto known = textures.images.find(source);
    made.image =
        known != textures.images.end() ? known->second : ls_gltf_find_image(import, source);
    textures.images[source] = made.image;
    if (made.image == LS_NONE)
        return;
    const std::string bytes(reinterpret_cast<const char*>(&made), sizeof made);
    const auto [place, is_new] = textures.numbers.try_emplace(bytes, import.input->texture_count);
    if (is_new)
        *gltf_check_memory(ls_input_add_texture(import.input)) = made;
    *texture = place->second;
}
