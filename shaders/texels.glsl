// texels.glsl - the scene's arrays as texel buffers, for kernels compiled with LS_TEXELS.
//
// llvmpipe (Mesa 22.3) loads each word of a buffer lane by lane, with a branch for each; texels it
// gathers for all lanes at once. Binding i of set 0 is array i of LsTraceScene (runtime/texels.h),
// of one segment. Fields that nobody reads are not fetched.

#ifndef LS_TEXELS_GLSL
#define LS_TEXELS_GLSL

layout(set = 0, binding = 0) uniform utextureBuffer ls_texels_objects;
layout(set = 0, binding = 1) uniform utextureBuffer ls_texels_instances;
layout(set = 0, binding = 2) uniform utextureBuffer ls_texels_top_nodes;
layout(set = 0, binding = 3) uniform utextureBuffer ls_texels_triangles;
layout(set = 0, binding = 4) uniform utextureBuffer ls_texels_blocks;      // words, as all
layout(set = 0, binding = 5) uniform utextureBuffer ls_texels_cell_blocks; // that are words
layout(set = 0, binding = 6) uniform utextureBuffer ls_texels_subgrids;
layout(set = 0, binding = 7) uniform utextureBuffer ls_texels_voxels;
layout(set = 0, binding = 8) uniform utextureBuffer ls_texels_references;
layout(set = 0, binding = 9) uniform utextureBuffer ls_texels_leaf_nodes;
layout(set = 0, binding = 10) uniform utextureBuffer ls_texels_shafts;

#define LS_TEXEL(array, index) texelFetch(ls_texels_##array, int(index))

LsObject ls_fetch_object(uint index)
{
    uvec4 a = LS_TEXEL(objects, 9u * index);
    uvec4 b = LS_TEXEL(objects, 9u * index + 1u);
    uvec4 c = LS_TEXEL(objects, 9u * index + 2u);
    uvec4 d = LS_TEXEL(objects, 9u * index + 3u);
    uvec4 e = LS_TEXEL(objects, 9u * index + 4u);
    uvec4 f = LS_TEXEL(objects, 9u * index + 5u);
    uvec4 g = LS_TEXEL(objects, 9u * index + 6u);
    uvec4 h = LS_TEXEL(objects, 9u * index + 7u);
    uvec4 i = LS_TEXEL(objects, 9u * index + 8u);
    return LsObject(uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), uintBitsToFloat(b.w),
                    uintBitsToFloat(c.xyz), uintBitsToFloat(c.w), uint[3](d.x, d.y, d.z),
                    uintBitsToFloat(d.w), e.x, e.y, e.z, e.w, f.x, f.y, f.z, f.w, g.x, g.y, g.z,
                    g.w, h.x, h.y, h.z, h.w, i.x, i.y, i.z, i.w);
}

LsInstance ls_fetch_instance(uint index)
{
    vec4 a = uintBitsToFloat(LS_TEXEL(instances, 8u * index));
    vec4 b = uintBitsToFloat(LS_TEXEL(instances, 8u * index + 1u));
    vec4 c = uintBitsToFloat(LS_TEXEL(instances, 8u * index + 2u));
    vec4 d = uintBitsToFloat(LS_TEXEL(instances, 8u * index + 3u));
    vec4 e = uintBitsToFloat(LS_TEXEL(instances, 8u * index + 4u));
    vec4 f = uintBitsToFloat(LS_TEXEL(instances, 8u * index + 5u));
    uvec4 g = LS_TEXEL(instances, 8u * index + 6u);
    return LsInstance(vec4[3](a, b, c), vec4[3](d, e, f), g.x, g.y, g.z, g.w,
                      uint[4](0u, 0u, 0u, 0u));
}

LsTriangle ls_fetch_triangle(uint index)
{
    uvec4 a = LS_TEXEL(triangles, 3u * index);
    uvec4 b = LS_TEXEL(triangles, 3u * index + 1u);
    uvec4 c = LS_TEXEL(triangles, 3u * index + 2u);
    return LsTriangle(uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), b.w,
                      uintBitsToFloat(c.xyz), c.w);
}

LsBvhNode ls_make_node(uvec4 a, uvec4 b)
{
    return LsBvhNode(uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), b.w);
}

#define LS_FIND_TOP_NODES(name)
#define LS_LOAD_TOP_NODE(nodes, index) \
    ls_make_node(LS_TEXEL(top_nodes, 2u * (index)), LS_TEXEL(top_nodes, 2u * (index) + 1u))

LsVoxel ls_fetch_voxel(uint index)
{
    uvec4 t = LS_TEXEL(voxels, index);
    return LsVoxel(t.x, t.y, t.z, t.w);
}

#define LS_FIND_OBJECT(name, index) LsObject name = ls_fetch_object(index)
#define LS_FIND_INSTANCE(name, index) LsInstance name = ls_fetch_instance(index)
#define LS_FIND_TRIANGLE(name, index) LsTriangle name = ls_fetch_triangle(index)
#define LS_FOUND(name, index) name

#define LS_LOAD_WORD(array, index) LS_TEXEL(array, index).x
#define LS_LOAD_VOXEL(index) ls_fetch_voxel(index)
#define LS_LOAD_LEAF_NODE(index) \
    ls_make_node(LS_TEXEL(leaf_nodes, 2u * (index)), LS_TEXEL(leaf_nodes, 2u * (index) + 1u))
#define LS_LOAD_CELL(block, cell) LS_TEXEL(cell_blocks, (block)*LS_BLOCK_CELLS + (cell)).x

#endif
