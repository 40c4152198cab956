// carry.glsl - a ray from world space into the space of an object; SPEC 7.2.

#ifndef LS_CARRY_GLSL
#define LS_CARRY_GLSL

#include "triangle.glsl"

// Moves an origin that lies farther than `reach` outside the object's box to where the ray enters
// it. False if the ray misses the box.
bool ls_move_far_origin(inout LsLocalRay ray, vec3 box_lower, vec3 box_upper, float reach)
{
    for (int step = 0; step < 2; step++)
    {
        precise vec3 below = box_lower - ray.origin;
        precise vec3 above = ray.origin - box_upper;
        float far = max(ls_max_component(below), ls_max_component(above));
        if (!(far > reach))
        {
            return true;
        }
        float pad = far * 1.9073486328125e-06; // 2^-19
        bvec3 still = lessThan(abs(ray.direction), vec3(LS_SMALLEST_COMPONENT));
        precise vec3 lower = box_lower - pad;
        precise vec3 upper = box_upper + pad;
        vec3 outside = max(lower - ray.origin, ray.origin - upper);
        if (ls_max_component(mix(vec3(0.0), outside, still)) > 0.0)
        {
            return false;
        }
        precise vec3 inverse = ls_inverse_direction(ray.direction);
        precise vec3 a = (lower - ray.origin) * inverse;
        precise vec3 b = (upper - ray.origin) * inverse;
        vec3 near = mix(min(a, b), vec3(-LS_INFINITY), still);
        vec3 leave = mix(max(a, b), vec3(LS_INFINITY), still);
        float enter = max(ls_max_component(near), 0.0);
        if (!(enter <= ls_min_component(leave)))
        {
            return false;
        }
        precise vec3 origin = ray.origin + ray.direction * enter;
        precise float s0 = ray.s0 + enter;
        ray.origin = origin;
        ray.s0 = s0;
    }
    precise vec3 below = box_lower - ray.origin;
    precise vec3 above = ray.origin - box_upper;
    return !(max(ls_max_component(below), ls_max_component(above)) > reach);
}

// Finishes a ray whose origin and direction are set, by its object's box and reach. False if it
// misses the object.
bool ls_local_ray_finish(inout LsLocalRay local, float tmin, float tmax, vec3 lower, vec3 upper,
                         float reach)
{
    local.scale = ls_direction_scale(local.direction);
    local.direction *= ls_exact_inverse(local.scale);
    local.s0 = 0.0;
    local.smin = tmin * local.scale;
    local.smax = tmax * local.scale;
    local.major = ls_max_axis(abs(local.direction));
    bool near = ls_move_far_origin(local, lower, upper, reach);
    local.pivot = ls_permute(local.origin, local.major);
    local.sheared = ls_permute(local.direction, local.major);
    return near;
}

// A coordinate of a point and of a direction in object space; SPEC 7.2.
float ls_carry_point(vec4 row, vec3 o)
{
    precise float p = ((row.x * o.x + row.y * o.y) + row.z * o.z) + row.w;
    return p;
}

float ls_carry_way(vec4 row, vec3 d)
{
    precise float q = (row.x * d.x + row.y * d.y) + row.z * d.z;
    return q;
}

// A scaled ray's origin and direction in object space, by the rows of `object_from_world`. False if
// a number of it is too large or too small.
bool ls_carry_by(LsRay ray, vec4 row_x, vec4 row_y, vec4 row_z, inout LsLocalRay local)
{
    vec3 o = ray.origin;
    vec3 d = ray.direction;
    local.origin =
        vec3(ls_carry_point(row_x, o), ls_carry_point(row_y, o), ls_carry_point(row_z, o));
    local.direction =
        vec3(ls_carry_way(row_x, d), ls_carry_way(row_y, d), ls_carry_way(row_z, d));
    return ls_is_finite(local.origin) && ls_is_direction(local.direction);
}

#endif
