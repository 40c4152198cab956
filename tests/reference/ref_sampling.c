#include "ref_sampling.h"

#include <math.h>

void ls_ref_random_bits(uint32_t pixel, uint32_t sample, uint32_t dimension, uint32_t seed,
                        uint32_t bits[4])
{
    uint32_t v[4] = {pixel, sample, dimension, seed};
    for (int i = 0; i < 4; i++)
    {
        v[i] = v[i] * 1664525u + 1013904223u;
    }
    for (int round = 0; round < 2; round++)
    {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
        for (int i = 0; i < 4 && round == 0; i++)
        {
            v[i] ^= v[i] >> 16;
        }
    }
    for (int i = 0; i < 4; i++)
    {
        bits[i] = v[i];
    }
}

void ls_ref_random(uint32_t pixel, uint32_t sample, uint32_t dimension, uint32_t seed,
                   float random[4])
{
    uint32_t bits[4];
    ls_ref_random_bits(pixel, sample, dimension, seed, bits);
    for (int i = 0; i < 4; i++)
    {
        random[i] = (float)(bits[i] >> 8) / 16777216.0f;
    }
}

void ls_ref_cos_sin_turn(float turn, float cos_sin[2])
{
    static const float SINE[5] = {1.57079633f, -0.645964098f, 0.0796926262f, -0.00468175414f,
                                  0.000160441185f};
    static const float COSINE[6] = {1.0f,           -1.23370055f,    0.253669508f,
                                    -0.0208634808f, 0.000919260274f, -0.0000252020424f};
    float quarters = turn * 4.0f;
    float nearest = floorf(quarters + 0.5f);
    float x = quarters - nearest;
    float y = x * x;
    float s = SINE[4];
    for (int i = 3; i >= 0; i--)
    {
        s = SINE[i] + y * s;
    }
    s = x * s;
    float c = COSINE[5];
    for (int i = 4; i >= 0; i--)
    {
        c = COSINE[i] + y * c;
    }
    const float points[4][2] = {{c, s}, {-s, c}, {-c, -s}, {s, -c}};
    int quadrant = (int)nearest % 4;
    cos_sin[0] = points[quadrant][0];
    cos_sin[1] = points[quadrant][1];
}

void ls_ref_sample_hemisphere(const double n[3], const float random[2], double direction[3])
{
    double side = n[2] >= 0.0 ? 1.0 : -1.0;
    double a = -1.0 / (side + n[2]);
    double b = n[0] * n[1] * a;
    double tangent[3] = {1.0 + side * n[0] * n[0] * a, side * b, -side * n[0]};
    double bitangent[3] = {b, side + n[1] * n[1] * a, -n[1]};
    float turn[2];
    ls_ref_cos_sin_turn(random[1], turn);
    double radius = sqrt(random[0]);
    double height = sqrt(1.0 - random[0]);
    for (int i = 0; i < 3; i++)
    {
        direction[i] = radius * (tangent[i] * turn[0] + bitangent[i] * turn[1]) + n[i] * height;
    }
}

void ls_ref_sample_triangle(const float random[2], float weights[2])
{
    float sum = random[0] + random[1];
    weights[0] = sum > 1.0f ? 1.0f - random[0] : random[0];
    weights[1] = sum > 1.0f ? 1.0f - random[1] : random[1];
}

static double largest_of(const double v[3])
{
    return fmax(fmax(fabs(v[0]), fabs(v[1])), fabs(v[2]));
}

LsRefSurface ls_ref_surface(const LsTriangle* triangle, const LsInstance* instance,
                            const double weights[2], double transform_bound)
{
    const double v[3][3] = {{triangle->v0.x, triangle->v0.y, triangle->v0.z},
                            {triangle->v1.x, triangle->v1.y, triangle->v1.z},
                            {triangle->v2.x, triangle->v2.y, triangle->v2.z}};
    LsRefSurface surface;
    double edge_b[3];
    double edge_c[3];
    double largest = 0.0;
    double longest = 0.0;
    for (int i = 0; i < 3; i++)
    {
        const LsVec4* r = &instance->world_from_object[i];
        const double row[3] = {r->x, r->y, r->z};
        surface.position[i] = r->w;
        edge_b[i] = 0.0;
        edge_c[i] = 0.0;
        double reach = fabs(r->w);
        double span = 0.0;
        for (int j = 0; j < 3; j++)
        {
            double b = v[1][j] - v[0][j];
            double c = v[2][j] - v[0][j];
            surface.position[i] += row[j] * (v[0][j] + weights[0] * b + weights[1] * c);
            edge_b[i] += row[j] * b;
            edge_c[i] += row[j] * c;
            reach += fabs(row[j]) * fmax(fmax(fabs(v[0][j]), fabs(v[1][j])), fabs(v[2][j]));
            span += fabs(row[j]) * fmax(fmax(fabs(b), fabs(c)), fabs(v[2][j] - v[1][j]));
        }
        largest = fmax(largest, reach);
        longest = fmax(longest, span);
    }

    double size = largest_of(edge_b) * largest_of(edge_c);
    double n[3];
    for (int i = 0; i < 3; i++)
    {
        int j = (i + 1) % 3;
        int k = (i + 2) % 3;
        n[i] = (edge_b[j] * edge_c[k] - edge_b[k] * edge_c[j]) / size;
    }
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    double side = instance->flags & LS_INSTANCE_MIRRORED ? -1.0 : 1.0;
    for (int i = 0; i < 3; i++)
    {
        surface.normal[i] = side * n[i] / length;
    }
    surface.error = ldexp(16.0 * largest + 32.0 * longest, -24) + transform_bound * largest;
    return surface;
}
