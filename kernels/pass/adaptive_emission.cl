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
// with opacity in w; sums as mean_medium has them), the clip planes (index space) and, per octree
// node, its CLASS_*. Writes color, premultiplied linear light; with COUNTERS the times the medium was
// looked at and the nodes tested.
#include "old/cells.clh"
#include "old/clip.clh"
#include "old/gather.clh"
#include "old/medium.clh"
#include "old/preintegrated.clh"

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

// What a ray looks at in one cell, or in a monotone piece of it.
typedef struct {
    const global float *knot_values;
    const global float4 *knot_colors;
    const global float4 *knot_sums;
    VolumeGrid volume;
    EmissionCast cast;
#if SHADED
    GradientSource gradient;
#endif
    Shading shading;
    float3 toward_eye;
    float3 near, way;  // index space: where the ray enters the cell, and its way through
    Cubic phi;         // along the way
    float from, width; // of the piece, shares of the way
    float length_mm;   // of the piece
} Piece;

// A point of a piece at u, 0 to 1.
typedef struct {
    float value;
    uint after; // knots at or below the value
    Medium medium;
} Point;

static inline Medium lit_at(const Piece *piece, float u, Medium medium)
{
#if SHADED
    float3 p = clamp_to_domain(piece->volume, piece->near + (piece->from + piece->width * u) * piece->way);
    return lit_medium(piece->gradient, piece->volume, piece->shading, piece->toward_eye, p, medium);
#else
    return medium;
#endif
}

static inline Point point_at(const Piece *piece, float u)
{
    Point point;
    point.value = cubic_at(piece->phi, piece->from + piece->width * u);
    point.after = knots_up_to(piece->knot_values, piece->cast.knots, point.value);
    float4 seen = transfer_between(piece->knot_values, piece->knot_colors, piece->cast.knots, point.after, point.value);
    point.medium.rgb = seen.xyz;
    point.medium.absorption = absorption_per_mm(piece->cast, seen.w);
    point.medium = lit_at(piece, u, point.medium);
    return point;
}

// A panel, and the light that it gives by itself.
typedef struct {
    float3 light;
    float depth, opacity;
} Lit;

static inline Lit lit_of(Panel panel)
{
    Lit lit;
    lit.depth = panel.depth;
    lit.opacity = -expm1(-panel.depth);
    lit.light = panel.rgb * lit.opacity;
    return lit;
}

// The panel from u on, `width` wide.
static inline Lit panel_of(const Piece *piece, Point near, Point middle, Point far, float u, float width)
{
    float length_mm = width * piece->length_mm;
    if (near.after == far.after)
        return lit_of(panel_simpson(near.medium, middle.medium, far.medium, length_mm));
    Medium mean = mean_medium(piece->knot_values, piece->knot_colors, piece->knot_sums, piece->cast, near.value, far.value);
    return lit_of(panel_midpoint(lit_at(piece, u + 0.5f * width, mean), length_mm));
}

// How far apart two results for one panel are: in its light, and in what it lets through.
static inline float apart(Lit a, Lit b)
{
    float3 light = fabs(a.light - b.light);
    return fmax(light.x, fmax(light.y, light.z)) + fabs(a.opacity - b.opacity);
}

// What a panel that meets knots may be off by although its halves agree: a spike that lies in one of
// them is as deep as the field is slow there, not as it is slow on the whole; and of colours that
// share a panel the nearer hides the farther, by an eighth of the depth's square at most.
static inline float unseen(const Piece *piece, Point near, Point far, Lit lit, float u, float width)
{
    if (near.after == far.after)
        return 0.0f;
    float a = fabs(cubic_slope(piece->phi, piece->from + piece->width * u));
    float b = fabs(cubic_slope(piece->phi, piece->from + piece->width * (u + 0.5f * width)));
    float c = fabs(cubic_slope(piece->phi, piece->from + piece->width * (u + width)));
    float fastest = fmax(a, fmax(b, c));
    float slowest = fmin(a, fmin(b, c));
    float uneven = fastest > 0.0f ? (fastest - slowest) / (fastest + slowest) : 0.0f;
    return (1.0f - lit.opacity) * lit.depth * uneven
         + 0.125f * piece->cast.color_spread * fmin(lit.depth * lit.depth, 8.0f * lit.opacity);
}

