// gltf_cameras.cpp - cameras and lamps (KHR_lights_punctual), placed in the world by their nodes.
//
// Both ignore the scale of their node, as glTF asks. The numbers of lamps are taken as they are:
// glTF measures them (candela, lux) and emissive factors (candela per square metre) by the eye, so
// lamps and emissive surfaces of one file keep their proportion.

#include "gltf_import.h"

namespace
{

// The node's axes at unit length.
GltfMatrix remove_scale(const GltfMatrix& world_from_node, const std::string& owner)
{
    GltfMatrix matrix = world_from_node;
    for (size_t j = 0; j < 3; j++)
    {
        const double length = gltf_find_column_length(matrix, j);
        if (!(length > 0.0 && length < std::numeric_limits<double>::infinity()))
            gltf_fail(LS_MESSAGE_GLTF_TRANSFORM,
                      owner + " stands in a node that is scaled to nothing, or beyond all numbers");
        for (size_t i = 0; i < 3; i++)
            matrix[i][j] /= length;
    }
    return matrix;
}

void set_cone(const tinygltf::Light& light, const std::string& name, LsLamp& lamp)
{
    const double inner = light.spot.innerConeAngle, outer = light.spot.outerConeAngle;
    if (!(inner >= 0.0 && inner < outer && outer <= 0.5 * GLTF_PI + 1e-6))
        gltf_fail(LS_MESSAGE_GLTF_MEMBER, name + " has cone angles that are not 0 <= inner < outer "
                                                 "<= pi/2");
    lamp.cos_inner = static_cast<float>(gltf_find_sine_cosine(inner).cosine);
    lamp.cos_outer = static_cast<float>(gltf_find_sine_cosine(outer).cosine);
}

} // namespace

void ls_gltf_add_camera(GltfImport& import, size_t index, const GltfMatrix& world_from_node)
{
    const tinygltf::Camera& camera = import.model.cameras[index];
    const std::string name = gltf_describe("camera", index, camera.name);
    if (camera.type != "perspective")
    {
        ls_gltf_note(import, LS_MESSAGE_GLTF_WARN_CAMERA,
                     "cameras that are not perspective are not supported", name,
                     "they will be missing");
        return;
    }
    const double yfov = camera.perspective.yfov;
    if (!(yfov > 0.0 && yfov < 3.14159) || !(camera.perspective.aspectRatio >= 0.0))
        gltf_fail(LS_MESSAGE_GLTF_MEMBER,
                  name + " has a field of view outside 0 to pi, or a negative aspect ratio");
    const double tan_half_y = gltf_find_tangent(0.5 * yfov);
    const GltfMatrix matrix = remove_scale(world_from_node, name);
    LsCamera* added = gltf_check_memory(ls_input_add_camera(import.input));
    gltf_store_rows(matrix, name, added->world_from_camera);
    added->tan_half_y = gltf_narrow(tan_half_y, name);
    added->aspect = gltf_narrow(camera.perspective.aspectRatio, name);
    if (!(added->tan_half_y > 0.0f))
        gltf_fail(LS_MESSAGE_GLTF_RANGE, name + " has a field of view too narrow for float");
}

void ls_gltf_add_lamp(GltfImport& import, size_t index, uint32_t node,
                      const GltfMatrix& world_from_node)
{
    const tinygltf::Light& light = import.model.lights[index];
    const std::string name = gltf_describe("light", index, light.name);
    const bool is_spot = light.type == "spot", is_directional = light.type == "directional";
    if (!is_spot && !is_directional && light.type != "point")
        gltf_fail(LS_MESSAGE_GLTF_MEMBER,
                  name + " has the unknown type \"" + gltf_quote(light.type) + "\"");
    const std::vector<double> color =
        light.color.empty() ? std::vector<double>(3, 1.0) : light.color;
    if (!(light.intensity >= 0.0 && color[0] >= 0.0 && color[1] >= 0.0 && color[2] >= 0.0 &&
          light.range >= 0.0))
        gltf_fail(LS_MESSAGE_GLTF_MEMBER, name + " has a negative intensity, colour or range");

    LsLamp lamp = {};
    lamp.kind = is_spot ? LS_LAMP_SPOT : is_directional ? LS_LAMP_DIRECTIONAL : LS_LAMP_POINT;
    lamp.node = node;
    lamp.intensity = {gltf_narrow(color[0] * light.intensity, name),
                      gltf_narrow(color[1] * light.intensity, name),
                      gltf_narrow(color[2] * light.intensity, name)};
    lamp.direction = {0.0f, 0.0f, -1.0f};
    lamp.cos_inner = 1.0f;
    lamp.cos_outer = -1.0f;
    if (!is_directional)
    {
        lamp.range = gltf_narrow(light.range, name);
        lamp.position = {gltf_narrow(world_from_node[0][3], name),
                         gltf_narrow(world_from_node[1][3], name),
                         gltf_narrow(world_from_node[2][3], name)};
    }
    if (is_spot || is_directional)
    {
        const GltfMatrix axes = remove_scale(world_from_node, name);
        lamp.direction = {static_cast<float>(-axes[0][2]), static_cast<float>(-axes[1][2]),
                          static_cast<float>(-axes[2][2])};
    }
    if (is_spot)
        set_cone(light, name, lamp);
    *gltf_check_memory(ls_input_add_lamp(import.input)) = lamp;
}
