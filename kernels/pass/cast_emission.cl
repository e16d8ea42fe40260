// Emission and absorption along each ray, front to back (Levoy 1988; Max 1995), at a fixed step.
//
// A panel is a segment between two samples of the lattice, the last and shorter one between the
// last full step and the exit, and with JITTERED (`lib/ray/jitter.clh`) a shorter first one; QUADRATURE says at which nodes it is sampled and what they weigh
// (lib/light/quadrature.clh, lib/light/preintegrated.clh). Panels tile the ray, so that opacity depends on path
// length alone. A panel is left out where it lies in transparent nodes wholly: it would add exactly
// nothing. With HOMOGENEOUS, the samples of a leaf of that class are one panel of the value that stands for
// the leaf. A ray ends once its transmittance falls below min_transmittance: the colour lost is at most
// min_transmittance times the brightest colour.
//
// Reads the voxels, the transfer function's knots (values in stored units; colours linear light
// with opacity in w; sums as mean_medium has them), the clip planes (index space) and, per octree
// node, its CLASS_*; with HOMOGENEOUS what stands for each leaf. Writes color, premultiplied linear light;
// with LAYERS depth (mm from the eye) and value (stored units), with NORMALS the normal, with VISIBILITY what reaches it of the
// first light: means along the ray, weighted as its light is, where the opacity is layers_from at least, else +inf and 0; with COUNTERS
// the samples taken and the nodes tested.
#include "lib/light/emission.clh"
#include "lib/ray/jitter.clh"
#include "lib/skip/segment_march.clh"

// With the nearest filter no value lies between two samples' own: there is nothing to integrate.
#define INTEGRATES (QUADRATURE == QUADRATURE_PREINTEGRATED && FILTER_LINEAR)

// What panels are made of.
typedef struct {
    Emitter emitter;
    Lattice lattice;
#if HOMOGENEOUS
    const global float *node_average; // what stands for each leaf
#endif
} PanelContext;

static inline Floats phi_at(VOXELS voxels, const PanelContext *context, Floats t)
{
    return field_at(voxels, context->lattice.volume, lattice_point(&context->lattice, t));
}

static inline Medium lit_at(VOXELS voxels, const PanelContext *context, Floats t, Medium medium)
{
    Floats3 p = lattice_point(&context->lattice, t);
#if SHADED && SHADOWS != SHADOWS_NONE
    const Emitter *emitter = &context->emitter;
    Floats visible[MAX_LIGHTS];
    lights_reaching(voxels, &emitter->feelers, emitter->shading, p, emitter->toward_eye, medium.absorption > 0.0f, visible);
#else
    const Floats *visible = 0;
#endif
    return lit_at_point(voxels, &context->emitter, p, medium, visible);
}

