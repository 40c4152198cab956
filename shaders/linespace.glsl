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
// The pipeline must be specialized with ls_scene_segment_log2() as LS_CONSTANT_SEGMENT_LOG2 where
// that is not 0, and may be with the bits of ls_scene_features() as constants 1 and on, which
// leaves out what the scene does not use.
//
// The walk through the cells is walk.glsl, the triangle test triangle.glsl.

#ifndef LS_LINESPACE_GLSL
#define LS_LINESPACE_GLSL

#include "instance.glsl"
#include "walk.glsl"

// More rounds than a sound file can take.
const uint LS_MAX_ROUNDS = 1u << 24;

// Tests the references whose bit is set in `mask`. True if the ray may end.
bool ls_test_references(inout LsLocalRay ray, inout LsBest best, uint first_reference, uint mask)
{
    ls_work.z += bitCount(mask);
    uint left = LS_DEFERS != 0u ? 0u : mask;
    mask = LS_DEFERS != 0u ? mask : 0u;
    while (mask != 0u)
    {
        uint bit = uint(findLSB(mask));
        mask &= mask - 1u;
        uint index = ray.first_triangle + LS_LOAD_WORD(references, first_reference + bit);
        left |= ls_may_meet(ls_project(ray, index)) ? 1u << bit : 0u;
    }
    ls_cut = ls_cut || int(mask | (0u - mask)) < 0;
    while (left != 0u)
    {
        uint bit = uint(findLSB(left));
        left &= left - 1u;
        if (ls_test_triangle(ray, best, LS_LOAD_WORD(references, first_reference + bit)))
        {
            return true;
        }
    }
    ls_cut = ls_cut || int(left | (0u - left)) < 0;
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

// Brute force over an object, LS_BRUTE_ROUND triangles a round, to stay within llvmpipe's rounds.
bool ls_test_all(inout LsLocalRay ray, inout LsBest best, uint count)
{
    uint i = 0u;
    for (; i < count; i += LS_BRUTE_ROUND)
    {
        if (ls_test_four(ray, best, i, count - 1u) || ls_test_four(ray, best, i + 4u, count - 1u))
        {
            return true;
        }
    }
    ls_cut = ls_cut || int(i - count) < 0;
    return false;
}

LsGrid ls_load_grid(uint object)
{
    LS_FIND_OBJECT(objects, object);
    LsGrid grid;
    grid.lower = LS_FOUND(objects, object).grid_lower;
    grid.inverse_cell = LS_FOUND(objects, object).inverse_cell;
    grid.cells = uvec3(LS_FOUND(objects, object).cells[0], LS_FOUND(objects, object).cells[1],
                       LS_FOUND(objects, object).cells[2]);
    grid.first_block = LS_FIRST(LS_FOUND(objects, object).first_block);
    grid.first_cell_block = LS_FIRST(LS_FOUND(objects, object).first_cell_block);
    grid.first_voxel = LS_FIRST(LS_FOUND(objects, object).first_voxel);
    grid.first_reference = LS_FIRST(LS_FOUND(objects, object).first_reference);
    grid.first_shaft_word = LS_FIRST(LS_FOUND(objects, object).first_shaft_word);
    grid.first_leaf_node = LS_FIRST(LS_FOUND(objects, object).first_leaf_node);
    grid.first_subgrid = LS_FIRST(LS_FOUND(objects, object).first_subgrid);
    grid.first_subgrid_block =
        LS_FOUND(objects, object).cell_block_count - LS_FOUND(objects, object).subgrid_count;
    grid.scene_patches = LS_HAS_SCENE_SHAFTS != 0u ? LS_FOUND(objects, object).scene_patches : 0u;
    return grid;
}

// Walks the grid of an object. True if the ray may end.
bool ls_walk_grid(inout LsLocalRay ray, inout LsBest best)
{
    LsGrid grid = ls_load_grid(ray.object);
    LsWalk walk;
    bool over = !ls_walk_begin(grid, ray, walk);
    for (uint round = 0u; round < LS_MAX_ROUNDS && !over; round++)
    {
        ls_walk_step(grid, ray, walk);
        if (ls_test_references(ray, best, walk.first_reference, walk.mask))
        {
            return true;
        }
        over = ls_walk_is_over(grid, ray, walk);
    }
    ls_cut = ls_cut || !over;
    return false;
}

// Traces a ray that is in its object's space. True if it may end.
bool ls_trace_object(inout LsLocalRay ray, inout LsBest best)
{
    LS_FIND_OBJECT(objects, ray.object);
    uint count = LS_FOUND(objects, ray.object).triangle_count;
    bool has_grid =
        LS_HAS_GRIDS != 0u &&
        (LS_HAS_LISTS == 0u || LS_FOUND(objects, ray.object).kind == LS_OBJECT_GRID);
    if (LS_METHOD == LS_METHOD_BRUTE)
    {
        return ls_test_all(ray, best, count);
    }
    return has_grid ? ls_walk_grid(ray, best) : ls_test_list(ray, best, count);
}

// Carries a scaled ray into an instance and traces it there. True if the ray may end.
bool ls_trace_instance(LsRay ray, inout LsBest best, uint index, uint mask, uint flags)
{
    LS_FIND_INSTANCE(instances, index);
    if ((LS_FOUND(instances, index).mask & mask) == 0u)
    {
        return false;
    }
    LsLocalRay local;
    return ls_carry_ray(ray, index, best.t, flags, local) && ls_trace_object(local, best);
}

// What is told of the best hit of a scaled ray.
LsHit ls_make_hit(LsRay ray, LsBest best, float scale, uint flags)
{
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
        uint at = index;
        LS_FIND_TRIANGLE(triangles, at);
        hit.primitive = LS_FOUND(triangles, at).primitive;
        hit.material = LS_FOUND(triangles, at).material;
        if (!any)
        {
            vec2 weights = ls_hit_weights(ls_project(local, index));
            hit.u = weights.x;
            hit.v = weights.y;
        }
    }
    hit.flags = ls_cut ? LS_HIT_CUT : 0u;
    return hit;
}

// The triangle of the last ls_trace_ray: its index into the object's part of TRIANGLES, or LS_NONE.
uint ls_hit_triangle;

// Traces one ray; SPEC chapter 7. `mask` selects instances (0xFF: all), `flags` are LS_RAY_FLAG_*.
LsHit ls_trace_ray(LsRay ray, uint mask, uint flags)
{
    ls_cut = false;
    ls_work = uvec3(0u);
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
        LS_FIND_TOP_NODES(nodes);
        vec3 inverse = ls_inverse_direction(ray.direction);
        float pad = ls_scene.transform_bound * ls_max_component(abs(ray.origin));
        uint node_count = LS_LOAD_TOP_NODE(nodes, 0).escape;
        bool done = false;
        uint i = 0u;
        while (i < node_count && !done)
        {
            LsBvhNode node = LS_LOAD_TOP_NODE(nodes, i);
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
    return ls_make_hit(ray, best, scale, flags);
}

#endif
