// Emission and absorption along each ray, front to back (Levoy 1988; Max 1995), at a fixed step.
//
// A panel is the stretch between two samples of the lattice, the last and shorter one between the
// last full step and the exit; QUADRATURE says at which nodes it is looked at and what they weigh
// (lib/quadrature.clh, lib/preintegrated.clh). Panels tile the ray, so that opacity depends on path
// length alone. A panel is left out where it lies in transparent nodes wholly: it would add exactly
// nothing. With HOMOGENEOUS, the samples of a leaf of that class are one panel of the leaf's average
// value. A ray ends once its transmission falls below least_transmission: the colour lost is at most
// least_transmission times the brightest colour.
//
// Reads the voxels, the transfer function's knots (values in stored units; colours linear light
// with opacity in w; sums as mean_medium has them), the clip planes (index space) and, per octree
// node, its CLASS_* and average. Writes color, premultiplied linear light; with COUNTERS the samples
// taken and the nodes tested.
#include "old/clip.clh"
#include "old/gather.clh"
#include "old/medium.clh"
#include "old/octree.clh"
#include "old/preintegrated.clh"

// What a ray looks at.
typedef struct {
    const global VOXEL *voxels;
    const global float *knot_values;
    const global float4 *knot_colors;
#if QUADRATURE == QUADRATURE_PREINTEGRATED
    const global float4 *knot_sums;
#endif
    VolumeGrid volume;
    Lattice lattice;
    EmissionCast cast;
#if SHADED
    GradientSource gradient;
#endif
    Shading shading;
    float3 toward_eye;
} Sight;

// The panel between two samples of the lattice. `near`, what is known of the first, is found unless
// `known`; what is known of the second takes its place.
#if QUADRATURE == QUADRATURE_PREINTEGRATED
typedef float Node; // Phi

static inline float phi_at(Sight sight, float t)
{
    return field_at(sight.voxels, sight.volume, lattice_point(sight.volume, sight.lattice, t));
}

static inline Panel panel_at(Sight sight, float t_near, float t_far, Node *near, bool known, uint *samples)
{
    float length_mm = t_far - t_near;
    Node first = known ? *near : phi_at(sight, t_near);
    Node last = phi_at(sight, t_far);
    *samples += known ? 1u : 2u;
    *near = last;
    Medium mean = mean_medium(sight.knot_values, sight.knot_colors, sight.knot_sums, sight.cast, first, last);
#if SHADED
    float3 middle = lattice_point(sight.volume, sight.lattice, t_near + 0.5f * length_mm);
    mean = lit_medium(sight.gradient, sight.volume, sight.shading, sight.toward_eye, middle, mean);
#endif
    return panel_midpoint(mean, length_mm);
}
#else
static inline Medium medium_at(Sight sight, float t)
{
    float3 p = lattice_point(sight.volume, sight.lattice, t);
    Medium medium = medium_of(sight.knot_values, sight.knot_colors, sight.cast, field_at(sight.voxels, sight.volume, p));
#if SHADED
    medium = lit_medium(sight.gradient, sight.volume, sight.shading, sight.toward_eye, p, medium);
#endif
    return medium;
}

#if QUADRATURE == QUADRATURE_RIEMANN
typedef uint Node; // samples are not shared

static inline Panel panel_at(Sight sight, float t_near, float t_far, Node *near, bool known, uint *samples)
{
    *samples += 1u;
    return panel_riemann(medium_at(sight, t_near), t_far - t_near);
}
#elif QUADRATURE == QUADRATURE_MIDPOINT
typedef uint Node; // samples are not shared

static inline Panel panel_at(Sight sight, float t_near, float t_far, Node *near, bool known, uint *samples)
{
    float length_mm = t_far - t_near;
    *samples += 1u;
    return panel_midpoint(medium_at(sight, t_near + 0.5f * length_mm), length_mm);
}
#else
typedef Medium Node;

