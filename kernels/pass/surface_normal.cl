// The unit normal where each ray hit: toward lower values, in world space; a cap's is the
// outward normal of its face or clip plane. Zero where nothing was hit.
//
// Reads the voxels or, with GRADIENT_PRECOMPUTED, directions of gradients, hit_mm and kind of a cast, and the
// clip planes (index space). Writes normal (w = 0).
#include "lib/ray/planes.clh"
#include "lib/ray/visible.clh"
#include "lib/volume/gradient.clh"

kernel void surface_normal(GRADIENT_ARGUMENTS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE,
                           const global float *hit_mm, const global uint *kind, global float4 *normal)
{
    Pixels pixels = RAY_PIXELS();
    Ints met = read_ints(kind, pixels);
    Floats4 n = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    Mask hit = met != KIND_NOTHING;
    if (ANY(hit)) {
        Ray ray = RAY_OF(pixels);
        Floats3 toward_eye = direction_to_eye(ray);
        Mask cap = met == KIND_CAP;
        Mask surface = hit & !cap;
        if (ANY(surface)) {
            Floats mm = read_floats(hit_mm, pixels);
            Pair3 at = ray_at(ray, surface ? mm : FLOATS(0.0f));
            Floats3 p = {at.x.high, at.y.high, at.z.high};
            Floats3 slope = field_normal(GRADIENT_GIVEN, volume, clamp_to_domain(volume, p), toward_eye);
            n.x = surface ? slope.x : n.x;
            n.y = surface ? slope.y : n.y;
            n.z = surface ? slope.z : n.z;
        }
        if (ANY(cap)) {
            Interval interval = visible_interval(volume, CLIP_GIVEN, ray);
            Floats3 outward = world_normal(volume, entry_covector(interval, CLIP_GIVEN, ray, cap), toward_eye);
            n.x = cap ? outward.x : n.x;
            n.y = cap ? outward.y : n.y;
            n.z = cap ? outward.z : n.z;
        }
    }
    scatter_float4(normal, pixels, n);
}
