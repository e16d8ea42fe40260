// One value per ray, exactly: its maximum or minimum, its mean, or its first local maximum, from the
// field's cubic in each cell along the ray.
//
// PROJECTION_EXTREMUM: the largest of sign * Phi and where it is first reached. The extrema of a
// cubic lie at its ends and turning points; nodes and cells whose range cannot beat the running
// extremum are left out (Mroz et al. 2000), and from the start those that cannot beat `floor`.
// PROJECTION_MEAN: Simpson's rule in every cell, exact for cubics.
// PROJECTION_LOCAL: the first local maximum >= threshold, else the maximum (Sato et al. 1998);
// either end counts when the value falls away from it, and a plateau counts from its start.
//
// Reads the voxels, the clip planes (index space) and, per octree node, its range and its CLASS_* (CLASS_BELOW: nowhere above
// `floor`). Writes per pixel kind (surface where the ray meets the volume) and value (stored units;
// 0 where it does not); with LAYERS depth (mm from the eye; +inf for the mean); with COUNTERS the
// cells read and the nodes tested.
#include "lib/beam.clh"
#include "lib/clip.clh"

#if !defined(PROJECTION) || !defined(PROJECTION_EXTREMUM) || !defined(PROJECTION_MEAN) || !defined(PROJECTION_LOCAL)
#error "PROJECTION, which value is wanted, is given by the host"
#endif

// A slope along the way through a cell, as a share of its spread, that rounding may have made.
#define FLAT_SHARE 1e-6f

// What is known of rays on their way.
typedef struct {
    Floats most;    // of sign * Phi
    Floats most_mm; // where it is first reached, from the entry
    Floats known;   // a value that the ray is known to reach
#if PROJECTION == PROJECTION_LOCAL
    Floats turn;    // the highest of a climb, the last of a fall
    Floats turn_mm;
    Mask rising;
#endif
    Mask done;
} Search;

