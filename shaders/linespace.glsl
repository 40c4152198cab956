// linespace.glsl - traces rays through a Line Space; the one include for shaders of others.
//
//     #extension GL_EXT_buffer_reference : require
//     #extension GL_EXT_buffer_reference_uvec2 : require
//     #extension GL_GOOGLE_include_directive : require
//     #include "ls_layout.h"
//     layout(push_constant) uniform Push { LsTraceScene ls_scene; ... }; // from ls_scene_trace()
//     #include "linespace.glsl"
//     ...
//     LsHit hit = ls_trace_ray(ray, 0xFFu, 0u);
//
// Cells are walked by whole numbers alone; a point on the ray only picks among the cells that an empty
// cube or a voxel leaves open. The s and the axis by which a cell is left are those by which the
// next is entered, so the intervals tile the ray. Planes of cells are whole numbers times a power
// of two, exact in float. design: F.-L. Schröder 2017, sections 4 and 7; J. Amanatides, A. Woo
// 1987; exactness: SPEC 7.5.
//
// The numbers of cells are floats: below 2^16 at every level (R5.1), so exact, and planes and points
// need no conversion.

#ifndef LS_LINESPACE_GLSL
#define LS_LINESPACE_GLSL

#include "scene.glsl"
#include "triangle.glsl"

// Set where a device ended a loop before its time: llvmpipe (Mesa 22.3) ends all loops of an
// invocation, without a word, after 65535 rounds in sum. The answer is then not to be trusted. After
// a loop its condition is asked again, in other words, lest the compiler knows the answer.
bool ls_cut;

// More rounds than a sound file can take.
const uint LS_MAX_ROUNDS = 1u << 24;

// Tests the references whose bit is set in `mask`. True if the ray may end.
bool ls_test_references(inout LsLocalRay ray, inout LsBest best, uint first_reference, uint mask)
{
    LsWordArray references = LsWordArray(ls_scene.references);
    while (mask != 0u)
    {
        uint bit = uint(findLSB(mask));
        mask &= mask - 1u;
        if (ls_test_triangle(ray, best, references.at[first_reference + bit]))
        {
            return true;
        }
    }
    ls_cut = ls_cut || int(mask | (0u - mask)) < 0;
    return false;
}

// Tests four triangles of an object from `number` on, or its last again: one tested twice changes
// nothing.
bool ls_test_four(inout LsLocalRay ray, inout LsBest best, uint number, uint last)
{
    bool done = ls_test_triangle(ray, best, min(number, last));
    done = ls_test_triangle(ray, best, min(number + 1u, last)) || done;
    done = ls_test_triangle(ray, best, min(number + 2u, last)) || done;
    done = ls_test_triangle(ray, best, min(number + 3u, last)) || done;
    return done;
}

// Tests all triangles of an object; brute force takes LS_BRUTE_ROUND a round, to stay within
// llvmpipe's rounds.
bool ls_test_all(inout LsLocalRay ray, inout LsBest best)
{
    uint count = LsObjectArray(ls_scene.objects).at[ray.object].triangle_count;
    uint round = LS_METHOD == LS_METHOD_BRUTE ? LS_BRUTE_ROUND : 1u;
    uint i = 0u;
    for (; i < count; i += round)
    {
        bool done;
        if (LS_METHOD == LS_METHOD_BRUTE)
        {
            done = ls_test_four(ray, best, i, count - 1u) ||
                   ls_test_four(ray, best, i + 4u, count - 1u);
        }
        else
        {
            done = ls_test_triangle(ray, best, i);
        }
        if (done)
        {
            return true;
        }
    }
    ls_cut = ls_cut || int(i - count) < 0;
    return false;
}

// Whether a ray meets a box before `end`; `inverse` from ls_inverse_direction, so no product is
// NaN.
bool ls_meets_box(vec3 origin, vec3 inverse, vec3 lower, vec3 upper, float begin, float end)
{
    precise vec3 a = (lower - origin) * inverse;
    precise vec3 b = (upper - origin) * inverse;
    return max(ls_max_component(min(a, b)), begin) <= min(ls_min_component(max(a, b)), end);
}

// Patch index on the face of `axis` for a point in voxel coordinates, clamped onto the voxel.
uint ls_patch_index(vec3 p, uint axis, uint patches)
{
    float n = float(patches);
    vec2 q = axis == 0u ? p.yz : (axis == 1u ? p.zx : p.xy);
    uvec2 k = uvec2(ivec2(clamp(q * n, vec2(0.0), vec2(n - 0.5))));
    return k.x * patches + k.y;
}

