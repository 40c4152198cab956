// gltf_animation.cpp - animations of the nodes that the scene shows.
//
// The format wants translation, rotation and scale of every animated node, in the order of nodes;
// what the file leaves out stands still at the node's own.

#include "gltf_import.h"

#include <algorithm>
#include <array>

namespace
{

constexpr uint32_t PATHS = 3;

// Samplers of one node by LS_PATH_*, -1 where it has none.
struct Track
{
    size_t node; // of the glTF
    std::array<int, PATHS> samplers = {-1, -1, -1};
};

// Keys of an input accessor that are kept: their times rise.
struct Times
{
    std::vector<float> seconds;
    std::vector<size_t> places; // in the accessor
    size_t count = 0;           // of the accessor
};

// A path's name as LS_PATH_*, or PATHS.
uint32_t find_path(const std::string& path)
{
    if (path == "translation")
        return LS_PATH_TRANSLATION;
    if (path == "rotation")
        return LS_PATH_ROTATION;
    return path == "scale" ? LS_PATH_SCALE : PATHS;
}

// tinygltf drops channels without a node, whose targets are an extension's.
void note_dropped(GltfImport& import)
{
    const cJSON* animations = gltf_get_member(import.root.get(), "animations");
    size_t index = 0;
    for (const cJSON* item = animations ? animations->child : nullptr; item;
         item = item->next, index++)
    {
        size_t number = 0;
        const std::string name = gltf_describe("animation", index, gltf_get_text(item, "name"));
        for (const cJSON* channel = gltf_get_member(item, "channels")->child; channel;
             channel = channel->next, number++)
            if (!gltf_get_member(gltf_get_member(channel, "target"), "node"))
                ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_CHANNEL,
                             "animation of anything but nodes is not supported",
                             name + ", channel " + std::to_string(number), "it stands still");
    }
}

// The shown nodes that an animation moves, by their numbers in the LsInput.
std::map<uint32_t, Track> find_tracks(GltfImport& import, const tinygltf::Animation& animation,
                                      const std::string& name)
{
    std::map<uint32_t, Track> tracks;
    for (const tinygltf::AnimationChannel& channel : animation.channels)
    {
        const tinygltf::Node& node =
            gltf_find(import.model.nodes, channel.target_node, "node", name);
        const size_t place = static_cast<size_t>(channel.target_node);
        const std::string owner = name + ", " + gltf_describe("node", place, node.name);
        gltf_find(animation.samplers, channel.sampler, "sampler", name);
        const uint32_t path = find_path(channel.target_path);
        if (path == PATHS)
        {
            if (channel.target_path == "weights")
                ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_MORPH, "morph targets are not supported",
                             owner + " (weights)", "such meshes keep their first shape");
            else
                ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_CHANNEL,
                             "animation of anything but nodes is not supported",
                             owner + " (" + gltf_quote(channel.target_path) + ")",
                             "it stands still");
            continue;
        }
        if (import.node_numbers[place] == LS_NONE)
            continue; // in another scene, or in none
        if (!node.matrix.empty())
            gltf_fail(LS_MESSAGE_GLTF_ANIMATION,
                      owner + " is animated, but has a matrix instead of translation, rotation and "
                              "scale");
        Track& track = tracks[import.node_numbers[place]];
        track.node = place;
        if (track.samplers[path] != -1)
            gltf_fail(LS_MESSAGE_GLTF_ANIMATION,
                      owner + " is animated twice in its " + channel.target_path);
        track.samplers[path] = channel.sampler;
    }
    return tracks;
}

