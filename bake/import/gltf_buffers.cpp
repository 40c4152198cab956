// gltf_buffers.cpp - the bytes of buffers: a GLB's own, embedded ones, files beside the scene.

#include "gltf_import.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace
{

int find_hex(char letter)
{
    if (letter >= '0' && letter <= '9')
        return letter - '0';
    letter = static_cast<char>(letter | 32);
    return letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
}

std::string decode_percent(const std::string& text)
{
    std::string decoded;
    for (size_t i = 0; i < text.size(); i++)
    {
        const int high = text[i] == '%' && text.size() - i > 2 ? find_hex(text[i + 1]) : -1;
        const int low = high >= 0 ? find_hex(text[i + 2]) : -1;
        if (low >= 0)
            i += 2;
        decoded += low >= 0 ? static_cast<char>(high << 4 | low) : text[i];
    }
    return decoded;
}

int find_base64(char letter)
{
    if (letter >= 'A' && letter <= 'Z')
        return letter - 'A';
    if (letter >= 'a' && letter <= 'z')
        return letter - 'a' + 26;
    if (letter >= '0' && letter <= '9')
        return letter - '0' + 52;
    return letter == '+' ? 62 : letter == '/' ? 63 : -1;
}

// False where a letter is none of base64's.
bool decode_base64(const char* text, size_t size, size_t limit, std::vector<unsigned char>& bytes)
{
    while (size && text[size - 1] == '=')
        size--;
    bytes.reserve(std::min(size / 4 * 3 + 3, limit));
    uint32_t word = 0;
    unsigned bits = 0;
    for (size_t i = 0; i < size; i++)
    {
        const int value = find_base64(text[i]);
        if (value < 0)
            return false;
        word = word << 6 | static_cast<uint32_t>(value);
        bits += 6;
        if (bits >= 8 && bytes.size() < limit)
            bytes.push_back(static_cast<unsigned char>(word >> (bits - 8)));
        bits -= bits >= 8 ? 8 : 0;
    }
    return true;
}

bool load_data_uri(GltfImport& import, const std::string& uri, size_t limit,
                   std::vector<unsigned char>& bytes, std::string& problem)
{
    const size_t comma = uri.find(',');
    if (comma == std::string::npos)
    {
        problem = "its data URI has no comma";
        return false;
    }
    ls_gltf_reserve(import, std::min(limit, uri.size() - comma), 0, true);
    const std::string coding = ";base64";
    if (comma >= coding.size() && !uri.compare(comma - coding.size(), coding.size(), coding))
    {
        if (decode_base64(uri.data() + comma + 1, uri.size() - comma - 1, limit, bytes))
            return true;
        problem = "its data URI is not base64";
        return false;
    }
    const std::string text = decode_percent(uri.substr(comma + 1));
    bytes.assign(text.begin(), text.begin() + static_cast<ptrdiff_t>(std::min(limit, text.size())));
    return true;
}

// "http:", "file:" and the like.
bool has_scheme(const std::string& uri)
{
    const size_t colon = uri.find(':');
    return colon != std::string::npos && colon > 0 &&
           std::isalpha(static_cast<unsigned char>(uri[0])) &&
           std::all_of(uri.begin(), uri.begin() + static_cast<ptrdiff_t>(colon),
                       [](unsigned char letter)
                       { return std::isalnum(letter) || std::strchr("+-.", letter); });
}

// The path of what a URI names beside the scene, its letters decoded in `name`; empty if it names no file.
std::string find_path(const std::string& scene, const std::string& uri, std::string& name)
{
    name = decode_percent(uri);
    if (name.empty() || name.find('\0') != std::string::npos)
        return {};
    const size_t slash = scene.rfind('/');
    return (slash == std::string::npos ? "./" : scene.substr(0, slash + 1)) + name;
}

bool load_file(GltfImport& import, const std::string& uri, size_t limit,
               std::vector<unsigned char>& bytes, std::string& problem)
{
    std::string name;
    const std::string path = find_path(import.path, uri, name);
    if (path.empty())
    {
        problem = "its URI names no file";
        return false;
    }
    const std::string quoted = "\"" + gltf_quote(name) + "\"";
    // A pipe must not stop us.
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status;
    if (file < 0 || fstat(file, &status) || !S_ISREG(status.st_mode))
    {
        problem = "its file " + quoted +
                  (file < 0 ? " cannot be read (" + std::string(std::strerror(errno)) + ")"
                            : std::string(" is no regular file"));
        if (file >= 0)
            close(file);
        return false;
    }
    try
    {
        const size_t size = std::min(limit, static_cast<size_t>(status.st_size));
        ls_gltf_reserve(import, size, 0, true);
        bytes.resize(size);
    }
    catch (...)
    {
        close(file);
        throw;
    }
    size_t size = 0;
    while (size < bytes.size())
    {
        const ssize_t part = read(file, bytes.data() + size, bytes.size() - size);
        if (part < 0 && errno == EINTR)
            continue;
        if (part <= 0)
            break;
        size += static_cast<size_t>(part);
    }
    close(file);
    if (size < bytes.size())
        problem = "its file " + quoted + " cannot be read to its end";
    return size == bytes.size();
}

} // namespace