// The mask of the shaft from one face and point to another; SPEC chapter 6.
uint ls_shaft_mask(LsVoxel voxel, uint first_shaft_word, uint face_in, vec3 point_in, uint face_out,
                   vec3 point_out)
{
    uint patches = (voxel.shape >> 8) & 0xFFu;
    uint width_log2 = (voxel.shape >> 16) & 0xFFu;
    uint patch_in = ls_patch_index(point_in, face_in >> 1, patches);
    uint patch_out = ls_patch_index(point_out, face_out >> 1, patches);
    bool forward = face_in < face_out;
    uint face_a = forward ? face_in : face_out;
    uint face_b = forward ? face_out : face_in;
    uint patch_a = forward ? patch_in : patch_out;
    uint patch_b = forward ? patch_out : patch_in;
    uint pair = face_a * 5u - face_a * (face_a - 1u) / 2u + (face_b - face_a - 1u);
    uint shaft = (pair * patches * patches + patch_a) * patches * patches + patch_b;
    uint bit = shaft << width_log2;
    uint word =
        LsWordArray(ls_scene.shafts).at[first_shaft_word + voxel.table + (bit >> 5)] >> (bit & 31u);
    return width_log2 == 5u ? word : word & ((1u << (1u << width_log2)) - 1u);
}

uint ls_min_axis(vec3 v)
{
    return v.x <= v.y && v.x <= v.z ? 0u : (v.y <= v.z ? 1u : 2u);
}

uint ls_max_axis(vec3 v)
{
    return v.x >= v.y && v.x >= v.z ? 0u : (v.y >= v.z ? 1u : 2u);
}

