// Emission and absorption along each ray, front to back, within an error bound (after Campagnolo,
// Celes and de Figueiredo 2015, who halve Simpson panels for both integrals).
//
// The cells along the ray are walked, nodes that are transparent wholly are leapt over. In a cell
// the field is a cubic along the ray; between its turning points it is monotone, so that a panel's
// ends bound the values that it meets. A panel within one interval of the transfer function is
// integrated by Simpson's rule, one that meets a knot as if the field were linear across it
// (lib/light/preintegrated.clh), so that no value is missed. A panel is compared with its two halves: if
// they differ by no more than the panel's share of the bound the halves count, else the panel is
// halved. What that comparison cannot see where knots are met is added to it (`unseen`). A panel's
// share is half its share of the light that the ray still gives plus half its share of the ray's
// length, so that all shares of a ray are 1 at most; a difference of opacity counts for itself and
// for all that lies behind. A ray ends once its transmittance falls below min_transmittance.
//
// Reads the voxels, the transfer function's knots (values in stored units; colours linear light
// with opacity in w; sums as mean_medium has them), the clip planes (index space), per octree node
// its CLASS_*, and a bit per cell in which something absorbs. Writes color, premultiplied linear light;
// with LAYERS depth (mm from the eye) and value (stored units), with NORMALS the normal, with VISIBILITY what reaches it of the first light: means along the
// ray, weighted as its light is, where the opacity is layers_from at least, else +inf and 0 (they have no
// part in the bound); with COUNTERS the samples of the medium and the nodes tested.
#include "lib/light/emission.clh"
#include "lib/skip/cell_path.clh"
#include "lib/skip/march.clh"

// The narrowest panel's share of its piece: it counts whatever the estimate.
#define MIN_WIDTH (1.0f / (float)(1u << ADAPTIVE_HALVINGS))
// Every panel that counts may follow one that was halved, and the first as many as there are levels.
#define MAX_TRIES ((2u << ADAPTIVE_HALVINGS) + ADAPTIVE_HALVINGS)

// A deeper panel is divided before its estimate is believed: its nodes might all lie in the dark.
#define DEEP 3.0f

// Of colours that share a panel the nearer hides the farther, by this share of the depth's square at most.
#define HIDDEN_SHARE 0.125f

// The halves' error as a share of their difference from the whole: a fifteenth by Simpson's rule, a
// third where the field is taken for linear.
#define FINER 0.33f

#if SHADED && SHADOWS != SHADOWS_NONE
// The shares of lights that reach the ends of a path through a cell; between them they are interpolated: lights dim little in
// a cell, and a feeler costs more than all else at a point.
typedef struct {
    Floats near[MAX_LIGHTS], far[MAX_LIGHTS];
    Floats far_t; // where the path ends
} LightsAlong;
#define LIGHTS_ALONG const LightsAlong *lights;
#define LIGHTS_PARAMETER , LightsAlong *lights
#define LIGHTS_GIVEN , &lights
#else
#define LIGHTS_ALONG
#define LIGHTS_PARAMETER
#define LIGHTS_GIVEN
#endif

// A monotone piece of a path through cells.
typedef struct {
    CellPath cell;
    LIGHTS_ALONG
    Floats from, width;     // shares of the path
    Floats t_mm, length_mm; // where it begins, from the ray's entry
} Piece;

// A point of a piece at u, 0 to 1.
typedef struct {
    Floats value;
    Ints after; // knots at or below the value
    Medium medium;
} Point;

#if SHADED && SHADOWS != SHADOWS_NONE
// Follows feelers from the ends of the paths of `which`, of which the near one may be where the path before ended.
static inline void feel_along(VOXELS voxels, const Emitter *emitter, const CellPath *path, LightsAlong *lights, Mask which)
{
    Mask known = path->enters == lights->far_t;
    for (uint n = 0u; n < MAX_LIGHTS; n++)
        lights->near[n] = lights->far[n];
    if (ANY(which & !known)) {
        Floats begins[MAX_LIGHTS];
        Floats3 near = clamp_to_domain(emitter->volume, path->near);
        lights_reaching(voxels, &emitter->feelers, emitter->shading, near, emitter->toward_eye, which & !known, begins);
        for (uint n = 0u; n < MAX_LIGHTS; n++)
            lights->near[n] = known ? lights->near[n] : begins[n];
    }
    Floats3 far = {path->near.x + path->through.x, path->near.y + path->through.y, path->near.z + path->through.z};
    far = clamp_to_domain(emitter->volume, far);
    lights_reaching(voxels, &emitter->feelers, emitter->shading, far, emitter->toward_eye, which, lights->far);
    lights->far_t = which ? path->enters + path->length : lights->far_t;
}

