// Where each ray, its direction per mm, is inside a volume of `sizes` voxels: `entry` holds the
// axis of the face that it enters by and whether it enters by a face at all.
#define LANES 1
#include "lib/ray/interval.clh"

kernel void interval(uint count, const global uint4 *sizes, const global float4 *origins, const global float4 *dirs,
                     global float2 *inside, global uint4 *entry)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    VolumeGrid volume;
    volume.nx = sizes[i].x;
    volume.ny = sizes[i].y;
    volume.nz = sizes[i].z;
    Ray ray;
    ray.origin.x = pair_of(origins[i].x, 0.0f);
    ray.origin.y = pair_of(origins[i].y, 0.0f);
    ray.origin.z = pair_of(origins[i].z, 0.0f);
    ray.dir.x = pair_of(dirs[i].x, 0.0f);
    ray.dir.y = pair_of(dirs[i].y, 0.0f);
    ray.dir.z = pair_of(dirs[i].z, 0.0f);
    ray.t_min = 0.0f;
    ray.t_max = INFINITY;
    Interval found = volume_interval(volume, ray);
    inside[i] = (float2)(found.enter, found.exit);
    entry[i] = (uint4)((uint)found.axis, found.by_face ? 1u : 0u, 0u, 0u);
}
