// The first point of each ray where Phi - iso changes sign.
//
// Fixed steps on the sample lattice (Levoy 1988), nodes that lie wholly on one side of the iso value
// skipped (Lesar et al. 2015, §III-C), the crossing refined between two samples. With `probe`, two
// samples on one side between which the field may turn are looked between for a peak on the other
// side. "Inside" is Phi >= iso. With caps, a ray that enters through a face of the volume or a clip
// plane where it is inside hits there.
//
// Reads the voxels, the clip planes (index space), per octree node its CLASS_*, and a bit per cell that
// the surface may cross. Writes per pixel hit_mm (from the base plane along the ray; +inf: none) and
// kind; with LAYERS depth (mm from the eye) and value at the hit (stored units; 0 without a hit); with
// COUNTERS the samples taken and the nodes tested.
#include "lib/clip.clh"
#include "lib/peak.clh"
#include "lib/refine.clh"
#include "lib/stretches.clh"

// What rays look at.
typedef struct {
    VolumeGrid volume;
    Lattice lattice;
    SurfaceCast cast;
    Mask capped; // rays that hit where they begin, if that is inside
} Sight;

// What is known of rays on their way.
typedef struct {
    Stretch stretch;
    RayPoint before; // sample k - 1, where it is known: heights above the iso value
    Bracket bracket; // of the surface
    Ints kind;       // KIND_*
    Ints samples;
} Search;

static inline RayPoint point_at(VOXELS voxels, const Sight *sight, Ints k)
{
    return ray_point(voxels, sight->volume, &sight->lattice, FLOATS(1.0f), sight->cast.iso, sight->cast.probe, lattice_t(&sight->lattice, k));
}

// Looks at the next segment, in the lanes of `which`.
static inline void look(VOXELS voxels, const Sight *sight, Search *search, Mask which)
{
    Ints k = search->stretch.k;
    Mask first = k == 0;
    Mask missing = which & !first & !search->stretch.known;
    if (ANY(missing)) {
        search->before = point_if(missing, point_at(voxels, sight, k - 1), search->before);
        search->samples += missing ? INTS(1) : INTS(0);
    }
    RayPoint before = search->before;
    RayPoint here = point_at(voxels, sight, k);
    search->samples += which ? INTS(1) : INTS(0);
    Mask inside = here.height >= 0.0f;
    Mask crosses = which & !first & (inside ^ (before.height >= 0.0f));
    Floats far = here.t;
    Floats f_far = here.height;
    if (sight->cast.probe) {
        Floats sign = inside ? FLOATS(-1.0f) : FLOATS(1.0f);
        RayPoint a = {before.t, sign * before.height, sign * before.slope};
        RayPoint b = {here.t, sign * here.height, sign * here.slope};
        RayPoint peak = b;
        Mask turns = peak_between(voxels, sight->volume, &sight->lattice, sign, sight->cast.iso, FLOATS(0.0f), true, a, b,
                                  which & !first & !crosses, &peak, &search->samples);
        far = turns ? peak.t : far;
        f_far = turns ? sign * peak.height : f_far;
        crosses = crosses | turns;
    }
    search->bracket.near = crosses ? before.t : search->bracket.near;
    search->bracket.f_near = crosses ? before.height : search->bracket.f_near;
    search->bracket.far = crosses ? far : search->bracket.far;
    search->bracket.f_far = crosses ? f_far : search->bracket.f_far;
    search->kind = crosses ? INTS(KIND_SURFACE) : search->kind;
    search->kind = which & first & inside & sight->capped ? INTS(KIND_CAP) : search->kind;
    search->before = point_if(which, here, before);
    search->stretch.known = search->stretch.known | which;
    search->stretch.k += which ? INTS(1) : INTS(0);
}

