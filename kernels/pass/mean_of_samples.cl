// The colour of pixels with many rays: the mean over a pixel's area, and with COVERAGE the share of its rays
// that met something.
//
// A work-item takes one listed pixel. Reads the samples' colours (linear light, premultiplied) and, with KIND, kinds;
// without, a sample met something whose opacity is at least opaque_from. Writes color and coverage.
#include "lib/abi.clh"

#if WITH_KIND
#define SAMPLE_KIND , const global uint *sample_kind
#else
#define SAMPLE_KIND
#endif
#if COVERAGE
#define COVERAGE_PLANE , global float *coverage
#else
#define COVERAGE_PLANE
#endif

kernel void mean_of_samples(const global uint2 *listed, uint first, uint count, uint per_pixel, float opaque_from,
                            const global float4 *sample_color SAMPLE_KIND, global float4 *color COVERAGE_PLANE)
{
    uint n = (uint)(get_global_id(1) * get_global_size(0) + get_global_id(0));
    if (n >= count)
        return;
    uint pixel = listed[first + n].x;
    float4 sum = (float4)(0.0f);
    uint met = 0u;
    for (uint k = n * per_pixel; k < (n + 1u) * per_pixel; k++) {
        sum += sample_color[k];
#if WITH_KIND
        met += sample_kind[k] != KIND_NOTHING ? 1u : 0u;
#else
        met += sample_color[k].w >= opaque_from ? 1u : 0u;
#endif
    }
    color[pixel] = sum / (float)per_pixel;
#if COVERAGE
    coverage[pixel] = (float)met / (float)per_pixel;
#endif
}
