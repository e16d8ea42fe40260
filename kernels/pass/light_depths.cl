// The optical depth from a light on, at the points of a grid that stands in it: column by column of the rays of a camera in the
// light's place, from point to point along each.
//
// Reads the voxels, the transfer function's knots (emission.clh), the clip planes (index space), per octree node its CLASS_*, and
// a bit per cell in which something absorbs. Writes light_depths from `first` on: `side` layers of side * side numbers, spacing_mm
// apart along the view axis, the first nearest_mm from the eye.
#define SHADOWS SHADOWS_EXACT
#define LAYERS 0
#include "lib/light/feeler.clh"
#include "lib/ray/camera.clh"

kernel void light_depths(VOXELS voxels, SKIP_BY_CLASS, const global float *knot_values, const global float4 *knot_colors,
                         const global float4 *knot_sums, CLIP_PLANES, VolumeGrid volume, RayGrid rays, EmissionCast cast, float nearest_mm,
                         float spacing_mm, uint side, uint first, global float *light_depths)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest column
    Ray ray = camera_ray(rays, pixels);
    Floats longer = length_per_mm(rays, AS_FLOATS(pixels.i), AS_FLOATS(pixels.j));
    Feelers feelers = {{knot_values, knot_colors, cast.knots}, {knot_sums}, cast, volume, skip_by_class(node_class, levels, cells), CLIP_GIVEN};
    feelers.cast.mm_per_t = 1.0f; // along the camera's rays
    Floats depth = FLOATS(0.0f);
    global float *layer = light_depths + first;
    ray.t_max = (nearest_mm - rays.base_mm) * longer;
    for (uint n = 0u; n < side; n++) {
        if (n > 0u) {
            ray.t_min = max_of(ray.t_max, FLOATS(0.0f));
            ray.t_max = (nearest_mm + (float)n * spacing_mm - rays.base_mm) * longer;
            VisibleRays part = visible_rays(pixels, ray, volume, CLIP_GIVEN);
            part.meets = part.meets & depth < DARK_FEELER;
            if (ANY(part.meets))
                depth += part.meets ? depth_along(voxels, &feelers, &part) : FLOATS(0.0f);
        }
        SCATTER(pixels.inside, layer, pixels.index, depth);
        layer += side * side;
    }
}
