// trace_lockstep.comp.glsl - scenes with one grid on llvmpipe: lists and grid in one kernel.
//
// llvmpipe never skips code: lanes run both sides of a branch, a loop's body runs once even if
// nobody wants it and then until the last lane is done. So a subgroup, which is a group, takes many
// rays: first all of them through the lists, such as walls and lights, with all lanes at the same
// triangle; then those that meet the grid from a queue in shared memory, from which lanes take
// another when their ray has ended. A lane walks one voxel ahead of its tests. See
// trace_lists.comp.glsl and trace_grid.comp.glsl for what GPUs do.

#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "ls_layout.h"

layout(local_size_x_id = LS_CONSTANT_GROUP_SIZE) in;
layout(constant_id = LS_CONSTANT_LANE_RAYS) const uint LS_LANE_RAYS = LS_MAX_LANE_RAYS;

layout(push_constant, std430) uniform Push
{
    LsLockstepParams params;
};

#define LS_TEXELS
#define ls_scene params
#include "scene.glsl"

// The instance that all lanes look at, and its object. Lanes hold one each and pass it round.
LsInstance instance_at_hand;
LsObject object_at_hand;
#undef LS_FIND_INSTANCE
#define LS_FIND_INSTANCE(name, index) LsInstance name = instance_at_hand
#undef LS_FIND_OBJECT
#define LS_FIND_OBJECT(name, index) LsObject name = object_at_hand

#include "batch.glsl"
#include "instance.glsl"
#include "walk.glsl"

#define LANES gl_WorkGroupSize.x
const uint FEWEST_IDLE = (3u * LANES) / 8u; // lanes that wait before they take rays together

// Rays that go on into the grid.
shared vec4 queue_origins[LANES * LS_LANE_RAYS];    // and smin
shared vec4 queue_directions[LANES * LS_LANE_RAYS]; // and smax
shared vec2 queue_rest[LANES * LS_LANE_RAYS];       // s0, and a word

// Bits of the word: 0..7 and 8..15 exponents of both scales, 16: a hit of equal t is better,
// from 20 on its number in the group.
#define WORD_WINS_TIES (1u << 16)
#define WORD_NUMBER 20

bool takes_any()
{
    return (params.flags & LS_RAY_FLAG_ANY_HIT) != 0u;
}

// Lanes before this one whose bit is set.
uint count_before(uint lanes)
{
    return bitCount(lanes & ((1u << gl_SubgroupInvocationID) - 1u));
}

void look_at(LsInstance own_instance, LsObject own_object, uint index)
{
    instance_at_hand.object_from_world[0] =
        subgroupShuffle(own_instance.object_from_world[0], index);
    instance_at_hand.object_from_world[1] =
        subgroupShuffle(own_instance.object_from_world[1], index);
    instance_at_hand.object_from_world[2] =
        subgroupShuffle(own_instance.object_from_world[2], index);
    instance_at_hand.object = subgroupShuffle(own_instance.object, index);
    instance_at_hand.mask = subgroupShuffle(own_instance.mask, index);
    instance_at_hand.flags = subgroupShuffle(own_instance.flags, index);
    object_at_hand.lower = subgroupShuffle(own_object.lower, index);
    object_at_hand.upper = subgroupShuffle(own_object.upper, index);
    object_at_hand.reach = subgroupShuffle(own_object.reach, index);
    object_at_hand.first_triangle = subgroupShuffle(own_object.first_triangle, index);
    object_at_hand.triangle_count = subgroupShuffle(own_object.triangle_count, index);
}

