//! Lesar et al. 2015, §IV: the octree against marching through everything.

use super::super::papers::{
    self, Case, Errors, LazyDataset, Paper, plain_steps, run_group, unskipped,
};
use super::super::{Bench, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::scene::{Refine, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b16",
    about: "isosurface through the octree against marching through everything, the picture the \
            same (Lesar et al. 2015, section IV)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The overall speed-up that the paper reports.
const PAPER_SPEEDUP: f64 = 1.2;

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = papers::outcome(bench, "case", Errors::Surface);
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let measured = run_group(bench, &mut outcome, &volume, "iso", |dataset| {
            cases(bench, dataset)
        })?;
        let speedups: Vec<f64> = papers::speedups(&measured).map(|(ours, _)| ours).collect();
        outcome.findings.push(format!(
            "{}: the octree by kd-restart is {:.2} times as fast as marching through everything, the \
             distance map {:.2} times; the picture is the same to the last bit",
            volume.name, speedups[1], speedups[3]
        ));
    }
    outcome.findings.push(
        "the paper's about 20 % are of octree, kd-restart and sparse casting together; sparse casting \
         is not part of this program"
            .into(),
    );
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn cases(bench: &Bench, dataset: &Dataset) -> Result<Vec<Case>> {
    let surface = dataset.surface(bench.preset.side_px())?;
    let march = plain_steps(&surface, 0.5, "regula-falsi:5".parse::<Refine>()?)?;
    let by = |traverse: Traverse| {
        let mut scene = march.clone();
        scene.sampling.traverse = traverse;
        Case::new(format!("octree, {traverse}"), scene).same_as(0)
    };
    let mut restart = by(Traverse::KdRestart);
    restart.paper = Paper {
        fps: None,
        speedup: Some(PAPER_SPEEDUP),
    };
    Ok(vec![
        Case::new("march", unskipped(march.clone())),
        restart,
        by(Traverse::Revelles),
        by(Traverse::Distance),
    ])
}
