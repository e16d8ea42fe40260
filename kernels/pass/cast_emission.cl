// Emission and absorption along each ray, front to back (Levoy 1988; Max 1995), at a fixed step.
//
// A panel is the stretch between two samples of the lattice, the last and shorter one between the
// last full step and the exit; QUADRATURE says at which nodes it is looked at and what they weigh
// (lib/quadrature.clh, lib/preintegrated.clh). Panels tile the ray, so that opacity depends on path
// length alone. A panel is left out where it lies in transparent nodes wholly: it would add exactly
// nothing. With HOMOGENEOUS, the samples of a leaf of that class are one panel of the value that stands for
// the leaf. A ray ends once its transmission falls below least_transmission: the colour lost is at most
// least_transmission times the brightest colour.
//
// Reads the voxels, the transfer function's knots (values in stored units; colours linear light
// with opacity in w; sums as mean_medium has them), the clip planes (index space) and, per octree
// node, its CLASS_*; with HOMOGENEOUS what stands for each leaf. Writes color, premultiplied linear light;
// with LAYERS depth (mm from the eye) and value (stored units), with NORMALS the normal: means along the
// ray, weighted as its light is, where the opacity is layers_from at least, else +inf and 0; with COUNTERS
// the samples taken and the nodes tested.
#include "lib/clip.clh"
#include "lib/gather.clh"
#include "lib/medium.clh"
#include "lib/plane.clh"
#include "lib/preintegrated.clh"
#include "lib/means.clh"
#include "lib/stretches.clh"

// With the nearest filter no value lies between two samples' own: there is nothing to integrate.
#define INTEGRATES (QUADRATURE == QUADRATURE_PREINTEGRATED && FILTER_LINEAR)

// What rays look at.
typedef struct {
    Transfer transfer;
#if INTEGRATES
    KnotSums knot_sums;
#endif
    VolumeGrid volume;
    Lattice lattice;
    EmissionCast cast;
#if HAS_GRADIENT && GRADIENT == GRADIENT_PRECOMPUTED
    Directions directions;
#endif
    Shading shading;
    Floats3 toward_eye;
} Sight;

static inline Floats phi_at(VOXELS voxels, const Sight *sight, Floats t)
{
    return field_at(voxels, sight->volume, lattice_point(sight->volume, &sight->lattice, t));
}

#if HAS_GRADIENT
static inline Medium lit_at(VOXELS voxels, const Sight *sight, Floats t, Medium medium)
{
    Floats3 p = lattice_point(sight->volume, &sight->lattice, t);
    return lit_medium(GRADIENT_FROM(voxels, sight->directions), sight->volume, sight->shading, sight->toward_eye, p, medium);
}
#else
#define lit_at(voxels, sight, t, medium) (medium)
#endif

#if !INTEGRATES
static inline Medium medium_at(VOXELS voxels, const Sight *sight, Floats t)
{
    Medium medium = medium_of(sight->transfer, sight->cast, phi_at(voxels, sight, t));
    place_light(&medium.light, t);
    return lit_at(voxels, sight, t, medium);
}
#endif

// The panel between two samples of the lattice. What is known of the first is `near`; what is known of the
// second takes its place. NODE_SAMPLES: how many samples that takes.
#if INTEGRATES
typedef Floats Node; // Phi
#define NODE_SAMPLES 1
#define NODE_AT phi_at
#define NODE_UNKNOWN FLOATS(0.0f)

static inline Node node_if(Mask mask, Node a, Node b) { return mask ? a : b; }

static inline Panel panel_at(VOXELS voxels, const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    Node first = *near;
    Node last = phi_at(voxels, sight, t_far);
    *near = last;
    Medium mean = mean_medium(sight->transfer, sight->knot_sums, sight->cast, first, last);
    return panel_linear(lit_at(voxels, sight, t_near + 0.5f * length_mm, mean), first, last, t_near, length_mm);
}
#elif QUADRATURE == QUADRATURE_RIEMANN
typedef Floats Node; // samples are not shared
#define NODE_SAMPLES 1
#define NODE_UNKNOWN FLOATS(0.0f)

static inline Panel panel_at(VOXELS voxels, const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    return panel_even(medium_at(voxels, sight, t_near), t_near, t_far - t_near);
}
#elif QUADRATURE == QUADRATURE_MIDPOINT
typedef Floats Node; // samples are not shared
#define NODE_SAMPLES 1
#define NODE_UNKNOWN FLOATS(0.0f)

static inline Panel panel_at(VOXELS voxels, const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    return panel_even(medium_at(voxels, sight, t_near + 0.5f * length_mm), t_near, length_mm);
}
#else
typedef Medium Node;
#define NODE_AT medium_at
#define NODE_UNKNOWN clear_medium()
#define node_if medium_if

