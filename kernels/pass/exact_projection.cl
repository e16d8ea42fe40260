// One value per ray, exactly: its maximum or minimum, its mean, or its first local maximum, from the
// field's cubic in each cell along the ray.
//
// PROJECTION_EXTREMUM: the largest of sign * Phi and where it is first reached. The extrema of a
// cubic lie at its ends and turning points; nodes and cells whose range cannot exceed the running
// extremum are left out (Mroz et al. 2000), and from the start those that cannot exceed `floor`.
// PROJECTION_MEAN: Simpson's rule in every cell, exact for cubics.
// PROJECTION_LOCAL: the first local maximum >= threshold, else the maximum (Sato et al. 1998);
// either end counts when the value falls away from it, and a plateau counts from its start.
//
// Reads the voxels, the clip planes (index space) and, per octree node, its range and its CLASS_*
// (CLASS_BELOW: nowhere above `floor`). Writes per ray kind (surface where the ray meets the volume) and
// value (stored units; 0 where it does not); with LAYERS depth (mm from the eye; +inf for the mean); with
// COUNTERS the cells read and the nodes tested.
#include "lib/ray/cast_planes.clh"
#include "lib/skip/march.clh"

#ifndef PROJECTION
#error "PROJECTION, which value is wanted, is given by the host"
#endif

// A slope along the ray's path through a cell, as a share of the cell's spread, that may be rounding.
#define FLAT_SHARE 1e-6f

// How many errors of its ends a cell's bound in single precision allows for.
#define BOUND_ERRORS 4.0f

#if PROJECTION == PROJECTION_MEAN
static inline Floats mean_along(VOXELS voxels, VolumeGrid volume, const VisibleRays *rays, Ints *cells_read)
{
    CellWalk walk = cells_start(volume, rays->ray, rays->interval);
    Mask alive = rays->meets;
    // Compensated summation (Kahan 1965): thousands of cells keep their digits.
    Floats sum = FLOATS(0.0f);
    Floats lost = FLOATS(0.0f);
    Floats whole = FLOATS(0.0f);
    Floats touched = FLOATS(0.0f);
    // A cell's share of the path, along the axis that the ray crosses fastest: differences of
    // positions in the cell keep the digits that differences of t lose.
    Floats x = fabs(walk.x.dir.high);
    Floats y = fabs(walk.y.dir.high);
    Floats z = fabs(walk.z.dir.high);
    Mask x_fastest = x >= y & x >= z;
    Mask y_fastest = !x_fastest & y >= z;
    Ints axis = x_fastest ? INTS(0) : y_fastest ? INTS(1) : INTS(2);
    while (ANY(alive)) {
        Corners corners = cell_corners(voxels, volume, &walk, 0.0f);
        *cells_read += alive ? INTS(1) : INTS(0);
        CellExit exit = cell_exit(&walk, alive);
        Floats3 near = point_in_cell(&walk, entry_t(&walk), walk.axis, NO_LANE);
        Floats3 far = point_in_cell(&walk, exit_t(&walk, exit), exit_axis(&walk, exit), ALL_LANES);
        Floats share = fabs(of_axis(axis, far.x - near.x, far.y - near.y, far.z - near.z));
        Floats3 middle = {0.5f * (near.x + far.x), 0.5f * (near.y + far.y), 0.5f * (near.z + far.z)};
        Floats mean = (corners_at(&corners, near) + 4.0f * corners_at(&corners, middle) + corners_at(&corners, far)) / 6.0f;
        touched = alive & whole == 0.0f & share == 0.0f ? mean : touched;
        Floats term = mean * share - lost;
        Floats next = sum + term;
        lost = alive ? (next - sum) - term : lost;
        sum = alive ? next : sum;
        whole = alive ? whole + share : whole;
        alive = alive & !exit.ends;
        cells_step(&walk, exit, alive);
    }
    // A ray that only touches the volume has the value there.
    return whole > 0.0f ? sum / whole : touched;
}
#else

// What a projection knows of its rays so far.
typedef struct {
    ProjectionCast cast;
    Floats max;      // of sign * Phi
    Floats max_mm;   // where it is first reached, from the entry
    Floats expected; // a value that the ray is known to reach
#if PROJECTION == PROJECTION_LOCAL
    Floats turn;     // the highest of a climb, the last of a fall
    Floats turn_mm;
    Mask rising;
#endif
    Mask done;
} ProjectionState;

static inline ProjectionState projection_start(ProjectionCast cast)
{
    ProjectionState state;
    state.cast = cast;
    state.max = FLOATS(cast.floor);
    state.max_mm = FLOATS(0.0f);
    state.expected = FLOATS(-INFINITY);
    state.done = NO_LANE;
#if PROJECTION == PROJECTION_LOCAL
    state.turn = FLOATS(-INFINITY);
    state.turn_mm = FLOATS(0.0f);
    state.rising = ALL_LANES;
#endif
    return state;
}

