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

kernel void exact_surface(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels,
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
    uint i = get_global_id(0);
    uint j = get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;

    Ray ray = pixel_ray(rays, i, j);
    Interval interval = volume_interval(volume, ray);
    clip_interval(&interval, clip_planes, clip_count, ray);
    Crossing found;
    found.t = INFINITY;
    found.kind = KIND_NOTHING;
    found.certificate = only_touches(interval) ? CERTIFICATE_UNDECIDED : CERTIFICATE_MISS;
    float hit_value = 0.0f;
    uint cells_read = 0u;
    uint nodes_tested = 0u;
    if (interval.enter <= interval.exit) {
        found = first_crossing(voxels, node_class, levels, volume, ray, interval, cast, &cells_read, &nodes_tested);
#if LAYERS
        if (found.kind != KIND_NOTHING)
            hit_value = field_at(voxels, volume, clamp_to_domain(volume, ray_at(ray, interval.enter + found.t).high));
#endif
    }

    hit_mm[pixel] = interval.enter + found.t;
    kind[pixel] = found.kind;
#if LAYERS
    depth[pixel] = ray.base_mm + (interval.enter + found.t);
    value[pixel] = hit_value;
#endif
#if CERTIFICATE
    certificate[pixel] = found.certificate;
#endif
#if COUNTERS
    steps[pixel] = cells_read;
    nodes[pixel] = nodes_tested;
#endif
}
