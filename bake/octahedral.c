// octahedral.c - Z. Cigolle et al., "A Survey of Efficient Representations for Independent Unit
// Vectors", JCGT 3(2), 2014: of the four words around the exact point the nearest ("oct precise").

#include "octahedral.h"

#include "ls_layout.h"

#include <math.h>

#define LARGEST 32767

static uint32_t make_word(int x, int y)
{
    return (uint32_t)(uint16_t)x | (uint32_t)(uint16_t)y << 16;
}

void ls_octahedral_decode(uint32_t word, double v[3])
{
    double x = (double)(int16_t)(word & 0xFFFFu) / LARGEST;
    double y = (double)(int16_t)(word >> 16) / LARGEST;
    double z = 1.0 - fabs(x) - fabs(y);
    v[0] = x;
    v[1] = y;
    v[2] = z;
    if (z < 0.0)
    {
        v[0] = (1.0 - fabs(y)) * (x < 0.0 ? -1.0 : 1.0);
        v[1] = (1.0 - fabs(x)) * (y < 0.0 ? -1.0 : 1.0);
    }
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    v[0] /= length;
    v[1] /= length;
    v[2] /= length;
}

uint32_t ls_octahedral_encode(const double v[3])
{
    // Divided by the largest first: the sum of three may leave the range of double.
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    double p[3] = {v[0] / largest, v[1] / largest, v[2] / largest};
    double sum = fabs(p[0]) + fabs(p[1]) + fabs(p[2]);
    double x = p[0] / sum, y = p[1] / sum;
    if (p[2] < 0.0)
    {
        double folded = (1.0 - fabs(y)) * (x < 0.0 ? -1.0 : 1.0);
        y = (1.0 - fabs(x)) * (y < 0.0 ? -1.0 : 1.0);
        x = folded;
    }
    int low_x = (int)floor(x * LARGEST), low_y = (int)floor(y * LARGEST);
    uint32_t best = 0;
    double best_dot = -INFINITY;
    for (int i = 0; i < 4; i++)
    {
        int at_x = low_x + (i & 1), at_y = low_y + (i >> 1);
        if (at_x > LARGEST || at_y > LARGEST || at_x < -LARGEST || at_y < -LARGEST)
        {
            continue;
        }
        double q[3];
        uint32_t word = make_word(at_x, at_y);
        if (word == LS_NONE) // means that there is none
        {
            word = make_word(-1, 0);
        }
        ls_octahedral_decode(word, q);
        double dot = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        if (dot > best_dot)
        {
            best_dot = dot;
            best = word;
        }
    }
    return best;
}
