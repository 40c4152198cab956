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

#include "ls_layout.h"

layout(local_size_x_id = LS_CONSTANT_GROUP_SIZE) in;

layout(push_constant, std430) uniform Push
{
    LsListParams params;
};

#define ls_scene params
#include "batch.glsl"
#include "carry.glsl"

LS_ARRAY(PassInstanceArray, LsPassInstance, 16);
LS_ARRAY(PairBoxArray, LsPairBox, 16);

const float LONG_WAY = 0.2; // longer ones through a box, in parts of its longest side, are long

// Carries a scaled ray into the space of an instance, whose number among LsPassInstance is in the
// order of instances. False if it misses it.
bool carry_ray(LsRay ray, uint number, float tmax, out LsLocalRay local)
{
    PassInstanceArray instances = PassInstanceArray(params.instances);
    uint kind = instances.at[number].flags;
    local.origin = ray.origin;
    local.direction = ray.direction;
    local.instance = number;
    local.first_triangle = instances.at[number].first_triangle;
    local.flags = params.flags;
    local.mirrored = (kind & LS_INSTANCE_MIRRORED) != 0u;
    if ((kind & LS_INSTANCE_IDENTITY) == 0u &&
        !ls_carry_by(ray, instances.at[number].object_from_world[0],
                     instances.at[number].object_from_world[1],
                     instances.at[number].object_from_world[2], local))
    {
        return false;
    }
    return ls_local_ray_finish(local, ray.tmin, tmax, instances.at[number].object_lower,
                               instances.at[number].object_upper, instances.at[number].reach);
}

// Whether a scaled ray that sees the instances of `mask` meets one before `tmax`; carries it there.
bool meets_instance(LsRay ray, uint number, uint mask, vec3 inverse, float pad, float tmax,
                    out LsLocalRay local)
{
    PassInstanceArray instances = PassInstanceArray(params.instances);
    return (instances.at[number].mask & mask) != 0u &&
           ls_meets_box(ray.origin, inverse, instances.at[number].lower - pad,
                        instances.at[number].upper + pad, ray.tmin, tmax) &&
           carry_ray(ray, number, tmax, local);
}

// Whether the way of a scaled ray through an instance's box is long.
bool has_long_way(LsRay ray, uint number, vec3 inverse, float pad, float tmax)
{
    PassInstanceArray instances = PassInstanceArray(params.instances);
    precise vec3 lower = instances.at[number].lower - pad;
    precise vec3 upper = instances.at[number].upper + pad;
    precise vec3 a = (lower - ray.origin) * inverse;
    precise vec3 b = (upper - ray.origin) * inverse;
    float t_enter = max(ls_max_component(min(a, b)), ray.tmin);
    float t_leave = min(ls_min_component(max(a, b)), tmax);
    return (t_leave - t_enter) * ls_max_component(abs(ray.direction)) >
           LONG_WAY * ls_max_component(upper - lower);
}

