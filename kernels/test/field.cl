// The field at each point of a volume of `size` voxels, and its slope along each direction.
#define LANES 1
#include "lib/volume/field.clh"

kernel void field(uint count, uint4 size, VOXELS voxels, const global float4 *points,
                  const global float4 *dirs, global float *values, global float2 *with_slope)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    VolumeGrid volume;
    volume.nx = size.x;
    volume.ny = size.y;
    volume.nz = size.z;
    Floats3 p = {points[i].x, points[i].y, points[i].z};
    Floats3 dir = {dirs[i].x, dirs[i].y, dirs[i].z};
    Floats slope;
    Floats value = field_slope_at(voxels, volume, p, dir, &slope);
    values[i] = field_at(voxels, volume, p);
    with_slope[i] = (float2)(value, slope);
}
