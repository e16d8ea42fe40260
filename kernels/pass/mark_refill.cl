// Marks the blocks of a sparse picture that must not be interpolated, because their corners differ; with FLOOD
// also those where a pixel on an edge, cast with a neighbouring block, differs from what would be
// interpolated there. All pixels of such a block, edges included, are cast next.
//
// A work-item tests one block, by lib/ray/differ.clh. Reads color, kind, normal, hit_mm. Writes cast.
#include "lib/abi.clh"
#include "lib/math/lanes.clh"
#include "lib/ray/differ.clh"

#if LANES != 1
#error "a work-item tests one block: LANES is 1"
#endif

#if FLOOD
static inline float mixed(float a, float b, float share) { return a + (b - a) * share; }

// What is interpolated between two pixels of one kind.
static inline Seen between(Seen a, Seen b, float share)
{
    Seen seen = a;
    seen.color.x = mixed(a.color.x, b.color.x, share);
    seen.color.y = mixed(a.color.y, b.color.y, share);
    seen.color.z = mixed(a.color.z, b.color.z, share);
    seen.color.w = mixed(a.color.w, b.color.w, share);
    Floats3 n = {mixed(a.normal.x, b.normal.x, share), mixed(a.normal.y, b.normal.y, share), mixed(a.normal.z, b.normal.z, share)};
    float length = sqrt(dot_of(n, n));
    seen.normal.x = length > 0.0f ? n.x / length : 0.0f;
    seen.normal.y = length > 0.0f ? n.y / length : 0.0f;
    seen.normal.z = length > 0.0f ? n.z / length : 0.0f;
    seen.t = mixed(a.t, b.t, share);
    return seen;
}
#endif

kernel void mark_refill(RayGrid rays, uint spacing, float threshold, float2 footprint, SEEN_PLANES, global uint *cast)
{
    int x = (int)(get_global_id(0) * spacing);
    int y = (int)(get_global_id(1) * spacing);
    int width = (int)rays.width;
    int height = (int)rays.height;
    if (x >= width || y >= height)
        return;
    int x_end = min(x + (int)spacing, width - 1);
    int y_end = min(y + (int)spacing, height - 1);
    Seen corners[4] = {seen_at(y * width + x, SEEN_GIVEN), seen_at(y * width + x_end, SEEN_GIVEN),
                       seen_at(y_end * width + x, SEEN_GIVEN), seen_at(y_end * width + x_end, SEEN_GIVEN)};
    Difference by = {threshold, footprint, (float)spacing};
    bool refills = false;
    for (int a = 0; a < 4; a++)
        for (int b = a + 1; b < 4; b++)
            refills = refills || differ(corners[a], corners[b], by);
#if FLOOD
    // Edge by edge: above, below, left, right.
    for (int edge = 0; edge < 4 && !refills; edge++) {
        bool down = edge >= 2;
        int from = down ? y : x;
        int to = down ? y_end : x_end;
        int fixed_at = edge == 0 ? y : edge == 1 ? y_end : edge == 2 ? x : x_end;
        Seen first = corners[edge == 1 ? 2 : edge == 3 ? 1 : 0];
        Seen last = corners[edge == 0 ? 1 : edge == 2 ? 2 : 3];
        for (int at = from + 1; at < to && !refills; at++) {
            int place = down ? at * width + fixed_at : fixed_at * width + at;
            // Another work-item may mark it meanwhile to be cast next: then it was not cast.
            if (atomic_or(cast + place, 0u) == MARK_CAST) {
                float share = (float)(at - from) / (float)(to - from);
                refills = differ(seen_at(place, SEEN_GIVEN), between(first, last, share), by);
            }
        }
    }
#endif
    if (!refills)
        return;
    // An edge belongs to two blocks, whose work-items mark it alike.
    for (int j = y; j <= y_end; j++)
        for (int i = x; i <= x_end; i++)
            atomic_cmpxchg(cast + j * width + i, MARK_FILLED, MARK_NEXT);
}
