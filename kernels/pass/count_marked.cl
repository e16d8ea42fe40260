// How many pixels of each square of LISTED_SQUARE pixels a side are marked to be cast next.
//
// A work-item counts one square. Reads cast. Writes counts, a number a square, row by row.
#include "lib/abi.clh"

kernel void count_marked(RayGrid rays, const global uint *cast, global uint *counts)
{
    uint across = (rays.width + LISTED_SQUARE - 1u) / LISTED_SQUARE;
    uint x = (uint)get_global_id(0) * LISTED_SQUARE;
    uint y = (uint)get_global_id(1) * LISTED_SQUARE;
    if (x >= rays.width || y >= rays.height)
        return;
    uint x_end = min(x + LISTED_SQUARE, rays.width);
    uint y_end = min(y + LISTED_SQUARE, rays.height);
    uint count = 0u;
    for (uint j = y; j < y_end; j++)
        for (uint i = x; i < x_end; i++)
            count += cast[j * rays.width + i] == MARK_NEXT ? 1u : 0u;
    counts[y / LISTED_SQUARE * across + x / LISTED_SQUARE] = count;
}
