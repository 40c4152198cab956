// walk.glsl - the way of a ray through the cells of an object's grid, and the shaft that a voxel is
// crossed by.
//
// Cells are walked by whole numbers alone; a point on the ray only picks among the cells that an
// empty cube or a voxel leaves open. The s and the axis by which a cell is left are those by which
// the next is entered, so the intervals tile the ray. Planes of cells are whole numbers times a
// power of two, exact in float. design: F.-L. Schröder 2017, sections 4 and 7; J. Amanatides, A.
// Woo 1987; exactness: SPEC 7.5.
//
// Space is mirrored so that the ray falls along no axis: -x for x and cell ~c for cell c, both
// exact. What lies ahead is then always at the greater coordinate. J. Revelles et al., "An
// Efficient Parametric Algorithm for Octree Traversal", WSCG 2000, mirror so too.
//
// Where a grid has scene shafts, a ray passes the intervals of its way that are empty in one step
// (thesis, 13.1). It goes on behind them as a ray does that starts there; docs/exactness.md tells
// why no hit is lost.

#ifndef LS_WALK_GLSL
#define LS_WALK_GLSL

#include "triangle.glsl"

// A grid: of LsObject what walking needs, and where the object's parts of the arrays begin. Loaded
// once a ray, or constant in a kernel for scenes of one grid.
struct LsGrid
{
    vec3 lower; // object space
    float inverse_cell;
    uvec3 cells;
    uint first_block;
    uint first_cell_block;
    uint first_voxel;
    uint first_reference;
    uint first_shaft_word;
    uint first_leaf_node;
    uint first_subgrid;
    uint first_subgrid_block; // cell block of sub-grid 0
    uint scene_patches;       // M, 0: no scene shafts; they are the first of the shaft words
};

// A cell outside of every grid, mirrored or not.
const int LS_OUTSIDE = 0x7FFFFFFF;

#define LS_USES_SCENE_SHAFTS (LS_HAS_SCENE_SHAFTS != 0u && LS_METHOD != LS_METHOD_GRID)

// Where a ray stands in the grid of its object: grid space, mirrored.
struct LsWalk
{
    vec3 origin;
    vec3 direction; // 0 along axes on which the ray never leaves its cell
    vec3 inverse;   // +inf there
    uint mirror;    // bit i: axis i is mirrored; in bits, for registers decide the speed
    ivec3 cell;     // counts cells of the level
    float s;        // where the cell is entered
    uint axis;      // of the face through which; 3: none, the ray starts inside
    uint level;
    uint block;     // cell block of the sub-grid
    uint leaf_node; // where a voxel's BVH goes on; 0: at its root
    // What is to be tested before the next step: bit k is reference first_reference + k.
    uint first_reference;
    uint mask;
    // With scene shafts: the way through the grid in intervals, the first from s_line on.
    uint signature; // filled intervals of the runs that come after the one at hand
    float s_line;
    float s_interval;
    float s_stop; // the end of the run at hand, +inf at the end of the grid
};

// -1 for axes that are mirrored, else 0: what a cell is xored with.
ivec3 ls_mirror(uint mirror)
{
    return -ivec3((uvec3(mirror) >> uvec3(0u, 1u, 2u)) & 1u);
}

// The cell in which a ray is at s, of a grid whose mirrored lower corner is `low`.
ivec3 ls_find_cell(LsWalk walk, float s, vec3 low, vec3 border)
{
    return ivec3(clamp(floor(walk.origin + walk.direction * s), low, low + border - 1.0));
}

// The lower corner of a grid, mirrored.
vec3 ls_mirrored_low(uint mirror, vec3 border)
{
    return mix(vec3(0.0), -border, notEqual(ls_mirror(mirror), ivec3(0)));
}

// Patch index on the face of `axis` of a point in a box's coordinates, [0,1] each, clamped onto it.
uint ls_patch_index(vec3 point, uint mirror, uint axis, uint patches)
{
    vec2 on_face = axis == 0u ? point.yz : (axis == 1u ? point.zx : point.xy);
    uint turned =
        axis == 0u ? mirror >> 1 : (axis == 1u ? (mirror >> 2) | (mirror << 1) : mirror);
    float n = float(patches);
    uvec2 k = uvec2(clamp(on_face * n, vec2(0.0), vec2(n - 0.5)));
    k.x = (turned & 1u) != 0u ? patches - 1u - k.x : k.x;
    k.y = (turned & 2u) != 0u ? patches - 1u - k.y : k.y;
    return k.x * patches + k.y;
}

