// The transfer function at each value.
#define LANES 1
#include "lib/light/transfer.clh"

kernel void transfer(uint count, uint knots, const global float *knot_values, const global float4 *knot_colors,
                     const global float *values, global float4 *colors)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    Transfer transfer = {knot_values, knot_colors, knots};
    ColorOpacity seen = transfer_at(transfer, values[i]);
    colors[i] = (float4)(seen.rgb.x, seen.rgb.y, seen.rgb.z, seen.opacity);
}
