// gltf_math.h - matrices and angles of the glTF importer, with the same bits from every compiler
// and C library, since they reach the file.

#ifndef GLTF_MATH_H
#define GLTF_MATH_H

#include <array>
#include <cmath>
#include <cstddef>

constexpr double GLTF_PI = 3.14159265358979323846;

// Row-major 3x4; the fourth row is (0, 0, 0, 1).
using GltfMatrix = std::array<std::array<double, 4>, 3>;

constexpr GltfMatrix GLTF_IDENTITY = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

inline GltfMatrix gltf_multiply(const GltfMatrix& a, const GltfMatrix& b)
{
    GltfMatrix product;
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 4; j++)
            product[i][j] = ((a[i][0] * b[0][j] + a[i][1] * b[1][j]) + a[i][2] * b[2][j]) +
                            (j == 3 ? a[i][3] : 0.0);
    return product;
}

// Length of column `j`.
inline double gltf_find_column_length(const GltfMatrix& matrix, size_t j)
{
    return std::sqrt((matrix[0][j] * matrix[0][j] + matrix[1][j] * matrix[1][j]) +
                     matrix[2][j] * matrix[2][j]);
}

// The tangent of an angle in (-pi/2, pi/2) by its continued fraction.
inline double gltf_find_tangent(double angle)
{
    const double square = angle * angle;
    double below = 61.0;
    for (int odd = 59; odd >= 1; odd -= 2)
        below = odd - square / below;
    return angle / below;
}

struct GltfSineCosine
{
    double sine, cosine;
};

// Through the tangent of the half of what is left of the angle beside quarter turns, which is at
// most pi/8; remquo is exact.
inline GltfSineCosine gltf_find_sine_cosine(double angle)
{
    int quarters = 0;
    const double rest = std::remquo(angle, 0.5 * GLTF_PI, &quarters);
    const double t = gltf_find_tangent(0.5 * rest);
    const double sine = 2.0 * t / (1.0 + t * t);
    const double cosine = (1.0 - t * t) / (1.0 + t * t);
    switch (quarters & 3)
    {
    case 0:
        return {sine, cosine};
    case 1:
        return {cosine, -sine};
    case 2:
        return {-sine, -cosine};
    default:
        return {-cosine, sine};
    }
}

#endif
