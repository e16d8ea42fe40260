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
#include "lib/beam.clh"
#include "lib/clip.clh"
#include "lib/gather.clh"
#include "lib/lattice.clh"
#include "lib/medium.clh"
#include "lib/plane.clh"
#include "lib/preintegrated.clh"
#include "lib/spans.clh"

// What rays look at.
typedef struct {
    const global VOXEL *voxels;
    Transfer transfer;
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
    Floats3 toward_eye;
} Sight;

static inline Floats phi_at(const Sight *sight, Floats t)
{
    return field_at(sight->voxels, sight->volume, lattice_point(sight->volume, &sight->lattice, t));
}

#if QUADRATURE != QUADRATURE_PREINTEGRATED
static inline Medium medium_at(const Sight *sight, Floats t)
{
    Medium medium = medium_of(sight->transfer, sight->cast, phi_at(sight, t));
#if SHADED
    Floats3 p = lattice_point(sight->volume, &sight->lattice, t);
    medium = lit_medium(sight->gradient, sight->volume, sight->shading, sight->toward_eye, p, medium);
#endif
    return medium;
}
#endif

// The panel between two samples of the lattice. What is known of the first is `near`; what is known of the
// second takes its place. NODE_SAMPLES: how many samples that takes.
#if QUADRATURE == QUADRATURE_PREINTEGRATED
typedef Floats Node; // Phi
#define NODE_SAMPLES 1
#define NODE_AT phi_at

static inline Node node_if(Mask mask, Node a, Node b) { return mask ? a : b; }

static inline Panel panel_at(const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    Node last = phi_at(sight, t_far);
    Medium mean = mean_medium(sight->transfer, sight->knot_sums, sight->cast, *near, last);
    *near = last;
#if SHADED
    Floats3 middle = lattice_point(sight->volume, &sight->lattice, t_near + 0.5f * length_mm);
    mean = lit_medium(sight->gradient, sight->volume, sight->shading, sight->toward_eye, middle, mean);
#endif
    return panel_midpoint(mean, length_mm);
}
#elif QUADRATURE == QUADRATURE_RIEMANN
typedef Floats Node; // samples are not shared
#define NODE_SAMPLES 1

static inline Panel panel_at(const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    return panel_riemann(medium_at(sight, t_near), t_far - t_near);
}
#elif QUADRATURE == QUADRATURE_MIDPOINT
typedef Floats Node; // samples are not shared
#define NODE_SAMPLES 1

static inline Panel panel_at(const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    return panel_midpoint(medium_at(sight, t_near + 0.5f * length_mm), length_mm);
}
#else
typedef Medium Node;
#define NODE_AT medium_at

static inline Node node_if(Mask mask, Node a, Node b)
{
    Node chosen = {{mask ? a.rgb.x : b.rgb.x, mask ? a.rgb.y : b.rgb.y, mask ? a.rgb.z : b.rgb.z},
                   mask ? a.absorption : b.absorption};
    return chosen;
}

#if QUADRATURE == QUADRATURE_ROMBERG
#define NODE_SAMPLES 4 // nodes lie evenly
#else
#define NODE_SAMPLES 2
#endif

static inline Panel panel_at(const Sight *sight, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    Medium nodes[NODE_SAMPLES + 1];
    nodes[0] = *near;
    for (int n = 1; n <= NODE_SAMPLES; n++)
        nodes[n] = medium_at(sight, n == NODE_SAMPLES ? t_far : t_near + (float)n * (length_mm / (float)NODE_SAMPLES));
    *near = nodes[NODE_SAMPLES];
#if QUADRATURE == QUADRATURE_ROMBERG
    return panel_romberg(nodes[0], nodes[1], nodes[2], nodes[3], nodes[4], length_mm);
#elif QUADRATURE == QUADRATURE_RK4
    return panel_rk4(nodes[0], nodes[1], nodes[2], length_mm);
#else
    return panel_simpson(nodes[0], nodes[1], nodes[2], length_mm);
#endif
}
#endif

