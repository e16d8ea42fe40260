// The first crossings of rays that are given one by one, in index space: what exact_surface does for
// a picture's. The rays stand in rows of `width`.
//
// Reads the voxels, per octree node its CLASS_*, and per ray its origin and direction. Writes hit
// (in lengths of the direction from the origin; +inf: none), KIND_* and CERTIFICATE_*.
#include "old/crossing.clh"

kernel void aimed_rays(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels,
                       VolumeGrid volume, SurfaceCast cast, uint count, uint width,
                       const global float4 *origins, const global float4 *dirs,
                       global float *hit, global uint *kind, global uint *certificate)
{
    uint column = get_global_id(0);
    uint i = get_global_id(1) * width + column;
    if (column >= width || i >= count)
        return;
    Ray ray;
    ray.origin = origins[i].xyz;
    ray.origin_low = (float3)(0.0f);
    ray.dir = dirs[i].xyz;
    ray.dir_low = (float3)(0.0f);
    ray.dir_world = ray.dir;
    ray.base_mm = 0.0f;
    Interval interval = volume_interval(volume, ray);
    Crossing found;
    found.t = INFINITY;
    found.kind = KIND_NOTHING;
    found.certificate = only_touches(interval) ? CERTIFICATE_UNDECIDED : CERTIFICATE_MISS;
    uint cells_read = 0u;
    uint nodes_tested = 0u;
    if (interval.enter <= interval.exit)
        found = first_crossing(voxels, node_class, levels, volume, ray, interval, cast, &cells_read, &nodes_tested);
    hit[i] = interval.enter + found.t;
    kind[i] = found.kind;
    certificate[i] = found.certificate;
}
