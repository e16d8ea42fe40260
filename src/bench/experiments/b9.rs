//! Ruijters and Vilanova 2006, §8: rays that end early in a volume where nothing is empty.
//!
//! The paper's third figure, 16.1 fps, is of ending whole bricks before their rays are cast. No brick
//! is drawn on its own here, so that the figure has no twin; what the octree costs or saves where it
//! finds nothing empty stands in its place.

use super::super::ways::{self, Errors, Found, TestVolume, Way, run_group, unskipped};
use super::super::{Bench, Experiment, Outcome, Specimen};
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
    races: false,
    run,
};

/// fps: none, early termination for each ray.
const PAPER: [f64; 2] = [2.2, 5.2];
/// The opacity at which a ray ends.
const TERMINATION: f64 = 0.99;
/// Opacity of a voxel's path at the volume's least value and at its greatest.
const OPACITIES: [f64; 2] = [0.1, 0.5];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = ways::outcome(bench, "case", Errors::Light);
    for subject in TestVolume::in_one_size(bench, PhantomKind::Blob) {
        let found = run_group(bench, &mut outcome, &subject, "filled", |specimen| {
            list(bench, specimen)
        })?;
        outcome.findings.push(tell(&subject.name, &found));
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn list(bench: &Bench, specimen: &Specimen) -> Result<Vec<Way>> {
    let range = specimen.volume.range();
    let knots = [(range.min, OPACITIES[0]), (range.max, OPACITIES[1])];
    let scene = specimen.medium(bench.effort.side_px(), &knots)?;
    let whole = ending_at(scene.clone(), Termination::NEVER);
    let ended = ending_at(scene, Termination::new(TERMINATION)?);
    let ended_name = format!("ends at {TERMINATION}");
    Ok(vec![
        Way::new("to the end", unskipped(whole)).paper_fps(Some(PAPER[0])),
        Way::new(&ended_name, unskipped(ended.clone())).paper_fps(Some(PAPER[1])),
        Way::new(format!("{ended_name}, octree"), ended).same_as(1),
    ])
}

fn ending_at(mut scene: Scene, termination: Termination) -> Scene {
    if let Picture::Emission(medium) = &mut scene.picture {
        medium.termination = termination;
    }
    scene
}

fn tell(volume: &str, found: &[Found]) -> String {
    let speedups: Vec<f64> = ways::speedups(found).map(|(ours, _)| ours).collect();
    let max = |place: usize| found[place].light.map_or(0.0, |light| 100.0 * light.max);
    format!(
        "{volume}: ending early is {:.2} times as fast as going to the end (paper {:.1}); with the \
         octree, which finds nothing to skip, it is {:.2} times as fast as without; the paper's 16.1 \
         fps, for ending whole bricks, have no twin here; the largest colour error goes from {:.2} \
         to {:.2} % of white",
        speedups[1],
        PAPER[1] / PAPER[0],
        found[1].times.over(&found[2].times),
        max(0),
        max(1)
    )
}
