// What each pixel gives to those that its disc reaches (lib/ray/blur.clh): its circle of confusion, at most WIDEST_PX, and what
// it covers of the lens.
//
// `opacity` says what a pixel covers: all of it where it has a depth (OPACITY_WHOLE); as much as it is opaque, as it has several
// rays (OPACITY_OF_RAYS); all where it has a depth, as what lies behind is part of its light, elsewhere as much as it is opaque
// (OPACITY_OF_MEDIUM). Where several rays met something that the middle one missed, that is taken to be as deep as the
// nearest of the pixels around; where they have no depth either the light stays where it is.
//
// Reads depth (+inf: none), coc and, unless pixels are opaque, color (linear light, premultiplied). Writes circle and cover.
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

kernel void blur_circles(RayGrid rays, uint opacity, const global float *depth, const global float *coc, const global float4 *color,
                         global float *circle, global float *cover)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    Mask deep = read_floats(depth, pixels) < INFINITY;
    Floats diameter = deep ? read_floats(coc, pixels) : FLOATS(0.0f);
    Floats covered = deep ? FLOATS(1.0f) : FLOATS(0.0f);
    if (opacity != OPACITY_WHOLE) {
        Floats alpha = read_float4(color, pixels).w;
        Mask missed = !deep & alpha > 0.0f;
        if (ANY(missed))
            diameter = missed ? circle_around(rays, pixels, depth, coc) : diameter;
        covered = deep & opacity == OPACITY_OF_MEDIUM ? FLOATS(1.0f) : alpha;
    }
    diameter = clamp_to(diameter, FLOATS(-(float)WIDEST_PX), FLOATS((float)WIDEST_PX));
    SCATTER(pixels.inside, circle, pixels.index, diameter);
    SCATTER(pixels.inside, cover, pixels.index, covered / disc_area(diameter));
}
