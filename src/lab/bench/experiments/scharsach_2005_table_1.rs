//! Scharsach 2005, Table 1: an isosurface made faster by skipping and by large steps with
//! refinement, which the table mixes and this separates.

use super::super::papers::{
    self, Case, Errors, LazyDataset, Measurement, plain_steps, run_group, unskipped,
};
use super::super::{Bench, Dataset, Experiment, Outcome};
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
    takes_peer: false,
    run,
};

/// The paper's frames per second for its sizes: basic, with skipping, with skipping and step 5 refined.
const PAPER: [[f64; 3]; 3] = [[14.6, 41.7, 350.0], [4.4, 24.3, 66.4], [1.5, 5.1, 15.1]];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = papers::outcome(bench, "case", Errors::Surface);
    for volume in LazyDataset::in_three_sizes(bench, PhantomKind::Vessels) {
        let paper = PAPER[volume.size];
        let measured = run_group(bench, &mut outcome, &volume, "iso", |dataset| {
            cases(bench, dataset, paper)
        })?;
        outcome.findings.extend(findings(&volume.name, &measured));
    }
    outcome.findings.push(
        "the paper's figures are of its own three sizes, in its order; a named volume stands beside \
         the middle one"
            .into(),
    );
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn cases(bench: &Bench, dataset: &Dataset, paper: [f64; 3]) -> Result<Vec<Case>> {
    let surface = dataset.surface(bench.preset.side_px())?;
    let (none, six) = ("none".parse::<Refine>()?, "bisection:6".parse::<Refine>()?);
    let fine = plain_steps(&surface, 1.0, none)?;
    let mut exact = surface.clone();
    exact.sampling.method = SamplingMethod::Exact;
    Ok(vec![
        Case::new("basic: step 1", unskipped(fine.clone())).paper_fps(Some(paper[0])),
        Case::new("+ skipping", fine)
            .paper_fps(Some(paper[1]))
            .same_as(0),
        Case::new(
            "+ skipping, step 1 refined",
            plain_steps(&surface, 1.0, six)?,
        ),
        Case::new("+ skipping, step 5", plain_steps(&surface, 5.0, none)?),
        Case::new(
            "+ skipping, step 5 refined",
            plain_steps(&surface, 5.0, six)?,
        )
        .paper_fps(Some(paper[2])),
        Case::new("exact", exact),
    ])
}

fn findings(volume: &str, measured: &[Measurement]) -> Vec<String> {
    let speedups: Vec<(f64, Option<f64>)> = papers::speedups(measured).collect();
    let share = |place: usize| papers::percent_missed(&measured[place]);
    let mut sentences = vec![format!(
        "{volume}: skipping alone is {:.1} times as fast as none (paper {:.1}), the picture the same",
        speedups[1].0,
        speedups[1].1.unwrap_or(f64::NAN)
    )];
    sentences.push(format!(
        "{volume}: step 5 with refinement is {:.2} times as fast as skipping alone (paper {:.1}), \
         but misses {} of the hits, where step 1 misses {}; exact casting misses {} \
         at {:.2} times step 5's time",
        measured[1].times.over(&measured[4].times),
        speedups[4]
            .1
            .zip(speedups[1].1)
            .map_or(f64::NAN, |(both, skip)| both / skip),
        share(4),
        share(1),
        share(5),
        measured[5].times.over(&measured[4].times),
    ));
    sentences
}
