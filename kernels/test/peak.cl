// The peak between two samples of each ray: rays hold the ends' t, the sign and the goal.
#define LANES 1
#include "lib/find/peak.clh"

kernel void peak(uint count, uint4 size, VOXELS voxels, float4 start, float4 dir, float length_mm, uint first,
                 const global float4 *rays, global float4 *peaks, global uint *found)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    VolumeGrid volume;
    volume.nx = size.x;
    volume.ny = size.y;
    volume.nz = size.z;
    Lattice lattice;
    lattice.volume = volume;
    lattice.start.x = start.x;
    lattice.start.y = start.y;
    lattice.start.z = start.z;
    lattice.dir.x = dir.x;
    lattice.dir.y = dir.y;
    lattice.dir.z = dir.z;
    lattice.length_mm = length_mm;
#if JITTERED
    lattice.ahead = 0.0f;
#endif
    float sign = rays[i].z;
    RayPoint a = ray_point(voxels, &lattice, sign, 0.0f, true, rays[i].x);
    RayPoint b = ray_point(voxels, &lattice, sign, 0.0f, true, rays[i].y);
    RayPoint best = {0.0f, 0.0f, 0.0f};
    Ints samples = INTS(0);
    Goal goal = {sign, 0.0f, rays[i].w, first != 0u};
    Segment segment = {a, b};
    found[i] = peak_between(voxels, &lattice, goal, segment, ALL_LANES, &best, &samples) ? 1u : 0u;
    peaks[i] = (float4)(best.t, best.height, best.slope, (float)samples);
}
