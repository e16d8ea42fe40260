// The first point of each ray where Phi - iso changes sign.
//
// Fixed steps on the sample lattice (Levoy 1988), spans of nodes that lie wholly on one side of
// the iso value skipped (Lesar et al. 2015, §III-C), the crossing refined between two samples.
// With `probe`, two samples on one side between which the field may turn are looked between for a
// peak on the other side. "Inside" is Phi >= iso. With caps, a ray that enters through a face of
// the volume or a clip plane where it is inside hits there.
//
// Reads the voxels, the clip planes (index space) and, per octree node, its CLASS_*. Writes per pixel
// hit_mm (from the base plane along the ray; +inf: none) and kind; with LAYERS depth (mm from the
// eye) and value at the hit (stored units; 0 without a hit); with COUNTERS the samples taken and the
// nodes tested.
#include "old/clip.clh"
#include "old/octree.clh"
#include "old/peak.clh"
#include "old/refine.clh"

kernel void cast_surface(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels,
                         const global float4 *clip_planes, uint clip_count,
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
    clip_interval(&interval, clip_planes, clip_count, ray);
    float hit = INFINITY; // mm from the entry
    uint met = KIND_NOTHING;
    float hit_value = 0.0f;
    uint sample_count = 0u;
    uint node_count = 0u;

    if (interval.enter <= interval.exit) {
        Lattice lattice = ray_lattice(volume, ray, interval, cast.step_mm);
        Walk walk = walk_start(volume, cast.traverse);
        uint3 cell = cell_at(volume, lattice.start);
        uint3 span_cell = cell; // of the span's last sample
        uint3 last_cell = cell; // of the sample before the span
        uint class = CLASS_VISIT;
        uint class_before = CLASS_VISIT;
        bool inside_before = false;
        RayPoint here = {0.0f, 0.0f, 0.0f}; // sample k, heights above the iso value
        RayPoint before = here;             // sample k - 1
        bool have_here = false;             // whether `here` is sample k - 1 as k's turn comes
        uint end = 0u;          // of the span
        uint k = 0u;
        while (k <= lattice.last && met == KIND_NOTHING) {
            if (k == end) {
                class_before = class;
                end = lattice.last + 1u;
                if (cast.traverse != TRAVERSE_OFF) {
                    cell = cell_at(volume, lattice_point(volume, lattice, lattice_t(lattice, k)));
                    last_cell = span_cell;
                    walk_on(&walk, last_cell, cell);
                    uint byte = walk_down(&walk, node_class, levels, cell, &node_count);
                    class = class_of(byte);
                    end = span_end(volume, lattice, k, cell, node_box(cell, walk.level, reach_of(byte)), &span_cell);
                }
            }
            // A skipped span's first segment matters unless it lies in skipped nodes wholly.
            bool visit = class == CLASS_VISIT;
            bool matters = visit || (k > 0u && !(class == class_before && leaves_touch(last_cell, cell)));
            for (uint m = have_here || k == 0u ? k : k - 1u; m <= k && matters; m++) {
                before = here;
                here = ray_point(voxels, volume, lattice, 1.0f, cast.iso, lattice_t(lattice, m));
                sample_count++;
            }
            bool inside = visit ? here.height >= 0.0f : class == CLASS_ABOVE;
            if (k == 0u) {
                if (inside && cast.caps && interval.by_face) {
                    met = KIND_CAP;
                    hit = 0.0f;
                }
            } else if (matters) {
                bool crosses = inside != inside_before;
                Bracket bracket;
                bracket.near = before.t;
                bracket.far = here.t;
                if (!crosses && cast.probe) {
                    float sign = inside ? -1.0f : 1.0f;
                    RayPoint a = before;
                    RayPoint b = here;
                    RayPoint peak;
                    a.height *= sign;
                    a.slope *= sign;
                    b.height *= sign;
                    b.slope *= sign;
                    crosses = peak_between(voxels, volume, lattice, sign, cast.iso, 0.0f, true, a, b, &peak, &sample_count);
                    bracket.far = crosses ? peak.t : here.t;
                }
                if (crosses) {
                    bracket.f_near = 0.0f;
                    bracket.f_far = 0.0f;
                    bracket.samples = 0u;
                    hit = refine(voxels, volume, lattice, cast.iso, cast.refine, cast.iterations, &bracket);
                    met = KIND_SURFACE;
                    sample_count += bracket.samples;
                }
            }
            inside_before = inside;
            uint next = visit ? k + 1u : end;
            have_here = matters && next == k + 1u;
            k = next;
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
    value[pixel] = hit_value;
#endif
#if COUNTERS
    steps[pixel] = sample_count;
    nodes[pixel] = node_count;
#endif
}
