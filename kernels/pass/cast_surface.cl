// The first point of each ray where Phi - iso changes sign.
//
// Fixed steps on the sample lattice (Levoy 1988), nodes that lie wholly on one side of the iso value
// skipped (Lesar et al. 2015, §III-C), the crossing refined between two samples. With `probe`, a peak on the other
// side is searched for between two samples on one side where the field may turn between them. "Inside"
// is Phi >= iso. With caps, a ray that enters through a face of the volume or a clip plane where it is
// inside hits there. With NEAREST_MARCH samples are the nearest voxels' values, and where two of
// them are on two sides the crossing is that of the field, if it has one there (`lib/find/approach.clh`); no peak is
// searched for.
//
// With JITTERED each ray's samples are shifted (`lib/ray/jitter.clh`).
//
// Reads the voxels, the clip planes (index space), per octree node its CLASS_*, and a bit per cell that
// the surface may cross. Writes per ray hit_mm (t; +inf: none) and kind; with LAYERS depth (mm from the eye)
// and value at the hit (stored units; 0 without a hit); with COUNTERS the samples taken and the nodes tested.
#include "lib/find/approach.clh"
#include "lib/find/peak.clh"
#include "lib/find/refine.clh"
#include "lib/ray/cast_planes.clh"
#include "lib/ray/jitter.clh"
#include "lib/skip/segment_march.clh"

// What a surface cast knows of its rays so far.
typedef struct {
    SurfaceCast cast;
    Mask capped;     // rays that hit where they begin, if that is inside
    RayPoint before; // sample k - 1, where it is known: heights above the iso value
    Bracket bracket; // of the surface
#if NEAREST_MARCH
    Approach approach;
#endif
    Ints kind;       // KIND_*
    Ints samples;
} SurfaceState;

static inline SurfaceState surface_start(SurfaceCast cast, Mask capped)
{
    SurfaceState state;
    state.cast = cast;
    state.capped = capped;
    state.before.t = state.before.height = state.before.slope = FLOATS(0.0f);
    state.bracket.near = state.bracket.far = state.bracket.f_near = state.bracket.f_far = FLOATS(0.0f);
#if NEAREST_MARCH
    state.approach = approach_start(cast.iso);
#endif
    state.kind = INTS(KIND_NOTHING);
    state.samples = INTS(0);
    return state;
}

static inline RayPoint point_at(VOXELS voxels, const SegmentMarch *march, SurfaceCast cast, Ints k)
{
    Floats t = lattice_t(&march->lattice, k);
#if NEAREST_MARCH
    Floats value = nearest_at(voxels, march->lattice.volume, lattice_point(&march->lattice, t));
    RayPoint point = {t, value - cast.iso, FLOATS(0.0f)};
    return point;
#else
    return ray_point(voxels, &march->lattice, FLOATS(1.0f), cast.iso, cast.probe, t);
#endif
}

// Which rays of `which`, whose first sample is `first`, hit where they begin.
static inline Mask begins_inside(VOXELS voxels, SurfaceState *state, const SegmentMarch *march, RayPoint first, Mask which)
{
#if NEAREST_MARCH
    if (!ANY(which))
        return NO_LANE;
    return which & state->capped & approach_begin(voxels, &march->lattice, &state->approach, first, which, &state->samples);
#else
    return which & state->capped & first.height >= 0.0f;
#endif
}

#if NEAREST_MARCH
// The rays of `which` that cross the surface before their next sample; the bracket becomes the crossing's.
static inline Mask crosses_before(VOXELS voxels, SurfaceState *state, const SegmentMarch *march, RayPoint here, Mask which)
{
    Approach *approach = &state->approach;
    approach->doubtful = approach->doubtful & !(which & !march->run.known);
    Segment segment = {state->before, here};
    Mask asked = which & (((here.height >= 0.0f) ^ (segment.a.height >= 0.0f)) | approach->doubtful);
    if (!ANY(asked))
        return NO_LANE;
    Mask crosses = approach_ask(voxels, &march->lattice, approach, segment, asked, &state->samples);
    state->bracket = approach->bracket;
    return crosses;
}
#else
// A peak between two samples on one side that reaches the other side, in the lanes of `which`; `far` becomes
// that peak. Returns the lanes that have one.
static inline Mask peak_across(VOXELS voxels, SurfaceState *state, const SegmentMarch *march, RayPoint here, Mask which, RayPoint *far)
{
    Floats sign = here.height >= 0.0f ? FLOATS(-1.0f) : FLOATS(1.0f);
    RayPoint before = state->before;
    Segment segment = {{before.t, sign * before.height, sign * before.slope}, {here.t, sign * here.height, sign * here.slope}};
    RayPoint peak = segment.b;
    Goal goal = {sign, state->cast.iso, FLOATS(0.0f), true};
    Mask turns = peak_between(voxels, &march->lattice, goal, segment, which, &peak, &state->samples);
    far->t = turns ? peak.t : far->t;
    far->height = turns ? sign * peak.height : far->height;
    return turns;
}

