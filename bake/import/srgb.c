// srgb.c - colours of files that store them as screens show them.

#include "srgb.h"

#include <math.h>

float ls_linear_from_srgb(float value)
{
    if (!(value > 0.0f))
        return 0.0f;
    if (value >= 1.0f)
        return 1.0f;
    return value <= 0.04045f ? value / 12.92f : powf((value + 0.055f) / 1.055f, 2.4f);
}
