//! Lesar et al. 2015, Figure 5: one volume under several transfer functions.

use super::super::papers::{self, Case, Errors, LazyDataset, run_group};
use super::super::{Bench, Dataset, Experiment, Illustration, Outcome};
use crate::error::Result;
use crate::frame::Wanted;
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b18",
    about: "one volume under four transfer functions: walls, interiors, both, all of it; with \
            pictures (Lesar et al. 2015, Figure 5)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

const WALL: [f64; 3] = [0.75, 0.22, 0.12];
const LUMEN: [f64; 3] = [0.95, 0.85, 0.55];
const TISSUE: [f64; 3] = [0.25, 0.35, 0.55];

/// Value as a share of the range from the volume's smallest value to the iso value (below 1) and on to
/// the greatest (1 to 2), linear-light colour, opacity of a voxel's path.
type Knots = &'static [(f64, [f64; 3], f64)];

const VARIANTS: [(&str, Knots); 4] = [
    (
        "walls",
        &[(0.6, WALL, 0.0), (1.0, WALL, 0.35), (1.4, WALL, 0.0)],
    ),
    ("interiors", &[(1.3, LUMEN, 0.0), (2.0, LUMEN, 0.6)]),
    (
        "walls and interiors",
        &[
            (0.6, WALL, 0.0),
            (1.0, WALL, 0.08),
            (1.4, LUMEN, 0.0),
            (2.0, LUMEN, 0.6),
        ],
    ),
    (
        "all of it",
        &[(0.1, TISSUE, 0.0), (1.0, WALL, 0.05), (2.0, LUMEN, 0.4)],
    ),
];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = papers::outcome(bench, "case", Errors::Light);
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let measured = run_group(bench, &mut outcome, &volume, "dvr", |dataset| {
            cases(bench, dataset)
        })?;
        let slowest = measured
            .iter()
            .map(|one| one.times.over(&measured[0].times));
        outcome.findings.push(format!(
            "{}: the picture of the slowest function takes {:.1} times as long as that of the \
             walls; the largest colour error of any is {:.2} % of white",
            volume.name,
            slowest.fold(1.0, f64::max),
            measured
                .iter()
                .filter_map(|one| Some(one.light?.max))
                .fold(0.0, f64::max)
                * 100.0
        ));
        outcome.pictures.extend(pictures(bench, volume.get()?)?);
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn cases(bench: &Bench, dataset: &Dataset) -> Result<Vec<Case>> {
    let range = dataset.volume.range();
    let value = |place: f64| {
        if place <= 1.0 {
            range.min + place * (dataset.iso - range.min)
        } else {
            dataset.iso + (place - 1.0) * (range.max - dataset.iso)
        }
    };
    let cases = VARIANTS.iter().map(|(name, knots)| {
        let knots = knots
            .iter()
            .map(|&(at, color, opacity)| (value(at), color, opacity));
        let knots: Vec<_> = knots.collect();
        let scene = dataset.colored_medium(bench.preset.side_px(), &knots)?;
        Ok(Case::new(*name, scene))
    });
    cases.collect()
}

fn pictures(bench: &Bench, dataset: &Dataset) -> Result<Vec<Illustration>> {
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let shots = cases(bench, dataset)?.into_iter().map(|case| {
        let frame = renderer.render(&case.scene, Wanted::DISPLAY)?.frame;
        Ok(Illustration {
            section: format!("{}, dvr", dataset.name),
            label: case.name,
            caption: String::new(),
            frame,
        })
    });
    shots.collect()
}
