// What a lens sees in each pixel, gathered from the discs of the pixels around (lib/ray/blur.clh).
//
// A disc that reaches a pixel covers a part of the lens as seen from there: that pixel's share of the disc. The lens is filled
// from the front: with the nearest part first, until nothing of it is left; what is farther shows through what is left alone. So
// the discs of one surface, which cover parts beside each other, add up whatever its slope. What is how near is known by
// BINS parts of the range of circles around; in a part what first surfaces hide comes after them. Nothing that lies behind a
// pixel in focus reaches it, and where no nearer disc does it keeps its light to the bit.
//
// taps: places around a pixel, the near before the far: (column, row, distance, pixels that it stands for). Places beyond the
// picture's edge are as the pixels at the edge. By how much a disc of a pixel's own size would miss all of the lens, as the
// taps see it, the lens is made smaller.
//
// Scatter as gather with alpha: Jimenez 2014, Next Generation Post Processing in Call of Duty: Advanced Warfare. Reads reaches of
// blur_reach, and the planes of first surfaces and, with HIDDEN, of what they hide. Writes blurred, in squares that are.
#include "lib/ray/blur.clh"

// Parts of the range of circles.
#define BINS 6

// Circles apart by less are not told apart.
#define MIN_PART_PX 1.0f

// Parts of the lens, quarters about its middle.
#define QUARTERS 4

// The discs around the pixels of a tile.
typedef struct {
    RayGrid rays;
    Pixels pixels;
    int first;   // the first pixel's place in a plane
    bool clear;  // no disc reaches over the picture's edge
    float ends[BINS]; // of the parts
    int bins, near_bins; // parts, and those of them before the focal plane
    Floats circle;    // the pixels' own
    Mask focused;     // the pixels in focus
    float own_reach;  // of the widest
} Tile;

// Places around a pixel.
typedef struct {
    const global float4 *taps;
    uint count;
} Taps;

// What is covered of each quarter of the lens by what lies in each part, and of the lens by what is nearer than the pixel itself.
typedef struct {
    Floats of[QUARTERS][BINS];
    Floats before_own;
} Covered;

// A tap turned by so many quarters about the pixel.
static inline int2 turned(float4 tap, int quarters)
{
    int2 across = (int2)((int)tap.x, (int)tap.y);
    int2 down = (int2)(-across.y, across.x);
    return quarters == 0 ? across : quarters == 1 ? down : quarters == 2 ? -across : -down;
}

// The quarter of the lens that a disc covers from so many quarters around: what lies before the focal plane is seen through
// the other side.
static inline int quarter_of(const Tile *tile, int quarters, int bin)
{
    return bin < tile->near_bins ? (quarters + 2) % QUARTERS : quarters;
}

// Where the numbers of the pixels to which a tap leads lie in a plane: of a tile that is clear its first, row by row, else those of
// each lane.
typedef struct {
    int first;
    Ints places;
} Tapped;

static inline Tapped tapped(const Tile *tile, int2 by)
{
    Tapped there = {tile->first + by.y * (int)tile->rays.width + by.x, INTS(0)};
    if (!tile->clear) {
        Ints i = clamp_ints(tile->pixels.i + by.x, INTS(0), INTS((int)tile->rays.width - 1));
        Ints j = clamp_ints(tile->pixels.j + by.y, INTS(0), INTS((int)tile->rays.height - 1));
        there.places = j * (int)tile->rays.width + i;
    }
    return there;
}

static inline Floats tapped_floats(const Tile *tile, const global float *plane, Tapped there)
{
#if LANES > 1
    if (tile->clear)
        return tile_floats(plane, there.first, (int)tile->rays.width);
    return GATHER(Floats, plane, there.places);
#else
    return plane[tile->clear ? there.first : there.places];
#endif
}

static inline Floats4 tapped_float4(const Tile *tile, const global float4 *plane, Tapped there)
{
#if LANES > 1
    if (tile->clear)
        return tile_float4(plane, there.first, (int)tile->rays.width);
    return gather_float4(plane, there.places);
#else
    return gather_float4(plane, tile->clear ? there.first : there.places);
#endif
}

// Whether all pixels of a tile and those so far around it lie in the picture.
static inline bool is_clear(RayGrid rays, int reach)
{
    int i = (int)(get_global_id(0) * TILE_WIDTH);
    int j = (int)(get_global_id(1) * TILE_HEIGHT);
    return i >= reach && j >= reach && i + (int)TILE_WIDTH + reach <= (int)rays.width && j + (int)TILE_HEIGHT + reach <= (int)rays.height;
}

