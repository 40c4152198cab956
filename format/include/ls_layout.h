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
#define LS_MAX_SCENE_PATCHES 32   // M of an object's scene shafts
#define LS_SIGNATURE_INTERVALS 32 // bits of a scene shaft's word
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
    uint32_t shape; // bits 0..7 kind; for masks 8..15 patches N, 16..23 width of a mask: log2 of
                    // its bits, or 0: reference_count bits
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
    uint32_t first_shaft_word; // scene shafts first, then the tables of voxels
    uint32_t shaft_word_count;
    uint32_t face_count; // triangles of the input, dropped ones counted: primitive < face_count
    uint32_t depth;      // deepest sub-grid level, 0 without sub-grids
    uint32_t patches;    // the N asked for; each voxel stores its own
    // M: the faces of the grid's box are cut into M x M patches, and the part of SHAFTS begins with
    // a word for each shaft between two of them, whose bits say which parts of its way may be
    // filled; 0: it does not.
    uint32_t scene_patches;
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
    uint32_t surface;   // 1 + index into SURFACES, or 0: there is no more to this material
    uint32_t reserved1; // 0
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

// ---- How surfaces look, optional -------------------------------------------------------------------

// What a material has beyond LsMaterial: transmission, holes, textures. After glTF 2.0 and its
// KHR_materials_transmission, _ior; a material that has none of it has no record.
LS_STRUCT(LsSurface)
{
    float transmission; // [0,1]: share of what is not reflected that goes through
    float ior;          // index of refraction, >= 1, or 0 for an infinite one (KHR_materials_ior)
    float alpha;        // [0,1]: factor of the base colour's alpha
    float alpha_cutoff; // >= 0; with LS_SURFACE_MASK, points of less alpha are holes
    float normal_scale; // of the normal texture's x and y
    uint32_t flags;     // LS_SURFACE_*
    uint32_t base_color_texture;         // this and the next: index into TEXTURES, or LS_NONE
    uint32_t metallic_roughness_texture; // roughness in green, metallic in blue
    uint32_t normal_texture;             // tangent space, +y up
    uint32_t emissive_texture;
    uint32_t transmission_texture; // in red
    uint32_t reserved;             // 0
};
LS_SIZE(LsSurface, 48);

#define LS_SURFACE_MASK 1u // alphaMode MASK

// A use of an image: which texture coordinates, how they are moved, how texels are read.
LS_STRUCT(LsTexture)
{
    LsVec4 row_u; // u' = row_u.x * u + row_u.y * v + row_u.z; w is 0 (KHR_texture_transform)
    LsVec4 row_v;
    uint32_t image;    // index into IMAGES
    uint32_t texcoord; // 0 or 1: which set of the object's texture coordinates
    uint32_t flags;    // LS_TEXTURE_*
    uint32_t reserved; // 0
};
LS_SIZE(LsTexture, 48);

#define LS_TEXTURE_SRGB 1u // colours are stored by the sRGB transfer function; alpha is linear
#define LS_TEXTURE_CLAMP_U 2u
#define LS_TEXTURE_CLAMP_V 4u
#define LS_TEXTURE_MIRROR_U 8u // without clamp or mirror the texture repeats
#define LS_TEXTURE_MIRROR_V 16u
#define LS_TEXTURE_NEAREST 32u // else bilinear

#define LS_MAX_IMAGE_SIDE 16384

// Pixels of an image: row by row from the top, v = 0 at the top, as glTF has it.
LS_STRUCT(LsImage)
{
    uint32_t width; // 1..LS_MAX_IMAGE_SIDE
    uint32_t height;
    uint32_t first_pixel; // index into PIXELS: red in bits 0..7, green, blue, alpha
    uint32_t reserved;    // 0
};
LS_SIZE(LsImage, 16);

// Where an object's attributes begin: three records a triangle, in the order of TRIANGLES and its
// corners, or LS_NONE where the object has none. There is one such record per object, or no chunk.
// In each chunk the objects' parts follow each other in order without gaps, an object's set 1 of
// TEXCOORDS right behind its set 0.
LS_STRUCT(LsAttributes)
{
    uint32_t first_normal;      // index into NORMALS
    uint32_t first_texcoord[2]; // indices into TEXCOORDS, sets 0 and 1
    uint32_t first_color;       // index into COLORS
};
LS_SIZE(LsAttributes, 16);

// NORMALS: unit vectors in object space, octahedral: two snorm16, x in the low half (Z. Cigolle et
// al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 2014; SPEC
// R4.16), -32768 not used. The word LS_NONE: this corner has none, the triangle's own normal
// counts; what would be encoded so, (-1,-1), is stored as (-1,0).

LS_STRUCT(LsTexcoord)
{
    float u;
    float v;
};
LS_SIZE(LsTexcoord, 8);

