// gltf_meshes.cpp - meshes that the scene shows, one of the input for each, and their placements.
//
// All primitives of a mesh go into one; those with the same attributes share their vertices. A mesh
// is measured first, then granted, then filled.

#include "gltf_import.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace
{

// Accessors of a primitive's positions and streams, -1 where it has none.
using Attributes = std::array<int, 1 + LS_STREAM_COUNT>;

constexpr struct
{
    const char* name;
    GltfUse use;
} ATTRIBUTES[1 + LS_STREAM_COUNT] = {
    {"POSITION", GltfUse::POSITION},   {"NORMAL", GltfUse::NORMAL},
    {"TEXCOORD_0", GltfUse::TEXCOORD}, {"TEXCOORD_1", GltfUse::TEXCOORD},
    {"COLOR_0", GltfUse::COLOR},
};

// Vertices of the mesh that come from one set of accessors.
struct Block
{
    uint32_t first_vertex = 0;
    std::string owner; // the first primitive that has them
    GltfElements elements[1 + LS_STREAM_COUNT];
    bool has[1 + LS_STREAM_COUNT] = {};
};

// A primitive of triangles.
struct Part
{
    const tinygltf::Primitive* primitive;
    std::string owner;
    size_t block;
    bool has_indices;
    GltfElements indices;
    size_t triangle_count;
};

struct Plan
{
    std::vector<Block> blocks;
    std::vector<Part> parts;
    uint64_t vertex_count = 0, triangle_count = 0;
    bool has_stream[LS_STREAM_COUNT] = {};
};

// ---- Measuring ----------------------------------------------------------------------------------

// What of a primitive's dress is not taken.
void note_attributes(GltfImport& import, const tinygltf::Primitive& primitive,
                     const std::string& owner)
{
    for (const auto& entry : primitive.attributes)
    {
        const std::string& attribute = entry.first;
        const bool is_known =
            std::any_of(std::begin(ATTRIBUTES), std::end(ATTRIBUTES),
                        [&](const auto& known) { return attribute == known.name; });
        if (is_known)
            continue;
        // Any number of names must not give as many warnings.
        if (attribute.rfind("WEIGHTS_", 0) == 0)
            continue; // told of by their joints
        if (attribute.rfind("JOINTS_", 0) == 0)
            ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_SKIN,
                         "joints and weights of skins are not supported", owner,
                         "such meshes stand as their nodes place them");
        else if (attribute == "TANGENT")
            ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_ATTRIBUTE, "tangents are left out", owner,
                         "they are found from texture coordinates");
        else
            ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_ATTRIBUTE, "attributes that are left out",
                         gltf_quote(attribute) + " of " + owner,
                         "positions, normals, texture coordinates 0 and 1 and colours 0 are taken");
    }
    if (!primitive.targets.empty())
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_MORPH, "morph targets are not supported", owner,
                     "such meshes keep their first shape");
}

// Whether it has triangles to show; notes why not.
bool has_triangles(GltfImport& import, const tinygltf::Primitive& primitive,
                   const std::string& owner)
{
    static const char* const modes[] = {"POINTS", "LINES", "LINE_LOOP", "LINE_STRIP"};
    if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        gltf_fail(LS_MESSAGE_GLTF_MEMBER,
                  owner + " has the unknown mode " + std::to_string(primitive.mode));
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES)
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_POINTS_LINES,
                     "points and lines have no triangles",
                     owner + " (" + modes[primitive.mode] + ")",
                     "they will be missing; make thin meshes of them");
    else if (!primitive.attributes.count("POSITION"))
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_NO_POSITION,
                     "primitives without POSITION show nothing", owner, "they will be missing");
    else
        return true;
    return false;
}

