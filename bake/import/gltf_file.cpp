// gltf_file.cpp - from a file to records: parts a GLB, checks the JSON's shape, parses it.
//
// tinygltf's own file functions are not used: they look for buffers in the working directory too,
// hang on pipes, read up to eight bytes behind a GLB's second chunk, want sizes to match exactly,
// load images that nobody uses, and copy embedded data four times. So it gets the text alone, in
// which the values of "buffers" and "images" are blanked; other stages read those.

#include "gltf_import.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace
{

constexpr unsigned MAX_JSON_DEPTH = 128; // tinygltf recurses through extras and extensions
// cJSON, tinygltf's own parser and its records, for one value.
constexpr uint64_t BYTES_PER_VALUE = 400;
constexpr uint32_t GLB_MAGIC = 0x46546C67, CHUNK_JSON = 0x4E4F534A, CHUNK_BIN = 0x004E4942;
constexpr size_t GLB_HEADER = 12, CHUNK_HEADER = 8;

void read_bytes(GltfImport& import)
{
    const int file = open(import.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status;
    if (file < 0 || fstat(file, &status) || !S_ISREG(status.st_mode))
    {
        const std::string reason = file < 0 ? std::strerror(errno) : "no regular file";
        if (file >= 0)
            close(file);
        throw Failure{LS_MESSAGE_FILE_UNREADABLE, "cannot be read: " + reason};
    }
    try
    {
        ls_gltf_reserve(import, static_cast<uint64_t>(status.st_size), 0, true);
        import.file.resize(static_cast<size_t>(status.st_size));
    }
    catch (...)
    {
        close(file);
        throw;
    }
    size_t size = 0;
    while (size < import.file.size())
    {
        const ssize_t part = read(file, import.file.data() + size, import.file.size() - size);
        if (part < 0 && errno == EINTR)
            continue;
        if (part <= 0)
            break;
        size += static_cast<size_t>(part);
    }
    close(file);
    if (size < import.file.size())
        throw Failure{LS_MESSAGE_FILE_CHANGED, "shrank or failed while it was read; try again"};
}

uint32_t read_word(const GltfImport& import, size_t offset)
{
    uint32_t word;
    std::memcpy(&word, import.file.data() + offset, sizeof word);
    return word;
}

// Parts a GLB: JSON, then perhaps the binary chunk; chunks behind them are to be ignored.
void part_binary(GltfImport& import)
{
    if (import.file.size() < GLB_HEADER + CHUNK_HEADER)
        gltf_fail(LS_MESSAGE_GLTF_GLB, "the GLB ends within its header");
    const uint32_t version = read_word(import, 4), length = read_word(import, 8);
    if (version != 2)
        throw Failure{LS_MESSAGE_GLTF_VERSION, "is a GLB of version " + std::to_string(version) +
                                                   ", only 2 is read; convert it to glTF 2.0"};
    if (length > import.file.size())
        gltf_fail(LS_MESSAGE_GLTF_GLB, "the GLB says that it has " + std::to_string(length) +
                                           " bytes, but the file has " +
                                           std::to_string(import.file.size()));
    size_t place = GLB_HEADER;
    for (unsigned chunk = 0; chunk < 2 && length >= place && length - place >= CHUNK_HEADER;
         chunk++)
    {
        const uint32_t size = read_word(import, place), kind = read_word(import, place + 4);
        place += CHUNK_HEADER;
        if (size > length - place)
            gltf_fail(LS_MESSAGE_GLTF_GLB,
                      "chunk " + std::to_string(chunk) + " of the GLB reaches beyond its end");
        if (chunk == 0 && kind != CHUNK_JSON)
            gltf_fail(LS_MESSAGE_GLTF_GLB, "the first chunk of the GLB is not JSON");
        const unsigned char* bytes = import.file.data() + place;
        if (chunk == 0)
            import.text.assign(reinterpret_cast<const char*>(bytes), size);
        else if (kind == CHUNK_BIN)
        {
            import.binary = bytes;
            import.binary_size = size;
        }
        place += size;
    }
    if (length > place && length - place < CHUNK_HEADER)
        gltf_fail(LS_MESSAGE_GLTF_GLB, "the GLB ends within the header of a chunk");
    if (import.text.empty())
        gltf_fail(LS_MESSAGE_GLTF_GLB, "the GLB has no JSON");
}

// "line 3, column 7"
std::string describe_place(const std::string& text, size_t offset)
{
    size_t line = 1, start = 0;
    for (size_t i = 0; i < offset && i < text.size(); i++)
        if (text[i] == '\n')
            line++, start = i + 1;
    return "line " + std::to_string(line) + ", column " + std::to_string(offset - start + 1);
}

// Where the string that begins at `start` ends: the place of its closing quote, or the text's end.
size_t find_quote(const std::string& text, size_t start)
{
    size_t i = start + 1;
    while (i < text.size() && text[i] != '"')
        i += text[i] == '\\' ? 2 : 1;
    return std::min(i, text.size());
}

// Whether a string holds a NUL. cJSON's strings end at one and tinygltf's do not, so the two would
// read different names.
bool has_nul(const std::string& text, size_t start, size_t end)
{
    for (size_t i = start + 1; i < end; i++)
    {
        if (text[i] == '\\' && !text.compare(i, 6, "\\u0000"))
            return true;
        i += text[i] == '\\';
    }
    return false;
}

// Counts values and looks how deep they nest, before anything is built of them.
void check_shape(GltfImport& import)
{
    const std::string& text = import.text;
    uint64_t values = 1;
    unsigned depth = 0;
    for (size_t i = 0; i < text.size(); i++)
    {
        switch (text[i])
        {
        case '"':
        {
            const size_t end = find_quote(text, i);
            if (has_nul(text, i, end))
                gltf_fail(LS_MESSAGE_GLTF_JSON, "no readable glTF: a string holds a zero byte at " +
                                                    describe_place(text, i));
            i = end;
            break;
        }
        case '[':
        case '{':
            values++;
            if (++depth > MAX_JSON_DEPTH)
                throw Failure{LS_MESSAGE_GLTF_JSON_DEPTH,
                              "the JSON nests deeper than " + std::to_string(MAX_JSON_DEPTH) +
                                  " levels at " + describe_place(text, i) +
                                  "; remove what nests so deep"};
            break;
        case ']':
        case '}':
            depth -= depth > 0;
            break;
        case ',':
            values++;
            break;
        default:
            break;
        }
    }
    ls_gltf_reserve(import, text.size() + values * BYTES_PER_VALUE, 0, true);
}

// Blanks the values of the members "buffers" and "images" of the outermost object. The text is JSON
// and they are arrays.
void blank_data(std::string& text)
{
    unsigned depth = 0;
    std::string key;
    size_t start = 0; // of a value to blank
    for (size_t i = 0; i < text.size(); i++)
    {
        const char letter = text[i];
        if (letter == '"')
        {
            const size_t end = find_quote(text, i);
            if (depth == 1 && !start)
                key = end - i < 16 ? text.substr(i + 1, end - i - 1) : "";
            i = end;
        }
        else if (letter == ':' && depth == 1 && (key == "buffers" || key == "images"))
            start = i + 1;
        else if (start && depth == 1 && (letter == ',' || letter == '}'))
        {
            text.replace(start, i - start, "[]" + std::string(i - start - 2, ' '));
            start = 0;
            key.clear();
        }
        depth += letter == '[' || letter == '{';
        depth -= letter == ']' || letter == '}';
    }
}

void parse_json(GltfImport& import)
{
    if (import.text.size() > UINT32_MAX - 1)
        throw Failure{LS_MESSAGE_GLTF_COUNT,
                      "the JSON is larger than 4 GB; keep its buffers in files of their own"};
    check_shape(import);
    const char* end = nullptr;
    import.root.reset(
        cJSON_ParseWithLengthOpts(import.text.c_str(), import.text.size(), &end, false));
    size_t place = end ? static_cast<size_t>(end - import.text.c_str()) : 0;
    if (import.root)
        while (place < import.text.size() && std::strchr(" \t\r\n", import.text[place]))
            place++; // strchr finds the NUL too, by which some writers pad
    if (!import.root || place < import.text.size())
        gltf_fail(LS_MESSAGE_GLTF_JSON, "no readable glTF: the JSON is malformed at " +
                                            describe_place(import.text, place));
    if (!cJSON_IsObject(import.root.get()))
        gltf_fail(LS_MESSAGE_GLTF_JSON, "no readable glTF: the JSON is no object");

    // Before anything else, since glTF 1 has objects where 2 has arrays.
    const cJSON* asset = gltf_get_member(import.root.get(), "asset");
    const std::string version = gltf_get_text(asset, "version");
    const std::string least = gltf_get_text(asset, "minVersion");
    if (version.empty())
        gltf_fail(LS_MESSAGE_GLTF_VERSION, "has no asset with a version, so it is no glTF 2.0");
    if (version.rfind("2.", 0) != 0 || (!least.empty() && least != "2.0"))
        throw Failure{LS_MESSAGE_GLTF_VERSION, "is glTF " +
                                                   gltf_quote(least.empty() ? version : least) +
                                                   ", only 2.0 is read; convert it"};
}

// tinygltf's records are large, and their arrays grow by doubling.
void reserve_records(GltfImport& import)
{
    static const struct
    {
        const char* name;
        size_t bytes;
    } arrays[] = {
        {"accessors", sizeof(tinygltf::Accessor)},
        {"animations", sizeof(tinygltf::Animation)},
        {"bufferViews", sizeof(tinygltf::BufferView)},
        {"cameras", sizeof(tinygltf::Camera)},
        {"materials", sizeof(tinygltf::Material)},
        {"meshes", sizeof(tinygltf::Mesh)},
        {"nodes", sizeof(tinygltf::Node)},
        {"samplers", sizeof(tinygltf::Sampler)},
        {"scenes", sizeof(tinygltf::Scene)},
        {"skins", sizeof(tinygltf::Skin)},
        {"textures", sizeof(tinygltf::Texture)},
    };
    uint64_t bytes = 0;
    for (const auto& array : arrays)
    {
        const cJSON* list = gltf_get_member(import.root.get(), array.name);
        for (const cJSON* item = list ? list->child : nullptr; item; item = item->next)
            bytes += 2 * array.bytes;
    }
    ls_gltf_reserve(import, bytes, 0, true);
}

// Numbers of the file are looked up among tinygltf's records and among the JSON's: both must hold the
// same, or what is checked in one would be used in the other.
void check_records(const GltfImport& import)
{
    const tinygltf::Model& model = import.model;
    const struct
    {
        const char* name;
        size_t count;
    } arrays[] = {
        {"accessors", model.accessors.size()},
        {"animations", model.animations.size()},
        {"bufferViews", model.bufferViews.size()},
        {"cameras", model.cameras.size()},
        {"materials", model.materials.size()},
        {"meshes", model.meshes.size()},
        {"nodes", model.nodes.size()},
        {"samplers", model.samplers.size()},
        {"scenes", model.scenes.size()},
        {"skins", model.skins.size()},
        {"textures", model.textures.size()},
    };
    for (const auto& array : arrays)
    {
        const cJSON* list = gltf_get_member(import.root.get(), array.name);
        size_t count = 0;
        for (const cJSON* item = list ? list->child : nullptr; item; item = item->next)
            count++;
        if (count != array.count)
            gltf_fail(LS_MESSAGE_GLTF_MEMBER, std::string(array.name) + ": only " +
                                                  std::to_string(array.count) + " of " +
                                                  std::to_string(count) + " are well-formed");
    }
}

// tinygltf finds no files.
bool find_no_file(const std::string&, void*)
{
    return false;
}

std::string keep_path(const std::string& path, void*)
{
    return path;
}

bool read_no_file(std::vector<unsigned char>*, std::string*, const std::string&, void*)
{
    return false;
}

bool write_no_file(std::string*, const std::string&, const std::vector<unsigned char>&, void*)
{
    return false;
}

bool load_no_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
                   const unsigned char*, int, void*)
{
    return false;
}

} // namespace

