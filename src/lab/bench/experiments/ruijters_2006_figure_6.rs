//! Ruijters and Vilanova 2006, Figure 6: the smallest node of the octree.

use super::super::papers::{self, Case, Errors, LazyDataset, run_group};
use super::super::{Bench, Dataset, Experiment, Outcome, Preset};
use crate::error::Result;
use crate::octree::Leaf;
use crate::scene::{Scene, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b8",
    about: "the edge of the octree's finest nodes: which is the fastest (Ruijters and Vilanova \
            2006, Figure 6)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The leaf edges that are measured, in cells.
fn edges(preset: Preset) -> &'static [u32] {
    match preset {
        Preset::Quick => &[4, 8, 16, 32],
        Preset::Usual | Preset::Full => &[4, 6, 8, 12, 16, 24, 32],
    }
}

/// The traversal that is measured. Not the distance map, whose leaves know how far around them nothing
/// is: the paper's octree has levels.
const TRAVERSE: Traverse = Traverse::KdRestart;

fn run(bench: &Bench) -> Result<Outcome> {
    let edges = edges(bench.preset);
    let mut outcome = papers::outcome(bench, "traversal", Errors::Light);
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        for traverse in [TRAVERSE, Traverse::Distance] {
            let series = traverse.to_string();
            let measured = run_group(bench, &mut outcome, &volume, &series, |dataset| {
                cases(bench, dataset, traverse, edges)
            })?;
            let times = edges.iter().zip(&measured);
            let best =
                times.min_by(|(_, a), (_, b)| a.times.median_ms().total_cmp(&b.times.median_ms()));
            if let Some((edge, best)) = best {
                let worst = measured.iter().map(|one| one.times.over(&best.times));
                outcome.findings.push(format!(
                    "{}, {series}: leaves of {edge} cells are the fastest, the slowest take {:.2} \
                     times as long; the paper finds an optimum for every device and gives no number \
                     that would hold for all",
                    volume.name,
                    worst.fold(1.0, f64::max)
                ));
            }
        }
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn cases(bench: &Bench, dataset: &Dataset, traverse: Traverse, edges: &[u32]) -> Result<Vec<Case>> {
    let mut scene: Scene = dataset.emission(bench.preset.side_px())?;
    scene.sampling.traverse = traverse;
    let cases = edges.iter().enumerate().map(|(index, &edge)| {
        Ok(Case {
            leaf: Leaf::new(edge)?,
            same_as: (index > 0).then_some(0),
            ..Case::new(format!("leaf {edge}"), scene.clone())
        })
    });
    cases.collect()
}
