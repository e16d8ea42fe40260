// Of the pixels that are marked to be cast next, leaves those marked that may show more to many rays than to
// one: those that differ from one of the eight around them (lib/ray/differ.clh), and with EMPTY_KNOWN, where all
// pixels that are proven to show nothing are unmarked already, those that met nothing.
//
// Reads what one ray a pixel saw. Writes cast and, with COVERAGE, the share of that ray that met something.
#include "lib/ray/pixels.clh"
#include "lib/ray/differ.clh"
#include "lib/ray/planes.clh"

#if COVERAGE
#define COVERAGE_PLANE , global float *coverage
#else
#define COVERAGE_PLANE
#endif

kernel void mark_edges(RayGrid rays, float threshold, float2 footprint, float opaque_from, SEEN_PLANES, global uint *cast COVERAGE_PLANE)
{
    Pixels pixels = tile_pixels(rays);
    Seen here = seen_at(pixels.index, SEEN_GIVEN);
#if WITH_KIND
    Mask met = here.kind != KIND_NOTHING;
#else
    Mask met = here.color.w >= opaque_from;
#endif
#if COVERAGE
    Floats covered = met ? FLOATS(1.0f) : FLOATS(0.0f);
    SCATTER(pixels.inside, coverage, pixels.index, covered);
#endif
    Mask marked = pixels.inside & read_ints(cast, pixels) == (int)MARK_NEXT;
    if (!ANY(marked))
        return;
    Mask stays = NO_LANE;
#if EMPTY_KNOWN
    stays = marked & !met;
#endif
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            if (dx == 0 && dy == 0)
                continue;
            Ints i = clamp_ints(pixels.i + dx, INTS(0), INTS((int)rays.width - 1));
            Ints j = clamp_ints(pixels.j + dy, INTS(0), INTS((int)rays.height - 1));
            Difference by = {threshold, footprint, dx != 0 && dy != 0 ? 1.41421356f : 1.0f};
            stays = stays | (marked & differ(here, seen_at(j * (int)rays.width + i, SEEN_GIVEN), by));
        }
    Mask unmarked = marked & !stays;
    SCATTER(unmarked, cast, pixels.index, INTS((int)MARK_FILLED));
}