void ls_gltf_read_file(GltfImport& import)
{
    read_bytes(import);
    const std::string& path = import.path;
    if (import.file.size() >= 4 && read_word(import, 0) == GLB_MAGIC)
        part_binary(import);
    else if (path.back() == 'b' || path.back() == 'B')
        gltf_fail(LS_MESSAGE_GLTF_GLB, "is no GLB: it does not begin with \"glTF\"");
    else
    {
        import.text.assign(import.file.begin(), import.file.end());
        import.file = {};
    }
    parse_json(import);
}

void ls_gltf_read_model(GltfImport& import)
{
    blank_data(import.text);
    reserve_records(import);
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(load_no_image, nullptr);
    loader.SetFsCallbacks({find_no_file, keep_path, read_no_file, write_no_file, nullptr});
    std::string errors, warnings;
    if (!loader.LoadASCIIFromString(&import.model, &errors, &warnings, import.text.c_str(),
                                    static_cast<unsigned>(import.text.size()), ""))
    {
        errors.resize(std::min(errors.find_first_of("\r\n"), errors.size()));
        gltf_fail(LS_MESSAGE_GLTF_JSON,
                  "no readable glTF" + (errors.empty() ? "" : " (" + errors.substr(0, 300) + ")"));
    }
    import.text = {};
    check_records(import);
}
