// The grey of each projected value: sRGB-encoded grey linear from the window's low to its high end,
// written as linear light, opaque where the ray met the volume.
//
// Reads kind and value of cast_projection. Writes color.
#include "lib/color.clh"
#include "lib/ray.clh"

kernel void window_value(RayGrid rays, float2 window, const global uint *kind, const global float *value,
                         global float4 *color)
{
    uint i = get_global_id(0);
    uint j = get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;

    float grey = clamp((value[pixel] - window.x) / (window.y - window.x), 0.0f, 1.0f);
    float light = linear_from_srgb(grey);
    color[pixel] = kind[pixel] == KIND_NOTHING ? (float4)(0.0f) : (float4)(light, light, light, 1.0f);
}
