//! Ruijters and Vilanova 2006, §8: rays that end early in a volume where nothing is empty.

use super::super::ways::{self, Errors, Found, Subject, Way, run_group, unskipped};
use super::super::{Bench, Experiment, Outcome, Specimen};
use crate::error::Result;
use crate::scene::{Picture, Scene};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b9",
    about: "early ray termination in a filled volume: none, alone, with the octree (Ruijters and \
            Vilanova 2006, section 8)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    run,
};

/// fps: none, early termination, early termination and octree.
const PAPER: [f64; 3] = [2.2, 5.2, 16.1];
/// The opacity at which a ray ends.
const TERMINATION: f64 = 0.99;
/// Share of the value range from which the volume is filled.
const FILLED_FROM: f64 = 0.05;

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(ways::table("case", Errors::Light));
    for subject in Subject::in_one_size(bench, PhantomKind::Blob) {
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
    let knots = [(range.at(FILLED_FROM), 0.0), (range.max, 0.5)];
    let scene = specimen.medium(bench.effort.side_px(), &knots)?;
    let whole = ending_at(scene.clone(), 1.0);
    let ended = ending_at(scene, TERMINATION);
    let ended_name = format!("ends at {TERMINATION}");
    Ok(vec![
        Way::new("to the end", unskipped(whole)).paper_fps(Some(PAPER[0])),
        Way::new(&ended_name, unskipped(ended.clone())).paper_fps(Some(PAPER[1])),
        Way::new(format!("{ended_name}, octree"), ended)
            .paper_fps(Some(PAPER[2]))
            .same_as(1),
    ])
}

fn ending_at(mut scene: Scene, termination: f64) -> Scene {
    if let Picture::Emission(medium) = &mut scene.picture {
        medium.termination = termination;
    }
    scene
}

fn tell(volume: &str, found: &[Found]) -> String {
    let speedups: Vec<f64> = ways::speedups(found).map(|(ours, _)| ours).collect();
    let max = |place: usize| found[place].light.map_or(0.0, |light| light.max);
    format!(
        "{volume}: ending early is {:.2} times as fast as going to the end (paper {:.1}), the octree \
         another {:.2} times (paper {:.1}, whose octree ends whole bricks); the largest colour error \
         goes from {:.4} to {:.4}",
        speedups[1],
        PAPER[1] / PAPER[0],
        speedups[2] / speedups[1],
        PAPER[2] / PAPER[1],
        max(0),
        max(1)
    )
}
