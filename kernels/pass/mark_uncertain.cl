// Marks the pixels of a surface's picture that must be cast: all but those of blocks that are proven to show
// nothing, because the frustum around all their rays meets no cell that the surface may cross and nothing
// inside, and, with SURFACES, all but the corners of those that are proven to show one smooth piece of the surface alone,
// which bilinear interpolation misses by no more than `max_error_mm`. A pixel's rays pass it within `margin` pixels of its
// centre.
//
// Large blocks are tested first; one that is not proven is parted into four, down to blocks of `spacing` pixels. Those of up
// to `widest` may be interpolated. With SEEN, where the smallest are single pixels that have had one ray, those are not tested
// that met something, nor of a surface those beside them: they become MARK_CAST. With an iso value of +inf it is a medium that
// may show: all cells count whose bits are set.
//
// A work-item tests a square of `spacing` << `block_levels` pixels a side. Reads the voxels and per octree node its
// CLASS_*, a bit per cell that the surface may cross, the clip planes (index space), and kind (SEEN_KINDS) or color
// (SEEN_OPACITIES). Writes cast.
#include "lib/ray/block_walk.clh"
#include "lib/skip/smooth_surface.clh"

#if LANES != 8
#error "the rays at a block's corners stand in lanes, two times four: LANES is 8"
#endif

#if SEEN == SEEN_KINDS
#define SEEN_PLANE , const global uint *kind

// Whether a pixel's ray, or one of the four beside it, met something.
static inline bool is_beside_hit(RayGrid rays, int x, int y, const global uint *kind)
{
    int left = max(x - 1, 0);
    int right = min(x + 1, (int)rays.width - 1);
    int above = max(y - 1, 0) * (int)rays.width;
    int below = min(y + 1, (int)rays.height - 1) * (int)rays.width;
    int row = y * (int)rays.width;
    return kind[row + x] != KIND_NOTHING || kind[row + left] != KIND_NOTHING || kind[row + right] != KIND_NOTHING
        || kind[above + x] != KIND_NOTHING || kind[below + x] != KIND_NOTHING;
}
#define IS_SEEN(block) ((block).side == 1 && is_beside_hit(rays, (block).x, (block).y, kind))
#elif SEEN == SEEN_OPACITIES
#define SEEN_PLANE , float opaque_from, const global float4 *color
#define IS_SEEN(block) ((block).side == 1 && color[(block).y * (int)rays.width + (block).x].w >= opaque_from)
#else
#define SEEN_PLANE
#define IS_SEEN(block) false
#endif

// Whether the field is below iso in all slices of a region, within the frustum; of a medium that is not known.
static inline bool is_below(VOXELS voxels, const Packet *packet, PacketRegion region, float iso)
{
    if (!(iso < INFINITY))
        return false;
    float below = nextafter(iso, -INFINITY);
    FieldRange range = {-INFINITY, below};
    for (int slice = region.low; slice < region.high && range.max == below; slice++)
        extend_by_slice(&range, voxels, packet, slice);
    return range.max == below;
}

#define LOOKED_INSIDE 2

// The first slice of cells in which a frustum meets what may lie inside, from `known` on; false: there is none. Blocks of the
// lowest LOOKED_INSIDE levels look into cells too where they pass those that the surface may cross.
static inline bool meets(VOXELS voxels, const SkipGrid *grid, VolumeGrid volume, float iso, Ray corners, int level, Slice known, Slice *met)
{
    Packet packet;
    PacketLines lines;
    *met = known;
    if (!frustum_start(&packet, corners, grid->levels, volume, &lines))
        return true;
    if (is_outside(&packet))
        return false;
    packet_from(&packet, known);
    Ints tested = INTS(0);
    PacketRegion region;
    while (packet_next(&packet, voxels, grid, iso, &region, &tested)) {
        if (region.class == CLASS_BELOW || (level < LOOKED_INSIDE && region.class == CLASS_VISIT && is_below(voxels, &packet, region, iso)))
            continue;
        met->axis = packet.main.index;
        met->at = packet.forward ? region.low : region.high - 1;
        return true;
    }
    return false;
}

#if SURFACES
// Whether interpolation between a block's corners is proven to miss the surface by no more than an error.
static inline bool is_smooth(VOXELS voxels, const SkipGrid *grid, ClipPlanes clip, VolumeGrid volume, RayGrid rays, Block block, float iso,
                             float max_error_mm, Slice met)
{
    return smooth_error_mm(voxels, grid, clip, volume, iso, corner_rays(rays, block, 0.0f), block_spread(rays, block, met.axis), met) <= max_error_mm;
}

// In a square in which so many more blocks failed than were proven, no more are tried.
#define MAX_FAILED 8
#endif

static inline uint start_at(Slice met)
{
    return met.axis < 0 ? START_UNKNOWN : ray_start(met.axis, met.at);
}

kernel void mark_uncertain(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RayGrid rays, uint spacing, uint block_levels, uint widest,
                           float margin, float max_error_mm, float iso SEEN_PLANE, global uint *cast)
{
    SkipGrid grid = skip_by_class(node_class, levels, cells);
    BlockWalk walk = block_walk(spacing, block_levels);
    // Per level, from where on its blocks may meet something, as is known from the one that they are quarters of.
    Slice known[MAX_BLOCK_LEVELS + 1];
    known[walk.level].axis = -1;
#if SURFACES
    int failed = 0;
#endif
    Block block;
    while (block_next(&walk, rays, &block)) {
        Slice met;
        bool seen = IS_SEEN(block);
        bool may_show = seen
                     || meets(voxels, &grid, volume, iso, corner_rays(rays, block, margin), walk.level, known[walk.level], &met);
        bool smooth = false;
#if SURFACES
        if (may_show && block.side <= (int)widest && failed < MAX_FAILED) {
            smooth = is_smooth(voxels, &grid, CLIP_GIVEN, volume, rays, block, iso, max_error_mm, met);
            failed += smooth ? -1 : 1;
        }
#endif
        if (smooth) {
            mark_interpolated(rays, block, (int)widest, met.axis, mark_with_start(MARK_NEXT, start_at(met)), cast);
        } else if (may_show && walk.level > 0) {
            walk.level--;
            known[walk.level] = met;
            continue;
        } else {
            uint mark = seen ? mark_with_start(MARK_CAST, start_at(known[walk.level]))
                      : may_show ? mark_with_start(MARK_NEXT, start_at(met)) : MARK_FILLED;
            mark_block(rays, block, mark, cast);
        }
        block_pass(&walk);
    }
}
