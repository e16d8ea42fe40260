// Puts what was gathered in the place of a picture's light, in the squares of pixels that are blurred.
//
// Reads reaches of blur_reach and, with HIDDEN, of what first surfaces hide, and blurred of gather_blur. Writes color.
#include "lib/ray/blur.clh"

#if HIDDEN
#define HIDDEN_REACHES , const global float4 *reaches_behind
#else
#define HIDDEN_REACHES
#endif

kernel void put_blurred(RayGrid rays, const global float4 *reaches HIDDEN_REACHES, const global float4 *blurred, global float4 *color)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    uint square = square_of(pixels, squares_in_row(rays));
    bool blurs = is_blurred(blurred_square(reaches[square]));
#if HIDDEN
    blurs = blurs || is_blurred(blurred_square(reaches_behind[square]));
#endif
    if (blurs)
        scatter_float4(color, pixels, read_float4(blurred, pixels));
}