#if !INTEGRATES
static inline Medium medium_at(VOXELS voxels, const PanelContext *context, Floats t)
{
    Medium medium = medium_of(context->emitter.transfer, context->emitter.cast, phi_at(voxels, context, t));
    place_light(&medium.light, t);
    return lit_at(voxels, context, t, medium);
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

static inline Panel panel_at(VOXELS voxels, const PanelContext *context, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    Node first = *near;
    Node last = phi_at(voxels, context, t_far);
    *near = last;
    Medium mean = mean_medium(context->emitter.transfer, context->emitter.knot_sums, context->emitter.cast, first, last);
    return panel_linear(lit_at(voxels, context, t_near + 0.5f * length_mm, mean), first, last, t_near, length_mm);
}
#elif QUADRATURE == QUADRATURE_RIEMANN
typedef Floats Node; // samples are not shared
#define NODE_SAMPLES 1
#define NODE_UNKNOWN FLOATS(0.0f)

static inline Panel panel_at(VOXELS voxels, const PanelContext *context, Floats t_near, Floats t_far, Node *near)
{
    return panel_even(medium_at(voxels, context, t_near), t_near, t_far - t_near);
}
#elif QUADRATURE == QUADRATURE_MIDPOINT
typedef Floats Node; // samples are not shared
#define NODE_SAMPLES 1
#define NODE_UNKNOWN FLOATS(0.0f)

static inline Panel panel_at(VOXELS voxels, const PanelContext *context, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    return panel_even(medium_at(voxels, context, t_near + 0.5f * length_mm), t_near, length_mm);
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

static inline Panel panel_at(VOXELS voxels, const PanelContext *context, Floats t_near, Floats t_far, Node *near)
{
    Floats length_mm = t_far - t_near;
    Medium nodes[NODE_SAMPLES + 1];
    nodes[0] = *near;
    for (int n = 1; n <= NODE_SAMPLES; n++)
        nodes[n] = medium_at(voxels, context, n == NODE_SAMPLES ? t_far : t_near + (float)n * (length_mm / (float)NODE_SAMPLES));
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

// Adds the next panel, in the lanes of `which`: panel k lies between samples k - 1 and k, of which the first
// may be known from the panel before.
static inline void add_panel(VOXELS voxels, const PanelContext *context, Accumulated *accumulated, SegmentRun *run, Node *near, Mask which,
                             Ints *samples)
{
    Floats t_near = lattice_t(&context->lattice, run->k - 1);
    Floats t_far = lattice_t(&context->lattice, run->k);
#ifdef NODE_AT
    Mask missing = which & !run->known;
    if (ANY(missing)) {
        *near = node_if(missing, NODE_AT(voxels, context, t_near), *near);
        *samples += missing ? INTS(1) : INTS(0);
    }
    Node far = *near;
    accumulate(accumulated, panel_at(voxels, context, t_near, t_far, &far), which);
    *near = node_if(which, far, *near);
#else
    accumulate(accumulated, panel_at(voxels, context, t_near, t_far, near), which);
#endif
    *samples += which ? INTS(NODE_SAMPLES) : INTS(0);
    segments_step(run, which);
}

#if HOMOGENEOUS
// Of the rays of `which`, those that leave a homogeneous leaf: its samples are one panel of the value that
// stands for the leaf.
static inline void add_homogeneous(VOXELS voxels, const PanelContext *context, Accumulated *accumulated, const SegmentMarch *march, Mask which)
{
    Mask same = which & march->spans.class == CLASS_HOMOGENEOUS;
    if (!ANY(same))
        return;
    const Lattice *lattice = &context->lattice;
    NodeWalk leaves = node_walk_start(lattice->volume, TRAVERSE_UNIFORM);
    Floats average = GATHER(Floats, context->node_average, AS_UINTS(node_index(march->grid.levels, march->spans.cell, &leaves)));
    Floats t_near = lattice_t(lattice, march->spans.begin);
    Floats length_mm = lattice_t(lattice, march->spans.end - 1) - t_near;
    Medium all = lit_at(voxels, context, t_near + 0.5f * length_mm, medium_of(context->emitter.transfer, context->emitter.cast, average));
    accumulate(accumulated, panel_even(all, t_near, length_mm), same);
}

#define NODE_AVERAGE const global float *node_average,
#else
#define NODE_AVERAGE
#endif

// Adds panels along rays until each has ended.
static inline void emit_along(VOXELS voxels, const PanelContext *context, Accumulated *accumulated, SegmentMarch *march, Ints *samples)
{
    float min_transmittance = context->emitter.cast.min_transmittance;
    Node near = NODE_UNKNOWN;
    for (;;) {
        march->alive = march->alive & accumulated->transmittance >= min_transmittance;
        for (Mask seeking = segments_seeking(march); ANY(seeking); seeking = segments_seeking(march)) {
#if HOMOGENEOUS
            add_homogeneous(voxels, context, accumulated, march, seeking);
            march->alive = march->alive & accumulated->transmittance >= min_transmittance;
            seeking = seeking & march->alive;
#endif
            segments_by_class(march, voxels, 0.0f, NO_LANE, seeking);
        }
        Mask standing = segments_standing(march);
#if HOMOGENEOUS && FILTER_LINEAR
        if (context->emitter.cast.traverse == TRAVERSE_DISTANCE)
            standing = segments_pass_clear(&march->run, &march->lattice, march->grid.cell_bits, standing);
        if (ANY(march->alive) && !ANY(standing))
            continue;
#endif
        if (!ANY(standing))
            return;
        do {
            add_panel(voxels, context, accumulated, &march->run, &near, standing, samples);
            standing = standing & march->run.k <= march->run.last & accumulated->transmittance >= min_transmittance;
        } while (march->packed && ANY(standing));
    }
}

#if INTEGRATES || SHADOWS == SHADOWS_EXACT || SHADOWS == SHADOWS_CACHED
#define SUMS TRANSFER_SUMS
#define SUMS_GIVEN TRANSFER_SUMS_GIVEN
#else
#define SUMS
#define SUMS_GIVEN NO_TRANSFER_SUMS
#endif

kernel void cast_emission(VOXELS voxels, SKIP_BY_CLASS, TRANSFER_KNOTS SUMS, NODE_AVERAGE CLIP_PLANES, FEELER_GRIDS EMITTER_DIRECTIONS
                          VolumeGrid volume, RAY_SOURCE, EmissionCast cast JITTER, Shading shading, EMISSION_PLANES COUNTER_PLANES)
{
    Pixels pixels = RAY_PIXELS();
    VisibleRays visible = visible_rays(pixels, RAY_OF(pixels), volume, CLIP_GIVEN);
    Accumulated accumulated = accumulate_start();
    Ints samples = INTS(0);
    Ints nodes_tested = INTS(0);
    if (ANY(visible.meets)) {
        SkipGrid grid = skip_by_class(node_class, levels, cells);
        Steps spacing = STEPS(cast.step_mm, pixels);
        SegmentMarch march = segment_march(volume, grid, &visible, cast.traverse, spacing, 1, !HOMOGENEOUS);
        Emitter emitter = {{knot_values, knot_colors, cast.knots}, SUMS_GIVEN, cast, volume, &shading,
                           direction_to_eye(visible.ray) EMITTER_FEELERS(SUMS_GIVEN) EMITTER_DIRECTIONS_GIVEN};
        PanelContext context;
        context.emitter = emitter;
        context.lattice = march.lattice;
#if HOMOGENEOUS
        context.node_average = node_average;
#endif
        emit_along(voxels, &context, &accumulated, &march, &samples);
        nodes_tested = march.nodes_tested;
    }
    WRITE_EMISSION(accumulated, cast, visible);
    WRITE_COUNTERS(pixels, samples, nodes_tested);
}
