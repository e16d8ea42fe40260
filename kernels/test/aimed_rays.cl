// The first crossings of rays that are given one by one, in index space: what exact_surface does for
// a picture's. The rays stand in rows of `width`; a work-item follows LANES of a row.
//
// Reads the voxels, per octree node its CLASS_*, a bit per cell that may be crossed, and per ray its
// origin and direction. Writes hit (in lengths of the direction from the origin; +inf: none), KIND_* and
// CERTIFICATE_*.
#include "lib/find/crossing.clh"

// Three numbers of four a ray.
static inline Floats3 of_rays(const global float4 *rays, Ints i)
{
    const global float *numbers = (const global float *)rays;
    Floats3 v;
    v.x = GATHER(Floats, numbers, i * 4);
    v.y = GATHER(Floats, numbers, i * 4 + 1);
    v.z = GATHER(Floats, numbers, i * 4 + 2);
    return v;
}

static inline Pair exactly(Floats number)
{
    Pair pair = {number, FLOATS(0.0f)};
    return pair;
}

kernel void aimed_rays(VOXELS voxels, const global uchar *node_class, const global uint4 *levels, const global ulong *cells,
                       VolumeGrid volume, SurfaceCast cast, uint count, uint width,
                       const global float4 *origins, const global float4 *dirs,
                       global float *hit, global uint *kind, global uint *certificate)
{
    Ints column = (int)(get_global_id(0) * LANES) + (LANE_X + LANE_Y * (int)TILE_WIDTH);
    Ints i = (int)(get_global_id(1) * width) + column;
    Mask there = (column < (int)width) & (i < (int)count);
    i = there ? i : INTS((int)count - 1);
    Floats3 origin = of_rays(origins, i);
    Floats3 dir = of_rays(dirs, i);
    Ray ray;
    ray.origin.x = exactly(origin.x);
    ray.origin.y = exactly(origin.y);
    ray.origin.z = exactly(origin.z);
    ray.dir.x = exactly(dir.x);
    ray.dir.y = exactly(dir.y);
    ray.dir.z = exactly(dir.z);
    ray.dir_world = dir;
    ray.base_mm = ray.t_min = FLOATS(0.0f);
    ray.t_max = FLOATS(INFINITY);
    Interval interval = volume_interval(volume, ray);
    Mask meets = there & (interval.enter <= interval.exit);
    VisibleRays visible = {{i, i, i, there, false}, ray, interval, meets};
    Ints cells_read = INTS(0);
    Ints nodes_tested = INTS(0);
    Crossing found = first_crossing(voxels, skip_by_class(node_class, levels, cells), volume, &visible, cast, &cells_read, &nodes_tested);
    Ints missed = only_touches(interval) ? INTS(CERTIFICATE_UNDECIDED) : INTS(CERTIFICATE_MISS);
    Ints proven = meets ? found.certificate : missed;
    Floats t = interval.enter + found.t;
    SCATTER(there, hit, i, t);
    SCATTER(there, kind, i, found.kind);
    SCATTER(there, certificate, i, proven);
}