void read_times(GltfImport& import, int accessor, const std::string& owner, Times& times)
{
    GltfElements elements;
    ls_gltf_find_elements(import, accessor, GltfUse::TIMES, owner, elements);
    ls_gltf_reserve(import, elements.count * (2 * sizeof(float) + sizeof(size_t)), 0, true);
    std::vector<float> seconds(elements.count);
    ls_gltf_read_numbers(elements, owner, seconds.data());
    times = {};
    times.count = elements.count;
    for (size_t i = 0; i < seconds.size(); i++)
    {
        if (!(seconds[i] >= 0.0f && std::isfinite(seconds[i])))
            gltf_fail(LS_MESSAGE_GLTF_ANIMATION,
                      owner + " has a key at a time that is negative or no number");
        if (!times.seconds.empty() && seconds[i] <= times.seconds.back())
            continue;
        times.seconds.push_back(seconds[i]);
        times.places.push_back(i);
    }
    if (times.seconds.size() < seconds.size())
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_KEYS, "keys whose times do not rise",
                     std::to_string(seconds.size() - times.seconds.size()) + " of " + owner,
                     "they are left out");
    if (times.seconds.empty())
        gltf_fail(LS_MESSAGE_GLTF_ANIMATION, owner + " has no keys");
}

uint32_t find_interpolation(const std::string& word, const std::string& owner)
{
    if (word == "STEP")
        return LS_INTERPOLATION_STEP;
    if (word == "CUBICSPLINE")
        return LS_INTERPOLATION_CUBIC;
    if (word != "LINEAR" && !word.empty())
        gltf_fail(LS_MESSAGE_GLTF_MEMBER,
                  owner + " has the unknown interpolation \"" + gltf_quote(word) + "\"");
    return LS_INTERPOLATION_LINEAR;
}

// Scales the quaternions of a key, its tangents by the same factor, so that the value has unit
// length.
void normalize_key(float* key, bool is_cubic, const std::string& owner)
{
    float* value = key + (is_cubic ? 4 : 0);
    double q[4] = {double(value[0]), double(value[1]), double(value[2]), double(value[3])};
    double length;
    if (!gltf_normalize(q, length))
        gltf_fail(LS_MESSAGE_GLTF_ANIMATION, owner + " has a rotation of length zero");
    for (size_t k = 0; is_cubic && k < 12; k++)
        if (k < 4 || k >= 8)
            key[k] = gltf_narrow(double(key[k]) / length, owner);
    for (size_t k = 0; k < 4; k++)
        value[k] = static_cast<float>(q[k]);
}

uint32_t add_keys(GltfImport& import, const float* numbers, size_t count)
{
    if (count > LS_NONE - 1)
        throw std::bad_alloc();
    ls_gltf_reserve(import, count * sizeof(float), 0, false);
    float* added = gltf_check_memory(ls_input_add_keys(import.input, static_cast<uint32_t>(count)));
    std::copy(numbers, numbers + count, added);
    return import.input->key_count - static_cast<uint32_t>(count);
}

// Adds the values of an output accessor at the keys that are kept.
uint32_t add_values(GltfImport& import, int accessor, uint32_t path, bool is_cubic,
                    const Times& times, const std::string& owner)
{
    const bool is_rotation = path == LS_PATH_ROTATION;
    GltfElements elements;
    ls_gltf_find_elements(import, accessor, is_rotation ? GltfUse::ROTATIONS : GltfUse::VECTORS,
                          owner, elements);
    const size_t per_key = is_cubic ? 3 : 1;
    if (elements.count % per_key || elements.count / per_key != times.count)
        gltf_fail(LS_MESSAGE_GLTF_ANIMATION, owner + " has " + std::to_string(elements.count) +
                                                 " values for " + std::to_string(times.count) +
                                                 " keys");
    const size_t width = per_key * elements.width; // numbers of a key
    ls_gltf_reserve(import, times.count * width * sizeof(float), 0, true);
    std::vector<float> numbers(times.count * width);
    ls_gltf_read_numbers(elements, owner, numbers.data());
    for (const float number : numbers)
        if (!std::isfinite(number))
            gltf_fail(LS_MESSAGE_GLTF_NOT_FINITE, owner + " has a value that is no finite number");
    for (size_t i = 0; i < times.places.size(); i++)
    {
        float* key = &numbers[i * width];
        std::copy_n(&numbers[times.places[i] * width], width, key);
        if (is_rotation)
            normalize_key(key, is_cubic, owner);
    }
    return add_keys(import, numbers.data(), times.places.size() * width);
}

