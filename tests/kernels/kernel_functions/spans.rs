//! The sample lattice and its spans of one node.

use angioray::gpu::{Args, Pass};
use angioray::scene::Filter;

use super::{Random, U8, common, room, run, upload, variant, xyz};

const ROOM: usize = 512;

/// One ray's samples and spans, as the device has them.
struct Walked {
    points: Vec<[f32; 4]>,
    cells: Vec<[u32; 3]>,
    spans: Vec<Span>,
}

#[derive(Debug, Clone, Copy)]
struct Span {
    first: usize,
    end: usize,
    /// Whether the leaves of the sample before and of the first sample touch.
    touch: bool,
    last_cell: [u32; 3],
}

fn first_three([x, y, z, _]: [u32; 4]) -> [u32; 3] {
    [x, y, z]
}

/// By how much of a step samples are shifted toward the eye; not at all; in a kernel that could.
const AHEAD: [Option<f32>; 4] = [None, Some(0.0), Some(0.375), Some(0.9999)];

// long: the kernel's arguments, three times in one order.
fn on_device(
    size: [u32; 3],
    [leaf, level]: [u32; 2],
    step_mm: f32,
    ahead: Option<f32>,
    rays: &[([f32; 4], [f32; 4])],
) -> Option<Vec<Walked>> {
    let device = common::device()?;
    let defines = variant(U8, Filter::Linear, leaf).defines();
    let defines = defines.with("JITTERED", u32::from(ahead.is_some()));
    let pass = Pass::new("test", "spans", defines, [1, 1]);
    let origins: Vec<[f32; 4]> = rays.iter().map(|ray| ray.0).collect();
    let dirs: Vec<[f32; 4]> = rays.iter().map(|ray| ray.1).collect();
    let mut sizes = room::<[u32; 4]>(&device, rays.len());
    let mut points = room::<[f32; 4]>(&device, rays.len() * ROOM);
    let [mut cells, mut spans, mut lasts] =
        [(); 3].map(|()| room::<[u32; 4]>(&device, rays.len() * ROOM));
    let args = Args::new()
        .value("count", &(rays.len() as u32))
        .value("room", &(ROOM as u32))
        .value("size", &[size[0], size[1], size[2], 0])
        .value("level", &level)
        .value("step_mm", &step_mm);
    let args = match ahead {
        Some(ahead) => args.value("ahead", &ahead),
        None => args,
    };
    run(
        &device,
        &pass,
        args.read("origins", &upload(&device, &origins))
            .read("dirs", &upload(&device, &dirs))
            .write("sizes", &mut sizes)
            .write("points", &mut points)
            .write("cells", &mut cells)
            .write("spans_out", &mut spans)
            .write("lasts", &mut lasts),
        rays.len(),
    );
    let sizes = sizes.download(&device).unwrap();
    let points = points.download(&device).unwrap();
    let cells = cells.download(&device).unwrap();
    let spans = spans.download(&device).unwrap();
    let lasts = lasts.download(&device).unwrap();
    let walked = |(ray, &[samples, spans_found, ..]): (usize, &[u32; 4])| {
        let (samples, spans_found) = (samples as usize, spans_found as usize);
        assert!(
            samples <= ROOM && spans_found <= ROOM,
            "{samples} samples, {spans_found} spans"
        );
        let base = ray * ROOM;
        let span = |i: usize| Span {
            first: spans[i][0] as usize,
            end: spans[i][1] as usize,
            touch: spans[i][2] != 0,
            last_cell: first_three(lasts[i]),
        };
        Walked {
            points: points[base..base + samples].to_vec(),
            cells: cells[base..base + samples]
                .iter()
                .map(|&c| first_three(c))
                .collect(),
            spans: (base..base + spans_found).map(span).collect(),
        }
    };
    Some(sizes.iter().enumerate().map(walked).collect())
}