// Walks the grid of an object. True if the ray may end.
bool ls_walk_grid(inout LsLocalRay ray, inout LsBest best)
{
    LsObjectArray objects = LsObjectArray(ls_scene.objects);
    LsWordArray blocks = LsWordArray(ls_scene.blocks);
    LsWordArray cells = LsWordArray(ls_scene.cell_blocks);
    LsVoxelArray voxels = LsVoxelArray(ls_scene.voxels);

    // The ray in grid space. Axes along which it hardly moves never leave a cell.
    float inverse_cell = objects.at[ray.object].inverse_cell;
    precise vec3 origin = (ray.origin - objects.at[ray.object].grid_lower) * inverse_cell;
    precise vec3 direction = ray.direction * inverse_cell;
    bvec3 still = lessThan(abs(ray.direction), vec3(LS_SMALLEST_COMPONENT));
    precise vec3 inverse = ls_inverse_direction(ray.direction) / inverse_cell;
    bvec3 rising = greaterThanEqual(direction, vec3(0.0));
    uvec3 dims = uvec3(objects.at[ray.object].cells[0], objects.at[ray.object].cells[1],
                       objects.at[ray.object].cells[2]);

    // Where it enters and leaves the grid. Triangles keep a margin to its border, so this needs no
    // growth.
    vec3 border = vec3(dims);
    if (ls_max_component(mix(vec3(0.0), max(-origin, origin - border), still)) > 0.0)
    {
        return false;
    }
    precise vec3 s_low = (vec3(0.0) - origin) * inverse;
    precise vec3 s_high = (border - origin) * inverse;
    float s_enter = ls_max_component(mix(min(s_low, s_high), vec3(-LS_INFINITY), still));
    float s_leave = ls_min_component(mix(max(s_low, s_high), vec3(LS_INFINITY), still));
    precise float s_first = ray.smin - ray.s0;
    precise float s = max(s_enter, s_first);
    if (!(s_enter <= s_leave && s <= s_leave))
    {
        return false;
    }

    vec3 cell = clamp(floor(origin + direction * s), vec3(0.0), border - 1.0); // counts cells of the level
    vec3 low = vec3(0.0); // the region of the level: the grid,
    vec3 high = border;   // or the parent voxel of a sub-grid
    int level = 0;
    float cells_per_unit = 1.0; // 4^level, and its inverse
    float cell_size = 1.0;
    uint block = 0u;
    uint axis = 0u;
    bool entered = false; // by a face, `axis`; before that the ray starts inside the cell
    uint octant_shift = (rising.x ? 0u : 4u) | (rising.y ? 0u : 8u) | (rising.z ? 0u : 16u);
    uint blocks_x = (dims.x + 3u) >> 2;
    uint blocks_y = (dims.y + 3u) >> 2;

    uint first_block = LS_FIRST(objects.at[ray.object].first_block);
    uint first_cell_block = LS_FIRST(objects.at[ray.object].first_cell_block);
    uint first_voxel = LS_FIRST(objects.at[ray.object].first_voxel);
    uint object_references = LS_FIRST(objects.at[ray.object].first_reference);
    uint first_shaft_word = LS_FIRST(objects.at[ray.object].first_shaft_word);

    for (uint round = 0u; round < LS_MAX_ROUNDS; round++)
    {
        // What stands here: an empty cube, which begins at `base` and grows with the ray, or a voxel.
        uvec3 at = uvec3(ivec3(cell));
        uint word = 0u;
        vec3 base = cell;
        float unit = 1.0;
        bool in_block = true;
        if (LS_HAS_SUBGRIDS == 0u || level == 0)
        {
            uvec3 at_block = at >> 2;
            word = blocks.at[first_block + at_block.x +
                             blocks_x * (at_block.y + blocks_y * at_block.z)];
            in_block = (word & 15u) == 0u;
            block = in_block ? word >> 4 : block;
        }
        if (in_block)
        {
            uvec3 in_at = at & 3u;
            word = cells.at[(first_cell_block + block) * LS_BLOCK_CELLS + in_at.x + 4u * in_at.y +
                            16u * in_at.z];
        }
        else
        {
            base = vec3(ivec3(at & ~3u));
            unit = 4.0;
        }
        bool filled = (word & 15u) == 0u;
        float side = filled ? 1.0 : float(int((word >> octant_shift) & 15u)) * unit;

        // The far planes, and where the ray leaves through them. Outside the grid all is empty;
        // outside a sub-grid it is not.
        vec3 plane = base + mix(vec3(unit - side), vec3(side), rising);
        if (LS_HAS_SUBGRIDS != 0u)
        {
            plane = clamp(plane, low, high);
        }
        precise vec3 s_planes = (plane * cell_size - origin) * inverse;
        s_planes = mix(s_planes, vec3(LS_INFINITY), still);
        uint axis_out = ls_min_axis(s_planes);
        float s_out = max(ls_min_component(s_planes), s);

        if (filled)
        {
            LsVoxel voxel = voxels.at[first_voxel + (word >> 4)];
            uint kind = voxel.shape & 0xFFu;
            if (LS_HAS_SUBGRIDS != 0u && kind == LS_VOXEL_SUBGRID)
            {
                level++;
                cells_per_unit *= 4.0;
                cell_size *= 0.25;
                low = cell * 4.0;
                high = low + 4.0;
                block = voxel.table;
                cell = clamp(floor((origin + direction * s) * cells_per_unit), low, high - 1.0);
                if (entered)
                {
                    cell = mix(cell, mix(high - 1.0, low, rising), ls_is_axis(axis));
                }
                continue;
            }
            uint mask =
                voxel.reference_count >= 32u ? 0xFFFFFFFFu : (1u << voxel.reference_count) - 1u;
            uint first_reference = object_references + voxel.first_reference;
            if (LS_HAS_LEAF_BVHS != 0u && kind == LS_VOXEL_BVH)
            {
                LsBvhNodeArray nodes = LsBvhNodeArray(ls_scene.leaf_nodes);
                uint first_node = LS_FIRST(objects.at[ray.object].first_leaf_node) + voxel.table;
                uint node_count = nodes.at[first_node].escape;
                uint i = 0u;
                while (i < node_count)
                {
                    LsBvhNode node = nodes.at[first_node + i];
                    float s_limit = ray.s0 == 0.0 ? ray.smax : LS_INFINITY;
                    bool met =
                        ls_meets_box(origin, inverse, node.lower, node.upper, s_first, s_limit);
                    if (met && node.leaf != 0u &&
                        ls_test_references(ray, best, first_reference + (node.leaf >> 4),
                                           (1u << (node.leaf & 15u)) - 1u))
                    {
                        return true;
                    }
                    i = met ? i + 1u : node.escape;
                }
                ls_cut = ls_cut || int(i - node_count) < 0;
                mask = 0u;
            }
            if (LS_HAS_MASKS != 0u && kind == LS_VOXEL_MASKS)
            {
                // A ray that starts in the voxel gets the shaft of its whole line through it.
                float s_in = s;
                uint axis_in = axis;
                if (!entered)
                {
                    precise vec3 s_near =
                        (mix(cell + 1.0, cell, rising) * cell_size - origin) * inverse;
                    s_near = mix(s_near, vec3(-LS_INFINITY), still);
                    axis_in = ls_max_axis(s_near);
                    s_in = min(ls_max_component(s_near), s);
                }
                vec3 point_in = (origin + direction * s_in) * cells_per_unit - cell;
                vec3 point_out = (origin + direction * s_out) * cells_per_unit - cell;
                uint face_in = 2u * axis_in + ((octant_shift >> (axis_in + 2u)) & 1u);
                uint face_out = 2u * axis_out + (~(octant_shift >> (axis_out + 2u)) & 1u);
                mask &=
                    ls_shaft_mask(voxel, first_shaft_word, face_in, point_in, face_out, point_out);
            }
            if (ls_test_references(ray, best, first_reference, mask))
            {
                return true;
            }
        }

        // What lies beyond has s >= s_out; compared with s0 added, as hits are.
        precise float s_end = s_out + ray.s0;
        if (ray.smax < s_end)
        {
            return false;
        }

        // Step through the plane of axis_out; along the other axes the ray stays within the cube.
        vec3 reached = floor((origin + direction * s_out) * cells_per_unit);
        vec3 last = mix(plane, plane - 1.0, rising); // the cube's last cells
        reached = clamp(reached, min(cell, last), max(cell, last));
        cell = mix(reached, mix(plane - 1.0, plane, rising), ls_is_axis(axis_out));
        s = s_out;
        axis = axis_out;
        entered = true;
        while (LS_HAS_SUBGRIDS != 0u && level > 0 &&
               (any(lessThan(cell, low)) || any(greaterThanEqual(cell, high))))
        {
            level--;
            cells_per_unit *= 0.25;
            cell_size *= 4.0;
            cell = floor(cell * 0.25);
            if (level == 0)
            {
                low = vec3(0.0);
                high = border;
            }
            else
            {
                low = floor(low * 0.0625) * 4.0;
                high = low + 4.0;
                uint subgrid = block - (objects.at[ray.object].cell_block_count -
                                        objects.at[ray.object].subgrid_count);
                block = LsWordArray(ls_scene.subgrids)
                            .at[LS_FIRST(objects.at[ray.object].first_subgrid) + subgrid];
            }
        }
        if (any(lessThan(cell, low)) || any(greaterThanEqual(cell, high)))
        {
            return false;
        }
    }
    ls_cut = true;
    return false;
}

