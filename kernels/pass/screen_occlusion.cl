// The share of the light from everywhere that a surface keeps from each hit within radius_mm, estimated from what the picture
// shows: spans of depths that rays spend inside the surface (thickness.cl). In `slices` planes through the eye and the point
// (lib/light/slice.clh), turned from pixel to pixel of a square of 4, `steps` pixels on either side are looked at, closer
// together near the point. What a pixel hides is the part of its span within radius_mm of the point. Pixels outside the
// picture hide nothing.
//
// px: the distance of neighbouring rays across the view axis, mm, at the base plane and its growth per mm. turns: of each
// pixel of the square the cosines and sines of its slices' angles.
//
// Reads the voxels, spans, hit_mm and kind. Writes estimate, and at hits tangents: the geometric normal in world space.
#include "lib/find/surface_point.clh"
#include "lib/light/slice.clh"
#include "lib/ray/camera.clh"
#include "lib/ray/planes.clh"

// Pixels of a square in which each has slices of its own.
#define SQUARE_PIXELS ((int)(SLICE_SQUARE * SLICE_SQUARE))

// The most by which the sphere around a point looks wider than it is, since its near side is nearer to the eye.
#define MAX_NEARER 4.0f

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

// What of a side of a slice is hidden.
static inline Ints hidden_sectors(const Surroundings *around, Slice slice, float side)
{
    Ints hidden = INTS(0);
    Floats reach = around->reach * slice.stretch;
    float each = 1.0f / (float)around->steps;
    Floats share = around->shift * each;
    Floats next = max_of(reach * share * share, FLOATS(1.0f));
    Floats before = FLOATS(0.0f);
    for (uint n = 0u; n < around->steps; n++) {
        Floats at = next;
        share += each;
        next = max_of(reach * share * share, at + 1.0f);
        Floats i = (side * at * slice.ahead_i + 12582912.0f) - 12582912.0f;
        Floats j = (side * at * slice.ahead_j + 12582912.0f) - 12582912.0f;
        Ints column = around->pixels.i + AS_INTS(i);
        Ints row = around->pixels.j + AS_INTS(j);
        Mask seen = around->hit & column >= 0 & column < (int)around->width & row >= 0 & row < (int)around->height;
        Floats2 span = gather_float2(around->spans, seen ? row * (int)around->width + column : around->pixels.index);
        // The span's front, and its direction per mm along the view axis, from the point.
        Floats apart = span.x - around->front;
        Floats mm = around->px.x + around->px.y * span.x;
        Floats tau = i * slice.column_tau + j * slice.row_tau;
        Floats nu = i * slice.column_nu + j * slice.row_nu;
        Floats x = side * (mm * tau + apart * slice.ray_tau);
        Floats y = mm * nu + apart * slice.ray_nu;
        Floats dx = side * (slice.ray_tau + around->px.y * tau);
        Floats dy = slice.ray_nu + around->px.y * nu;
        // Its part within the sphere.
        Floats a = 1.0f / (dx * dx + dy * dy);
        Floats b = (x * dx + y * dy) * a;
        Floats c = (x * x + y * y - around->radius_mm * around->radius_mm) * a;
        Floats within = b * b - c;
        Floats half_of = sqrt(max_of(within, FLOATS(0.0f)));
        Floats from = max_of(-half_of - b, FLOATS(0.0f));
        Floats to = min_of(half_of - b, span.y - span.x);
        seen = seen & within > 0.0f & to > from;
        Floats far_x = x + to * dx;
        Floats far_y = y + to * dy;
        x += from * dx;
        y += from * dy;
        // What ends above the tangent plane is taken to go on half way to the pixels looked at beside it.
        Mask hangs = far_y > 0.0f;
        x -= hangs ? 0.5f * (at - before) * mm : FLOATS(0.0f);
        far_x += hangs ? 0.5f * (next - at) * mm : FLOATS(0.0f);
        before = at;
        Ints bits = sectors_between(sector_place(x, y), sector_place(far_x, far_y), side, around->sector_shift);
        hidden |= seen ? bits : INTS(0);
    }
    return hidden;
}

kernel void screen_occlusion(VOXELS voxels, VolumeGrid volume, RayGrid rays, float iso, float4 right, float4 down, float2 px,
                             float4 forward, float radius_mm, uint slices, uint steps, const global float2 *turns,
                             const global float2 *sectors, const global float *hit_mm, const global uint *kind,
                             const global float2 *spans, global float *estimate, global float4 *tangents)
{
    Pixels pixels = tile_pixels(rays);
    Mask hit = pixels.inside & read_ints(kind, pixels) == KIND_SURFACE;
    if (!ANY(pixels.inside))
        return;
    Floats occluded = FLOATS(0.0f);
    if (ANY(hit)) {
        Ray ray = camera_ray(rays, pixels);
        SurfacePoint point = surface_point(voxels, volume, ray, read_floats(hit_mm, pixels), iso, hit);
        ScreenAxes axes = {right, down, forward};
        Ints turn = (pixels.i + pixels.j) % (int)SLICE_SQUARE * (int)SLICE_SQUARE + pixels.i % (int)SLICE_SQUARE;
        Floats per_mm = 1.0f / along_axis(ray.dir_world, forward);
        Surroundings around;
        around.spans = spans;
        around.width = rays.width;
        around.height = rays.height;
        around.px = px;
        around.radius_mm = radius_mm;
        around.steps = steps;
        around.pixels = pixels;
        around.hit = hit;
        around.front = gather_float2(spans, pixels.index).x;
        Floats mm = px.x + px.y * around.front;
        Floats nearer = radius_mm * px.y / (mm * per_mm);
        nearer = 1.0f / sqrt(max_of(1.0f - nearer * nearer, FLOATS(1.0f / (MAX_NEARER * MAX_NEARER))));
        around.reach = min_of(radius_mm / mm * nearer, FLOATS((float)(rays.width + rays.height)));
        around.shift = (AS_FLOATS(turn * 7 % SQUARE_PIXELS) + 0.5f) / (float)SQUARE_PIXELS;
        around.sector_shift = (AS_FLOATS(turn * 11 % SQUARE_PIXELS) + 0.5f) / (float)SQUARE_PIXELS;
        for (uint n = 0u; n < slices; n++) {
            Floats2 turned = gather_float2(turns, turn * (int)slices + (int)n);
            Slice slice = slice_at(axes, ray.dir_world, per_mm, point.normal, turned.x, turned.y);
            Ints hidden = hidden_sectors(&around, slice, 1.0f) | hidden_sectors(&around, slice, -1.0f);
            occluded += hidden_share(slice, hidden, sectors);
        }
        occluded = min_of(occluded / (float)slices, FLOATS(1.0f));
        Floats4 normal = {point.normal.x, point.normal.y, point.normal.z, FLOATS(0.0f)};
        scatter_float4(tangents, pixels, normal);
    }
    SCATTER(pixels.inside, estimate, pixels.index, hit ? occluded : FLOATS(0.0f));
}
