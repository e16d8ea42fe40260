// Lists the pixels that are marked to be cast next, and marks them as cast: square by square, tile of 4 x 4
// pixels by tile, so that neighbours are followed together and no lane stays empty.
//
// A work-item lists the pixels of one square. Reads where each square begins (sum_counts). Writes listed
// and cast.
#include "lib/abi.clh"

// The pixels along a tile's edge: the largest that a work-item follows.
#define TILE 4u

kernel void list_marked(RayGrid rays, const global uint *begins, global uint *cast, global uint *listed)
{
    uint across = (rays.width + LISTED_SQUARE - 1u) / LISTED_SQUARE;
    uint x = (uint)get_global_id(0) * LISTED_SQUARE;
    uint y = (uint)get_global_id(1) * LISTED_SQUARE;
    if (x >= rays.width || y >= rays.height)
        return;
    uint next = begins[y / LISTED_SQUARE * across + x / LISTED_SQUARE];
    for (uint tile = 0u; tile < LISTED_SQUARE * LISTED_SQUARE; tile += TILE * TILE) {
        uint tile_y = y + tile / (LISTED_SQUARE * TILE) * TILE;
        uint tile_x = x + tile / TILE % LISTED_SQUARE;
        for (uint n = 0u; n < TILE * TILE; n++) {
            uint i = tile_x + n % TILE;
            uint j = tile_y + n / TILE;
            uint pixel = j * rays.width + i;
            if (i < rays.width && j < rays.height && cast[pixel] == MARK_NEXT) {
                cast[pixel] = MARK_CAST;
                listed[next++] = pixel;
            }
        }
    }
}
