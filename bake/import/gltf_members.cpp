// gltf_members.cpp - whether the members that are read have the types that glTF 2.0 gives them.
//
// tinygltf takes most malformed members for missing ones, drops primitives and channels that lack
// one, and cuts whole numbers to 32 bits. The tables below name what the importer reads; other
// members may be anything. Ranges that need more than the number itself are checked at its use.

#include "gltf_import.h"

#include <algorithm>

namespace
{

enum class Kind
{
    INDEX,  // whole, 0 to 2^31 - 1
    SIZE,   // whole, 0 to 2^53
    NUMBER, // finite
    BOOLEAN,
    STRING,
    NUMBERS, // array of finite numbers, `size` of them unless that is 0
    INDICES, // array
    STRINGS, // array
    OBJECT,
    OBJECTS,   // array
    INDEX_MAP, // object, all of whose members are indices
};

struct Rule
{
    const char* name; // null ends a table
    Kind kind;
    bool is_required = false;
    const Rule* members = nullptr; // of OBJECT and OBJECTS; null: any
    int size = 0;
};

constexpr bool REQUIRED = true, OPTIONAL = false;
constexpr Rule END = {nullptr, Kind::OBJECT};

const Rule TRANSFORM[] = {
    {"offset", Kind::NUMBERS, OPTIONAL, nullptr, 2},
    {"rotation", Kind::NUMBER},
    {"scale", Kind::NUMBERS, OPTIONAL, nullptr, 2},
    {"texCoord", Kind::INDEX},
    END,
};
const Rule TEXTURE_INFO_EXTENSIONS[] = {
    {"KHR_texture_transform", Kind::OBJECT, OPTIONAL, TRANSFORM},
    END,
};
const Rule TEXTURE_INFO[] = {
    {"index", Kind::INDEX, REQUIRED},
    {"texCoord", Kind::INDEX},
    {"scale", Kind::NUMBER},
    {"extensions", Kind::OBJECT, OPTIONAL, TEXTURE_INFO_EXTENSIONS},
    END,
};
const Rule METALLIC_ROUGHNESS[] = {
    {"baseColorFactor", Kind::NUMBERS, OPTIONAL, nullptr, 4},
    {"baseColorTexture", Kind::OBJECT, OPTIONAL, TEXTURE_INFO},
    {"metallicFactor", Kind::NUMBER},
    {"roughnessFactor", Kind::NUMBER},
    {"metallicRoughnessTexture", Kind::OBJECT, OPTIONAL, TEXTURE_INFO},
    END,
};
const Rule TRANSMISSION[] = {
    {"transmissionFactor", Kind::NUMBER},
    {"transmissionTexture", Kind::OBJECT, OPTIONAL, TEXTURE_INFO},
    END,
};
const Rule IOR[] = {{"ior", Kind::NUMBER}, END};
const Rule EMISSIVE_STRENGTH[] = {{"emissiveStrength", Kind::NUMBER}, END};
const Rule MATERIAL_EXTENSIONS[] = {
    {"KHR_materials_transmission", Kind::OBJECT, OPTIONAL, TRANSMISSION},
    {"KHR_materials_ior", Kind::OBJECT, OPTIONAL, IOR},
    {"KHR_materials_emissive_strength", Kind::OBJECT, OPTIONAL, EMISSIVE_STRENGTH},
    END,
};
const Rule MATERIAL[] = {
    {"name", Kind::STRING},
    {"pbrMetallicRoughness", Kind::OBJECT, OPTIONAL, METALLIC_ROUGHNESS},
    {"normalTexture", Kind::OBJECT, OPTIONAL, TEXTURE_INFO},
    {"occlusionTexture", Kind::OBJECT, OPTIONAL, TEXTURE_INFO},
    {"emissiveTexture", Kind::OBJECT, OPTIONAL, TEXTURE_INFO},
    {"emissiveFactor", Kind::NUMBERS, OPTIONAL, nullptr, 3},
    {"alphaMode", Kind::STRING},
    {"alphaCutoff", Kind::NUMBER},
    {"doubleSided", Kind::BOOLEAN},
    {"extensions", Kind::OBJECT, OPTIONAL, MATERIAL_EXTENSIONS},
    END,
};
const Rule TEXTURE[] = {
    {"name", Kind::STRING},
    {"sampler", Kind::INDEX},
    {"source", Kind::INDEX},
    {"extensions", Kind::OBJECT},
    END,
};
const Rule SAMPLER[] = {
    {"magFilter", Kind::INDEX},
    {"minFilter", Kind::INDEX},
    {"wrapS", Kind::INDEX},
    {"wrapT", Kind::INDEX},
    END,
};
const Rule IMAGE[] = {
    {"name", Kind::STRING},
    {"uri", Kind::STRING},
    {"mimeType", Kind::STRING},
    {"bufferView", Kind::INDEX},
    END,
};
const Rule BUFFER[] = {
    {"name", Kind::STRING},
    {"uri", Kind::STRING},
    {"byteLength", Kind::SIZE, REQUIRED},
    END,
};
const Rule BUFFER_VIEW[] = {
    {"name", Kind::STRING},
    {"buffer", Kind::INDEX, REQUIRED},
    {"byteOffset", Kind::SIZE},
    {"byteLength", Kind::SIZE, REQUIRED},
    {"byteStride", Kind::SIZE},
    {"extensions", Kind::OBJECT},
    END,
};
const Rule SPARSE_INDICES[] = {
    {"bufferView", Kind::INDEX, REQUIRED},
    {"byteOffset", Kind::INDEX},
    {"componentType", Kind::INDEX, REQUIRED},
    END,
};
const Rule SPARSE_VALUES[] = {
    {"bufferView", Kind::INDEX, REQUIRED},
    {"byteOffset", Kind::INDEX},
    END,
};
const Rule SPARSE[] = {
    {"count", Kind::INDEX, REQUIRED},
    {"indices", Kind::OBJECT, REQUIRED, SPARSE_INDICES},
    {"values", Kind::OBJECT, REQUIRED, SPARSE_VALUES},
    END,
};
const Rule ACCESSOR[] = {
    {"name", Kind::STRING},
    {"bufferView", Kind::INDEX},
    {"byteOffset", Kind::SIZE},
    {"componentType", Kind::INDEX, REQUIRED},
    {"normalized", Kind::BOOLEAN},
    {"count", Kind::SIZE, REQUIRED},
    {"type", Kind::STRING, REQUIRED},
    {"sparse", Kind::OBJECT, OPTIONAL, SPARSE},
    END,
};
const Rule PRIMITIVE[] = {
    {"attributes", Kind::INDEX_MAP, REQUIRED},
    {"indices", Kind::INDEX},
    {"material", Kind::INDEX},
    {"mode", Kind::INDEX},
    {"targets", Kind::OBJECTS},
    {"extensions", Kind::OBJECT},
    END,
};
const Rule MESH[] = {
    {"name", Kind::STRING},
    {"primitives", Kind::OBJECTS, REQUIRED, PRIMITIVE},
    END,
};
const Rule NODE_LIGHT[] = {{"light", Kind::INDEX, REQUIRED}, END};
const Rule NODE_EXTENSIONS[] = {
    {"KHR_lights_punctual", Kind::OBJECT, OPTIONAL, NODE_LIGHT},
    END,
};
const Rule NODE[] = {
    {"name", Kind::STRING},
    {"mesh", Kind::INDEX},
    {"camera", Kind::INDEX},
    {"skin", Kind::INDEX},
    {"children", Kind::INDICES},
    {"matrix", Kind::NUMBERS, OPTIONAL, nullptr, 16},
    {"translation", Kind::NUMBERS, OPTIONAL, nullptr, 3},
    {"rotation", Kind::NUMBERS, OPTIONAL, nullptr, 4},
    {"scale", Kind::NUMBERS, OPTIONAL, nullptr, 3},
    {"extensions", Kind::OBJECT, OPTIONAL, NODE_EXTENSIONS},
    END,
};
const Rule SCENE[] = {
    {"name", Kind::STRING},
    {"nodes", Kind::INDICES},
    END,
};
const Rule PERSPECTIVE[] = {
    {"yfov", Kind::NUMBER, REQUIRED},
    {"znear", Kind::NUMBER, REQUIRED},
    {"zfar", Kind::NUMBER},
    {"aspectRatio", Kind::NUMBER},
    END,
};
const Rule CAMERA[] = {
    {"name", Kind::STRING},
    {"type", Kind::STRING, REQUIRED},
    {"perspective", Kind::OBJECT, OPTIONAL, PERSPECTIVE},
    {"orthographic", Kind::OBJECT},
    END,
};
const Rule ANIMATION_TARGET[] = {
    {"node", Kind::INDEX},
    {"path", Kind::STRING, REQUIRED},
    {"extensions", Kind::OBJECT},
    END,
};
const Rule ANIMATION_CHANNEL[] = {
    {"sampler", Kind::INDEX, REQUIRED},
    {"target", Kind::OBJECT, REQUIRED, ANIMATION_TARGET},
    END,
};
const Rule ANIMATION_SAMPLER[] = {
    {"input", Kind::INDEX, REQUIRED},
    {"output", Kind::INDEX, REQUIRED},
    {"interpolation", Kind::STRING},
    END,
};
const Rule ANIMATION[] = {
    {"name", Kind::STRING},
    {"channels", Kind::OBJECTS, REQUIRED, ANIMATION_CHANNEL},
    {"samplers", Kind::OBJECTS, REQUIRED, ANIMATION_SAMPLER},
    END,
};
const Rule SKIN[] = {
    {"name", Kind::STRING},
    {"joints", Kind::INDICES, REQUIRED},
    END,
};
const Rule SPOT[] = {
    {"innerConeAngle", Kind::NUMBER},
    {"outerConeAngle", Kind::NUMBER},
    END,
};
const Rule LIGHT[] = {
    {"name", Kind::STRING},
    {"type", Kind::STRING, REQUIRED},
    {"color", Kind::NUMBERS, OPTIONAL, nullptr, 3},
    {"intensity", Kind::NUMBER},
    {"range", Kind::NUMBER},
    {"spot", Kind::OBJECT, OPTIONAL, SPOT},
    END,
};
const Rule LIGHTS[] = {{"lights", Kind::OBJECTS, REQUIRED, LIGHT}, END};
const Rule FILE_EXTENSIONS[] = {
    {"KHR_lights_punctual", Kind::OBJECT, OPTIONAL, LIGHTS},
    END,
};
const Rule ASSET[] = {
    {"version", Kind::STRING, REQUIRED},
    {"minVersion", Kind::STRING},
    END,
};
const Rule ROOT[] = {
    {"asset", Kind::OBJECT, REQUIRED, ASSET},
    {"extensionsUsed", Kind::STRINGS},
    {"extensionsRequired", Kind::STRINGS},
    {"scene", Kind::INDEX},
    {"scenes", Kind::OBJECTS, OPTIONAL, SCENE},
    {"nodes", Kind::OBJECTS, OPTIONAL, NODE},
    {"meshes", Kind::OBJECTS, OPTIONAL, MESH},
    {"accessors", Kind::OBJECTS, OPTIONAL, ACCESSOR},
    {"bufferViews", Kind::OBJECTS, OPTIONAL, BUFFER_VIEW},
    {"buffers", Kind::OBJECTS, OPTIONAL, BUFFER},
    {"materials", Kind::OBJECTS, OPTIONAL, MATERIAL},
    {"textures", Kind::OBJECTS, OPTIONAL, TEXTURE},
    {"samplers", Kind::OBJECTS, OPTIONAL, SAMPLER},
    {"images", Kind::OBJECTS, OPTIONAL, IMAGE},
    {"cameras", Kind::OBJECTS, OPTIONAL, CAMERA},
    {"animations", Kind::OBJECTS, OPTIONAL, ANIMATION},
    {"skins", Kind::OBJECTS, OPTIONAL, SKIN},
    {"extensions", Kind::OBJECT, OPTIONAL, FILE_EXTENSIONS},
    END,
};

// Where a value stands: a chain on the stack, written out only for a message.
struct Place
{
    const Place* above;
    const char* name; // null: an element
    size_t index;
};

std::string describe_place(const Place* place)
{
    if (!place)
        return "";
    const std::string above = describe_place(place->above);
    if (!place->name)
        return above + "[" + std::to_string(place->index) + "]";
    return above + (above.empty() ? "" : ".") + gltf_quote(place->name);
}

[[noreturn]] void fail_member(const Place& place, const std::string& what)
{
    gltf_fail(LS_MESSAGE_GLTF_MEMBER, describe_place(&place) + " " + what);
}

void check_number(const cJSON& value, const Place& place)
{
    if (!cJSON_IsNumber(&value))
        fail_member(place, "is no number");
    if (!std::isfinite(value.valuedouble))
        fail_member(place, "is larger than any number");
}

void check_whole(const cJSON& value, const Place& place, double largest)
{
    check_number(value, place);
    if (!(value.valuedouble >= 0.0 && value.valuedouble <= largest &&
          value.valuedouble == std::floor(value.valuedouble)))
        fail_member(place, "is no whole number from 0 to " +
                               std::to_string(static_cast<uint64_t>(largest)));
}

constexpr double LARGEST_INDEX = 2147483647.0, LARGEST_SIZE = 9007199254740992.0;

void check_string(const cJSON& value, const Place& place)
{
    if (!cJSON_IsString(&value))
        fail_member(place, "is no string");
}

void check_object(const cJSON& object, const Rule* rules, const Place* place);

// Calls `check` for each element of an array.
template <class Check>
int check_array(const cJSON& value, const Place& place, const char* what, const Check& check)
{
    if (!cJSON_IsArray(&value))
        fail_member(place, std::string("is no array of ") + what);
    Place element = {&place, nullptr, 0};
    for (const cJSON* child = value.child; child; child = child->next, element.index++)
        check(*child, element);
    return static_cast<int>(element.index);
}

void check_value(const cJSON& value, const Rule& rule, const Place& place)
{
    switch (rule.kind)
    {
    case Kind::INDEX:
        check_whole(value, place, LARGEST_INDEX);
        break;
    case Kind::SIZE:
        check_whole(value, place, LARGEST_SIZE);
        break;
    case Kind::NUMBER:
        check_number(value, place);
        break;
    case Kind::BOOLEAN:
        if (!cJSON_IsBool(&value))
            fail_member(place, "is neither true nor false");
        break;
    case Kind::STRING:
        check_string(value, place);
        break;
    case Kind::NUMBERS:
    {
        const int count = check_array(value, place, "numbers", check_number);
        if (rule.size && count != rule.size)
            fail_member(place, "has " + std::to_string(count) + " numbers instead of " +
                                   std::to_string(rule.size));
        break;
    }
    case Kind::INDICES:
        check_array(value, place, "whole numbers",
                    [](const cJSON& element, const Place& where)
                    { check_whole(element, where, LARGEST_INDEX); });
        break;
    case Kind::STRINGS:
        check_array(value, place, "strings", check_string);
        break;
    case Kind::OBJECT:
        check_object(value, rule.members, &place);
        break;
    case Kind::OBJECTS:
        check_array(value, place, "objects",
                    [&](const cJSON& element, const Place& where)
                    { check_object(element, rule.members, &where); });
        break;
    case Kind::INDEX_MAP:
        if (!cJSON_IsObject(&value))
            fail_member(place, "is no object");
        for (const cJSON* child = value.child; child; child = child->next)
            check_whole(*child, {&place, child->string, 0}, LARGEST_INDEX);
        break;
    }
}

// glTF wants the names of an object's members to be unique (2.0, section 2.7): of two, cJSON takes the
// first and tinygltf the last. What is extra is nobody's business.
void check_names(const cJSON& value, const Place* place)
{
    std::vector<const char*> names;
    Place child_place = {place, nullptr, 0};
    for (const cJSON* child = value.child; child; child = child->next, child_place.index++)
    {
        child_place.name = child->string;
        if (child->string)
            names.push_back(child->string);
        if (child->child && !(child->string && !std::strcmp(child->string, "extras")))
            check_names(*child, &child_place);
    }
    std::sort(names.begin(), names.end(),
              [](const char* a, const char* b) { return std::strcmp(a, b) < 0; });
    for (size_t i = 1; i < names.size(); i++)
        if (!std::strcmp(names[i - 1], names[i]))
            fail_member({place, names[i], 0}, "comes twice");
}

void check_object(const cJSON& object, const Rule* rules, const Place* place)
{
    if (!cJSON_IsObject(&object))
        fail_member(*place, "is no object");
    uint64_t seen = 0;
    for (const cJSON* child = object.child; child && rules; child = child->next)
        for (unsigned i = 0; rules[i].name; i++)
            if (!std::strcmp(rules[i].name, child->string))
            {
                seen |= uint64_t(1) << i;
                check_value(*child, rules[i], {place, child->string, 0});
                break;
            }
    for (unsigned i = 0; rules && rules[i].name; i++)
        if (rules[i].is_required && !(seen >> i & 1))
            fail_member({place, rules[i].name, 0}, "is missing");
}

// tinygltf keeps one of the two.
void check_transforms(const cJSON* nodes)
{
    size_t index = 0;
    for (const cJSON* node = nodes ? nodes->child : nullptr; node; node = node->next, index++)
        if (gltf_get_member(node, "matrix") &&
            (gltf_get_member(node, "translation") || gltf_get_member(node, "rotation") ||
             gltf_get_member(node, "scale")))
            gltf_fail(LS_MESSAGE_GLTF_TRANSFORM,
                      gltf_describe("node", index, gltf_get_text(node, "name")) +
                          " has a matrix and also a translation, rotation or scale");
}

// tinygltf itself refuses such indices, of meshes that nobody shows too, and does not say whose.
void check_indices(const cJSON* root)
{
    std::vector<bool> has_view; // of accessors
    const cJSON* accessors = gltf_get_member(root, "accessors");
    for (const cJSON* item = accessors ? accessors->child : nullptr; item; item = item->next)
        has_view.push_back(gltf_get_member(item, "bufferView"));
    const cJSON* meshes = gltf_get_member(root, "meshes");
    size_t number = 0;
    for (const cJSON* mesh = meshes ? meshes->child : nullptr; mesh; mesh = mesh->next, number++)
    {
        size_t p = 0;
        for (const cJSON* primitive = gltf_get_member(mesh, "primitives")->child; primitive;
             primitive = primitive->next, p++)
        {
            const int index = gltf_get_index(primitive, "indices", -1);
            if (index == -1)
                continue;
            const std::string owner = gltf_describe("mesh", number, gltf_get_text(mesh, "name")) +
                                      ", primitive " + std::to_string(p);
            if (static_cast<size_t>(index) >= has_view.size())
                gltf_fail(LS_MESSAGE_GLTF_INDEX,
                          owner + " names accessor " + std::to_string(index) +
                              " for its indices, but there are " + std::to_string(has_view.size()));
            if (!has_view[static_cast<size_t>(index)])
                gltf_fail(LS_MESSAGE_GLTF_ACCESSOR, owner + " has its indices in accessor " +
                                                        std::to_string(index) +
                                                        ", which has no buffer view");
        }
    }
}

} // namespace

void ls_gltf_check_members(GltfImport& import)
{
    check_names(*import.root, nullptr);
    check_object(*import.root, ROOT, nullptr);
    check_transforms(gltf_get_member(import.root.get(), "nodes"));
    check_indices(import.root.get());
}