// Gathers panels `k` up to `last`, in the lanes of `which`; `k` is then the next. Panel k lies between
// samples k - 1 and k.
static inline void gather_panels(const Sight *sight, Gathered *gathered, Ints *k, Ints last, Mask which, Ints *samples)
{
    Mask active = which & *k <= last & gathered->transmission >= sight->cast.least_transmission;
#ifdef NODE_AT
    if (!ANY(active))
        return;
    Node near = NODE_AT(sight, lattice_t(&sight->lattice, *k - 1));
    *samples += active ? INTS(1) : INTS(0);
#else
    Node near = FLOATS(0.0f);
#endif
    while (ANY(active)) {
        Panel panel = panel_at(sight, lattice_t(&sight->lattice, *k - 1), lattice_t(&sight->lattice, *k), &near);
        gather(gathered, panel, active);
        *samples += active ? INTS(NODE_SAMPLES) : INTS(0);
        *k = active ? *k + 1 : *k;
        active = active & *k <= last & gathered->transmission >= sight->cast.least_transmission;
    }
}

// Past a region of a beam, the panels that may reach into it: those before and after it add nothing.
static inline void gather_region(const Sight *sight, Gathered *gathered, const Beam *beam, BeamRegion region, const CellWalk *walk, Ints *k,
                                 Mask which, Ints *samples)
{
    AxisWalk d = beam->axis == 0 ? walk->x : beam->axis == 1 ? walk->y : walk->z;
    float low = (float)region.low - BEAM_MARGIN;
    float high = (float)region.high + BEAM_MARGIN;
    Floats enter = ((beam->forward ? low : high) - d.start.high) * d.mm_per_cell;
    Floats leave = ((beam->forward ? high : low) - d.start.high) * d.mm_per_cell;
    float step_mm = sight->lattice.step_mm;
    Floats most = AS_FLOATS(sight->lattice.last);
    // Panels that end after it is entered, and begin before it is left.
    Ints first = AS_INTS(within(enter / step_mm, FLOATS(1.0f), most));
    Ints last = AS_INTS(within(leave / step_mm + 1.0f, FLOATS(0.0f), most));
    which = which & leave >= 0.0f & *k <= last;
    *k = which & first > *k ? first : *k;
    gather_panels(sight, gathered, k, last, which, samples);
}

