// The absorption per mm of each opacity.
#define LANES 1
#include "lib/light/transfer.clh"

kernel void absorption(uint count, float unit_length_mm, float max_absorption,
                       const global float *opacities, global float *per_mm)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    EmissionCast cast;
    cast.unit_length_mm = unit_length_mm;
    cast.max_absorption = max_absorption;
    per_mm[i] = absorption_per_mm(cast, opacities[i]);
}
