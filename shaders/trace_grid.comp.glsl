// trace_grid.comp.glsl - second pass over scenes with one grid: the queued rays through it.
//
// Lanes walk until enough triangles wait to be tested. Then all lanes of the subgroup share the
// tests, a pair of ray and triangle each, whichever ray it belongs to; owners collect what was
// found. So neither long walks nor long lists leave the other lanes idle for long. A lane whose ray
// has ended takes the next one from the queue (T. Aila, S. Laine, "Understanding the Efficiency of
// Ray Traversal on GPUs", HPG 2009), unless LS_REFILL is 0, for devices that bound the rounds of
// loops. Some rays meet many times more cells than others, and a batch ends with its last ray: when
// the queue is empty, lanes without a ray take half of the way that another still has before it,
// again and again. A group is one subgroup, of at most 32 lanes.

#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require

#include "ls_layout.h"

layout(local_size_x_id = LS_CONSTANT_GROUP_SIZE) in;
layout(constant_id = LS_CONSTANT_REFILL) const uint LS_REFILL = 1;

layout(push_constant, std430) uniform Push
{
    LsGridParams params;
};

#define ls_scene params
#include "batch.glsl"
#include "walk.glsl"

#define LANES gl_WorkGroupSize.x
const uint FEWEST_IDLE = LANES * 3u / 8u;  // lanes that wait before they fetch rays or parts
const uint FEWEST_PAIRS = LANES * 3u / 4u; // tests that wait before they are done
const uint FEWEST_STEPS = 4u;              // between one division and the next
const float FEWEST_CELLS = 2.0;            // that lie before a ray if its way is divided

// What testing needs of the ray of each lane: pivot and major, sheared and s0.
shared vec4 pivots[LANES];
shared vec4 sheareds[LANES];
shared uint notes[LANES]; // what lanes tell each other

LsLocalRay load_testing_ray(uint lane)
{
    LsLocalRay ray;
    ray.pivot = pivots[lane].xyz;
    ray.major = floatBitsToUint(pivots[lane].w);
    ray.sheared = sheareds[lane].xyz;
    ray.s0 = sheareds[lane].w;
    return ray;
}

// A lane's ray, or the part of one, and the best hit in the grid.
struct Traced
{
    LsLocalRay ray;
    uint index;
    uint scales;
    uint triangle; // LS_NONE: none in the grid
    uint owner;    // the lane that writes the ray's hit; LS_NONE: the lane has no ray
    float s_end;   // cells entered behind it are another lane's
};

// The one grid of the scene: its parts of all arrays begin at 0, since lists have none.
LsGrid get_grid()
{
    return LsGrid(params.grid_lower, params.inverse_cell,
                  uvec3(params.cells[0], params.cells[1], params.cells[2]), 0u, 0u, 0u, 0u, 0u, 0u,
                  0u, params.first_subgrid_block,
                  (params.flags >> LS_GRID_SCENE_PATCHES) & 0xFFu);
}

bool takes_any()
{
    return (params.flags & LS_RAY_FLAG_ANY_HIT) != 0u;
}

// Takes ray `slot` of the queue. False if it misses the grid after all.
bool begin(uint slot, inout Traced traced, inout LsWalk walk)
{
    LsGridRay queued = Queue(params.queue).rays[slot];
    traced.ray.origin = queued.origin;
    traced.ray.smin = queued.smin;
    traced.ray.direction = queued.direction;
    traced.ray.smax = queued.smax;
    traced.ray.s0 = queued.s0;
    traced.index = queued.index;
    traced.scales = queued.scales;
    traced.triangle = LS_NONE;
    traced.owner = gl_SubgroupInvocationID;
    traced.s_end = LS_INFINITY;
    uint major = ls_max_axis(abs(queued.direction));
    pivots[gl_SubgroupInvocationID] =
        vec4(ls_permute(queued.origin, major), uintBitsToFloat(major));
    sheareds[gl_SubgroupInvocationID] = vec4(ls_permute(queued.direction, major), queued.s0);
    return ls_walk_begin(get_grid(), traced.ray, walk);
}

