// Fills the pixels of a sparse picture that were not cast. FILLING_EMPTY: with what a ray leaves that meets nothing.
// FILLING_GRID: bilinearly from the corners of their blocks on a grid. FILLING_BLOCKS: as the first those with MARK_FILLED, as
// the second those whose marks say that they belong to a block of their own (marks.clh).
//
// An interpolated pixel's kind is that of the corner nearest to it; where it met something, its depth, value,
// occlusion, visibility, thickness, span and normal are means of the corners that did. Where there is no kind, what a corner met
// shows in its depth, and what a pixel meets in its opacity. Of its occlusion nothing is proven.
//
// Reads cast; reads and writes color (COLOR) and the layers that there are (KIND, DEPTH, VALUE,
// OCCLUSION, OCCLUSION_BOUND, VISIBILITY, THICK, NORMAL, COUNTERS, CERTIFICATE) and spans.
#include "lib/ray/blocks.clh"
#include "lib/ray/planes.clh"

#if WITH_COLOR
#define COLOR_PLANE , global float4 *color
#else
#define COLOR_PLANE
#endif
#if WITH_KIND
#define KIND_PLANE , global uint *kind
#else
#define KIND_PLANE
#endif
#if WITH_DEPTH
#define DEPTH_PLANE , global float *depth
#else
#define DEPTH_PLANE
#endif
#if WITH_VALUE
#define VALUE_PLANE , global float *value
#else
#define VALUE_PLANE
#endif
#if WITH_OCCLUSION
#define OCCLUSION_PLANE , global float *occlusion
#else
#define OCCLUSION_PLANE
#endif
#if WITH_OCCLUSION_BOUND
#define BOUND_PLANE , global float *occlusion_bound
#else
#define BOUND_PLANE
#endif
#if WITH_VISIBILITY
#define VISIBILITY_PLANE , global float *visibility
#else
#define VISIBILITY_PLANE
#endif
#if WITH_THICK
#define THICK_PLANE , global float *thick
#else
#define THICK_PLANE
#endif
#if WITH_SPANS
#define SPAN_PLANE , global float2 *spans
#else
#define SPAN_PLANE
#endif
#if WITH_NORMAL
#define NORMAL_PLANE , global float4 *normal
#else
#define NORMAL_PLANE
#endif
#if COUNTERS
#define COUNTER_PLANES , global uint *steps, global uint *nodes
#else
#define COUNTER_PLANES
#endif
#if CERTIFICATE
#define CERTIFICATE_PLANE , global uint *certificate
#else
#define CERTIFICATE_PLANE
#endif

