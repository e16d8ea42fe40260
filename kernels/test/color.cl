// Both directions of the sRGB curve at each value.
#define LANES 1
#include "lib/light/color.clh"

kernel void color(uint count, const global float *values, global float *linear, global float *srgb)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    linear[i] = linear_from_srgb(values[i]);
    srgb[i] = srgb_from_linear(values[i]);
}