// A path that stands still: one key of the node's own.
uint32_t add_constant(GltfImport& import, const tinygltf::Node& node, uint32_t path,
                      const std::string& owner)
{
    double still[4] = {0.0, 0.0, 0.0, 1.0};
    const std::vector<double>& own = path == LS_PATH_TRANSLATION ? node.translation
                                     : path == LS_PATH_ROTATION  ? node.rotation
                                                                 : node.scale;
    if (path == LS_PATH_SCALE)
        std::fill(still, still + 3, 1.0);
    std::copy(own.begin(), own.end(), still);
    double length;
    if (path == LS_PATH_ROTATION)
        gltf_normalize(still, length); // not of length zero (gltf_nodes.cpp)
    float values[4];
    const size_t width = path == LS_PATH_ROTATION ? 4 : 3;
    for (size_t k = 0; k < width; k++)
        values[k] = gltf_narrow(still[k], owner);
    return add_keys(import, values, width);
}

// The three channels of a node; returns the time of the last key.
float add_track(GltfImport& import, const tinygltf::Animation& animation, const std::string& name,
                uint32_t number, const Track& track)
{
    static const char* const words[PATHS] = {"translation", "rotation", "scale"};
    const tinygltf::Node& node = import.model.nodes[track.node];
    float last = 0.0f;
    int known = -1; // accessor of the times that the channel before has
    Times times;
    for (uint32_t path = 0; path < PATHS; path++)
    {
        const std::string owner =
            name + ", " + words[path] + " of " + gltf_describe("node", track.node, node.name);
        LsChannel channel = {};
        channel.node = number;
        channel.path = path;
        if (track.samplers[path] == -1)
        {
            const float start = 0.0f;
            channel.interpolation = LS_INTERPOLATION_STEP;
            channel.key_count = 1;
            channel.first_time = add_keys(import, &start, 1);
            channel.first_value = add_constant(import, node, path, owner);
            known = -1;
        }
        else
        {
            const tinygltf::AnimationSampler& sampler =
                animation.samplers[static_cast<size_t>(track.samplers[path])];
            channel.interpolation = find_interpolation(sampler.interpolation, owner);
            const bool is_shared = known == sampler.input;
            if (!is_shared)
                read_times(import, sampler.input, owner, times);
            known = sampler.input;
            channel.key_count = static_cast<uint32_t>(times.seconds.size());
            channel.first_time =
                is_shared ? import.input->channels[import.input->channel_count - 1].first_time
                          : add_keys(import, times.seconds.data(), times.seconds.size());
            channel.first_value =
                add_values(import, sampler.output, path,
                           channel.interpolation == LS_INTERPOLATION_CUBIC, times, owner);
            last = std::max(last, times.seconds.back());
        }
        *gltf_check_memory(ls_input_add_channel(import.input)) = channel;
    }
    return last;
}

} // namespace

void ls_gltf_read_animations(GltfImport& import)
{
    note_dropped(import);
    for (size_t i = 0; i < import.model.animations.size(); i++)
    {
        const tinygltf::Animation& animation = import.model.animations[i];
        const std::string name = gltf_describe("animation", i, animation.name);
        const std::map<uint32_t, Track> tracks = find_tracks(import, animation, name);
        if (tracks.empty())
            continue;
        LsAnimation made = {};
        made.first_channel = import.input->channel_count;
        for (const auto& [number, track] : tracks)
            made.duration =
                std::max(made.duration, add_track(import, animation, name, number, track));
        made.channel_count = import.input->channel_count - made.first_channel;
        *gltf_check_memory(ls_input_add_animation(import.input)) = made;
    }
}
