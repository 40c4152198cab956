// trace_grid.comp.glsl - second pass over scenes with one grid: the queued rays through it.
//
// Lanes walk until enough triangles wait to be tested. Then all lanes of the subgroup share the
// tests, a pair of ray and triangle each, whichever ray it belongs to; owners collect what was
// found. So neither long walks nor long lists leave the other lanes idle for long. Empty cubes and
// voxels are passed apart from each other, for many lanes at a time. A lane whose ray has ended
// takes the next one from the queue (T. Aila, S. Laine, "Understanding the Efficiency of Ray
// Traversal on GPUs", HPG 2009), unless LS_REFILL is 0, for devices that bound the rounds of loops.
//
// Some rays meet many times more cells than others, and a batch ends with its last ray. So rays
// with a long way are taken first, neighbours by different subgroups; and when the queue is empty,
// lanes without a ray take parts of the way that another still has before it, again and again. A
// group is one subgroup, of at most 32 lanes.

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
const uint FEWEST_IDLE = LANES / 2u; // lanes that wait before they fetch rays
const uint FEWEST_FREE = LANES / 4u; // lanes that wait before they take parts of rays
// Tests that wait before they are done; where rounds of loops are bounded, as many as can be done.
const uint FEWEST_PAIRS = LS_REFILL != 0u ? LANES * 5u / 8u : LANES;
const uint FEWEST_SEARCHING = LANES * 5u / 16u; // lanes in empty cubes while others wait in voxels
const uint FEWEST_STEPS = 4u;                   // between one division and the next
const float FEWEST_CELLS = 2.0;                 // that lie before a ray if its way is divided
const uint TOGETHER = 2u;                       // rays beside each other that are taken together
const uint STRETCHES = 256u;                    // of the queue, from which rays are taken in turns

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
                  0u, params.first_subgrid_block, (params.flags >> LS_GRID_SCENE_PATCHES) & 0xFFu);
}

bool takes_any()
{
    return (params.flags & LS_RAY_FLAG_ANY_HIT) != 0u;
}

// Rays beside each other in a batch are alike: where they graze a surface, all have long ways, and
// a subgroup of such rays would be what the batch waits for. So the rays that a subgroup takes come
// from all stretches of the queue. A permutation of the numbers below `count`.
uint deal(uint number, uint count)
{
    uint stretch = count / (TOGETHER * STRETCHES); // its length, in what is taken together
    uint turn = number / TOGETHER;
    uint dealt = ((turn % STRETCHES) * stretch + turn / STRETCHES) * TOGETHER + number % TOGETHER;
    return number < stretch * TOGETHER * STRETCHES ? dealt : number;
}

// The slot of the ray that is taken as number `number`: those with long ways first.
uint find_slot(uint number, uint far_count, uint queued_count)
{
    return number < far_count ? deal(number, far_count)
                              : Queue(params.queue).head.capacity - 1u -
                                    deal(number - far_count, queued_count - far_count);
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
        bool wins = traced.triangle == LS_NONE
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

// Passes over the lowest `width` bits of what is left of a mask if bit `number` is not among them.
void pass_bits(uint mask, uint width, inout uint number, inout uint bit)
{
    uint count = bitCount((mask >> bit) & ((1u << width) - 1u));
    bool passes = number >= count;
    number -= passes ? count : 0u;
    bit += passes ? width : 0u;
}

// Which bit of a mask is set as number `number`, counted from 0. Without a loop, since some devices
// bound their rounds.
uint find_bit(uint mask, uint number)
{
    uint bit = 0u;
    pass_bits(mask, 16u, number, bit);
    pass_bits(mask, 8u, number, bit);
    pass_bits(mask, 4u, number, bit);
    pass_bits(mask, 2u, number, bit);
    pass_bits(mask, 1u, number, bit);
    return bit;
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
        bit = find_bit(mask, skipped);
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
    subgroupBarrier(); // for the next notes
}

#define TAKE(value) value = subgroupShuffle(value, giver)

// Lanes without a ray take parts of the way that others have before them, evenly. They start there
// as rays do that begin inside a grid, which loses no hit (docs/exactness.md).
void divide(inout Traced traced, inout LsWalk walk, inout bool walks)
{
    uint lane = gl_SubgroupInvocationID;
    vec3 border = vec3(get_grid().cells);
    vec3 low = ls_mirrored_low(walk.mirror, border);
    float s_leave = ls_min_component((low + border - walk.origin) * walk.inverse);
    float s_last = min(min(s_leave, traced.s_end), traced.ray.smax - traced.ray.s0);
    float cell_count = (s_last - walk.s) * ls_max_component(walk.direction); // about
    bool gives = walks && cell_count > FEWEST_CELLS;
    bool takes = traced.owner == LS_NONE;
    uvec4 givers = subgroupBallot(gives);
    uvec4 takers = subgroupBallot(takes);
    uint giver_count = subgroupBallotBitCount(givers);
    uint taker_count = subgroupBallotBitCount(takers);
    if (giver_count == 0u)
    {
        return;
    }

    // The first giver's parts go to the first takers, and so on.
    uint share = max(taker_count / giver_count, 1u);
    uint giver_number = subgroupBallotExclusiveBitCount(givers);
    uint taker_number = subgroupBallotExclusiveBitCount(takers);
    if (gives)
    {
        notes[giver_number] = lane;
    }
    subgroupBarrier();
    bool finds_takers = gives && giver_number * share < taker_count;
    uint part_count = finds_takers ? min(share, uint(min(cell_count, float(LANES)))) + 1u : 1u;
    precise float s_part = (s_last - walk.s) / float(part_count);
    uint part = taker_number % share + 1u; // part 0 stays with the giver
    uint taken_from = taker_number / share;
    uint giver = takes && taken_from < giver_count ? notes[taken_from] : lane;
    uint count_there = subgroupShuffle(part_count, giver);
    takes = takes && giver != lane && part < count_there;
    giver = takes ? giver : lane;

    // Where one part ends the next begins, to the bit.
    TAKE(part_count);
    TAKE(s_part);
    float s_end = subgroupShuffle(traced.s_end, giver);
    precise float s_first = subgroupShuffle(walk.s, giver);
    part = takes ? part : 0u;
    precise float s_begin = s_first + s_part * float(part);
    precise float s_behind = s_first + s_part * float(part + 1u);
    if ((finds_takers || takes) && part + 1u < part_count)
    {
        s_end = s_behind;
    }
    traced.s_end = s_end;
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
        walk.s = s_begin;
        walk.axis = 3u;
        walk.level = 0u;
        walk.block = 0u;
        walk.leaf_node = 0u;
        walk.mask = 0u;
        walk.cell = ls_find_cell(walk, s_begin, ls_mirrored_low(walk.mirror, border), border);
        walks = true;
    }
    subgroupBarrier();
}