// Traces a ray that is in its object's space. True if it may end.
bool ls_trace_object(inout LsLocalRay ray, inout LsBest best)
{
    if (LS_METHOD == LS_METHOD_EXACT && LS_HAS_GRIDS != 0u &&
        (LS_HAS_LISTS == 0u ||
         LsObjectArray(ls_scene.objects).at[ray.object].kind == LS_OBJECT_GRID))
    {
        return ls_walk_grid(ray, best);
    }
    return ls_test_all(ray, best);
}

// A coordinate of a point and of a direction in object space; SPEC 7.2.
float ls_carry_point(vec4 row, vec3 o)
{
    precise float p = ((row.x * o.x + row.y * o.y) + row.z * o.z) + row.w;
    return p;
}

float ls_carry_way(vec4 row, vec3 d)
{
    precise float q = (row.x * d.x + row.y * d.y) + row.z * d.z;
    return q;
}

// Carries a scaled ray into the space of an instance. False if it misses it.
bool ls_carry_ray(LsRay ray, uint index, float tmax, uint flags, out LsLocalRay local)
{
    LsInstanceArray instances = LsInstanceArray(ls_scene.instances);
    local.origin = ray.origin;
    local.direction = ray.direction;
    local.instance = index;
    local.object = LS_FIRST(instances.at[index].object);
    local.flags = flags;
    local.mirrored = false;
    uint kind = LS_HAS_TOP_LEVEL != 0u ? instances.at[index].flags : LS_INSTANCE_IDENTITY;
    if ((kind & LS_INSTANCE_IDENTITY) == 0u)
    {
        vec3 o = ray.origin;
        vec3 d = ray.direction;
        vec4 row_x = instances.at[index].object_from_world[0];
        vec4 row_y = instances.at[index].object_from_world[1];
        vec4 row_z = instances.at[index].object_from_world[2];
        local.origin = vec3(ls_carry_point(row_x, o), ls_carry_point(row_y, o),
                            ls_carry_point(row_z, o));
        local.direction = vec3(ls_carry_way(row_x, d), ls_carry_way(row_y, d),
                               ls_carry_way(row_z, d));
        if (!ls_is_finite(local.origin) || !ls_is_direction(local.direction))
        {
            return false;
        }
        local.mirrored = (kind & LS_INSTANCE_MIRRORED) != 0u;
    }
    return ls_local_ray_finish(local, ray.tmin, tmax);
}