// Linear colour that multiplies the material's base colour and alpha: unorm16, low half first.
LS_STRUCT(LsCornerColor)
{
    uint32_t red_green;
    uint32_t blue_alpha;
};
LS_SIZE(LsCornerColor, 8);

// A light without a surface, in world space (KHR_lights_punctual).
LS_STRUCT(LsLamp)
{
    LsVec3 position;  // world; 0 for directional ones
    uint32_t kind;    // LS_LAMP_*
    LsVec3 direction; // world, unit length: where it shines; exactly (0,0,-1) for points
    float range;      // world units beyond which it gives no light; 0: unlimited
    LsVec3 intensity; // linear: radiant intensity (W/sr), for directional ones irradiance (W/m^2)
    uint32_t node;    // index into NODES, or LS_NONE
    float cos_inner;  // spot: full within, none beyond cos_outer <= cos_inner; else 1 and -1
    float cos_outer;
    uint32_t reserved[2]; // 0
};
LS_SIZE(LsLamp, 64);

#define LS_LAMP_POINT 0u
#define LS_LAMP_SPOT 1u
#define LS_LAMP_DIRECTIONAL 2u

// ---- Animation of nodes, optional; kept for later use ------------------------------------------------

// Channels that play together. Animations follow each other in CHANNELS without gaps.
LS_STRUCT(LsAnimation)
{
    uint32_t first_channel; // index into CHANNELS
    uint32_t channel_count; // >= 3, three for each animated node
    float duration;         // seconds: the largest time of a key
    uint32_t reserved;      // 0
};
LS_SIZE(LsAnimation, 16);

// One of translation, rotation, scale of one node over time. An animated node has all three in its
// animation, in a row in that order, those that stand still with one key: parent_from_node = T * R
// * S then needs nothing else. Within an animation nodes rise from one three to the next. In KEYS
// each channel's times and then its values follow those of the channel before, without gaps; a
// channel may share the times of the one right before it, and then adds values alone.
LS_STRUCT(LsChannel)
{
    uint32_t node;          // index into NODES
    uint32_t path;          // LS_PATH_*
    uint32_t interpolation; // LS_INTERPOLATION_*
    uint32_t key_count;     // >= 1
    uint32_t first_time;    // index into KEYS: key_count seconds, >= 0, each greater than the last
    uint32_t first_value;   // index into KEYS: per key 3 numbers, 4 for rotations (x y z w); cubic
                            // splines have in-tangent, value, out-tangent, each of so many
    uint32_t reserved[2];   // 0
};
LS_SIZE(LsChannel, 32);

#define LS_PATH_TRANSLATION 0u
#define LS_PATH_ROTATION 1u // unit quaternions
#define LS_PATH_SCALE 2u

#define LS_INTERPOLATION_STEP 0u
#define LS_INTERPOLATION_LINEAR 1u // rotations spherically
#define LS_INTERPOLATION_CUBIC 2u  // glTF 2.0, appendix C.5

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
// enough to travel as push constants beside a kernel's own. With LS_CONSTANT_SEGMENT_LOG2 the
// arrays from triangles on, those that grow with triangles and cells, are tables of the addresses
// of their segments.
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

// ---- The two passes of scenes with one grid -----------------------------------------------------

// What the first pass leaves for the second: rays that go on into the grid, LsGridRay[capacity].
// Those with a long way before them fill it from the front, so that they are taken first, the
// others from the back.
LS_STRUCT(LsTraceQueue)
{
    uint32_t counts[2]; // of rays with a long way, of the others
    uint32_t capacity;
    uint32_t next;         // that no lane has taken yet
    uint32_t reserved[12]; // so that the rays begin at a multiple of 64
};
LS_SIZE(LsTraceQueue, 64);

// A ray in the space of the grid's object, its direction scaled (SPEC 7.2), tmax that of its best
// hit so far.
LS_STRUCT(LsGridRay)
{
    LsVec3 origin;
    float smin;
    LsVec3 direction;
    float smax;
    uint32_t index; // of the ray and its hit
    float s0;
    uint32_t scales; // bits 0..7 and 8..15 exponents of both scales, 16: a hit of equal t is better
    uint32_t reserved;
};
LS_SIZE(LsGridRay, 48);

// An instance as the first pass reads it: all of it in one place, since loads that wait for each
// other are what that pass would spend its time on. Made when a scene is created, for the instances
// that are lists and behind them for the one with the grid, from the top level, INSTANCES and
// OBJECTS.
LS_STRUCT(LsPassInstance)
{
    LsVec3 lower; // world space: the box of the top level's leaf, or what it would be
    uint32_t mask;
    LsVec3 upper;
    uint32_t flags; // LS_INSTANCE_*
    LsVec4 object_from_world[3];
    LsVec3 object_lower;
    float reach;
    LsVec3 object_upper;
    uint32_t first_box; // of a list: LsPairBox[ceil(triangle_count / 2)]
    uint32_t instance;
    uint32_t object;
    uint32_t first_triangle;
    uint32_t triangle_count;
};
LS_SIZE(LsPassInstance, 128);

