//! Scharsach 2005, Figures 4 and 5; Lesar et al. 2015, Figure 3: refinement on and off.

use super::super::papers::{self, Case, Errors, LazyDataset, Measurement, plain_steps, run_group};
use super::super::{Bench, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::scene::{Refine, SamplingMethod};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b3",
    about: "isosurface at steps of 1 and 5 voxels, each without and with refinement (Scharsach \
            2005, Figures 4 and 5; Lesar et al. 2015, Figure 3)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

const STEPS: [f64; 2] = [1.0, 5.0];
const REFINERS: [&str; 3] = ["none", "bisection:6", "regula-falsi:5"];
/// The paper's frames per second: step 1 unrefined, and step 5 with six bisections.
const PAPER: [(f64, &str, f64); 2] = [(1.0, "none", 24.3), (5.0, "bisection:6", 66.4)];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = papers::outcome(bench, "case", Errors::Surface);
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let measured = run_group(bench, &mut outcome, &volume, "iso", |dataset| {
            cases(bench, dataset)
        })?;
        outcome.findings.push(finding(&volume.name, &measured));
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn cases(bench: &Bench, dataset: &Dataset) -> Result<Vec<Case>> {
    let surface = dataset.surface(bench.preset.side_px())?;
    let mut cases = Vec::new();
    for step in STEPS {
        for refiner in REFINERS {
            let of_paper = PAPER.iter().find(|(s, r, _)| (*s, *r) == (step, refiner));
            let scene = plain_steps(&surface, step, refiner.parse::<Refine>()?)?;
            let case = Case::new(format!("step {step}, {refiner}"), scene);
            cases.push(case.paper_fps(of_paper.map(|(_, _, fps)| *fps)));
        }
    }
    let mut exact = surface;
    exact.sampling.method = SamplingMethod::Exact;
    cases.push(Case::new("exact", exact));
    Ok(cases)
}

fn finding(volume: &str, measured: &[Measurement]) -> String {
    let of = |place: usize| measured[place].surface;
    let mean = |place: usize| match of(place).and_then(|s| s.depth_mean) {
        Some(mean) => format!("{mean:.3}"),
        None => "none (no hits)".into(),
    };
    let missed = |place: usize| papers::percent_missed(&measured[place]);
    format!(
        "{volume}: six bisections bring the mean depth error from {} to {} voxels at step 5, \
         from {} to {} at step 1; what is left is of rays that stepped over a surface and met \
         another behind it. They bring no hit back: {} are missed at step 5 and {} at step 1, \
         refined or not; 'no visible difference' at step 5 holds where nothing thin is missed",
        mean(3),
        mean(4),
        mean(0),
        mean(1),
        missed(4),
        missed(1),
    )
}
