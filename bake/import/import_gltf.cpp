// import_gltf.cpp - glTF and GLB files through tinygltf; the only place that names it.
//
// What is taken: the nodes of the default scene with their matrices, triangle lists, strips and
// fans, the core material's factors with KHR_materials_emissive_strength, perspective cameras. What
// is left: textures (images are never decoded), animation, skins, morph targets, lights that are no
// triangles. tinygltf checks little of what indices and accessors say, so all of it is checked
// here.

#include "failure.h"
#include "import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace
{

// Row-major 3x4; the fourth row is (0, 0, 0, 1).
using Matrix = std::array<std::array<double, 4>, 3>;

constexpr Matrix IDENTITY = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Matrix multiply(const Matrix& a, const Matrix& b)
{
    Matrix product;
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 4; j++)
            product[i][j] = ((a[i][0] * b[0][j] + a[i][1] * b[1][j]) + a[i][2] * b[2][j]) +
                            (j == 3 ? a[i][3] : 0.0);
    return product;
}

void store_rows(const Matrix& matrix, LsVec4 (&rows)[3])
{
    for (size_t i = 0; i < 3; i++)
        rows[i] = {static_cast<float>(matrix[i][0]), static_cast<float>(matrix[i][1]),
                   static_cast<float>(matrix[i][2]), static_cast<float>(matrix[i][3])};
}

// "mesh 3 (\"walls\")"
std::string describe(const char* kind, size_t index, const std::string& name)
{
    std::string text = std::string(kind) + " " + std::to_string(index);
    if (!name.empty())
        text += " (\"" + name.substr(0, 64) + "\")";
    return text;
}

[[noreturn]] void fail_format(const std::string& text)
{
    throw Failure{LS_ERROR_INPUT_FORMAT, text + "; export the scene again"};
}

[[noreturn]] void fail_index(const std::string& text)
{
    throw Failure{LS_ERROR_INPUT_INDEX, text + "; export the scene again"};
}

// The record that `index` names, or a failure that says who named it.
template <class Record>
const Record& find_record(const std::vector<Record>& records, int index, const char* kind,
                          const std::string& owner)
{
    if (index < 0 || static_cast<size_t>(index) >= records.size())
        fail_index(owner + " names " + kind + " " + std::to_string(index) + ", but there are " +
                   std::to_string(records.size()));
    return records[static_cast<size_t>(index)];
}

template <class Record> Record* check_memory(Record* record)
{
    if (!record)
        throw std::bad_alloc();
    return record;
}

// A mesh placed by the scene's nodes.
struct Placement
{
    size_t mesh;   // of the glTF
    uint32_t node; // of the LsInput
    Matrix world_from_object;
};

// Bytes of an accessor, all within its buffer.
struct Elements
{
    const unsigned char* bytes;
    size_t stride;
    size_t count;
};

class Importer
{
  public:
    Importer(LsInput* target, const char* file) : input(target), path(file)
    {
    }

    void run()
    {
        parse();
        check_extensions();
        walk_scene();
        add_materials();
        add_meshes();
    }

  private:
    LsInput* input;
    std::string path;
    tinygltf::Model model;
    std::vector<Placement> placements;
    std::vector<bool> is_node_seen;
    uint32_t first_material = 0;

    void parse();
    void check_extensions() const;
    void walk_scene();
    void walk_node(int index, uint32_t parent, const Matrix& world_from_parent, unsigned level,
                   const std::string& owner);
    Matrix read_transform(const tinygltf::Node& node, const std::string& name) const;
    void add_camera(const tinygltf::Camera& camera, const Matrix& world_from_node);
    void add_materials();
    void add_meshes();
    bool add_mesh(const tinygltf::Mesh& mesh, const std::string& name);
    Elements find_elements(int index, int type, const std::string& owner) const;
    std::vector<uint32_t> read_indices(const tinygltf::Primitive& primitive, size_t vertex_count,
                                       const std::string& owner) const;
};

// ---- File ---------------------------------------------------------------------------------------

bool skip_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
                const unsigned char*, int, void*)
{
    return true;
}

void Importer::parse()
{
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(skip_image, nullptr);
    std::string errors, warnings;
    const bool is_binary = std::tolower(path.back()) == 'b';
    const bool is_read = is_binary ? loader.LoadBinaryFromFile(&model, &errors, &warnings, path)
                                   : loader.LoadASCIIFromFile(&model, &errors, &warnings, path);
    if (is_read)
        return;
    errors.resize(std::min(errors.find_first_of("\r\n"), errors.size()));
    fail_format("no readable glTF" + (errors.empty() ? "" : " (" + errors.substr(0, 300) + ")"));
}

