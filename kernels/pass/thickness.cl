// How far each ray goes on behind its hit, to its next crossing of the surface or to the end of its visible part; and the span
// of depths that it spends there. With MARCHED the ray is followed, by the march that found the hit; else it is `constant_mm`.
//
// spans: where the ray enters and where it leaves, mm along the view axis `forward` (unit, world space) from the base plane
// (RayGrid); 0 and -1 where it meets nothing.
//
// Reads hit_mm and kind of a cast, and with MARCHED the voxels, the clip planes (index space), per octree node its CLASS_*, and a
// bit per cell that the surface may cross. Writes with SPANS spans, with LAYERS thick (mm).
#include "lib/find/leaving.clh"
#include "lib/ray/planes.clh"

#if MARCHED
#define MARCH_INPUTS VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume,
#define HOW_THICK SurfaceCast cast, float start_mm
#else
#define MARCH_INPUTS
#define HOW_THICK float constant_mm
#endif
#if SPANS
#define SPAN_PLANE , float4 forward, global float2 *spans
#else
#define SPAN_PLANE
#endif
#if LAYERS
#define THICK_PLANE , global float *thick
#else
#define THICK_PLANE
#endif

#if MARCHED
// The ray from so far behind its hit on that no rounding puts its beginning before it.
static inline Ray ray_behind(Ray ray, Pair3 at, float start_mm)
{
    ray.origin = at;
    ray.t_min = FLOATS(start_mm);
    ray.t_max = FLOATS(INFINITY);
    return ray;
}
#endif

kernel void thickness(MARCH_INPUTS RAY_SOURCE, HOW_THICK, const global float *hit_mm, const global uint *kind SPAN_PLANE THICK_PLANE)
{
    Pixels pixels = RAY_PIXELS();
    Ints met = read_ints(kind, pixels);
    Mask hit = pixels.inside & met != KIND_NOTHING;
    Floats t = FLOATS(0.0f);
    Floats mm = FLOATS(0.0f);
    if (ANY(hit)) {
        t = read_floats(hit_mm, pixels);
        t = hit ? t : FLOATS(0.0f);
#if MARCHED
        Ray ray = RAY_OF(pixels);
        Mask surface = hit & met == KIND_SURFACE;
        Mask inside = hit;
        Pair3 at = ray_at(ray, t);
#if FILTER_LINEAR
        // Hits at fixed steps lie beside the surface.
        SurfacePoint point = surface_point(voxels, volume, ray, t, cast.iso, SETTLING_STEPS, surface);
        at.x = pair_if(surface, point.at.x, at.x);
        at.y = pair_if(surface, point.at.y, at.y);
        at.z = pair_if(surface, point.at.z, at.z);
        inside = inside & !(surface & point.inside);
#endif
        Pixels own = pixels;
        own.inside = hit;
        VisibleRays visible = visible_rays(own, ray_behind(ray, at, start_mm), volume, CLIP_GIVEN);
        CellMarch march = cell_march(volume, skip_by_class(node_class, levels, cells), &visible, cast.traverse, false);
        cast.caps = 0u;
        CrossingState state = crossing_start(cast, visible.interval, &march.walk);
#if FILTER_LINEAR
        state.begun = ALL_LANES;
        state.inside = inside;
#endif
        Ints cells_read = INTS(0);
        march_to_crossing(voxels, &march, &state, FILTER_LINEAR, &cells_read);
        Floats until = state.found.kind != KIND_NOTHING ? visible.interval.enter + state.found.t : visible.interval.exit;
        mm = visible.meets ? until : FLOATS(0.0f);
#else
        mm = FLOATS(constant_mm);
#endif
    }
#if LAYERS
    scatter_floats(thick, pixels, hit ? mm : FLOATS(0.0f));
#endif
#if SPANS
    Floats3 dir = RAY_OF(pixels).dir_world;
    Floats per_mm = dir.x * forward.x + dir.y * forward.y + dir.z * forward.z;
    Floats2 span = {hit ? t * per_mm : FLOATS(0.0f), hit ? (t + mm) * per_mm : FLOATS(-1.0f)};
    scatter_float2(spans, pixels, span);
#endif
}
