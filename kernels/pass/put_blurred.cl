// Puts what was gathered in the place of a picture's light, in the squares of pixels that are blurred.
//
// Reads reaches of blur_reach, and blurred of gather_blur. Writes color.
#include "lib/ray/blur.clh"

kernel void put_blurred(RayGrid rays, const global float4 *reaches, const global float4 *blurred, global float4 *color)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    if (is_blurred(blurred_square(reaches[square_of(pixels, squares_in_row(rays))])))
        scatter_float4(color, pixels, read_float4(blurred, pixels));
}