// The box of triangles 2k and 2k + 1 of a list, or of its last one, grown by more than rounding can
// do to boxes, rays and tests (docs/exactness.md).
LS_STRUCT(LsPairBox)
{
    LsVec3 lower; // object space, from the object's lower corner
    uint32_t reserved_0;
    LsVec3 upper;
    uint32_t reserved_1;
};
LS_SIZE(LsPairBox, 32);

// Push constants of the first pass: lists.
LS_STRUCT(LsListParams)
{
    LsAddress instances; // LsPassInstance[list_count + 1]
    LsAddress boxes;     // LsPairBox
    LsAddress triangles;
    LsAddress rays; // as in LsTraceParams
    LsAddress hits;
    LsAddress masks;
    LsAddress queue; // LsTraceQueue
    uint32_t ray_count;
    uint32_t flags;
    uint32_t list_count;
    float transform_bound;
    uint32_t begins; // 1: makes the queue empty and does nothing else
    uint32_t reserved;
};
LS_SIZE(LsListParams, 80);

// Push constants of the second pass: the grid. The fields of LsObject that it needs are the
// object's.
LS_STRUCT(LsGridParams)
{
    LsAddress triangles;
    LsAddress blocks;
    LsAddress cell_blocks;
    LsAddress subgrids;
    LsAddress voxels;
    LsAddress references;
    LsAddress leaf_nodes;
    LsAddress shafts;
    LsAddress hits;
    LsAddress queue;
    LsVec3 grid_lower;
    float inverse_cell;
    uint32_t cells[3];
    uint32_t flags; // LS_RAY_FLAG_*, LS_GRID_*
    uint32_t instance;
    uint32_t object;
    uint32_t first_triangle;
    uint32_t first_subgrid_block; // cell_block_count - subgrid_count
};
LS_SIZE(LsGridParams, 128);

#define LS_GRID_MIRRORED 0x80000000u // the instance turns the winding round
#define LS_GRID_SCENE_PATCHES 16     // first of eight bits with the object's scene_patches

// ---- One pass over scenes with one grid where lanes go in lockstep, whatever they do --------------

// Push constants. The scene is read as texels.
LS_STRUCT(LsLockstepParams)
{
    LsVec3 grid_lower; // as in LsGridParams
    float inverse_cell;
    uint32_t cells[3];
    uint32_t flags; // LS_RAY_FLAG_*, LS_GRID_MIRRORED
    LsAddress rays; // as in LsTraceParams
    LsAddress hits;
    LsAddress masks;
    uint32_t ray_count;
    uint32_t instance_count; // no more than lanes
    uint32_t grid_instance;
    uint32_t grid_object;
    uint32_t first_triangle;
    uint32_t reserved;
};
LS_SIZE(LsLockstepParams, 80);

#define LS_MAX_LANE_RAYS 32u // LS_CONSTANT_LANE_RAYS
// A lane has a multiple of so many rays. A block of a group's rays is that many for each lane;
// where rounds ran out its first hit has LS_HIT_CUT.
#define LS_BLOCK_LANE_RAYS 4u
// In LsTraceParams.flags, of kernels that read texels: the rays of a block, of which an invocation
// traces those whose hit has LS_HIT_CUT; 0: an invocation traces a ray.
#define LS_TRACE_BLOCK 16u // first of eight bits
// Steps with their tests that a group takes in the grid. Two loops count them, a third the rays in
// the lists, so that all stay within llvmpipe's 65535.
#define LS_LOCKSTEP_ROUNDS 20000u

#define LS_METHOD_EXACT 0u // through the Line Space
#define LS_METHOD_BRUTE 1u // every triangle, same test: the yardstick of exactness
#define LS_METHOD_GRID 2u  // the same cells without shafts: tells what these are worth
// Exact, but instead of a hit what it took: `instance` holds the cells and empty cubes walked,
// `object` the shafts looked up, those across grids too, `primitive` the triangles tested,
// `material` 0, t, u, v 0.
#define LS_METHOD_COUNT 3u

// Specialization constants of the kernels: 0 the method, from 1 on the required features in bit
// order, and behind the room for more of them:
#define LS_CONSTANT_GROUP_SIZE 32
#define LS_CONSTANT_DEFERS 33     // LS_DEFERS
#define LS_CONSTANT_REFILL 34     // of the second of two passes
#define LS_CONSTANT_HAS_LIGHTS 35 // of the path tracer
#define LS_CONSTANT_SEGMENT_LOG2 36
#define LS_CONSTANT_LANE_RAYS 37 // that a group traces in lockstep, divided by its lanes

// Triangles that brute force tests in a round of its loop.
#define LS_BRUTE_ROUND 8u

#endif