// The shares of lights that reach the point s of a path, 0 to 1.
static inline void lights_along(const LightsAlong *lights, Floats s, Floats *visible)
{
    for (uint n = 0u; n < MAX_LIGHTS; n++)
        visible[n] = lights->near[n] + s * (lights->far[n] - lights->near[n]);
}
#endif

static inline Medium lit_at(VOXELS voxels, const Emitter *emitter, const Piece *piece, Floats u, Medium medium)
{
#if FILTER_LINEAR
    Floats s = piece->from + piece->width * u;
#else
    Floats s = FLOATS(0.5f); // a cell has one gradient; on its faces that of the next might be read
#endif
    Floats3 p = {piece->cell.near.x + s * piece->cell.through.x, piece->cell.near.y + s * piece->cell.through.y, piece->cell.near.z + s * piece->cell.through.z};
#if SHADED && SHADOWS != SHADOWS_NONE
    Floats visible[MAX_LIGHTS];
    lights_along(piece->lights, s, visible);
#else
    const Floats *visible = 0;
#endif
    return lit_at_point(voxels, emitter, clamp_to_domain(emitter->volume, p), medium, visible);
}

static inline Point point_at(VOXELS voxels, const Emitter *emitter, const Piece *piece, Floats u)
{
    Point point;
    point.value = cubic_at(piece->cell.phi, piece->from + piece->width * u);
    point.after = knots_up_to(emitter->transfer, point.value);
    ColorOpacity entry = transfer_between(emitter->transfer, point.after, point.value);
    Medium medium = {light_of(entry.rgb, point.value), absorption_per_mm(emitter->cast, entry.opacity)};
    place_light(&medium.light, piece->t_mm + u * piece->length_mm);
    point.medium = lit_at(voxels, emitter, piece, u, medium);
    return point;
}

// A panel, and the light that it gives by itself.
typedef struct {
    Light light;
    Floats depth, opacity;
} Lit;

// A panel of a piece: from u on, `width` wide; its nodes are points[first], and the two `apart` and twice as far on.
typedef struct {
    uint first, apart;
    Floats u, width;
} PanelPlace;

static inline Lit panel_of(VOXELS voxels, const Emitter *emitter, const Piece *piece, const Point *points, PanelPlace place, Mask which)
{
    const Point *near = &points[place.first];
    const Point *middle = &points[place.first + place.apart];
    const Point *far = &points[place.first + 2u * place.apart];
    Floats length_mm = place.width * piece->length_mm;
    Panel panel = panel_simpson(near->medium, middle->medium, far->medium, length_mm);
    Mask meets_knots = which & near->after != far->after;
    if (ANY(meets_knots)) {
        Medium mean = mean_medium(emitter->transfer, emitter->knot_sums, emitter->cast, near->value, far->value);
        Panel linear = panel_linear(lit_at(voxels, emitter, piece, place.u + 0.5f * place.width, mean), near->value, far->value,
                                    piece->t_mm + place.u * piece->length_mm, length_mm);
        panel.light = light_if(meets_knots, linear.light, panel.light);
        panel.depth = meets_knots ? linear.depth : panel.depth;
    }
    Lit lit;
    lit.depth = panel.depth;
    lit.opacity = alpha_of_depth(panel.depth);
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
    return max_of(x, max_of(y, z)) + fabs(a->opacity - b->opacity);
}

