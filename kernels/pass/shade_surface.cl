// The colour of each hit surface: linear light, premultiplied, opaque where something was hit.
//
// Reads kind of cast_surface and, with SHADED, normal of surface_normal. Writes color.
#include "lib/ray/planes.clh"
#include "lib/ray/source.clh"
#include "lib/light/shade.clh"

kernel void shade_surface(RAY_SOURCE, Shading shading, const global uint *kind
#if SHADED
                          , const global float4 *normal
#endif
                          , global float4 *color)
{
    Pixels pixels = RAY_PIXELS();
    Mask hit = read_ints(kind, pixels) != KIND_NOTHING;
    Floats4 seen = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    if (ANY(hit)) {
        Floats3 rgb = {FLOATS(shading.color.x), FLOATS(shading.color.y), FLOATS(shading.color.z)};
#if SHADED
        Floats4 n = read_float4(normal, pixels);
        Floats3 facing = {n.x, n.y, n.z};
        Ray ray = RAY_OF(pixels);
        rgb = reflect_light(shading, rgb, facing, direction_to_eye(ray));
#endif
        seen.x = hit ? rgb.x : seen.x;
        seen.y = hit ? rgb.y : seen.y;
        seen.z = hit ? rgb.z : seen.z;
        seen.w = hit ? FLOATS(1.0f) : seen.w;
    }
    scatter_float4(color, pixels, seen);
}
