// How many pixels of each square of LISTED_SQUARE pixels a side are to be cast next, and how many are interpolated in
// blocks that have their corners to themselves.
//
// A work-item counts one square. Reads cast. Writes counts, a number a square, row by row, of the first and then of the
// second.
#include "lib/ray/marks.clh"

kernel void count_marked(RayGrid rays, const global uint *cast, global uint *counts)
{
    uint across = (rays.width + LISTED_SQUARE - 1u) / LISTED_SQUARE;
    uint down = (rays.height + LISTED_SQUARE - 1u) / LISTED_SQUARE;
    uint x = (uint)get_global_id(0) * LISTED_SQUARE;
    uint y = (uint)get_global_id(1) * LISTED_SQUARE;
    if (x >= rays.width || y >= rays.height)
        return;
    uint x_end = min(x + LISTED_SQUARE, rays.width);
    uint y_end = min(y + LISTED_SQUARE, rays.height);
    uint next = 0u;
    uint in_blocks = 0u;
    for (uint j = y; j < y_end; j++)
        for (uint i = x; i < x_end; i++) {
            uint kind = kind_of_mark(cast[j * rays.width + i]);
            next += kind == MARK_NEXT ? 1u : 0u;
            in_blocks += kind == MARK_BLOCK ? 1u : 0u;
        }
    uint square = y / LISTED_SQUARE * across + x / LISTED_SQUARE;
    counts[square] = next;
    counts[across * down + square] = in_blocks;
}