// Writes the hit of a ray that has ended, if it lies in the grid; else what the first pass wrote
// stands.
void finish(inout Traced traced)
{
    if (traced.triangle == LS_NONE)
    {
        return;
    }
    uint index = params.first_triangle + traced.triangle;
    float scale = uintBitsToFloat((traced.scales & 0xFFu) << 23);
    float local_scale = uintBitsToFloat(((traced.scales >> 8) & 0xFFu) << 23);
    vec2 weights = ls_hit_weights(ls_project(load_testing_ray(gl_SubgroupInvocationID), index));
    LsHit hit;
    hit.t = takes_any() ? 0.0
                        : traced.ray.smax * ls_exact_inverse(local_scale) * ls_exact_inverse(scale);
    hit.u = takes_any() ? 0.0 : weights.x;
    hit.v = takes_any() ? 0.0 : weights.y;
    hit.instance = params.instance;
    hit.object = params.object;
    LsTriangleArray triangles = ls_find_triangle(ls_scene.triangles, index);
    hit.primitive = triangles.at[index].primitive;
    hit.material = triangles.at[index].material;
    hit.flags = 0u;
    store_hit(params.hits, traced.index, hit);
    traced.triangle = LS_NONE;
}

// Keeps a hit that is better than the best. True if the ray may end.
bool keep(inout Traced traced, float s, uint triangle)
{
    if (!(s > traced.ray.smin && s <= traced.ray.smax))
    {
        return false;
    }
    if (s == traced.ray.smax)
    {
        bool wins =
            traced.triangle == LS_NONE
                ? (traced.scales & 1u << 16) != 0u
                : ls_load_primitive(params.first_triangle + triangle) <
                      ls_load_primitive(params.first_triangle + traced.triangle);
        if (!wins)
        {
            return false;
        }
    }
    traced.ray.smax = s;
    traced.triangle = triangle;
    return takes_any();
}

// Does as many of the waiting tests as there are lanes: those of `pending`, whose bit k stands for
// reference k from `first_reference` on, in the order of lanes and bits. Takes their bits away; all
// lanes come here together, `pair_count` is the sum of their bits. True if the lane's ray may end.
bool share_tests(inout Traced traced, inout uint pending, uint first_reference, uint pair_count)
{
    uint lane = gl_SubgroupInvocationID;
    uint end = subgroupInclusiveAdd(bitCount(pending));
    uint begin = end - bitCount(pending);

    // The pair of this lane: its owner is the first lane whose pairs end behind it.
    uint owner = 0u;
    for (uint step = LANES / 2u; step > 0u; step >>= 1)
    {
        owner += subgroupShuffle(end, owner + step - 1u) <= lane ? step : 0u;
    }
    uint mask = subgroupShuffle(pending, owner);
    uint first = subgroupShuffle(first_reference, owner);
    uint skipped = lane - subgroupShuffle(begin, owner);
    bool met = false;
    float s = 0.0;
    uint triangle = 0u;
    uint bit = 0u;
    if (lane < pair_count)
    {
        for (; skipped > 0u; skipped--)
        {
            mask &= mask - 1u;
        }
        bit = uint(findLSB(mask));
        triangle = LS_LOAD_WORD(references, first + bit);
        LsLocalRay ray = load_testing_ray(owner);
        LsProjection p = ls_project(ray, params.first_triangle + triangle);
        met =
            ls_may_meet(p) && ls_meet(p, ray.sheared.z, ray.s0, s) &&
            !ls_is_culled(p, ray.sheared.z, (params.flags & LS_GRID_MIRRORED) != 0u, params.flags);
    }

    // What the pairs of this lane's ray have come to.
    uint found = subgroupBallot(met).x;
    uint done = min(end, LANES);
    found &= begin >= done ? 0u : (0xFFFFFFFFu >> (32u - done)) & (0xFFFFFFFFu << begin);
    // The bits up to that of the last pair that was done.
    uint last = subgroupShuffle(bit, max(done, 1u) - 1u);
    pending &= begin >= done ? 0xFFFFFFFFu : end == done ? 0u : 0xFFFFFFFEu << last;
    bool may_end = false;
    while (subgroupAny(found != 0u))
    {
        uint worker = found != 0u ? uint(findLSB(found)) : 0u;
        float s_found = subgroupShuffle(s, worker);
        uint triangle_found = subgroupShuffle(triangle, worker);
        if (found != 0u)
        {
            found &= found - 1u;
            may_end = keep(traced, s_found, triangle_found) || may_end;
        }
    }
    return may_end;
}

