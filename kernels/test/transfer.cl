// The transfer function at each value.
#include "old/transfer.clh"

kernel void transfer(uint count, uint knots, const global float *knot_values, const global float4 *knot_colors,
                     const global float *values, global float4 *colors)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    colors[i] = transfer_at(knot_values, knot_colors, knots, values[i]);
}
