// The light of each pixel, dimmed by a halo of what is nearer within halo_px, and by a contour on the rim of what is in front of
// what lies contour_px beside it (DepthCues has the formulas).
//
// per_mm: the share of the range of depths that a mm has; halo, contour: the shares of the light that they take. Reads depth
// (+inf: nothing is seen). Reads and writes color.
#include "lib/ray/planes.clh"

// The size of a bend where something is seen in the middle of the three depths, infinite where nothing is; none where one of
// them lies outside the picture.
static inline Floats bend_size(Floats before, Floats middle, Floats behind, Mask inside)
{
    Floats bend = middle < INFINITY ? fabs(before + behind - 2.0f * middle) : FLOATS(INFINITY);
    return inside ? bend : FLOATS(0.0f);
}

// The darkness of a contour of what is seen at `mm`, in front of what lies so many columns and rows ahead, where it goes on
// behind.
static inline Floats contour_ahead(RayGrid rays, Pixels pixels, const global float *depth, Floats mm, int x, int y, float per_mm)
{
    Pixels ahead = pixels_beside(rays, pixels, x, y);
    Pixels one = pixels_beside(rays, pixels, -x, -y);
    Floats one_mm = read_floats(depth, one);
    Mask inside = ahead.inside & one.inside;
    Floats bend = read_floats(depth, ahead) + one_mm - 2.0f * mm;
    bend = inside ? bend : FLOATS(0.0f);
    if (!ANY(bend > 0.0f))
        return FLOATS(0.0f);
    Pixels two = pixels_beside(rays, pixels, -2 * x, -2 * y);
    Pixels three = pixels_beside(rays, pixels, -3 * x, -3 * y);
    Floats two_mm = read_floats(depth, two);
    Floats behind = max_of(bend_size(mm, one_mm, two_mm, one.inside & two.inside),
                           bend_size(one_mm, two_mm, read_floats(depth, three), one.inside & two.inside & three.inside));
    Floats excess = behind < INFINITY ? bend - CONTOUR_EXCESS * behind : FLOATS(0.0f);
    return clamp_to(excess * (CONTOUR_SLOPE * per_mm), FLOATS(0.0f), FLOATS(1.0f));
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
        Floats dark = FLOATS(0.0f);
        for (int y = -1; y <= 1; y++) {
            for (int x = -1; x <= 1; x++) {
                if (x != 0 || y != 0)
                    dark = max_of(dark, contour_ahead(rays, pixels, depth, mm, w * x, w * y, per_mm));
            }
        }
        kept *= 1.0f - contour * dark;
    }
    Floats4 light = read_float4(color, pixels);
    light.x = seen ? light.x * kept : light.x;
    light.y = seen ? light.y * kept : light.y;
    light.z = seen ? light.z * kept : light.z;
    scatter_float4(color, pixels, light);
}
