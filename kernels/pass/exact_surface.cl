// The first point of each ray where Phi - iso changes sign, exactly: cell by cell, the field's cubic
// solved in each (lib/crossing.clh); nodes that lie wholly on one side of the iso value are leapt
// over. "Inside" is Phi >= iso. With caps, a ray that enters through a face of the volume or a clip
// plane where it is inside hits there.
//
// Reads the voxels, the clip planes (index space) and, per octree node, its CLASS_*. Writes per pixel hit_mm (from the base plane
// along the ray; +inf: none) and kind; with LAYERS depth (mm from the eye) and value at the hit
// (stored units; 0 without a hit); with CERTIFICATE what is proven of the pixel, CERTIFICATE_*; with
// COUNTERS the cells read and the nodes tested.
#include "lib/clip.clh"
#include "lib/crossing.clh"

kernel void exact_surface(VOXELS voxels, const global uchar *node_class, const global uint4 *levels, const global ulong *cells,
                          const global float4 *clip_planes, uint clip_count,
                          VolumeGrid volume, RayGrid rays, SurfaceCast cast,
                          global float *hit_mm, global uint *kind
#if LAYERS
                          , global float *depth, global float *value
#endif
#if CERTIFICATE
                          , global uint *certificate
#endif
#if COUNTERS
                          , global uint *steps, global uint *nodes
#endif
)
{
    Pixels pixels = tile_pixels(rays);
    Ray ray = pixel_ray(rays, pixels);
    Interval interval = volume_interval(volume, ray);
    clip_interval(&interval, clip_planes, clip_count, ray);
    Mask meets = pixels.inside & interval.enter <= interval.exit;
    Ints cells_read = INTS(0);
    Ints nodes_tested = INTS(0);
    Crossing found = first_crossing(voxels, node_class, levels, cells, volume, ray, interval, cast, meets, &cells_read, &nodes_tested);
    Floats t = interval.enter + found.t;

    SCATTER(pixels.inside, hit_mm, pixels.index, t);
    SCATTER(pixels.inside, kind, pixels.index, found.kind);
#if LAYERS
    Mask hit = found.kind != KIND_NOTHING;
    Pair3 p = ray_at(ray, hit ? t : interval.enter);
    Floats3 at = {p.x.high, p.y.high, p.z.high};
    Floats seen = hit ? field_at(voxels, volume, clamp_to_domain(volume, at)) : FLOATS(0.0f);
    Floats depth_mm = ray.base_mm + t;
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
    SCATTER(pixels.inside, value, pixels.index, seen);
#endif
#if CERTIFICATE
    Ints missed = only_touches(interval) ? INTS(CERTIFICATE_UNDECIDED) : INTS(CERTIFICATE_MISS);
    Ints proven = meets ? found.certificate : missed;
    SCATTER(pixels.inside, certificate, pixels.index, proven);
#endif
#if COUNTERS
    SCATTER(pixels.inside, steps, pixels.index, cells_read);
    SCATTER(pixels.inside, nodes, pixels.index, nodes_tested);
#endif
}