// The error that a panel which meets knots may have although its halves agree: a spike that lies in one of
// them is as deep as the field is slow there, not as it is slow on the whole; and of colours that
// share a panel the nearer hides the farther.
static inline Floats unseen(const Emitter *emitter, const Piece *piece, const Point *near, const Point *far, const Lit *lit, Floats u, Floats width)
{
    Floats a = fabs(cubic_slope(piece->cell.phi, piece->from + piece->width * u));
    Floats b = fabs(cubic_slope(piece->cell.phi, piece->from + piece->width * (u + 0.5f * width)));
    Floats c = fabs(cubic_slope(piece->cell.phi, piece->from + piece->width * (u + width)));
    Floats fastest = max_of(a, max_of(b, c));
    Floats slowest = min_of(a, min_of(b, c));
    Floats uneven = fastest > 0.0f ? (fastest - slowest) / (fastest + slowest) : FLOATS(0.0f);
    Floats hidden = (1.0f - lit->opacity) * lit->depth * uneven
                  + HIDDEN_SHARE * emitter->cast.color_spread * min_of(lit->depth * lit->depth, lit->opacity / HIDDEN_SHARE);
    return near->after == far->after ? FLOATS(0.0f) : hidden;
}

// Adds the light of pieces, in the lanes of `which`. `share_per_mm`: half the bound over the ray's length.
static inline void add_piece(VOXELS voxels, const Emitter *emitter, Accumulated *accumulated, const Piece *piece, Floats share_per_mm, Mask which,
                             Ints *samples)
{
    Floats u = FLOATS(0.0f);
    Floats width = FLOATS(1.0f);
    which = which & accumulated->transmittance >= emitter->cast.min_transmittance;
    if (!ANY(which))
        return;
    Point points[5]; // a quarter of the panel apart
    points[0] = point_at(voxels, emitter, piece, FLOATS(0.0f));
    *samples += which ? INTS(1) : INTS(0);
    for (uint tries = 0u; tries < MAX_TRIES && ANY(which); tries++) {
        // Sums of powers of two, not below the smallest: exact.
        width = min_of(width, 1.0f - u);
        for (uint n = 1u; n < 5u; n++)
            points[n] = point_at(voxels, emitter, piece, u + (0.25f * (float)n) * width);
        *samples += which ? INTS(4) : INTS(0);
        Lit lits[3]; // the panel and its halves
        for (uint n = 0u; n < 3u; n++) {
            PanelPlace place;
            place.first = n == 2u ? 2u : 0u;
            place.apart = n == 0u ? 2u : 1u;
            place.u = n == 2u ? u + 0.5f * width : u;
            place.width = n == 0u ? width : 0.5f * width;
            lits[n] = panel_of(voxels, emitter, piece, points, place, which);
        }
        Lit both = lit_behind(&lits[1], &lits[2]);
        Floats allowed = 0.5f * emitter->cast.bound * accumulated->transmittance * both.opacity
                       + share_per_mm * width * piece->length_mm;
        Floats off = FINER * apart(&lits[0], &both) + unseen(emitter, piece, &points[0], &points[2], &lits[1], u, 0.5f * width)
                   + (1.0f - lits[1].opacity) * unseen(emitter, piece, &points[2], &points[4], &lits[2], u + 0.5f * width, 0.5f * width);
        Mask agree = accumulated->transmittance * off <= allowed & both.depth <= DEEP;
        Mask counts = which & (agree | width <= MIN_WIDTH);
        accumulate_light(accumulated, both.light, both.depth, counts);
        u = counts ? u + width : u;
        width = counts ? 2.0f * width : 0.5f * width;
        points[0].value = counts ? points[4].value : points[0].value;
        points[0].after = counts ? points[4].after : points[0].after;
        points[0].medium = medium_if(counts, points[4].medium, points[0].medium);
        which = which & u < 1.0f & accumulated->transmittance >= emitter->cast.min_transmittance;
    }
}

