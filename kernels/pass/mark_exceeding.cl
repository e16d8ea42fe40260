// What becomes of the pixels of a projection that have had one ray: MARK_NEXT where the frustum around the pixel may hold
// what exceeds the value that was found by more than `tolerance`, such as a vessel thinner than a pixel; MARK_CAST elsewhere.
// Large blocks are tested first, against the smallest value that was found in them.
//
// A work-item tests a square of `spacing` << `block_levels` pixels a side. Reads the voxels, per octree node its CLASS_* and
// range, kind and value. Writes cast.
#include "lib/ray/block_walk.clh"
#include "lib/skip/frustum_values.clh"

#if LANES != 8
#error "the rays at a block's corners stand in lanes, two times four: LANES is 8"
#endif

// The smallest of what the rays of a block found of sign * Phi, what is below the floor as the floor; +inf where all missed
// the volume.
static inline float lowest_found(RayGrid rays, Block block, ProjectionCast cast, const global uint *kind, const global float *value)
{
    int x_end = min(block.x + block.side, (int)rays.width);
    int y_end = min(block.y + block.side, (int)rays.height);
    float lowest = INFINITY;
    for (int j = block.y; j < y_end; j++)
        for (int i = block.x; i < x_end; i++) {
            int pixel = j * (int)rays.width + i;
            if (kind[pixel] != KIND_NOTHING)
                lowest = fmin(lowest, fmax(cast.sign * value[pixel], cast.floor));
        }
    return lowest;
}

kernel void mark_exceeding(VOXELS voxels, SKIP_BY_RANGE, VolumeGrid volume, RayGrid rays, uint spacing, uint block_levels, float margin,
                           float tolerance, ProjectionCast cast_by, const global uint *kind, const global float *value, global uint *cast)
{
    SkipGrid grid = skip_by_range(node_class, node_range, levels);
    BlockWalk walk = block_walk(spacing, block_levels);
    Block block;
    while (block_next(&walk, rays, &block)) {
        float allowed = lowest_found(rays, block, cast_by, kind, value) + tolerance;
        PacketLines lines;
        Frustum frustum;
        frustum.is_cut = true;
        bool below = allowed == INFINITY;
        if (!below && frustum_start(&frustum.packet, corner_rays(rays, block, margin), levels, volume, &lines))
            below = walk.level > 0 ? values_by_leaves(&frustum, &grid, cast_by).max <= allowed
                                   : stays_below(&frustum, voxels, &grid, cast_by.sign, allowed);
        if (!below && walk.level > 0) {
            walk.level--;
            continue;
        }
        mark_block(rays, block, below ? MARK_CAST : MARK_NEXT, cast);
        block_pass(&walk);
    }
}
