// How much pixels differ that one ray was cast in from the mean of many, in channels, sRGB-encoded.
//
// A work-item takes one listed pixel. Reads the samples' colours and color (linear light, premultiplied). Writes apart, one
// entry a pixel of the list: the sum of the squares of red's, green's and blue's differences, and the greatest of them.
#include "lib/abi.clh"
#include "lib/math/lanes.clh"
#include "lib/light/color.clh"

#if LANES != 1
#error "a work-item takes one pixel: LANES is 1"
#endif

kernel void compare_samples(const global uint2 *listed, uint first, uint count, uint per_pixel, const global float4 *sample_color,
                            const global float4 *color, global float2 *apart)
{
    uint n = (uint)(get_global_id(1) * get_global_size(0) + get_global_id(0));
    if (n >= count)
        return;
    float4 sum = (float4)(0.0f);
    for (uint k = n * per_pixel; k < (n + 1u) * per_pixel; k++)
        sum += sample_color[k];
    float4 mean = sum / (float)per_pixel;
    float4 one = color[listed[first + n].x];
    float red = fabs(srgb_from_linear(mean.x) - srgb_from_linear(one.x));
    float green = fabs(srgb_from_linear(mean.y) - srgb_from_linear(one.y));
    float blue = fabs(srgb_from_linear(mean.z) - srgb_from_linear(one.z));
    apart[first + n] = (float2)(red * red + green * green + blue * blue, fmax(red, fmax(green, blue)));
}