// Adds a piece. `share_per_mm`: half the bound over the ray's length.
static inline void gather_piece(Gathered *gathered, const Piece *piece, float share_per_mm, uint *samples)
{
    float u = 0.0f;
    float width = 1.0f;
    Point near = point_at(piece, 0.0f);
    *samples += 1u;
    for (uint tries = 0u; tries < MOST_TRIES && u < 1.0f && gathered->transmission >= piece->cast.least_transmission; tries++) {
        // Sums of powers of two, not below the least: exact.
        width = fmin(width, 1.0f - u);
        Point middle = point_at(piece, u + 0.5f * width);
        Point far = point_at(piece, u + width);
        Point first = point_at(piece, u + 0.25f * width);
        Point third = point_at(piece, u + 0.75f * width);
        *samples += 4u;
        Lit whole = panel_of(piece, near, middle, far, u, width);
        Lit one = panel_of(piece, near, first, middle, u, 0.5f * width);
        Lit two = panel_of(piece, middle, third, far, u + 0.5f * width, 0.5f * width);
        Lit both;
        both.depth = one.depth + two.depth;
        both.opacity = one.opacity + two.opacity * (1.0f - one.opacity);
        both.light = one.light + two.light * (1.0f - one.opacity);
        float allowed = 0.5f * piece->cast.bound * gathered->transmission * both.opacity
                      + share_per_mm * width * piece->length_mm;
        float off = FINER * apart(whole, both) + unseen(piece, near, middle, one, u, 0.5f * width)
                  + (1.0f - one.opacity) * unseen(piece, middle, far, two, u + 0.5f * width, 0.5f * width);
        bool agree = gathered->transmission * off <= allowed && both.depth <= DEEP;
        if (agree || width <= LEAST_WIDTH) {
            gather_light(gathered, both.light, both.depth);
            u += width;
            width *= 2.0f;
            near = far;
        } else {
            width *= 0.5f;
        }
    }
}

kernel void adaptive_emission(const global VOXEL *voxels, const global uchar *node_class, const global uint4 *levels,
                              const global float *knot_values, const global float4 *knot_colors, const global float4 *knot_sums,
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
        Piece piece;
        piece.knot_values = knot_values;
        piece.knot_colors = knot_colors;
        piece.knot_sums = knot_sums;
        piece.volume = volume;
        piece.cast = cast;
#if SHADED
#if GRADIENT == GRADIENT_PRECOMPUTED
        piece.gradient.directions = directions;
        piece.gradient.grid = direction_grid;
#else
        piece.gradient.voxels = voxels;
#endif
#endif
        piece.shading = shading;
        piece.toward_eye = -ray.dir_world;
        float share_per_mm = 0.5f * cast.bound / fmax(interval.exit - interval.enter, FLT_MIN);
        CellWalk walk = cells_start(volume, ray, interval);
        Walk way = walk_start(volume, cast.traverse);
        CellBox box = {(uint3)(0u), (uint3)(0u)};
        uint3 before = octree_cell(volume, &walk);
        bool more = true;
        while (more && gathered.transmission >= cast.least_transmission) {
            bool skip = false;
            if (cast.traverse != TRAVERSE_OFF && !box_holds(box, walk.cell)) {
                uint3 cell = octree_cell(volume, &walk);
                walk_on(&way, before, cell);
                before = cell;
                uint byte = walk_down(&way, node_class, levels, cell, &node_count);
                skip = class_of(byte) == CLASS_BELOW;
                box = box_to_the_end(volume, node_box(cell, way.level, reach_of(byte)));
            }
            if (skip) {
                more = cells_leap(&walk, box);
                continue;
            }
            Corners corners = cell_corners(voxels, volume, &walk, 0.0f);
            CellExit exit = cell_exit(&walk);
            float least = corners_least(&corners);
            float most = corners_most(&corners);
            float length_mm = (exit.t.x - walk.t.x) + (exit.t.y - walk.t.y);
            bool absorbs = mean_medium(knot_values, knot_colors, knot_sums, cast, least, most).absorption > 0.0f;
            if (absorbs && length_mm > 0.0f) {
                float3 near = point_in_cell(&walk, walk.t, walk.axis, false);
                float3 far = point_in_cell(&walk, exit.t, exit.axis, true);
                piece.phi = cubic_along(&corners, near, far - near);
                piece.near = convert_float3(walk.cell) + near;
#if !FILTER_LINEAR
                piece.near -= 0.5f; // cells are the voxels' own boxes
#endif
                piece.way = far - near;
                float ends[4] = {0.0f, 1.0f, 1.0f, 1.0f};
                uint last = cubic_turns(piece.phi, &ends[1], &ends[2]) + 1u;
                ends[last] = 1.0f;
                for (uint n = 1u; n <= last; n++) {
                    piece.from = ends[n - 1u];
                    piece.width = ends[n] - ends[n - 1u];
                    piece.length_mm = piece.width * length_mm;
                    gather_piece(&gathered, &piece, share_per_mm, &sample_count);
                }
            }
            more = cells_step(&walk, exit);
        }
    }

    color[pixel] = gathered_color(gathered);
#if COUNTERS
    steps[pixel] = sample_count;
    nodes[pixel] = node_count;
#endif
}