// Tests the triangles of the list at hand, which lanes load together and pass round, for the lanes
// that `take_part`; all lanes come here. True if the ray may end.
bool test_list(inout LsLocalRay ray, bool takes_part, inout LsBest best)
{
    bool done = false;
    uint count = object_at_hand.triangle_count;
    uint begin = object_at_hand.first_triangle;
    for (uint first = 0u; first < count; first += LANES)
    {
        uint end = min(count - first, LANES);
        LsTriangle own =
            ls_fetch_triangle(begin + first + min(gl_SubgroupInvocationID, end - 1u));
        uint left = 0u;
        for (uint i = 0u; i < end; i++)
        {
            vec3 v0 = subgroupShuffle(own.v0, i);
            vec3 v1 = subgroupShuffle(own.v1, i);
            vec3 v2 = subgroupShuffle(own.v2, i);
            left |= ls_may_meet(ls_project_corners(ray, v0, v1, v2)) ? 1u << i : 0u;
        }
        left = takes_part && !done ? left : 0u;
        while (left != 0u)
        {
            uint bit = uint(findLSB(left));
            left &= left - 1u;
            if (ls_test_triangle(ray, best, first + bit))
            {
                done = true;
                left = 0u;
            }
        }
    }
    return done;
}

// The one grid of the scene: its parts of all arrays begin at 0, since lists have none.
LsGrid get_grid()
{
    return LsGrid(params.grid_lower, params.inverse_cell,
                  uvec3(params.cells[0], params.cells[1], params.cells[2]), 0u, 0u, 0u, 0u, 0u, 0u,
                  0u, 0u, 0u);
}

// A lane's ray in the grid.
struct Traced
{
    LsLocalRay ray;
    uint word;
    LsWalk walk;  // its mask: what waits to be tested in the voxel ahead
    bool walks;
    float s_ahead; // where that voxel is entered
    uint first_reference;
    uint mask;     // the tests of the voxel at hand
    uint triangle; // of the best hit, LS_NONE: none in the grid
    uint primitive;
    vec2 weights;
};

// Takes ray `slot` of the queue.
void begin(uint slot, inout Traced traced)
{
    vec4 origin = queue_origins[slot];
    vec4 direction = queue_directions[slot];
    vec2 rest = queue_rest[slot];
    traced.ray.origin = origin.xyz;
    traced.ray.smin = origin.w;
    traced.ray.direction = direction.xyz;
    traced.ray.smax = direction.w;
    traced.ray.s0 = rest.x;
    traced.word = floatBitsToUint(rest.y);
    traced.ray.major = ls_max_axis(abs(traced.ray.direction));
    traced.ray.pivot = ls_permute(traced.ray.origin, traced.ray.major);
    traced.ray.sheared = ls_permute(traced.ray.direction, traced.ray.major);
    traced.walks = ls_walk_begin(get_grid(), traced.ray, traced.walk);
}

uint ray_index(uint word)
{
    return gl_WorkGroupID.x * LANES * LS_LANE_RAYS + (word >> WORD_NUMBER);
}

// Writes the hit of a ray that has ended, if it lies in the grid; else what lists gave stands.
void finish(inout Traced traced)
{
    if (traced.triangle == LS_NONE)
    {
        return;
    }
    float scale = uintBitsToFloat((traced.word & 0xFFu) << 23);
    float local_scale = uintBitsToFloat(((traced.word >> 8) & 0xFFu) << 23);
    LS_FIND_TRIANGLE(triangles, params.first_triangle + traced.triangle);
    LsHit hit;
    hit.t = takes_any() ? 0.0
                        : traced.ray.smax * ls_exact_inverse(local_scale) * ls_exact_inverse(scale);
    hit.u = takes_any() ? 0.0 : traced.weights.x;
    hit.v = takes_any() ? 0.0 : traced.weights.y;
    hit.instance = params.grid_instance;
    hit.object = params.grid_object;
    hit.primitive = traced.primitive;
    hit.material = triangles.material;
    hit.flags = 0u;
    HitArray(params.hits).at[ray_index(traced.word)] = hit;
    traced.triangle = LS_NONE;
}

