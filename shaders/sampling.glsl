// sampling.glsl - random numbers and what is drawn with them; docs/rendering.md has the formulas.
//
// Built from integers and from sums and products that round alike everywhere, so that devices and
// the reference draw the same numbers. Only square roots and divisions may differ in their last
// bits.

#ifndef LS_SAMPLING_GLSL
#define LS_SAMPLING_GLSL

const float LS_PI = 3.14159265358979;

// Four words for one place in a render, hashed by pcg4d: M. Jarzynski, M. Olano, "Hash Functions
// for GPU Rendering", JCGT 9(3), 2020.
uvec4 ls_random_bits(uint pixel, uint sample_index, uint dimension, uint seed)
{
    uvec4 v = uvec4(pixel, sample_index, dimension, seed) * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Multiples of 2^-24 in [0,1), exact.
vec4 ls_unit_floats(uvec4 bits)
{
    return vec4(bits >> 8u) * uintBitsToFloat((127u - 24u) << 23);
}

vec4 ls_random(uint pixel, uint sample_index, uint dimension, uint seed)
{
    return ls_unit_floats(ls_random_bits(pixel, sample_index, dimension, seed));
}

// Cosine and sine of `turn` whole turns, turn in [0,1]. The nearest quarter turn is taken out
// exactly, the rest of at most an eighth goes through the series of sine and cosine of a quarter
// turn.
vec2 ls_cos_sin_turn(float turn)
{
    precise float quarters = turn * 4.0;
    precise float nearest = floor(quarters + 0.5);
    precise float x = quarters - nearest;
    precise float y = x * x;
    precise float sine =
        x * (1.57079633 +
             y * (-0.645964098 + y * (0.0796926262 + y * (-0.00468175414 + y * 0.000160441185))));
    precise float cosine =
        1.0 +
        y * (-1.23370055 +
             y * (0.253669508 + y * (-0.0208634808 + y * (0.000919260274 + y * -0.0000252020424))));
    vec2 odd = vec2(-sine, cosine);
    vec2 even = vec2(cosine, sine);
    uint quadrant = uint(nearest) & 3u;
    vec2 point = (quadrant & 1u) != 0u ? odd : even;
    return (quadrant & 2u) != 0u ? -point : point;
}

// A direction about the unit normal n with density cos / pi. The frame is that of T. Duff et al.,
// "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
vec3 ls_sample_hemisphere(vec3 n, vec2 random)
{
    float side = n.z >= 0.0 ? 1.0 : -1.0;
    precise float a = -1.0 / (side + n.z);
    precise float b = n.x * n.y * a;
    precise vec3 tangent = vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    precise vec3 bitangent = vec3(b, side + n.y * n.y * a, -n.y);
    precise vec2 disk = sqrt(random.x) * ls_cos_sin_turn(random.y);
    precise float height = sqrt(1.0 - random.x);
    precise vec3 direction = (tangent * disk.x + bitangent * disk.y) + n * height;
    return direction;
}

// Weights of the second and third corner, uniform over a triangle: a point of the unit square
// beyond the diagonal is turned about its middle.
vec2 ls_sample_triangle(vec2 random)
{
    return random.x + random.y > 1.0 ? 1.0 - random : random;
}

// A point on a triangle with what it takes to leave it.
struct LsHitSurface
{
    vec3 position;
    vec3 normal; // unit; of the side from which the corners run counter-clockwise in object space
    float error; // how far along the normal a ray must start to be free of the surface
};

// The point with weights (u, v) of a triangle under a 3x4 matrix. `transform_bound` as in
// LsDeviceScene.
//
// The distance to keep follows from rounding alone, u = 2^-24: positions are off by a few u of the
// largest term in their sums, and the triangle test by 16 u of the triangle's size (SPEC 7.6).
LsHitSurface ls_surface(LsTriangle triangle, vec4 rows[3], bool mirrored, vec2 weights,
                        float transform_bound)
{
    precise vec3 edge_b = triangle.v1 - triangle.v0;
    precise vec3 edge_c = triangle.v2 - triangle.v0;
    precise vec3 point = triangle.v0 + (edge_b * weights.x + edge_c * weights.y);
    vec3 reach = max(max(abs(triangle.v0), abs(triangle.v1)), abs(triangle.v2));
    vec3 span = max(max(abs(edge_b), abs(edge_c)), abs(triangle.v2 - triangle.v1));

    LsHitSurface surface;
    vec3 b;
    vec3 c;
    float largest = 0.0;
    float longest = 0.0;
    for (int i = 0; i < 3; i++)
    {
        vec4 row = rows[i];
        precise float x = ((row.x * point.x + row.y * point.y) + row.z * point.z) + row.w;
        surface.position[i] = x;
        b[i] = dot(rows[i].xyz, edge_b);
        c[i] = dot(rows[i].xyz, edge_c);
        largest = max(largest, dot(abs(rows[i].xyz), reach) + abs(rows[i].w));
        longest = max(longest, dot(abs(rows[i].xyz), span));
    }

    // Scaled before the products, which would underflow for triangles smaller than 1e-10.
    float size_b = max(max(abs(b.x), abs(b.y)), abs(b.z));
    float size_c = max(max(abs(c.x), abs(c.y)), abs(c.z));
    vec3 normal = cross(b / size_b, c / size_c);
    normal /= max(max(abs(normal.x), abs(normal.y)), abs(normal.z));
    surface.normal = normalize(mirrored ? -normal : normal);

    const float unit = uintBitsToFloat((127u - 24u) << 23);
    surface.error = unit * (16.0 * largest + 32.0 * longest) + transform_bound * largest;
    return surface;
}

#endif
