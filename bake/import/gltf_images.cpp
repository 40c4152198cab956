// gltf_images.cpp - decodes the images that textures use; one that cannot be is a warning.
//
// Only PNG and JPEG, which is what glTF has.

#include "gltf_import.h"
#include "image_file.h"

#include <climits>
#include <cstdlib>
#include <cstring>

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
    if (ls_image_is_deep(bytes, size))
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_IMAGE_DEPTH, "images of 16 bits a channel", name,
                     "they are reduced to 8");
    LsInputImage image;
    const char* why;
    const LsResult result =
        ls_image_decode(import.input, import.path.c_str(), bytes, size, &image, &why, import.error);
    if (result != LS_OK)
        throw Reported{result};
    if (why)
        return note_problem(import, name, why);
    LsInputImage* added = ls_input_add_image(import.input);
    if (!added)
        std::free(image.pixels);
    *gltf_check_memory(added) = image;
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