kernel void fill_uncast(RayGrid rays, uint spacing, float opaque_from, const global uint *cast COLOR_PLANE KIND_PLANE DEPTH_PLANE
                        VALUE_PLANE OCCLUSION_PLANE BOUND_PLANE VISIBILITY_PLANE THICK_PLANE SPAN_PLANE NORMAL_PLANE COUNTER_PLANES CERTIFICATE_PLANE)
{
    Pixels pixels = tile_pixels(rays);
    Ints mark = read_ints(cast, pixels);
#if FILLING == FILLING_BLOCKS
    Mask shown = is_block_mark(mark);
    pixels.inside = pixels.inside & (shown | mark == (int)MARK_FILLED);
    Ints side = shown ? side_of_mark(mark) : INTS(1);
    int beyond = 0;
#else
    pixels.inside = pixels.inside & mark == (int)MARK_FILLED;
    Mask shown = ALL_LANES;
    Ints side = INTS((int)spacing);
    int beyond = 1;
#endif
    if (!ANY(pixels.inside))
        return;
#if FILLING == FILLING_EMPTY
    Mask meets = NO_LANE;
    Ints nearest = INTS(KIND_NOTHING);
    Floats4 light = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
#else
    BlockCorners corners = block_corners(block_side(pixels.i, side, beyond, rays.width), block_side(pixels.j, side, beyond, rays.height), rays.width);
    Mask meets = shown;
#if WITH_COLOR
    Floats4 light = blend(color, corners.place, corners.weight);
    light.x = shown ? light.x : FLOATS(0.0f);
    light.y = shown ? light.y : FLOATS(0.0f);
    light.z = shown ? light.z : FLOATS(0.0f);
    light.w = shown ? light.w : FLOATS(0.0f);
    meets = light.w >= opaque_from;
#endif
    // The corners that met something, by their weights.
    Floats weight[4];
    Ints nearest = INTS(KIND_NOTHING);
    Floats greatest = FLOATS(-1.0f);
    for (int n = 0; n < 4; n++) {
        Mask met = ALL_LANES;
#if WITH_KIND
        Ints corner = GATHER(Ints, kind, corners.place[n]);
        met = corner != KIND_NOTHING;
        Mask nearer = corners.weight[n] > greatest;
        nearest = nearer ? corner : nearest;
        greatest = nearer ? corners.weight[n] : greatest;
#elif WITH_DEPTH
        met = GATHER(Floats, depth, corners.place[n]) < INFINITY;
#endif
        weight[n] = met ? corners.weight[n] : FLOATS(0.0f);
    }
#if WITH_KIND
    nearest = shown ? nearest : INTS(KIND_NOTHING);
    meets = nearest != KIND_NOTHING;
#endif
#endif
#if WITH_KIND
    SCATTER(pixels.inside, kind, pixels.index, nearest);
#endif
#if WITH_COLOR
    scatter_float4(color, pixels, light);
#endif
#if WITH_DEPTH
    Floats depth_mm = FLOATS(INFINITY);
#if FILLING != FILLING_EMPTY
    depth_mm = meets ? mean_of(depth, corners.place, weight) : depth_mm;
#endif
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
#endif
#if WITH_VALUE
    Floats phi = FLOATS(0.0f);
#if FILLING != FILLING_EMPTY
    phi = meets ? mean_of(value, corners.place, weight) : phi;
#endif
    SCATTER(pixels.inside, value, pixels.index, phi);
#endif
#if WITH_OCCLUSION
    Floats kept = FLOATS(0.0f);
#if FILLING != FILLING_EMPTY
    kept = meets ? mean_of(occlusion, corners.place, weight) : kept;
#endif
    SCATTER(pixels.inside, occlusion, pixels.index, kept);
#endif
#if WITH_OCCLUSION_BOUND
    SCATTER(pixels.inside, occlusion_bound, pixels.index, meets ? FLOATS(1.0f) : FLOATS(0.0f));
#endif
#if WITH_VISIBILITY
    Floats reached = FLOATS(0.0f);
#if FILLING != FILLING_EMPTY
    reached = meets ? mean_of(visibility, corners.place, weight) : reached;
#endif
    SCATTER(pixels.inside, visibility, pixels.index, reached);
#endif
#if WITH_THICK
    Floats mm = FLOATS(0.0f);
#if FILLING != FILLING_EMPTY
    mm = meets ? mean_of(thick, corners.place, weight) : mm;
#endif
    SCATTER(pixels.inside, thick, pixels.index, mm);
#endif
#if WITH_SPANS
    Floats2 span = {FLOATS(0.0f), FLOATS(-1.0f)};
#if FILLING != FILLING_EMPTY
    Floats2 mean_span = mean_of_spans(spans, corners.place, weight);
    span.x = meets ? mean_span.x : span.x;
    span.y = meets ? mean_span.y : span.y;
#endif
    scatter_float2(spans, pixels, span);
#endif
#if WITH_NORMAL
    Floats4 n = {FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f), FLOATS(0.0f)};
#if FILLING != FILLING_EMPTY
    Floats4 mean = blend(normal, corners.place, weight);
    Floats length = sqrt(mean.x * mean.x + mean.y * mean.y + mean.z * mean.z);
    Mask points = meets & length > 0.0f;
    n.x = points ? mean.x / length : n.x;
    n.y = points ? mean.y / length : n.y;
    n.z = points ? mean.z / length : n.z;
#endif
    scatter_float4(normal, pixels, n);
#endif
#if COUNTERS
    SCATTER(pixels.inside, steps, pixels.index, INTS(0));
    SCATTER(pixels.inside, nodes, pixels.index, INTS(0));
#endif
#if CERTIFICATE
    SCATTER(pixels.inside, certificate, pixels.index, INTS(FILLING == FILLING_EMPTY ? CERTIFICATE_MISS : CERTIFICATE_UNDECIDED));
#endif
}
