// The colour of each hit surface: linear light, premultiplied, opaque where something was hit.
//
// Reads kind of a surface's cast and, with SHADED, its hit_mm and normal of surface_normal; with OCCLUSION too, the occlusion of
// light from everywhere, which shows by `strength`, with VISIBILITY what reaches the hits of each light. Writes color.
#include "lib/ray/planes.clh"
#include "lib/ray/source.clh"
#include "lib/light/shade.clh"

#if SHADED
#define HITS const global float *hit_mm,
#define NORMAL_PLANE , const global float4 *normal
#else
#define HITS
#define NORMAL_PLANE
#endif
#if SHADED && OCCLUSION
#define OCCLUSION_PLANE , float strength, const global float *occlusion
#else
#define OCCLUSION_PLANE
#endif

#if SHADED && VISIBILITY
#define LIGHTS_PLANE , const global float4 *lights_reached
#else
#define LIGHTS_PLANE
#endif

kernel void shade_surface(RAY_SOURCE, Shading shading, HITS const global uint *kind NORMAL_PLANE OCCLUSION_PLANE LIGHTS_PLANE, global float4 *color)
{
    Pixels pixels = RAY_PIXELS();
    Mask hit = read_ints(kind, pixels) != KIND_NOTHING;
    Floats4 seen = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    if (ANY(hit)) {
        Floats3 rgb = {FLOATS(shading.color.x), FLOATS(shading.color.y), FLOATS(shading.color.z)};
#if SHADED
        Ray ray = RAY_OF(pixels);
        Floats mm = read_floats(hit_mm, pixels);
        Pair3 at = ray_at(ray, hit ? mm : FLOATS(0.0f));
        Floats4 n = read_float4(normal, pixels);
        LitPoint point = {{at.x.high, at.y.high, at.z.high}, {n.x, n.y, n.z}, direction_to_eye(ray)};
        Floats reached = FLOATS(1.0f);
#if OCCLUSION
        reached -= strength * read_floats(occlusion, pixels);
#endif
#if VISIBILITY
        Floats4 lights = read_float4(lights_reached, pixels);
        Floats visible[MAX_LIGHTS] = {lights.x, lights.y, lights.z, lights.w};
        rgb = reflect_lights(&shading, rgb, point, reached, visible);
#else
        rgb = reflect_lights(&shading, rgb, point, reached, 0);
#endif
#endif
        seen.x = hit ? rgb.x : seen.x;
        seen.y = hit ? rgb.y : seen.y;
        seen.z = hit ? rgb.z : seen.z;
        seen.w = hit ? FLOATS(1.0f) : seen.w;
    }
    scatter_float4(color, pixels, seen);
}
