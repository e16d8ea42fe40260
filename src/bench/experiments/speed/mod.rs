//! What a whole frame takes in each mode, from the camera set to pixels that the host can read, beside
//! its error, beside what the device can sample at most, and beside another renderer.

mod contender;
mod errors;
mod medium;
mod race;
mod row;
mod told;

use super::super::ways::TestVolume;
use super::super::{Bench, Effort, Experiment, Outcome};
use crate::error::Result;
use crate::measure::Peer;

use contender::contenders;
use race::{Entrants, race};

pub const EXPERIMENT: Experiment = Experiment {
    name: "speed",
    about: "whole frames of every mode: wall and processor time, samples a second as a share of what \
            the device can sample at most, error; with --peer the ratio to another renderer; on the \
            volumes named, or on noisy vessel phantoms",
    takes_volumes: true,
    counts_rays: false,
    times_frames: false,
    races: true,
    run,
};

/// Voxels along each side of the phantoms.
fn volume_sides(effort: Effort) -> [u32; 2] {
    match effort {
        Effort::Quick => [64, 128],
        Effort::Usual | Effort::Full => [256, 512],
    }
}

/// Pixels along each side of the pictures.
fn picture_sides(effort: Effort) -> [u32; 2] {
    match effort {
        Effort::Quick => [128, 256],
        Effort::Usual | Effort::Full => [512, 1024],
    }
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut peer = bench.peer.as_deref().map(Peer::start).transpose()?;
    let mut outcome = Outcome::of(row::table(peer.is_some()));
    for subject in TestVolume::scans(bench, &volume_sides(bench.effort)) {
        let sides = picture_sides(bench.effort);
        let media = bench.unit(&format!("{}: media", subject.name), || {
            medium::choose(bench, subject.specimen()?, sides[0])
        })?;
        outcome
            .findings
            .extend(media.iter().map(|one| one.told(&subject.name)));
        for side_px in sides {
            let place = format!("{}, {side_px}x{side_px}", subject.name);
            let raced = bench.unit(&place, || {
                let specimen = subject.specimen()?;
                race(Entrants {
                    bench,
                    specimen,
                    contenders: &contenders(specimen, side_px, &media)?,
                    peer: peer.as_mut(),
                })
            })?;
            row::tabulate(&mut outcome.table, &subject.name, side_px, &raced);
            outcome.findings.extend(told::race(&place, &raced));
            bench.so_far(&outcome)?;
        }
    }
    outcome.findings.extend(told::conduct(bench));
    Ok(outcome)
}
