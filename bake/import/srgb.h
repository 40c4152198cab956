// srgb.h - colours of files that store them as screens show them.

#ifndef LS_SRGB_H
#define LS_SRGB_H

// Linear light of a value of the sRGB transfer function; clamped to [0,1], NaN is 0.
float ls_linear_from_srgb(float value);

#endif