// Compressed primitives may have plain data too, which is taken then.
void check_compression(const GltfImport& import, const tinygltf::Primitive& primitive,
                       const std::string& owner)
{
    if (!primitive.extensions.count("KHR_draco_mesh_compression"))
        return;
    const auto is_plain = [&](int index)
    {
        const tinygltf::Accessor& accessor =
            gltf_find(import.model.accessors, index, "accessor", owner);
        return accessor.bufferView != -1 || accessor.sparse.isSparse;
    };
    bool is_all = primitive.indices == -1 || is_plain(primitive.indices);
    for (const auto& [attribute, accessor] : primitive.attributes)
        is_all = is_all && is_plain(accessor);
    if (!is_all)
        throw Failure{LS_MESSAGE_GLTF_COMPRESSED,
                      owner + " is there only as KHR_draco_mesh_compression has it; export the "
                              "scene without compression"};
}

size_t count_triangles(size_t corners, int mode, const std::string& owner)
{
    if (mode == TINYGLTF_MODE_TRIANGLES)
    {
        if (corners % 3)
            gltf_fail(LS_MESSAGE_GLTF_CORNERS, owner + " has " + std::to_string(corners) +
                                                   " corners, which is no multiple of three");
        return corners / 3;
    }
    if (corners == 1 || corners == 2)
        gltf_fail(LS_MESSAGE_GLTF_CORNERS,
                  owner + " is a strip or fan of " + std::to_string(corners) + " corners");
    return corners ? corners - 2 : 0;
}

void add_block(GltfImport& import, const Attributes& attributes, const std::string& owner,
               Plan& plan)
{
    Block block;
    block.owner = owner;
    for (size_t i = 0; i < attributes.size(); i++)
    {
        if (attributes[i] == -1)
            continue;
        const std::string name = owner + ", " + ATTRIBUTES[i].name;
        ls_gltf_find_elements(import, attributes[i], ATTRIBUTES[i].use, name, block.elements[i]);
        block.has[i] = true;
        if (block.elements[i].count != block.elements[0].count)
            gltf_fail(LS_MESSAGE_GLTF_ATTRIBUTE_COUNT,
                      name + " has " + std::to_string(block.elements[i].count) + " elements for " +
                          std::to_string(block.elements[0].count) + " positions");
        if (i > 0)
            plan.has_stream[i - 1] = true;
    }
    block.first_vertex = static_cast<uint32_t>(plan.vertex_count);
    plan.vertex_count += block.elements[0].count;
    plan.blocks.push_back(std::move(block));
}

void plan_mesh(GltfImport& import, const tinygltf::Mesh& mesh, const std::string& name, Plan& plan)
{
    std::map<Attributes, size_t> numbers; // of blocks
    for (size_t p = 0; p < mesh.primitives.size(); p++)
    {
        const tinygltf::Primitive& primitive = mesh.primitives[p];
        const std::string owner = name + ", primitive " + std::to_string(p);
        if (!has_triangles(import, primitive, owner))
            continue;
        note_attributes(import, primitive, owner);
        check_compression(import, primitive, owner);

        Attributes attributes;
        for (size_t i = 0; i < attributes.size(); i++)
        {
            const auto found = primitive.attributes.find(ATTRIBUTES[i].name);
            attributes[i] = found == primitive.attributes.end() ? -1 : found->second;
        }
        const auto [place, is_new] = numbers.try_emplace(attributes, plan.blocks.size());
        if (is_new)
            add_block(import, attributes, owner, plan);

        Part part = {&primitive, owner, place->second, primitive.indices != -1, {}, 0};
        size_t corners = plan.blocks[part.block].elements[0].count;
        if (part.has_indices)
        {
            ls_gltf_find_elements(import, primitive.indices, GltfUse::INDICES, owner, part.indices);
            corners = part.indices.count;
        }
        part.triangle_count = count_triangles(corners, primitive.mode, owner);
        plan.triangle_count += part.triangle_count;
        plan.parts.push_back(std::move(part));
        if (plan.vertex_count >= LS_NONE || plan.triangle_count >= LS_NONE)
            throw Failure{LS_MESSAGE_GLTF_COUNT,
                          name + " has more than 4294967294 vertices or triangles; split it"};
    }
}

// ---- Filling ------------------------------------------------------------------------------------