// A required extension changes the geometry unless it is of a kind that only dresses it.
void Importer::check_extensions() const
{
    for (const std::string& extension : model.extensionsRequired)
        if (extension.rfind("KHR_materials_", 0) != 0 && extension.rfind("KHR_texture_", 0) != 0 &&
            extension.rfind("EXT_texture_", 0) != 0 && extension != "KHR_lights_punctual")
            throw Failure{LS_ERROR_INPUT_UNSUPPORTED,
                          "requires the extension " + extension.substr(0, 64) +
                              ", which is not supported; export the scene without it"};
}

// ---- Nodes --------------------------------------------------------------------------------------

void Importer::walk_scene()
{
    is_node_seen.assign(model.nodes.size(), false);
    if (!model.scenes.empty())
    {
        const tinygltf::Scene& scene =
            find_record(model.scenes, std::max(model.defaultScene, 0), "scene", "the file");
        for (const int node : scene.nodes)
            walk_node(node, LS_NONE, IDENTITY, 1, "the scene");
        return;
    }
    // Without scenes every node that is nobody's child is shown.
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes)
        for (const int child : node.children)
            if (child >= 0 && static_cast<size_t>(child) < is_child.size())
                is_child[static_cast<size_t>(child)] = true;
    for (size_t i = 0; i < model.nodes.size(); i++)
        if (!is_child[i])
            walk_node(static_cast<int>(i), LS_NONE, IDENTITY, 1, "the file");
}

void Importer::walk_node(int index, uint32_t parent, const Matrix& world_from_parent,
                         unsigned level, const std::string& owner)
{
    const tinygltf::Node& node = find_record(model.nodes, index, "node", owner);
    const std::string name = describe("node", static_cast<size_t>(index), node.name);
    if (is_node_seen[static_cast<size_t>(index)])
        fail_format(name + " has two parents, or is its own");
    is_node_seen[static_cast<size_t>(index)] = true;
    if (level > LS_MAX_NODE_DEPTH)
        throw Failure{LS_ERROR_INPUT_LIMIT, name + " lies deeper than " +
                                                std::to_string(LS_MAX_NODE_DEPTH) +
                                                " levels; flatten the hierarchy"};

    const Matrix parent_from_node = read_transform(node, name);
    const Matrix world_from_node = multiply(world_from_parent, parent_from_node);
    const uint32_t number = input->node_count;
    LsSceneNode* added = check_memory(ls_input_add_node(input));
    added->parent = parent;
    store_rows(parent_from_node, added->parent_from_node);

    if (node.mesh != -1)
    {
        find_record(model.meshes, node.mesh, "mesh", name);
        placements.push_back({static_cast<size_t>(node.mesh), number, world_from_node});
    }
    if (node.camera != -1)
        add_camera(find_record(model.cameras, node.camera, "camera", name), world_from_node);
    for (const int child : node.children)
        walk_node(child, number, world_from_node, level + 1, name);
}

Matrix Importer::read_transform(const tinygltf::Node& node, const std::string& name) const
{
    const auto check_size = [&](const std::vector<double>& numbers, size_t size, const char* what)
    {
        if (!numbers.empty() && numbers.size() != size)
            fail_format(name + " has a " + what + " of " + std::to_string(numbers.size()) +
                        " numbers instead of " + std::to_string(size));
        return !numbers.empty();
    };
    Matrix matrix = IDENTITY;
    if (check_size(node.matrix, 16, "matrix"))
    {
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 4; j++)
                matrix[i][j] = node.matrix[4 * j + i];
        if (node.matrix[3] != 0.0 || node.matrix[7] != 0.0 || node.matrix[11] != 0.0 ||
            node.matrix[15] != 1.0)
            fail_format(name + " has a matrix whose last row is not 0 0 0 1");
        return matrix;
    }
    if (check_size(node.rotation, 4, "rotation"))
    {
        double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2],
               w = node.rotation[3];
        const double length = std::sqrt(((x * x + y * y) + z * z) + w * w);
        if (!(length > 0.0))
            fail_format(name + " has a rotation of length zero");
        x /= length, y /= length, z /= length, w /= length;
        matrix = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
                   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
                   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}}};
    }
    if (check_size(node.scale, 3, "scale"))
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 3; j++)
                matrix[i][j] *= node.scale[j];
    if (check_size(node.translation, 3, "translation"))
        for (size_t i = 0; i < 3; i++)
            matrix[i][3] = node.translation[i];
    return matrix;
}

