// A picture blurred along its rows or its columns by a Gaussian, of which three standard deviations to either side are used.
// Places beyond the picture's edge are as the pixels at the edge.
//
// Reads color (linear light, premultiplied). Writes blurred.
#include "lib/ray/planes.clh"

kernel void blur_along(RayGrid rays, uint columns, float deviation_px, const global float4 *color, global float4 *blurred)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    int reach = (int)ceil(3.0f * deviation_px);
    Floats4 sum = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    float weights = 0.0f;
    for (int n = -reach; n <= reach; n++) {
        float z = (float)n / deviation_px;
        float weight = exp(-0.5f * z * z);
        Ints i = clamp_ints(pixels.i + (columns ? 0 : n), INTS(0), INTS((int)rays.width - 1));
        Ints j = clamp_ints(pixels.j + (columns ? n : 0), INTS(0), INTS((int)rays.height - 1));
        Floats4 there = gather_float4(color, j * (int)rays.width + i);
        sum.x += weight * there.x;
        sum.y += weight * there.y;
        sum.z += weight * there.z;
        sum.w += weight * there.w;
        weights += weight;
    }
    sum.x /= weights;
    sum.y /= weights;
    sum.z /= weights;
    sum.w /= weights;
    scatter_float4(blurred, pixels, sum);
}
