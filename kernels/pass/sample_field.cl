// The field at equal steps along every ray through the volume, and nothing else: the most samples that
// a cast could take, against which casts are measured.
//
// Skips nothing, stops nowhere, knows no clip planes. Writes value, the mean of a ray's samples in stored
// units, and steps, their number: both 0 where the ray misses the volume or crosses less of it than a step.
#include "lib/ray/interval.clh"
#include "lib/ray/source.clh"
#include "lib/volume/field.clh"

kernel void sample_field(VOXELS voxels, VolumeGrid volume, RAY_SOURCE, float step_mm,
                         global float *value, global uint *steps)
{
    Pixels pixels = RAY_PIXELS();
    Ray ray = RAY_OF(pixels);
    Interval interval = volume_interval(volume, ray);
    Mask meets = pixels.inside & interval.enter < interval.exit;
    Floats enter = meets ? interval.enter : FLOATS(0.0f);
    Floats length_mm = meets ? interval.exit - enter : FLOATS(0.0f);
    Ints count = AS_INTS(length_mm / step_mm);
    Floats sum = FLOATS(0.0f);
    for (int k = 0; ANY(k < count); k++) {
        // In the middle of its step. Past a ray's end field_at stays in the last cell.
        Floats t = enter + ((float)k + 0.5f) * step_mm;
        Floats3 p = {ray.origin.x.high + ray.dir.x.high * t, ray.origin.y.high + ray.dir.y.high * t, ray.origin.z.high + ray.dir.z.high * t};
        Floats sample = field_at(voxels, volume, p);
        sum += k < count ? sample : FLOATS(0.0f);
    }
    Floats mean = count > 0 ? sum / AS_FLOATS(count) : FLOATS(0.0f);
    SCATTER(pixels.inside, value, pixels.index, mean);
    SCATTER(pixels.inside, steps, pixels.index, count);
}
