// ls_layout.h - every struct whose bytes are shared, once for C17, C++17 and GLSL.
//
// Part 1 is stored in .lspace files (format/SPEC.md is the norm; a change here is a change of the
// format). Part 2 is passed to shaders at run time and never stored. All structs follow std430: an
// LsVec3 stands at a multiple of 16 and the word after it fills its hole, so there is no padding.
//
// Spaces: "world" is the space of the scene; "object" that of one mesh as its file gave it; "grid"
// is object space moved and scaled so that a cell is 1 wide and the grid begins at (0,0,0): p_grid
// = (p_object - grid_lower) * inverse_cell.

#ifndef LS_LAYOUT_H
#define LS_LAYOUT_H

#ifdef VULKAN // GLSL: glslang defines VULKAN for Vulkan targets
#define LS_STRUCT(name) struct name
#define LS_SIZE(name, bytes)
#define LsVec3 vec3
#define LsVec4 vec4
#define uint32_t uint
#define LsAddress uvec2
#else
#include <assert.h>
#include <stdint.h>
#define LS_STRUCT(name)       \
    typedef struct name name; \
    struct name
#define LS_SIZE(name, bytes) static_assert(sizeof(name) == (bytes), #name " has another size")
typedef struct LsVec3
{
    float x, y, z;
} LsVec3;
typedef struct LsVec4
{
    float x, y, z, w;
} LsVec4;
typedef uint64_t LsAddress; // a buffer device address; low word first, as uvec2
#endif

// ---- Part 1: stored ---------------------------------------------------------------------------

// Cells come in blocks of LS_BLOCK_SIDE^3, both in the grid of an object and in sub-grids.
#define LS_BLOCK_SIDE 4
#define LS_BLOCK_CELLS 64

// A voxel of more triangles than this is subdivided, or a BVH leaf; a mask has at most this many
// bits.
#define LS_MASK_TRIANGLES 32
// A voxel of no more triangles than this has no masks: testing is cheaper than looking up.
#define LS_DIRECT_TRIANGLES 3
// An object of no more triangles than this has no grid, only its list.
#define LS_LIST_TRIANGLES 32

#define LS_MAX_PATCHES 16
#define LS_MAX_DEPTH 8
#define LS_MAX_CELLS 4096    // cells along one axis of a grid
#define LS_MAX_NODE_DEPTH 64 // levels of the scene's node hierarchy
#define LS_NONE 0xFFFFFFFFu

#define LS_OBJECT_LIST 0u // all triangles are tested
#define LS_OBJECT_GRID 1u

#define LS_VOXEL_LIST 0u    // no table: every triangle of the voxel is tested
#define LS_VOXEL_MASKS 1u   // a shaft table of masks over the voxel's triangles
#define LS_VOXEL_SUBGRID 2u // a block of 4^3 smaller cells
#define LS_VOXEL_BVH 3u     // a small BVH over the voxel's triangles

// Three corners in object space, in the winding of the input.
LS_STRUCT(LsTriangle)
{
    LsVec3 v0;
    uint32_t primitive; // number of the triangle in the object's input, dropped ones counted
    LsVec3 v1;
    uint32_t material; // index into MATERIALS
    LsVec3 v2;
    uint32_t reserved; // 0
};
LS_SIZE(LsTriangle, 48);

// A filled voxel. All first_* and table indices are relative to the object's part of their chunk.
LS_STRUCT(LsVoxel)
{
    uint32_t first_reference;
    uint32_t reference_count; // >= 1, or 0 for LS_VOXEL_SUBGRID
    uint32_t shape; // bits 0..7 kind; for masks 8..15 patches N, 16..23 log2 of bits per shaft
    uint32_t table; // masks: first word; sub-grid: cell block; BVH: first leaf node; list: 0
};
LS_SIZE(LsVoxel, 16);