// The format wants finite attributes; positions are judged by the mesh stage.
void clean_stream(GltfImport& import, const Block& block, LsStreamKind kind, float* values)
{
    const uint32_t size = ls_stream_size(kind);
    size_t wrong = 0;
    for (size_t i = 0; i < block.elements[0].count; i++)
    {
        float* value = values + i * size;
        if (kind == LS_STREAM_COLOR)
            for (uint32_t k = 0; k < size; k++)
                value[k] = value[k] < 0.0f ? 0.0f : value[k] > 1.0f ? 1.0f : value[k];
        if (std::all_of(value, value + size, [](float number) { return std::isfinite(number); }))
            continue;
        std::fill(value, value + size, kind == LS_STREAM_COLOR ? 1.0f : 0.0f);
        wrong++;
    }
    if (wrong)
        ls_gltf_note(
            import, LS_MESSAGE_GLTF_WARN_NOT_FINITE, "attributes that are no finite numbers",
            std::to_string(wrong) + " of " + ATTRIBUTES[1 + kind].name + " of " + block.owner,
            "such normals are left out, texture coordinates are 0, colours white");
}

void fill_block(GltfImport& import, const Block& block, LsInputMesh& mesh)
{
    const size_t count = block.elements[0].count;
    ls_gltf_read_numbers(block.elements[0], block.owner,
                         mesh.positions + size_t(3) * block.first_vertex);
    for (int k = 0; k < LS_STREAM_COUNT; k++)
    {
        const LsStreamKind kind = static_cast<LsStreamKind>(k);
        const uint32_t size = ls_stream_size(kind);
        LsInputStream& stream = mesh.streams[k];
        if (!stream.values)
            continue;
        float* values = stream.values + static_cast<size_t>(size) * block.first_vertex;
        const GltfElements& elements = block.elements[1 + k];
        if (block.has[1 + k])
        {
            ls_gltf_read_numbers(elements, block.owner, values);
            if (elements.width < size) // RGB: spread from behind, alpha is 1
                for (size_t i = count; i-- > 0;)
                {
                    std::memmove(values + i * size, values + i * elements.width,
                                 elements.width * sizeof *values);
                    values[i * size + 3] = 1.0f;
                }
            clean_stream(import, block, kind, values);
        }
        else if (kind == LS_STREAM_COLOR)
            std::fill(values, values + count * size, 1.0f);
    }
}

// Corners in glTF's order (specification 2.0, section 3.7.2.1).
void fill_part(const Part& part, const Block& block, const uint32_t* corners, uint32_t* triangles)
{
    const auto put = [&](size_t triangle, size_t a, size_t b, size_t c)
    {
        const size_t order[3] = {a, b, c};
        for (size_t k = 0; k < 3; k++)
            triangles[3 * triangle + k] =
                block.first_vertex +
                (corners ? corners[order[k]] : static_cast<uint32_t>(order[k]));
    };
    for (size_t i = 0; i < part.triangle_count; i++)
    {
        if (part.primitive->mode == TINYGLTF_MODE_TRIANGLES)
            put(i, 3 * i, 3 * i + 1, 3 * i + 2);
        else if (part.primitive->mode == TINYGLTF_MODE_TRIANGLE_STRIP)
            put(i, i, i + 1 + i % 2, i + 2 - i % 2);
        else
            put(i, i + 1, i + 2, 0);
    }
}

void read_corners(const Part& part, const Block& block, std::vector<uint32_t>& corners)
{
    corners.resize(part.indices.count);
    ls_gltf_read_indices(part.indices, part.owner, corners.data());
    for (size_t i = 0; i < corners.size(); i++)
        if (corners[i] >= block.elements[0].count)
            gltf_fail(LS_MESSAGE_GLTF_VERTEX_INDEX,
                      part.owner + " has the index " + std::to_string(corners[i]) + " at place " +
                          std::to_string(i) + ", but " + std::to_string(block.elements[0].count) +
                          " vertices");
}

