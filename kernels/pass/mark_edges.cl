// Of the pixels that are marked as cast, marks those to be cast next that may show more to many rays than to one: those of
// which one of the four beside them met something else, or, with WITH_HITS, something much nearer or farther; and those whose
// mean is estimated to differ from what is seen in their centre. The others become MARK_FILLED.
//
// The mean of a smooth picture over a pixel differs from its centre by a 24th of the sum of its two second
// derivatives; differences of neighbours are taken for them, and of the two the greater counts. The threshold is that of
// channels, sRGB-encoded, and of opacity.
//
// Reads what one ray a pixel saw. Writes cast and, with COVERAGE, the share of that ray that met something.
#include "lib/ray/marks.clh"
#include "lib/ray/planes.clh"
#include "lib/light/color.clh"

#if WITH_KIND
#define SEEN_KIND , const global uint *kind
#else
#define SEEN_KIND
#endif
#if WITH_HITS
#define SEEN_HITS , float2 footprint, const global float *hit_mm
#else
#define SEEN_HITS
#endif
#if COVERAGE
#define COVERAGE_PLANE , global float *coverage
#else
#define COVERAGE_PLANE
#endif

// A hit is much nearer or farther than that of a ray beside it where a surface between them would rise so steeply: by how
// many of the rays' distances.
#define STEEP 6.0f

// How much a channel's mean is estimated to differ, encoded, by the two pixels beside it along one axis.
static inline Floats change_of(Floats center, Floats beside)
{
    Floats mean = center + (beside - 2.0f * center) * (1.0f / 24.0f);
    return fabs(srgb_from_linear(max_of(mean, FLOATS(0.0f))) - srgb_from_linear(max_of(center, FLOATS(0.0f))));
}

// The same of all channels and of opacity: the greatest.
static inline Floats change(Floats4 center, Floats4 beside)
{
    Floats opacity = fabs(beside.w - 2.0f * center.w) * (1.0f / 24.0f);
    return max_of(max_of(change_of(center.x, beside.x), change_of(center.y, beside.y)), max_of(change_of(center.z, beside.z), opacity));
}

kernel void mark_edges(RayGrid rays, float threshold, float opaque_from, const global float4 *color SEEN_KIND SEEN_HITS,
                       global uint *cast COVERAGE_PLANE)
{
    Pixels pixels = tile_pixels(rays);
    if (!ANY(pixels.inside))
        return;
    Ints before = read_ints(cast, pixels);
    Mask marked = pixels.inside & is_cast_mark(before);
#if WITH_KIND
    Ints here = read_ints(kind, pixels);
#endif
#if COVERAGE
#if WITH_KIND
    Mask met = here != KIND_NOTHING;
#else
    Mask met = read_float4(color, pixels).w >= opaque_from;
#endif
    Floats covered = met ? FLOATS(1.0f) : FLOATS(0.0f);
    SCATTER(pixels.inside, coverage, pixels.index, covered);
#endif
    if (!ANY(marked))
        return;
    Floats4 center = read_float4(color, pixels);
#if WITH_HITS
    Floats t = read_floats(hit_mm, pixels);
#endif
    Mask differs = NO_LANE;
    for (int axis = 0; axis < 2; axis++) {
        Floats4 beside = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
        for (int side = -1; side <= 1; side += 2) {
            Ints i = clamp_ints(pixels.i + (axis == 0 ? side : 0), INTS(0), INTS((int)rays.width - 1));
            Ints j = clamp_ints(pixels.j + (axis == 1 ? side : 0), INTS(0), INTS((int)rays.height - 1));
            Ints place = j * (int)rays.width + i;
            Floats4 one = gather_float4(color, place);
            beside.x += one.x;
            beside.y += one.y;
            beside.z += one.z;
            beside.w += one.w;
#if WITH_KIND
            differs = differs | GATHER(Ints, kind, place) != here;
#endif
#if WITH_HITS
            Floats there = GATHER(Floats, hit_mm, place);
            // Where either met nothing, the kinds differ.
            differs = differs | fabs(there - t) > STEEP * (footprint.x + footprint.y * min_of(there, t));
#endif
        }
        differs = differs | change(center, beside) > threshold;
    }
    Ints mark = differs ? next_after_cast(before) : INTS((int)MARK_FILLED);
    SCATTER(marked, cast, pixels.index, mark);
}
