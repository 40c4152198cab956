// instance.glsl - rays carried into the space of an instance, and objects without a grid; SPEC 7.2.

#ifndef LS_INSTANCE_GLSL
#define LS_INSTANCE_GLSL

#include "carry.glsl"

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
        if (!ls_carry_by(ray, LS_FOUND(instances, index).object_from_world[0],
                         LS_FOUND(instances, index).object_from_world[1],
                         LS_FOUND(instances, index).object_from_world[2], local))
        {
            return false;
        }
        local.mirrored = (kind & LS_INSTANCE_MIRRORED) != 0u;
    }
    LS_FIND_OBJECT(objects, local.object);
    local.first_triangle = LS_FIRST(LS_FOUND(objects, local.object).first_triangle);
    return ls_local_ray_finish(local, ray.tmin, tmax, LS_FOUND(objects, local.object).lower,
                               LS_FOUND(objects, local.object).upper,
                               LS_FOUND(objects, local.object).reach);
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
