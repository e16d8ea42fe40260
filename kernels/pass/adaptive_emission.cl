// Emission and absorption along each ray, front to back, within an error bound (after Campagnolo,
// Celes and de Figueiredo 2015, who halve Simpson panels for both integrals).
//
// The cells along the ray are walked, nodes that are transparent wholly are leapt over. In a cell
// the field is a cubic along the ray; between its turning points it is monotone, so that a panel's
// ends tell which values it meets. A panel within one interval of the transfer function is looked
// at by Simpson's rule, one that meets a knot as if the field were linear across it
// (lib/preintegrated.clh), so that no value is missed. A panel is compared with its two halves: if
// they differ by no more than the panel's share of the bound the halves count, else the panel is
// halved. What that comparison cannot see where knots are met is added to it (`unseen`). A panel's
// share is half its share of the light that the ray still gives plus half its share of the ray's
// length, so that all shares of a ray are 1 at most; a difference of opacity counts for itself and
// for all that lies behind. A ray ends once its transmission falls below least_transmission.
//
// Reads the voxels, the transfer function's knots (values in stored units; colours linear light
// with opacity in w; sums as mean_medium has them), the clip planes (index space), per octree node
// its CLASS_*, and a bit per cell in which something absorbs. Writes color, premultiplied linear light;
// with LAYERS depth (mm from the eye) and value (stored units), with NORMALS the normal: means along the
// ray, weighted as its light is, where the opacity is layers_from at least, else +inf and 0 (they have no
// part in the bound); with COUNTERS the times the medium was looked at and the nodes tested.
#include "lib/beam.clh"
#include "lib/clip.clh"
#include "lib/gather.clh"
#include "lib/means.clh"
#include "lib/preintegrated.clh"

#ifndef ADAPTIVE_HALVINGS
#error "ADAPTIVE_HALVINGS, how often a piece of a cell is halved, is given by the host"
#endif

// The narrowest panel's share of its piece: it counts whatever the estimate.
#define LEAST_WIDTH (1.0f / (float)(1u << ADAPTIVE_HALVINGS))
// Every panel that counts may follow one that was halved, and the first as many as there are levels.
#define MOST_TRIES ((2u << ADAPTIVE_HALVINGS) + ADAPTIVE_HALVINGS)

// A deeper panel is divided before its estimate is believed: its nodes might all lie in the dark.
#define DEEP 3.0f

// The halves' error as a share of their difference from the whole: a fifteenth by Simpson's rule, a
// third where the field is taken for linear.
#define FINER 0.33f

// What rays look at.
typedef struct {
    Transfer transfer;
    KnotSums knot_sums;
    VolumeGrid volume;
    EmissionCast cast;
#if HAS_GRADIENT && GRADIENT == GRADIENT_PRECOMPUTED
    Directions directions;
#endif
    Shading shading;
    Floats3 toward_eye;
} Sight;

// Monotone pieces of rays, each in a cell.
typedef struct {
    Floats3 near, way;  // index space: where the ray enters the cell, and its way through
    Cubic phi;          // along the way
    Floats from, width; // of the piece, shares of the way
    Floats t_mm, length_mm; // of the piece: where it begins, from the ray's entry
} Piece;

// A point of a piece at u, 0 to 1.
typedef struct {
    Floats value;
    Ints after; // knots at or below the value
    Medium medium;
} Point;

static inline Medium lit_at(VOXELS voxels, const Sight *sight, const Piece *piece, Floats u, Medium medium)
{
#if HAS_GRADIENT
#if FILTER_LINEAR
    Floats s = piece->from + piece->width * u;
#else
    Floats s = FLOATS(0.5f); // a cell has one gradient; what lies on its walls may be read from the next
#endif
    Floats3 p = {piece->near.x + s * piece->way.x, piece->near.y + s * piece->way.y, piece->near.z + s * piece->way.z};
    p = clamp_to_domain(sight->volume, p);
    return lit_medium(GRADIENT_FROM(voxels, sight->directions), sight->volume, sight->shading, sight->toward_eye, p, medium);
#else
    return medium;
#endif
}

static inline Point point_at(VOXELS voxels, const Sight *sight, const Piece *piece, Floats u)
{
    Point point;
    point.value = cubic_at(piece->phi, piece->from + piece->width * u);
    point.after = knots_up_to(sight->transfer, point.value);
    Seen seen = transfer_between(sight->transfer, point.after, point.value);
    Medium medium = {light_of(seen.rgb, point.value), absorption_per_mm(sight->cast, seen.opacity)};
    place_light(&medium.light, piece->t_mm + u * piece->length_mm);
    point.medium = lit_at(voxels, sight, piece, u, medium);
    return point;
}