// Adds the light of cells, in the lanes of `which`: one monotone piece after the other.
static inline void add_cell(VOXELS voxels, const Emitter *emitter, Accumulated *accumulated, CellPath path LIGHTS_PARAMETER, Floats share_per_mm,
                            Mask which, Ints *samples)
{
    Floats ends[4];
    ends[0] = FLOATS(0.0f);
    cubic_turns(path.phi, &ends[1], &ends[2]);
    ends[3] = FLOATS(1.0f);
    Piece piece;
    piece.cell = path;
    which = which & path.length > 0.0f;
#if SHADED && SHADOWS != SHADOWS_NONE
    feel_along(voxels, emitter, &path, lights, which);
    piece.lights = lights;
#endif
    for (uint n = 1u; n < 4u; n++) {
        piece.from = ends[n - 1u];
        piece.width = ends[n] - ends[n - 1u];
        piece.t_mm = path.enters + piece.from * path.length;
        piece.length_mm = piece.width * path.length;
        add_piece(voxels, emitter, accumulated, &piece, share_per_mm, which & piece.width > 0.0f, samples);
    }
}

static inline void emit_along(VOXELS voxels, const Emitter *emitter, Accumulated *accumulated, CellMarch *march, Floats share_per_mm,
                              Ints *samples)
{
    EmissionCast cast = emitter->cast;
    Corners corners = no_corners();
#if SHADED && SHADOWS != SHADOWS_NONE
    LightsAlong lights;
    lights.far_t = FLOATS(-1.0f);
    for (uint n = 0u; n < MAX_LIGHTS; n++)
        lights.near[n] = lights.far[n] = FLOATS(1.0f);
#endif
    while (ANY(march->alive)) {
        for (Mask seeking = cells_seeking(march); ANY(seeking); seeking = cells_seeking(march)) {
            Skip skip = cells_by_class(march, voxels, 0.0f, seeking);
            cells_pass(march, skip, ALL_LANES);
        }
        // From cell to cell, until every ray stands in one where something absorbs.
        Mask reading = cells_standing(march);
        Mask absorbing = NO_LANE;
        while (ANY(reading)) {
            Corners read = cell_corners(voxels, march->volume, &march->walk, 0.0f);
            corners = corners_if(reading, read, corners);
            Medium mean = mean_medium(emitter->transfer, emitter->knot_sums, cast, corners_min(&read), corners_max(&read));
            Mask absorbs = mean.absorption > 0.0f;
            absorbing = absorbing | (reading & absorbs);
            reading = reading & !absorbs;
            CellExit exit = cell_exit(&march->walk, reading);
            reading = cells_advance(march, exit, reading, reading);
        }
        if (ANY(absorbing)) {
            CellExit exit = cell_exit(&march->walk, absorbing);
            CellPath path = cell_path(&march->walk, &corners, exit);
            add_cell(voxels, emitter, accumulated, path LIGHTS_GIVEN, share_per_mm, absorbing, samples);
            cells_advance(march, exit, absorbing, absorbing & accumulated->transmittance >= cast.min_transmittance);
        }
    }
}

kernel void adaptive_emission(VOXELS voxels, SKIP_BY_CLASS, TRANSFER_KNOTS TRANSFER_SUMS, CLIP_PLANES, FEELER_GRIDS EMITTER_DIRECTIONS
                              VolumeGrid volume, RAY_SOURCE, EmissionCast cast, Shading shading, EMISSION_PLANES COUNTER_PLANES)
{
    Pixels pixels = RAY_PIXELS();
    VisibleRays visible = visible_rays(pixels, RAY_OF(pixels), volume, CLIP_GIVEN);
    Accumulated accumulated = accumulate_start();
    Ints samples = INTS(0);
    Ints nodes_tested = INTS(0);
    if (ANY(visible.meets)) {
        CellMarch march = cell_march(volume, skip_by_class(node_class, levels, cells), &visible, cast.traverse, true);
        Emitter emitter = {{knot_values, knot_colors, cast.knots}, TRANSFER_SUMS_GIVEN, cast, volume, &shading,
                           direction_to_eye(visible.ray) EMITTER_FEELERS(TRANSFER_SUMS_GIVEN) EMITTER_DIRECTIONS_GIVEN};
        Floats share_per_mm = 0.5f * cast.bound / max_of(visible.interval.exit - visible.interval.enter, FLOATS(FLT_MIN));
        emit_along(voxels, &emitter, &accumulated, &march, share_per_mm, &samples);
        nodes_tested = march.nodes_tested;
    }
    WRITE_EMISSION(accumulated, cast, visible);
    WRITE_COUNTERS(pixels, samples, nodes_tested);
}