// Takes what ended parts of rays have found to the rays' owners and frees their lanes; writes the
// hits of rays of which no part is left, and tells the other parts what is known.
void collect_parts(inout Traced traced, inout bool walks, inout uint mask)
{
    uint lane = gl_SubgroupInvocationID;
    bool has_ended = traced.owner != LS_NONE && !walks && mask == 0u;
    uint finders =
        subgroupBallot(has_ended && traced.owner != lane && traced.triangle != LS_NONE).x;
    while (finders != 0u)
    {
        uint finder = uint(findLSB(finders));
        finders &= finders - 1u;
        float s = subgroupShuffle(traced.ray.smax, finder);
        uint triangle = subgroupShuffle(traced.triangle, finder);
        uint owner = subgroupShuffle(traced.owner, finder);
        if (owner == lane && triangle != traced.triangle)
        {
            keep(traced, s, triangle);
        }
    }

    notes[lane] = 0u; // whether a part of its ray is left
    subgroupBarrier();
    if (traced.owner != LS_NONE && !has_ended)
    {
        notes[traced.owner] = 1u;
    }
    subgroupBarrier();
    uint owner = traced.owner == LS_NONE ? lane : traced.owner;
    // What lies behind the owner's hit is of no use, as far as rounding of s + s0 lets one say so.
    float s_known = subgroupShuffle(traced.ray.smax, owner);
    traced.s_end = traced.ray.s0 == 0.0 ? min(traced.s_end, s_known) : traced.s_end;
    bool is_known = subgroupShuffle(traced.triangle, owner) != LS_NONE;
    if (takes_any() && is_known)
    {
        walks = false;
        mask = 0u;
    }
    if (has_ended && (traced.owner != lane || notes[lane] == 0u))
    {
        if (traced.owner == lane)
        {
            finish(traced);
        }
        traced.owner = LS_NONE;
    }
}

#define TAKE(value) value = subgroupShuffle(value, giver)

// Lanes without a ray take the second half of the way that others have before them. They start
// there as rays do that begin inside a grid, which loses no hit (docs/exactness.md).
void divide(inout Traced traced, inout LsWalk walk, inout bool walks)
{
    uint lane = gl_SubgroupInvocationID;
    vec3 border = vec3(get_grid().cells);
    vec3 low = ls_mirrored_low(walk.mirror, border);
    float s_leave = ls_min_component((low + border - walk.origin) * walk.inverse);
    float s_last = min(min(s_leave, traced.s_end), traced.ray.smax - traced.ray.s0);
    float s_middle = 0.5 * (walk.s + s_last);
    bool gives = walks && (s_last - walk.s) * ls_max_component(walk.direction) > FEWEST_CELLS;
    bool takes = traced.owner == LS_NONE;
    uvec4 givers = subgroupBallot(gives);
    uvec4 takers = subgroupBallot(takes);
    uint count = min(subgroupBallotBitCount(givers), subgroupBallotBitCount(takers));
    if (count == 0u)
    {
        return;
    }
    uint gives_to = subgroupBallotExclusiveBitCount(givers);
    uint takes_from = subgroupBallotExclusiveBitCount(takers);
    gives = gives && gives_to < count;
    takes = takes && takes_from < count;
    if (gives)
    {
        notes[gives_to] = lane;
    }
    subgroupBarrier();
    uint giver = takes ? notes[takes_from] : lane;
    float s_end = subgroupShuffle(traced.s_end, giver);
    if (gives)
    {
        traced.s_end = s_middle;
    }
    TAKE(s_middle);
    TAKE(walk.origin);
    TAKE(walk.direction);
    TAKE(walk.inverse);
    TAKE(walk.mirror);
    TAKE(traced.ray.smin);
    TAKE(traced.ray.smax);
    TAKE(traced.ray.s0);
    TAKE(traced.scales);
    TAKE(traced.triangle);
    TAKE(traced.owner);
    if (LS_USES_SCENE_SHAFTS)
    {
        TAKE(walk.signature);
        TAKE(walk.s_line);
        TAKE(walk.s_interval);
        TAKE(walk.s_stop);
    }
    if (takes)
    {
        pivots[lane] = pivots[giver];
        sheareds[lane] = sheareds[giver];
        traced.s_end = s_end;
        walk.s = s_middle;
        walk.axis = 3u;
        walk.level = 0u;
        walk.block = 0u;
        walk.leaf_node = 0u;
        walk.mask = 0u;
        walk.cell = ls_find_cell(walk, s_middle, ls_mirrored_low(walk.mirror, border), border);
        walks = true;
    }
    subgroupMemoryBarrierShared();
}