// 4^3 cells, x fastest, then y, then z. See SPEC 5.3 for a cell word.
LS_STRUCT(LsCellBlock)
{
    uint32_t cells[LS_BLOCK_CELLS];
};
LS_SIZE(LsCellBlock, 256);

// A node of a BVH laid out depth first. After a miss, or after a leaf, traversal goes on at
// `escape` (after a hit inner node at the next node); it ends when the index reaches the node
// count.
LS_STRUCT(LsBvhNode)
{
    LsVec3 lower;    // world space in the top level; grid space in a voxel's BVH
    uint32_t escape; // relative to the BVH's first node; greater than the node's own index
    LsVec3 upper;
    uint32_t leaf; // 0: inner node; otherwise first << 4 | count, count 1..15
};
LS_SIZE(LsBvhNode, 32);

// A mesh with its own Line Space.
LS_STRUCT(LsObject)
{
    LsVec3 lower; // object space; the box [lower, upper] holds every triangle
    uint32_t kind;
    LsVec3 upper;
    float reach;        // object units: origins farther outside the box are moved (SPEC 7.2)
    LsVec3 grid_lower;  // object space: where the grid begins
    float inverse_cell; // cells per object unit
    uint32_t cells[3];  // size of the grid in cells, 1..LS_MAX_CELLS each
    float bound;        // e, in cells: the float bound of SPEC 7.5
    uint32_t first_triangle;
    uint32_t triangle_count;
    uint32_t first_block; // ceil(cells/4) words per axis follow, x fastest
    uint32_t block_count;
    uint32_t first_cell_block;
    uint32_t cell_block_count; // blocks of the grid first, then those of sub-grids
    uint32_t first_subgrid;    // one word per sub-grid: the cell block of its parent voxel
    uint32_t subgrid_count;
    uint32_t first_voxel;
    uint32_t voxel_count;
    uint32_t first_reference;
    uint32_t reference_count;
    uint32_t first_leaf_node;
    uint32_t leaf_node_count;
    uint32_t first_shaft_word;
    uint32_t shaft_word_count;
    uint32_t face_count; // triangles of the input, dropped ones counted: primitive < face_count
    uint32_t depth;      // deepest sub-grid level, 0 without sub-grids
    uint32_t patches;    // the N asked for; each voxel stores its own
    uint32_t reserved;   // 0
};
LS_SIZE(LsObject, 144);

// An object placed in the world. Rows of 3x4 matrices: p_object = rows * (p_world, 1).
LS_STRUCT(LsInstance)
{
    LsVec4 object_from_world[3]; // what rays are carried by: the normative transform
    LsVec4 world_from_object[3]; // for positions and normals to shade with
    uint32_t object;
    uint32_t node;  // index into NODES, or LS_NONE
    uint32_t mask;  // 8 bits; a ray whose mask shares none of them does not see the instance
    uint32_t flags; // LS_INSTANCE_*
    uint32_t reserved[4];
};
LS_SIZE(LsInstance, 128);

#define LS_INSTANCE_MIRRORED 1u // the transform turns the winding round
#define LS_INSTANCE_IDENTITY 2u

// The node hierarchy as the input gave it, parents before children. Kept for tools and later
// animation.
LS_STRUCT(LsSceneNode)
{
    LsVec4 parent_from_node[3];
    uint32_t parent; // smaller than the node's own index, or LS_NONE
    uint32_t reserved[3];
};
LS_SIZE(LsSceneNode, 64);

LS_STRUCT(LsMaterial)
{
    LsVec3 base_color; // linear; diffuse albedo in [0,1]
    uint32_t flags;    // LS_MATERIAL_*
    LsVec3 emission;   // linear radiance, W/(sr m^2) or any unit of the scene
    uint32_t reserved0;
    float metallic;
    float roughness;
    uint32_t reserved1[2];
};
LS_SIZE(LsMaterial, 48);

#define LS_MATERIAL_EMISSIVE 1u
#define LS_MATERIAL_DOUBLE_SIDED 2u