bool goes_on(Traced traced, LsWalk walk)
{
    return !ls_walk_is_over(get_grid(), traced.ray, walk) && !(traced.s_end < walk.s);
}

// Walks through empty cubes until few lanes still do, then with all that came to a voxel through
// it: a voxel takes twice the instructions of a cube, which all lanes wait for.
void walk_on(Traced traced, inout LsWalk walk, inout bool walks)
{
    bool searches = walks && walk.mask == 0u;
    uint word = LS_NONE;
    do
    {
        if (searches)
        {
            walks = goes_on(traced, walk);
            searches = walks;
            if (walks)
            {
                bool in_block;
                word = ls_walk_find(get_grid(), walk, in_block);
                if (ls_is_voxel(word))
                {
                    searches = false;
                }
                else
                {
                    ls_walk_pass(get_grid(), traced.ray, walk, word, in_block, false);
                }
            }
        }
    } while (subgroupBallotBitCount(subgroupBallot(searches)) >= FEWEST_SEARCHING);
    if (ls_is_voxel(word))
    {
        ls_walk_pass(get_grid(), traced.ray, walk, word, true, true);
    }
}

// The same for devices that bound the rounds of loops: through one cube or one voxel.
void step_on(Traced traced, inout LsWalk walk, inout bool walks)
{
    if (walks && walk.mask == 0u)
    {
        walks = goes_on(traced, walk);
        if (walks)
        {
            ls_walk_step(get_grid(), traced.ray, walk);
        }
    }
}

void main()
{
    uint far_count = Queue(params.queue).head.counts[0];
    uint queued_count = far_count + Queue(params.queue).head.counts[1];
    Traced traced;
    traced.triangle = LS_NONE;
    traced.owner = LS_NONE;
    LsWalk walk;
    walk.mask = 0u; // the tests that wait
    bool walks = false;
    bool is_drained = false; // the queue
    // A lane's only ray, where lanes take no more; each subgroup has some of the long ways then.
    uint number = gl_SubgroupInvocationID * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    bool queues_ray = LS_REFILL == 0u && number < queued_count;
    if (LS_REFILL == 0u)
    {
        walks = queues_ray && begin(find_slot(number, far_count, queued_count), traced, walk);
        is_drained = true;
        subgroupBarrier();
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
            if (free_count >= FEWEST_FREE)
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
                    walks = slot < queued_count &&
                            begin(find_slot(slot, far_count, queued_count), traced, walk);
                }
                subgroupBarrier();
            }
        }

        // Walk until there is something better to do.
        uint pair_count;
        uint steps_done = 0u;
        while (true)
        {
            pair_count = subgroupAdd(bitCount(walk.mask));
            bool steps = walks && walk.mask == 0u;
            uint idle_count = subgroupBallotBitCount(subgroupBallot(!walks && walk.mask == 0u));
            if (pair_count >= FEWEST_PAIRS || !subgroupAny(steps) ||
                (is_drained ? idle_count >= FEWEST_FREE && steps_done >= FEWEST_STEPS
                            : idle_count >= FEWEST_IDLE))
            {
                break;
            }
            steps_done++;
            if (LS_REFILL != 0u)
            {
                walk_on(traced, walk, walks);
            }
            else
            {
                step_on(traced, walk, walks);
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
    if (queues_ray && is_cut)
    {
        // A device ended the loop; whose ray it was cannot be told.
        uint slot = find_slot(number, far_count, queued_count);
        uint index = Queue(params.queue).rays[slot].index;
        HitArray(params.hits).at[index].flags = LS_HIT_CUT;
    }
}