void main()
{
    uint queued_count = Queue(params.queue).head.count;
    Traced traced;
    traced.triangle = LS_NONE;
    traced.owner = LS_NONE;
    LsWalk walk;
    walk.mask = 0u; // the tests that wait
    bool walks = false;
    bool is_drained = false; // the queue
    bool queues_ray = false;
    if (LS_REFILL == 0u)
    {
        uint slot = gl_GlobalInvocationID.x;
        queues_ray = slot < queued_count;
        walks = queues_ray && begin(slot, traced, walk);
        is_drained = true;
        subgroupMemoryBarrierShared();
    }
    while (true)
    {
        bool is_idle = !walks && walk.mask == 0u;
        if (is_drained)
        {
            if (subgroupAny(traced.owner != LS_NONE && is_idle))
            {
                collect_parts(traced, walks, walk.mask);
            }
            uint free_count = subgroupBallotBitCount(subgroupBallot(traced.owner == LS_NONE));
            if (free_count == LANES)
            {
                break;
            }
            if (free_count >= FEWEST_IDLE)
            {
                divide(traced, walk, walks);
            }
        }
        else
        {
            uvec4 idle_lanes = subgroupBallot(is_idle);
            uint idle_count = subgroupBallotBitCount(idle_lanes);
            if (idle_count >= FEWEST_IDLE)
            {
                uint first = 0u;
                if (subgroupElect())
                {
                    first = atomicAdd(Queue(params.queue).head.next, idle_count);
                }
                uint slot =
                    subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(idle_lanes);
                is_drained = subgroupAny(slot >= queued_count);
                if (is_idle)
                {
                    finish(traced);
                    traced.owner = LS_NONE;
                    walks = slot < queued_count && begin(slot, traced, walk);
                }
                subgroupMemoryBarrierShared();
            }
        }

        // Walk until there is something better to do.
        uint pair_count;
        uint steps_done = 0u;
        while (true)
        {
            pair_count = subgroupAdd(bitCount(walk.mask));
            bool steps = walks && walk.mask == 0u;
            uint idle_count =
                subgroupBallotBitCount(subgroupBallot(!walks && walk.mask == 0u));
            if (pair_count >= FEWEST_PAIRS || !subgroupAny(steps) ||
                (idle_count >= FEWEST_IDLE && (!is_drained || steps_done >= FEWEST_STEPS)))
            {
                break;
            }
            steps_done++;
            if (steps)
            {
                walks = !ls_walk_is_over(get_grid(), traced.ray, walk) && !(traced.s_end < walk.s);
                if (walks)
                {
                    ls_walk_step(get_grid(), traced.ray, walk);
                }
            }
        }
        bool steps = walks && walk.mask == 0u;
        if (pair_count >= FEWEST_PAIRS || (pair_count != 0u && !subgroupAny(steps)))
        {
            if (share_tests(traced, walk.mask, walk.first_reference, pair_count))
            {
                walks = false;
                walk.mask = 0u;
            }
        }
    }
    bool is_cut = subgroupAny(traced.owner != LS_NONE);
    if (LS_REFILL == 0u && queues_ray && is_cut)
    {
        // A device ended the loop; whose ray it was cannot be told.
        uint index = Queue(params.queue).rays[gl_GlobalInvocationID.x].index;
        HitArray(params.hits).at[index].flags = LS_HIT_CUT;
    }
}
