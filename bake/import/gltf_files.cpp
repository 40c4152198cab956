// gltf_files.cpp - the files that a glTF names: the URIs of its buffers and images.
//
// The JSON is passed over once for those strings alone, since embedded data may make it large and
// building a tree of it slow. It may be malformed; then the import says so.

#include "gltf_import.h"
#include "input_files.h"
#include "ls_format.h"

#include <cstring>
#include <string_view>

namespace
{

constexpr size_t GLB_START = 20; // its header and that of the first chunk, which is the JSON
constexpr size_t LONGEST_KEY = 64;

// The JSON of a file, in a GLB or alone.
std::string_view find_json(const LsMapping& file)
{
    const std::string_view text(static_cast<const char*>(file.bytes), file.size);
    if (text.substr(0, 4) != "glTF" || text.size() < GLB_START)
        return text;
    uint32_t size;
    std::memcpy(&size, text.data() + GLB_START - 8, sizeof size);
    return text.substr(GLB_START, size);
}

// Where the string that begins at `start` ends: the place of its closing quote, or the text's end.
size_t find_quote(std::string_view text, size_t start)
{
    size_t end = start;
    while ((end = text.find('"', end + 1)) != std::string_view::npos)
    {
        size_t slashes = 0;
        while (text[end - 1 - slashes] == '\\')
            slashes++;
        if (slashes % 2 == 0)
            return end;
    }
    return text.size();
}

// What a string of JSON says; the quotes are at `start` and `end`.
std::string decode(std::string_view text, size_t start, size_t end)
{
    const std::unique_ptr<cJSON, void (*)(cJSON*)> item(
        cJSON_ParseWithLength(text.data() + start, end + 1 - start), cJSON_Delete);
    return cJSON_IsString(item.get()) ? item->valuestring : "";
}

bool is_key(std::string_view text, size_t end)
{
    const size_t next = text.find_first_not_of(" \t\r\n", end + 1);
    return next != std::string_view::npos && text[next] == ':';
}

// The values of "uri" in the objects of the outermost lists "buffers" and "images".
std::vector<std::string> find_uris(std::string_view text)
{
    std::vector<std::string> uris;
    unsigned depth = 0;
    bool is_data = false, is_uri = false;
    for (size_t i = 0; i < text.size(); i++)
    {
        if (text[i] == '"')
        {
            const size_t end = find_quote(text, i);
            if (end == text.size())
                break;
            if ((depth == 1 || (depth == 3 && is_data)) && is_key(text, end))
            {
                const std::string key = end - i < LONGEST_KEY ? decode(text, i, end) : "";
                is_uri = depth == 3 && key == "uri";
                is_data = depth == 3 || key == "buffers" || key == "images";
            }
            else if (depth == 3 && is_uri)
            {
                if (text.compare(i + 1, 5, "data:") != 0)
                    uris.push_back(decode(text, i, end));
                is_uri = false;
            }
            i = end;
        }
        depth += text[i] == '[' || text[i] == '{';
        depth -= text[i] == ']' || text[i] == '}';
    }
    return uris;
}

} // namespace

bool ls_gltf_list_files(const char* path, LsNameTable* files)
{
    // Mapped, since what is only looked at should not count as memory of the bake.
    LsMapping mapping;
    if (ls_mapping_open(&mapping, path, nullptr) != LS_OK)
        return true;
    bool ok = true;
    try
    {
        std::string file;
        for (const std::string& uri : find_uris(find_json(mapping)))
            if (ls_gltf_find_file(path, uri, file))
                ok = ok && ls_name_table_set(files, file.c_str(), 0);
    }
    catch (const std::exception&) // there is nothing to throw but for lack of memory
    {
        ok = false;
    }
    ls_mapping_close(&mapping);
    return ok;
}