// The number of the shaft through which a ray crosses a box: it enters at `point_in` by the near
// face of axis_in and leaves at `point_out` by the far face of axis_out, points in the box's
// coordinates. SPEC chapter 6. `forward`: the ray goes from the shaft's first patch to its second.
uint ls_shaft_number(uint patches, uint mirror, uint axis_in, vec3 point_in, uint axis_out,
                     vec3 point_out, out bool forward)
{
    uint patch_in = ls_patch_index(point_in, mirror, axis_in, patches);
    uint patch_out = ls_patch_index(point_out, mirror, axis_out, patches);
    uint face_in = 2u * axis_in + ((mirror >> axis_in) & 1u);
    uint face_out = 2u * axis_out + (~(mirror >> axis_out) & 1u);
    forward = face_in < face_out;
    uint face_a = forward ? face_in : face_out;
    uint face_b = forward ? face_out : face_in;
    uint patch_a = forward ? patch_in : patch_out;
    uint patch_b = forward ? patch_out : patch_in;
    uint pair = face_a * 5u - face_a * (face_a - 1u) / 2u + (face_b - face_a - 1u);
    return (pair * patches * patches + patch_a) * patches * patches + patch_b;
}

// Reads which intervals of the way from s_enter to s_leave are filled: those of the scene shaft
// from face to face of the whole grid.
void ls_load_signature(LsGrid grid, inout LsWalk walk, float s_enter, uint axis_in, float s_leave,
                       uint axis_out)
{
    vec3 border = vec3(grid.cells);
    vec3 low = ls_mirrored_low(walk.mirror, border);
    vec3 point_in = (walk.origin + walk.direction * s_enter - low) / border;
    vec3 point_out = (walk.origin + walk.direction * s_leave - low) / border;
    bool forward;
    uint shaft = ls_shaft_number(grid.scene_patches, walk.mirror, axis_in, point_in, axis_out,
                                 point_out, forward);
    uint word = LS_LOAD_WORD(shafts, grid.first_shaft_word + shaft);
    walk.signature = forward ? word : bitfieldReverse(word);
    walk.s_line = s_enter;
    walk.s_interval = (s_leave - s_enter) * (1.0 / float(LS_SIGNATURE_INTERVALS));
    ls_work.y++;
}

// Goes on to the next run of filled intervals that does not lie behind; what is before it is empty.
// False if there is none.
bool ls_walk_jump(LsGrid grid, inout LsWalk walk)
{
    bool behind = true;
    while (behind && walk.signature != 0u)
    {
        uint first = uint(findLSB(walk.signature));
        uint left = LS_SIGNATURE_INTERVALS - first;
        uint count = min(uint(findLSB(~(walk.signature >> first))), left); // -1 for none
        bool is_last = count == left;
        walk.signature &= is_last ? 0u : 0xFFFFFFFFu << (first + count);
        walk.s_stop =
            is_last ? LS_INFINITY : walk.s_line + float(first + count) * walk.s_interval;
        float s_begin = walk.s_line + float(first) * walk.s_interval;
        behind = walk.s_stop < walk.s;
        if (!behind && s_begin > walk.s)
        {
            vec3 border = vec3(grid.cells);
            walk.s = s_begin;
            walk.axis = 3u;
            walk.level = 0u;
            walk.cell = ls_find_cell(walk, s_begin, ls_mirrored_low(walk.mirror, border), border);
        }
    }
    // A device that ended the loop before its time has not looked at all runs.
    return !behind || int(walk.signature | (0u - walk.signature)) < 0;
}