// Tests the next triangle of the voxel at hand.
void test_next(inout Traced traced)
{
    uint bit = uint(findLSB(traced.mask));
    traced.mask &= traced.mask - 1u;
    uint number = LS_LOAD_WORD(references, traced.first_reference + bit);
    LS_FIND_TRIANGLE(triangles, params.first_triangle + number);
    LsProjection p = ls_project_corners(traced.ray, triangles.v0, triangles.v1, triangles.v2);
    float depth = traced.ray.sheared.z;
    bool mirrored = (params.flags & LS_GRID_MIRRORED) != 0u;
    float s;
    if (!ls_may_meet(p) || !ls_meet(p, depth, traced.ray.s0, s) ||
        !(s > traced.ray.smin && s <= traced.ray.smax) ||
        ls_is_culled(p, depth, mirrored, params.flags))
    {
        return;
    }
    bool wins_ties = traced.triangle == LS_NONE ? (traced.word & WORD_WINS_TIES) != 0u
                                                : triangles.primitive < traced.primitive;
    if (s == traced.ray.smax && !wins_ties)
    {
        return;
    }
    traced.ray.smax = s;
    traced.triangle = number;
    traced.primitive = triangles.primitive;
    traced.weights = ls_hit_weights(p);
    if (takes_any())
    {
        traced.walks = false;
        traced.walk.mask = 0u;
        traced.mask = 0u;
    }
}

// Traces the group's rays through the lists. Every ray has its hit so far afterwards, and those
// that meet the grid are in the queue; returns their number.
uint trace_lists()
{
    uint instance_count = params.instance_count;
    uint own = min(gl_SubgroupInvocationID, instance_count - 1u);
    LsInstance own_instance = ls_fetch_instance(own);
    LsObject own_object = ls_fetch_object(own_instance.object);
    LsGrid grid = get_grid();
    uint queued_count = 0u;
    uint base = gl_WorkGroupID.x * LANES * LS_LANE_RAYS;
    uint end = min(LANES * LS_LANE_RAYS, params.ray_count - base);
    for (uint first = 0u; first < end; first += LANES)
    {
        // All lanes trace, those behind the last ray the last again.
        uint number = first + gl_SubgroupInvocationID;
        uint index = base + number;
        bool is_ray = index < params.ray_count;
        index = min(index, params.ray_count - 1u);
        LsRay ray = RayArray(params.rays).at[index];
        uint mask = get_mask(params.masks, index);
        bool legal = ls_ray_is_legal(ray);
        float scale = ls_scale_ray(ray);
        LsBest best = LsBest(ray.tmax, LS_NONE, LS_NONE);
        ls_best_weights = vec2(0.0);
        bool done = !legal;
        for (uint i = 0u; i < instance_count; i++)
        {
            if (i != params.grid_instance)
            {
                look_at(own_instance, own_object, i);
                bool sees = (instance_at_hand.mask & mask) != 0u;
                LsLocalRay local;
                bool meets = ls_carry_ray(ray, i, best.t, params.flags, local);
                done = test_list(local, sees && meets && !done, best) || done;
            }
        }
        look_at(own_instance, own_object, params.grid_instance);
        bool sees = (instance_at_hand.mask & mask) != 0u;
        LsLocalRay local;
        LsWalk walk;
        bool goes_on = ls_carry_ray(ray, params.grid_instance, best.t, params.flags, local) &&
                       sees && !done && is_ray && ls_walk_begin(grid, local, walk);

        bool found = best.instance != LS_NONE;
        uint instance = found ? best.instance : 0u;
        uint object = subgroupShuffle(own_instance.object, instance);
        uint first_triangle = LS_FIRST(subgroupShuffle(own_object.first_triangle, instance));
        LS_FIND_TRIANGLE(triangles, first_triangle + (found ? best.triangle : 0u));
        bool any = takes_any();
        if (is_ray)
        {
            HitArray(params.hits).at[index] =
                LsHit(found ? (any ? 0.0 : best.t * ls_exact_inverse(scale)) : -1.0,
                      found && !any ? ls_best_weights.x : 0.0,
                      found && !any ? ls_best_weights.y : 0.0, best.instance,
                      found ? object : LS_NONE, found ? triangles.primitive : LS_NONE,
                      found ? triangles.material : LS_NONE, 0u);
        }

        uint going = subgroupBallot(goes_on).x;
        if (goes_on)
        {
            uint slot = queued_count + count_before(going);
            bool wins_ties = found && params.grid_instance < best.instance;
            uint word = (floatBitsToUint(scale) >> 23) | ((floatBitsToUint(local.scale) >> 23) << 8) |
                        (wins_ties ? WORD_WINS_TIES : 0u) | number << WORD_NUMBER;
            queue_origins[slot] = vec4(local.origin, local.smin);
            queue_directions[slot] = vec4(local.direction, local.smax);
            queue_rest[slot] = vec2(local.s0, uintBitsToFloat(word));
        }
        queued_count += bitCount(going);
    }
    subgroupMemoryBarrierShared();
    return queued_count;
}

