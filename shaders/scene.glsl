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

// Records of the arrays that grow with triangles and cells: TRIANGLES, BLOCKS, CELL_BLOCKS, SUBGRIDS, VOXELS,
// REFERENCES, LEAF_NODES and SHAFTS are read through these alone. `array` is the address in LsTraceScene.
LsTriangle ls_load_triangle(uvec2 array, uint index)
{
    return LsTriangleArray(array).at[index];
}

LsVoxel ls_load_voxel(uvec2 array, uint index)
{
    return LsVoxelArray(array).at[index];
}

LsBvhNode ls_load_node(uvec2 array, uint index)
{
    return LsBvhNodeArray(array).at[index];
}

uint ls_load_cell(uvec2 array, uint block, uint cell)
{
    return LsWordArray(array).at[block * LS_BLOCK_CELLS + cell];
}

uint ls_load_word(uvec2 array, uint index)
{
    return LsWordArray(array).at[index];
}

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer LsSceneReference
{
    LsDeviceScene scene;
};

#endif