bool ls_gltf_find_file(const std::string& scene, const std::string& uri, std::string& path)
{
    std::string name;
    path = uri.rfind("data:", 0) == 0 || has_scheme(uri) ? "" : find_path(scene, uri, name);
    return !path.empty();
}

bool ls_gltf_load_uri(GltfImport& import, const std::string& uri, size_t limit,
                      std::vector<unsigned char>& bytes, std::string& problem)
{
    if (uri.rfind("data:", 0) == 0)
        return load_data_uri(import, uri, limit, bytes, problem);
    if (has_scheme(uri))
    {
        problem = "its URI \"" + gltf_quote(uri) + "\" is no file beside the scene";
        return false;
    }
    return load_file(import, uri, limit, bytes, problem);
}

void ls_gltf_read_buffers(GltfImport& import)
{
    const cJSON* list = gltf_get_member(import.root.get(), "buffers");
    for (cJSON* item = list ? list->child : nullptr; item; item = item->next)
    {
        const std::string name =
            gltf_describe("buffer", import.buffers.size(), gltf_get_text(item, "name"));
        const size_t length = static_cast<size_t>(gltf_get_number(item, "byteLength", 0));
        GltfBuffer buffer;
        cJSON* uri = cJSON_GetObjectItemCaseSensitive(item, "uri");
        if (uri)
        {
            std::string problem;
            if (!ls_gltf_load_uri(import, uri->valuestring, length, buffer.owned, problem))
                throw Failure{LS_MESSAGE_GLTF_BUFFER,
                              name + ": " + problem + "; put it there or export the scene again"};
            buffer.bytes = buffer.owned.data();
            buffer.size = buffer.owned.size();
            buffer.is_there = true;
            cJSON_DeleteItemFromObjectCaseSensitive(item, "uri"); // embedded data is large
        }
        else if (import.buffers.empty() && import.binary)
        {
            buffer.bytes = import.binary;
            buffer.size = std::min(length, import.binary_size);
            buffer.is_there = true;
        }
        if (buffer.is_there && buffer.size < length)
            gltf_fail(LS_MESSAGE_GLTF_BUFFER, name + " should have " + std::to_string(length) +
                                                  " bytes, but there are " +
                                                  std::to_string(buffer.size));
        import.buffers.push_back(std::move(buffer));
    }
}

const unsigned char* ls_gltf_find_bytes(const GltfImport& import, int view, size_t offset,
                                        size_t size, const std::string& owner)
{
    const tinygltf::BufferView& record =
        gltf_find(import.model.bufferViews, view, "buffer view", owner);
    const GltfBuffer& buffer = gltf_find(import.buffers, record.buffer, "buffer", owner);
    if (!buffer.is_there)
    {
        for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
            if (record.extensions.count(name))
                throw Failure{LS_MESSAGE_GLTF_COMPRESSED,
                              owner + " is there only as " + name +
                                  " has it; export the scene without compression"};
        gltf_fail(LS_MESSAGE_GLTF_BUFFER, owner + " lies in buffer " +
                                              std::to_string(record.buffer) +
                                              ", which has no bytes");
    }
    // Subtract, never add: the numbers are the file's.
    const bool is_view_inside =
        record.byteOffset <= buffer.size && record.byteLength <= buffer.size - record.byteOffset;
    if (!is_view_inside || offset > record.byteLength || size > record.byteLength - offset)
        gltf_fail(LS_MESSAGE_GLTF_BOUNDS, owner + " reaches beyond its buffer of " +
                                              std::to_string(buffer.size) + " bytes, or its part");
    return buffer.bytes + record.byteOffset + offset;
}