#if PROJECTION == PROJECTION_MEAN
static inline Floats mean_along(VOXELS voxels, VolumeGrid volume, Ray ray, Interval interval, Mask alive, Ints *cells_read)
{
    CellWalk walk = cells_start(volume, ray, interval);
    // Compensated summation (Kahan 1965): thousands of cells keep their digits.
    Floats sum = FLOATS(0.0f);
    Floats lost = FLOATS(0.0f);
    Floats whole = FLOATS(0.0f);
    Floats touched = FLOATS(0.0f);
    // A cell's share of the way, along the axis that the ray crosses fastest: differences of
    // places in the cell keep the digits that differences of t lose.
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
        Floats3 near = point_in_cell(&walk, entry_moment(&walk), walk.axis, NO_LANE);
        Floats3 far = point_in_cell(&walk, exit_moment(&walk, exit), exit_axis(&walk, exit), ALL_LANES);
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

// What a node or cell must beat to matter: by more, but where `ties` count.
static inline Floats to_beat(const Search *search, ProjectionCast cast, Mask *ties)
{
#if PROJECTION == PROJECTION_LOCAL
    // A climb that has reached the threshold ends where all that follows is lower. Else a local maximum
    // that counts, or a higher maximum, is looked for.
    Mask reached = search->rising & search->turn >= cast.threshold;
    *ties = reached | search->most >= cast.threshold;
    return reached ? search->turn : search->most >= cast.threshold ? FLOATS(cast.threshold) : search->most;
#else
    *ties = search->known > search->most;
    return *ties ? search->known : search->most;
#endif
}

// In the lanes of `which`, the ray passes by what cannot matter.
static inline void pass_by(Search *search, ProjectionCast cast, Mask which)
{
#if PROJECTION == PROJECTION_LOCAL
    Mask reached = search->rising & search->turn >= cast.threshold;
    search->done = search->done | (which & reached);
    // What is passed over is below the threshold: what follows is a climb from there.
    which = which & !reached;
    search->rising = search->rising | which;
    search->turn = which ? FLOATS(-INFINITY) : search->turn;
#endif
}

// Comes to an end of a monotone piece, in the lanes of `which`; `slope` is that of the piece before.
static inline void come_to(Search *search, ProjectionCast cast, Floats v, Floats t, Floats slope, Floats flat, Mask which)
{
#if PROJECTION == PROJECTION_LOCAL
    which = which & !search->done;
    Mask climbs = which & (search->turn == -INFINITY | slope > flat);
    Mask falls = which & !climbs & slope < -flat;
    Mask higher = climbs & v > search->turn;
    search->turn_mm = higher ? t : search->turn_mm;
    search->turn = higher ? v : search->turn;
    Mask counts = falls & search->rising & search->turn >= cast.threshold;
    search->done = search->done | counts;
    search->rising = (search->rising | climbs) & (!falls | counts);
    search->turn = falls & !counts ? v : search->turn;
#endif
    Mask more = which & v > search->most;
    search->most = more ? v : search->most;
    search->most_mm = more ? t : search->most_mm;
}

// A cell that may matter, in the lanes of `which`.
static inline void follow_cell(Search *search, ProjectionCast cast, const CellWalk *walk, const Corners *corners, CellExit exit, Mask which)
{
    Moment enters = entry_moment(walk);
    Moment leaves = exit_moment(walk, exit);
    Floats3 near = point_in_cell(walk, enters, walk->axis, NO_LANE);
    Floats3 far = point_in_cell(walk, leaves, exit_axis(walk, exit), ALL_LANES);
    Floats3 way = {far.x - near.x, far.y - near.y, far.z - near.z};
    Cubic cubic = cubic_along(corners, near, way);
    Floats turns[4];
    turns[0] = FLOATS(0.0f);
    cubic_turns(cubic, &turns[1], &turns[2]);
    turns[3] = FLOATS(1.0f);
    // Rise and fall are told by the slope: a dip too shallow for the values' digits has one all the same.
    Floats flat = FLAT_SHARE * (corners_most(corners) - corners_least(corners));
#pragma unroll
    for (uint n = 0u; n < 4u; n++) {
        Floats s = turns[n];
        Floats3 p = {near.x + way.x * s, near.y + way.y * s, near.z + way.z * s};
        Floats v = cast.sign * corners_at(corners, p);
        Floats t = enters.high + (leaves.high - enters.high) * s;
        Mask there = which & (n == 0u || n == 3u ? ALL_LANES : s < 1.0f);
#if PROJECTION == PROJECTION_LOCAL
        // With the nearest filter the field changes at walls alone.
        Floats before = n == 3u ? (turns[2] < 1.0f ? turns[2] : turns[1] < 1.0f ? turns[1] : FLOATS(0.0f)) : turns[n == 0u ? 0u : n - 1u];
        Floats slope = n > 0u ? cast.sign * cubic_slope(cubic, 0.5f * (before + s)) : FILTER_LINEAR ? FLOATS(0.0f) : v - search->turn;
#else
        Floats slope = FLOATS(0.0f);
#endif
        come_to(search, cast, v, t, slope, flat, there);
    }
}

#if PROJECTION == PROJECTION_EXTREMUM
// The most that a ray meets in a cell of sign * Phi, by where it enters and leaves it in single
// precision, which is off by a share of `slack_mm`.
static inline Floats nearly_most(const CellWalk *walk, const Corners *corners, Floats enters_mm, Floats leaves_mm, Floats slack_mm, float sign)
{
    Floats3 near = nearly_in_cell(walk, enters_mm);
    Floats3 far = nearly_in_cell(walk, leaves_mm);
    Floats3 way = {far.x - near.x, far.y - near.y, far.z - near.z};
    Floats fastest = most_of(fabs(walk->x.dir.high), most_of(fabs(walk->y.dir.high), fabs(walk->z.dir.high)));
    Floats off = 4.0f * (slack_mm * fastest + walk->rounding);
    return cubic_bound(cubic_along(corners, near, way), sign) + off * (corners_most(corners) - corners_least(corners));
}
#endif

// Walks the cells of the box, in the lanes of `alive` that stand in it; gives the lanes that go on.
static inline Mask search_box(Search *search, ProjectionCast cast, CellWalk *walk, const CellBox *box, VOXELS voxels,
                              VolumeGrid volume, Mask alive, Ints *cells_read)
{
    Mask reading = alive & box_holds(box, walk->cell);
#if PROJECTION == PROJECTION_EXTREMUM
    Floats enters_mm = entry_moment(walk).high;
    Floats slack_mm = FLOATS(0.0f);
#endif
    while (ANY(reading)) {
        Corners corners = cell_corners(voxels, volume, walk, 0.0f);
        *cells_read += reading ? INTS(1) : INTS(0);
        CellExit exit = cell_exit(walk, reading);
        Floats bound = cast.sign > 0.0f ? corners_most(&corners) : -corners_least(&corners);
        Mask ties;
        Floats beat = to_beat(search, cast, &ties);
        Mask matters = reading & (bound > beat | (bound == beat & ties));
#if PROJECTION == PROJECTION_EXTREMUM
        if (ANY(matters)) {
            Floats leaves_mm = least_of(exit.nearly_mm, walk->end.high);
            Floats most = nearly_most(walk, &corners, enters_mm, leaves_mm, slack_mm + exit.slack_mm, cast.sign);
            matters = matters & (most > beat | (most == beat & ties));
        }
        enters_mm = exit.nearly_mm;
        slack_mm = exit.slack_mm;
#endif
        pass_by(search, cast, reading & !matters);
        if (ANY(matters))
            follow_cell(search, cast, walk, &corners, exit, matters);
        Mask goes_on = reading & !search->done & !exit.ends;
        alive = alive & !(reading & !goes_on);
        cells_step(walk, exit, goes_on);
        reading = goes_on & box_holds(box, walk->cell);
    }
    return alive;
}

static inline void search_along(Search *search, VOXELS voxels, const global uchar *node_class, const global float2 *node_range,
                                const global uint4 *levels, VolumeGrid volume, Ray ray, Interval interval, ProjectionCast cast, Mask alive,
                                Ints *cells_read, Ints *nodes_tested)
{
    search->most = FLOATS(cast.floor);
    search->most_mm = FLOATS(0.0f);
    search->known = FLOATS(-INFINITY);
    search->done = NO_LANE;
#if PROJECTION == PROJECTION_LOCAL
    search->turn = FLOATS(-INFINITY);
    search->turn_mm = FLOATS(0.0f);
    search->rising = ALL_LANES;
#endif
    CellWalk walk = cells_start(volume, ray, interval);
    Walk way = walk_start(volume, cast.traverse);
    CellBox box;
    int everything = cast.traverse == TRAVERSE_OFF ? INT_MAX : 0;
    box.low.x = box.low.y = box.low.z = INTS(0);
    box.high.x = box.high.y = box.high.z = INTS(everything);
    Ints3 before = octree_cell(volume, &walk); // in the last node
    Beam beam;
    bool together = FILTER_LINEAR && cast.traverse == TRAVERSE_DISTANCE && ANY(alive) && beam_start(&beam, &walk, levels, volume, alive);
#if PROJECTION == PROJECTION_EXTREMUM
    // Where most is to be expected, first: what the rays reach there all else must beat.
    BeamRegion highest = {0, 0, CLASS_VISIT};
    Search ahead = *search;
    if (together) {
        highest = highest_layer(&beam, node_class, node_range, cast.sign, nodes_tested);
        CellWalk from = walk;
        Mask behind = alive & before_region(&beam, highest, &walk);
        Mask there = leap_to_region(&beam, highest, &from, behind) | (alive & !behind);
        box = region_box(&beam, highest);
        search_box(&ahead, cast, &from, &box, voxels, volume, there, cells_read);
        search->known = ahead.most;
    }
#endif
    while (ANY(alive)) {
        Mask ties;
        Floats beat = to_beat(search, cast, &ties);
        if (together) {
            BeamRegion region;
            float least = LEAST_LANE(alive ? beat : FLOATS(INFINITY));
            if (!beam_next_to_beat(&beam, voxels, node_class, node_range, cast.sign, least, ANY(alive & ties), &region, nodes_tested)) {
                pass_by(search, cast, alive);
                break;
            }
#if PROJECTION == PROJECTION_EXTREMUM
            if (region.low >= highest.low && region.low < highest.high) {
                // Looked at already.
                Mask more = alive & ahead.most > search->most;
                search->most = more ? ahead.most : search->most;
                search->most_mm = more ? ahead.most_mm : search->most_mm;
                continue;
            }
#endif
            Mask behind = alive & before_region(&beam, region, &walk);
            pass_by(search, cast, behind);
            behind = behind & !search->done;
            Mask goes_on = leap_to_region(&beam, region, &walk, behind);
            alive = alive & !(search->done | (behind & !goes_on));
            box = region_box(&beam, region);
        } else {
            Mask leaping = alive & !box_holds(&box, walk.cell);
            while (ANY(leaping)) {
                Ints3 cell = octree_cell(volume, &walk);
                walk_on(&way, before, cell, leaping);
                before.x = leaping ? cell.x : before.x;
                before.y = leaping ? cell.y : before.y;
                before.z = leaping ? cell.z : before.z;
                beat = to_beat(search, cast, &ties);
                Mask skips = walk_down_to_beat(&way, node_class, node_range, levels, cell, cast.sign, beat, ties, &box, leaping, nodes_tested);
                box_to_the_end(volume, &box, leaping);
                leaping = leaping & skips;
                pass_by(search, cast, leaping);
                Mask goes_on = cells_leap(&walk, &box, leaping & !search->done);
                alive = alive & !(leaping & !goes_on);
                leaping = goes_on;
            }
        }
        alive = search_box(search, cast, &walk, &box, voxels, volume, alive, cells_read);
    }
#if PROJECTION == PROJECTION_LOCAL
    Mask counts = search->rising & search->turn >= cast.threshold;
    search->most = counts ? search->turn : search->most;
    search->most_mm = counts ? search->turn_mm : search->most_mm;
#endif
}
#endif

kernel void exact_projection(VOXELS voxels, const global uchar *node_class, const global float2 *node_range,
                             const global uint4 *levels, const global float4 *clip_planes, uint clip_count,
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
    Pixels pixels = tile_pixels(rays);
    Ray ray = pixel_ray(rays, pixels);
    Interval interval = volume_interval(volume, ray);
    clip_interval(&interval, clip_planes, clip_count, ray);
    Mask meets = pixels.inside & interval.enter <= interval.exit;
    Ints cells_read = INTS(0);
    Ints nodes_tested = INTS(0);
#if PROJECTION == PROJECTION_MEAN
    Floats found = mean_along(voxels, volume, ray, interval, meets, &cells_read);
    Floats found_mm = FLOATS(INFINITY); // from the entry
#else
    Search search;
    search_along(&search, voxels, node_class, node_range, levels, volume, ray, interval, cast, meets, &cells_read, &nodes_tested);
    Floats found = cast.sign * search.most;
    Floats found_mm = search.most_mm;
#endif
    Ints met = meets ? INTS(KIND_SURFACE) : INTS(KIND_NOTHING);
    Floats seen = meets ? found : FLOATS(0.0f);
    SCATTER(pixels.inside, kind, pixels.index, met);
    SCATTER(pixels.inside, value, pixels.index, seen);
#if LAYERS
    Floats depth_mm = meets ? ray.base_mm + (interval.enter + found_mm) : FLOATS(INFINITY);
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
#endif
#if COUNTERS
    SCATTER(pixels.inside, steps, pixels.index, cells_read);
    SCATTER(pixels.inside, nodes, pixels.index, nodes_tested);
#endif
}