// Looks along rays until each has met the surface or its end, in the lanes of `alive`.
static inline void look_along(VOXELS voxels, const Sight *sight, Search *search, const global uchar *node_class, const global uint4 *levels,
                              const global ulong *cells, Ray ray, Interval interval, Mask alive, Ints *nodes_tested)
{
    const Lattice *lattice = &sight->lattice;
    VolumeGrid volume = sight->volume;
    uint traverse = sight->cast.traverse;
    search->stretch = stretch_up_to(traverse == TRAVERSE_OFF ? lattice->last : INTS(-1));
    Spans spans = spans_start(volume, lattice, traverse);
    bool together = false;
    Beam beam;
    CellWalk walk;
    if (FILTER_LINEAR && traverse == TRAVERSE_DISTANCE) {
        walk = cells_start(volume, ray, interval);
        together = beam_start(&beam, &walk, levels, volume, alive);
    }
    for (;;) {
        alive = alive & search->kind == KIND_NOTHING;
        if (together) {
            while (ANY(alive) && !ANY(alive & search->stretch.k <= search->stretch.last)) {
                BeamRegion region;
                if (!beam_next(&beam, voxels, node_class, cells, sight->cast.iso, &region, nodes_tested)) {
                    alive = NO_LANE;
                } else if (region.class == CLASS_VISIT) {
                    stretch_into(&search->stretch, lattice, &beam, region, &walk, alive);
                } else if (region.class == CLASS_ABOVE) {
                    // Whether rays begin in it.
                    Mask first = alive & sight->capped & search->stretch.k == 0;
                    stretch_into(&search->stretch, lattice, &beam, region, &walk, first);
                    search->stretch.last = first & search->stretch.last > 0 ? INTS(0) : search->stretch.last;
                }
            }
        } else if (traverse != TRAVERSE_OFF) {
            Mask arrives = alive & search->stretch.k > search->stretch.last;
            while (ANY(arrives)) {
                Mask goes_on = spans_leave(&spans, volume, lattice, arrives);
                alive = alive & !(arrives & !goes_on);
                Ints byte = walk_down(&spans.way, node_class, levels, spans.cell, goes_on, nodes_tested);
                CellBox box;
                box.low = box.high = spans.cell;
                set_box(&box, spans.cell, spans.way.level, reach_of(byte), goes_on);
                spans_enter(&spans, &search->stretch, volume, lattice, class_of(byte), &box, goes_on);
                arrives = goes_on & search->stretch.k > search->stretch.last;
            }
        }
        Mask looking = alive & search->stretch.k <= search->stretch.last;
        if (!ANY(looking))
            return;
        look(voxels, sight, search, looking);
    }
}

kernel void cast_surface(VOXELS voxels, const global uchar *node_class, const global uint4 *levels, const global ulong *cells,
                         const global float4 *clip_planes, uint clip_count,
                         VolumeGrid volume, RayGrid rays, SurfaceCast cast,
                         global float *hit_mm, global uint *kind
#if LAYERS
                         , global float *depth, global float *value
#endif
#if COUNTERS
                         , global uint *steps, global uint *nodes
#endif
)
{
    Pixels pixels = tile_pixels(rays);
    Ray ray = pixel_ray(rays, pixels);
    Interval interval = volume_interval(volume, ray);
    clip_interval(&interval, clip_planes, clip_count, ray);
    Mask meets = pixels.inside & interval.enter <= interval.exit;
    Sight sight;
    sight.volume = volume;
    sight.lattice = ray_lattice(volume, ray, interval, cast.step_mm);
    sight.cast = cast;
    sight.capped = cast.caps ? interval.by_face : NO_LANE;
    Search search;
    search.before.t = search.before.height = search.before.slope = FLOATS(0.0f);
    search.bracket.near = search.bracket.far = search.bracket.f_near = search.bracket.f_far = FLOATS(0.0f);
    search.kind = INTS(KIND_NOTHING);
    search.samples = INTS(0);
    Ints node_count = INTS(0);
    Floats met_mm = FLOATS(0.0f); // from the entry; a cap lies there
    if (ANY(meets))
        look_along(voxels, &sight, &search, node_class, levels, cells, ray, interval, meets, &node_count);
    Mask crossed = search.kind == KIND_SURFACE;
    if (ANY(crossed)) {
        Floats refined = refine(voxels, volume, &sight.lattice, cast.iso, cast.refine, (int)cast.iterations, search.bracket, crossed, &search.samples);
        met_mm = crossed ? refined : met_mm;
    }

    Mask hit = search.kind != KIND_NOTHING;
    Floats t = hit ? interval.enter + met_mm : FLOATS(INFINITY);
    SCATTER(pixels.inside, hit_mm, pixels.index, t);
    SCATTER(pixels.inside, kind, pixels.index, search.kind);
#if LAYERS
    Floats seen = hit ? field_at(voxels, volume, lattice_point(volume, &sight.lattice, hit ? met_mm : FLOATS(0.0f))) : FLOATS(0.0f);
    Floats depth_mm = ray.base_mm + t;
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
    SCATTER(pixels.inside, value, pixels.index, seen);
#endif
#if COUNTERS
    SCATTER(pixels.inside, steps, pixels.index, search.samples);
    SCATTER(pixels.inside, nodes, pixels.index, node_count);
#endif
}