// Cameras ignore the scale of their node, as glTF asks. Orthographic ones have no place in the
// format.
// The tangent of an angle in (0, pi/2) by its continued fraction: the same bits from every compiler
// and C library, since it reaches the file.
static double find_tangent(double angle)
{
    const double square = angle * angle;
    double below = 61.0;
    for (int odd = 59; odd >= 1; odd -= 2)
        below = odd - square / below;
    return angle / below;
}

void Importer::add_camera(const tinygltf::Camera& camera, const Matrix& world_from_node)
{
    if (camera.type != "perspective")
        return;
    const double tan_half_y = find_tangent(0.5 * camera.perspective.yfov);
    if (!(camera.perspective.yfov > 0.0 && camera.perspective.yfov < 3.14159) ||
        !(camera.perspective.aspectRatio >= 0.0))
        fail_format("a camera has a field of view outside 0 to pi, or a negative aspect ratio");
    Matrix matrix = world_from_node;
    for (size_t j = 0; j < 3; j++)
    {
        const double length =
            std::sqrt((matrix[0][j] * matrix[0][j] + matrix[1][j] * matrix[1][j]) +
                      matrix[2][j] * matrix[2][j]);
        if (!(length > 0.0))
            fail_format("a camera stands in a node that is scaled to nothing");
        for (size_t i = 0; i < 3; i++)
            matrix[i][j] /= length;
    }
    LsCamera* added = check_memory(ls_input_add_camera(input));
    store_rows(matrix, added->world_from_camera);
    added->tan_half_y = static_cast<float>(tan_half_y);
    added->aspect = static_cast<float>(camera.perspective.aspectRatio);
}

// ---- Materials ----------------------------------------------------------------------------------

// glTF's own schema holds factors to [0,1]; a file that does not is held to it here.
float clamp_factor(double factor)
{
    return static_cast<float>(std::min(std::max(factor, 0.0), 1.0));
}

double read_emissive_strength(const tinygltf::Material& material)
{
    const auto extension = material.extensions.find("KHR_materials_emissive_strength");
    if (extension == material.extensions.end() || !extension->second.Has("emissiveStrength"))
        return 1.0;
    return extension->second.Get("emissiveStrength").GetNumberAsDouble();
}

void Importer::add_materials()
{
    first_material = input->material_count;
    for (size_t i = 0; i < model.materials.size(); i++)
    {
        const tinygltf::Material& material = model.materials[i];
        const std::string name = describe("material", i, material.name);
        const std::vector<double>& color = material.pbrMetallicRoughness.baseColorFactor;
        const std::vector<double>& emissive = material.emissiveFactor;
        const double strength = read_emissive_strength(material);
        if (color.size() < 3 || emissive.size() != 3)
            fail_format(name + " has a factor of too few numbers");
        if (!(strength >= 0.0 && strength < 1e30))
            fail_format(name + " has an emissive strength that is negative or not finite");

        LsMaterial* added = &check_memory(ls_input_add_material(input))->core;
        added->base_color = {clamp_factor(color[0]), clamp_factor(color[1]),
                             clamp_factor(color[2])};
        added->emission = {static_cast<float>(std::max(emissive[0], 0.0) * strength),
                           static_cast<float>(std::max(emissive[1], 0.0) * strength),
                           static_cast<float>(std::max(emissive[2], 0.0) * strength)};
        added->metallic = clamp_factor(material.pbrMetallicRoughness.metallicFactor);
        added->roughness = clamp_factor(material.pbrMetallicRoughness.roughnessFactor);
        const LsVec3& emission = added->emission;
        if (!(std::isfinite(emission.x) && std::isfinite(emission.y) && std::isfinite(emission.z)))
            fail_format(name + " emits more than a float can hold");
        if (emission.x > 0.0f || emission.y > 0.0f || emission.z > 0.0f)
            added->flags |= LS_MATERIAL_EMISSIVE;
        if (material.doubleSided)
            added->flags |= LS_MATERIAL_DOUBLE_SIDED;
    }
}

// ---- Meshes -------------------------------------------------------------------------------------