// The parts of circles between two, none of which lies on both sides of the focal plane.
static inline void part_circles(Tile *tile, float nearest, float farthest)
{
    float before = nearest < 0.0f ? -nearest : 0.0f;
    float behind = farthest > 0.0f ? farthest : 0.0f;
    int near_bins = min((int)ceil(before / MIN_PART_PX), BINS);
    int far_bins = min((int)ceil(behind / MIN_PART_PX), BINS);
    if (near_bins + far_bins > BINS) {
        int shared = (int)((float)BINS * before / (before + behind) + 0.5f);
        near_bins = min(near_bins, max(shared, 1));
        near_bins = far_bins > 0 ? min(near_bins, BINS - 1) : near_bins;
        far_bins = min(far_bins, BINS - near_bins);
    }
    tile->near_bins = near_bins;
    tile->bins = max(near_bins + far_bins, 1);
    for (int bin = 0; bin < tile->bins; bin++) {
        int then = bin + 1 - near_bins;
        tile->ends[bin] = then <= 0 ? before * (float)then / (float)near_bins : behind * (float)then / (float)far_bins;
    }
    tile->ends[tile->bins - 1] = INFINITY;
}

// Adds what the discs of a layer cover.
static inline void add_covered(const Tile *tile, Taps taps, BlurredLayer layer, Covered *covered)
{
    for (uint n = 0u; n < taps.count; n++) {
        float4 tap = taps.taps[n];
        if (tap.z >= layer.reach)
            break;
        for (int quarters = 0; quarters < QUARTERS; quarters++) {
            Tapped there = tapped(tile, turned(tap, quarters));
            Floats circle = tapped_floats(tile, layer.circle, there);
            Floats reaches = disc_reach(circle, tap.z);
            if (!ANY(reaches > 0.0f))
                continue;
            Floats covers = tap.w * reaches * tapped_floats(tile, layer.cover, there);
            Mask nearer = NO_LANE;
            for (int bin = 0; bin < tile->bins; bin++) {
                Mask before = circle < tile->ends[bin];
                covered->of[quarter_of(tile, quarters, bin)][bin] += before & !nearer ? covers : FLOATS(0.0f);
                nearer = before;
            }
            covered->before_own += circle < tile->circle ? covers : FLOATS(0.0f);
        }
    }
}

// What discs of the pixels' own size would cover, as the taps see it; 1 but for the taps' error.
static inline Floats covered_by_own(const Tile *tile, Taps taps)
{
    Floats covered = FLOATS(0.0f);
    for (uint n = 0u; n < taps.count; n++) {
        float4 tap = taps.taps[n];
        if (tap.z >= tile->own_reach)
            break;
        covered += tap.w * disc_reach(tile->circle, tap.z);
    }
    return (float)QUARTERS * covered / disc_area(tile->circle);
}

// Fills what is left of a quarter with what covers it; what of that is seen. What covers nothing is seen where anything is left.
static inline Floats fill(Floats covers, Floats *left)
{
    Floats open = *left > 0.0f ? FLOATS(1.0f) : FLOATS(0.0f);
    if (!ANY(covers > 0.0f))
        return open;
    Floats seen = min_of(covers, *left);
    *left -= seen;
    return covers > 0.0f ? seen / covers : open;
}

// Adds the light of the discs of a layer: of those in each part what is seen, to pixels in focus of those that are nearer `nearer`.
static inline void add_light(const Tile *tile, Taps taps, BlurredLayer layer, const Covered *shares, Floats4 *light)
{
    for (uint n = 0u; n < taps.count; n++) {
        float4 tap = taps.taps[n];
        if (tap.z >= layer.reach)
            break;
        for (int quarters = 0; quarters < QUARTERS; quarters++) {
            Tapped there = tapped(tile, turned(tap, quarters));
            Floats circle = tapped_floats(tile, layer.circle, there);
            Floats reaches = disc_reach(circle, tap.z);
            if (!ANY(reaches > 0.0f))
                continue;
            Floats gives = tap.w * reaches / disc_area(circle);
            int last = tile->bins - 1;
            Floats share = shares->of[quarter_of(tile, quarters, last)][last];
            for (int bin = last - 1; bin >= 0; bin--)
                share = circle < tile->ends[bin] ? shares->of[quarter_of(tile, quarters, bin)][bin] : share;
            Floats share_in_focus = circle < tile->circle ? shares->before_own : FLOATS(0.0f);
            gives *= tile->focused ? share_in_focus : share;
            Floats4 color = tapped_float4(tile, layer.color, there);
            light->x += gives * color.x;
            light->y += gives * color.y;
            light->z += gives * color.z;
            light->w += gives * color.w;
        }
    }
}

