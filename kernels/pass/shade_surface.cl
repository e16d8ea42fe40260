// The colour of each hit surface: linear light, premultiplied, opaque where something was hit.
//
// Reads kind of cast_surface and, with SHADED, normal of surface_normal. Writes color.
#include "old/ray.clh"
#include "old/shade.clh"

kernel void shade_surface(RayGrid rays, Shading shading, const global uint *kind
#if SHADED
                          , const global float4 *normal
#endif
                          , global float4 *color)
{
    uint i = get_global_id(0);
    uint j = get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;

    float4 seen = (float4)(0.0f);
    if (kind[pixel] != KIND_NOTHING) {
        float3 rgb = shading.color.xyz;
#if SHADED
        Ray ray = pixel_ray(rays, i, j);
        rgb = reflect_light(shading, rgb, normal[pixel].xyz, -ray.dir_world);
#endif
        seen = (float4)(rgb, 1.0f);
    }
    color[pixel] = seen;
}
