// triangle.glsl - rays in object space and the watertight triangle test; SPEC 7.1, 7.2 and 7.4.
//
// S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, with the
// shear multiplied out so that no division decides. Everything is `precise`: the same operations
// must give the same bits wherever they are inlined, and a fused multiply-add would open the edges.

#ifndef LS_TRIANGLE_GLSL
#define LS_TRIANGLE_GLSL

#include "scene.glsl"

// Set where a device ended a loop before its time: llvmpipe (Mesa 22.3) ends all loops of an
// invocation, without a word, after 65535 rounds in sum. The answer is then not to be trusted.
// After a loop its condition is asked again, in other words, lest the compiler knows the answer.
bool ls_cut;

// What a ray has come across, for LS_METHOD_COUNT: cells or empty cubes and boxes of BVHs in
// voxels, shafts looked up, triangles tested. Kernels that never read it do not count.
uvec3 ls_work;

#define LS_INFINITY uintBitsToFloat(0x7F800000u)
#define LS_LARGEST_FLOAT uintBitsToFloat(0x7F7FFFFFu)

bool ls_is_finite(float x)
{
    return (floatBitsToUint(x) & 0x7F800000u) != 0x7F800000u;
}

bool ls_is_finite(vec3 v)
{
    return ls_is_finite(v.x) && ls_is_finite(v.y) && ls_is_finite(v.z);
}

bool ls_is_nan(float x)
{
    return (floatBitsToUint(x) & 0x7FFFFFFFu) > 0x7F800000u;
}

float ls_max_component(vec3 v)
{
    return max(max(v.x, v.y), v.z);
}

float ls_min_component(vec3 v)
{
    return min(min(v.x, v.y), v.z);
}

uint ls_min_axis(vec3 v)
{
    return v.x <= v.y && v.x <= v.z ? 0u : (v.y <= v.z ? 1u : 2u);
}

uint ls_max_axis(vec3 v)
{
    return v.x >= v.y && v.x >= v.z ? 0u : (v.y >= v.z ? 1u : 2u);
}

// Whether a component is that of an axis. Selecting by it, rather than by an index that is known at
// run time only, keeps vectors in registers.
bvec3 ls_is_axis(uint axis)
{
    return equal(uvec3(0u, 1u, 2u), uvec3(axis));
}

// A direction is usable if it is finite and not zero, which starts below 2^-100: devices may take
// numbers below 2^-126 for zero, and what they lose of such a direction must not show.
bool ls_is_direction(vec3 d)
{
    return ls_is_finite(d) && ls_max_component(abs(d)) >= 7.88860905221011805e-31;
}

bool ls_ray_is_legal(LsRay ray)
{
    // A tmax below 2^-126 is none: devices may take it for zero.
    return ls_is_finite(ray.origin) && ls_is_direction(ray.direction) && !ls_is_nan(ray.tmin) &&
           !ls_is_nan(ray.tmax) && ray.tmin >= 0.0 && ray.tmax > ray.tmin &&
           floatBitsToUint(ray.tmax) >= 0x00800000u;
}

// The nearest hit so far. t is in units of the scaled direction of ls_scale_ray. The rest of a hit
// follows from these at the end.
struct LsBest
{
    float t;       // tmax before the first hit
    uint instance; // LS_NONE before the first hit
    uint triangle; // index into the object's part of TRIANGLES
};

// Whether a ray meets a box before `end`; `inverse` from ls_inverse_direction, so no product is
// NaN.
bool ls_meets_box(vec3 origin, vec3 inverse, vec3 lower, vec3 upper, float begin, float end)
{
    precise vec3 a = (lower - origin) * inverse;
    precise vec3 b = (upper - origin) * inverse;
    return max(ls_max_component(min(a, b)), begin) <= min(ls_min_component(max(a, b)), end);
}

// A ray in the space of one object, its direction scaled by a power of two so that the largest
// component lies in [1,2). Distances s count scaled directions: s = t * scale.
struct LsLocalRay
{
    vec3 origin; // moved along the ray by s0 if it lay far away
    vec3 direction;
    float s0;
    float smin;
    float smax; // of the nearest hit so far
    float scale;
    uint major;   // axis of the largest component of the direction
    vec3 pivot;   // the origin as ls_permute turns it
    vec3 sheared; // the direction likewise
    uint instance;
    uint object;
    uint first_triangle; // of the object
    uint flags;          // LS_RAY_FLAG_*
    bool mirrored;
};

