// trace_lists.comp.glsl - first pass over scenes with one grid: each ray through the lists, such as
// walls and lights, and those that meet the grid's box into a queue. Every ray has its hit so far
// afterwards.
//
// Lists and grid in one kernel make every lane wait for those that walk the grid; here the lanes of
// a subgroup do the same work, and in trace_grid.comp.glsl all of them walk. Of a list each ray
// tests only those triangles whose boxes it meets, two to a box, as a wall is two triangles. A
// group is one subgroup, of at most 32 lanes.

#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require

#include "ls_layout.h"

layout(local_size_x_id = LS_CONSTANT_GROUP_SIZE) in;

layout(push_constant, std430) uniform Push
{
    LsListParams params;
};

#define ls_scene params
#include "batch.glsl"
#include "instance.glsl"

#define LANES gl_WorkGroupSize.x

// Boxes of the pairs of triangles that are looked at, from the lower corner of their object's box.
shared vec3 lowers[LANES / 2u];
shared vec3 uppers[LANES / 2u];

// How far boxes grow, as a part of an object's `reach`, which is twice its longest side: what
// rounding can do to boxes, rays and tests is a third of it (docs/exactness.md).
const float GROWTH = 7.62939453125e-06; // 2^-17

bool sees(uint instance, uint mask)
{
    return (LsInstanceArray(params.instances).at[instance].mask & mask) != 0u;
}

// The boxes of triangles `first` to `first` + LANES of a list. All lanes come here.
void make_boxes(uint object, uint first)
{
    LsObjectArray objects = LsObjectArray(params.objects);
    uint last = objects.at[object].triangle_count - 1u;
    uint index = objects.at[object].first_triangle + min(first + gl_SubgroupInvocationID, last);
    LS_FIND_TRIANGLE(triangles, index);
    vec3 v0 = triangles.at[index].v0;
    vec3 v1 = triangles.at[index].v1;
    vec3 v2 = triangles.at[index].v2;
    vec3 lower = min(min(v0, v1), v2);
    vec3 upper = max(max(v0, v1), v2);
    lower = min(lower, subgroupShuffleXor(lower, 1u));
    upper = max(upper, subgroupShuffleXor(upper, 1u));
    float growth = objects.at[object].reach * GROWTH;
    subgroupBarrier();
    if ((gl_SubgroupInvocationID & 1u) == 0u)
    {
        // First the corner: growth may be less than what coordinates far from 0 can tell apart.
        precise vec3 lower_grown = (lower - objects.at[object].lower) - growth;
        precise vec3 upper_grown = (upper - objects.at[object].lower) + growth;
        lowers[gl_SubgroupInvocationID >> 1] = lower_grown;
        uppers[gl_SubgroupInvocationID >> 1] = upper_grown;
    }
    subgroupBarrier();
}

// Tests those of triangles `first` to `end` of a ray's list whose boxes it meets. True if the ray
// may end.
bool test_boxed(inout LsLocalRay ray, inout LsBest best, uint first, uint end)
{
    vec3 inverse = ls_inverse_direction(ray.direction);
    vec3 origin = (ray.origin - LsObjectArray(params.objects).at[ray.object].lower) * inverse;
    float s_first = ray.smin - ray.s0;
    float s_limit = ray.s0 == 0.0 ? ray.smax : LS_INFINITY;
    uint left = 0u;
    for (uint pair = 0u; first + 2u * pair < end; pair++)
    {
        vec3 a = lowers[pair] * inverse - origin;
        vec3 b = uppers[pair] * inverse - origin;
        // What is too large for a number is NaN, and met.
        bool missed = max(ls_max_component(min(a, b)), s_first) >
                      min(ls_min_component(max(a, b)), s_limit);
        left |= missed ? 0u : 3u << (2u * pair);
    }
    left &= 0xFFFFFFFFu >> (32u - min(end - first, 32u));
    while (left != 0u)
    {
        uint bit = uint(findLSB(left));
        left &= left - 1u;
        if (ls_test_triangle(ray, best, first + bit))
        {
            return true;
        }
    }
    ls_cut = ls_cut || int(left | (0u - left)) < 0;
    return false;
}

