// Marks the pixels of a surface's picture that must be cast: all but those of blocks that are proven to show
// nothing, because the frustum around all their rays meets no cell that the surface may cross and nothing
// inside. A pixel's rays pass it within `margin` pixels of its centre. Large blocks are tested first; one that is
// not proven is parted into four, down to blocks of `spacing` pixels.
//
// A work-item tests a square of `spacing` << `block_levels` pixels a side. Reads the voxels and per octree node its
// CLASS_*, and a bit per cell that the surface may cross. Writes cast.
#include "lib/ray/camera.clh"
#include "lib/skip/packet.clh"

#if LANES != 8
#error "the rays at a block's corners stand in lanes, two times four: LANES is 8"
#endif

// The outermost rays of a block.
static inline Ray corner_rays(RayGrid rays, int x, int y, int side, float margin)
{
    float left = (float)x - margin;
    float above = (float)y - margin;
    float right = (float)(min(x + side, (int)rays.width) - 1) + margin;
    float below = (float)(min(y + side, (int)rays.height) - 1) + margin;
    return camera_ray_at(rays, (Floats)(left, right, left, right, left, right, left, right),
                         (Floats)(above, above, below, below, above, above, below, below));
}

static inline bool is_empty(VOXELS voxels, SkipGrid grid, VolumeGrid volume, float iso, Ray corners)
{
    Packet packet;
    if (!frustum_start(&packet, corners, grid.levels, volume))
        return false;
    Ints tested = INTS(0);
    PacketRegion region;
    while (packet_next(&packet, voxels, &grid, iso, &region, &tested))
        if (region.class != CLASS_BELOW)
            return false;
    return true;
}

static inline void mark_block(RayGrid rays, int x, int y, int side, uint mark, global uint *cast)
{
    int x_end = min(x + side, (int)rays.width);
    int y_end = min(y + side, (int)rays.height);
    for (int j = y; j < y_end; j++)
        for (int i = x; i < x_end; i++)
            cast[j * (int)rays.width + i] = mark;
}

// Every second bit of a number.
static inline int every_second_bit(int n)
{
    int bits = 0;
    for (int bit = 0; bit < 8; bit++)
        bits |= (n >> (2 * bit) & 1) << bit;
    return bits;
}

kernel void mark_uncertain(VOXELS voxels, SKIP_BY_CLASS, VolumeGrid volume, RayGrid rays, uint spacing, uint block_levels, float margin, float iso,
                           global uint *cast)
{
    int square_side = (int)(spacing << block_levels);
    int x = (int)get_global_id(0) * square_side;
    int y = (int)get_global_id(1) * square_side;
    if (x >= (int)rays.width || y >= (int)rays.height)
        return;
    SkipGrid grid = skip_by_class(node_class, levels, cells);
    // The smallest blocks in Morton order: a block of level n begins where 2n bits of its number are 0. After
    // one that is not proven come its quarters, after one that is proven the next that begins there.
    int last = 1 << (2 * (int)block_levels);
    int level = (int)block_levels;
    for (int n = 0; n < last;) {
        int block_x = x + every_second_bit(n) * (int)spacing;
        int block_y = y + every_second_bit(n >> 1) * (int)spacing;
        int side = (int)spacing << level;
        bool inside = block_x < (int)rays.width && block_y < (int)rays.height;
        bool proven = !inside || is_empty(voxels, grid, volume, iso, corner_rays(rays, block_x, block_y, side, margin));
        if (!proven && level > 0) {
            level--;
            continue;
        }
        if (inside)
            mark_block(rays, block_x, block_y, side, proven ? MARK_FILLED : MARK_NEXT, cast);
        n += 1 << (2 * level);
        while (level < (int)block_levels && (n & ((4 << (2 * level)) - 1)) == 0)
            level++;
    }
}
