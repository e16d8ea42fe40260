// The unit normal where each ray hit: toward lower values, in world space; a cap's is the
// outward normal of its face or clip plane. Zero where nothing was hit.
//
// Reads the voxels or, with GRADIENT_PRECOMPUTED, directions of gradients, hit_mm and kind of cast_surface, and the clip planes (index space). Writes
// normal (w = 0).
#include "lib/clip.clh"
#include "lib/gradient.clh"
#include "lib/plane.clh"

kernel void surface_normal(
#if GRADIENT == GRADIENT_PRECOMPUTED
                           const global short *directions, uint4 direction_grid,
#else
                           VOXELS voxels,
#endif
                           const global float4 *clip_planes, uint clip_count,
                           VolumeGrid volume, RayGrid rays,
                           const global float *hit_mm, const global uint *kind, global float4 *normal)
{
    Pixels pixels = tile_pixels(rays);
    Ints met = pixels_ints(kind, pixels);
    Floats4 n = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    Mask hit = met != KIND_NOTHING;
    if (ANY(hit)) {
        Ray ray = pixel_ray(rays, pixels);
        Floats3 toward_eye = {-ray.dir_world.x, -ray.dir_world.y, -ray.dir_world.z};
        Mask cap = met == KIND_CAP;
        Mask surface = hit & !cap;
        if (ANY(surface)) {
            Floats mm = pixels_floats(hit_mm, pixels);
            Pair3 at = ray_at(ray, surface ? mm : FLOATS(0.0f));
            Floats3 p = {at.x.high, at.y.high, at.z.high};
#if GRADIENT == GRADIENT_PRECOMPUTED
            Directions precomputed = {directions, direction_grid};
#endif
            Floats3 slope = field_normal(GRADIENT_FROM(voxels, precomputed), volume, clamp_to_domain(volume, p), toward_eye);
            n.x = surface ? slope.x : n.x;
            n.y = surface ? slope.y : n.y;
            n.z = surface ? slope.z : n.z;
        }
        if (ANY(cap)) {
            Interval interval = volume_interval(volume, ray);
            clip_interval(&interval, clip_planes, clip_count, ray);
            Floats3 outward = world_normal(volume, entry_covector(interval, clip_planes, ray, cap), toward_eye);
            n.x = cap ? outward.x : n.x;
            n.y = cap ? outward.y : n.y;
            n.z = cap ? outward.z : n.z;
        }
    }
    put_fours(normal, pixels, n);
}
