// The mean of estimates of occlusion over the pixels around each hit: over squares of 4, in each of which every pixel was
// estimated by sections of its own, at the four places that hold the pixel in their middle. A pixel counts by how near its hit is
// to the tangent plane of the point, and how near to the point, within half of the radius, so that neither what lies before nor
// what lies behind an edge does, however the surface is tilted.
//
// px, radius_mm: as in screen_occlusion.cl. Reads spans, estimate, normal and kind. Writes occlusion.
#include "lib/ray/camera.clh"
#include "lib/ray/planes.clh"

// Half the width of what is averaged, pixels.
#define HALF_WIDTH 2

// How far from the point a hit may lie that counts, as a share of the radius: occlusion is not the same all around.
#define FARTHEST_SHARE 0.5f

// How far from the tangent plane a hit may lie that counts, as a share of the radius; and in pixels, whichever is more.
#define RADIUS_SHARE 0.15f
#define PLANE_PX 0.7f

kernel void smooth_occlusion(RayGrid rays, float4 right, float4 down, float2 px, float radius_mm, const global float2 *spans,
                             const global float *estimate, const global float4 *normal, const global uint *kind, global float *occlusion)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return;
    Mask hit = pixels.inside & read_ints(kind, pixels) == KIND_SURFACE;
    Floats sum = FLOATS(0.0f);
    Floats weights = FLOATS(1.0f);
    if (ANY(hit)) {
        Floats4 n = read_float4(normal, pixels);
        Floats3 dir = direction_per_mm(rays, AS_FLOATS(pixels.i), AS_FLOATS(pixels.j));
        // Heights above the tangent plane, and squares of distances, of a step along a column, a row, and the ray.
        Floats column = n.x * right.x + n.y * right.y + n.z * right.z;
        Floats row = n.x * down.x + n.y * down.y + n.z * down.z;
        Floats along = n.x * dir.x + n.y * dir.y + n.z * dir.z;
        Floats column_along = dir.x * right.x + dir.y * right.y + dir.z * right.z;
        Floats row_along = dir.x * down.x + dir.y * down.y + dir.z * down.z;
        Floats per_mm = dot_of(dir, dir);
        Floats front = read_float2(spans, pixels).x;
        Floats near_mm = max_of(FLOATS(RADIUS_SHARE * radius_mm), PLANE_PX * (px.x + px.y * front));
        Floats per_height = 1.0f / near_mm;
        float per_square = 1.0f / (FARTHEST_SHARE * FARTHEST_SHARE * radius_mm * radius_mm);
        weights = FLOATS(0.0f);
        for (int y = -HALF_WIDTH; y <= HALF_WIDTH; y++) {
            for (int x = -HALF_WIDTH; x <= HALF_WIDTH; x++) {
                Pixels beside = pixels_beside(rays, pixels, x, y);
                Floats2 span = read_float2(spans, beside);
                Mask seen = beside.inside & span.y >= span.x;
                Floats value = read_floats(estimate, beside);
                float share = (x == -HALF_WIDTH || x == HALF_WIDTH ? 0.5f : 1.0f) * (y == -HALF_WIDTH || y == HALF_WIDTH ? 0.5f : 1.0f);
                Floats mm = px.x + px.y * span.x;
                Floats apart = span.x - front;
                Floats height = mm * ((float)x * column + (float)y * row) + apart * along;
                Floats square = mm * mm * (float)(x * x + y * y) + apart * apart * per_mm
                              + 2.0f * mm * apart * ((float)x * column_along + (float)y * row_along);
                Floats weight = max_of(1.0f - fabs(height) * per_height, FLOATS(0.0f)) * max_of(1.0f - square * per_square, FLOATS(0.0f));
                weight = seen ? share * weight : FLOATS(0.0f);
                sum += weight > 0.0f ? weight * value : FLOATS(0.0f);
                weights += weight;
            }
        }
    }
    scatter_floats(occlusion, pixels, hit ? sum / weights : FLOATS(0.0f));
}
