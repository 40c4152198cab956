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
layout(constant_id = 8) const uint LS_HAS_SCENE_SHAFTS = 1;

// Lanes first do the quick part of all tests that wait, then the rest of those that are left,
// together. CPUs, where loading a triangle twice costs more than waiting, do not.
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

// Records are read through the macros from here on alone: LS_FIND_... declares what LS_FOUND then
// reads fields of. They may name an argument twice. As functions they cost the second pass 5 to 12
// % of its speed on an NVIDIA H100 although nothing is cut (docs/benchmarks.md, "Large input").
#ifdef LS_TEXELS
#include "texels.glsl"
#else

// The address of the segment that record `index` lies in, and the record's number there. Segments
// hold as many records as if one took 2^record_log2 bytes.
#define LS_SEGMENT(array, index, record_log2) \
    (LS_SEGMENT_LOG2 == 0u ? (array)          \
                           : LsAddressArray(array).at[(index) >> (LS_SEGMENT_LOG2 - record_log2)])
#define LS_IN_SEGMENT(index, record_log2)  \
    (LS_SEGMENT_LOG2 == 0u ? (index)       \
                           : (index) & ((1u << (LS_SEGMENT_LOG2 - record_log2)) - 1u))

#define LS_FIND_OBJECT(name, index) LsObjectArray name = LsObjectArray(ls_scene.objects)
#define LS_FIND_INSTANCE(name, index) LsInstanceArray name = LsInstanceArray(ls_scene.instances)
#define LS_FIND_TRIANGLE(name, index) \
    LsTriangleArray name = ls_find_triangle(ls_scene.triangles, index)
#define LS_FIND_TOP_NODES(name) LsBvhNodeArray name = LsBvhNodeArray(ls_scene.top_nodes)
#define LS_FOUND(name, index) name.at[index]
#define LS_LOAD_TOP_NODE(nodes, index) nodes.at[index]

#define LS_LOAD_WORD(array, index) \
    LsWordArray(LS_SEGMENT(ls_scene.array, index, 2u)).at[LS_IN_SEGMENT(index, 2u)]
#define LS_LOAD_VOXEL(index) \
    LsVoxelArray(LS_SEGMENT(ls_scene.voxels, index, 4u)).at[LS_IN_SEGMENT(index, 4u)]
#define LS_LOAD_LEAF_NODE(index) \
    LsBvhNodeArray(LS_SEGMENT(ls_scene.leaf_nodes, index, 5u)).at[LS_IN_SEGMENT(index, 5u)]
// The word of cell `cell` of a block.
#define LS_LOAD_CELL(block, cell)                              \
    LsWordArray(LS_SEGMENT(ls_scene.cell_blocks, block, 8u))   \
        .at[LS_IN_SEGMENT(block, 8u) * LS_BLOCK_CELLS + (cell)]

// The segment of triangle `index`, which becomes its number there. Of a triangle hardly anyone
// reads all.
LsTriangleArray ls_find_triangle(uvec2 array, inout uint index)
{
    LsTriangleArray segment = LsTriangleArray(LS_SEGMENT(array, index, 6u)); // 48 bytes each
    index = LS_IN_SEGMENT(index, 6u);
    return segment;
}

#endif

// The triangle's number in the input.
uint ls_load_primitive(uint index)
{
    LS_FIND_TRIANGLE(triangles, index);
    return LS_FOUND(triangles, index).primitive;
}

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer LsSceneReference
{
    LsDeviceScene scene;
};

#endif