// What a node or cell must exceed to matter.
static inline Threshold projection_threshold(const ProjectionState *state)
{
    Threshold threshold;
    threshold.sign = state->cast.sign;
#if PROJECTION == PROJECTION_LOCAL
    // A climb that has reached the threshold ends where all that follows is lower. Else a local maximum
    // that counts, or a higher maximum, is wanted.
    float counts_from = state->cast.threshold;
    Mask reached = state->rising & state->turn >= counts_from;
    threshold.ties = reached | state->max >= counts_from;
    threshold.value = reached ? state->turn : state->max >= counts_from ? FLOATS(counts_from) : state->max;
#else
    threshold.ties = state->expected > state->max;
    threshold.value = threshold.ties ? state->expected : state->max;
#endif
    return threshold;
}

static inline Mask exceeds_threshold(Floats bound, Threshold threshold)
{
    return bound > threshold.value | (bound == threshold.value & threshold.ties);
}

// The rays of `which` skip what cannot matter.
static inline void projection_skip(ProjectionState *state, Mask which)
{
#if PROJECTION == PROJECTION_LOCAL
    Mask reached = state->rising & state->turn >= state->cast.threshold;
    state->done = state->done | (which & reached);
    // What is skipped is below the threshold: what follows is a climb from there.
    which = which & !reached;
    state->rising = state->rising | which;
    state->turn = which ? FLOATS(-INFINITY) : state->turn;
#endif
}

// An end of a monotone piece.
typedef struct {
    Floats value; // sign * Phi
    Floats t;
    Floats slope; // of the piece before
    Floats flat;  // a slope that may be rounding
} Turn;

// Arrives at an end of a monotone piece, in the lanes of `which`.
static inline void projection_arrive(ProjectionState *state, Turn at, Mask which)
{
#if PROJECTION == PROJECTION_LOCAL
    which = which & !state->done;
    Mask climbs = which & (state->turn == -INFINITY | at.slope > at.flat);
    Mask falls = which & !climbs & at.slope < -at.flat;
    Mask higher = climbs & at.value > state->turn;
    state->turn_mm = higher ? at.t : state->turn_mm;
    state->turn = higher ? at.value : state->turn;
    Mask counts = falls & state->rising & state->turn >= state->cast.threshold;
    state->done = state->done | counts;
    state->rising = (state->rising | climbs) & (!falls | counts);
    state->turn = falls & !counts ? at.value : state->turn;
#endif
    Mask more = which & at.value > state->max;
    state->max = more ? at.value : state->max;
    state->max_mm = more ? at.t : state->max_mm;
}

// Follows the cubic of a cell that may matter, in the lanes of `which`.
static inline void follow_cell(ProjectionState *state, const CellWalk *walk, const Corners *corners, CellExit exit, Mask which)
{
    TPair enters = entry_t(walk);
    TPair leaves = exit_t(walk, exit);
    Floats3 near = point_in_cell(walk, enters, walk->axis, NO_LANE);
    Floats3 far = point_in_cell(walk, leaves, exit_axis(walk, exit), ALL_LANES);
    Floats3 through = {far.x - near.x, far.y - near.y, far.z - near.z};
    Cubic cubic = cubic_along(corners, near, through);
    Floats turns[4];
    turns[0] = FLOATS(0.0f);
    cubic_turns(cubic, &turns[1], &turns[2]);
    turns[3] = FLOATS(1.0f);
    // Rise and fall are decided by the slope: a dip too shallow for the values' digits has one all the same.
    Turn at;
    at.flat = FLAT_SHARE * (corners_max(corners) - corners_min(corners));
#pragma unroll
    for (uint n = 0u; n < 4u; n++) {
        Floats s = turns[n];
        Floats3 p = {near.x + through.x * s, near.y + through.y * s, near.z + through.z * s};
        at.value = state->cast.sign * corners_at(corners, p);
        at.t = enters.high + (leaves.high - enters.high) * s;
        Mask there = which & (n == 0u || n == 3u ? ALL_LANES : s < 1.0f);
#if PROJECTION == PROJECTION_LOCAL
        // With the nearest filter the field changes at faces alone.
        Floats before = n == 3u ? (turns[2] < 1.0f ? turns[2] : turns[1] < 1.0f ? turns[1] : FLOATS(0.0f)) : turns[n == 0u ? 0u : n - 1u];
        at.slope = n > 0u ? state->cast.sign * cubic_slope(cubic, 0.5f * (before + s)) : FILTER_LINEAR ? FLOATS(0.0f) : at.value - state->turn;
#else
        at.slope = FLOATS(0.0f);
#endif
        projection_arrive(state, at, there);
    }
}

#if PROJECTION == PROJECTION_EXTREMUM
// A bound on sign * Phi along a ray in a cell, from where it enters and leaves it in single precision, which
// is off by a share of `slack_mm`.
static inline Floats cell_bound(const CellWalk *walk, const Corners *corners, Floats enters_mm, Floats leaves_mm, Floats slack_mm, float sign)
{
    Floats3 near = point_in_cell_single(walk, enters_mm);
    Floats3 far = point_in_cell_single(walk, leaves_mm);
    Floats3 through = {far.x - near.x, far.y - near.y, far.z - near.z};
    Floats fastest = max_of(fabs(walk->x.dir.high), max_of(fabs(walk->y.dir.high), fabs(walk->z.dir.high)));
    Floats off = BOUND_ERRORS * (slack_mm * fastest + walk->rounding);
    return cubic_bound(cubic_along(corners, near, through), sign) + off * (corners_max(corners) - corners_min(corners));
}
#endif