// Carries a scaled ray into an instance and traces it there. True if the ray may end.
bool ls_trace_instance(LsRay ray, inout LsBest best, uint index, uint mask, uint flags)
{
    if ((LsInstanceArray(ls_scene.instances).at[index].mask & mask) == 0u)
    {
        return false;
    }
    LsLocalRay local;
    return ls_carry_ray(ray, index, best.t, flags, local) && ls_trace_object(local, best);
}

// The triangle of the last ls_trace_ray: its index into the object's part of TRIANGLES, or LS_NONE.
uint ls_hit_triangle;

// Traces one ray; SPEC chapter 7. `mask` selects instances (0xFF: all), `flags` are LS_RAY_FLAG_*.
LsHit ls_trace_ray(LsRay ray, uint mask, uint flags)
{
    ls_cut = false;
    bool legal = ls_ray_is_legal(ray);
    float scale = ls_scale_ray(ray);
    LsBest best = LsBest(ray.tmax, LS_NONE, LS_NONE);
    if (legal && LS_HAS_TOP_LEVEL == 0u)
    {
        ls_trace_instance(ray, best, 0u, mask, flags);
    }
    else if (legal && LS_METHOD == LS_METHOD_BRUTE)
    {
        bool done = false;
        uint i = 0u;
        for (; i < ls_scene.instance_count && !done; i++)
        {
            done = ls_trace_instance(ray, best, i, mask, flags);
        }
        ls_cut = ls_cut || (int(i - ls_scene.instance_count) < 0 && !done);
    }
    else if (legal)
    {
        // Boxes grow with the ray's origin, whose rounding in object space grows with it; SPEC 7.3.
        LsBvhNodeArray nodes = LsBvhNodeArray(ls_scene.top_nodes);
        vec3 inverse = ls_inverse_direction(ray.direction);
        float pad = ls_scene.transform_bound * ls_max_component(abs(ray.origin));
        uint node_count = nodes.at[0].escape;
        bool done = false;
        uint i = 0u;
        while (i < node_count && !done)
        {
            LsBvhNode node = nodes.at[i];
            bool met = ls_meets_box(ray.origin, inverse, node.lower - pad, node.upper + pad,
                                    ray.tmin, best.t);
            if (met && node.leaf != 0u)
            {
                done = ls_trace_instance(ray, best, node.leaf >> 4, mask, flags);
            }
            i = met ? i + 1u : node.escape;
        }
        ls_cut = ls_cut || (int(i - node_count) < 0 && !done);
    }

    ls_hit_triangle = best.triangle;
    LsHit hit;
    bool any = (flags & LS_RAY_FLAG_ANY_HIT) != 0u;
    bool found = best.instance != LS_NONE;
    hit.t = found ? (any ? 0.0 : best.t * ls_exact_inverse(scale)) : -1.0;
    hit.u = 0.0;
    hit.v = 0.0;
    hit.instance = best.instance;
    hit.object = LS_NONE;
    hit.primitive = LS_NONE;
    hit.material = LS_NONE;
    if (found)
    {
        LsLocalRay local;
        ls_carry_ray(ray, best.instance, best.t, flags, local);
        uint index = local.first_triangle + best.triangle;
        hit.object = local.object;
        hit.primitive = LsTriangleArray(ls_scene.triangles).at[index].primitive;
        hit.material = LsTriangleArray(ls_scene.triangles).at[index].material;
        if (!any)
        {
            vec2 weights = ls_hit_weights(local, index);
            hit.u = weights.x;
            hit.v = weights.y;
        }
    }
    hit.flags = ls_cut ? LS_HIT_CUT : 0u;
    return hit;
}

#endif
