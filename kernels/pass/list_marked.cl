// Lists the pixels that are cast next, and after them those that are interpolated in blocks that have their corners to
// themselves: square by square, tile of 4 x 4 pixels by tile, so that neighbours are followed together and no lane stays
// empty. Marks the first as cast.
//
// A work-item lists the pixels of one square. Reads where each square begins (sum_counts), of the first and then of the
// second. Writes listed, pixels and where their rays may meet something first, and cast.
#include "lib/ray/marks.clh"

// The pixels along a tile's edge: the largest that a work-item follows.
#define TILE 4u

kernel void list_marked(RayGrid rays, const global uint *begins, global uint *cast, global uint2 *listed)
{
    uint across = (rays.width + LISTED_SQUARE - 1u) / LISTED_SQUARE;
    uint down = (rays.height + LISTED_SQUARE - 1u) / LISTED_SQUARE;
    uint x = (uint)get_global_id(0) * LISTED_SQUARE;
    uint y = (uint)get_global_id(1) * LISTED_SQUARE;
    if (x >= rays.width || y >= rays.height)
        return;
    uint square = y / LISTED_SQUARE * across + x / LISTED_SQUARE;
    uint next = begins[square];
    uint next_in_block = begins[across * down + square];
    for (uint tile = 0u; tile < LISTED_SQUARE * LISTED_SQUARE; tile += TILE * TILE) {
        uint tile_y = y + tile / (LISTED_SQUARE * TILE) * TILE;
        uint tile_x = x + tile / TILE % LISTED_SQUARE;
        for (uint n = 0u; n < TILE * TILE; n++) {
            uint i = tile_x + n % TILE;
            uint j = tile_y + n / TILE;
            if (i >= rays.width || j >= rays.height)
                continue;
            uint pixel = j * rays.width + i;
            uint mark = cast[pixel];
            if (kind_of_mark(mark) == MARK_NEXT) {
                cast[pixel] = MARK_CAST;
                listed[next++] = (uint2)(pixel, start_of_mark(mark));
            } else if (kind_of_mark(mark) == MARK_BLOCK) {
                listed[next_in_block++] = (uint2)(pixel, START_UNKNOWN);
            }
        }
    }
}
