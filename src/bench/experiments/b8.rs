//! Ruijters and Vilanova 2006, Figure 6: the smallest node of the octree.

use super::super::ways::{self, Errors, TestVolume, Way, run_group};
use super::super::{Bench, Effort, Experiment, Outcome, Specimen};
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
    races: false,
    run,
};

/// Cells.
fn edges(effort: Effort) -> &'static [u32] {
    match effort {
        Effort::Quick => &[4, 8, 16, 32],
        Effort::Usual | Effort::Full => &[4, 6, 8, 12, 16, 24, 32],
    }
}

/// Not the distance map, whose leaves know how far around them nothing is: the paper's octree has
/// levels.
const TRAVERSE: Traverse = Traverse::KdRestart;

fn run(bench: &Bench) -> Result<Outcome> {
    let edges = edges(bench.effort);
    let mut outcome = ways::outcome(bench, "traversal", Errors::Light);
    for subject in TestVolume::in_one_size(bench, PhantomKind::Vessels) {
        for traverse in [TRAVERSE, Traverse::Distance] {
            let case = traverse.to_string();
            let found = run_group(bench, &mut outcome, &subject, &case, |specimen| {
                list(bench, specimen, traverse, edges)
            })?;
            let times = edges.iter().zip(&found);
            let best =
                times.min_by(|(_, a), (_, b)| a.times.median_ms().total_cmp(&b.times.median_ms()));
            if let Some((edge, best)) = best {
                let worst = found.iter().map(|one| one.times.over(&best.times));
                outcome.findings.push(format!(
                    "{}, {case}: leaves of {edge} cells are the fastest, the slowest take {:.2} \
                     times as long; the paper finds an optimum for every device and gives no number \
                     that would hold for all",
                    subject.name,
                    worst.fold(1.0, f64::max)
                ));
            }
        }
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn list(bench: &Bench, specimen: &Specimen, traverse: Traverse, edges: &[u32]) -> Result<Vec<Way>> {
    let mut scene: Scene = specimen.emission(bench.effort.side_px())?;
    scene.sampling.traverse = traverse;
    let ways = edges.iter().enumerate().map(|(place, &edge)| {
        Ok(Way {
            leaf: Leaf::new(edge)?,
            same_as: (place > 0).then_some(0),
            ..Way::new(format!("leaf {edge}"), scene.clone())
        })
    });
    ways.collect()
}
