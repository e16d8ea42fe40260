// The share of the light from everywhere that a surface keeps from each hit, between two bounds: the directions from it are parted
// into squares of a cube around it (lib/light/cube.clh), whose pyramids of rays all meet the surface again within t_max
// (index_direction, lib/find/leaving.clh), or none does, or it is not known (lib/skip/pyramid.clh). Those of which it is not
// known are parted into four, the largest first, until they have no more than `unknown_share` of the light. 0 on caps, before which the
// kept part of the volume is empty, and where nothing was hit.
//
// Reads the voxels, the clip planes (index space), per octree node its CLASS_*, a bit per cell that the surface may cross, and
// hit_mm and kind of a cast. Writes occlusion, the middle between the bounds, and with LAYERS occlusion_bound, how far they are from it.
// A work-item takes one hit.
#if LANES != 1
#error "a work-item takes one ray"
#endif
#include "lib/find/surface_point.clh"
#include "lib/light/cube.clh"
#include "lib/ray/planes.clh"
#include "lib/ray/visible.clh"
#include "lib/skip/pyramid.clh"

#if LAYERS
#define BOUND_PLANE , global float *occlusion_bound
#else
#define BOUND_PLANE
#endif

// The squares of which more is to be known, a ring: where it is full no more are parted.
#define MOST_SQUARES 1024u

typedef struct {
    uint numbers[MOST_SQUARES];
    uint first, count;
} SquareQueue;

static inline void put_square(SquareQueue *queue, CubeSquare square)
{
    queue->numbers[(queue->first + queue->count++) % MOST_SQUARES] = square_number(square);
}

static inline CubeSquare next_square(SquareQueue *queue)
{
    CubeSquare square = square_of(queue->numbers[queue->first]);
    queue->first = (queue->first + 1u) % MOST_SQUARES;
    queue->count--;
    return square;
}

// The pyramid of a square, from a point of the surface.
static inline Pyramid pyramid_of(SurfacePoint point, CubeSquare square, VolumeGrid volume, float iso)
{
    int cells[3] = {axis_cells(volume.nx), axis_cells(volume.ny), axis_cells(volume.nz)};
    Pair place[3] = {point.at.x, point.at.y, point.at.z};
    Pyramid pyramid;
    pyramid.axis = (int)(square.face >> 1);
    pyramid.forward = (square.face & 1u) != 0u;
    for (int n = 0; n < 3; n++) {
        int a = (pyramid.axis + n) % 3;
        pyramid.cell[n] = clamp((int)place[a].high, 0, cells[a] - 1);
        pyramid.place[n] = in_cell(place[a], pyramid.cell[n]);
    }
    pyramid.main_cells = cells[pyramid.axis];
    pyramid.last_u = cells[(pyramid.axis + 1) % 3] - 1;
    pyramid.last_v = cells[(pyramid.axis + 2) % 3] - 1;
    pyramid.u = square_side(square.i, square.parted);
    pyramid.v = square_side(square.j, square.parted);
    pyramid.iso = iso;
    pyramid.open = point.inside ? -1.0f : 1.0f;
    pyramid.slices = slice_axes(volume, pyramid.axis);
    return pyramid;
}

// The s up to which no ray of a square is beyond t_max, and from which on all are.
static inline float2 s_at(const SquareCorners *corners, float t_max)
{
    float3 middle = normalize(corners->at[0] + corners->at[1] + corners->at[2] + corners->at[3]);
    float longest = 0.0f;
    float least = INFINITY;
    for (int n = 0; n < 4; n++) {
        longest = fmax(longest, length(corners->at[n]));
        least = fmin(least, dot(corners->at[n], middle));
    }
    return (float2)(t_max / longest * (1.0f - PLACE_ROUNDING), t_max / least * (1.0f + PLACE_ROUNDING));
}

// The share of the light that is kept from a point: surely, and perhaps.
static inline float2 bounds_of(VOXELS voxels, const SkipGrid *grid, VolumeGrid volume, ClipPlanes clip, SurfacePoint point, float iso, float t_max,
                               float unknown_share)
{
    WorldAxes axes = world_axes(volume);
    float3 normal = (float3)(point.normal.x, point.normal.y, point.normal.z);
    SquareQueue queue;
    queue.first = queue.count = 0u;
    for (uint n = 0u; n < CUBE_FACES * FACE_SQUARES * FACE_SQUARES; n++) {
        CubeSquare square = {n / (FACE_SQUARES * FACE_SQUARES), 0u, n % FACE_SQUARES, n / FACE_SQUARES % FACE_SQUARES};
        put_square(&queue, square);
    }
    float open = 0.0f;
    float blocked = 0.0f;
    while (queue.count > 0u && 1.0f - open - blocked > unknown_share) {
        CubeSquare square = next_square(&queue);
        SquareCorners corners = square_corners(axes, square);
        float share = square_share(&corners, normal);
        if (!(share > 0.0f))
            continue;
        Pyramid pyramid = pyramid_of(point, square, volume, iso);
        float2 s = s_at(&corners, t_max);
        uint known = pyramid_of_rays(voxels, grid, volume, &pyramid, clip, s.x, s.y);
        if (known == PYRAMID_OPEN)
            open += share;
        else if (known == PYRAMID_BLOCKED)
            blocked += share;
        else if (square.parted < MAX_PARTED && queue.count + 4u <= MOST_SQUARES)
            for (uint n = 0u; n < 4u; n++)
                put_square(&queue, quarter_of(square, n));
    }
    return (float2)(blocked, fmax(1.0f - open, blocked));
}

kernel void bound_occlusion(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, SurfaceCast cast, float t_max,
                            float unknown_share, const global float *hit_mm, const global uint *kind, global float *occlusion BOUND_PLANE)
{
    Pixels pixels = RAY_PIXELS();
    if (!pixels.inside)
        return;
    float2 bounds = (float2)(0.0f);
    if (read_ints(kind, pixels) == KIND_SURFACE) {
        SurfacePoint point = surface_point(voxels, volume, RAY_OF(pixels), read_floats(hit_mm, pixels), cast.iso, SETTLING_STEPS, ALL_LANES);
        SkipGrid grid = skip_by_class(node_class, levels, cells);
        bounds = bounds_of(voxels, &grid, volume, CLIP_GIVEN, point, cast.iso, t_max, unknown_share);
    }
    occlusion[pixels.index] = 0.5f * (bounds.y + bounds.x);
#if LAYERS
    occlusion_bound[pixels.index] = 0.5f * (bounds.y - bounds.x);
#endif
}
