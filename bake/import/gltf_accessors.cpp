// gltf_accessors.cpp - elements of accessors: their types, where they lie, sparse ones put in.

#include "gltf_import.h"

#include <algorithm>
#include <cstring>

namespace
{

// Bits of component types: 5120 + place.
constexpr unsigned I8 = 1u << 0, U8 = 1u << 1, I16 = 1u << 2, U16 = 1u << 3, U32 = 1u << 5,
                   F32 = 1u << 6;

// Elements without bytes in the file are zero: a small file must not ask for any number of them.
constexpr size_t MAX_ZEROS = size_t(1) << 24;

// What glTF 2.0 (section 3.7.2.1, and 3.11 for animation) allows for a use, and what
// KHR_mesh_quantization adds.
struct Legal
{
    const char* what;
    int type, other_type;
    unsigned plain, normalized;
    unsigned quantized_plain, quantized_normalized;
};

Legal find_legal(GltfUse use)
{
    constexpr int SCALAR = TINYGLTF_TYPE_SCALAR, VEC2 = TINYGLTF_TYPE_VEC2,
                  VEC3 = TINYGLTF_TYPE_VEC3, VEC4 = TINYGLTF_TYPE_VEC4;
    constexpr unsigned SMALL = I8 | U8 | I16 | U16;
    switch (use)
    {
    case GltfUse::POSITION:
        return {"positions", VEC3, VEC3, F32, 0, SMALL, SMALL};
    case GltfUse::NORMAL:
        return {"normals", VEC3, VEC3, F32, 0, 0, I8 | I16};
    case GltfUse::TEXCOORD:
        return {"texture coordinates", VEC2, VEC2, F32, U8 | U16, SMALL, SMALL};
    case GltfUse::COLOR:
        return {"colours", VEC3, VEC4, F32, U8 | U16, 0, 0};
    case GltfUse::INDICES:
        return {"indices", SCALAR, SCALAR, U8 | U16 | U32, 0, 0, 0};
    case GltfUse::TIMES:
        return {"key times", SCALAR, SCALAR, F32, 0, 0, 0};
    case GltfUse::VECTORS:
        return {"keys of a translation or scale", VEC3, VEC3, F32, 0, 0, 0};
    case GltfUse::ROTATIONS:
        return {"keys of a rotation", VEC4, VEC4, F32, SMALL, 0, 0};
    }
    return {"", 0, 0, 0, 0, 0, 0};
}

size_t find_component_bytes(int component)
{
    switch (component)
    {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    default:
        return 4;
    }
}

const char* describe_component(int component)
{
    static const char* const names[] = {
        "signed bytes",           "unsigned bytes",           "signed shorts", "unsigned shorts",
        "signed 32 bit integers", "unsigned 32 bit integers", "floats"};
    const int place = component - TINYGLTF_COMPONENT_TYPE_BYTE;
    return place >= 0 && place < 7 ? names[place] : "of an unknown component type";
}

const char* describe_type(int type)
{
    switch (type)
    {
    case TINYGLTF_TYPE_SCALAR:
        return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
        return "VEC2";
    case TINYGLTF_TYPE_VEC3:
        return "VEC3";
    case TINYGLTF_TYPE_VEC4:
        return "VEC4";
    default:
        return "a matrix";
    }
}

void check_type(const GltfImport& import, const tinygltf::Accessor& accessor, GltfUse use,
                const std::string& name)
{
    const Legal legal = find_legal(use);
    const int place = accessor.componentType - TINYGLTF_COMPONENT_TYPE_BYTE;
    const unsigned bit = place >= 0 && place < 7 ? 1u << place : 0;
    const unsigned core = accessor.normalized ? legal.normalized : legal.plain;
    const unsigned quantized =
        accessor.normalized ? legal.quantized_normalized : legal.quantized_plain;
    const bool is_type = accessor.type == legal.type || accessor.type == legal.other_type;
    // `normalized` says nothing about floats; files set it.
    const bool is_float = bit == F32 && (legal.plain & F32);
    if (is_type && (is_float || (bit & (core | (import.is_quantized ? quantized : 0)))))
        return;
    const bool is_quantized = is_type && (bit & quantized);
    gltf_fail(LS_MESSAGE_GLTF_ACCESSOR_TYPE,
              name + " has " + legal.what +
                  " of a type that is not legal: " + describe_type(accessor.type) + " of " +
                  (accessor.normalized ? "normalized " : "") +
                  describe_component(accessor.componentType) +
                  (is_quantized ? ", without KHR_mesh_quantization" : ""));
}

// How far it is from the first byte of an array to behind its last one, or more than any buffer has.
size_t find_span(size_t count, size_t stride, size_t element_bytes)
{
    if (count == 0)
        return 0;
    const size_t most = std::numeric_limits<size_t>::max();
    return (most - element_bytes) / stride < count - 1 ? most
                                                       : (count - 1) * stride + element_bytes;
}

void find_sparse(const GltfImport& import, const tinygltf::Accessor& accessor,
                 const std::string& name, GltfElements& elements)
{
    const int component = accessor.sparse.indices.componentType;
    if (component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        component != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        gltf_fail(LS_MESSAGE_GLTF_ACCESSOR_TYPE,
                  name + " has sparse indices that are no unsigned integers, but " +
                      describe_component(component));
    const size_t count = static_cast<size_t>(accessor.sparse.count);
    if (count > elements.count)
        gltf_fail(LS_MESSAGE_GLTF_ACCESSOR, name + " replaces " + std::to_string(count) +
                                                " of its " + std::to_string(elements.count) +
                                                " elements");
    elements.sparse_count = count;
    elements.sparse_component = component;
    const size_t element_bytes = find_component_bytes(elements.component) * elements.width;
    elements.sparse_indices = ls_gltf_find_bytes(
        import, accessor.sparse.indices.bufferView,
        static_cast<size_t>(accessor.sparse.indices.byteOffset),
        find_span(count, find_component_bytes(component), find_component_bytes(component)),
        name + ", its sparse indices,");
    elements.sparse_values = ls_gltf_find_bytes(
        import, accessor.sparse.values.bufferView,
        static_cast<size_t>(accessor.sparse.values.byteOffset),
        find_span(count, element_bytes, element_bytes), name + ", its sparse values,");
}

uint32_t read_unsigned(const unsigned char* bytes, int component)
{
    uint16_t narrow;
    uint32_t wide;
    switch (component)
    {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return *bytes;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        std::memcpy(&narrow, bytes, sizeof narrow);
        return narrow;
    default:
        std::memcpy(&wide, bytes, sizeof wide);
        return wide;
    }
}

// glTF 2.0, section 3.6.2.2: the two smallest signed values mean the same.
float read_number(const unsigned char* bytes, int component, bool is_normalized)
{
    int8_t byte;
    int16_t narrow;
    uint16_t narrow_unsigned;
    float number;
    switch (component)
    {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        std::memcpy(&byte, bytes, sizeof byte);
        return is_normalized ? std::max(static_cast<float>(byte) / 127.0f, -1.0f)
                             : static_cast<float>(byte);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return is_normalized ? static_cast<float>(*bytes) / 255.0f : static_cast<float>(*bytes);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        std::memcpy(&narrow, bytes, sizeof narrow);
        return is_normalized ? std::max(static_cast<float>(narrow) / 32767.0f, -1.0f)
                             : static_cast<float>(narrow);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        std::memcpy(&narrow_unsigned, bytes, sizeof narrow_unsigned);
        return is_normalized ? static_cast<float>(narrow_unsigned) / 65535.0f
                             : static_cast<float>(narrow_unsigned);
    default:
        std::memcpy(&number, bytes, sizeof number);
        return number;
    }
}

// Calls `put(element, bytes)` for all elements, then for those that are replaced.
template <class Put>
void visit(const GltfElements& elements, const std::string& owner, const Put& put)
{
    const size_t component_bytes = find_component_bytes(elements.component);
    if (elements.bytes)
        for (size_t i = 0; i < elements.count; i++)
            put(i, elements.bytes + i * elements.stride);
    const size_t index_bytes = find_component_bytes(elements.sparse_component);
    size_t next = 0; // the least that is legal: they rise
    for (size_t i = 0; i < elements.sparse_count; i++)
    {
        const size_t index =
            read_unsigned(elements.sparse_indices + i * index_bytes, elements.sparse_component);
        if (index < next)
            gltf_fail(LS_MESSAGE_GLTF_ACCESSOR,
                      owner + " has sparse indices that do not rise at " + std::to_string(i));
        if (index >= elements.count)
            gltf_fail(LS_MESSAGE_GLTF_VERTEX_INDEX,
                      owner + " has the sparse index " + std::to_string(index) + ", but " +
                          std::to_string(elements.count) + " elements");
        put(index, elements.sparse_values + i * elements.width * component_bytes);
        next = index + 1;
    }
}

} // namespace

void ls_gltf_find_elements(const GltfImport& import, int index, GltfUse use,
                           const std::string& owner, GltfElements& elements)
{
    const tinygltf::Accessor& accessor =
        gltf_find(import.model.accessors, index, "accessor", owner);
    const std::string name =
        owner + ", " + gltf_describe("accessor", static_cast<size_t>(index), accessor.name);
    check_type(import, accessor, use, name);
    if (accessor.count >= LS_NONE)
        throw Failure{LS_MESSAGE_GLTF_COUNT, name + " has " + std::to_string(accessor.count) +
                                                 " elements, more than 4294967294; split it"};
    if (accessor.bufferView == -1 && accessor.count > MAX_ZEROS)
        throw Failure{LS_MESSAGE_GLTF_COUNT, name + " has " + std::to_string(accessor.count) +
                                                 " elements, but no buffer view for them; no more "
                                                 "than " +
                                                 std::to_string(MAX_ZEROS) + " may be zero"};
    elements = {};
    elements.count = accessor.count;
    elements.component = accessor.componentType;
    elements.is_normalized =
        accessor.normalized && accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT;
    elements.width =
        accessor.type == TINYGLTF_TYPE_SCALAR ? 1 : static_cast<unsigned>(accessor.type);

    const size_t element_bytes = find_component_bytes(elements.component) * elements.width;
    if (accessor.bufferView != -1)
    {
        const tinygltf::BufferView& view =
            gltf_find(import.model.bufferViews, accessor.bufferView, "buffer view", name);
        elements.stride = view.byteStride ? view.byteStride : element_bytes;
        if (elements.stride < element_bytes)
            gltf_fail(LS_MESSAGE_GLTF_ACCESSOR,
                      name + " has elements of " + std::to_string(element_bytes) +
                          " bytes at a stride of " + std::to_string(elements.stride));
        elements.bytes =
            ls_gltf_find_bytes(import, accessor.bufferView, accessor.byteOffset,
                               find_span(elements.count, elements.stride, element_bytes), name);
    }
    if (accessor.sparse.isSparse)
        find_sparse(import, accessor, name, elements);
}

void ls_gltf_read_numbers(const GltfElements& elements, const std::string& owner, float* numbers)
{
    const size_t component_bytes = find_component_bytes(elements.component);
    std::fill(numbers, numbers + (elements.bytes ? 0 : elements.count * elements.width), 0.0f);
    visit(elements, owner,
          [&](size_t element, const unsigned char* bytes)
          {
              for (unsigned k = 0; k < elements.width; k++)
                  numbers[element * elements.width + k] = read_number(
                      bytes + k * component_bytes, elements.component, elements.is_normalized);
          });
}

void ls_gltf_read_indices(const GltfElements& elements, const std::string& owner, uint32_t* indices)
{
    std::fill(indices, indices + (elements.bytes ? 0 : elements.count), 0u);
    visit(elements, owner,
          [&](size_t element, const unsigned char* bytes)
          { indices[element] = read_unsigned(bytes, elements.component); });
}
