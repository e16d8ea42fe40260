// What each ray meets behind the first vessel's exit: from its first hit on, the first point at which it enters where
// Phi >= iso, after it has left it, exactly (lib/find/crossing.clh). A ray whose first hit was the vessel's exit, as it began
// inside, has left it there.
//
// Only where something uneven is near (lib/ray/blur.clh). Reads the voxels, the clip planes (index space), per octree node its
// CLASS_*, a bit per cell that the surface may cross, reaches of blur_reach, and hit_mm (t of the first hits; +inf: none)
// of a cast. Writes hidden_mm (t; +inf: none), kind and depth (mm from the eye).
#include "lib/find/crossing.clh"
#include "lib/ray/blur.clh"

// The first crossings of rays from t on, in the lanes of `which`, and whether each begins inside.
static inline Crossing crossing_after(VOXELS voxels, SkipGrid grid, VolumeGrid volume, ClipPlanes clip, SurfaceCast cast, Pixels pixels,
                                      Ray ray, Floats t, Mask which, Mask *begins_inside)
{
    cast.caps = 0u;
    ray.t_min = which ? t : FLOATS(0.0f);
    pixels.inside = pixels.inside & which;
    VisibleRays rays = visible_rays(pixels, ray, volume, clip);
    CellMarch march = cell_march(volume, grid, &rays, cast.traverse, true);
    CrossingState state = crossing_start(cast, rays.interval, &march.walk);
    Ints cells_read = INTS(0);
    march_to_crossing(voxels, &march, &state, false, &cells_read);
    Crossing found = crossing_found(&state);
    Mask crosses = rays.meets & found.kind != KIND_NOTHING;
    found.kind = crosses ? found.kind : INTS(KIND_NOTHING);
    found.t = crosses ? rays.interval.enter + found.t : FLOATS(INFINITY);
    *begins_inside = crosses & state.inside;
    return found;
}

kernel void behind_surface(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, SurfaceCast cast, uint squares_across,
                           float after_mm, const global float4 *reaches, const global float *hit_mm, global float *hidden_mm,
                           global uint *kind, global float *depth)
{
    Pixels pixels = RAY_PIXELS();
    Floats t = FLOATS(INFINITY);
    Ray ray = RAY_OF(pixels);
    if (blurred_square(reaches[square_of(pixels, squares_across)]).uneven) {
        SkipGrid grid = skip_by_class(node_class, levels, cells);
        Floats first_mm = read_floats(hit_mm, pixels);
        Mask hit = pixels.inside & first_mm < INFINITY;
        Mask inside = NO_LANE;
        if (ANY(hit)) {
            Crossing next = crossing_after(voxels, grid, volume, CLIP_GIVEN, cast, pixels, ray, first_mm + after_mm, hit, &inside);
            t = hit ? next.t : t;
        }
        Mask left = inside & t < INFINITY;
        if (ANY(left)) {
            Mask still_inside = NO_LANE;
            Crossing next = crossing_after(voxels, grid, volume, CLIP_GIVEN, cast, pixels, ray, t + after_mm, left, &still_inside);
            t = left ? (still_inside ? FLOATS(INFINITY) : next.t) : t;
        }
    }
    Ints met = t < INFINITY ? INTS(KIND_SURFACE) : INTS(KIND_NOTHING);
    Floats depth_mm = ray.base_mm + t;
    SCATTER(pixels.inside, hidden_mm, pixels.index, t);
    SCATTER(pixels.inside, kind, pixels.index, met);
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
}
