// Emission and absorption along each ray, front to back (Levoy 1988; Max 1995).
//
// C = sum of c * T * (1 - exp(-absorption * w)), where w is each sample's share of the path in mm.
// Samples sit at both ends and in the middle of each step, with the weights of Simpson's rule; what
// is left before the exit, less than a step, has those of the trapezoid rule. All shares are
// positive and tile the ray, so that opacity depends on path length alone and never leaves 0..1.
// Nodes whose whole range is transparent are skipped. A ray ends once its transmission falls below
// least_transmission: the colour lost is at most least_transmission times the brightest colour.
//
// Reads the voxels, the transfer function's knots (values in stored units; colours linear light
// with opacity in w), the clip planes (index space) and, per octree node, its CLASS_*. Writes color,
// premultiplied linear light; with COUNTERS the samples taken and the nodes tested.
#include "lib/clip.clh"
#include "lib/gradient.clh"
#include "lib/octree.clh"
#include "lib/shade.clh"
#include "lib/transfer.clh"

// Half steps that end before the exit, or at it but for rounding.
static inline uint full_half_steps(Lattice lattice)
{
    float over = (float)lattice.last * lattice.step_mm - lattice.length_mm;
    return over <= 1e-4f * lattice.step_mm || lattice.last == 0u ? lattice.last : lattice.last - 1u;
}

// The share of the path of sample k of a lattice of half steps, in mm. Simpson's rule holds on the
// first `simpson` half steps, an even number.
static inline float path_share_mm(Lattice lattice, uint simpson, uint k)
{
    float half_mm = lattice.step_mm;
    if ((k & 1u) == 1u && k < simpson)
        return half_mm * (4.0f / 3.0f);
    float before = k <= simpson ? half_mm * (1.0f / 3.0f) : 0.5f * (lattice_t(lattice, k) - lattice_t(lattice, k - 1u));
    float after = k < simpson ? half_mm * (1.0f / 3.0f) : 0.5f * (lattice_t(lattice, k + 1u) - lattice_t(lattice, k));
    return (k == 0u ? 0.0f : before) + (k == lattice.last ? 0.0f : after);
}

kernel void cast_emission(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels,
                          const global float *knot_values, const global float4 *knot_colors,
                          const global float4 *clip_planes, uint clip_count,
#if SHADED && GRADIENT == GRADIENT_PRECOMPUTED
                          const global short *directions, uint4 direction_grid,
#endif
                          VolumeGrid volume, RayGrid rays, EmissionCast cast, Shading shading,
                          global float4 *color
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
    float3 emitted = (float3)(0.0f);
    float optical_depth = 0.0f;
    float lost = 0.0f; // of the optical depth by rounding: thousands of thin samples keep their digits
    float transmission = 1.0f;
    uint sample_count = 0u;
    uint node_count = 0u;

    if (interval.enter <= interval.exit) {
        Lattice lattice = ray_lattice(volume, ray, interval, 0.5f * cast.step_mm);
        uint simpson = full_half_steps(lattice) & ~1u;
        Walk walk = walk_start(volume, cast.traverse);
        uint3 cell = cell_at(volume, lattice.start);
        uint3 span_cell = cell; // of the last sample of the span before
        uint k = 0u;
        while (k <= lattice.last && transmission >= cast.least_transmission) {
            bool skip = false;
            uint end = lattice.last + 1u;
            if (cast.traverse != TRAVERSE_OFF) {
                cell = cell_at(volume, lattice_point(volume, lattice, lattice_t(lattice, k)));
                walk_on(&walk, span_cell, cell);
                uint byte = walk_down(&walk, node_class, levels, cell, &node_count);
                skip = class_of(byte) != CLASS_VISIT;
                end = span_end(volume, lattice, k, cell, node_box(cell, walk.level, reach_of(byte)), &span_cell);
            }
            for (; k < end && !skip && transmission >= cast.least_transmission; k++) {
                float t = lattice_t(lattice, k);
                float3 p = lattice_point(volume, lattice, t);
                float4 seen = transfer_at(knot_values, knot_colors, cast.knots, field_at(voxels, volume, p));
                sample_count++;
                if (seen.w > 0.0f) {
                    float depth_here = absorption_per_mm(cast, seen.w) * path_share_mm(lattice, simpson, k);
                    float3 rgb = seen.xyz;
#if SHADED
                    float3 toward_eye = -ray.dir_world;
                    GradientSource source;
#if GRADIENT == GRADIENT_PRECOMPUTED
                    source.directions = directions;
                    source.grid = direction_grid;
#else
                    source.voxels = voxels;
#endif
                    rgb = reflect_light(shading, rgb, field_normal(source, volume, p, toward_eye), toward_eye);
#endif
                    emitted += rgb * (transmission * -expm1(-depth_here));
                    float term = depth_here - lost; // Kahan 1965
                    float sum = optical_depth + term;
                    lost = (sum - optical_depth) - term;
                    optical_depth = sum;
                    transmission = exp(-optical_depth);
                }
            }
            k = end;
        }
    }

    color[pixel] = (float4)(emitted, -expm1(-optical_depth));
#if COUNTERS
    steps[pixel] = sample_count;
    nodes[pixel] = node_count;
#endif
}
