// One value per ray: its maximum or minimum, its mean, or its first local maximum.
//
// PROJECTION_EXTREMUM: the largest of sign * Phi over the samples, and where it is first reached;
// what cannot exceed the running extremum, which starts at `floor`, is skipped (Mroz et al. 2000). With
// `probe` the peaks between samples count too.
// PROJECTION_MEAN: the composite trapezoid rule, every sample needed.
// PROJECTION_LOCAL: the first local maximum >= threshold, else the maximum (Sato et al. 1998);
// either end counts when the value falls away from it.
// With JITTERED each ray's samples are shifted (`lib/ray/jitter.clh`).
//
// Reads the voxels, the clip planes (index space) and, per octree node, its range and its CLASS_*
// (CLASS_BELOW: nowhere above `floor`). Writes per ray kind (surface where the ray meets the
// volume) and value (stored units; 0 where it does not); with LAYERS depth (mm from the eye; +inf for
// the mean); with COUNTERS the samples taken and the nodes tested.
#include "lib/find/peak.clh"
#include "lib/ray/cast_planes.clh"
#include "lib/ray/jitter.clh"
#include "lib/skip/segment_march.clh"

#ifndef PROJECTION
#error "PROJECTION, which value is wanted, is given by the host"
#endif

#if PROJECTION == PROJECTION_MEAN
static inline Floats mean_along(VOXELS voxels, const Lattice *lattice, Mask alive, Ints *samples)
{
    // Compensated summation (Kahan 1965): thousands of samples keep their digits.
    Floats sum = FLOATS(0.0f);
    Floats lost = FLOATS(0.0f);
    Floats before = FLOATS(0.0f);
    Floats t = FLOATS(0.0f);
    for (Ints k = INTS(0); ANY(alive); k += 1) {
        Floats after = lattice_t(lattice, k < lattice->last ? k + 1 : k);
        Floats v = field_at(voxels, lattice->volume, lattice_point(lattice, t));
        Floats weight = lattice->last == 0 ? FLOATS(1.0f) : 0.5f * (after - before) / lattice->length_mm;
        Floats term = v * weight - lost;
        Floats next = sum + term;
        lost = alive ? (next - sum) - term : lost;
        sum = alive ? next : sum;
        *samples += alive ? INTS(1) : INTS(0);
        before = t;
        t = after;
        alive = alive & k < lattice->last;
    }
    return sum;
}
#else

// What a projection knows of its rays so far.
typedef struct {
    ProjectionCast cast;
    RayPoint before; // sample k - 1, where it is known: heights are sign * Phi
    Floats max;      // of sign * Phi
    Floats max_mm;   // where it is first reached, from the entry
    Mask done;
    Ints samples;
} MaximumState;

static inline MaximumState maximum_start(ProjectionCast cast)
{
    MaximumState state;
    state.cast = cast;
    state.before.t = state.before.height = state.before.slope = FLOATS(0.0f);
    state.max = FLOATS(cast.floor);
    state.max_mm = FLOATS(0.0f);
    state.done = NO_LANE;
    state.samples = INTS(0);
    return state;
}

// What equals the running maximum matters too where a climb has reached the threshold: it ends where all
// that follows is lower.
static inline Threshold maximum_threshold(const MaximumState *state)
{
    Threshold threshold = {state->cast.sign, state->max, NO_LANE};
    if (PROJECTION == PROJECTION_LOCAL)
        threshold.ties = state->max >= state->cast.threshold;
    return threshold;
}

static inline RayPoint point_at(VOXELS voxels, const SegmentMarch *march, ProjectionCast cast, Ints k)
{
    return ray_point(voxels, &march->lattice, FLOATS(cast.sign), 0.0f, cast.probe, lattice_t(&march->lattice, k));
}

// Tests the next segment, in the lanes of `which`.
static inline void test_segment(VOXELS voxels, MaximumState *state, SegmentMarch *march, Mask which)
{
    Ints k = march->run.k;
    RayPoint here = point_at(voxels, march, state->cast, k);
    state->samples += which ? INTS(1) : INTS(0);
    if (state->cast.probe) {
        Mask missing = which & k > 0 & !march->run.known;
        if (ANY(missing)) {
            state->before = point_if(missing, point_at(voxels, march, state->cast, k - 1), state->before);
            state->samples += missing ? INTS(1) : INTS(0);
        }
        RayPoint peak = here;
        Goal goal = {FLOATS(state->cast.sign), 0.0f, state->max, false};
        Segment segment = {state->before, here};
        Mask peaks = peak_between(voxels, &march->lattice, goal, segment, which & k > 0, &peak, &state->samples);
        state->max = peaks ? peak.height : state->max;
        state->max_mm = peaks ? peak.t : state->max_mm;
    }
    state->done = state->done | (which & maximum_threshold(state).ties & here.height < state->max);
    Mask more = which & here.height > state->max;
    state->max = more ? here.height : state->max;
    state->max_mm = more ? here.t : state->max_mm;
    state->before = point_if(which, here, state->before);
    segments_step(&march->run, which);
}

static inline void march_to_maximum(VOXELS voxels, MaximumState *state, SegmentMarch *march)
{
    for (;;) {
        march->alive = march->alive & !state->done;
        for (Mask seeking = segments_seeking(march); ANY(seeking); seeking = segments_seeking(march)) {
            Threshold threshold = maximum_threshold(state);
            Mask left_out = segments_above(march, voxels, threshold, seeking);
            // What is left out is lower.
            state->done = state->done | (left_out & threshold.ties);
            march->alive = march->alive & !state->done;
        }
        Mask standing = segments_standing(march);
        if (!ANY(standing))
            return;
        test_segment(voxels, state, march, standing);
    }
}
#endif

kernel void cast_maximum(VOXELS voxels, SKIP_BY_RANGE, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, ProjectionCast cast JITTER,
                         global uint *kind, global float *value DEPTH_PLANE COUNTER_PLANES)
{
    Pixels pixels = RAY_PIXELS();
    VisibleRays visible = visible_rays(pixels, RAY_OF(pixels), volume, CLIP_GIVEN);
    Floats found = FLOATS(0.0f);
    Floats found_mm = FLOATS(INFINITY); // from the entry
    Ints samples = INTS(0);
    Ints nodes_tested = INTS(0);
    if (ANY(visible.meets)) {
        Steps spacing = STEPS(cast.step_mm, pixels);
#if PROJECTION == PROJECTION_MEAN
        Lattice lattice = ray_lattice(volume, visible.ray, visible.interval, spacing);
        found = mean_along(voxels, &lattice, visible.meets, &samples);
#else
        SkipGrid grid = skip_by_range(node_class, node_range, levels);
        SegmentMarch march = segment_march(volume, grid, &visible, cast.traverse, spacing, 0, true);
        MaximumState state = maximum_start(cast);
        march_to_maximum(voxels, &state, &march);
        found = cast.sign * state.max;
        found_mm = state.max_mm;
        samples = state.samples;
        nodes_tested = march.nodes_tested;
#endif
    }

    Ints met = visible.meets ? INTS(KIND_SURFACE) : INTS(KIND_NOTHING);
    Floats phi = visible.meets ? found : FLOATS(0.0f);
    SCATTER(pixels.inside, kind, pixels.index, met);
    SCATTER(pixels.inside, value, pixels.index, phi);
#if LAYERS
    Floats depth_mm = visible.meets ? visible.ray.base_mm + (visible.interval.enter + found_mm) : FLOATS(INFINITY);
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
#endif
    WRITE_COUNTERS(pixels, samples, nodes_tested);
}
