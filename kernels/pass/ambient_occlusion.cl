// The share of the light from everywhere that a surface keeps from each hit: that of rays over the hemisphere about its normal,
// distributed by their cosine to it, which meet the surface again from t_min to t_max (index_direction, lib/find/leaving.clh). 0 on caps, before
// which the kept part of the volume is empty, and where nothing was hit.
//
// hemispheres: HEMISPHERES sets of `per_hemisphere` directions each (x, y in the tangent plane, z along the normal); neighbouring
// pixels take different ones, so that their errors differ too.
//
// Reads the voxels, the clip planes (index space), per octree node its CLASS_*, a bit per cell that the surface may cross, and
// hit_mm and kind of a cast. Writes occlusion.
#include "lib/find/leaving.clh"
#include "lib/ray/planes.clh"

// Pixels along a row of the squares in which each has a set of its own.
#define SETS_IN_ROW 8

// The sets of a pixel's rays lie so far apart; it has no factor in common with HEMISPHERES.
#define SETS_APART 29

// The number of the set that each ray takes.
static inline Ints set_of(Pixels pixels, Ints in_pixel)
{
    Ints place = pixels.j % (HEMISPHERES / SETS_IN_ROW) * SETS_IN_ROW + pixels.i % SETS_IN_ROW;
    return (place + SETS_APART * in_pixel) % HEMISPHERES;
}

kernel void ambient_occlusion(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, SurfaceCast cast,
                              const global float4 *hemispheres, uint per_hemisphere, float t_min, float t_max,
                              const global float *hit_mm, const global uint *kind, global float *occlusion)
{
    Pixels pixels = RAY_PIXELS();
    Mask hit = pixels.inside & read_ints(kind, pixels) == KIND_SURFACE;
    Ints blocked = INTS(0);
    if (ANY(hit)) {
        SurfacePoint point = surface_point(voxels, volume, RAY_OF(pixels), read_floats(hit_mm, pixels), cast.iso, SETTLING_STEPS, hit);
        Tangents tangents = tangents_of(point.normal);
        SkipGrid grid = skip_by_class(node_class, levels, cells);
        Ints first = set_of(pixels, RAY_IN_PIXEL(pixels)) * (int)per_hemisphere;
        for (uint n = 0u; n < per_hemisphere; n++) {
            Floats3 dir = about_normal(point.normal, tangents, gather_float4(hemispheres, first + (int)n));
            Mask meets = meets_again(voxels, grid, volume, CLIP_GIVEN, cast, point, dir, t_min, t_max, hit);
            blocked += meets ? INTS(1) : INTS(0);
        }
    }
    SCATTER(pixels.inside, occlusion, pixels.index, AS_FLOATS(blocked) / (float)per_hemisphere);
}