// Follows rays through the cells of the march's box.
static inline void project_cells(ProjectionState *state, CellMarch *march, VOXELS voxels, Ints *cells_read)
{
    CellWalk *walk = &march->walk;
    float sign = state->cast.sign;
    Mask reading = cells_standing(march);
#if PROJECTION == PROJECTION_EXTREMUM
    Floats enters_mm = entry_t(walk).high;
    Floats slack_mm = FLOATS(0.0f);
#endif
    while (ANY(reading)) {
        Corners corners = cell_corners(voxels, march->volume, walk, 0.0f);
        *cells_read += reading ? INTS(1) : INTS(0);
        CellExit exit = cell_exit(walk, reading);
        Floats bound = sign > 0.0f ? corners_max(&corners) : -corners_min(&corners);
        Threshold threshold = projection_threshold(state);
        Mask matters = reading & exceeds_threshold(bound, threshold);
#if PROJECTION == PROJECTION_EXTREMUM
        if (ANY(matters)) {
            Floats leaves_mm = min_of(exit.t_single, walk->end.high);
            bound = cell_bound(walk, &corners, enters_mm, leaves_mm, slack_mm + exit.slack_mm, sign);
            matters = matters & exceeds_threshold(bound, threshold);
        }
        enters_mm = exit.t_single;
        slack_mm = exit.slack_mm;
#endif
        projection_skip(state, reading & !matters);
        if (ANY(matters))
            follow_cell(state, walk, &corners, exit, matters);
        reading = cells_advance(march, exit, reading, reading & !state->done);
    }
}

static inline ProjectionState project(VOXELS voxels, SkipGrid grid, VolumeGrid volume, const VisibleRays *rays, ProjectionCast cast,
                                      Ints *cells_read, Ints *nodes_tested)
{
    CellMarch march = cell_march(volume, grid, rays, cast.traverse, true);
    ProjectionState state = projection_start(cast);
#if PROJECTION == PROJECTION_EXTREMUM
    // First where the greatest values are to be expected: all else must exceed what rays reach there.
    ProjectionState ahead = state;
    CellMarch there = cells_ahead(&march, cast.sign);
    if (march.packed) {
        project_cells(&ahead, &there, voxels, cells_read);
        state.expected = ahead.max;
    }
#endif
    while (ANY(march.alive)) {
        for (Mask seeking = cells_seeking(&march); ANY(seeking); seeking = cells_seeking(&march)) {
            Skip skip = cells_above(&march, voxels, projection_threshold(&state), seeking);
#if PROJECTION == PROJECTION_EXTREMUM
            if (skip.seen_ahead) {
                Mask more = skip.rays & ahead.max > state.max;
                state.max = more ? ahead.max : state.max;
                state.max_mm = more ? ahead.max_mm : state.max_mm;
                continue;
            }
#endif
            projection_skip(&state, skip.rays);
            cells_pass(&march, skip, !state.done);
        }
        project_cells(&state, &march, voxels, cells_read);
    }
#if PROJECTION == PROJECTION_LOCAL
    Mask counts = state.rising & state.turn >= cast.threshold;
    state.max = counts ? state.turn : state.max;
    state.max_mm = counts ? state.turn_mm : state.max_mm;
#endif
    *nodes_tested += march.nodes_tested;
    return state;
}
#endif

kernel void exact_projection(VOXELS voxels, SKIP_BY_RANGE, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, ProjectionCast cast,
                             global uint *kind, global float *value DEPTH_PLANE COUNTER_PLANES)
{
    Pixels pixels = RAY_PIXELS();
    VisibleRays visible = visible_rays(pixels, RAY_OF(pixels), volume, CLIP_GIVEN);
    Ints cells_read = INTS(0);
    Ints nodes_tested = INTS(0);
#if PROJECTION == PROJECTION_MEAN
    Floats found = mean_along(voxels, volume, &visible, &cells_read);
    Floats found_mm = FLOATS(INFINITY); // from the entry
#else
    ProjectionState state = project(voxels, skip_by_range(node_class, node_range, levels), volume, &visible, cast, &cells_read, &nodes_tested);
    Floats found = cast.sign * state.max;
    Floats found_mm = state.max_mm;
#endif
    Ints met = visible.meets ? INTS(KIND_SURFACE) : INTS(KIND_NOTHING);
    Floats phi = visible.meets ? found : FLOATS(0.0f);
    SCATTER(pixels.inside, kind, pixels.index, met);
    SCATTER(pixels.inside, value, pixels.index, phi);
#if LAYERS
    Floats depth_mm = visible.meets ? visible.ray.base_mm + (visible.interval.enter + found_mm) : FLOATS(INFINITY);
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
#endif
    WRITE_COUNTERS(pixels, cells_read, nodes_tested);
}