// Checks that all elements of an accessor lie within their view and buffer.
Elements Importer::find_elements(int index, int type, const std::string& owner) const
{
    const tinygltf::Accessor& accessor = find_record(model.accessors, index, "accessor", owner);
    const std::string name =
        owner + ", " + describe("accessor", static_cast<size_t>(index), accessor.name);
    if (accessor.sparse.isSparse || accessor.bufferView == -1)
        throw Failure{LS_ERROR_INPUT_UNSUPPORTED,
                      name + " is sparse, which is not supported; export the scene without "
                             "sparse accessors"};
    if (accessor.type != type)
        fail_format(name + " has the wrong type");
    const tinygltf::BufferView& view =
        find_record(model.bufferViews, accessor.bufferView, "buffer view", name);
    const tinygltf::Buffer& buffer = find_record(model.buffers, view.buffer, "buffer", name);
    const int stride = accessor.ByteStride(view);
    if (stride <= 0)
        fail_format(name + " has an illegal stride");
    if (accessor.count >= LS_NONE)
        throw Failure{LS_ERROR_INPUT_LIMIT, name + " has more than 4294967294 elements"};

    // Subtract, never add: the numbers are the file's.
    const size_t element_bytes =
        static_cast<size_t>(
            tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType))) *
        static_cast<size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type)));
    const bool is_view_inside = view.byteOffset <= buffer.data.size() &&
                                view.byteLength <= buffer.data.size() - view.byteOffset;
    const bool is_accessor_inside = is_view_inside && accessor.byteOffset <= view.byteLength;
    const size_t room = is_accessor_inside ? view.byteLength - accessor.byteOffset : 0;
    if (!is_accessor_inside ||
        (accessor.count &&
         (room < element_bytes ||
          (room - element_bytes) / static_cast<size_t>(stride) < accessor.count - 1)))
        fail_index(name + " reaches beyond its buffer of " + std::to_string(buffer.data.size()) +
                   " bytes");
    return {buffer.data.data() + view.byteOffset + accessor.byteOffset, static_cast<size_t>(stride),
            accessor.count};
}

