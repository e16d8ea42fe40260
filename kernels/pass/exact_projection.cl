// One value per ray, exactly: its maximum or minimum, its mean, or its first local maximum, from the
// field's cubic in each cell along the ray.
//
// PROJECTION_EXTREMUM: the largest of sign * Phi and where it is first reached. The extrema of a
// cubic lie at its ends and turning points; nodes and cells whose range cannot beat the running
// extremum are left out (Mroz et al. 2000), and from the start those that cannot beat `floor`.
// PROJECTION_MEAN: Simpson's rule in every cell, exact for cubics.
// PROJECTION_LOCAL: the first local maximum >= threshold, else the maximum (Sato et al. 1998);
// either end counts when the value falls away from it, and a plateau counts from its start.
//
// Reads the voxels, the clip planes (index space) and, per octree node, its range and its CLASS_* (CLASS_BELOW: nowhere above
// `floor`). Writes per pixel kind (surface where the ray meets the volume) and value (stored units;
// 0 where it does not); with LAYERS depth (mm from the eye; +inf for the mean); with COUNTERS the
// cells read and the nodes tested.
#include "old/cells.clh"
#include "old/clip.clh"

#if !defined(PROJECTION) || !defined(PROJECTION_EXTREMUM) || !defined(PROJECTION_MEAN) || !defined(PROJECTION_LOCAL)
#error "PROJECTION, which value is wanted, is given by the host"
#endif

// A slope along the way through a cell, as a share of its spread, that rounding may have made.
#define FLAT_SHARE 1e-6f

