// What a surface keeps from the hits of rays that pass listed pixels beside their centres, where it is known: the mean over the
// nine pixels around each, weighted by the inverse square of the distance of their hits; 0 where those meet nothing.
//
// A work-item takes one ray, of per_side * per_side in each pixel. right, down, px: as in smooth_occlusion.cl. Reads spans and
// occlusion of the centres, and sample_hit_mm and sample_kind of the rays' own cast. Writes sample_occlusion.
#if LANES != 1
#error "a work-item takes one ray"
#endif
#include "lib/ray/camera.clh"

// The distance of neighbouring rays below a share of which hits are the same.
#define SAME_PX 0.1f

kernel void occlusion_between(RayGrid rays, const global uint2 *listed, uint first, uint count, uint per_side, float4 right, float4 down,
                              float2 px, const global float2 *spans, const global float *occlusion, const global float *sample_hit_mm,
                              const global uint *sample_kind, global float *sample_occlusion)
{
    uint n = (uint)(get_global_id(1) * get_global_size(0) + get_global_id(0));
    uint per_pixel = per_side * per_side;
    if (n >= count * per_pixel)
        return;
    float sum = 0.0f;
    float weights = 0.0f;
    if (sample_kind[n] == KIND_SURFACE) {
        uint pixel = listed[first + n / per_pixel].x;
        int i = (int)(pixel % rays.width);
        int j = (int)(pixel / rays.width);
        float x = ((float)(n % per_side) + 0.5f) / (float)per_side - 0.5f;
        float y = ((float)(n % per_pixel / per_side) + 0.5f) / (float)per_side - 0.5f;
        Floats3 dir = direction_per_mm(rays, (float)i + x, (float)j + y);
        float column_along = dir.x * right.x + dir.y * right.y + dir.z * right.z;
        float row_along = dir.x * down.x + dir.y * down.y + dir.z * down.z;
        float per_mm = dot_of(dir, dir);
        float front = sample_hit_mm[n] / sqrt(per_mm);
        for (int v = -1; v <= 1; v++) {
            for (int u = -1; u <= 1; u++) {
                int column = i + u;
                int row = j + v;
                if (column < 0 || row < 0 || column >= (int)rays.width || row >= (int)rays.height)
                    continue;
                int place = row * (int)rays.width + column;
                float2 span = spans[place];
                float mm = px.x + px.y * span.x;
                float right_mm = mm * ((float)u - x);
                float down_mm = mm * ((float)v - y);
                float apart = span.x - front;
                float square = right_mm * right_mm + down_mm * down_mm + apart * apart * per_mm
                             + 2.0f * apart * (right_mm * column_along + down_mm * row_along);
                float weight = span.y >= span.x ? 1.0f / (square + SAME_PX * SAME_PX * mm * mm) : 0.0f;
                sum += weight * occlusion[place];
                weights += weight;
            }
        }
    }
    sample_occlusion[n] = weights > 0.0f ? sum / weights : 0.0f;
}
