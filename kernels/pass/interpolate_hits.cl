// Where the rays of pixels hit whose blocks are proven to show one smooth piece of the surface
// (mark_uncertain): the place along the volume's axis that the block's rays mostly run along is interpolated between the
// block's corners, which were cast.
//
// Reads cast. Reads and writes hit_mm. Writes kind and what else a surface's cast does (cast_planes.clh), the iso value as
// value.
#include "lib/ray/blocks.clh"
#include "lib/ray/camera.clh"
#include "lib/ray/cast_planes.clh"

#if CERTIFICATE
#define CERTIFICATE_PLANE , global uint *certificate
#else
#define CERTIFICATE_PLANE
#endif

// A ray's origin and its direction along an axis that differs from lane to lane, index space.
static inline Floats origin_along(Ray ray, Ints axis) { return of_axis(axis, ray.origin.x.high, ray.origin.y.high, ray.origin.z.high); }
static inline Floats speed_along(Ray ray, Ints axis) { return of_axis(axis, ray.dir.x.high, ray.dir.y.high, ray.dir.z.high); }

kernel void interpolate_hits(RayGrid rays, float iso, const global uint *cast, global float *hit_mm, global uint *kind DEPTH_PLANE VALUE_PLANE
                             CERTIFICATE_PLANE COUNTER_PLANES)
{
    Pixels pixels = tile_pixels(rays);
    Ints mark = read_ints(cast, pixels);
    pixels.inside = pixels.inside & is_block_mark(mark);
    if (!ANY(pixels.inside))
        return;
    Ints side = pixels.inside ? side_of_mark(mark) : INTS(1);
    Ints axis = axis_of_mark(mark);
    BlockSide x = block_side(pixels.i, side, 0, rays.width);
    BlockSide y = block_side(pixels.j, side, 0, rays.height);
    BlockCorners corners = block_corners(x, y, rays.width);
    Floats place = FLOATS(0.0f);
    for (int n = 0; n < 4; n++) {
        Ray corner = camera_ray_at(rays, AS_FLOATS(n % 2 == 0 ? x.low : x.high), AS_FLOATS(n < 2 ? y.low : y.high));
        Floats t = GATHER(Floats, hit_mm, corners.place[n]);
        place += corners.weight[n] * (origin_along(corner, axis) + t * speed_along(corner, axis));
    }
    Ray ray = camera_ray(rays, pixels);
    Floats t = (place - origin_along(ray, axis)) / speed_along(ray, axis);
    SCATTER(pixels.inside, hit_mm, pixels.index, t);
    SCATTER(pixels.inside, kind, pixels.index, INTS(KIND_SURFACE));
#if LAYERS
    Floats depth_mm = ray.base_mm + t;
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
    SCATTER(pixels.inside, value, pixels.index, FLOATS(iso));
#endif
#if CERTIFICATE
    SCATTER(pixels.inside, certificate, pixels.index, INTS(CERTIFICATE_HIT));
#endif
    Ints none = INTS(0);
    WRITE_COUNTERS(pixels, none, none);
}