uint32_t find_material(GltfImport& import, const Part& part)
{
    uint32_t material;
    if (part.primitive->material == -1)
        material = ls_input_default_material(import.input);
    else
    {
        gltf_find(import.model.materials, part.primitive->material, "material", part.owner);
        material = import.first_material + static_cast<uint32_t>(part.primitive->material);
    }
    if (material == LS_NONE)
        throw std::bad_alloc();
    return material;
}

void reserve_mesh(GltfImport& import, const Plan& plan)
{
    uint64_t vertex_bytes = 3 * sizeof(float), longest = 0;
    for (int k = 0; k < LS_STREAM_COUNT; k++)
        if (plan.has_stream[k])
            vertex_bytes += ls_stream_size(static_cast<LsStreamKind>(k)) * sizeof(float);
    for (const Part& part : plan.parts)
        longest = std::max(longest, static_cast<uint64_t>(part.indices.count));
    ls_gltf_reserve(import, longest * sizeof(uint32_t), 0, true); // corners of a primitive
    ls_gltf_reserve(import,
                    plan.vertex_count * vertex_bytes + plan.triangle_count * 4 * sizeof(uint32_t),
                    plan.triangle_count, false);
}

// One mesh of the input from all primitives of a glTF mesh; false if it has no triangle.
bool add_mesh(GltfImport& import, const tinygltf::Mesh& mesh, const std::string& name)
{
    Plan plan;
    plan_mesh(import, mesh, name, plan);
    if (plan.triangle_count == 0)
        return false;
    reserve_mesh(import, plan);
    LsInputMesh* added =
        gltf_check_memory(ls_input_add_mesh(import.input, static_cast<uint32_t>(plan.vertex_count),
                                            static_cast<uint32_t>(plan.triangle_count)));
    if (!mesh.name.empty())
        added->name = gltf_check_memory(strdup(mesh.name.c_str()));
    for (int k = 0; k < LS_STREAM_COUNT; k++)
        if (plan.has_stream[k] && !ls_input_stream_create(added, static_cast<LsStreamKind>(k),
                                                          added->vertex_count, false))
            throw std::bad_alloc();

    for (const Block& block : plan.blocks)
        fill_block(import, block, *added);
    std::vector<uint32_t> corners;
    size_t triangle = 0;
    for (const Part& part : plan.parts)
    {
        const Block& block = plan.blocks[part.block];
        if (part.has_indices)
            read_corners(part, block, corners);
        fill_part(part, block, part.has_indices ? corners.data() : nullptr,
                  added->indices + 3 * triangle);
        std::fill_n(added->materials + triangle, part.triangle_count,
                    part.triangle_count ? find_material(import, part) : 0);
        triangle += part.triangle_count;
    }
    return true;
}

} // namespace

// Meshes in the order of the file; then their placements in the order of nodes.
void ls_gltf_read_meshes(GltfImport& import)
{
    const std::vector<tinygltf::Mesh>& meshes = import.model.meshes;
    std::vector<bool> is_shown(meshes.size(), false);
    for (const GltfPlacement& placement : import.placements)
        is_shown[placement.mesh] = true;
    std::vector<uint32_t> numbers(meshes.size(), LS_NONE);
    for (size_t i = 0; i < meshes.size(); i++)
    {
        if (is_shown[i] && add_mesh(import, meshes[i], gltf_describe("mesh", i, meshes[i].name)))
            numbers[i] = import.input->mesh_count - 1;
        ls_input_note_progress(import.input, 0.4 + 0.5 * static_cast<double>(i + 1) /
                                                       static_cast<double>(meshes.size()));
    }
    for (const GltfPlacement& placement : import.placements)
    {
        if (numbers[placement.mesh] == LS_NONE)
            continue;
        LsInputInstance* added = gltf_check_memory(ls_input_add_instance(import.input));
        added->mesh = numbers[placement.mesh];
        added->node = placement.node;
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 4; j++)
                added->world_from_object[i][j] = placement.world_from_object[i][j];
    }
}