// A panel, and the light that it gives by itself.
typedef struct {
    Light light;
    Floats depth, opacity;
} Lit;

// The panel from u on, `width` wide, in the lanes of `which`.
static inline Lit panel_of(VOXELS voxels, const Sight *sight, const Piece *piece, const Point *near, const Point *middle, const Point *far,
                           Floats u, Floats width, Mask which)
{
    Floats length_mm = width * piece->length_mm;
    Panel panel = panel_simpson(near->medium, middle->medium, far->medium, length_mm);
    Mask meets_knots = which & near->after != far->after;
    if (ANY(meets_knots)) {
        Medium mean = mean_medium(sight->transfer, sight->knot_sums, sight->cast, near->value, far->value);
        Panel linear = panel_linear(lit_at(voxels, sight, piece, u + 0.5f * width, mean), near->value, far->value,
                                    piece->t_mm + u * piece->length_mm, length_mm);
        panel.light = light_if(meets_knots, linear.light, panel.light);
        panel.depth = meets_knots ? linear.depth : panel.depth;
    }
    Lit lit;
    lit.depth = panel.depth;
    lit.opacity = kept_back(panel.depth);
    lit.light = weighted(panel.light, lit.opacity);
    return lit;
}

// A panel behind another, as one.
static inline Lit lit_behind(const Lit *one, const Lit *two)
{
    Lit both;
    both.depth = one->depth + two->depth;
    both.opacity = one->opacity + two->opacity * (1.0f - one->opacity);
    both.light = sum_of(one->light, weighted(two->light, 1.0f - one->opacity));
    return both;
}

// How far apart two results for one panel are: in its light, and in what it lets through.
static inline Floats apart(const Lit *a, const Lit *b)
{
    Floats x = fabs(a->light.rgb.x - b->light.rgb.x);
    Floats y = fabs(a->light.rgb.y - b->light.rgb.y);
    Floats z = fabs(a->light.rgb.z - b->light.rgb.z);
    return most_of(x, most_of(y, z)) + fabs(a->opacity - b->opacity);
}

// What a panel that meets knots may be off by although its halves agree: a spike that lies in one of
// them is as deep as the field is slow there, not as it is slow on the whole; and of colours that
// share a panel the nearer hides the farther, by an eighth of the depth's square at most.
static inline Floats unseen(const Sight *sight, const Piece *piece, const Point *near, const Point *far, const Lit *lit, Floats u, Floats width)
{
    Floats a = fabs(cubic_slope(piece->phi, piece->from + piece->width * u));
    Floats b = fabs(cubic_slope(piece->phi, piece->from + piece->width * (u + 0.5f * width)));
    Floats c = fabs(cubic_slope(piece->phi, piece->from + piece->width * (u + width)));
    Floats fastest = most_of(a, most_of(b, c));
    Floats slowest = least_of(a, least_of(b, c));
    Floats uneven = fastest > 0.0f ? (fastest - slowest) / (fastest + slowest) : FLOATS(0.0f);
    Floats hidden = (1.0f - lit->opacity) * lit->depth * uneven
                  + 0.125f * sight->cast.color_spread * least_of(lit->depth * lit->depth, 8.0f * lit->opacity);
    return near->after == far->after ? FLOATS(0.0f) : hidden;
}

