// Marks the pixels of a medium's picture that must be cast: all but the corners of blocks whose light and opacity are proven
// to differ by no more than `max_error` in any channel, by what lies in the frustum around all their rays. Large blocks are
// tested first; one that is not proven is parted into four, down to blocks of `spacing` pixels. Between the corners of
// blocks, or of their parts of `widest` pixels, colours are interpolated.
//
// From the back to the front, each layer of leaves lets through a share of what is behind it and adds light of its own: what
// leaves it is a mean of the two, weighted with its opacity. Of both, and of the opacity, the smallest and the greatest are
// known: by the leaves' absorption and colours, and by how far rays go in them.
//
// A work-item tests a square of `spacing` << `block_levels` pixels a side. Reads per octree node its CLASS_*, per leaf the
// bounds of its light (`leaf_light`: first the smallest, then the greatest red, green, blue, linear light, and absorption of
// the unit length), and the clip planes. Writes cast.
#include "lib/ray/block_walk.clh"
#include "lib/ray/clip.clh"
#include "lib/skip/packet.clh"

#if LANES != 8
#error "the rays at a block's corners stand in lanes, two times four: LANES is 8"
#endif

// Red, green, blue, premultiplied linear light, and opacity: the smallest and the greatest.
typedef struct {
    float4 low, high;
} LightRange;

// The bounds of all leaves that a frustum touches in a layer.
static inline LightRange layer_light(const Packet *packet, const global float4 *leaf_light, int layer)
{
    Ints tested = INTS(0);
    LayerLeaves leaves = layer_leaves(packet, layer, &tested);
    LightRange light = {(float4)(INFINITY), (float4)(-INFINITY)};
    uint first = leaves.first;
    for (uint v = 0u; v < leaves.across_v; v++) {
        uint leaf = first;
        for (uint u = 0u; u < leaves.across_u; u++) {
            float4 low = leaf_light[2u * leaf];
            float4 high = leaf_light[2u * leaf + 1u];
            // What absorbs nothing shows no colour.
            bool shows = high.w > 0.0f;
            light.low = shows ? fmin(light.low, low) : (float4)(light.low.xyz, 0.0f);
            light.high = shows ? fmax(light.high, high) : light.high;
            leaf += packet->u.leaf;
        }
        first += packet->v.leaf;
    }
    return light;
}

static inline float4 mixed(float4 behind, float4 light, float opacity) { return behind + (light - behind) * opacity; }

// What a layer makes of the light from behind it: `of` its colours, with 1 for what opacity grows towards, of opacities from
// the first to the second.
static inline void pass_layer(LightRange *range, LightRange of, float2 opacity)
{
    of.low.w = of.high.w = 1.0f;
    range->low = fmin(mixed(range->low, of.low, opacity.x), mixed(range->low, of.low, opacity.y));
    range->high = fmax(mixed(range->high, of.high, opacity.x), mixed(range->high, of.high, opacity.y));
}

// What shading makes of a colour: it times `least` at least, and it times `most` plus `added` at most.
typedef struct {
    float4 least, most, added;
} Reflects;

static inline LightRange reflected(LightRange light, Reflects reflects)
{
    light.low.xyz *= reflects.least.xyz;
    light.high.xyz = light.high.xyz * reflects.most.xyz + reflects.added.xyz;
    return light;
}

// The light of all rays of a frustum; `per_slice`: how far they go in a slice of cells, the shortest and the longest, in unit
// lengths.
static inline LightRange frustum_light(Packet packet, const SkipGrid *grid, const global float4 *leaf_light, float2 per_slice, Reflects reflects,
                                       bool is_cut)
{
    LightRange range = {(float4)(0.0f), (float4)(0.0f)};
    Ints tested = INTS(0);
    packet_turn(&packet);
    while (packet_has_slices(&packet)) {
        int layer = packet.slice / (int)LEAF;
        int layers;
        uint class = layer_class(&packet, grid, layer, &layers, &tested);
        if (class != CLASS_BELOW) {
            layers = 1;
            LightRange light = layer_light(&packet, leaf_light, layer);
            int from = layer * (int)LEAF;
            int to = min(from + (int)LEAF, packet.main_cells);
            bool whole = !is_cut && is_inside(&packet, from, to);
            float2 length = (float)(to - from) * per_slice;
            float2 depth = (float2)(whole ? length.x * light.low.w : 0.0f, length.y * light.high.w);
            if (depth.y > 0.0f)
                pass_layer(&range, reflected(light, reflects), 1.0f - exp(-depth));
        }
        packet.slice = layers_end(&packet, layer, layers);
    }
    return range;
}

static inline float mean_of_corners(Floats v) { return 0.25f * (v.s0 + v.s1 + v.s2 + v.s3); }

// How far rays go in a slice of cells, mm, at least and at most; `speed` is the corners' along the main axis. What they go is
// a vector that lies between the corners' for all rays between them: no longer than the longest, and no shorter than the
// shortest as seen along one direction.
static inline float2 mm_per_slice(Ray corners, Floats speed)
{
    Floats3 w = corners.dir_world;
    float3 along = normalize((float3)(mean_of_corners(w.x), mean_of_corners(w.y), mean_of_corners(w.z)));
    Floats mm = 1.0f / fabs(speed);
    Floats seen = (w.x * along.x + w.y * along.y + w.z * along.z) * mm;
    return (float2)(fmax(MIN_LANE(seen), 0.0f), MAX_LANE(mm));
}

kernel void mark_varying_light(SKIP_BY_CLASS, const global float4 *leaf_light, CLIP_PLANES, VolumeGrid volume, RayGrid rays, uint spacing, uint block_levels,
                               uint widest, float max_error, float unit_length_mm, float4 reflects_least, float4 reflects_most, float4 reflects_added,
                               global uint *cast)
{
    SkipGrid grid = skip_by_class(node_class, levels, cells);
    ClipPlanes clip = CLIP_GIVEN;
    Reflects reflects = {reflects_least, reflects_most, reflects_added};
    BlockWalk walk = block_walk(spacing, block_levels);
    Block block;
    while (block_next(&walk, rays, &block)) {
        Packet packet;
        PacketLines lines;
        bool even = false;
        Ray corners = corner_rays(rays, block, 0.0f);
        if (frustum_start(&packet, corners, levels, volume, &lines)) {
            if (is_outside(&packet)) {
                mark_block(rays, block, MARK_FILLED, cast);
                block_pass(&walk);
                continue;
            }
            float2 per_slice = mm_per_slice(corners, lines.main.dir) / unit_length_mm;
            bool is_cut = clip.count > 0u || frustum_begins_inside(&packet, &lines);
            LightRange light = frustum_light(packet, &grid, leaf_light, per_slice, reflects, is_cut);
            float4 differ = light.high - light.low;
            even = fmax(fmax(differ.x, differ.y), fmax(differ.z, differ.w)) <= max_error;
        }
        mark_or_part(&walk, rays, block, even, (int)widest, cast);
    }
}
