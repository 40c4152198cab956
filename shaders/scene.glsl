// scene.glsl - the scene's arrays on the device, and what of them this pipeline uses.
//
// The shader that includes it enables GL_EXT_buffer_reference and GL_EXT_buffer_reference_uvec2,
// and declares `ls_scene`, an LsTraceScene, before the include: as push constants, in a uniform
// block, or as a variable that it fills from LsSceneReference(address).scene.trace.

#ifndef LS_SCENE_GLSL
#define LS_SCENE_GLSL

#include "ls_layout.h"

// Specialization: the method, and the required features of the file in bit order. What a file does
// not use is compiled away.
layout(constant_id = 0) const uint LS_METHOD = LS_METHOD_EXACT;
layout(constant_id = 1) const uint LS_HAS_TOP_LEVEL = 1;
layout(constant_id = 2) const uint LS_HAS_LISTS = 1;
layout(constant_id = 3) const uint LS_HAS_GRIDS = 1;
layout(constant_id = 4) const uint LS_HAS_SUBGRIDS = 1;
layout(constant_id = 5) const uint LS_HAS_LEAF_BVHS = 1;
layout(constant_id = 6) const uint LS_HAS_MASKS = 1;
layout(constant_id = 7) const uint LS_HAS_EXACT_MASKS = 1;

// Lanes first do the quick part of all tests that wait, then the rest of those that are left, together. CPUs, where
// loading a triangle twice costs more than waiting, do not.
layout(constant_id = LS_CONSTANT_DEFERS) const uint LS_DEFERS = 1;

// Where an object's part of an array begins. A file without a top level has one object, whose parts
// begin at 0.
#define LS_FIRST(index) (LS_HAS_TOP_LEVEL != 0u ? (index) : 0u)

// 0: no array is cut; else the log2 of a segment's bytes.
layout(constant_id = LS_CONSTANT_SEGMENT_LOG2) const uint LS_SEGMENT_LOG2 = 0;

#define LS_ARRAY(name, type, alignment)                                                       \
    layout(buffer_reference, std430, buffer_reference_align = alignment) readonly buffer name \
    {                                                                                         \
        type at[];                                                                            \
    }

LS_ARRAY(LsObjectArray, LsObject, 16);
LS_ARRAY(LsInstanceArray, LsInstance, 16);
LS_ARRAY(LsBvhNodeArray, LsBvhNode, 16);
LS_ARRAY(LsMaterialArray, LsMaterial, 16);
LS_ARRAY(LsLightArray, LsLight, 16);
LS_ARRAY(LsTriangleArray, LsTriangle, 16);
LS_ARRAY(LsVoxelArray, LsVoxel, 16);
LS_ARRAY(LsWordArray, uint, 4);
LS_ARRAY(LsAddressArray, uvec2, 8);

// Records of the arrays that grow with triangles and cells: TRIANGLES, BLOCKS, CELL_BLOCKS, SUBGRIDS, VOXELS,
// REFERENCES, LEAF_NODES and SHAFTS are read through these alone. `array` is the address in LsTraceScene.

// Where record `index` of an array lies: the address of its segment, in which it is record `index` then. Segments
// hold as many records as if a record took 2^record_log2 bytes.
uvec2 ls_find_segment(uvec2 array, inout uint index, uint record_log2)
{
    if (LS_SEGMENT_LOG2 == 0u)
    {
        return array;
    }
    uint count_log2 = LS_SEGMENT_LOG2 - record_log2;
    uvec2 segment = LsAddressArray(array).at[index >> count_log2];
    index &= (1u << count_log2) - 1u;
    return segment;
}

LsTriangle ls_load_triangle(uvec2 array, uint index)
{
    uvec2 segment = ls_find_segment(array, index, 6u); // of 48 bytes
    return LsTriangleArray(segment).at[index];
}

LsVoxel ls_load_voxel(uvec2 array, uint index)
{
    uvec2 segment = ls_find_segment(array, index, 4u);
    return LsVoxelArray(segment).at[index];
}

LsBvhNode ls_load_node(uvec2 array, uint index)
{
    uvec2 segment = ls_find_segment(array, index, 5u);
    return LsBvhNodeArray(segment).at[index];
}

uint ls_load_cell(uvec2 array, uint block, uint cell)
{
    uvec2 segment = ls_find_segment(array, block, 8u);
    return LsWordArray(segment).at[block * LS_BLOCK_CELLS + cell];
}

uint ls_load_word(uvec2 array, uint index)
{
    uvec2 segment = ls_find_segment(array, index, 2u);
    return LsWordArray(segment).at[index];
}

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer LsSceneReference
{
    LsDeviceScene scene;
};

#endif
