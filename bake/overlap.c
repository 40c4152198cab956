// overlap.c - thirteen axes: three of the box, the triangle's normal, nine cross products.

#include "overlap.h"

#include <math.h>

// Those of the library are calls.
static double smaller(double a, double b)
{
    return a < b ? a : b;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

LsOverlap ls_overlap_prepare(const double corners[3][3])
{
    LsOverlap t;
    for (int axis = 0; axis < 3; axis++)
    {
        t.lower[axis] = smaller(smaller(corners[0][axis], corners[1][axis]), corners[2][axis]);
        t.upper[axis] = larger(larger(corners[0][axis], corners[1][axis]), corners[2][axis]);
    }
    double edges[3][3];
    for (int k = 0; k < 3; k++)
    {
        for (int axis = 0; axis < 3; axis++)
        {
            edges[k][axis] = corners[(k + 1) % 3][axis] - corners[k][axis];
        }
    }
    t.plane = 0.0;
    for (int axis = 0; axis < 3; axis++)
    {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        t.normal[axis] = edges[0][u] * edges[1][v] - edges[0][v] * edges[1][u];
        t.plane += t.normal[axis] * corners[0][axis];
    }
    for (int i = 0; i < 3; i++)
    {
        for (int k = 0; k < 3; k++)
        {
            int n = 3 * i + k, u = (i + 1) % 3, v = (i + 2) % 3;
            t.u[n] = -edges[k][v];
            t.v[n] = edges[k][u];
            double a = t.u[n] * corners[k][u] + t.v[n] * corners[k][v];
            double b = t.u[n] * corners[(k + 2) % 3][u] + t.v[n] * corners[(k + 2) % 3][v];
            t.low[n] = smaller(a, b);
            t.high[n] = larger(a, b);
        }
    }
    return t;
}

bool ls_overlap_box(const LsOverlap* t, const double centre[3], const double half[3])
{
    for (int axis = 0; axis < 3; axis++)
    {
        if (t->lower[axis] > centre[axis] + half[axis] ||
            t->upper[axis] < centre[axis] - half[axis])
        {
            return false;
        }
    }
    double radius = 0.0, distance = -t->plane;
    for (int axis = 0; axis < 3; axis++)
    {
        radius += fabs(t->normal[axis]) * half[axis];
        distance += t->normal[axis] * centre[axis];
    }
    if (fabs(distance) > radius)
    {
        return false;
    }
    for (int n = 0; n < 9; n++)
    {
        int u = (n / 3 + 1) % 3, v = (n / 3 + 2) % 3;
        double at = t->u[n] * centre[u] + t->v[n] * centre[v];
        double reach = fabs(t->u[n]) * half[u] + fabs(t->v[n]) * half[v];
        if (t->low[n] > at + reach || t->high[n] < at - reach)
        {
            return false;
        }
    }
    return true;
}
