// What each pixel gives to those that its disc reaches (lib/ray/blur.clh): its circle of confusion, at most WIDEST_PX, and what
// it covers of the lens.
//
// A pixel covers all of its disc's part where it has a depth, or with `by_alpha`, where pixels have several rays, as much as it is
// opaque. Where some of these met something that the middle one missed, that is taken to be as deep as the nearest of the pixels
// around. Without a depth a pixel covers nothing: what little light it may have stays where it is, behind all else.
//
// Reads depth (+inf: none), coc and, with `by_alpha`, color (linear light, premultiplied). Writes circle and cover.
#include "lib/ray/blur.clh"

// The circle of the nearest of the pixels around that have a depth; 0: none has.
static inline Floats circle_around(RayGrid rays, Pixels pixels, const global float *depth, const global float *coc)
{
    Floats nearest_mm = FLOATS(INFINITY);
    Floats circle = FLOATS(0.0f);
    for (int n = 0; n < 9; n++) {
        Ints i = clamp_ints(pixels.i + (n % 3 - 1), INTS(0), INTS((int)rays.width - 1));
        Ints j = clamp_ints(pixels.j + (n / 3 - 1), INTS(0), INTS((int)rays.height - 1));
        Ints place = j * (int)rays.width + i;
        Floats mm = GATHER(Floats, depth, place);
        Floats there = GATHER(Floats, coc, place);
        circle = mm < nearest_mm ? there : circle;
        nearest_mm = min_of(nearest_mm, mm);
    }
    return circle;
}

kernel void blur_circles(RayGrid rays, uint by_alpha, const global float *depth, const global float *coc, const global float4 *color,
                         global float *circle, global float *cover)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    Mask deep = read_floats(depth, pixels) < INFINITY;
    Floats diameter = deep ? read_floats(coc, pixels) : FLOATS(0.0f);
    Floats covered = deep ? FLOATS(1.0f) : FLOATS(0.0f);
    if (by_alpha) {
        covered = read_float4(color, pixels).w;
        Mask missed = !deep & covered > 0.0f;
        if (ANY(missed))
            diameter = missed ? circle_around(rays, pixels, depth, coc) : diameter;
    }
    diameter = clamp_to(diameter, FLOATS(-(float)WIDEST_PX), FLOATS((float)WIDEST_PX));
    SCATTER(pixels.inside, circle, pixels.index, diameter);
    SCATTER(pixels.inside, cover, pixels.index, covered / disc_area(diameter));
}
