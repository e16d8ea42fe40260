// From linear light to display: composited over the background, sRGB-encoded, contrast and
// brightness about the middle grey, clamped, gamma.
//
// Reads color. Writes display (sRGB-encoded 0..1, opaque).
#include "lib/color.clh"
#include "old/ray.clh"

kernel void tone_curve(RayGrid rays, Tone tone, const global float4 *color, global float4 *display)
{
    uint i = get_global_id(0);
    uint j = get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;

    float4 seen = color[pixel];
    float3 light = seen.xyz + tone.background.xyz * (1.0f - seen.w);
    float3 v = (float3)(srgb_from_linear(light.x), srgb_from_linear(light.y), srgb_from_linear(light.z));
    v = clamp((v - 0.5f) * tone.contrast + 0.5f + tone.brightness, 0.0f, 1.0f);
    if (tone.inverse_gamma != 1.0f)
        v = pow(v, (float3)(tone.inverse_gamma));
    display[pixel] = (float4)(v, 1.0f);
}