// Places a ray at the first cell. False if it misses the grid, or if its best hit lies before it.
bool ls_walk_begin(LsGrid grid, LsLocalRay ray, out LsWalk walk)
{
    float inverse_cell = grid.inverse_cell;
    precise vec3 origin = (ray.origin - grid.lower) * inverse_cell;
    bvec3 still = lessThan(abs(ray.direction), vec3(LS_SMALLEST_COMPONENT));
    bvec3 falling = lessThan(mix(ray.direction, vec3(0.0), still), vec3(0.0));
    precise vec3 inverse = abs(ls_inverse_direction(ray.direction)) / inverse_cell;
    vec3 border = vec3(grid.cells);
    walk.axis = 3u;
    walk.level = 0u;
    walk.block = 0u;
    walk.leaf_node = 0u;
    walk.first_reference = 0u;
    walk.mask = 0u;

    // A ray that stands still along an axis must stand inside the grid, and truly before its
    // border: then the distance to a plane ahead is never 0 times infinity.
    if (ls_max_component(mix(vec3(0.0), max(-origin, origin - border), still)) > 0.0)
    {
        return false;
    }
    origin = mix(origin, min(origin, uintBitsToFloat(floatBitsToUint(border) - 1u)), still);
    walk.origin = mix(origin, -origin, falling);
    walk.direction = mix(abs(ray.direction) * inverse_cell, vec3(0.0), still);
    walk.inverse = mix(inverse, vec3(LS_INFINITY), still);
    walk.mirror = uint(falling.x) | (uint(falling.y) << 1) | (uint(falling.z) << 2);

    // Triangles keep a margin to the grid's border, so this needs no growth.
    vec3 low = mix(vec3(0.0), -border, falling);
    precise vec3 s_low = (low - walk.origin) * inverse;
    precise vec3 s_high = (low + border - walk.origin) * inverse;
    float s_enter = ls_max_component(mix(s_low, vec3(-LS_INFINITY), still));
    float s_leave = ls_min_component(mix(s_high, vec3(LS_INFINITY), still));
    precise float s_first = ray.smin - ray.s0;
    precise float s = max(s_enter, s_first);
    walk.s = s;
    walk.cell = ls_find_cell(walk, s, low, border);
    precise float s_end = s + ray.s0;
    bool meets = s_enter <= s_leave && s <= s_leave && s_end <= ray.smax;
    if (LS_USES_SCENE_SHAFTS)
    {
        walk.signature = 0u;
        walk.s_stop = LS_INFINITY;
    }
    if (LS_USES_SCENE_SHAFTS && grid.scene_patches != 0u && meets)
    {
        uint axis_in = ls_max_axis(mix(s_low, vec3(-LS_INFINITY), still));
        uint axis_out = ls_min_axis(mix(s_high, vec3(LS_INFINITY), still));
        ls_load_signature(grid, walk, s_enter, axis_in, s_leave, axis_out);
        meets = ls_walk_jump(grid, walk) && walk.s + ray.s0 <= ray.smax;
    }
    return meets;
}

// Whether the ray has left the grid, or nothing ahead can be nearer than its best hit: what lies
// beyond has a greater s, compared with s0 added, as hits are.
bool ls_walk_is_over(LsGrid grid, LsLocalRay ray, LsWalk walk)
{
    precise float s_end = walk.s + ray.s0;
    uvec3 at = uvec3(walk.cell ^ ls_mirror(walk.mirror)); // of cells below 0, greater than any size
    bool outside = any(greaterThanEqual(at, grid.cells));
    return ray.smax < s_end || (outside && (LS_HAS_SUBGRIDS == 0u || walk.level == 0u));
}

// The mask of the shaft through which the ray crosses a voxel, as ls_shaft_number takes it. Bits
// from the voxel's reference count on are those of other shafts.
uint ls_shaft_mask(LsVoxel voxel, uint first_shaft_word, uint mirror, uint axis_in, vec3 point_in,
                   uint axis_out, vec3 point_out)
{
    uint patches = (voxel.shape >> 8) & 0xFFu;
    uint width_log2 = (voxel.shape >> 16) & 0xFFu;
    bool forward;
    uint shaft =
        ls_shaft_number(patches, mirror, axis_in, point_in, axis_out, point_out, forward);
    bool exact = LS_HAS_EXACT_MASKS != 0u && width_log2 == 0u;
    uint width = exact ? voxel.reference_count : 1u << width_log2;
    uint bit = shaft * width;
    uint at = first_shaft_word + voxel.table + (bit >> 5);
    uint shift = bit & 31u;
    uint mask = LS_LOAD_WORD(shafts, at) >> shift;
    if (exact && shift + width > 32u)
    {
        mask |= LS_LOAD_WORD(shafts, at + 1u) << (32u - shift);
    }
    return mask;
}

