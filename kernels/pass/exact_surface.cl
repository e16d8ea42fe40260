// The first point of each ray where Phi - iso changes sign, exactly: cell by cell, the field's cubic
// solved in each (lib/find/crossing.clh); nodes that lie wholly on one side of the iso value are leapt
// over. "Inside" is Phi >= iso. With caps, a ray that enters through a face of the volume or a clip
// plane where it is inside hits there.
//
// Reads the voxels, the clip planes (index space), per octree node its CLASS_*, and a bit per cell that the
// surface may cross. Writes per ray hit_mm (t; +inf: none) and kind; with LAYERS depth (mm from the eye) and
// value at the hit (stored units; 0 without a hit); with CERTIFICATE what is proven of the ray, CERTIFICATE_*;
// with COUNTERS the cells read and the nodes tested.
#include "lib/find/crossing.clh"
#include "lib/ray/cast_planes.clh"

#if CERTIFICATE
#define CERTIFICATE_PLANE , global uint *certificate
#else
#define CERTIFICATE_PLANE
#endif

kernel void exact_surface(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, SurfaceCast cast,
                          global float *hit_mm, global uint *kind DEPTH_PLANE VALUE_PLANE CERTIFICATE_PLANE COUNTER_PLANES)
{
    Pixels pixels = RAY_PIXELS();
    VisibleRays visible = visible_rays(pixels, RAY_OF(pixels), volume, CLIP_GIVEN);
    Ints cells_read = INTS(0);
    Ints nodes_tested = INTS(0);
    SkipGrid grid = skip_by_class(node_class, levels, cells);
    Crossing found = first_crossing(voxels, grid, volume, &visible, cast, &cells_read, &nodes_tested);
    Floats t = visible.interval.enter + found.t;

    SCATTER(pixels.inside, hit_mm, pixels.index, t);
    SCATTER(pixels.inside, kind, pixels.index, found.kind);
#if LAYERS
    Mask hit = found.kind != KIND_NOTHING;
    Pair3 p = ray_at(visible.ray, hit ? t : visible.interval.enter);
    Floats3 at = {p.x.high, p.y.high, p.z.high};
    Floats phi = hit ? field_at(voxels, volume, clamp_to_domain(volume, at)) : FLOATS(0.0f);
    Floats depth_mm = visible.ray.base_mm + t;
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
    SCATTER(pixels.inside, value, pixels.index, phi);
#endif
#if CERTIFICATE
    Ints missed = only_touches(visible.interval) ? INTS(CERTIFICATE_UNDECIDED) : INTS(CERTIFICATE_MISS);
    Ints proven = visible.meets ? found.certificate : missed;
    SCATTER(pixels.inside, certificate, pixels.index, proven);
#endif
    WRITE_COUNTERS(pixels, cells_read, nodes_tested);
}