#if QUADRATURE == QUADRATURE_ROMBERG
#define LAST 4u // of the nodes, which lie evenly
#else
#define LAST 2u
#endif

static inline Panel panel_at(Sight sight, float t_near, float t_far, Node *near, bool known, uint *samples)
{
    float length_mm = t_far - t_near;
    Medium nodes[LAST + 1u];
    if (known)
        nodes[0] = *near;
    for (uint n = known ? 1u : 0u; n <= LAST; n++) {
        nodes[n] = medium_at(sight, n == LAST ? t_far : t_near + (float)n * (length_mm / (float)LAST));
        *samples += 1u;
    }
    *near = nodes[LAST];
#if QUADRATURE == QUADRATURE_ROMBERG
    return panel_romberg(nodes[0], nodes[1], nodes[2], nodes[3], nodes[4], length_mm);
#elif QUADRATURE == QUADRATURE_RK4
    return panel_rk4(nodes[0], nodes[1], nodes[2], length_mm);
#else
    return panel_simpson(nodes[0], nodes[1], nodes[2], length_mm);
#endif
}
#endif
#endif

kernel void cast_emission(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels,
                          const global float *knot_values, const global float4 *knot_colors,
#if QUADRATURE == QUADRATURE_PREINTEGRATED
                          const global float4 *knot_sums,
#endif
#if HOMOGENEOUS
                          const global float *node_average,
#endif
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
    Gathered gathered = gather_start();
    uint sample_count = 0u;
    uint node_count = 0u;

    if (interval.enter <= interval.exit) {
        Lattice lattice = ray_lattice(volume, ray, interval, cast.step_mm);
        Sight sight;
        sight.voxels = voxels;
        sight.knot_values = knot_values;
        sight.knot_colors = knot_colors;
#if QUADRATURE == QUADRATURE_PREINTEGRATED
        sight.knot_sums = knot_sums;
#endif
        sight.volume = volume;
        sight.lattice = lattice;
        sight.cast = cast;
#if SHADED
#if GRADIENT == GRADIENT_PRECOMPUTED
        sight.gradient.directions = directions;
        sight.gradient.grid = direction_grid;
#else
        sight.gradient.voxels = voxels;
#endif
#endif
        sight.shading = shading;
        sight.toward_eye = -ray.dir_world;
        Walk walk = walk_start(volume, cast.traverse);
        uint3 cell = cell_at(volume, lattice.start);
        uint3 span_cell = cell; // of the span's last sample
        uint3 last_cell = cell; // of the sample before the span
        uint class = CLASS_VISIT;
        uint class_before = CLASS_VISIT;
        Node near;              // sample k - 1
        bool have_near = false; // whether it is known as k's turn comes
        uint end = 0u;          // of the span
        uint k = 0u;
        while (k <= lattice.last && gathered.transmission >= cast.least_transmission) {
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
            // A panel is left out where it lies in transparent nodes wholly.
            bool matters = k > 0u
                        && !(class == CLASS_BELOW && class_before == CLASS_BELOW && leaves_touch(last_cell, cell));
            if (matters)
                gather(&gathered, panel_at(sight, lattice_t(lattice, k - 1u), lattice_t(lattice, k), &near, have_near, &sample_count));
            uint next = class == CLASS_VISIT ? k + 1u : end;
#if HOMOGENEOUS
            if (class == CLASS_HOMOGENEOUS && gathered.transmission >= cast.least_transmission) {
                Medium all = medium_of(knot_values, knot_colors, cast, node_average[node_index(levels, cell, 0u)]);
                gather(&gathered, panel_midpoint(all, lattice_t(lattice, end - 1u) - lattice_t(lattice, k)));
            }
#endif
            have_near = matters && next == k + 1u;
            k = next;
        }
    }

    color[pixel] = gathered_color(gathered);
#if COUNTERS
    steps[pixel] = sample_count;
    nodes[pixel] = node_count;
#endif
}