// Adds pieces, in the lanes of `which`. `share_per_mm`: half the bound over the ray's length.
static inline void gather_pieces(VOXELS voxels, const Sight *sight, Gathered *gathered, const Piece *piece, Floats share_per_mm, Mask which,
                                 Ints *samples)
{
    Floats u = FLOATS(0.0f);
    Floats width = FLOATS(1.0f);
    which = which & gathered->transmission >= sight->cast.least_transmission;
    if (!ANY(which))
        return;
    Point points[5]; // a quarter of the panel apart
    points[0] = point_at(voxels, sight, piece, FLOATS(0.0f));
    *samples += which ? INTS(1) : INTS(0);
    for (uint tries = 0u; tries < MOST_TRIES && ANY(which); tries++) {
        // Sums of powers of two, not below the least: exact.
        width = least_of(width, 1.0f - u);
        for (uint n = 1u; n < 5u; n++)
            points[n] = point_at(voxels, sight, piece, u + (0.25f * (float)n) * width);
        *samples += which ? INTS(4) : INTS(0);
        Lit lits[3]; // the panel and its halves
        for (uint n = 0u; n < 3u; n++) {
            uint first = n == 2u ? 2u : 0u;
            uint apart_by = n == 0u ? 2u : 1u;
            Floats begin = n == 2u ? u + 0.5f * width : u;
            Floats wide = n == 0u ? width : 0.5f * width;
            lits[n] = panel_of(voxels, sight, piece, &points[first], &points[first + apart_by], &points[first + 2u * apart_by], begin, wide, which);
        }
        Lit both = lit_behind(&lits[1], &lits[2]);
        Floats allowed = 0.5f * sight->cast.bound * gathered->transmission * both.opacity
                       + share_per_mm * width * piece->length_mm;
        Floats off = FINER * apart(&lits[0], &both) + unseen(sight, piece, &points[0], &points[2], &lits[1], u, 0.5f * width)
                   + (1.0f - lits[1].opacity) * unseen(sight, piece, &points[2], &points[4], &lits[2], u + 0.5f * width, 0.5f * width);
        Mask agree = gathered->transmission * off <= allowed & both.depth <= DEEP;
        Mask counts = which & (agree | width <= LEAST_WIDTH);
        gather_light(gathered, both.light, both.depth, counts);
        u = counts ? u + width : u;
        width = counts ? 2.0f * width : 0.5f * width;
        points[0].value = counts ? points[4].value : points[0].value;
        points[0].after = counts ? points[4].after : points[0].after;
        points[0].medium = medium_if(counts, points[4].medium, points[0].medium);
        which = which & u < 1.0f & gathered->transmission >= sight->cast.least_transmission;
    }
}

// Adds the cells in which rays stand, in the lanes of `which`: a monotone piece after the other.
static inline void gather_cells(VOXELS voxels, const Sight *sight, Gathered *gathered, const CellWalk *walk, const Corners *corners, CellExit exit,
                                Floats share_per_mm, Mask which, Ints *samples)
{
    Moment enters = entry_moment(walk);
    Moment leaves = exit_moment(walk, exit);
    Floats length_mm = (leaves.high - enters.high) + (leaves.low - enters.low);
    Floats3 near = point_in_cell(walk, enters, walk->axis, NO_LANE);
    Floats3 far = point_in_cell(walk, leaves, exit_axis(walk, exit), ALL_LANES);
    const float corner = FILTER_LINEAR ? 0.0f : 0.5f; // with the nearest filter cells are the voxels' own boxes
    Piece piece;
    piece.way.x = far.x - near.x;
    piece.way.y = far.y - near.y;
    piece.way.z = far.z - near.z;
    piece.phi = cubic_along(corners, near, piece.way);
    piece.near.x = AS_FLOATS(walk->cell.x) + near.x - corner;
    piece.near.y = AS_FLOATS(walk->cell.y) + near.y - corner;
    piece.near.z = AS_FLOATS(walk->cell.z) + near.z - corner;
    Floats ends[4];
    ends[0] = FLOATS(0.0f);
    cubic_turns(piece.phi, &ends[1], &ends[2]);
    ends[3] = FLOATS(1.0f);
    which = which & length_mm > 0.0f;
    for (uint n = 1u; n < 4u; n++) {
        piece.from = ends[n - 1u];
        piece.width = ends[n] - ends[n - 1u];
        piece.t_mm = enters.high + piece.from * length_mm;
        piece.length_mm = piece.width * length_mm;
        gather_pieces(voxels, sight, gathered, &piece, share_per_mm, which & piece.width > 0.0f, samples);
    }
}

