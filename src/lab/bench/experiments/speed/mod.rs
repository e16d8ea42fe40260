//! What a whole frame takes in each mode, from the camera set to pixels that the host can read, beside
//! its error, beside what the device can sample at most, and beside another renderer.

mod candidate;
mod errors;
mod findings;
mod medium;
mod picture;
mod row;
mod section;
mod timing;

use super::super::papers::LazyDataset;
use super::super::{Bench, Experiment, Outcome, Preset};
use crate::error::Result;
use crate::lab::measure::Peer;

use candidate::candidates;
use timing::{Lineup, time_all};

pub const EXPERIMENT: Experiment = Experiment {
    name: "speed",
    about: "whole frames of every mode: wall and processor time, samples a second as a share of what \
            the device can sample at most, error; with --peer the ratio to another renderer; on the \
            volumes named, or on noisy vessel phantoms",
    takes_volumes: true,
    counts_rays: false,
    times_frames: false,
    takes_peer: true,
    run,
};

/// Voxels along each side of the phantoms.
fn volume_sides(preset: Preset) -> [u32; 2] {
    match preset {
        Preset::Quick => [64, 128],
        Preset::Usual | Preset::Full => [256, 512],
    }
}

/// Pixels along each side of the pictures.
fn picture_sides(preset: Preset) -> [u32; 2] {
    match preset {
        Preset::Quick => [128, 256],
        Preset::Usual | Preset::Full => [512, 1024],
    }
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut peer = bench.peer.as_deref().map(Peer::start).transpose()?;
    let mut outcome = Outcome::of(row::table(peer.is_some()));
    for volume in LazyDataset::scans(bench, &volume_sides(bench.preset)) {
        let sides = picture_sides(bench.preset);
        let media = bench.unit(&format!("{}: media", volume.name), || {
            medium::choose(bench, volume.get()?, sides[0])
        })?;
        outcome
            .findings
            .extend(media.iter().map(|one| one.finding(&volume.name)));
        for side_px in sides {
            let place = format!("{}, {side_px}x{side_px}", volume.name);
            let rows = bench.unit(&place, || {
                let dataset = volume.get()?;
                time_all(Lineup {
                    bench,
                    dataset,
                    candidates: &candidates(dataset, side_px, &media)?,
                    peer: peer.as_mut(),
                })
            })?;
            row::tabulate(&mut outcome.table, &volume.name, side_px, &rows);
            outcome.sections.push(section::section(&place, &rows));
            outcome.findings.extend(findings::of_rows(&place, &rows));
            bench.so_far(&outcome)?;
        }
    }
    outcome.findings.extend(findings::conditions(bench));
    Ok(outcome)
}
