// The first point of each ray where Phi - iso changes sign.
//
// Fixed steps on the sample lattice (Levoy 1988), spans of nodes that lie wholly on one side of
// the iso value skipped (Lesar et al. 2015, §III-C), the crossing refined between two samples.
// "Inside" is Phi >= iso. With caps, a ray that enters through a face of the volume where it is
// inside hits there.
//
// Reads the voxels and, per octree node, its CLASS_*. Writes per pixel hit_mm (from the base plane
// along the ray; +inf: none) and kind; with LAYERS depth (mm from the eye) and the physical value
// at the hit; with COUNTERS the samples taken and the nodes tested.
#include "lib/refine.clh"
#include "lib/octree.clh"

kernel void cast_surface(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels,
                         VolumeGrid volume, RayGrid rays, SurfaceCast cast,
                         global float *hit_mm, global uint *kind
#if LAYERS
                         , global float *depth, global float *value
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
    float hit = INFINITY; // mm from the entry
    uint met = KIND_NOTHING;
    float hit_value = 0.0f;
    uint sample_count = 0u;
    uint node_count = 0u;

    if (interval.enter <= interval.exit) {
        Lattice lattice = ray_lattice(volume, ray, interval, cast.step_mm);
        Walk walk = walk_start(volume, cast.traverse);
        uint3 cell = cell_at(volume, lattice.start);
        bool inside_before = false;
        uint k = 0u;
        while (k <= lattice.last && met == KIND_NOTHING) {
            uint class = CLASS_VISIT;
            uint end = lattice.last + 1u;
            if (cast.traverse != TRAVERSE_OFF) {
                for (;;) {
                    class = node_class[node_index(levels, cell, walk.level)];
                    node_count++;
                    if (class != CLASS_VISIT || walk.level == 0u)
                        break;
                    walk.level--;
                }
                end = span_end(volume, lattice, k, cell, walk.level);
            }
            // Of a span on one side, the first sample tells all.
            uint sampled_end = class == CLASS_VISIT ? end : k + 1u;
            for (; k < sampled_end; k++) {
                bool inside = class == CLASS_ABOVE;
                if (class == CLASS_VISIT) {
                    inside = iso_distance(voxels, volume, lattice, cast.iso, lattice_t(lattice, k)) >= 0.0f;
                    sample_count++;
                }
                if (k == 0u) {
                    inside_before = inside;
                    if (inside && cast.caps && interval.by_face) {
                        met = KIND_CAP;
                        hit = 0.0f;
                        break;
                    }
                } else if (inside != inside_before) {
                    Bracket bracket;
                    bracket.near = lattice_t(lattice, k - 1u);
                    bracket.far = lattice_t(lattice, k);
                    bracket.f_near = 0.0f;
                    bracket.f_far = 0.0f;
                    bracket.samples = 0u;
                    hit = refine(voxels, volume, lattice, cast.iso, cast.refine, cast.iterations, &bracket);
                    met = KIND_SURFACE;
                    sample_count += bracket.samples;
                    break;
                }
            }
            k = end;
            if (k <= lattice.last) {
                uint3 before = cell;
                cell = cell_at(volume, lattice_point(volume, lattice, lattice_t(lattice, k)));
                walk_on(&walk, before, cell);
            }
        }
#if LAYERS
        if (met != KIND_NOTHING)
            hit_value = field_at(voxels, volume, lattice_point(volume, lattice, hit));
#endif
    }

    hit_mm[pixel] = met == KIND_NOTHING ? INFINITY : interval.enter + hit;
    kind[pixel] = met;
#if LAYERS
    depth[pixel] = met == KIND_NOTHING ? INFINITY : ray.base_mm + (interval.enter + hit);
    value[pixel] = met == KIND_NOTHING ? 0.0f : volume.slope * hit_value + volume.intercept;
#endif
#if COUNTERS
    steps[pixel] = sample_count;
    nodes[pixel] = node_count;
#endif
}