// In the lanes of `alive`.
static inline void gather_along(VOXELS voxels, const Sight *sight, Gathered *gathered, const global uchar *node_class,
                                const global uint4 *levels, const global ulong *cells, Ray ray, Interval interval, Mask alive,
                                Ints *samples, Ints *nodes_tested)
{
    VolumeGrid volume = sight->volume;
    EmissionCast cast = sight->cast;
    Floats share_per_mm = 0.5f * cast.bound / most_of(interval.exit - interval.enter, FLOATS(FLT_MIN));
    CellWalk walk = cells_start(volume, ray, interval);
    Walk way = walk_start(volume, cast.traverse);
    CellBox box;
    int everything = cast.traverse == TRAVERSE_OFF ? INT_MAX : 0;
    box.low.x = box.low.y = box.low.z = INTS(0);
    box.high.x = box.high.y = box.high.z = INTS(everything);
    Ints3 before = octree_cell(volume, &walk); // in the last node
    Beam beam;
    bool together = FILTER_LINEAR && cast.traverse == TRAVERSE_DISTANCE && beam_start(&beam, &walk, levels, volume, alive);
    Corners corners;
#pragma unroll
    for (uint i = 0u; i < 8u; i++)
        corners.v[i] = FLOATS(0.0f);
    while (ANY(alive)) {
        // From node to node, until every ray stands in a cell that must be read.
        while (together && ANY(alive) && !ANY(alive & box_holds(&box, walk.cell))) {
            BeamRegion region;
            if (!beam_next(&beam, voxels, node_class, cells, 0.0f, &region, nodes_tested)) {
                alive = NO_LANE;
            } else if (region.class == CLASS_VISIT) {
                Mask behind = alive & before_region(&beam, region, &walk);
                alive = alive & !(behind & !leap_to_region(&beam, region, &walk, behind));
                box = region_box(&beam, region);
            }
        }
        Mask leaping = together ? NO_LANE : alive & !box_holds(&box, walk.cell);
        while (ANY(leaping)) {
            Ints3 cell = octree_cell(volume, &walk);
            walk_on(&way, before, cell, leaping);
            before.x = leaping ? cell.x : before.x;
            before.y = leaping ? cell.y : before.y;
            before.z = leaping ? cell.z : before.z;
            Ints byte = walk_down(&way, node_class, levels, cell, leaping, nodes_tested);
            set_box(&box, cell, way.level, reach_of(byte), leaping);
            box_to_the_end(volume, &box, leaping);
            leaping = leaping & class_of(byte) == CLASS_BELOW;
            Mask goes_on = cells_leap(&walk, &box, leaping);
            alive = alive & !(leaping & !goes_on);
            leaping = goes_on;
        }
        // From cell to cell, until every ray stands in one where something absorbs.
        Mask reading = alive & box_holds(&box, walk.cell);
        Mask standing = NO_LANE;
        while (ANY(reading)) {
            Corners read = cell_corners(voxels, volume, &walk, 0.0f);
#pragma unroll
            for (uint i = 0u; i < 8u; i++)
                corners.v[i] = reading ? read.v[i] : corners.v[i];
            Medium mean = mean_medium(sight->transfer, sight->knot_sums, cast, corners_least(&read), corners_most(&read));
            Mask absorbs = mean.absorption > 0.0f;
            standing = standing | (reading & absorbs);
            reading = reading & !absorbs;
            CellExit exit = cell_exit(&walk, reading);
            Mask goes_on = reading & !exit.ends;
            cells_step(&walk, exit, goes_on);
            alive = alive & !(reading & exit.ends);
            reading = goes_on & box_holds(&box, walk.cell);
        }
        if (ANY(standing)) {
            CellExit exit = cell_exit(&walk, standing);
            gather_cells(voxels, sight, gathered, &walk, &corners, exit, share_per_mm, standing, samples);
            Mask goes_on = standing & !exit.ends & gathered->transmission >= cast.least_transmission;
            cells_step(&walk, exit, goes_on);
            alive = alive & !(standing & !goes_on);
        }
    }
}

kernel void adaptive_emission(VOXELS voxels, const global uchar *node_class, const global uint4 *levels, const global ulong *cells,
                              const global float *knot_values, const global float4 *knot_colors, const global float4 *knot_sums,
#if LAYERS
                              const global float *knot_value_sums,
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
    Mask meets = pixels.inside & interval.enter <= interval.exit;
    Gathered gathered = gather_start();
    Ints sample_count = INTS(0);
    Ints node_count = INTS(0);
    if (ANY(meets)) {
        Sight sight;
        sight.transfer.values = knot_values;
        sight.transfer.colors = knot_colors;
        sight.transfer.knots = cast.knots;
        sight.knot_sums.sums = knot_sums;
#if LAYERS
        sight.knot_sums.value_sums = knot_value_sums;
#endif
        sight.volume = volume;
        sight.cast = cast;
#if HAS_GRADIENT && GRADIENT == GRADIENT_PRECOMPUTED
        Directions precomputed = {directions, direction_grid};
        sight.directions = precomputed;
#endif
        sight.shading = shading;
        sight.toward_eye.x = -ray.dir_world.x;
        sight.toward_eye.y = -ray.dir_world.y;
        sight.toward_eye.z = -ray.dir_world.z;
        gather_along(voxels, &sight, &gathered, node_class, levels, cells, ray, interval, meets, &sample_count, &node_count);
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
