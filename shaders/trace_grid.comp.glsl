// trace_grid.comp.glsl - second pass over scenes with one grid: the queued rays through it.
//
// Lanes walk until enough triangles wait to be tested. Then all lanes of the subgroup share the tests, a pair of
// ray and triangle each, whichever ray it belongs to; owners collect what was found. So neither
// long walks nor long lists leave the other lanes idle for long. A lane whose ray has ended takes the next one
// from the queue (T. Aila, S. Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009), unless
// LS_REFILL is 0, which suits rays that go similar ways. A group is one subgroup, of at most 32 lanes.

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
const uint FEWEST_IDLE = LANES / 4u;  // lanes that wait before they fetch rays together
const uint FEWEST_PAIRS = LANES / 2u; // tests that wait before they are done

// What testing needs of the ray of each lane: pivot and major, sheared and s0.
shared vec4 pivots[LANES];
shared vec4 sheareds[LANES];

LsLocalRay load_testing_ray(uint lane)
{
    LsLocalRay ray;
    ray.pivot = pivots[lane].xyz;
    ray.major = floatBitsToUint(pivots[lane].w);
    ray.sheared = sheareds[lane].xyz;
    ray.s0 = sheareds[lane].w;
    return ray;
}

// A lane's ray and the best hit in the grid.
struct Traced
{
    LsLocalRay ray;
    uint index;
    uint scales;
    uint triangle; // LS_NONE: none in the grid
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
    uint major = ls_max_axis(abs(queued.direction));
    pivots[gl_SubgroupInvocationID] =
        vec4(ls_permute(queued.origin, major), uintBitsToFloat(major));
    sheareds[gl_SubgroupInvocationID] = vec4(ls_permute(queued.direction, major), queued.s0);
    return ls_walk_begin(get_grid(), traced.ray, walk);
}

// Writes the hit of a ray that has ended, if it lies in the grid; else what the first pass wrote stands.
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
    HitArray(params.hits).at[traced.index] = hit;
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
// reference k from `first_reference` on, in the order of lanes and bits. Takes their bits away; all lanes come
// here together, `pair_count` is the sum of their bits. True if the lane's ray may end.
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

void main()
{
    uint queued_count = Queue(params.queue).head.count;
    Traced traced;
    traced.triangle = LS_NONE;
    LsWalk walk;
    walk.mask = 0u; // the tests that wait
    bool walks = false;
    bool drained = false;
    bool queues_ray = false;
    if (LS_REFILL == 0u)
    {
        uint slot = gl_GlobalInvocationID.x;
        queues_ray = slot < queued_count;
        walks = queues_ray && begin(slot, traced, walk);
        drained = true;
        subgroupMemoryBarrierShared();
    }
    while (true)
    {
        bool idle = !walks && walk.mask == 0u;
        uvec4 idle_lanes = subgroupBallot(idle);
        uint idle_count = subgroupBallotBitCount(idle_lanes);
        if (drained && idle_count == LANES)
        {
            break;
        }
        if (!drained && idle_count >= FEWEST_IDLE)
        {
            uint first = 0u;
            if (subgroupElect())
            {
                first = atomicAdd(Queue(params.queue).head.next, idle_count);
            }
            uint slot = subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(idle_lanes);
            drained = subgroupAny(slot >= queued_count);
            if (idle)
            {
                finish(traced);
                walks = slot < queued_count && begin(slot, traced, walk);
            }
            subgroupMemoryBarrierShared();
        }

        // Walk until there is something better to do.
        uint pair_count;
        while (true)
        {
            pair_count = subgroupAdd(bitCount(walk.mask));
            bool steps = walks && walk.mask == 0u;
            uint fewest = drained ? LANES : FEWEST_IDLE;
            if (pair_count >= FEWEST_PAIRS || !subgroupAny(steps) ||
                subgroupBallotBitCount(subgroupBallot(!walks && walk.mask == 0u)) >= fewest)
            {
                break;
            }
            if (steps)
            {
                walks = !ls_walk_is_over(get_grid(), traced.ray, walk);
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
    finish(traced);
    if (LS_REFILL == 0u && queues_ray && subgroupAny(walks || walk.mask != 0u))
    {
        // A device ended the loop; whose ray it was cannot be told.
        HitArray(params.hits).at[traced.index].flags = LS_HIT_CUT;
    }
}
