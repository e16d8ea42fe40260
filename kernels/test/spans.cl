// The sample lattice of each ray and its spans of one node: per ray, at most `room` each of
// points, their cells, and spans (first sample, end, whether the cells either side of its beginning
// touch), and of `lasts`, the cells of the spans' last samples.
#include "old/octree.clh"

kernel void spans(uint count, uint room, uint4 size, uint level, float step_mm,
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
    ray.origin = origins[i].xyz;
    ray.origin_low = (float3)(0.0f);
    ray.dir = dirs[i].xyz;
    ray.dir_low = (float3)(0.0f);
    Interval interval = volume_interval(volume, ray);
    uint samples = 0u;
    uint spans_found = 0u;
    if (interval.enter <= interval.exit) {
        Lattice lattice = ray_lattice(volume, ray, interval, step_mm);
        samples = lattice.last + 1u;
        for (uint k = 0u; k < samples && k < room; k++) {
            float3 p = lattice_point(volume, lattice, lattice_t(lattice, k));
            uint3 cell = cell_at(volume, p);
            points[i * room + k] = (float4)(p, interval.enter + lattice_t(lattice, k));
            cells[i * room + k] = (uint4)(cell, 0u);
        }
        uint3 last_cell = cell_at(volume, lattice.start);
        for (uint k = 0u; k < samples && spans_found < room;) {
            uint3 cell = cell_at(volume, lattice_point(volume, lattice, lattice_t(lattice, k)));
            uint touch = leaves_touch(last_cell, cell) ? 1u : 0u;
            uint end = span_end(volume, lattice, k, cell, node_box(cell, level, 0u), &last_cell);
            spans_out[i * room + spans_found] = (uint4)(k, end, touch, 0u);
            lasts[i * room + spans_found] = (uint4)(last_cell, 0u);
            spans_found++;
            k = end;
        }
    }
    sizes[i] = (uint4)(samples, spans_found, 0u, 0u);
}
