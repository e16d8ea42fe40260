//! Ruijters and Vilanova 2006, §8: rays that end early in a volume where nothing is empty.
//!
//! The paper's third figure, 16.1 fps, is of ending whole bricks before their rays are cast. No brick
//! is drawn on its own here, so that the figure has no counterpart; what the octree costs or saves where it
//! finds nothing empty stands in its place.

use super::super::papers::{self, Case, Errors, LazyDataset, Measurement, run_group, unskipped};
use super::super::{Bench, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::scene::{Picture, Scene, Termination};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b9",
    about: "early ray termination where nothing is transparent: none, alone, with the octree \
            (Ruijters and Vilanova 2006, section 8)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The paper's frames per second: without early termination, and with it for each ray.
const PAPER: [f64; 2] = [2.2, 5.2];
/// The opacity at which a ray ends.
const TERMINATION: f64 = 0.99;
/// Opacity of a voxel's path at the volume's smallest value and at its greatest.
const OPACITIES: [f64; 2] = [0.1, 0.5];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = papers::outcome(bench, "case", Errors::Light);
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Blob) {
        let measured = run_group(bench, &mut outcome, &volume, "filled", |dataset| {
            cases(bench, dataset)
        })?;
        outcome.findings.push(finding(&volume.name, &measured));
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn cases(bench: &Bench, dataset: &Dataset) -> Result<Vec<Case>> {
    let range = dataset.volume.range();
    let knots = [(range.min, OPACITIES[0]), (range.max, OPACITIES[1])];
    let scene = dataset.medium(bench.preset.side_px(), &knots)?;
    let whole = ending_at(scene.clone(), Termination::NEVER);
    let ended = ending_at(scene, Termination::new(TERMINATION)?);
    let ended_name = format!("ends at {TERMINATION}");
    Ok(vec![
        Case::new("to the end", unskipped(whole)).paper_fps(Some(PAPER[0])),
        Case::new(&ended_name, unskipped(ended.clone())).paper_fps(Some(PAPER[1])),
        Case::new(format!("{ended_name}, octree"), ended).same_as(1),
    ])
}

fn ending_at(mut scene: Scene, termination: Termination) -> Scene {
    if let Picture::Emission(medium) = &mut scene.picture {
        medium.termination = termination;
    }
    scene
}

fn finding(volume: &str, measured: &[Measurement]) -> String {
    let speedups: Vec<f64> = papers::speedups(measured).map(|(ours, _)| ours).collect();
    let max = |place: usize| measured[place].light.map_or(0.0, |light| 100.0 * light.max);
    format!(
        "{volume}: ending early is {:.2} times as fast as going to the end (paper {:.1}); with the \
         octree, which finds nothing to skip, it is {:.2} times as fast as without; the paper's 16.1 \
         fps, for ending whole bricks, have no counterpart here; the largest colour error goes from {:.2} \
         to {:.2} % of white",
        speedups[1],
        PAPER[1] / PAPER[0],
        measured[1].times.over(&measured[2].times),
        max(0),
        max(1)
    )
}
