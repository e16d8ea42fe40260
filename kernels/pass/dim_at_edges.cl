// The light of each pixel, dimmed by a halo of what is nearer within halo_px and by a contour where it is in front of what lies
// contour_px beside it (DepthCues has the formulas).
//
// per_mm: the share of the range of depths that a mm has; halo, contour: the shares of the light that they take. Reads depth
// (+inf: nothing is seen). Reads and writes color.
#include "lib/ray/planes.clh"

// The darkness at `mm` of a contour along a line through the pixels.
static inline Floats bend_along(RayGrid rays, Pixels pixels, const global float *depth, Floats mm, int x, int y, float per_mm)
{
    Pixels ahead = pixels_beside(rays, pixels, x, y);
    Pixels behind = pixels_beside(rays, pixels, -x, -y);
    Floats bend = read_floats(depth, ahead) + read_floats(depth, behind) - 2.0f * mm;
    Floats dark = clamp_to(bend * (CONTOUR_SLOPE * per_mm), FLOATS(0.0f), FLOATS(1.0f));
    return ahead.inside & behind.inside ? dark : FLOATS(0.0f);
}

kernel void dim_at_edges(RayGrid rays, float per_mm, float halo, uint halo_px, float contour, uint contour_px, const global float *depth,
                         global float4 *color)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    Floats mm = read_floats(depth, pixels);
    Mask seen = mm < INFINITY;
    if (!ANY(pixels.inside & seen))
        return;
    mm = seen ? mm : FLOATS(0.0f);
    Floats kept = FLOATS(1.0f);
    if (halo > 0.0f) {
        Floats dark = FLOATS(0.0f);
        int reach = (int)halo_px;
        float per_px = 1.0f / (float)(reach + 1);
        for (int y = -reach; y <= reach; y++) {
            for (int x = -reach; x <= reach; x++) {
                float near = 1.0f - sqrt((float)(x * x + y * y)) * per_px;
                if (near > 0.0f) {
                    Pixels beside = pixels_beside(rays, pixels, x, y);
                    Floats nearer = (mm - read_floats(depth, beside)) * (HALO_SLOPE * per_mm);
                    Floats share = near * clamp_to(nearer, FLOATS(0.0f), FLOATS(1.0f));
                    dark = max_of(dark, beside.inside ? share : FLOATS(0.0f));
                }
            }
        }
        kept *= 1.0f - halo * dark;
    }
    if (contour > 0.0f) {
        int w = (int)contour_px;
        Floats dark = max_of(bend_along(rays, pixels, depth, mm, w, 0, per_mm), bend_along(rays, pixels, depth, mm, 0, w, per_mm));
        dark = max_of(dark, bend_along(rays, pixels, depth, mm, w, w, per_mm));
        dark = max_of(dark, bend_along(rays, pixels, depth, mm, w, -w, per_mm));
        kept *= 1.0f - contour * dark;
    }
    Floats4 light = read_float4(color, pixels);
    light.x = seen ? light.x * kept : light.x;
    light.y = seen ? light.y * kept : light.y;
    light.z = seen ? light.z * kept : light.z;
    scatter_float4(color, pixels, light);
}
