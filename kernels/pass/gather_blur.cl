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

// The discs around the pixels of a tile.
typedef struct {
    RayGrid rays;
    Pixels pixels;
    bool clear; // no disc reaches over the picture's edge
    float reach, nearest, width; // of the parts
    Floats circle;    // the pixels' own
    Mask focused;     // the pixels in focus
} Tile;

// Places around a pixel.
typedef struct {
    const global float4 *taps;
    uint count;
} Taps;

// What is covered of the lens by what is nearer than the ends of the parts, and by what is nearer than the pixel itself.
typedef struct {
    Floats before[BINS];
    Floats before_own;
} Covered;

// The pixels to which a tap leads from those of a tile.
static inline Pixels tapped(const Tile *tile, float4 tap)
{
    Pixels pixels = tile->pixels;
    int dx = (int)tap.x;
    int dy = (int)tap.y;
    if (tile->clear) {
        pixels.index += dy * (int)tile->rays.width + dx;
        return pixels;
    }
    Ints i = clamp_ints(pixels.i + dx, INTS(0), INTS((int)tile->rays.width - 1));
    Ints j = clamp_ints(pixels.j + dy, INTS(0), INTS((int)tile->rays.height - 1));
    pixels.index = j * (int)tile->rays.width + i;
    pixels.in_rows = false;
    return pixels;
}

// Whether all pixels of a tile and those so far around it lie in the picture.
static inline bool is_clear(RayGrid rays, int reach)
{
    int i = (int)(get_global_id(0) * TILE_WIDTH);
    int j = (int)(get_global_id(1) * TILE_HEIGHT);
    return i >= reach && j >= reach && i + (int)TILE_WIDTH + reach <= (int)rays.width && j + (int)TILE_HEIGHT + reach <= (int)rays.height;
}

static inline float part_end(const Tile *tile, int part)
{
    return tile->nearest + (float)(part + 1) * tile->width;
}

// Adds what the discs of a layer cover.
static inline void add_covered(const Tile *tile, Taps taps, BlurredLayer layer, Covered *covered)
{
    for (uint n = 0u; n < taps.count; n++) {
        float4 tap = taps.taps[n];
        if (tap.z >= tile->reach + 0.5f)
            break;
        Pixels there = tapped(tile, tap);
        Floats circle = read_floats(layer.circle, there);
        Floats covers = tap.w * disc_reach(circle, tap.z) * read_floats(layer.cover, there);
        for (int part = 0; part < BINS - 1; part++)
            covered->before[part] += circle < part_end(tile, part) ? covers : FLOATS(0.0f);
        covered->before[BINS - 1] += covers;
        covered->before_own += circle < tile->circle ? covers : FLOATS(0.0f);
    }
}

// What discs of the pixels' own size would cover, as the taps see it; 1 but for the taps' error.
static inline Floats covered_by_own(const Tile *tile, Taps taps)
{
    Floats covered = FLOATS(0.0f);
    for (uint n = 0u; n < taps.count; n++) {
        float4 tap = taps.taps[n];
        if (tap.z >= tile->reach + 0.5f)
            break;
        covered += tap.w * disc_reach(tile->circle, tap.z);
    }
    return covered / disc_area(tile->circle);
}

// The share of what is covered up to `to`, in order, from `from` on, that fits into `whole`.
static inline Floats share_within(Floats from, Floats to, Floats whole)
{
    Floats covered = to - from;
    Floats within = min_of(to, whole) - min_of(from, whole);
    return covered > 0.0f ? min_of(within / covered, FLOATS(1.0f)) : FLOATS(0.0f);
}

// Adds the light of the discs of a layer: of those in each part its share, to pixels in focus of those that are nearer `nearer`.
static inline void add_light(const Tile *tile, Taps taps, BlurredLayer layer, const Floats *shares, Floats nearer, Floats4 *light)
{
    for (uint n = 0u; n < taps.count; n++) {
        float4 tap = taps.taps[n];
        if (tap.z >= tile->reach + 0.5f)
            break;
        Pixels there = tapped(tile, tap);
        Floats circle = read_floats(layer.circle, there);
        Floats gives = tap.w * disc_reach(circle, tap.z) / disc_area(circle);
        if (!ANY(gives > 0.0f))
            continue;
        Floats share = shares[BINS - 1];
        for (int part = BINS - 2; part >= 0; part--)
            share = circle < part_end(tile, part) ? shares[part] : share;
        Floats share_in_focus = circle < tile->circle ? nearer : FLOATS(0.0f);
        gives *= tile->focused ? share_in_focus : share;
        Floats4 color = read_float4(layer.color, there);
        light->x += gives * color.x;
        light->y += gives * color.y;
        light->z += gives * color.z;
        light->w += gives * color.w;
    }
}

