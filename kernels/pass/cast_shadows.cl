// How much of each light reaches the hits of a surface: the share of rays toward it, spread over the disc of the sky that it
// fills, which do not meet the surface before the light (those from t_min on along index_direction, lib/find/leaving.clh). 0
// where the light is behind the surface, 1 for one at the eye; before caps the kept part of the volume is empty.
//
// Reads the voxels, the clip planes (index space), per octree node its CLASS_*, a bit per cell that the surface may cross, sets
// of directions about the middle of a light, and hit_mm, kind and normal of a cast. Writes lights_reached, a component a light,
// and with VISIBILITY that of the first light as visibility; 0 where nothing was hit.
#include "lib/find/leaving.clh"
#include "lib/find/ray_sets.clh"
#include "lib/light/toward_light.clh"
#include "lib/ray/planes.clh"

#if VISIBILITY
#define VISIBILITY_PLANE , global float *visibility
#else
#define VISIBILITY_PLANE
#endif

kernel void cast_shadows(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, SurfaceCast cast, Shading shading, RAY_SET_SOURCE,
                         float t_min, const global float *hit_mm, const global uint *kind, const global float4 *normal,
                         global float4 *lights_reached VISIBILITY_PLANE)
{
    Pixels pixels = RAY_PIXELS();
    Ints met = read_ints(kind, pixels);
    Mask hit = pixels.inside & met == KIND_SURFACE;
    Mask cap = pixels.inside & met == KIND_CAP;
    Floats reached[MAX_LIGHTS];
    for (uint n = 0u; n < MAX_LIGHTS; n++)
        reached[n] = met != KIND_NOTHING ? FLOATS(1.0f) : FLOATS(0.0f);
    if (ANY(hit | cap)) {
        Ray ray = RAY_OF(pixels);
        Floats4 outward = read_float4(normal, pixels);
        Floats mm = read_floats(hit_mm, pixels);
        SurfacePoint point = surface_point(voxels, volume, ray, mm, cast.iso, SETTLING_STEPS, hit);
        point.normal.x = cap ? outward.x : point.normal.x;
        point.normal.y = cap ? outward.y : point.normal.y;
        point.normal.z = cap ? outward.z : point.normal.z;
        Pair3 at = ray_at(ray, hit | cap ? mm : FLOATS(0.0f));
        LitPoint lit = {{at.x.high, at.y.high, at.z.high}, point.normal, direction_to_eye(ray)};
        SkipGrid grid = skip_by_class(node_class, levels, cells);
        Ints first = first_of_set(pixels, RAY_IN_PIXEL(pixels), per_set);
        for (uint n = 0u; n < shading.light_count; n++) {
            const LightSource *light = &shading.lights[n];
            if (light->shines_from == LIGHT_FROM_EYE)
                continue;
            Floats3 toward = toward_light(&shading, light, lit);
            Tangents tangents = tangents_of(toward);
            Floats t_light = t_of_light(volume, light, lit.place, toward);
            Ints open = INTS(0);
            for (uint k = 0u; k < per_set; k++) {
                Floats3 dir = about_normal(toward, tangents, gather_float4(ray_sets, first + (int)k));
                Mask faces = (hit | cap) & dot_of(point.normal, dir) > 0.0f;
                Mask meets = meets_again(voxels, grid, volume, CLIP_GIVEN, cast, point, dir, t_min, t_light, faces & hit);
                open += faces & !meets ? INTS(1) : INTS(0);
            }
            reached[n] = AS_FLOATS(open) / (float)per_set;
        }
    }
    Floats4 all = {reached[0], reached[1], reached[2], reached[3]};
    scatter_float4(lights_reached, pixels, all);
#if VISIBILITY
    SCATTER(pixels.inside, visibility, pixels.index, reached[0]);
#endif
}
