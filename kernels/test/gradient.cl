// The field's gradient at each point of a volume of `size` voxels, and the normal made of it by the
// map of covectors with these rows, which is `fallback` where the gradient vanishes.
#define LANES 1
#include "lib/volume/gradient.clh"

kernel void gradient(uint count, uint4 size, float4 row_x, float4 row_y, float4 row_z,
#if GRADIENT == GRADIENT_PRECOMPUTED
                     const global short *directions, uint4 direction_grid,
#else
                     VOXELS voxels,
#endif
                     const global float4 *points, float4 fallback,
                     global float4 *gradients, global float4 *normals)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    VolumeGrid volume;
    volume.nx = size.x;
    volume.ny = size.y;
    volume.nz = size.z;
    volume.gradient_row_x = row_x;
    volume.gradient_row_y = row_y;
    volume.gradient_row_z = row_z;
#if GRADIENT == GRADIENT_PRECOMPUTED
    Directions precomputed = {directions, direction_grid};
#endif
    Floats3 p = {points[i].x, points[i].y, points[i].z};
    Floats3 instead = {fallback.x, fallback.y, fallback.z};
    Floats3 gradient = field_gradient(GRADIENT_FROM(voxels, precomputed), volume, p);
    Floats3 normal = field_normal(GRADIENT_FROM(voxels, precomputed), volume, p, instead);
    gradients[i] = (float4)(gradient.x, gradient.y, gradient.z, 0.0f);
    normals[i] = (float4)(normal.x, normal.y, normal.z, 0.0f);
}
