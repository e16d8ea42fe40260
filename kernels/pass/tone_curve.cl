// From linear light to display: composited over the background, sRGB-encoded, contrast and
// brightness about the middle grey, clamped, gamma.
//
// Reads color. Writes display (sRGB-encoded 0..1, opaque).
#include "lib/light/color.clh"
#include "lib/ray/planes.clh"

static inline Floats shown(Tone tone, Floats light, float background, Floats seen)
{
    Floats v = srgb_from_linear(light + background * seen);
    v = clamp_to((v - 0.5f) * tone.contrast + 0.5f + tone.brightness, FLOATS(0.0f), FLOATS(1.0f));
    return tone.inverse_gamma != 1.0f ? power(v, tone.inverse_gamma) : v;
}

kernel void tone_curve(RayGrid rays, Tone tone, const global float4 *color, global float4 *display)
{
    Pixels pixels = tile_pixels(rays);
    Floats4 v = read_float4(color, pixels);
    Floats behind = 1.0f - v.w;
    v.x = shown(tone, v.x, tone.background.x, behind);
    v.y = shown(tone, v.y, tone.background.y, behind);
    v.z = shown(tone, v.z, tone.background.z, behind);
    v.w = FLOATS(1.0f);
    scatter_float4(display, pixels, v);
}
