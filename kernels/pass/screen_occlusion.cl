// The share of the light from everywhere that a surface keeps from each hit within radius_mm, estimated from what the picture
// shows: spans of depths that rays spend inside the surface (thickness.cl). In `sections` planes through the eye and the point
// (lib/light/section.clh), turned from pixel to pixel of a square of 4, `steps` pixels on either side are looked at, closer
// together near the point. What a pixel hides is the part of its span within radius_mm of the point. Pixels outside the
// picture hide nothing.
//
// px: the distance of neighbouring rays across the view axis, mm, at the base plane and its growth per mm. turns: of each
// pixel of the square the cosines and sines of its sections' angles.
//
// Reads the voxels, spans, hit_mm and kind. Writes estimate where something was met, 0 on caps.
#include "lib/find/surface_point.clh"
#include "lib/light/section.clh"
#include "lib/ray/camera.clh"
#include "lib/ray/planes.clh"

// Pixels of a square in which each has sections of its own.
#define SQUARE_PIXELS ((int)(SECTION_SQUARE * SECTION_SQUARE))

// The most by which the sphere around a point looks wider than it is, since its near side is nearer to the eye.
#define MAX_NEARER 4.0f

// The whole number next to one that is not beyond 2^22: adding 3 * 2^22 leaves no room for fractions.
static inline Floats nearest_whole(Floats number) { return (number + 12582912.0f) - 12582912.0f; }

// The slope against the tangent plane below which what is seen hides less than a thousandth.
#define LEAST_SLOPE 0.01f

// What is looked at around a point.
typedef struct {
    const global float2 *spans;
    uint width, height;
    float2 px;
    float radius_mm;
    uint steps;
    Pixels pixels;
    Mask hit;
    Floats front;  // the point's depth
    Floats reach;  // the radius, in pixels of a unit across the ray
    Floats shift;  // of the steps, as a share of one
    Floats sector_shift;
} Surroundings;

// What of a side of a section is hidden, +1 or -1.
static inline Ints hidden_sectors(const Surroundings *around, Section section, float side)
{
    Ints hidden = INTS(0);
    Floats reach = around->reach * section.stretch;
    Floats ahead_i = side * section.ahead_i;
    Floats ahead_j = side * section.ahead_j;
    Floats column_tau = side * section.column_tau;
    Floats row_tau = side * section.row_tau;
    Floats ray_tau = side * section.ray_tau;
    float each = 1.0f / (float)around->steps;
    Floats share = around->shift * each;
    Floats before = FLOATS(0.0f);
    Floats at = FLOATS(0.0f);
    Floats next = max_of(reach * share * share, FLOATS(1.0f));
    for (uint n = 0u; n < around->steps; n++) {
        before = at;
        at = next;
        share += each;
        next = max_of(reach * share * share, at + 1.0f);
        Floats i = nearest_whole(at * ahead_i);
        Floats j = nearest_whole(at * ahead_j);
        Ints column = around->pixels.i + AS_INTS(i);
        Ints row = around->pixels.j + AS_INTS(j);
        Mask seen = around->hit & column >= 0 & column < (int)around->width & row >= 0 & row < (int)around->height;
        Floats2 span = gather_float2(around->spans, seen ? row * (int)around->width + column : around->pixels.index);
        // The span's front from the point.
        Floats apart = span.x - around->front;
        Floats mm = fma(FLOATS(around->px.y), span.x, FLOATS(around->px.x));
        Floats tau = fma(i, column_tau, j * row_tau);
        Floats nu = fma(i, section.column_nu, j * section.row_nu);
        Floats x = fma(mm, tau, apart * ray_tau);
        Floats y = fma(mm, nu, apart * section.ray_nu);
        // What is not above the tangent plane, as most of a round vessel, hides nothing.
        seen = seen & span.y > span.x & y > LEAST_SLOPE * fabs(x);
        if (!ANY(seen))
            continue;
        // Its direction per mm along the view axis; whether it ends above the tangent plane; and the part of it within the sphere.
        Floats dx = fma(FLOATS(around->px.y), tau, ray_tau);
        Floats dy = fma(FLOATS(around->px.y), nu, section.ray_nu);
        Mask hangs = fma(span.y - span.x, dy, y) > 0.0f;
        Floats a = 1.0f / fma(dx, dx, dy * dy);
        Floats b = fma(x, dx, y * dy) * a;
        Floats c = fma(x, x, fma(y, y, FLOATS(-around->radius_mm * around->radius_mm))) * a;
        Floats within = fma(b, b, -c);
        Floats half_of = sqrt(max_of(within, FLOATS(0.0f)));
        Floats from = max_of(-half_of - b, FLOATS(0.0f));
        Floats to = min_of(half_of - b, span.y - span.x);
        seen = seen & within > 0.0f & to > from;
        Floats far_x = fma(to, dx, x);
        Floats far_y = fma(to, dy, y);
        x = fma(from, dx, x);
        y = fma(from, dy, y);
        // What ends above the tangent plane is taken to go on half way to the pixels looked at beside it.
        Floats half_mm = hangs ? 0.5f * mm : FLOATS(0.0f);
        x = fma(before - at, half_mm, x);
        far_x = fma(next - at, half_mm, far_x);
        Ints bits = sectors_between(x, y, far_x, far_y, side, around->sector_shift);
        hidden |= seen ? bits : INTS(0);
    }
    return hidden;
}

