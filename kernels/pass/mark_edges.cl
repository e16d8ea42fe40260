// Of the pixels that are marked to be cast next, leaves those marked that may show more to many rays than to
// one: those of which one of the four beside them met something else, and those whose mean is estimated to differ
// from what is seen in their centre. With EMPTY_KNOWN, where all pixels that are proven to show nothing are
// unmarked already, those stay marked too that met nothing.
//
// The mean of a smooth picture over a pixel differs from its centre by a 24th of the sum of its two second
// derivatives; their differences are taken for them. The threshold is that of channels, sRGB-encoded, and of opacity.
//
// Reads what one ray a pixel saw. Writes cast and, with COVERAGE, the share of that ray that met something.
#include "lib/ray/pixels.clh"
#include "lib/ray/planes.clh"
#include "lib/light/color.clh"

#if WITH_KIND
#define SEEN_KIND , const global uint *kind
#else
#define SEEN_KIND
#endif
#if COVERAGE
#define COVERAGE_PLANE , global float *coverage
#else
#define COVERAGE_PLANE
#endif

// How much a channel's mean is estimated to differ, encoded.
static inline Floats change_of(Floats center, Floats around)
{
    Floats mean = center + (around - 4.0f * center) * (1.0f / 24.0f);
    return fabs(srgb_from_linear(max_of(mean, FLOATS(0.0f))) - srgb_from_linear(max_of(center, FLOATS(0.0f))));
}

kernel void mark_edges(RayGrid rays, float threshold, float opaque_from, const global float4 *color SEEN_KIND, global uint *cast COVERAGE_PLANE)
{
    Pixels pixels = tile_pixels(rays);
    Mask marked = pixels.inside & read_ints(cast, pixels) == (int)MARK_NEXT;
#if COVERAGE || WITH_KIND
#if WITH_KIND
    Ints here = read_ints(kind, pixels);
    Mask met = here != KIND_NOTHING;
#else
    Mask met = read_float4(color, pixels).w >= opaque_from;
#endif
#endif
#if COVERAGE
    Floats covered = met ? FLOATS(1.0f) : FLOATS(0.0f);
    SCATTER(pixels.inside, coverage, pixels.index, covered);
#endif
    if (!ANY(marked))
        return;
    Floats4 center = read_float4(color, pixels);
    Floats4 around = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
    Mask stays = NO_LANE;
#if EMPTY_KNOWN
    stays = marked & !met;
#endif
    for (int side = 0; side < 4; side++) {
        Ints i = clamp_ints(pixels.i + (side == 0 ? -1 : side == 1 ? 1 : 0), INTS(0), INTS((int)rays.width - 1));
        Ints j = clamp_ints(pixels.j + (side == 2 ? -1 : side == 3 ? 1 : 0), INTS(0), INTS((int)rays.height - 1));
        Ints place = j * (int)rays.width + i;
        Floats4 beside = gather_float4(color, place);
        around.x += beside.x;
        around.y += beside.y;
        around.z += beside.z;
        around.w += beside.w;
#if WITH_KIND
        stays = stays | (marked & GATHER(Ints, kind, place) != here);
#endif
    }
    Floats opacity = fabs(around.w - 4.0f * center.w) * (1.0f / 24.0f);
    Floats change = max_of(max_of(change_of(center.x, around.x), change_of(center.y, around.y)), max_of(change_of(center.z, around.z), opacity));
    stays = stays | (marked & change > threshold);
    Mask unmarked = marked & !stays;
    SCATTER(unmarked, cast, pixels.index, INTS((int)MARK_FILLED));
}