#if QUADRATURE == QUADRATURE_ROMBERG
#define NODE_SAMPLES 4 // nodes lie evenly
#elif QUADRATURE == QUADRATURE_PREINTEGRATED
#define NODE_SAMPLES 1 // either value for half the panel
#else
#define NODE_SAMPLES 2
#endif

static inline Panel panel_at(VOXELS voxels, const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    Medium nodes[NODE_SAMPLES + 1];
    nodes[0] = *near;
    for (int n = 1; n <= NODE_SAMPLES; n++)
        nodes[n] = medium_at(voxels, sight, n == NODE_SAMPLES ? t_far : t_near + (float)n * (length_mm / (float)NODE_SAMPLES));
    *near = nodes[NODE_SAMPLES];
#if QUADRATURE == QUADRATURE_ROMBERG
    return panel_romberg(nodes[0], nodes[1], nodes[2], nodes[3], nodes[4], length_mm);
#elif QUADRATURE == QUADRATURE_RK4
    return panel_rk4(nodes[0], nodes[1], nodes[2], length_mm);
#elif QUADRATURE == QUADRATURE_PREINTEGRATED
    return panel_halves(nodes[0], nodes[1], length_mm);
#else
    return panel_simpson(nodes[0], nodes[1], nodes[2], length_mm);
#endif
}
#endif

// Gathers the next panel, in the lanes of `which`: panel k lies between samples k - 1 and k, of which the
// first may be known from the panel before.
static inline void gather_panel(VOXELS voxels, const Sight *sight, Gathered *gathered, Stretch *stretch, Node *near, Mask which, Ints *samples)
{
    Floats t_near = lattice_t(&sight->lattice, stretch->k - 1);
    Floats t_far = lattice_t(&sight->lattice, stretch->k);
#ifdef NODE_AT
    Mask missing = which & !stretch->known;
    if (ANY(missing)) {
        *near = node_if(missing, NODE_AT(voxels, sight, t_near), *near);
        *samples += missing ? INTS(1) : INTS(0);
    }
    Node far = *near;
    gather(gathered, panel_at(voxels, sight, t_near, t_far, &far), which);
    *near = node_if(which, far, *near);
    stretch->known = stretch->known | which;
#else
    gather(gathered, panel_at(voxels, sight, t_near, t_far, near), which);
#endif
    *samples += which ? INTS(NODE_SAMPLES) : INTS(0);
    stretch->k += which ? INTS(1) : INTS(0);
}

// Gathers along rays until each has come to its end, in the lanes of `alive`.
static inline void gather_along(VOXELS voxels, const Sight *sight, Gathered *gathered, const global uchar *node_class,
#if HOMOGENEOUS
                                const global float *node_average,
#endif
                                const global uint4 *levels, const global ulong *cells, Ray ray, Interval interval, Mask alive,
                                Ints *samples, Ints *nodes_tested)
{
    const Lattice *lattice = &sight->lattice;
    VolumeGrid volume = sight->volume;
    uint traverse = sight->cast.traverse;
    Stretch stretch = stretch_up_to(traverse == TRAVERSE_OFF ? lattice->last : INTS(0));
    stretch.k = INTS(1);
    Spans spans = spans_start(volume, lattice, traverse);
#if HOMOGENEOUS
    Ints begin = INTS(0); // of the present span
#endif
    Node near = NODE_UNKNOWN;
    bool together = false;
    Beam beam;
    CellWalk walk;
#if FILTER_LINEAR && !HOMOGENEOUS
    if (traverse == TRAVERSE_DISTANCE) {
        walk = cells_start(volume, ray, interval);
        together = beam_start(&beam, &walk, levels, volume, alive);
    }
#endif
    for (;;) {
        alive = alive & gathered->transmission >= sight->cast.least_transmission;
        if (together) {
            while (ANY(alive) && !ANY(alive & stretch.k <= stretch.last)) {
                BeamRegion region;
                if (!beam_next(&beam, voxels, node_class, cells, 0.0f, &region, nodes_tested))
                    alive = NO_LANE;
                else if (region.class == CLASS_VISIT)
                    stretch_into(&stretch, lattice, &beam, region, &walk, alive);
            }
        } else if (traverse != TRAVERSE_OFF) {
            Mask arrives = alive & stretch.k > stretch.last;
            while (ANY(arrives)) {
#if HOMOGENEOUS
                Mask same = arrives & spans.class == CLASS_HOMOGENEOUS;
                if (ANY(same)) {
                    Walk leaves = walk_start(volume, TRAVERSE_UNIFORM);
                    Floats average = GATHER(Floats, node_average, AS_UINTS(node_index(levels, spans.cell, &leaves)));
                    Floats t_near = lattice_t(lattice, begin);
                    Floats length_mm = lattice_t(lattice, spans.end - 1) - t_near;
                    Medium all = lit_at(voxels, sight, t_near + 0.5f * length_mm, medium_of(sight->transfer, sight->cast, average));
                    gather(gathered, panel_even(all, t_near, length_mm), same);
                    alive = alive & gathered->transmission >= sight->cast.least_transmission;
                    arrives = arrives & alive;
                }
                begin = arrives ? spans.end : begin;
#endif
                Mask goes_on = spans_leave(&spans, volume, lattice, arrives);
                alive = alive & !(arrives & !goes_on);
                Ints byte = walk_down(&spans.way, node_class, levels, spans.cell, goes_on, nodes_tested);
                CellBox box;
                box.low = box.high = spans.cell;
                set_box(&box, spans.cell, spans.way.level, reach_of(byte), goes_on);
                spans_enter(&spans, &stretch, volume, lattice, class_of(byte), &box, goes_on);
                stretch.k = stretch.k > 0 ? stretch.k : INTS(1); // no panel ends at the first sample
                arrives = goes_on & stretch.k > stretch.last;
            }
        }
        Mask looking = alive & stretch.k <= stretch.last;
#if HOMOGENEOUS && FILTER_LINEAR
        if (traverse == TRAVERSE_DISTANCE)
            looking = pass_clear(&stretch, volume, lattice, cells, looking);
        if (ANY(alive) && !ANY(looking))
            continue;
#endif
        if (!ANY(looking))
            return;
        do {
            gather_panel(voxels, sight, gathered, &stretch, &near, looking, samples);
            looking = looking & stretch.k <= stretch.last & gathered->transmission >= sight->cast.least_transmission;
        } while (together && ANY(looking));
    }
}