static inline Covered nothing_covered(void)
{
    Covered covered;
    for (int quarter = 0; quarter < QUARTERS; quarter++)
        for (int bin = 0; bin < BINS; bin++)
            covered.of[quarter][bin] = FLOATS(0.0f);
    covered.before_own = FLOATS(0.0f);
    return covered;
}

// What the lens sees in the pixels of a tile that discs reach.
static inline Floats4 seen_by_lens(const Tile *tile, Taps taps, BlurredLayer seen, BlurredLayer hidden, Floats4 own)
{
    Covered by_seen = nothing_covered();
    Covered by_hidden = nothing_covered();
    add_covered(tile, taps, seen, &by_seen);
    add_covered(tile, taps, hidden, &by_hidden);
    if (!ANY(!tile->focused | by_seen.before_own + by_hidden.before_own > 0.0f))
        return own;
    Floats whole = covered_by_own(tile, taps);
    Floats nearer = by_seen.before_own + by_hidden.before_own;
    Mask shows_hidden = tile->focused & by_hidden.before_own > 0.0f;
    for (int quarter = 0; quarter < QUARTERS; quarter++) {
        Floats left = whole / (float)QUARTERS;
        for (int bin = 0; bin < tile->bins; bin++) {
            Mask covers = by_hidden.of[quarter][bin] > 0.0f;
            by_seen.of[quarter][bin] = fill(by_seen.of[quarter][bin], &left);
            by_hidden.of[quarter][bin] = fill(by_hidden.of[quarter][bin], &left);
            shows_hidden = shows_hidden | (!tile->focused & covers & by_hidden.of[quarter][bin] > 0.0f);
        }
    }
    by_seen.before_own = by_hidden.before_own = nearer > 1.0f ? 1.0f / nearer : FLOATS(1.0f);
    Floats4 light = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    add_light(tile, taps, seen, &by_seen, &light);
    if (ANY(shows_hidden))
        add_light(tile, taps, hidden, &by_hidden, &light);
    Floats uncovered = 1.0f - min_of(nearer, FLOATS(1.0f));
    Floats scale = tile->focused ? FLOATS(1.0f) : 1.0f / whole;
    Floats through = tile->focused ? uncovered : FLOATS(0.0f);
    Mask kept = tile->focused & nearer == 0.0f;
    light.x = kept ? own.x : light.x * scale + through * own.x;
    light.y = kept ? own.y : light.y * scale + through * own.y;
    light.z = kept ? own.z : light.z * scale + through * own.z;
    // Sums of shares that make up all of the lens round to more.
    light.w = kept ? own.w : min_of(light.w * scale + through * own.w, FLOATS(1.0f));
    return light;
}

#if HIDDEN
#define HIDDEN_PLANES \
    , const global float4 *reaches_behind, const global float *circle_behind, const global float *cover_behind, const global float4 *color_behind
#else
#define HIDDEN_PLANES
#endif

kernel void gather_blur(RayGrid rays, const global float4 *taps, uint tap_count, const global float4 *reaches, const global float *circle,
                        const global float *cover, const global float4 *color HIDDEN_PLANES, global float4 *blurred)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    uint square = square_of(pixels, squares_in_row(rays));
    BlurredSquare around = blurred_square(reaches[square]);
    BlurredLayer seen = {circle, cover, color, around.reach + 0.5f};
    BlurredLayer hidden = {circle, cover, color, 0.0f};
#if HIDDEN
    BlurredSquare behind = blurred_square(reaches_behind[square]);
    if (behind.nearest <= behind.farthest) {
        BlurredLayer layer = {circle_behind, cover_behind, color_behind, behind.reach + 0.5f};
        hidden = layer;
        around.reach = max(around.reach, behind.reach);
        around.nearest = min(around.nearest, behind.nearest);
        around.farthest = max(around.farthest, behind.farthest);
    }
#endif
    if (!is_blurred(around))
        return;
    Tile tile;
    tile.rays = rays;
    tile.pixels = pixels;
    part_circles(&tile, around.nearest, around.farthest);
    tile.first = FIRST_LANE(pixels.index);
    tile.clear = is_clear(rays, (int)(around.reach + 0.5f));
    tile.circle = read_floats(circle, pixels);
    tile.own_reach = 0.5f * MAX_LANE(fabs(tile.circle)) + 0.5f;
    tile.focused = read_floats(cover, pixels) > 0.0f & is_focused(tile.circle);
    Taps from = {taps, tap_count};
    Floats4 own = read_float4(color, pixels);
    scatter_float4(blurred, pixels, seen_by_lens(&tile, from, seen, hidden, own));
}