// Goes on in a voxel's BVH to the next leaf that the ray meets, and asks for its triangles. False
// if there is none.
bool ls_walk_leaf(LsGrid grid, LsLocalRay ray, inout LsWalk walk, LsVoxel voxel)
{
    uint first_node = grid.first_leaf_node + voxel.table;
    uint node_count = LS_LOAD_LEAF_NODE(first_node).escape;
    // Of an infinite inverse the one that ls_inverse_direction gives, so that no product is NaN.
    vec3 inverse = min(walk.inverse, vec3(1.0 / (LS_SMALLEST_COMPONENT * grid.inverse_cell)));
    bvec3 falling = notEqual(ls_mirror(walk.mirror), ivec3(0));
    float s_limit = ray.s0 == 0.0 ? ray.smax : LS_INFINITY;
    precise float s_first = ray.smin - ray.s0;
    uint i = walk.leaf_node;
    while (i < node_count)
    {
        ls_work.x++;
        LsBvhNode node = LS_LOAD_LEAF_NODE(first_node + i);
        bool met = ls_meets_box(walk.origin, inverse, mix(node.lower, -node.upper, falling),
                                mix(node.upper, -node.lower, falling), s_first, s_limit);
        i = met ? i + 1u : node.escape;
        if (met && node.leaf != 0u)
        {
            walk.first_reference = grid.first_reference + voxel.first_reference + (node.leaf >> 4);
            walk.mask = (1u << (node.leaf & 15u)) - 1u;
            walk.leaf_node = i;
            return true;
        }
    }
    walk.leaf_node = 0u;
    return false;
}

// What stands where the ray is. Lowest nibble 0: a voxel, the other bits its number. Else an empty
// cube, a nibble for each octant of directions its side, in blocks where `in_block` is false.
uint ls_walk_find(LsGrid grid, inout LsWalk walk, out bool in_block)
{
    uvec3 at = uvec3(walk.cell ^ ls_mirror(walk.mirror));
    uint word = 0u;
    in_block = true;
    ls_work.x += walk.leaf_node == 0u ? 1u : 0u; // else it is a cell that was begun before
    if (LS_HAS_SUBGRIDS == 0u || walk.level == 0u)
    {
        uvec3 at_block = at >> 2;
        uint blocks_x = (grid.cells.x + 3u) >> 2;
        uint blocks_y = (grid.cells.y + 3u) >> 2;
        word = LS_LOAD_WORD(blocks, grid.first_block + at_block.x +
                                                 blocks_x * (at_block.y + blocks_y * at_block.z));
        in_block = (word & 15u) == 0u;
        walk.block = in_block ? word >> 4 : walk.block;
    }
    if (in_block)
    {
        uvec3 in_at = at & 3u;
        word = LS_LOAD_CELL(grid.first_cell_block + walk.block,
                            in_at.x + 4u * in_at.y + 16u * in_at.z);
    }
    return word;
}

bool ls_is_voxel(uint word)
{
    return (word & 15u) == 0u;
}

