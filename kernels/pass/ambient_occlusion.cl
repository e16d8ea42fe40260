// The share of the light from everywhere that a surface keeps from each hit: that of rays over the hemisphere about its normal,
// distributed by their cosine to it, which meet the surface again from t_min to t_max (index_direction, lib/find/leaving.clh). 0 on caps, before
// which the kept part of the volume is empty, and where nothing was hit.
//
// Reads the voxels, the clip planes (index space), per octree node its CLASS_*, a bit per cell that the surface may cross, sets of
// directions about the normal, and hit_mm and kind of a cast. Writes occlusion.
#include "lib/find/leaving.clh"
#include "lib/find/ray_sets.clh"
#include "lib/ray/planes.clh"

kernel void ambient_occlusion(VOXELS voxels, SKIP_BY_CLASS, CLIP_PLANES, VolumeGrid volume, RAY_SOURCE, SurfaceCast cast,
                              RAY_SET_SOURCE, float t_min, float t_max,
                              const global float *hit_mm, const global uint *kind, global float *occlusion)
{
    Pixels pixels = RAY_PIXELS();
    Mask hit = pixels.inside & read_ints(kind, pixels) == KIND_SURFACE;
    Ints blocked = INTS(0);
    if (ANY(hit)) {
        SurfacePoint point = surface_point(voxels, volume, RAY_OF(pixels), read_floats(hit_mm, pixels), cast.iso, SETTLING_STEPS, hit);
        Tangents tangents = tangents_of(point.normal);
        SkipGrid grid = skip_by_class(node_class, levels, cells);
        Ints first = first_of_set(pixels, RAY_IN_PIXEL(pixels), per_set);
        for (uint n = 0u; n < per_set; n++) {
            Floats3 dir = about_normal(point.normal, tangents, gather_float4(ray_sets, first + (int)n));
            Mask meets = meets_again(voxels, grid, volume, CLIP_GIVEN, cast, point, dir, t_min, FLOATS(t_max), hit);
            blocked += meets ? INTS(1) : INTS(0);
        }
    }
    SCATTER(pixels.inside, occlusion, pixels.index, AS_FLOATS(blocked) / (float)per_set);
}