static inline Covered nothing_covered(void)
{
    Covered covered;
    for (int part = 0; part < BINS; part++)
        covered.before[part] = FLOATS(0.0f);
    covered.before_own = FLOATS(0.0f);
    return covered;
}

// What the lens sees in the pixels of a tile that discs reach.
static inline Floats4 seen_by_lens(const Tile *tile, Taps taps, BlurredLayer seen, BlurredLayer hidden, Floats4 own)
{
    Covered by_seen = nothing_covered();
    Covered by_hidden = nothing_covered();
    add_covered(tile, taps, seen, &by_seen);
#if HIDDEN
    add_covered(tile, taps, hidden, &by_hidden);
#endif
    Floats whole = covered_by_own(tile, taps);
    Floats nearer = by_seen.before_own + by_hidden.before_own;
    Floats share_nearer = nearer > 1.0f ? 1.0f / nearer : FLOATS(1.0f);
    Floats of_seen[BINS], of_hidden[BINS];
    Floats before = FLOATS(0.0f);
    for (int part = 0; part < BINS; part++) {
        Floats then_seen = by_seen.before[part] + (part > 0 ? by_hidden.before[part - 1] : FLOATS(0.0f));
        Floats then_hidden = by_seen.before[part] + by_hidden.before[part];
        of_seen[part] = share_within(before, then_seen, whole);
        of_hidden[part] = share_within(then_seen, then_hidden, whole);
        before = then_hidden;
    }
    Floats4 light = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    add_light(tile, taps, seen, of_seen, share_nearer, &light);
#if HIDDEN
    add_light(tile, taps, hidden, of_hidden, share_nearer, &light);
#endif
    Floats uncovered = 1.0f - min_of(nearer, FLOATS(1.0f));
    Floats scale = tile->focused ? FLOATS(1.0f) : 1.0f / whole;
    Floats through = tile->focused ? uncovered : FLOATS(0.0f);
    Mask kept = tile->focused & nearer == 0.0f;
    light.x = kept ? own.x : light.x * scale + through * own.x;
    light.y = kept ? own.y : light.y * scale + through * own.y;
    light.z = kept ? own.z : light.z * scale + through * own.z;
    light.w = kept ? own.w : light.w * scale + through * own.w;
    return light;
}

#if HIDDEN
#define HIDDEN_PLANES , const global float *circle_behind, const global float *cover_behind, const global float4 *color_behind
#else
#define HIDDEN_PLANES
#endif

kernel void gather_blur(RayGrid rays, const global float4 *taps, uint tap_count, const global float4 *reaches, const global float *circle,
                        const global float *cover, const global float4 *color HIDDEN_PLANES, global float4 *blurred)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    BlurredSquare around = blurred_square(reaches[square_of(pixels, squares_in_row(rays))]);
    if (!is_blurred(around))
        return;
    Floats4 own = read_float4(color, pixels);
    Tile tile;
    tile.rays = rays;
    tile.pixels = pixels;
    tile.reach = around.reach;
    tile.nearest = around.nearest;
    tile.width = (around.farthest - around.nearest) / (float)BINS;
    tile.clear = is_clear(rays, (int)(around.reach + 0.5f));
    tile.circle = read_floats(circle, pixels);
    Mask is_seen = read_floats(cover, pixels) > 0.0f;
    tile.focused = is_seen & is_focused(tile.circle);
    Taps from = {taps, tap_count};
    BlurredLayer seen = {circle, cover, color};
#if HIDDEN
    BlurredLayer hidden = {circle_behind, cover_behind, color_behind};
#else
    BlurredLayer hidden = seen;
#endif
    scatter_float4(blurred, pixels, seen_by_lens(&tile, from, seen, hidden, own));
}
