// Where each square's pixels begin in a list of all: the sums of the counts before it, of pixels that are cast next and
// then of those in blocks.
//
// A single work-item: a picture has few squares. Replaces counts by those sums; writes totals: the pixels that are cast next,
// and all.
#include "lib/abi.clh"

kernel void sum_counts(uint squares, global uint *counts, global uint *totals)
{
    if (get_global_id(0) != 0 || get_global_id(1) != 0)
        return;
    uint sum = 0u;
    for (uint n = 0u; n < 2u * squares; n++) {
        if (n == squares)
            totals[0] = sum;
        uint count = counts[n];
        counts[n] = sum;
        sum += count;
    }
    totals[1] = sum;
}