// Marks the answers of rays that too many rounds went by for: those at hand and those from `next`
// on. trace.comp.glsl traces them once more.
void give_up(inout Traced traced, uint next, uint queued_count, uint idle_lanes)
{
    if ((idle_lanes >> gl_SubgroupInvocationID & 1u) != 0u)
    {
        finish(traced);
    }
    else
    {
        HitArray(params.hits).at[ray_index(traced.word)].flags = LS_HIT_CUT;
    }
    for (uint slot = next + gl_SubgroupInvocationID; slot < queued_count; slot += LANES)
    {
        uint waiting = floatBitsToUint(queue_rest[slot].y);
        HitArray(params.hits).at[ray_index(waiting)].flags = LS_HIT_CUT;
    }
    // And of each block the first, whose answer may be right, which tracing it once more does not
    // change.
    uint base = gl_WorkGroupID.x * LANES * LS_LANE_RAYS;
    uint end = min(base + LANES * LS_LANE_RAYS, params.ray_count);
    const uint BLOCK = LANES * LS_BLOCK_LANE_RAYS;
    for (uint index = base + gl_SubgroupInvocationID * BLOCK; index < end; index += LANES * BLOCK)
    {
        HitArray(params.hits).at[index].flags = LS_HIT_CUT;
    }
}

void main()
{
    uint queued_count = trace_lists();
    LsGrid grid = get_grid();
    Traced traced;
    traced.walk.mask = 0u;
    traced.walks = false;
    traced.s_ahead = 0.0;
    traced.first_reference = 0u;
    traced.mask = 0u;
    traced.triangle = LS_NONE;
    traced.primitive = 0u;
    traced.weights = vec2(0.0);
    uint next = 0u; // in the queue
    uint idle_lanes = 0xFFFFFFFFu >> (32u - LANES);
    uint round = 0u;
    bool drained = false;
    while (!drained && round < LS_LOCKSTEP_ROUNDS)
    {
        drained = next >= queued_count && bitCount(idle_lanes) == LANES;
        if ((idle_lanes >> gl_SubgroupInvocationID & 1u) != 0u)
        {
            finish(traced);
            uint slot = next + count_before(idle_lanes);
            if (slot < queued_count)
            {
                begin(slot, traced);
            }
        }
        next += bitCount(idle_lanes);
        uint fewest = next < queued_count ? FEWEST_IDLE : LANES;
        do
        {
            if (traced.walks && traced.walk.mask == 0u)
            {
                traced.walks = !ls_walk_is_over(grid, traced.ray, traced.walk);
                if (traced.walks)
                {
                    traced.s_ahead = traced.walk.s + traced.ray.s0;
                    ls_walk_step(grid, traced.ray, traced.walk);
                }
            }
            if (traced.mask == 0u)
            {
                traced.mask = traced.ray.smax < traced.s_ahead ? 0u : traced.walk.mask;
                traced.first_reference = traced.walk.first_reference;
                traced.walk.mask = 0u;
            }
            if (traced.mask != 0u)
            {
                test_next(traced);
            }
            bool idle = !traced.walks && (traced.mask | traced.walk.mask) == 0u;
            idle_lanes = subgroupBallot(idle).x;
            round++;
        } while (bitCount(idle_lanes) < fewest && round < LS_LOCKSTEP_ROUNDS);
    }
    if (!drained)
    {
        give_up(traced, next, queued_count, idle_lanes);
    }
}
