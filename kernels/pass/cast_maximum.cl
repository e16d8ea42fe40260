// One value per ray: its maximum or minimum, its mean, or its first local maximum.
//
// PROJECTION_EXTREMUM: the largest of sign * Phi over the samples, and where it is first reached;
// what cannot beat the running extremum, which starts at `floor`, is skipped (Mroz et al. 2000). With
// `probe` the peaks between samples count too.
// PROJECTION_MEAN: the composite trapezoid rule, every sample needed.
// PROJECTION_LOCAL: the first local maximum >= threshold, else the maximum (Sato et al. 1998);
// either end counts when the value falls away from it.
//
// Reads the voxels, the clip planes (index space) and, per octree node, its range and its CLASS_*
// (CLASS_BELOW: nowhere above `floor`). Writes per pixel kind (surface where the ray meets the
// volume) and value (stored units; 0 where it does not); with LAYERS depth (mm from the eye; +inf for
// the mean); with COUNTERS the samples taken and the nodes tested.
#include "lib/clip.clh"
#include "lib/peak.clh"
#include "lib/stretches.clh"

#if !defined(PROJECTION) || !defined(PROJECTION_EXTREMUM) || !defined(PROJECTION_MEAN) || !defined(PROJECTION_LOCAL)
#error "PROJECTION, which value is wanted, is given by the host"
#endif

// What rays look at.
typedef struct {
    VolumeGrid volume;
    Lattice lattice;
    ProjectionCast cast;
} Sight;

#if PROJECTION == PROJECTION_MEAN
static inline Floats mean_along(VOXELS voxels, const Sight *sight, Mask alive, Ints *samples)
{
    const Lattice *lattice = &sight->lattice;
    // Compensated summation (Kahan 1965): thousands of samples keep their digits.
    Floats sum = FLOATS(0.0f);
    Floats lost = FLOATS(0.0f);
    Floats before = FLOATS(0.0f);
    Floats t = FLOATS(0.0f);
    for (Ints k = INTS(0); ANY(alive); k += 1) {
        Floats after = lattice_t(lattice, k < lattice->last ? k + 1 : k);
        Floats v = field_at(voxels, sight->volume, lattice_point(sight->volume, lattice, t));
        Floats weight = lattice->last == 0 ? FLOATS(1.0f) : 0.5f * (after - before) / lattice->length_mm;
        Floats term = v * weight - lost;
        Floats next = sum + term;
        lost = alive ? (next - sum) - term : lost;
        sum = alive ? next : sum;
        *samples += alive ? INTS(1) : INTS(0);
        before = t;
        t = after;
        alive = alive & k < lattice->last;
    }
    return sum;
}
#else

// What is known of rays on their way.
typedef struct {
    Stretch stretch;
    RayPoint before; // sample k - 1, where it is known: heights are sign * Phi
    Floats most;     // of sign * Phi
    Floats most_mm;  // where it is first reached, from the entry
    Mask done;
    Ints samples;
} Search;

// Whether what equals the running maximum matters too: a climb that has reached the threshold ends where
// all that follows is lower.
static inline Mask ties_count(const Sight *sight, const Search *search)
{
    return PROJECTION == PROJECTION_LOCAL ? search->most >= sight->cast.threshold : NO_LANE;
}

static inline RayPoint point_at(VOXELS voxels, const Sight *sight, Ints k)
{
    return ray_point(voxels, sight->volume, &sight->lattice, FLOATS(sight->cast.sign), 0.0f, sight->cast.probe, lattice_t(&sight->lattice, k));
}

// Looks at the next segment, in the lanes of `which`.
static inline void look(VOXELS voxels, const Sight *sight, Search *search, Mask which)
{
    Ints k = search->stretch.k;
    RayPoint here = point_at(voxels, sight, k);
    search->samples += which ? INTS(1) : INTS(0);
    if (sight->cast.probe) {
        Mask missing = which & k > 0 & !search->stretch.known;
        if (ANY(missing)) {
            search->before = point_if(missing, point_at(voxels, sight, k - 1), search->before);
            search->samples += missing ? INTS(1) : INTS(0);
        }
        RayPoint peak = here;
        Mask peaks = peak_between(voxels, sight->volume, &sight->lattice, FLOATS(sight->cast.sign), 0.0f, search->most, false,
                                  search->before, here, which & k > 0, &peak, &search->samples);
        search->most = peaks ? peak.height : search->most;
        search->most_mm = peaks ? peak.t : search->most_mm;
    }
    search->done = search->done | (which & ties_count(sight, search) & here.height < search->most);
    Mask more = which & here.height > search->most;
    search->most = more ? here.height : search->most;
    search->most_mm = more ? here.t : search->most_mm;
    search->before = point_if(which, here, search->before);
    search->stretch.known = search->stretch.known | which;
    search->stretch.k += which ? INTS(1) : INTS(0);
}

