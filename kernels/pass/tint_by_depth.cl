// The colour of what each ray shows by its depth: tinted by the ramp's colour there, as bright as it was, then faded by fog,
// opacity included.
//
// near_mm, per_mm: where near begins, and the share of the way to far that a mm has. fog, tint: the shares that they take;
// steps: how many depths are told apart, 0 for all. With RIM tints are confined to where normals turn away, by (1 - |n.v|)^rim.
// Reads depth (mm from the eye, or from the eye plane of a parallel camera; +inf: nothing is seen) and with RIM normal. Reads and
// writes color.
#include "lib/math/power.clh"
#include "lib/ray/planes.clh"
#include "lib/ray/source.clh"

#if RIM
#define RIM_PLANE float rim, const global float4 *normal,
#else
#define RIM_PLANE
#endif

// The luminance of linear light (Rec. 709).
static inline Floats luminance(Floats4 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

static inline Floats unit(Floats x) { return clamp_to(x, FLOATS(0.0f), FLOATS(1.0f)); }

// The ramp's colour of a share of the way from near to far.
static inline Floats3 ramp_color(uint ramp, Floats share)
{
    Floats x = (ramp == RAMP_FULL ? 4.0f : 2.0f) * share;
    float falls_from = ramp == RAMP_FULL ? 4.0f : 2.0f;
    float blue_from = ramp == RAMP_FULL ? 2.0f : 0.0f;
    Floats3 color = {unit(2.0f - x), unit(min_of(x, falls_from - x)), unit(x - blue_from)};
    return color;
}

kernel void tint_by_depth(RAY_SOURCE, float near_mm, float per_mm, float fog, float tint, uint ramp, uint steps, RIM_PLANE const global float *depth,
                          global float4 *color)
{
    Pixels pixels = RAY_PIXELS();
    if (!ANY(pixels.inside))
        return; // another work-item writes the nearest pixel
    Floats mm = read_floats(depth, pixels);
    Mask seen = mm < INFINITY;
    if (!ANY(seen))
        return;
    Floats4 was = read_float4(color, pixels);
    Floats4 light = was;
    Floats share = unit(((seen ? mm : FLOATS(near_mm)) - near_mm) * per_mm);
    if (tint > 0.0f) {
        Floats told = share;
        if (steps > 0) {
            float last = (float)(steps - 1);
            Floats step = AS_FLOATS(AS_INTS(min_of(share * (float)steps, FLOATS(last))));
            told = (step + 0.5f) / (float)steps;
        }
        Floats weight = FLOATS(tint);
#if RIM
        Floats4 n = read_float4(normal, pixels);
        Floats3 toward = direction_to_eye(RAY_OF(pixels));
        weight *= power(unit(1.0f - fabs(n.x * toward.x + n.y * toward.y + n.z * toward.z)), rim);
#endif
        Floats bright = luminance(light);
        Floats3 of_depth = ramp_color(ramp, told);
        light.x += weight * (bright * of_depth.x - light.x);
        light.y += weight * (bright * of_depth.y - light.y);
        light.z += weight * (bright * of_depth.z - light.z);
    }
    Floats kept = seen ? 1.0f - fog * share : FLOATS(1.0f);
    light.x = seen ? light.x * kept : was.x;
    light.y = seen ? light.y * kept : was.y;
    light.z = seen ? light.z * kept : was.z;
    light.w *= kept;
    scatter_float4(color, pixels, light);
}
