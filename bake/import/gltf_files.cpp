// gltf_files.cpp - the files that a glTF names: the URIs of its buffers and images.
//
// The JSON is passed over once for those strings alone, since embedded data may make it large and
// building a tree of it slow. It may be malformed; then the import says so.

#include "gltf_import.h"
#include "input_files.h"

#include <cstdio>
#include <cstring>

namespace
{

constexpr size_t GLB_START = 20; // its header and that of the first chunk, which is the JSON
constexpr size_t LONGEST_KEY = 64;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

// The JSON of a file, in a GLB or alone; empty where it cannot be read.
std::string read_json(const char* path)
{
    const File file(std::fopen(path, "rb"), std::fclose);
    unsigned char start[GLB_START];
    if (!file || std::fseek(file.get(), 0, SEEK_END))
        return {};
    long size = std::ftell(file.get());
    std::rewind(file.get());
    if (size < static_cast<long>(sizeof start) ||
        std::fread(start, 1, sizeof start, file.get()) != sizeof start)
        return {};
    if (!std::memcmp(start, "glTF", 4))
    {
        uint32_t json_size;
        std::memcpy(&json_size, start + 12, sizeof json_size);
        size = std::min(size - static_cast<long>(sizeof start), static_cast<long>(json_size));
    }
    else
        std::rewind(file.get());
    std::string text(static_cast<size_t>(size), '\0');
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
    return text;
}

// Where the string that begins at `start` ends: the place of its closing quote, or the text's end.
size_t find_quote(const std::string& text, size_t start)
{
    size_t end = start;
    while ((end = text.find('"', end + 1)) != std::string::npos)
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
std::string decode(const std::string& text, size_t start, size_t end)
{
    const std::unique_ptr<cJSON, void (*)(cJSON*)> item(
        cJSON_ParseWithLength(text.c_str() + start, end + 1 - start), cJSON_Delete);
    return cJSON_IsString(item.get()) ? item->valuestring : "";
}

bool is_key(const std::string& text, size_t end)
{
    const size_t next = text.find_first_not_of(" \t\r\n", end + 1);
    return next != std::string::npos && text[next] == ':';
}

// The values of "uri" in the objects of the outermost lists "buffers" and "images".
std::vector<std::string> find_uris(const std::string& text)
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
    try
    {
        for (const std::string& uri : find_uris(read_json(path)))
        {
            std::string file;
            if (ls_gltf_find_file(path, uri, file) && !ls_name_table_set(files, file.c_str(), 0))
                return false;
        }
        return true;
    }
    catch (const std::exception&) // there is nothing to throw but for lack of memory
    {
        return false;
    }
}
