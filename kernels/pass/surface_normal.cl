// The unit normal where each ray hit: toward lower values, in world space; a cap's is the
// outward normal of its face or clip plane. Zero where nothing was hit.
//
// Reads the voxels or, with GRADIENT_PRECOMPUTED, directions of gradients, hit_mm and kind of cast_surface, and the clip planes (index space). Writes
// normal (w = 0).
#include "old/clip.clh"
#include "old/gradient.clh"

kernel void surface_normal(
#if GRADIENT == GRADIENT_PRECOMPUTED
                           const global short *directions, uint4 direction_grid,
#else
                           const global VOXEL *voxels,
#endif
                           const global float4 *clip_planes, uint clip_count,
                           VolumeGrid volume, RayGrid rays,
                           const global float *hit_mm, const global uint *kind, global float4 *normal)
{
    uint i = get_global_id(0);
    uint j = get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;

    float3 n = (float3)(0.0f);
    if (kind[pixel] != KIND_NOTHING) {
        Ray ray = pixel_ray(rays, i, j);
        float3 toward_eye = -ray.dir_world;
        if (kind[pixel] == KIND_CAP) {
            Interval interval = volume_interval(volume, ray);
            clip_interval(&interval, clip_planes, clip_count, ray);
            n = world_normal(volume, entry_covector(interval, clip_planes, ray), toward_eye);
        } else {
            float3 p = clamp_to_domain(volume, ray_at(ray, hit_mm[pixel]).high);
            GradientSource source;
#if GRADIENT == GRADIENT_PRECOMPUTED
            source.directions = directions;
            source.grid = direction_grid;
#else
            source.voxels = voxels;
#endif
            n = field_normal(source, volume, p, toward_eye);
        }
    }
    normal[pixel] = (float4)(n, 0.0f);
}
