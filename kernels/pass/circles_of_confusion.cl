// The diameter of each pixel's circle of confusion, in pixels, above 0 behind the focal plane; and the light of those that
// are out of focus darkened by it, `darken` where it is DARKEST_PX or wider.
//
// Of a point at the axial depth z it is from_inverse / s - from_inverse / z + from_depth * (z - s), s the focal plane's depth:
// one of the two factors is 0, as the camera is parallel or not. Reads depth (mm from the eye, or from the eye plane of a
// parallel camera; +inf: nothing is seen). Writes coc; reads and writes color.
#include "lib/ray/camera.clh"
#include "lib/ray/planes.clh"

kernel void circles_of_confusion(RayGrid rays, float focus_mm, float from_inverse, float from_depth, float darken, const global float *depth,
                                 global float *coc, global float4 *color)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    Floats mm = read_floats(depth, pixels);
    Floats axial_mm = from_depth == 0.0f ? mm / length_per_mm(rays, AS_FLOATS(pixels.i), AS_FLOATS(pixels.j)) : mm;
    Floats circle = from_depth == 0.0f ? from_inverse / focus_mm - from_inverse / axial_mm : from_depth * (axial_mm - focus_mm);
    SCATTER(pixels.inside, coc, pixels.index, circle);
    if (darken > 0.0f) {
        Floats kept = 1.0f - darken * min_of(fabs(circle) / (float)DARKEST_PX, FLOATS(1.0f));
        Floats4 light = read_float4(color, pixels);
        light.x *= kept;
        light.y *= kept;
        light.z *= kept;
        scatter_float4(color, pixels, light);
    }
}
