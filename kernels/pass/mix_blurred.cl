// Mixes a picture with a blurred one: the wider a pixel's circle of confusion, the more of the blurred one it shows, all of it
// from `widest_px` on (Lesar et al. 2015, §III-G).
//
// Reads coc and blurred. Reads and writes color (linear light, premultiplied).
#include "lib/ray/planes.clh"

kernel void mix_blurred(RayGrid rays, float widest_px, const global float *coc, const global float4 *blurred, global float4 *color)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    Floats share = min_of(fabs(read_floats(coc, pixels)) / widest_px, FLOATS(1.0f));
    Floats4 sharp = read_float4(color, pixels);
    Floats4 soft = read_float4(blurred, pixels);
    sharp.x += share * (soft.x - sharp.x);
    sharp.y += share * (soft.y - sharp.y);
    sharp.z += share * (soft.z - sharp.z);
    sharp.w += share * (soft.w - sharp.w);
    scatter_float4(color, pixels, sharp);
}
