// The sample lattice of each ray and its spans of one node: per ray, at most `room` each of
// points, their cells, and spans (first sample, end, whether the cells either side of its beginning
// touch), and of `lasts`, the cells of the spans' last samples.
#define LANES 1
#include "lib/skip/spans.clh"

static inline uint4 as_numbers(Ints3 cell)
{
    return (uint4)((uint)cell.x, (uint)cell.y, (uint)cell.z, 0u);
}

#if JITTERED
#define AHEAD , float ahead
#define STEPS_GIVEN {step_mm, ahead}
#else
#define AHEAD
#define STEPS_GIVEN {step_mm}
#endif

kernel void spans(uint count, uint room, uint4 size, uint level, float step_mm AHEAD,
                  const global float4 *origins, const global float4 *dirs,
                  global uint4 *sizes, global float4 *points, global uint4 *cells,
                  global uint4 *spans_out, global uint4 *lasts)
{
    uint i = get_global_id(0);
    if (i >= count || get_global_id(1) != 0)
        return;
    VolumeGrid volume;
    volume.nx = size.x;
    volume.ny = size.y;
    volume.nz = size.z;
    Ray ray;
    ray.origin.x = pair_of(origins[i].x, 0.0f);
    ray.origin.y = pair_of(origins[i].y, 0.0f);
    ray.origin.z = pair_of(origins[i].z, 0.0f);
    ray.dir.x = pair_of(dirs[i].x, 0.0f);
    ray.dir.y = pair_of(dirs[i].y, 0.0f);
    ray.dir.z = pair_of(dirs[i].z, 0.0f);
    ray.t_min = 0.0f;
    ray.t_max = INFINITY;
    Interval interval = volume_interval(volume, ray);
    uint samples = 0u;
    uint spans_found = 0u;
    if (interval.enter <= interval.exit) {
        Steps steps = STEPS_GIVEN;
        Lattice lattice = ray_lattice(volume, ray, interval, steps);
        samples = (uint)lattice.last + 1u;
        for (uint k = 0u; k < samples && k < room; k++) {
            Floats t = lattice_t(&lattice, (int)k);
            Floats3 p = lattice_point(&lattice, t);
            points[i * room + k] = (float4)(p.x, p.y, p.z, interval.enter + t);
            cells[i * room + k] = as_numbers(cell_at(volume, p));
        }
        Ints3 last_cell = cell_at(volume, lattice.start);
        for (uint k = 0u; k < samples && spans_found < room;) {
            Ints3 cell = cell_at(volume, lattice_point(&lattice, lattice_t(&lattice, (int)k)));
            uint touch = leaves_touch(last_cell, cell) ? 1u : 0u;
            CellBox box;
            set_box(&box, cell, (int)level, 0, ALL_LANES);
            uint end = (uint)span_end(&lattice, (int)k, cell, &box, ALL_LANES, &last_cell);
            spans_out[i * room + spans_found] = (uint4)(k, end, touch, 0u);
            lasts[i * room + spans_found] = as_numbers(last_cell);
            spans_found++;
            k = end;
        }
    }
    sizes[i] = (uint4)(samples, spans_found, 0u, 0u);
}
