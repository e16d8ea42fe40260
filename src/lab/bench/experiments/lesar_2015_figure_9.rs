//! Lesar et al. 2015, Figure 9: how many nodes each ray goes through; near-misses are the dearest.

use serde::{Deserialize, Serialize};

use super::super::papers::{LazyDataset, plain_steps};
use super::super::{Bench, Dataset, Experiment, Illustration, Outcome};
use crate::error::Result;
use crate::frame::{Frame, KIND, Layer, NODES, STEPS, Wanted};
use crate::lab::report::{Shown, Table};
use crate::scene::{Refine, Scene, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b17",
    about: "the map of traversal iterations a ray, its histogram, and which rays are the dearest \
            (Lesar et al. 2015, Figure 9)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: false,
    takes_peer: false,
    run,
};

const COLUMNS: [(&str, &str, Shown); 7] = [
    ("volume", "volume", Shown::Short),
    ("from", "iterations from", Shown::Fixed(0)),
    ("to", "to", Shown::Fixed(0)),
    ("pixels", "pixels", Shown::Fixed(0)),
    ("hits", "hits", Shown::Fixed(0)),
    ("near_misses", "near-misses", Shown::Fixed(0)),
    ("clear_misses", "clear misses", Shown::Fixed(0)),
];

/// The classes of rays that are the histogram's columns.
const CLASSES: [&str; 3] = ["hits", "near-misses", "clear misses"];

/// Histograms of the iterations in one volume.
#[derive(Serialize, Deserialize)]
struct IterationCounts {
    /// Pixels by class; bin b counts rays of 2^(b − 1) to 2^b − 1 iterations, bin 0 those of none.
    bins: Vec<[u64; 3]>,
    /// Sums of iterations by class.
    iterations: [u64; 3],
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conditions.side_px = Some(bench.preset.side_px());
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let dataset = volume.get()?;
        let histogram = bench.unit(&volume.name, || {
            Ok(IterationCounts::of(&frame(bench, dataset)?))
        })?;
        tabulate(&mut outcome, &volume.name, &histogram);
        outcome.findings.push(finding(&volume.name, &histogram));
        bench.so_far(&outcome)?;
        outcome
            .pictures
            .push(map(&volume.name, frame(bench, dataset)?));
    }
    outcome.findings.push(
        "a near-miss is a ray that takes samples, for it passes through nodes that hold the iso \
         value, but meets no surface; a clear miss takes none; in the map dark is many"
            .into(),
    );
    Ok(outcome)
}

/// The paper's cast: kd-restart, fixed steps, regula falsi.
fn scene(bench: &Bench, dataset: &Dataset) -> Result<Scene> {
    let surface = dataset.surface(bench.preset.side_px())?;
    let mut scene = plain_steps(&surface, 0.5, "regula-falsi:5".parse::<Refine>()?)?;
    scene.sampling.traverse = Traverse::KdRestart;
    Ok(scene)
}

fn frame(bench: &Bench, dataset: &Dataset) -> Result<Frame> {
    let wanted = Wanted::DISPLAY.with(Layer::COUNTERS).with([Layer::Kind]);
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    Ok(renderer.render(&scene(bench, dataset)?, wanted)?.frame)
}

impl IterationCounts {
    fn of(frame: &Frame) -> Self {
        let planes = [NODES, STEPS, KIND].map(|key| frame.plane(key));
        let [nodes, steps, kinds] = planes.map(Option::unwrap_or_default);
        let mut histogram = Self {
            bins: Vec::new(),
            iterations: [0; 3],
        };
        for ((&nodes, &steps), &kind) in nodes.iter().zip(steps).zip(kinds) {
            let class = match (kind, steps) {
                (0, 0) => 2,
                (0, _) => 1,
                _ => 0,
            };
            let bin = (u32::BITS - nodes.leading_zeros()) as usize;
            if histogram.bins.len() <= bin {
                histogram.bins.resize(bin + 1, [0; 3]);
            }
            histogram.bins[bin][class] += 1;
            histogram.iterations[class] += u64::from(nodes);
        }
        histogram
    }

    /// Iterations a ray, by class; nothing where there is no ray of the class.
    fn means(&self) -> [Option<f64>; 3] {
        [0, 1, 2].map(|class| {
            let rays: u64 = self.bins.iter().map(|bin| bin[class]).sum();
            (rays > 0).then(|| self.iterations[class] as f64 / rays as f64)
        })
    }
}

fn tabulate(outcome: &mut Outcome, volume: &str, histogram: &IterationCounts) {
    for (bin, counts) in histogram.bins.iter().enumerate() {
        let (from, to) = match bin {
            0 => (0_u64, 0),
            bin => (1 << (bin - 1), (1 << bin) - 1),
        };
        outcome.table.push(vec![
            volume.into(),
            from.into(),
            to.into(),
            counts.iter().sum::<u64>().into(),
            counts[0].into(),
            counts[1].into(),
            counts[2].into(),
        ]);
    }
}

fn finding(volume: &str, histogram: &IterationCounts) -> String {
    let means = histogram.means();
    let by_class = CLASSES.iter().zip(means);
    let by_class = by_class.filter_map(|(class, mean)| Some(format!("{class} {:.1}", mean?)));
    let by_class = by_class.collect::<Vec<_>>().join(", ");
    let dearest = CLASSES.iter().zip(means).max_by(|(_, a), (_, b)| {
        let of = |mean: &Option<f64>| mean.unwrap_or(0.0);
        of(a).total_cmp(&of(b))
    });
    let (dearest, _) = dearest.unwrap_or((&CLASSES[0], None));
    let holds = if *dearest == CLASSES[1] {
        "as in the paper"
    } else {
        "unlike the paper, where near-misses are"
    };
    format!("{volume}: iterations a ray: {by_class}; {dearest} are the dearest, {holds}")
}

/// The iterations as grey levels: white none, black the most of any ray.
fn map(volume: &str, mut frame: Frame) -> Illustration {
    let nodes = frame.layers.take(NODES).unwrap_or_default();
    let max = nodes.iter().copied().max().unwrap_or(0);
    let grey = |&nodes: &u32| {
        let level = 1.0 - nodes as f32 / max.max(1) as f32;
        [level, level, level, 1.0]
    };
    frame.display = Some(nodes.iter().map(grey).collect());
    Illustration {
        section: volume.to_owned(),
        label: "iterations".into(),
        caption: format!("traversal iterations a ray, white none, black {max}"),
        frame,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::ImageSize;

    #[test]
    fn rays_are_counted_by_what_they_met_and_how_far_they_went() {
        let size = ImageSize::new(3, 2).unwrap();
        let mut frame = Frame::blank(size, Wanted::NONE).unwrap();
        frame.layers.insert(STEPS, vec![5, 2, 0, 0, 9, 1]);
        frame.layers.insert(NODES, vec![1, 7, 0, 4, 8, 3]);
        frame.layers.insert(KIND, vec![1, 0, 0, 0, 2, 0]);
        let histogram = IterationCounts::of(&frame);
        // Bins: 0; 1; 2, 3; 4 to 7; 8 to 15.
        let expected = [[0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 1, 1], [1, 0, 0]];
        assert_eq!(histogram.bins, expected);
        assert_eq!(histogram.means(), [Some(4.5), Some(5.0), Some(2.0)]);
        assert!(finding("x", &histogram).ends_with("near-misses are the dearest, as in the paper"));
    }
}