static inline Ints3 cells_if(Mask mask, Ints3 a, Ints3 b)
{
    Ints3 chosen = {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
    return chosen;
}

// Each ray by itself from node to node.
static inline void gather_spans(const Sight *sight, Gathered *gathered, const global uchar *node_class,
#if HOMOGENEOUS
                                const global float *node_average,
#endif
                                const global uint4 *levels, Mask alive, Ints *samples, Ints *nodes)
{
    const Lattice *lattice = &sight->lattice;
    VolumeGrid volume = sight->volume;
    Walk way = walk_start(volume, sight->cast.traverse);
    CellBox box;
    box.low.x = box.low.y = box.low.z = box.high.x = box.high.y = box.high.z = INTS(0);
    Ints3 cell = cell_at(volume, lattice->start);
    Ints3 span_cell = cell; // of the span's last sample
    Ints3 last_cell = cell; // of the sample before the span
    Ints class = INTS(CLASS_VISIT);
    Ints class_before = INTS(CLASS_VISIT);
#ifdef NODE_AT
    Node near = NODE_AT(sight, FLOATS(0.0f)); // sample k - 1, where it is known
    Mask have_near = NO_LANE;
#else
    Node near = FLOATS(0.0f);
#endif
    Ints end = INTS(0); // of the span
    Ints k = INTS(0);
    for (;;) {
        alive = alive & k <= lattice->last & gathered->transmission >= sight->cast.least_transmission;
        if (!ANY(alive))
            return;
        Mask arrives = alive & k == end;
        if (ANY(arrives)) {
            class_before = arrives ? class : class_before;
            cell = cells_if(arrives, cell_at(volume, lattice_point(volume, lattice, lattice_t(lattice, k))), cell);
            last_cell = cells_if(arrives, span_cell, last_cell);
            walk_on(&way, last_cell, cell, arrives);
            Ints byte = walk_down(&way, node_class, levels, cell, arrives, nodes);
            class = arrives ? class_of(byte) : class;
            set_box(&box, cell, way.level, reach_of(byte), arrives);
            Ints3 far;
            Ints next_end = span_end(volume, lattice, k, cell, &box, arrives, &far);
            end = arrives ? next_end : end;
            span_cell = cells_if(arrives, far, span_cell);
        }
        // A panel is left out where it lies in transparent nodes wholly.
        Mask matters = alive & k > 0 & !(class == CLASS_BELOW & class_before == CLASS_BELOW & leaves_touch(last_cell, cell));
        Ints next = class == CLASS_VISIT ? k + 1 : end;
        if (ANY(matters)) {
            Floats t_near = lattice_t(lattice, k - 1);
#ifdef NODE_AT
            Mask look = matters & !have_near;
            if (ANY(look)) {
                Node found = NODE_AT(sight, t_near);
                near = node_if(look, found, near);
                *samples += look ? INTS(1) : INTS(0);
            }
#endif
            gather(gathered, panel_at(sight, t_near, lattice_t(lattice, k), &near), matters);
            *samples += matters ? INTS(NODE_SAMPLES) : INTS(0);
        }
#if HOMOGENEOUS
        Mask same = alive & class == CLASS_HOMOGENEOUS & gathered->transmission >= sight->cast.least_transmission;
        if (ANY(same)) {
            Walk leaves = walk_start(volume, TRAVERSE_UNIFORM);
            Floats average = GATHER(Floats, node_average, AS_UINTS(node_index(levels, cell, &leaves)));
            Medium all = medium_of(sight->transfer, sight->cast, average);
            gather(gathered, panel_midpoint(all, lattice_t(lattice, end - 1) - lattice_t(lattice, k)), same);
        }
#endif
#ifdef NODE_AT
        have_near = matters & next == k + 1;
#endif
        k = alive ? next : k;
    }
}

kernel void cast_emission(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels, const global uint *cells,
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
        sight.voxels = voxels;
        sight.transfer.values = knot_values;
        sight.transfer.colors = knot_colors;
        sight.transfer.knots = cast.knots;
#if QUADRATURE == QUADRATURE_PREINTEGRATED
        sight.knot_sums = knot_sums;
#endif
        sight.volume = volume;
        sight.lattice = ray_lattice(volume, ray, interval, cast.step_mm);
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
        sight.toward_eye.x = -ray.dir_world.x;
        sight.toward_eye.y = -ray.dir_world.y;
        sight.toward_eye.z = -ray.dir_world.z;
        Ints k = INTS(1);
        Beam beam;
        CellWalk walk;
        bool together = false;
#if FILTER_LINEAR && !HOMOGENEOUS
        if (cast.traverse == TRAVERSE_DISTANCE) {
            walk = cells_start(volume, ray, interval);
            together = beam_start(&beam, &walk, levels, volume, alive);
        }
#endif
        if (together) {
            BeamRegion region;
            while (ANY(alive & gathered.transmission >= cast.least_transmission) && beam_next(&beam, voxels, node_class, cells, 0.0f, &region, &node_count)) {
                if (region.class == CLASS_VISIT)
                    gather_region(&sight, &gathered, &beam, region, &walk, &k, alive, &sample_count);
            }
        } else if (cast.traverse == TRAVERSE_OFF) {
            gather_panels(&sight, &gathered, &k, sight.lattice.last, alive, &sample_count);
        } else {
#if HOMOGENEOUS
            gather_spans(&sight, &gathered, node_class, node_average, levels, alive, &sample_count, &node_count);
#else
            gather_spans(&sight, &gathered, node_class, levels, alive, &sample_count, &node_count);
#endif
        }
    }

    Floats4 seen = {gathered.rgb.x, gathered.rgb.y, gathered.rgb.z, kept_back(gathered.depth)};
    put_fours(color, pixels, seen);
#if COUNTERS
    SCATTER(pixels.inside, steps, pixels.index, sample_count);
    SCATTER(pixels.inside, nodes, pixels.index, node_count);
#endif
}