// Passes what ls_walk_find has found, `filled` if it is a voxel: one cell or empty cube, or one
// leaf of a BVH. What of it is to be tested is in the walk afterwards, which then stands before the
// next.
void ls_walk_pass(LsGrid grid, LsLocalRay ray, inout LsWalk walk, uint word, bool in_block,
                  bool filled)
{
    ivec3 cell = walk.cell;
    float cells_per_unit = 1.0; // 4^level, and its inverse
    float cell_size = 1.0;
    if (LS_HAS_SUBGRIDS != 0u)
    {
        cells_per_unit = uintBitsToFloat((127u + 2u * walk.level) << 23);
        cell_size = uintBitsToFloat((127u - 2u * walk.level) << 23);
    }
    walk.mask = 0u;
    // An empty cube begins at `base` and grows with the ray.
    ivec3 base = in_block ? cell : cell & ~3;
    uint unit_log2 = in_block ? 0u : 2u;
    LsVoxel voxel;
#ifdef LS_TEXELS
    // Lanes that have none fetch as well, and then what the cache holds.
    voxel = LsVoxel(0u, 0u, 0u, 0u);
#endif
    if (filled)
    {
        voxel = LS_LOAD_VOXEL(grid.first_voxel + (word >> 4));
        uint kind = voxel.shape & 0xFFu;
        if (LS_HAS_SUBGRIDS != 0u && kind == LS_VOXEL_SUBGRID)
        {
            walk.level++;
            walk.block = voxel.table;
            ivec3 low = cell * 4;
            vec3 point = (walk.origin + walk.direction * walk.s) * (cells_per_unit * 4.0);
            ivec3 below = clamp(ivec3(floor(point)), low, low + 3);
            walk.cell = mix(below, low, ls_is_axis(walk.axis));
            return;
        }
        if (LS_HAS_LEAF_BVHS != 0u && kind == LS_VOXEL_BVH && ls_walk_leaf(grid, ray, walk, voxel))
        {
            return;
        }
    }

    // The far planes, and where the ray leaves through them. Outside the grid all is empty;
    // outside a sub-grid it is not.
    ivec3 plane = base + (filled ? 1 : int(((word >> (4u * walk.mirror)) & 15u) << unit_log2));
    if (LS_HAS_SUBGRIDS != 0u && walk.level > 0u)
    {
        plane = min(plane, (cell & ~3) + 4);
    }
    precise vec3 s_planes = (vec3(plane) * cell_size - walk.origin) * walk.inverse;
    uint axis_out = ls_min_axis(s_planes);
    float s_out = max(ls_min_component(s_planes), walk.s);
    vec3 point_out = (walk.origin + walk.direction * s_out) * cells_per_unit;

    if (filled && (LS_HAS_LEAF_BVHS == 0u || (voxel.shape & 0xFFu) != LS_VOXEL_BVH))
    {
        walk.first_reference = grid.first_reference + voxel.first_reference;
        walk.mask = voxel.reference_count >= 32u ? 0xFFFFFFFFu : (1u << voxel.reference_count) - 1u;
        if (LS_HAS_MASKS != 0u && LS_METHOD != LS_METHOD_GRID &&
            (voxel.shape & 0xFFu) == LS_VOXEL_MASKS)
        {
            // A ray that starts in the voxel gets the shaft of its whole line through it.
            float s_in = walk.s;
            uint axis_in = walk.axis;
            if (walk.axis == 3u)
            {
                precise vec3 s_near = (vec3(cell) * cell_size - walk.origin) * walk.inverse;
                s_near = mix(s_near, vec3(-LS_INFINITY), equal(walk.direction, vec3(0.0)));
                axis_in = ls_max_axis(s_near);
                s_in = min(ls_max_component(s_near), walk.s);
            }
            vec3 point_in = (walk.origin + walk.direction * s_in) * cells_per_unit;
            walk.mask &= ls_shaft_mask(voxel, grid.first_shaft_word, walk.mirror, axis_in,
                                       point_in - vec3(cell), axis_out, point_out - vec3(cell));
            ls_work.y++;
        }
    }

    // Step through the plane of axis_out; along the other axes the ray stays within the cube.
    ivec3 inside = filled ? cell : clamp(ivec3(floor(point_out)), cell, plane - 1);
    ivec3 next = mix(inside, plane, ls_is_axis(axis_out));
    walk.s = s_out;
    walk.axis = axis_out;
    while (LS_HAS_SUBGRIDS != 0u && walk.level > 0u && any(notEqual(next >> 2, cell >> 2)))
    {
        walk.level--;
        cell = cell >> 2;
        next = next >> 2;
        if (walk.level > 0u)
        {
            uint subgrid = walk.block - grid.first_subgrid_block;
            walk.block = LS_LOAD_WORD(subgrids, grid.first_subgrid + subgrid);
        }
    }
    walk.cell = next;
    if (LS_USES_SCENE_SHAFTS && walk.s > walk.s_stop && !ls_walk_jump(grid, walk))
    {
        walk.level = 0u;
        walk.cell = ivec3(LS_OUTSIDE);
    }
}

// Finds and passes one cell or empty cube, or one leaf of a BVH.
void ls_walk_step(LsGrid grid, LsLocalRay ray, inout LsWalk walk)
{
    bool in_block;
    uint word = ls_walk_find(grid, walk, in_block);
    ls_walk_pass(grid, ray, walk, word, in_block, ls_is_voxel(word));
}

#endif
