// gltf_images.cpp - decodes the images that textures use; one that cannot be is a warning.
//
// Only PNG and JPEG, which is what glTF has: the other decoders of stb_image are never reached.

#include "gltf_import.h"

#include <algorithm>
#include <climits>
#include <cstring>
#include <stb_image.h>

namespace
{

bool is_png(const unsigned char* bytes, size_t size)
{
    static const unsigned char start[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    return size >= sizeof start && !std::memcmp(bytes, start, sizeof start);
}

bool is_jpeg(const unsigned char* bytes, size_t size)
{
    return size >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

uint32_t note_problem(GltfImport& import, const std::string& name, const std::string& problem)
{
    ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_IMAGE, "images that cannot be read",
                 name + ": " + problem, "textures of them are left out");
    return LS_NONE;
}

uint32_t decode(GltfImport& import, const unsigned char* bytes, size_t size,
                const std::string& name)
{
    if (!is_png(bytes, size) && !is_jpeg(bytes, size))
        return note_problem(import, name, "it is neither PNG nor JPEG");
    int width, height, channels;
    const int length = static_cast<int>(size);
    if (size > INT_MAX || !stbi_info_from_memory(bytes, length, &width, &height, &channels))
        return note_problem(import, name, "its header is malformed");
    if (width < 1 || height < 1 || width > LS_MAX_IMAGE_SIDE || height > LS_MAX_IMAGE_SIDE)
        return note_problem(import, name,
                            "its size of " + std::to_string(width) + " x " +
                                std::to_string(height) + " is beyond the limit of " +
                                std::to_string(LS_MAX_IMAGE_SIDE));
    if (stbi_is_16_bit_from_memory(bytes, length))
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_IMAGE_DEPTH, "images of 16 bits a channel", name,
                     "they are reduced to 8");

    // The decoder needs about as much again for what it unpacks.
    const uint64_t pixel_bytes =
        uint64_t(4) * static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
    ls_gltf_reserve(import, pixel_bytes, 0, false);
    ls_gltf_reserve(import, 2 * pixel_bytes, 0, true);
    std::unique_ptr<unsigned char, void (*)(void*)> pixels(
        stbi_load_from_memory(bytes, length, &width, &height, &channels, 4), stbi_image_free);
    if (!pixels)
        return note_problem(import, name,
                            std::string("it is malformed (") + stbi_failure_reason() + ")");

    LsInputImage* added = gltf_check_memory(ls_input_add_image(import.input));
    const size_t count = static_cast<size_t>(width) * static_cast<size_t>(height);
    added->width = static_cast<uint32_t>(width);
    added->height = static_cast<uint32_t>(height);
    added->pixels =
        gltf_check_memory(static_cast<uint32_t*>(std::malloc(count * sizeof(uint32_t))));
    for (size_t i = 0; i < count; i++)
    {
        const unsigned char* p = pixels.get() + 4 * i;
        added->pixels[i] =
            uint32_t(p[0]) | uint32_t(p[1]) << 8 | uint32_t(p[2]) << 16 | uint32_t(p[3]) << 24;
    }
    return import.input->image_count - 1;
}

} // namespace

uint32_t ls_gltf_find_image(GltfImport& import, size_t index)
{
    if (import.images.empty())
    {
        const cJSON* list = gltf_get_member(import.root.get(), "images");
        for (const cJSON* item = list ? list->child : nullptr; item; item = item->next)
            import.images.push_back(item);
    }
    const cJSON* image = gltf_find(import.images, static_cast<int>(index), "image", "a texture");
    const std::string name = gltf_describe("image", index, gltf_get_text(image, "name"));
    const cJSON* uri = gltf_get_member(image, "uri");
    const int view = gltf_get_index(image, "bufferView", -1);
    if (uri)
    {
        std::vector<unsigned char> bytes;
        std::string problem;
        if (!ls_gltf_load_uri(import, uri->valuestring, INT_MAX, bytes, problem))
            return note_problem(import, name, problem);
        return decode(import, bytes.data(), bytes.size(), name);
    }
    if (view == -1)
        return note_problem(import, name, "it has neither a URI nor a buffer view");
    const size_t size = gltf_find(import.model.bufferViews, view, "buffer view", name).byteLength;
    return decode(import, ls_gltf_find_bytes(import, view, 0, size, name), size, name);
}