// The rays of `which` that cross the surface before their next sample; the bracket becomes the crossing's.
static inline Mask crosses_before(VOXELS voxels, SurfaceState *state, const SegmentMarch *march, RayPoint here, Mask which)
{
    RayPoint before = state->before;
    RayPoint far = here;
    Mask crosses = which & ((here.height >= 0.0f) ^ (before.height >= 0.0f));
    if (state->cast.probe)
        crosses = crosses | peak_across(voxels, state, march, here, which & !crosses, &far);
    state->bracket.near = crosses ? before.t : state->bracket.near;
    state->bracket.f_near = crosses ? before.height : state->bracket.f_near;
    state->bracket.far = crosses ? far.t : state->bracket.far;
    state->bracket.f_far = crosses ? far.height : state->bracket.f_far;
    return crosses;
}
#endif

// Tests the next segment, in the lanes of `which`.
static inline void test_segment(VOXELS voxels, SurfaceState *state, SegmentMarch *march, Mask which)
{
    Ints k = march->run.k;
    Mask first = k == 0;
    Mask missing = which & !first & !march->run.known;
    if (ANY(missing)) {
        state->before = point_if(missing, point_at(voxels, march, state->cast, k - 1), state->before);
        state->samples += missing ? INTS(1) : INTS(0);
    }
    RayPoint here = point_at(voxels, march, state->cast, k);
    state->samples += which ? INTS(1) : INTS(0);
    Mask crosses = crosses_before(voxels, state, march, here, which & !first);
    state->kind = crosses ? INTS(KIND_SURFACE) : state->kind;
    state->kind = begins_inside(voxels, state, march, here, which & first) ? INTS(KIND_CAP) : state->kind;
    state->before = point_if(which, here, state->before);
    segments_step(&march->run, which);
}

// Marches until each ray has met the surface or its end.
static inline void march_to_surface(VOXELS voxels, SurfaceState *state, SegmentMarch *march)
{
    for (;;) {
        march->alive = march->alive & state->kind == KIND_NOTHING;
        for (Mask seeking = segments_seeking(march); ANY(seeking); seeking = segments_seeking(march))
            segments_by_class(march, voxels, state->cast.iso, state->capped, seeking);
        Mask standing = segments_standing(march);
        if (!ANY(standing))
            return;
        test_segment(voxels, state, march, standing);
    }
}

kernel void cast_surface(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, SurfaceCast cast JITTER,
                         global float *hit_mm, global uint *kind DEPTH_PLANE VALUE_PLANE COUNTER_PLANES)
{
    Pixels pixels = RAY_PIXELS();
    VisibleRays visible = visible_rays(pixels, RAY_OF(pixels), volume, CLIP_GIVEN);
    SurfaceState state = surface_start(cast, cast.caps ? visible.interval.by_face : NO_LANE);
    Steps spacing = STEPS(cast.step_mm, pixels);
    SegmentMarch march = segment_march(volume, skip_by_class(node_class, levels, cells), &visible, cast.traverse, spacing, 0, true);
    march_to_surface(voxels, &state, &march);
    Floats hit_from_entry_mm = FLOATS(0.0f); // a cap lies there
    Mask crossed = state.kind == KIND_SURFACE;
    if (ANY(crossed)) {
        Refinement by = {cast.iso, cast.refine, (int)cast.iterations};
#if NEAREST_MARCH
        // One point alone is not refined.
        Mask between = crossed & state.bracket.near < state.bracket.far;
        Floats refined = refine(voxels, &march.lattice, by, state.bracket, between, &state.samples);
        refined = between ? refined : state.bracket.far;
#else
        Floats refined = refine(voxels, &march.lattice, by, state.bracket, crossed, &state.samples);
#endif
        hit_from_entry_mm = crossed ? refined : hit_from_entry_mm;
    }

    Mask hit = state.kind != KIND_NOTHING;
    Floats t = hit ? visible.interval.enter + hit_from_entry_mm : FLOATS(INFINITY);
    SCATTER(pixels.inside, hit_mm, pixels.index, t);
    SCATTER(pixels.inside, kind, pixels.index, state.kind);
#if LAYERS
    Floats3 at = lattice_point(&march.lattice, hit ? hit_from_entry_mm : FLOATS(0.0f));
    Floats phi = hit ? field_at(voxels, volume, at) : FLOATS(0.0f);
    Floats depth_mm = visible.ray.base_mm + t;
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
    SCATTER(pixels.inside, value, pixels.index, phi);
#endif
    WRITE_COUNTERS(pixels, state.samples, march.nodes_tested);
}