// Traces a scaled ray through the instances that are lists, unless it is `done`; true if it is done
// then. All lanes look at the same node at a time: scenes of one grid have few. Tells whether the
// ray meets the grid's box.
bool trace_lists(LsRay ray, uint mask, bool done, inout LsBest best, out bool meets_grid)
{
    LsBvhNodeArray nodes = LsBvhNodeArray(params.top_nodes);
    vec3 inverse = ls_inverse_direction(ray.direction);
    float pad = params.transform_bound * ls_max_component(abs(ray.origin));
    uint grid_node = LS_NONE;
    uint i = 0u;
    for (; i < params.top_node_count; i++)
    {
        LsBvhNode node = nodes.at[i];
        uint instance = node.leaf >> 4;
        if (node.leaf == 0u)
        {
            continue;
        }
        if (instance == params.grid_instance)
        {
            grid_node = i;
            continue;
        }
        LsLocalRay local;
        bool meets = !done && sees(instance, mask) &&
                     ls_meets_box(ray.origin, inverse, node.lower - pad, node.upper + pad, ray.tmin,
                                  best.t) &&
                     ls_carry_ray(ray, instance, best.t, params.flags, local);
        if (!subgroupAny(meets))
        {
            continue;
        }
        uint object = LsInstanceArray(params.instances).at[instance].object;
        uint count = LsObjectArray(params.objects).at[object].triangle_count;
        for (uint first = 0u; first < count; first += LANES)
        {
            make_boxes(object, first);
            if (meets && !done)
            {
                done = test_boxed(local, best, first, min(first + LANES, count));
            }
        }
    }
    ls_cut = ls_cut || int(i - params.top_node_count) < 0;
    meets_grid = params.top_node_count == 0u && sees(params.grid_instance, mask);
    if (grid_node != LS_NONE && sees(params.grid_instance, mask))
    {
        LsBvhNode node = nodes.at[grid_node];
        meets_grid =
            ls_meets_box(ray.origin, inverse, node.lower - pad, node.upper + pad, ray.tmin, best.t);
    }
    return done;
}

LsHit make_hit(LsBest best, float scale)
{
    LsHit hit = LsHit(-1.0, 0.0, 0.0, LS_NONE, LS_NONE, LS_NONE, LS_NONE, ls_cut ? LS_HIT_CUT : 0u);
    if (best.instance != LS_NONE)
    {
        bool any = (params.flags & LS_RAY_FLAG_ANY_HIT) != 0u;
        hit.t = any ? 0.0 : best.t * ls_exact_inverse(scale);
        hit.u = any ? 0.0 : ls_best_weights.x;
        hit.v = any ? 0.0 : ls_best_weights.y;
        hit.instance = best.instance;
        hit.object = LsInstanceArray(params.instances).at[best.instance].object;
        uint index = LsObjectArray(params.objects).at[hit.object].first_triangle + best.triangle;
        LS_FIND_TRIANGLE(triangles, index);
        hit.primitive = triangles.at[index].primitive;
        hit.material = triangles.at[index].material;
    }
    return hit;
}

void main()
{
    Queue queue = Queue(params.queue);
    if (params.ray_count == 0u)
    {
        if (gl_GlobalInvocationID.x == 0u)
        {
            queue.head.count = 0u;
            queue.head.next = 0u;
        }
        return;
    }
    // Lanes beyond the last ray take it once more, since all are needed to look at lists.
    bool has_ray = gl_GlobalInvocationID.x < params.ray_count;
    uint index = min(gl_GlobalInvocationID.x, params.ray_count - 1u);
    LsRay ray = RayArray(params.rays).at[index];
    ls_cut = false;
    bool is_legal = ls_ray_is_legal(ray);
    float scale = ls_scale_ray(ray);
    LsBest best = LsBest(ray.tmax, LS_NONE, LS_NONE);
    bool goes_on;
    bool done =
        trace_lists(ray, get_mask(params.masks, index), !has_ray || !is_legal, best, goes_on);
    LsGridRay grid_ray;
    goes_on = goes_on && !done;
    if (goes_on)
    {
        LsLocalRay local;
        goes_on = ls_carry_ray(ray, params.grid_instance, best.t, params.flags, local);
        bool wins_ties = best.instance != LS_NONE && params.grid_instance < best.instance;
        uint scales = (floatBitsToUint(scale) >> 23) | ((floatBitsToUint(local.scale) >> 23) << 8) |
                      (wins_ties ? 1u << 16 : 0u);
        grid_ray = LsGridRay(local.origin, local.smin, local.direction, local.smax, index, local.s0,
                             scales, 0u);
    }
    if (has_ray)
    {
        store_hit(params.hits, index, make_hit(best, scale));
    }

    // One addition a subgroup.
    uvec4 going = subgroupBallot(goes_on);
    uint count = subgroupBallotBitCount(going);
    uint first = 0u;
    if (count != 0u && subgroupElect())
    {
        first = atomicAdd(queue.head.count, count);
    }
    first = subgroupBroadcastFirst(first);
    if (goes_on)
    {
        store_queued(params.queue, first + subgroupBallotExclusiveBitCount(going), grid_ray);
    }
}
