// The grey of each projected value: sRGB-encoded grey linear from the window's black end (x) to its
// white one (y), either of which may be the higher, written as linear light, opaque where the ray met the volume.
//
// Reads kind and value of cast_maximum; the window is in stored units like it. Writes color.
#include "lib/light/color.clh"
#include "lib/ray/planes.clh"
#include "lib/ray/source.clh"

kernel void window_value(RAY_SOURCE, float2 window, const global uint *kind, const global float *value,
                         global float4 *color)
{
    Pixels pixels = RAY_PIXELS();
    // Halves, so that the widest window does not overflow; one too narrow for single precision is a step
    // (its ends are equal only where white is the higher one).
    Floats above = 0.5f * read_floats(value, pixels) - 0.5f * window.x;
    float width = 0.5f * window.y - 0.5f * window.x;
    Floats step = above > 0.0f ? FLOATS(1.0f) : FLOATS(0.0f);
    Floats grey = width != 0.0f ? clamp_to(above / width, FLOATS(0.0f), FLOATS(1.0f)) : step;
    Mask met = read_ints(kind, pixels) != KIND_NOTHING;
    Floats light = met ? linear_from_srgb(grey) : FLOATS(0.0f);
    Floats4 seen = {light, light, light, met ? FLOATS(1.0f) : FLOATS(0.0f)};
    scatter_float4(color, pixels, seen);
}