kernel void cast_emission(VOXELS voxels, const global uchar *node_class, const global uint4 *levels, const global ulong *cells,
                          const global float *knot_values, const global float4 *knot_colors,
#if INTEGRATES
                          const global float4 *knot_sums,
#if LAYERS
                          const global float *knot_value_sums,
#endif
#endif
#if HOMOGENEOUS
                          const global float *node_average,
#endif
                          const global float4 *clip_planes, uint clip_count,
#if HAS_GRADIENT && GRADIENT == GRADIENT_PRECOMPUTED
                          const global short *directions, uint4 direction_grid,
#endif
                          VolumeGrid volume, RayGrid rays, EmissionCast cast, Shading shading,
                          global float4 *color
#if LAYERS
                          , global float *depth, global float *value
#endif
#if NORMALS
                          , global float4 *normal
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
    Mask alive = pixels.inside & interval.enter <= interval.exit;
    Gathered gathered = gather_start();
    Ints sample_count = INTS(0);
    Ints node_count = INTS(0);
    if (ANY(alive)) {
        Sight sight;
        sight.transfer.values = knot_values;
        sight.transfer.colors = knot_colors;
        sight.transfer.knots = cast.knots;
#if INTEGRATES
        sight.knot_sums.sums = knot_sums;
#if LAYERS
        sight.knot_sums.value_sums = knot_value_sums;
#endif
#endif
        sight.volume = volume;
        sight.lattice = ray_lattice(volume, ray, interval, cast.step_mm);
        sight.cast = cast;
#if HAS_GRADIENT && GRADIENT == GRADIENT_PRECOMPUTED
        Directions precomputed = {directions, direction_grid};
        sight.directions = precomputed;
#endif
        sight.shading = shading;
        sight.toward_eye.x = -ray.dir_world.x;
        sight.toward_eye.y = -ray.dir_world.y;
        sight.toward_eye.z = -ray.dir_world.z;
#if HOMOGENEOUS
        gather_along(voxels, &sight, &gathered, node_class, node_average, levels, cells, ray, interval, alive, &sample_count, &node_count);
#else
        gather_along(voxels, &sight, &gathered, node_class, levels, cells, ray, interval, alive, &sample_count, &node_count);
#endif
    }

    Floats4 seen = {gathered.light.rgb.x, gathered.light.rgb.y, gathered.light.rgb.z, kept_back(gathered.depth)};
    put_fours(color, pixels, seen);
#if LAYERS
    put_depth_and_value(depth, value, &gathered.light, seen.w >= cast.layers_from, ray.base_mm + interval.enter, pixels);
#endif
#if NORMALS
    put_normal(normal, &gathered.light, seen.w >= cast.layers_from, ray, pixels);
#endif
#if COUNTERS
    SCATTER(pixels.inside, steps, pixels.index, sample_count);
    SCATTER(pixels.inside, nodes, pixels.index, node_count);
#endif
}
