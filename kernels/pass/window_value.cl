// The grey of each projected value: sRGB-encoded grey linear from the window's low to its high end,
// written as linear light, opaque where the ray met the volume.
//
// Reads kind and value of cast_maximum; the window is in stored units like it. Writes color.
#include "lib/color.clh"
#include "old/ray.clh"

kernel void window_value(RayGrid rays, float2 window, const global uint *kind, const global float *value,
                         global float4 *color)
{
    uint i = get_global_id(0);
    uint j = get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;

    // Halves, so that the widest window does not overflow; one too narrow for single precision is a step.
    float above = 0.5f * value[pixel] - 0.5f * window.x;
    float width = 0.5f * window.y - 0.5f * window.x;
    float grey = width > 0.0f ? clamp(above / width, 0.0f, 1.0f) : (above > 0.0f ? 1.0f : 0.0f);
    float light = linear_from_srgb(grey);
    color[pixel] = kind[pixel] == KIND_NOTHING ? (float4)(0.0f) : (float4)(light, light, light, 1.0f);
}