kernel void screen_occlusion(VOXELS voxels, VolumeGrid volume, RayGrid rays, float iso, float4 right, float4 down, float2 px,
                             float4 forward, float radius_mm, uint sections, uint steps, const global float2 *turns,
                             const global float2 *sectors, const global float *hit_mm, const global uint *kind,
                             const global float2 *spans, global float *estimate)
{
    Pixels pixels = tile_pixels(rays);
    Ints met = read_ints(kind, pixels);
    Mask hit = pixels.inside & met == KIND_SURFACE;
    Floats occluded = FLOATS(0.0f);
    if (ANY(hit)) {
        Ray ray = camera_ray(rays, pixels);
        SurfacePoint point = surface_point(voxels, volume, ray, read_floats(hit_mm, pixels), iso, 1u, hit);
        ScreenAxes axes = {right, down, forward};
        AroundPoint about = around_point(axes, ray.dir_world, point.normal);
        Ints turn = (pixels.i + pixels.j) % (int)SECTION_SQUARE * (int)SECTION_SQUARE + pixels.i % (int)SECTION_SQUARE;
        Surroundings around;
        around.spans = spans;
        around.width = rays.width;
        around.height = rays.height;
        around.px = px;
        around.radius_mm = radius_mm;
        around.steps = steps;
        around.pixels = pixels;
        around.hit = hit;
        around.front = read_float2(spans, pixels).x;
        Floats mm = px.x + px.y * around.front;
        Floats nearer = radius_mm * px.y / (mm * about.per_mm);
        nearer = 1.0f / sqrt(max_of(1.0f - nearer * nearer, FLOATS(1.0f / (MAX_NEARER * MAX_NEARER))));
        around.reach = min_of(radius_mm / mm * nearer, FLOATS((float)(rays.width + rays.height)));
        around.shift = (AS_FLOATS(turn * 7 % SQUARE_PIXELS) + 0.5f) / (float)SQUARE_PIXELS;
        around.sector_shift = (AS_FLOATS(turn * 11 % SQUARE_PIXELS) + 0.5f) / (float)SQUARE_PIXELS;
        for (uint n = 0u; n < sections; n++) {
            Floats2 turned = gather_float2(turns, turn * (int)sections + (int)n);
            Section section = section_at(about, turned.x, turned.y);
            Ints hidden = hidden_sectors(&around, section, 1.0f) | hidden_sectors(&around, section, -1.0f);
            if (ANY(hidden != 0))
                occluded += hidden_share(section, hidden, sectors);
        }
        occluded = min_of(occluded / (float)sections, FLOATS(1.0f));
    }
    // On caps too: what is smoothed beside them reads it.
    SCATTER(pixels.inside & met != KIND_NOTHING, estimate, pixels.index, hit ? occluded : FLOATS(0.0f));
}
