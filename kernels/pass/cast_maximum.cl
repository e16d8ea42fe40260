// One value per ray: its maximum or minimum, its mean, or its first local maximum.
//
// PROJECTION_EXTREMUM: the largest of sign * Phi over the samples, and where it is first reached;
// a node is skipped when its range cannot beat the running extremum, which starts at `floor` (Mroz
// et al. 2000). With `probe` the peaks between samples count too.
// PROJECTION_MEAN: the composite trapezoid rule, every sample needed.
// PROJECTION_LOCAL: the first local maximum >= threshold, else the maximum (Sato et al. 1998);
// either end counts when the value falls away from it.
//
// Reads the voxels, the clip planes (index space) and, per octree node, its range and its CLASS_*
// (CLASS_BELOW: nowhere above `floor`). Writes per pixel kind (surface where the ray meets the
// volume) and value (stored units; 0 where it does not); with LAYERS depth (mm from the eye; +inf for
// the mean); with COUNTERS the samples taken and the nodes tested.
#include "old/clip.clh"
#include "old/octree.clh"
#include "old/peak.clh"

#if !defined(PROJECTION) || !defined(PROJECTION_EXTREMUM) || !defined(PROJECTION_MEAN) || !defined(PROJECTION_LOCAL)
#error "PROJECTION, which value is wanted, is given by the host"
#endif

kernel void cast_maximum(const global VOXEL *voxels, const global uchar *node_class, const global float2 *node_range, const global uint4 *levels,
                            const global float4 *clip_planes, uint clip_count,
                            VolumeGrid volume, RayGrid rays, ProjectionCast cast,
                            global uint *kind, global float *value
#if LAYERS
                            , global float *depth
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
    bool meets = interval.enter <= interval.exit;
    float found = 0.0f;
    float found_mm = INFINITY; // from the entry
    uint sample_count = 0u;
    uint node_count = 0u;

    if (meets) {
        Lattice lattice = ray_lattice(volume, ray, interval, cast.step_mm);
#if PROJECTION == PROJECTION_MEAN
        // Compensated summation (Kahan 1965): thousands of samples keep their digits.
        float sum = 0.0f;
        float lost = 0.0f;
        for (uint k = 0u; k <= lattice.last; k++) {
            float t = lattice_t(lattice, k);
            float before = lattice_t(lattice, k == 0u ? 0u : k - 1u);
            float after = lattice_t(lattice, k == lattice.last ? k : k + 1u);
            float v = field_at(voxels, volume, lattice_point(volume, lattice, t));
            float weight = lattice.last == 0u ? 1.0f : 0.5f * (after - before) / lattice.length_mm;
            float term = v * weight - lost;
            float next = sum + term;
            lost = (next - sum) - term;
            sum = next;
            sample_count++;
        }
        found = sum;
#else
        float most = cast.floor; // of sign * Phi
        found_mm = 0.0f;
        bool done = false;
        Walk walk = walk_start(volume, cast.traverse);
        uint3 cell = cell_at(volume, lattice.start);
        uint3 span_cell = cell; // of the span's last sample
        uint3 last_cell = cell; // of the sample before the span
        bool skip = false;
        bool skip_before = false;
        RayPoint here = {0.0f, 0.0f, 0.0f}; // sample k, heights are sign * Phi
        RayPoint before = here;             // sample k - 1
        bool have_here = false;             // whether `here` is sample k - 1 as k's turn comes
        uint end = 0u;                      // of the span
        uint k = 0u;
        while (k <= lattice.last && !done) {
            if (k == end) {
                skip_before = skip;
                end = lattice.last + 1u;
                if (cast.traverse != TRAVERSE_OFF) {
                    cell = cell_at(volume, lattice_point(volume, lattice, lattice_t(lattice, k)));
                    last_cell = span_cell;
                    walk_on(&walk, last_cell, cell);
                    // A climb that has reached the threshold ends where all that follows is lower.
                    bool ties = PROJECTION == PROJECTION_LOCAL && most >= cast.threshold;
                    CellBox box;
                    skip = walk_down_to_beat(&walk, node_class, node_range, levels, cell, cast.sign, most, ties, &box, &node_count);
                    end = span_end(volume, lattice, k, cell, box, &span_cell);
                }
            }
            // A skipped span's first segment matters unless it lies in skipped nodes wholly.
            bool matters = !skip || !(skip_before && leaves_touch(last_cell, cell));
            for (uint m = have_here || k == 0u ? k : k - 1u; m <= k && matters; m++) {
                before = here;
                here = ray_point(voxels, volume, lattice, cast.sign, 0.0f, lattice_t(lattice, m));
                sample_count++;
            }
            RayPoint peak;
            if (matters && k > 0u && cast.probe
                && peak_between(voxels, volume, lattice, cast.sign, 0.0f, most, false, before, here, &peak, &sample_count)) {
                most = peak.height;
                found_mm = peak.t;
            }
#if PROJECTION == PROJECTION_LOCAL
            done = matters && most >= cast.threshold && here.height < most;
#endif
            if (matters && here.height > most) {
                most = here.height;
                found_mm = here.t;
            }
            uint next = skip ? end : k + 1u;
            have_here = matters && next == k + 1u;
            k = next;
        }
        found = cast.sign * most;
#endif
    }

    kind[pixel] = meets ? KIND_SURFACE : KIND_NOTHING;
    value[pixel] = found;
#if LAYERS
    depth[pixel] = ray.base_mm + (interval.enter + found_mm);
#endif
#if COUNTERS
    steps[pixel] = sample_count;
    nodes[pixel] = node_count;
#endif
}