/// Rays through the volume: anywhere, along axes and diagonals, and in faces of nodes.
fn rays(size: [u32; 3], leaf: u32, random: &mut Random) -> Vec<([f32; 4], [f32; 4])> {
    (0..300)
        .map(|i| {
            let mut dir = random.direction();
            if i % 3 == 1 {
                dir = [0.0; 4];
                dir[random.below(3) as usize] = if random.below(2) == 0 { 1.0 } else { -1.0 };
            } else if i % 3 == 2 {
                dir[random.below(3) as usize] = [0.0, -0.0, 1e-30, 1e-9][random.below(4) as usize];
            }
            let length = xyz(dir).iter().map(|c| c * c).sum::<f64>().sqrt();
            let dir = dir.map(|c| (f64::from(c) / length) as f32);
            let mut origin: [f32; 4] = [0.0; 4];
            for axis in 0..3 {
                let n = size[axis];
                let through = match random.below(4) {
                    0 => (random.below(n.div_ceil(leaf)) * leaf).min(n - 1) as f32,
                    1 => random.below(n) as f32,
                    _ => random.within(0.0, f64::from(n - 1).max(0.01)),
                };
                origin[axis] = through - 50.0 * dir[axis];
            }
            (origin, dir)
        })
        .collect()
}

fn node(cell: [u32; 3], leaf: u32, level: u32) -> [u32; 3] {
    cell.map(|c| (c / leaf) >> level)
}

/// What is wrong with a ray's spans as a tiling by nodes of `leaf << level` cells.
fn tiling_fault(walked: &Walked, leaf: u32, level: u32) -> Option<String> {
    let mut next = 0;
    for span in &walked.spans {
        if span.first != next || span.end <= span.first || span.end > walked.cells.len() {
            return Some(format!("{span:?} does not follow sample {next}"));
        }
        let nodes = walked.cells[span.first..span.end]
            .iter()
            .map(|&cell| node(cell, leaf, level));
        let own = node(walked.cells[span.first], leaf, level);
        if let Some(other) = nodes.into_iter().find(|&other| other != own) {
            return Some(format!("{span:?} reaches from node {own:?} into {other:?}"));
        }
        if span.last_cell != walked.cells[span.end - 1] {
            return Some(format!("{span:?} ends in {:?}", walked.cells[span.end - 1]));
        }
        next = span.end;
    }
    (next != walked.cells.len()).then(|| format!("{next} of {} samples", walked.cells.len()))
}

/// What is wrong with a flag that two samples' leaves touch: flagged, the straight line between them
/// stays in both leaves; not flagged, they differ by more than a step along one axis.
fn touch_fault(walked: &Walked, leaf: u32) -> Option<String> {
    for span in walked.spans.iter().skip(1) {
        let (a, b) = (span.first - 1, span.first);
        let leaves = [a, b].map(|k| node(walked.cells[k], leaf, 0));
        let apart: u32 = (0..3)
            .map(|axis| leaves[0][axis].abs_diff(leaves[1][axis]))
            .sum();
        if !span.touch {
            if apart <= 1 {
                return Some(format!("{leaves:?} are reported not to touch"));
            }
            continue;
        }
        let (p, q) = (xyz(walked.points[a]), xyz(walked.points[b]));
        for i in 0..=64 {
            let f = f64::from(i) / 64.0;
            let at: [f64; 3] = std::array::from_fn(|axis| p[axis] * (1.0 - f) + q[axis] * f);
            let within = |leaf_node: [u32; 3]| {
                (0..3).all(|axis| {
                    let low = f64::from(leaf_node[axis] * leaf);
                    // Below the first voxel lies half a voxel of a one-voxel axis.
                    let low = if low == 0.0 { -0.5 } else { low };
                    (low - 1e-4..=f64::from((leaf_node[axis] + 1) * leaf) + 1e-4)
                        .contains(&at[axis])
                })
            };
            if !leaves.into_iter().any(within) {
                return Some(format!("{at:?} lies in neither of {leaves:?}"));
            }
        }
    }
    None
}