// Looks along rays, in the lanes of `alive`.
static inline void look_along(VOXELS voxels, const Sight *sight, Search *search, const global uchar *node_class, const global float2 *node_range,
                              const global uint4 *levels, Ray ray, Interval interval, Mask alive, Ints *nodes_tested)
{
    const Lattice *lattice = &sight->lattice;
    VolumeGrid volume = sight->volume;
    uint traverse = sight->cast.traverse;
    float sign = sight->cast.sign;
    search->stretch = stretch_up_to(traverse == TRAVERSE_OFF ? lattice->last : INTS(-1));
    search->before.t = search->before.height = search->before.slope = FLOATS(0.0f);
    search->most = FLOATS(sight->cast.floor);
    search->most_mm = FLOATS(0.0f);
    search->done = NO_LANE;
    Spans spans = spans_start(volume, lattice, traverse);
    bool together = false;
    Beam beam;
    CellWalk walk;
    if (FILTER_LINEAR && traverse == TRAVERSE_DISTANCE) {
        walk = cells_start(volume, ray, interval);
        together = beam_start(&beam, &walk, levels, volume, alive);
    }
    for (;;) {
        alive = alive & !search->done;
        if (together) {
            while (ANY(alive) && !ANY(alive & search->stretch.k <= search->stretch.last)) {
                BeamRegion region;
                Mask ties = ties_count(sight, search);
                float beat = LEAST_LANE(alive ? search->most : FLOATS(INFINITY));
                if (!beam_next_to_beat(&beam, voxels, node_class, node_range, sign, beat, ANY(alive & ties), &region, nodes_tested)) {
                    alive = NO_LANE;
                } else {
                    Mask leaves_out = stretch_into(&search->stretch, lattice, &beam, region, &walk, alive);
                    // What is left out is lower.
                    search->done = search->done | (leaves_out & ties);
                    alive = alive & !search->done;
                }
            }
        } else if (traverse != TRAVERSE_OFF) {
            Mask arrives = alive & search->stretch.k > search->stretch.last;
            while (ANY(arrives)) {
                Mask goes_on = spans_leave(&spans, volume, lattice, arrives);
                alive = alive & !(arrives & !goes_on);
                CellBox box;
                box.low = box.high = spans.cell;
                Mask skips = walk_down_to_beat(&spans.way, node_class, node_range, levels, spans.cell, sign, search->most,
                                               ties_count(sight, search), &box, goes_on, nodes_tested);
                spans_enter(&spans, &search->stretch, volume, lattice, skips ? INTS(CLASS_BELOW) : INTS(CLASS_VISIT), &box, goes_on);
                arrives = goes_on & search->stretch.k > search->stretch.last;
            }
        }
        Mask looking = alive & search->stretch.k <= search->stretch.last;
        if (!ANY(looking))
            return;
        look(voxels, sight, search, looking);
    }
}
#endif

kernel void cast_maximum(VOXELS voxels, const global uchar *node_class, const global float2 *node_range, const global uint4 *levels,
                            const global float4 *clip_planes, uint clip_count,
                            VolumeGrid volume, RayGrid rays, ProjectionCast cast,
                            global uint *kind, global float *value
#if LAYERS
                            , global float *depth
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
    Floats found = FLOATS(0.0f);
    Floats found_mm = FLOATS(INFINITY); // from the entry
    Ints sample_count = INTS(0);
    Ints node_count = INTS(0);
    if (ANY(meets)) {
#if PROJECTION == PROJECTION_MEAN
        found = mean_along(voxels, &sight, meets, &sample_count);
#else
        Search search;
        search.samples = INTS(0);
        look_along(voxels, &sight, &search, node_class, node_range, levels, ray, interval, meets, &node_count);
        found = cast.sign * search.most;
        found_mm = search.most_mm;
        sample_count = search.samples;
#endif
    }

    Ints met = meets ? INTS(KIND_SURFACE) : INTS(KIND_NOTHING);
    Floats seen = meets ? found : FLOATS(0.0f);
    SCATTER(pixels.inside, kind, pixels.index, met);
    SCATTER(pixels.inside, value, pixels.index, seen);
#if LAYERS
    Floats depth_mm = meets ? ray.base_mm + (interval.enter + found_mm) : FLOATS(INFINITY);
    SCATTER(pixels.inside, depth, pixels.index, depth_mm);
#endif
#if COUNTERS
    SCATTER(pixels.inside, steps, pixels.index, sample_count);
    SCATTER(pixels.inside, nodes, pixels.index, node_count);
#endif
}