// The corners of a primitive in the order of drawing.
std::vector<uint32_t> Importer::read_indices(const tinygltf::Primitive& primitive,
                                             size_t vertex_count, const std::string& owner) const
{
    std::vector<uint32_t> indices;
    if (primitive.indices == -1)
    {
        indices.resize(vertex_count);
        for (size_t i = 0; i < vertex_count; i++)
            indices[i] = static_cast<uint32_t>(i);
        return indices;
    }
    const Elements elements = find_elements(primitive.indices, TINYGLTF_TYPE_SCALAR, owner);
    const int component = model.accessors[static_cast<size_t>(primitive.indices)].componentType;
    indices.resize(elements.count);
    for (size_t i = 0; i < elements.count; i++)
    {
        const unsigned char* bytes = elements.bytes + i * elements.stride;
        uint16_t narrow = 0;
        if (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
            std::memcpy(&indices[i], bytes, sizeof indices[i]);
        else if (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT)
            std::memcpy(&narrow, bytes, sizeof narrow), indices[i] = narrow;
        else if (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
            indices[i] = *bytes;
        else
            fail_format(owner + " has indices that are no unsigned integers");
        if (indices[i] >= vertex_count)
            fail_index(owner + " has the index " + std::to_string(indices[i]) + " at place " +
                       std::to_string(i) + ", but " + std::to_string(vertex_count) + " vertices");
    }
    return indices;
}

// Appends the triangles of a primitive, corners in glTF's order (specification 2.0, section
// 3.7.2.1).
void append_triangles(std::vector<uint32_t>& triangles, const std::vector<uint32_t>& indices,
                      uint32_t first_vertex, int mode, const std::string& owner)
{
    const size_t count = indices.size();
    const auto append = [&](size_t a, size_t b, size_t c)
    {
        for (const size_t corner : {a, b, c})
            triangles.push_back(first_vertex + indices[corner]);
    };
    switch (mode)
    {
    case TINYGLTF_MODE_TRIANGLES:
        if (count % 3)
            fail_format(owner + " has " + std::to_string(count) +
                        " corners, which is no multiple of three");
        for (size_t i = 0; i < count; i += 3)
            append(i, i + 1, i + 2);
        break;
    case TINYGLTF_MODE_TRIANGLE_STRIP:
        for (size_t i = 0; i + 2 < count; i++)
            append(i, i + 1 + i % 2, i + 2 - i % 2);
        break;
    case TINYGLTF_MODE_TRIANGLE_FAN:
        for (size_t i = 0; i + 2 < count; i++)
            append(i + 1, i + 2, 0);
        break;
    default:
        fail_format(owner + " has the unknown mode " + std::to_string(mode));
    }
}

// One mesh of the input from all primitives of a glTF mesh; false if it has no triangle.
bool Importer::add_mesh(const tinygltf::Mesh& mesh, const std::string& name)
{
    std::vector<float> positions;
    std::vector<uint32_t> triangles;
    std::vector<uint32_t> materials;
    std::map<int, uint32_t> first_vertices; // primitives may share an accessor of positions
    for (size_t p = 0; p < mesh.primitives.size(); p++)
    {
        const tinygltf::Primitive& primitive = mesh.primitives[p];
        const std::string owner = name + ", primitive " + std::to_string(p);
        const bool is_points_or_lines =
            primitive.mode >= TINYGLTF_MODE_POINTS && primitive.mode <= TINYGLTF_MODE_LINE_STRIP;
        const auto attribute = primitive.attributes.find("POSITION");
        if (is_points_or_lines || attribute == primitive.attributes.end())
            continue;

        const Elements elements = find_elements(attribute->second, TINYGLTF_TYPE_VEC3, owner);
        if (model.accessors[static_cast<size_t>(attribute->second)].componentType !=
            TINYGLTF_COMPONENT_TYPE_FLOAT)
            fail_format(owner + " has positions that are no floats");
        const auto [place, is_new] = first_vertices.try_emplace(
            attribute->second, static_cast<uint32_t>(positions.size() / 3));
        if (is_new)
        {
            if (positions.size() / 3 + elements.count >= LS_NONE)
                throw Failure{LS_ERROR_INPUT_LIMIT,
                              name + " has more than 4294967294 vertices; split it"};
            const size_t first = positions.size();
            positions.resize(first + 3 * elements.count);
            for (size_t i = 0; i < elements.count; i++)
                std::memcpy(&positions[first + 3 * i], elements.bytes + i * elements.stride,
                            3 * sizeof(float));
        }
        append_triangles(triangles, read_indices(primitive, elements.count, owner), place->second,
                         primitive.mode, owner);

        uint32_t material = LS_NONE;
        if (primitive.material == -1)
            material = ls_input_default_material(input);
        else
        {
            find_record(model.materials, primitive.material, "material", owner);
            material = first_material + static_cast<uint32_t>(primitive.material);
        }
        if (material == LS_NONE)
            throw std::bad_alloc();
        materials.resize(triangles.size() / 3, material);
    }
    if (materials.empty())
        return false;
    if (materials.size() >= LS_NONE)
        throw Failure{LS_ERROR_INPUT_LIMIT, name + " has more than 4294967294 triangles; split it"};

    LsInputMesh* added =
        check_memory(ls_input_add_mesh(input, static_cast<uint32_t>(positions.size() / 3),
                                       static_cast<uint32_t>(materials.size())));
    std::copy(positions.begin(), positions.end(), added->positions);
    std::copy(triangles.begin(), triangles.end(), added->indices);
    std::copy(materials.begin(), materials.end(), added->materials);
    return true;
}

// Meshes that the scene shows, in the order of the file; then their placements in the order of
// nodes.
void Importer::add_meshes()
{
    std::vector<bool> is_shown(model.meshes.size(), false);
    for (const Placement& placement : placements)
        is_shown[placement.mesh] = true;
    std::vector<uint32_t> numbers(model.meshes.size(), LS_NONE);
    for (size_t i = 0; i < model.meshes.size(); i++)
        if (is_shown[i] && add_mesh(model.meshes[i], describe("mesh", i, model.meshes[i].name)))
            numbers[i] = input->mesh_count - 1;
    for (const Placement& placement : placements)
    {
        if (numbers[placement.mesh] == LS_NONE)
            continue;
        LsInputInstance* added = check_memory(ls_input_add_instance(input));
        added->mesh = numbers[placement.mesh];
        added->node = placement.node;
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 4; j++)
                added->world_from_object[i][j] = placement.world_from_object[i][j];
    }
}

} // namespace

LsResult ls_import_gltf(LsInput* input, const char* path, LsError* error)
{
    return run_guarded(path, error, [=] { Importer(input, path).run(); });
}