kernel void exact_projection(const global VOXEL *voxels, const global uchar *node_class, const global float2 *node_range,
                             const global uint4 *levels, const global float4 *clip_planes, uint clip_count,
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
    uint i = get_global_id(0);
    uint j = get_global_id(1);
    if (i >= rays.width || j >= rays.height)
        return;
    uint pixel = j * rays.width + i;

    Ray ray = pixel_ray(rays, i, j);
    Interval interval = volume_interval(volume, ray);
    clip_interval(&interval, clip_planes, clip_count, ray);
    bool meets = interval.enter <= interval.exit;
    float found = 0.0f;
    float found_mm = INFINITY; // from the entry
    uint cells_read = 0u;
    uint nodes_tested = 0u;

    if (meets) {
        CellWalk walk = cells_start(volume, ray, interval);
        bool more = true;
#if PROJECTION == PROJECTION_MEAN
        // Compensated summation (Kahan 1965): thousands of cells keep their digits.
        float sum = 0.0f;
        float lost = 0.0f;
        float whole = 0.0f;
        // A cell's share of the way, along the axis that the ray crosses fastest: differences of
        // places in the cell keep the digits that differences of t lose.
        float3 speed = fabs(walk.dir);
        uint axis = speed.x >= speed.y ? (speed.x >= speed.z ? 0u : 2u) : (speed.y >= speed.z ? 1u : 2u);
        while (more) {
            Corners corners = cell_corners(voxels, volume, &walk, 0.0f);
            cells_read++;
            CellExit exit = cell_exit(&walk);
            float3 near = point_in_cell(&walk, walk.t, walk.axis, false);
            float3 far = point_in_cell(&walk, exit.t, exit.axis, true);
            float share = fabs(component(far, axis) - component(near, axis));
            float mean = (corners_at(&corners, near) + 4.0f * corners_at(&corners, 0.5f * (near + far)) + corners_at(&corners, far)) / 6.0f;
            found = whole == 0.0f && share == 0.0f ? mean : found;
            float term = mean * share - lost;
            float next = sum + term;
            lost = (next - sum) - term;
            sum = next;
            whole += share;
            more = cells_step(&walk, exit);
        }
        // A ray that only touches the volume has the value there.
        found = whole > 0.0f ? sum / whole : found;
#else
        float most = cast.floor; // of sign * Phi
        found_mm = 0.0f;
        Walk way = walk_start(volume, cast.traverse);
        CellBox box = {(uint3)(0u), cast.traverse == TRAVERSE_OFF ? walk.count : (uint3)(0u)};
        uint3 before = octree_cell(volume, &walk); // in the last node
        bool done = false;
#if PROJECTION == PROJECTION_LOCAL
        float turn = -INFINITY; // the highest of a climb, the last of a fall
        float turn_mm = 0.0f;
        bool rising = true;
#endif
        while (more && !done) {
            float beat = most;
            bool ties = false;
#if PROJECTION == PROJECTION_LOCAL
            // A climb that has reached the threshold ends where all that follows is lower. Else a
            // local maximum that counts, or a higher maximum, is looked for.
            bool reached = rising && turn >= cast.threshold;
            ties = reached || most >= cast.threshold;
            beat = reached ? turn : (most >= cast.threshold ? cast.threshold : most);
#endif
            bool skip = false;
            if (!box_holds(box, walk.cell)) {
                uint3 cell = octree_cell(volume, &walk);
                walk_on(&way, before, cell);
                before = cell;
                skip = walk_down_to_beat(&way, node_class, node_range, levels, cell, cast.sign, beat, ties, &box, &nodes_tested);
                box = box_to_the_end(volume, box);
            }
            Corners corners;
            CellExit exit;
            bool pass = skip;
            if (!skip) {
                corners = cell_corners(voxels, volume, &walk, 0.0f);
                cells_read++;
                exit = cell_exit(&walk);
                float bound = cast.sign > 0.0f ? corners_most(&corners) : -corners_least(&corners);
                pass = bound < beat || (bound == beat && !ties);
            }
#if PROJECTION == PROJECTION_LOCAL
            done = pass && reached;
            // What is passed over is below the threshold: what follows is a climb from there.
            rising = rising || pass;
            turn = pass && !done ? -INFINITY : turn;
#endif
            if (!pass) {
                float3 near = point_in_cell(&walk, walk.t, walk.axis, false);
                float3 far = point_in_cell(&walk, exit.t, exit.axis, true);
                float ends[4] = {0.0f, 1.0f, 1.0f, 1.0f};
                Cubic cubic = cubic_along(&corners, near, far - near);
                uint last = cubic_turns(cubic, &ends[1], &ends[2]) + 1u;
                ends[last] = 1.0f;
#if PROJECTION == PROJECTION_LOCAL
                // Rise and fall are told by the slope: a dip too shallow for the values' digits has
                // one all the same.
                float flat = FLAT_SHARE * (corners_most(&corners) - corners_least(&corners));
#endif
                for (uint n = 0u; n <= last && !done; n++) {
                    float v = cast.sign * corners_at(&corners, near + (far - near) * ends[n]);
                    float t = walk.t.x + (exit.t.x - walk.t.x) * ends[n];
#if PROJECTION == PROJECTION_LOCAL
                    // With the nearest filter the field changes at walls alone.
                    float slope = n > 0u ? cast.sign * cubic_slope(cubic, 0.5f * (ends[n - 1u] + ends[n])) : (FILTER_LINEAR ? 0.0f : v - turn);
                    if (turn == -INFINITY || slope > flat) {
                        rising = true;
                        if (v > turn) {
                            turn = v;
                            turn_mm = t;
                        }
                    } else if (slope < -flat) {
                        done = rising && turn >= cast.threshold;
                        rising = done;
                        turn = done ? turn : v;
                    }
#endif
                    if (v > most) {
                        most = v;
                        found_mm = t;
                    }
                }
            }
            more = !done && (skip ? cells_leap(&walk, box) : cells_step(&walk, exit));
        }
#if PROJECTION == PROJECTION_LOCAL
        bool counts = rising && turn >= cast.threshold;
        most = counts ? turn : most;
        found_mm = counts ? turn_mm : found_mm;
#endif
        found = cast.sign * most;
#endif
    }

    kind[pixel] = meets ? KIND_SURFACE : KIND_NOTHING;
    value[pixel] = found;
#if LAYERS
    depth[pixel] = ray.base_mm + (interval.enter + found_mm);
#endif
#if COUNTERS
    steps[pixel] = cells_read;
    nodes[pixel] = nodes_tested;
#endif
}
