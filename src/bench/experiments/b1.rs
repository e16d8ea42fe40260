//! Scharsach 2005, Table 1: an isosurface made faster by skipping and by large steps with
//! refinement, which the table mixes and this separates.

use super::super::ways::{self, Errors, Found, TestVolume, Way, plain_steps, run_group, unskipped};
use super::super::{Bench, Experiment, Outcome, Specimen};
use crate::error::Result;
use crate::scene::{Refine, SamplingMethod};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b1",
    about: "isosurface: basic, with skipping, with steps of 5 voxels and refinement, each alone; \
            three sizes (Scharsach 2005, Table 1)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    races: false,
    run,
};

/// fps of the paper's sizes: basic, with skipping, with skipping and step 5 refined.
const PAPER: [[f64; 3]; 3] = [[14.6, 41.7, 350.0], [4.4, 24.3, 66.4], [1.5, 5.1, 15.1]];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = ways::outcome(bench, "case", Errors::Surface);
    for subject in TestVolume::in_three_sizes(bench, PhantomKind::Vessels) {
        let paper = PAPER[subject.size];
        let found = run_group(bench, &mut outcome, &subject, "iso", |specimen| {
            list(bench, specimen, paper)
        })?;
        outcome.findings.extend(tell(&subject.name, &found));
    }
    outcome.findings.push(
        "the paper's figures are of its own three sizes, in its order; a named volume stands beside \
         the middle one"
            .into(),
    );
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn list(bench: &Bench, specimen: &Specimen, paper: [f64; 3]) -> Result<Vec<Way>> {
    let surface = specimen.surface(bench.effort.side_px())?;
    let (none, six) = ("none".parse::<Refine>()?, "bisection:6".parse::<Refine>()?);
    let fine = plain_steps(&surface, 1.0, none)?;
    let mut exact = surface.clone();
    exact.sampling.method = SamplingMethod::Exact;
    Ok(vec![
        Way::new("basic: step 1", unskipped(fine.clone())).paper_fps(Some(paper[0])),
        Way::new("+ skipping", fine)
            .paper_fps(Some(paper[1]))
            .same_as(0),
        Way::new(
            "+ skipping, step 1 refined",
            plain_steps(&surface, 1.0, six)?,
        ),
        Way::new("+ skipping, step 5", plain_steps(&surface, 5.0, none)?),
        Way::new(
            "+ skipping, step 5 refined",
            plain_steps(&surface, 5.0, six)?,
        )
        .paper_fps(Some(paper[2])),
        Way::new("exact", exact),
    ])
}

fn tell(volume: &str, found: &[Found]) -> Vec<String> {
    let speedups: Vec<(f64, Option<f64>)> = ways::speedups(found).collect();
    let share = |place: usize| ways::percent_missed(&found[place]);
    let mut told = vec![format!(
        "{volume}: skipping alone is {:.1} times as fast as none (paper {:.1}), the picture the same",
        speedups[1].0,
        speedups[1].1.unwrap_or(f64::NAN)
    )];
    told.push(format!(
        "{volume}: step 5 with refinement is {:.2} times as fast as skipping alone (paper {:.1}), \
         but misses {} of the hits, where step 1 misses {}; exact casting misses {} \
         at {:.2} times step 5's time",
        found[1].times.over(&found[4].times),
        speedups[4]
            .1
            .zip(speedups[1].1)
            .map_or(f64::NAN, |(both, skip)| both / skip),
        share(4),
        share(1),
        share(5),
        found[5].times.over(&found[4].times),
    ));
    told
}