// 2^e for the exponent that scales a direction; SPEC 7.2.
float ls_direction_scale(vec3 d)
{
    uint exponent = min(floatBitsToUint(ls_max_component(abs(d))) >> 23, 253u);
    return uintBitsToFloat(exponent << 23);
}

float ls_exact_inverse(float power_of_two)
{
    return uintBitsToFloat((254u << 23) - floatBitsToUint(power_of_two));
}

// Scales the direction by a power of two so that its largest component lies in [1,2), and tmin and
// tmax with it; returns 2^E of SPEC 7.2. Components below 2^-126 become zero on every device.
float ls_scale_ray(inout LsRay ray)
{
    float scale = ls_direction_scale(ray.direction);
    uvec3 exponents = floatBitsToUint(ray.direction) & 0x7F800000u;
    vec3 normal = mix(ray.direction, vec3(0.0), equal(exponents, uvec3(0u)));
    ray.direction = normal * ls_exact_inverse(scale);
    ray.tmin *= scale;
    ray.tmax = min(ray.tmax, LS_LARGEST_FLOAT) * scale;
    return scale;
}

// Components this small, against a direction scaled to 1, move a ray by nothing on its whole way;
// they are kept from zero so that the inverse stays finite.
const float LS_SMALLEST_COMPONENT = 8.67361737988403547e-19; // 2^-60

vec3 ls_inverse_direction(vec3 d)
{
    vec3 kept = mix(d, vec3(LS_SMALLEST_COMPONENT), lessThan(abs(d), vec3(LS_SMALLEST_COMPONENT)));
    return 1.0 / kept;
}

// (kx, ky, kz) of SPEC 7.4 without the swap: it negates U, V, W and det together, which changes
// neither the decision nor s, u, v.
vec3 ls_permute(vec3 v, uint major)
{
    return major == 2u ? v : (major == 1u ? v.zxy : v.yzx);
}

// The corners of a triangle relative to the ray's origin, their projections along the ray, and U,
// V, W of SPEC 7.4.
struct LsProjection
{
    vec3 a, b, c;
    vec2 pa, pb, pc;
    float u, v, w;
};

// A triangle by its corners. Reads the ray's pivot, sheared and major alone.
LsProjection ls_project_corners(LsLocalRay ray, vec3 v0, vec3 v1, vec3 v2)
{
    precise vec3 d = ray.sheared;
    precise vec3 a = ls_permute(v0, ray.major) - ray.pivot;
    precise vec3 b = ls_permute(v1, ray.major) - ray.pivot;
    precise vec3 c = ls_permute(v2, ray.major) - ray.pivot;
    precise vec2 pa = a.xy * d.z - d.xy * a.z;
    precise vec2 pb = b.xy * d.z - d.xy * b.z;
    precise vec2 pc = c.xy * d.z - d.xy * c.z;
    precise float u = pc.x * pb.y - pc.y * pb.x;
    precise float v = pa.x * pc.y - pa.y * pc.x;
    precise float w = pb.x * pa.y - pb.y * pa.x;
    return LsProjection(a, b, c, pa, pb, pc, u, v, w);
}

// Triangle `index` of the whole array.
LsProjection ls_project(LsLocalRay ray, uint index)
{
    LS_FIND_TRIANGLE(triangles, index);
    return ls_project_corners(ray, LS_FOUND(triangles, index).v0, LS_FOUND(triangles, index).v1,
                              LS_FOUND(triangles, index).v2);
}

// Whether the signs of U, V and W let the ray pass through: few triangles of a voxel get so far.
bool ls_may_meet(LsProjection p)
{
    return !(min(min(p.u, p.v), p.w) < 0.0 && max(max(p.u, p.v), p.w) > 0.0);
}

// The weights of the second and third corner where the ray meets a triangle that it hits.
vec2 ls_hit_weights(LsProjection p)
{
    precise float det = (p.u + p.v) + p.w;
    precise vec2 weights = vec2(p.v / det, p.w / det);
    return weights;
}

