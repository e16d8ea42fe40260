// Where each square's pixels begin in a list of all: the sums of the counts before it.
//
// A single work-item: a picture has few squares. Replaces counts by those sums; writes total, one number.
#include "lib/abi.clh"

kernel void sum_counts(uint squares, global uint *counts, global uint *total)
{
    if (get_global_id(0) != 0 || get_global_id(1) != 0)
        return;
    uint sum = 0u;
    for (uint n = 0u; n < squares; n++) {
        uint count = counts[n];
        counts[n] = sum;
        sum += count;
    }
    *total = sum;
}
