// Adds a share of one picture to the mean of several; the first one replaces what was there.
//
// Reads picture. Writes mean, and reads it unless `is_first`.
#include "lib/ray/planes.clh"

kernel void add_picture(RayGrid rays, float share, uint is_first, const global float4 *picture, global float4 *mean)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    Floats4 sum = read_float4(picture, pixels);
    Floats4 before = read_float4(mean, pixels);
    sum.x = is_first ? share * sum.x : before.x + share * sum.x;
    sum.y = is_first ? share * sum.y : before.y + share * sum.y;
    sum.z = is_first ? share * sum.z : before.z + share * sum.z;
    sum.w = is_first ? share * sum.w : before.w + share * sum.w;
    scatter_float4(mean, pixels, sum);
}