// An emissive triangle of an instance. Sampling picks light i where the running sum of the
// selection probabilities, proportional to area times luminance, passes a uniform number.
LS_STRUCT(LsLight)
{
    uint32_t instance;
    uint32_t triangle; // index into the object's part of TRIANGLES
    float area;        // world units squared
    float cumulative;  // sum of probabilities up to and including this light; the last is 1
};
LS_SIZE(LsLight, 16);

LS_STRUCT(LsCamera)
{
    LsVec4 world_from_camera[3]; // the camera looks along its own -z, y up
    float tan_half_y;            // tangent of half the vertical field of view
    float aspect;                // width / height, or 0 when the input leaves it open
    uint32_t reserved[2];
};
LS_SIZE(LsCamera, 64);

// ---- Part 2: per dispatch, never stored ---------------------------------------------------------

// One ray of the batch call and of ray files; SPEC 7.1 says which are legal.
LS_STRUCT(LsRay)
{
    LsVec3 origin; // world
    float tmin;    // in units of `direction`
    LsVec3 direction;
    float tmax;
};
LS_SIZE(LsRay, 32);

// One hit of the batch call and of hit files. A miss: t = -1, u = v = 0, the four indices LS_NONE.
LS_STRUCT(LsHit)
{
    float t; // in units of the ray's direction; 0 for any-hit rays that hit
    float u; // weight of the second corner
    float v; // weight of the third corner
    uint32_t instance;
    uint32_t object;
    uint32_t primitive;
    uint32_t material;
    uint32_t flags; // 0, or LS_HIT_CUT
};
LS_SIZE(LsHit, 32);

// The device ended a loop of the trace before its time, so the answer is not to be trusted:
// llvmpipe (Mesa 22.3) does so after 65535 rounds of all loops of a ray. lstrace reports it.
#define LS_HIT_CUT 1u

// Where the arrays lie that tracing reads. An absent array has address 0 and is never read. Small
// enough to travel as push constants beside a kernel's own.
LS_STRUCT(LsTraceScene)
{
    LsAddress objects;
    LsAddress instances;
    LsAddress top_nodes;
    LsAddress triangles;
    LsAddress blocks;
    LsAddress cell_blocks;
    LsAddress subgrids;
    LsAddress voxels;
    LsAddress references;
    LsAddress leaf_nodes;
    LsAddress shafts;
    uint32_t instance_count;
    float transform_bound; // growth of top level boxes per unit of the largest origin coordinate
};
LS_SIZE(LsTraceScene, 96);

// A scene with what shading reads as well; lies in device memory.
LS_STRUCT(LsDeviceScene)
{
    LsTraceScene trace;
    LsAddress materials;
    LsAddress lights;
    uint32_t light_count;
    uint32_t reserved; // 0
};
LS_SIZE(LsDeviceScene, 120);

#define LS_RAY_FLAG_ANY_HIT 1u          // the first hit found ends the ray
#define LS_RAY_FLAG_CULL_BACK_FACING 2u // after VK_KHR_ray_tracing: counter-clockwise is the front
#define LS_RAY_FLAG_CULL_FRONT_FACING 4u

// Push constants of the batch kernel: all of the 128 bytes that every device has.
LS_STRUCT(LsTraceParams)
{
    LsTraceScene scene;
    LsAddress rays;  // LsRay[ray_count]
    LsAddress hits;  // LsHit[ray_count]
    LsAddress masks; // uint[ray_count], or 0: all rays see all instances
    uint32_t ray_count;
    uint32_t flags; // LS_RAY_FLAG_*
};
LS_SIZE(LsTraceParams, 128);

#define LS_METHOD_EXACT 0u // through the Line Space
#define LS_METHOD_BRUTE 1u // every triangle, same test: the yardstick of exactness

// Triangles that brute force tests in a round of its loop.
#define LS_BRUTE_ROUND 8u

#endif
