// instance.glsl - rays carried into the space of an instance, and objects without a grid; SPEC 7.2.

#ifndef LS_INSTANCE_GLSL
#define LS_INSTANCE_GLSL

#include "triangle.glsl"

// Moves an origin that lies farther than `reach` outside the object's box to where the ray enters
// it. False if the ray misses the box.
bool ls_move_far_origin(inout LsLocalRay ray)
{
    LS_FIND_OBJECT(objects, ray.object);
    vec3 box_lower = LS_FOUND(objects, ray.object).lower;
    vec3 box_upper = LS_FOUND(objects, ray.object).upper;
    float reach = LS_FOUND(objects, ray.object).reach;
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

// Finishes a ray whose origin, direction and object are set. False if it misses the object.
bool ls_local_ray_finish(inout LsLocalRay local, float tmin, float tmax)
{
    local.scale = ls_direction_scale(local.direction);
    local.direction *= ls_exact_inverse(local.scale);
    local.s0 = 0.0;
    local.smin = tmin * local.scale;
    local.smax = tmax * local.scale;
    local.major = ls_max_axis(abs(local.direction));
    LS_FIND_OBJECT(objects, local.object);
    local.first_triangle = LS_FIRST(LS_FOUND(objects, local.object).first_triangle);
    bool near = ls_move_far_origin(local);
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

// Carries a scaled ray into the space of an instance. False if it misses it.
bool ls_carry_ray(LsRay ray, uint index, float tmax, uint flags, out LsLocalRay local)
{
    LS_FIND_INSTANCE(instances, index);
    local.origin = ray.origin;
    local.direction = ray.direction;
    local.instance = index;
    local.object = LS_FIRST(LS_FOUND(instances, index).object);
    local.flags = flags;
    local.mirrored = false;
    uint kind = LS_HAS_TOP_LEVEL != 0u ? LS_FOUND(instances, index).flags : LS_INSTANCE_IDENTITY;
    if ((kind & LS_INSTANCE_IDENTITY) == 0u)
    {
        vec3 o = ray.origin;
        vec3 d = ray.direction;
        vec4 row_x = LS_FOUND(instances, index).object_from_world[0];
        vec4 row_y = LS_FOUND(instances, index).object_from_world[1];
        vec4 row_z = LS_FOUND(instances, index).object_from_world[2];
        local.origin =
            vec3(ls_carry_point(row_x, o), ls_carry_point(row_y, o), ls_carry_point(row_z, o));
        local.direction =
            vec3(ls_carry_way(row_x, d), ls_carry_way(row_y, d), ls_carry_way(row_z, d));
        if (!ls_is_finite(local.origin) || !ls_is_direction(local.direction))
        {
            return false;
        }
        local.mirrored = (kind & LS_INSTANCE_MIRRORED) != 0u;
    }
    return ls_local_ray_finish(local, ray.tmin, tmax);
}

// Tests the triangles of a list. True if the ray may end.
bool ls_test_list(inout LsLocalRay ray, inout LsBest best, uint count)
{
    ls_work.z += count;
    uint first = 0u;
    for (; first < count; first += 32u)
    {
        uint end = min(first + 32u, count);
        uint left = 0u;
        uint i = first;
        for (; i < end; i++)
        {
            bool may_meet = LS_DEFERS == 0u || ls_may_meet(ls_project(ray, ray.first_triangle + i));
            left |= may_meet ? 1u << (i - first) : 0u;
        }
        ls_cut = ls_cut || int(i - end) < 0;
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
    }
    ls_cut = ls_cut || int(first - count) < 0;
    return false;
}

#endif