// Tests those of triangles `first` to `end` of a ray's list whose boxes it meets, the first of them
// being `first_box`. True if the ray may end. `inverse` and `origin`: of the ray's direction, and
// its origin from the object's lower corner times that.
bool test_boxed(inout LsLocalRay ray, inout LsBest best, uint first, uint end, uint first_box,
                vec3 inverse, vec3 origin)
{
    PairBoxArray boxes = PairBoxArray(params.boxes);
    float s_first = ray.smin - ray.s0;
    float s_limit = ray.s0 == 0.0 ? ray.smax : LS_INFINITY;
    uint met = 0u;
    uint pair = 0u;
    for (; first + 2u * pair < end; pair++)
    {
        vec3 a = boxes.at[first_box + pair].lower * inverse - origin;
        vec3 b = boxes.at[first_box + pair].upper * inverse - origin;
        // What is too large for a number is NaN, and met.
        bool missed =
            max(ls_max_component(min(a, b)), s_first) > min(ls_min_component(max(a, b)), s_limit);
        met |= missed ? 0u : 1u << pair;
    }
    ls_cut = ls_cut || int(first + 2u * pair - end) < 0;

    // The quick part of the tests for both triangles of a box at once, then the rest for those that
    // are left, which is one of two as a rule.
    uint left = 0u;
    while (met != 0u)
    {
        uint bit = 2u * uint(findLSB(met));
        met &= met - 1u;
        uint index = ray.first_triangle + first;
        uint other = min(bit + 1u, end - first - 1u);
        left |= ls_may_meet(ls_project(ray, index + bit)) ? 1u << bit : 0u;
        left |= ls_may_meet(ls_project(ray, index + other)) ? 1u << other : 0u;
    }
    ls_cut = ls_cut || int(met | (0u - met)) < 0;
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

// Traces a scaled ray through the lists; true if it may end.
bool trace_lists(LsRay ray, uint mask, vec3 inverse, float pad, inout LsBest best)
{
    PassInstanceArray instances = PassInstanceArray(params.instances);
    uint i = 0u;
    for (; i < params.list_count; i++)
    {
        LsLocalRay local;
        if (!meets_instance(ray, i, mask, inverse, pad, best.t, local))
        {
            continue;
        }
        bool is_same = (instances.at[i].flags & LS_INSTANCE_IDENTITY) != 0u;
        vec3 local_inverse = is_same ? inverse : ls_inverse_direction(local.direction);
        vec3 origin = (local.origin - instances.at[i].object_lower) * local_inverse;
        uint count = instances.at[i].triangle_count;
        uint first_box = instances.at[i].first_box;
        uint first = 0u;
        for (; first < count; first += 32u)
        {
            if (test_boxed(local, best, first, min(first + 32u, count), first_box + first / 2u,
                           local_inverse, origin))
            {
                return true;
            }
        }
        ls_cut = ls_cut || int(first - count) < 0;
    }
    ls_cut = ls_cut || int(i - params.list_count) < 0;
    return false;
}

LsHit make_hit(LsBest best, float scale)
{
    LsHit hit = LsHit(-1.0, 0.0, 0.0, LS_NONE, LS_NONE, LS_NONE, LS_NONE, ls_cut ? LS_HIT_CUT : 0u);
    if (best.instance != LS_NONE)
    {
        PassInstanceArray instances = PassInstanceArray(params.instances);
        bool any = (params.flags & LS_RAY_FLAG_ANY_HIT) != 0u;
        hit.t = any ? 0.0 : best.t * ls_exact_inverse(scale);
        hit.u = any ? 0.0 : ls_best_weights.x;
        hit.v = any ? 0.0 : ls_best_weights.y;
        hit.instance = instances.at[best.instance].instance;
        hit.object = instances.at[best.instance].object;
        uint index = instances.at[best.instance].first_triangle + best.triangle;
        LS_FIND_TRIANGLE(triangles, index);
        hit.primitive = triangles.at[index].primitive;
        hit.material = triangles.at[index].material;
    }
    return hit;
}

void main()
{
    Queue queue = Queue(params.queue);
    if (params.begins != 0u)
    {
        if (gl_GlobalInvocationID.x == 0u)
        {
            queue.head.counts[0] = 0u;
            queue.head.counts[1] = 0u;
            queue.head.capacity = params.ray_count;
            queue.head.next = 0u;
        }
        return;
    }
    bool has_ray = gl_GlobalInvocationID.x < params.ray_count;
    uint index = min(gl_GlobalInvocationID.x, params.ray_count - 1u);
    LsRay ray = RayArray(params.rays).at[index];
    uint mask = get_mask(params.masks, index);
    ls_cut = false;
    bool goes_on = has_ray && ls_ray_is_legal(ray);
    float scale = ls_scale_ray(ray);
    vec3 inverse = ls_inverse_direction(ray.direction);
    float pad = params.transform_bound * ls_max_component(abs(ray.origin));
    LsBest best = LsBest(ray.tmax, LS_NONE, LS_NONE);
    goes_on = goes_on && !trace_lists(ray, mask, inverse, pad, best);

    LsGridRay grid_ray;
    bool is_long = false;
    if (goes_on)
    {
        PassInstanceArray instances = PassInstanceArray(params.instances);
        LsLocalRay local;
        goes_on = meets_instance(ray, params.list_count, mask, inverse, pad, best.t, local);
        is_long = has_long_way(ray, params.list_count, inverse, pad, best.t);
        bool wins_ties = best.instance != LS_NONE && instances.at[params.list_count].instance <
                                                         instances.at[best.instance].instance;
        uint scales = (floatBitsToUint(scale) >> 23) | ((floatBitsToUint(local.scale) >> 23) << 8) |
                      (wins_ties ? 1u << 16 : 0u);
        grid_ray = LsGridRay(local.origin, local.smin, local.direction, local.smax, index, local.s0,
                             scales, 0u);
    }

    // One addition a subgroup to each count, by the first two lanes; two there are in any. While it
    // is on its way the hits are written.
    uvec4 going = subgroupBallot(goes_on);
    uvec4 going_far = subgroupBallot(goes_on && is_long);
    uint count = subgroupBallotBitCount(going);
    uint far_count = subgroupBallotBitCount(going_far);
    uint lane = gl_SubgroupInvocationID;
    uint first = 0u;
    if (lane < 2u && count != 0u)
    {
        first = atomicAdd(queue.head.counts[lane], lane == 0u ? far_count : count - far_count);
    }
    if (has_ray)
    {
        store_hit(params.hits, index, make_hit(best, scale));
    }
    first = subgroupShuffle(first, is_long ? 0u : 1u);
    if (goes_on)
    {
        uint far_before = subgroupBallotExclusiveBitCount(going_far);
        uint before = subgroupBallotExclusiveBitCount(going) - far_before;
        store_queued(params.queue,
                     is_long ? first + far_before : params.ray_count - 1u - (first + before),
                     grid_ray);
    }
}
