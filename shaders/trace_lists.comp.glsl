// trace_lists.comp.glsl - first pass over scenes with one grid: each ray through the lists, such as walls and
// lights, and those that meet the grid's box into a queue. Every ray has its hit so far afterwards.
//
// Lists and grid in one kernel make every lane wait for those that walk the grid; here the lanes of a subgroup
// do the same work, and in trace_grid.comp.glsl all of them walk.

#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_ballot : require

#include "ls_layout.h"

layout(local_size_x_id = LS_CONSTANT_GROUP_SIZE) in;

layout(push_constant, std430) uniform Push
{
    LsListParams params;
};

#define ls_scene params
#include "batch.glsl"
#include "instance.glsl"

bool sees(uint instance, uint mask)
{
    return (LsInstanceArray(params.instances).at[instance].mask & mask) != 0u;
}

// Traces a scaled ray through the instances that are lists; true if it may end. All lanes look at the same node at
// a time: scenes of one grid have few. Tells whether the ray meets the grid's box.
bool trace_lists(LsRay ray, uint mask, inout LsBest best, out bool meets_grid)
{
    meets_grid = params.top_node_count == 0u && sees(params.grid_instance, mask);
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
        if (sees(instance, mask) &&
            ls_meets_box(ray.origin, inverse, node.lower - pad, node.upper + pad, ray.tmin,
                         best.t) &&
            ls_carry_ray(ray, instance, best.t, params.flags, local))
        {
            uint count = LsObjectArray(params.objects).at[local.object].triangle_count;
            if (ls_test_list(local, best, count))
            {
                return true;
            }
        }
    }
    ls_cut = ls_cut || int(i - params.top_node_count) < 0;
    if (grid_node != LS_NONE && sees(params.grid_instance, mask))
    {
        LsBvhNode node = nodes.at[grid_node];
        meets_grid =
            ls_meets_box(ray.origin, inverse, node.lower - pad, node.upper + pad, ray.tmin, best.t);
    }
    return false;
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
        LsTriangleArray triangles = ls_find_triangle(ls_scene.triangles, index);
        hit.primitive = triangles.at[index].primitive;
        hit.material = triangles.at[index].material;
    }
    return hit;
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    Queue queue = Queue(params.queue);
    if (params.ray_count == 0u)
    {
        if (index == 0u)
        {
            queue.head.count = 0u;
            queue.head.next = 0u;
        }
        return;
    }
    bool goes_on = false;
    LsGridRay grid_ray;
    if (index < params.ray_count)
    {
        LsRay ray = RayArray(params.rays).at[index];
        uint mask = get_mask(params.masks, index);
        ls_cut = false;
        bool legal = ls_ray_is_legal(ray);
        float scale = ls_scale_ray(ray);
        LsBest best = LsBest(ray.tmax, LS_NONE, LS_NONE);
        if (legal && !trace_lists(ray, mask, best, goes_on) && goes_on)
        {
            LsLocalRay local;
            goes_on = ls_carry_ray(ray, params.grid_instance, best.t, params.flags, local);
            bool wins_ties = best.instance != LS_NONE && params.grid_instance < best.instance;
            grid_ray.origin = local.origin;
            grid_ray.smin = local.smin;
            grid_ray.direction = local.direction;
            grid_ray.smax = local.smax;
            grid_ray.index = index;
            grid_ray.s0 = local.s0;
            grid_ray.scales = (floatBitsToUint(scale) >> 23) |
                              ((floatBitsToUint(local.scale) >> 23) << 8) |
                              (wins_ties ? 1u << 16 : 0u);
            grid_ray.reserved = 0u;
        }
        else
        {
            goes_on = false;
        }
        HitArray(params.hits).at[index] = make_hit(best, scale);
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
        queue.rays[first + subgroupBallotExclusiveBitCount(going)] = grid_ray;
    }
}
