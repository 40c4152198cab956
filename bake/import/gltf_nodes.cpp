// gltf_nodes.cpp - the nodes of the scene that is taken, with their transforms.

#include "gltf_import.h"

#include <algorithm>

namespace
{

// Which scene: the one asked for, else the default one, else the first; -1 if there is none.
int choose_scene(GltfImport& import)
{
    const std::vector<tinygltf::Scene>& scenes = import.model.scenes;
    const uint32_t wanted = import.input->options.scene;
    if (wanted > scenes.size())
        throw Failure{LS_MESSAGE_GLTF_SCENE, "has no scene " + std::to_string(wanted - 1) +
                                                 ", but " + std::to_string(scenes.size()) +
                                                 "; choose another"};
    if (wanted)
        return static_cast<int>(wanted - 1);
    if (scenes.empty())
        return -1;
    const int chosen = std::max(import.model.defaultScene, 0);
    gltf_find(scenes, chosen, "scene", "the file");
    for (size_t i = 0; i < scenes.size(); i++)
        if (i != static_cast<size_t>(chosen))
            ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_SCENES,
                         "of its " + std::to_string(scenes.size()) + " scenes only " +
                             gltf_describe("scene", static_cast<size_t>(chosen),
                                           scenes[static_cast<size_t>(chosen)].name) +
                             " is taken, not",
                         gltf_describe("scene", i, scenes[i].name),
                         "choose with --scene, or bake each into a file");
    return chosen;
}

GltfMatrix read_matrix(const std::vector<double>& numbers, const std::string& name)
{
    GltfMatrix matrix;
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 4; j++)
            matrix[i][j] = numbers[4 * j + i];
    if (numbers[3] != 0.0 || numbers[7] != 0.0 || numbers[11] != 0.0 || numbers[15] != 1.0)
        gltf_fail(LS_MESSAGE_GLTF_TRANSFORM, name + " has a matrix whose last row is not 0 0 0 1");
    return matrix;
}

// The members have their sizes, or are empty (gltf_members.cpp).
GltfMatrix read_transform(const tinygltf::Node& node, const std::string& name)
{
    if (!node.matrix.empty())
        return read_matrix(node.matrix, name);
    GltfMatrix matrix = GLTF_IDENTITY;
    if (!node.rotation.empty())
    {
        double q[4] = {node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]};
        double length;
        if (!gltf_normalize(q, length))
            gltf_fail(LS_MESSAGE_GLTF_TRANSFORM, name + " has a rotation of length zero");
        const double x = q[0], y = q[1], z = q[2], w = q[3];
        matrix = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
                   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
                   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}}};
    }
    if (!node.scale.empty())
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 3; j++)
                matrix[i][j] *= node.scale[j];
    if (!node.translation.empty())
        for (size_t i = 0; i < 3; i++)
            matrix[i][3] = node.translation[i];
    return matrix;
}

void add_parts(GltfImport& import, const tinygltf::Node& node, uint32_t number,
               const GltfMatrix& world_from_node, const std::string& name)
{
    if (node.mesh != -1)
    {
        gltf_find(import.model.meshes, node.mesh, "mesh", name);
        import.placements.push_back({static_cast<size_t>(node.mesh), number, world_from_node});
    }
    if (node.skin != -1)
    {
        const tinygltf::Skin& skin = gltf_find(import.model.skins, node.skin, "skin", name);
        ls_gltf_note(
            import, LS_MESSAGE_GLTF_WARN_SKIN, "skins are not supported",
            name + " with " + gltf_describe("skin", static_cast<size_t>(node.skin), skin.name),
            "such meshes stand as their nodes place them; apply the pose before exporting");
    }
    if (node.camera != -1)
    {
        gltf_find(import.model.cameras, node.camera, "camera", name);
        ls_gltf_add_camera(import, static_cast<size_t>(node.camera), world_from_node);
    }
    const auto lamp = node.extensions.find("KHR_lights_punctual");
    if (lamp != node.extensions.end() && lamp->second.Has("light"))
    {
        const int light = lamp->second.Get("light").GetNumberAsInt();
        gltf_find(import.model.lights, light, "light", name);
        ls_gltf_add_lamp(import, static_cast<size_t>(light), number, world_from_node);
    }
}

void walk_node(GltfImport& import, int index, uint32_t parent, const GltfMatrix& world_from_parent,
               unsigned level, const std::string& owner)
{
    const tinygltf::Node& node = gltf_find(import.model.nodes, index, "node", owner);
    const size_t place = static_cast<size_t>(index);
    const std::string name = gltf_describe("node", place, node.name);
    if (import.node_numbers[place] != LS_NONE)
        gltf_fail(LS_MESSAGE_GLTF_NODE_PARENTS, name + " has two parents, or is its own");
    if (level > LS_MAX_NODE_DEPTH)
        throw Failure{LS_MESSAGE_GLTF_NODE_DEPTH, name + " lies deeper than " +
                                                      std::to_string(LS_MAX_NODE_DEPTH) +
                                                      " levels; flatten the hierarchy"};

    const GltfMatrix parent_from_node = read_transform(node, name);
    const GltfMatrix world_from_node = gltf_multiply(world_from_parent, parent_from_node);
    const uint32_t number = import.input->node_count;
    import.node_numbers[place] = number;
    LsSceneNode* added = gltf_check_memory(ls_input_add_node(import.input));
    added->parent = parent;
    gltf_store_rows(parent_from_node, name, added->parent_from_node);
    LsVec4 rows[3]; // only to see that they can be
    gltf_store_rows(world_from_node, name, rows);

    add_parts(import, node, number, world_from_node, name);
    for (const int child : node.children)
        walk_node(import, child, number, world_from_node, level + 1, name);
}

} // namespace

void ls_gltf_read_nodes(GltfImport& import)
{
    const std::vector<tinygltf::Node>& nodes = import.model.nodes;
    ls_gltf_reserve(import, nodes.size() * (sizeof(LsSceneNode) + sizeof(LsInputInstance)), 0,
                    false);
    import.node_numbers.assign(nodes.size(), LS_NONE);
    const int scene = choose_scene(import);
    if (scene >= 0)
    {
        for (const int node : import.model.scenes[static_cast<size_t>(scene)].nodes)
            walk_node(import, node, LS_NONE, GLTF_IDENTITY, 1, "the scene");
        return;
    }
    // Without scenes every node that is nobody's child is shown.
    std::vector<bool> is_child(nodes.size(), false);
    for (const tinygltf::Node& node : nodes)
        for (const int child : node.children)
            if (child >= 0 && static_cast<size_t>(child) < is_child.size())
                is_child[static_cast<size_t>(child)] = true;
    for (size_t i = 0; i < nodes.size(); i++)
        if (!is_child[i])
            walk_node(import, static_cast<int>(i), LS_NONE, GLTF_IDENTITY, 1, "the file");
}
