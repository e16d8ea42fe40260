// Marks the pixels of a projection that must be cast: all but those of blocks whose rays all miss the volume, and, but for
// their corners, those of blocks whose values are proven to differ by no more than `max_error`, by what lies in the frustum
// around all their rays. Large blocks are tested first; one that is not proven is parted into four, down to blocks of
// `spacing` pixels. Between the corners of blocks, or of their parts of `widest` pixels, values are interpolated.
//
// A work-item tests a square of `spacing` << `block_levels` pixels a side. Reads the voxels, per octree node its CLASS_* and
// range, and the clip planes (index space). Writes cast.
#include "lib/ray/block_walk.clh"
#include "lib/ray/clip.clh"
#include "lib/skip/frustum_values.clh"

#if LANES != 8
#error "the rays at a block's corners stand in lanes, two times four: LANES is 8"
#endif

// Whether all rays of a block meet the volume, because those at its corners do.
static inline bool all_meet(VolumeGrid volume, ClipPlanes clip, Ray corners)
{
    Interval interval = volume_interval(volume, corners);
    clip_interval(&interval, clip, corners);
    return !ANY(!(interval.enter < interval.exit));
}

// Whether the values of a block's rays differ by no more than `max_error`. `looks_inside` cells too.
static inline bool is_even(VOXELS voxels, const SkipGrid *grid, const Frustum *frustum, ProjectionCast cast, float max_error, bool looks_inside)
{
    FieldRange values = values_by_leaves(frustum, grid, cast);
    if (values.max - values.min <= max_error)
        return true;
#if PROJECTION == PROJECTION_MEAN
    return false;
#else
    return looks_inside && stays_below(frustum, voxels, grid, cast.sign, values.min + max_error);
#endif
}

kernel void mark_varying_values(VOXELS voxels, SKIP_BY_RANGE, CLIP_PLANES, VolumeGrid volume, RayGrid rays, uint spacing, uint block_levels,
                                uint widest, float max_error, ProjectionCast cast_by, global uint *cast)
{
    SkipGrid grid = skip_by_range(node_class, node_range, levels);
    ClipPlanes clip = CLIP_GIVEN;
    BlockWalk walk = block_walk(spacing, block_levels);
    Block block;
    while (block_next(&walk, rays, &block)) {
        Ray corners = corner_rays(rays, block, 0.0f);
        Frustum frustum;
        PacketLines lines;
        bool known = frustum_start(&frustum.packet, corners, levels, volume, &lines);
        if (known && is_outside(&frustum.packet)) {
            mark_block(rays, block, MARK_FILLED, cast);
            block_pass(&walk);
            continue;
        }
        frustum.is_cut = clip.count > 0u || frustum_begins_inside(&frustum.packet, &lines);
        bool even = known && all_meet(volume, clip, corners) && is_even(voxels, &grid, &frustum, cast_by, max_error, walk.level == 0);
        mark_or_part(&walk, rays, block, even, (int)widest, cast);
    }
}