#[test]
fn spans_tile_the_lattice_by_nodes() {
    let mut random = Random(7);
    let (mut spans, mut runs, mut walks) = (0, 0, 0);
    let (mut far_apart, mut coarser_faults) = (0, 0);
    let mut ahead = AHEAD.into_iter().cycle();
    for (size, leaf) in [
        ([40, 33, 27], 4),
        ([64, 5, 31], 5),
        ([30, 30, 30], 8),
        ([1, 40, 40], 4),
        ([1, 1, 17], 4),
    ] {
        for level in 0..4 {
            for step_mm in [0.3, 1.7, 9.0] {
                let rays = rays(size, leaf, &mut random);
                let ahead = ahead.next().flatten();
                let Some(all) = on_device(size, [leaf, level], step_mm, ahead, &rays) else {
                    return;
                };
                for (ray, walked) in rays.iter().zip(&all) {
                    let fault = tiling_fault(walked, leaf, level).or(touch_fault(walked, leaf));
                    assert_eq!(
                        fault, None,
                        "{size:?} leaf {leaf} level {level} step {step_mm} ahead {ahead:?}: {ray:?}"
                    );
                    // In nodes of half the size the same spans are too long.
                    coarser_faults +=
                        usize::from(level > 0 && tiling_fault(walked, leaf, level - 1).is_some());
                    far_apart += walked
                        .spans
                        .iter()
                        .skip(1)
                        .filter(|span| !span.touch)
                        .count();
                    // Below the one voxel of an axis a span may be a single sample.
                    if !size.contains(&1) {
                        walks += 1;
                        spans += walked.spans.len();
                        runs += walked
                            .cells
                            .chunk_by(|&a, &b| node(a, leaf, level) == node(b, leaf, level))
                            .count();
                    }
                }
            }
        }
    }
    assert!(coarser_faults > 100, "{coarser_faults}");
    assert!(far_apart > 100, "{far_apart}");
    // Spans end where nodes do, rarely before; a ray's last sample, in the far face, may stand alone.
    assert!(
        spans < runs + walks + runs / 50,
        "{spans} spans for {runs} runs of one node in {walks} rays"
    );
}

/// Where each sample should be, in double precision.
#[test]
fn samples_lie_a_step_apart_from_entry_to_exit() {
    let size = [40, 33, 27];
    let step = 0.3_f32;
    let rays = rays(size, 4, &mut Random(8));
    for ahead in AHEAD {
        let Some(all) = on_device(size, [4, 0], step, ahead, &rays) else {
            return;
        };
        let seen = check_places(size, step, ahead.unwrap_or(0.0), rays.iter().zip(&all));
        assert!(seen > 10_000, "{seen}");
    }
}

/// Checks that samples lie where they should, and counts them.
fn check_places<'a>(
    size: [u32; 3],
    step: f32,
    ahead: f32,
    walked: impl Iterator<Item = (&'a ([f32; 4], [f32; 4]), &'a Walked)>,
) -> usize {
    let mut seen = 0;
    for (&(origin, dir), walked) in walked {
        let Some((first, last)) = walked.points.first().zip(walked.points.last()) else {
            continue;
        };
        seen += walked.points.len();
        let (enter, exit) = (f64::from(first[3]), f64::from(last[3]));
        for (k, &point) in walked.points.iter().enumerate() {
            let steps = (k as f64 - f64::from(ahead)).max(0.0);
            let t = (enter + steps * f64::from(step)).min(exit);
            for axis in 0..3 {
                let at = f64::from(origin[axis]) + t * f64::from(dir[axis]);
                assert!(
                    (f64::from(point[axis]) - at).abs() < 1e-4,
                    "{origin:?} {dir:?}: sample {k}"
                );
                assert!((0.0..=f64::from(size[axis] - 1)).contains(&f64::from(point[axis])));
            }
        }
        let steps = (exit - enter) / f64::from(step) + f64::from(ahead);
        assert!((steps.ceil() - (walked.points.len() - 1) as f64).abs() <= 1.0);
    }
    seen
}
