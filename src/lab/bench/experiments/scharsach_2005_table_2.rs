//! Scharsach 2005, Table 2: what shading costs where light is summed along the ray.

use super::super::papers::{self, Case, Errors, LazyDataset, run_group};
use super::super::{Bench, Experiment, Outcome};
use crate::error::Result;
use crate::scene::{Phong, Picture};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b2",
    about: "emission and absorption without and with shading; three sizes (Scharsach 2005, Table 2)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The paper's frames per second for its sizes: unshaded, shaded.
const PAPER: [[f64; 2]; 3] = [[40.5, 26.7], [23.9, 11.3], [4.4, 1.5]];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = papers::outcome(bench, "case", Errors::Light);
    for volume in LazyDataset::in_three_sizes(bench, PhantomKind::Vessels) {
        let paper = PAPER[volume.size];
        let measured = run_group(bench, &mut outcome, &volume, "dvr", |dataset| {
            let plain = dataset.emission(bench.preset.side_px())?;
            let mut shaded = plain.clone();
            if let Picture::Emission(medium) = &mut shaded.picture {
                medium.phong = Some(Phong::default());
            }
            Ok(vec![
                Case::new("unshaded", plain).paper_fps(Some(paper[0])),
                Case::new("shaded", shaded).paper_fps(Some(paper[1])),
            ])
        })?;
        outcome.findings.push(format!(
            "{}: shading takes {:.2} times as long as none; in the paper {:.2} times",
            volume.name,
            measured[1].times.over(&measured[0].times),
            paper[0] / paper[1]
        ));
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}