// What is left of the test of a triangle that may be met, `s` being where. False if it is not.
bool ls_meet(LsProjection p, float depth, float s0, out float s)
{
    s = 0.0;
    // Off the ends of a needle, U, V and W may all round to zero; the bounds tell. They cost no
    // hit: rounding turns a sign to zero at most, so whatever truly holds the ray accepts it.
    vec2 low = min(min(p.pa, p.pb), p.pc);
    vec2 high = max(max(p.pa, p.pb), p.pc);
    precise float det = (p.u + p.v) + p.w;
    if (max(low.x, low.y) > 0.0 || min(high.x, high.y) < 0.0 || det == 0.0)
    {
        return false;
    }
    // In slivers the rounding of U, V and W moves the weighed point far along the triangle; how far
    // shows in projection, and the longest edge leads it back under the ray.
    precise vec2 ab = p.pb - p.pa;
    precise vec2 bc = p.pc - p.pb;
    precise vec2 ca = p.pa - p.pc;
    precise vec3 lengths =
        vec3(ab.x * ab.x + ab.y * ab.y, bc.x * bc.x + bc.y * bc.y, ca.x * ca.x + ca.y * ca.y);
    precise vec3 edge = vec3(ab, p.b.z - p.a.z);
    precise float longest = lengths.x;
    if (lengths.y > longest)
    {
        edge = vec3(bc, p.c.z - p.b.z);
        longest = lengths.y;
    }
    if (lengths.z > longest)
    {
        edge = vec3(ca, p.a.z - p.c.z);
        longest = lengths.z;
    }
    precise vec2 beside = ((p.u * p.pa + p.v * p.pb) + p.w * p.pc) / det;
    precise float back = (beside.x * edge.x + beside.y * edge.y) / longest;
    precise float height = ((p.u * p.a.z + p.v * p.b.z) + p.w * p.c.z) / det - back * edge.z;
    precise float quotient = height / depth;
    precise float distance = quotient + s0;
    s = distance;
    return true;
}

// Whether culling by the ray's flags leaves a triangle out.
bool ls_is_culled(LsProjection p, float depth, bool mirrored, uint flags)
{
    if ((flags & (LS_RAY_FLAG_CULL_BACK_FACING | LS_RAY_FLAG_CULL_FRONT_FACING)) == 0u)
    {
        return false;
    }
    precise float det = (p.u + p.v) + p.w;
    bool front = ((det > 0.0) == (depth > 0.0)) != mirrored;
    return (flags & (front ? LS_RAY_FLAG_CULL_FRONT_FACING : LS_RAY_FLAG_CULL_BACK_FACING)) != 0u;
}

// Corner weights of the last hit that ls_test_triangle kept; kernels that never read them do not
// have them.
vec2 ls_best_weights;

// Tests triangle `number` of the ray's object, and keeps it if it is the best so far. Returns
// whether the ray may end: it is a hit and any hit was asked for. What only a hit needs is loaded
// only then.
bool ls_test_triangle(inout LsLocalRay ray, inout LsBest best, uint number)
{
    uint index = ray.first_triangle + number;
    LsProjection p = ls_project(ray, index);
    float s;
    if (!ls_may_meet(p) || !ls_meet(p, ray.sheared.z, ray.s0, s) ||
        !(s > ray.smin && s <= ray.smax))
    {
        return false;
    }
    if (s == ray.smax &&
        (best.instance == LS_NONE || ray.instance > best.instance ||
         (ray.instance == best.instance &&
          ls_load_primitive(index) >
              ls_load_primitive(ray.first_triangle + best.triangle))))
    {
        return false;
    }
    if (ls_is_culled(p, ray.sheared.z, ray.mirrored, ray.flags))
    {
        return false;
    }
    ray.smax = s;
    best.t = s * ls_exact_inverse(ray.scale);
    best.instance = ray.instance;
    best.triangle = number;
    ls_best_weights = ls_hit_weights(p);
    return (ray.flags & LS_RAY_FLAG_ANY_HIT) != 0u;
}

#endif
