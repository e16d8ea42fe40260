//! Lesar et al. 2015, §IV: octree and sparse casting against marching through everything, each alone and together.

use super::super::papers::{
    self, Case, Errors, LazyDataset, Paper, percent_missed, plain_steps, run_group, sparsely,
    unskipped,
};
use super::super::{Bench, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::scene::{Refine, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b16",
    about: "isosurface through the octree, cast sparsely, and both, against marching through everything \
            (Lesar et al. 2015, section IV)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The overall speed-up that the paper reports, of octree, kd-restart and sparse casting together.
const PAPER_SPEEDUP: f64 = 1.2;

/// The cases of the octree alone and of sparse casting alone, by their places.
const RESTART: usize = 1;
const SPARSE: usize = 4;

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
            volume.name, speedups[RESTART], speedups[3]
        ));
        let lost = |case: usize| percent_missed(&measured[case]);
        outcome.findings.push(format!(
            "{}: sparse casting alone is {:.2} times as fast as marching through every pixel, with the octree by \
             kd-restart {:.2} times, with the distance map {:.2} times; it misses {} of the hits, marching {}",
            volume.name,
            speedups[SPARSE],
            speedups[SPARSE + 1],
            speedups[SPARSE + 2],
            lost(SPARSE),
            lost(0)
        ));
    }
    outcome.findings.push(
        "the paper's about 20 % are of octree, kd-restart and sparse casting together".into(),
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
    let mut both = Case::new(
        "sparse, octree, kd-restart",
        sparsely(by(Traverse::KdRestart).scene)?,
    );
    both.paper = Paper {
        fps: None,
        speedup: Some(PAPER_SPEEDUP),
    };
    let whole = unskipped(march.clone());
    let distance = sparsely(by(Traverse::Distance).scene)?;
    Ok(vec![
        Case::new("march", whole.clone()),
        by(Traverse::KdRestart),
        by(Traverse::Revelles),
        by(Traverse::Distance),
        Case::new("sparse, march", sparsely(whole)?),
        both.same_as(SPARSE),
        Case::new("sparse, octree, distance", distance).same_as(SPARSE),
    ])
}
