//! What the rows show, a sentence each.

use super::errors::judged_pixels;
use super::race::{Raced, Runner, TURN_DEG};
use super::row::{beside, cores, renderer};
use crate::bench::Bench;
use crate::gpu::DeviceKind;
use crate::report::figure;

/// Of one picture size: what the device can sample, and the ratios to a peer.
pub fn race(place: &str, rows: &[Raced]) -> Vec<String> {
    let mut told = Vec::new();
    let sampling = rows.iter().filter(|row| row.runner == Runner::Sampling);
    let rates: Vec<String> = sampling
        .filter_map(|row| {
            let rate = figure(1e-6 * row.samples_per_s()?);
            Some(format!("{rate} ({})", row.setting))
        })
        .collect();
    if !rates.is_empty() {
        told.push(format!(
            "{place}: sampling alone takes so many million samples a second: {}",
            rates.join(", ")
        ));
    }
    let ratio = |row: &Raced| {
        let (rival, ratios) = beside(row, rows)?;
        let look = row.look?.name();
        let cpu = ratios.cpu.map(figure).unwrap_or_else(|| "unknown".into());
        let (wall, setting) = (figure(ratios.wall), &rival.setting);
        let own = &row.setting;
        Some(format!("{cpu} ({wall}) {look} by {own} beside {setting}"))
    };
    let ratios: Vec<String> = rows.iter().filter_map(ratio).collect();
    let peer = rows
        .iter()
        .find(|row| matches!(row.runner, Runner::Peer(_)));
    if let Some(peer) = peer {
        told.push(format!(
            "{place}: processor time (wall time) as a multiple of that of {}: {}",
            renderer(peer),
            ratios.join("; ")
        ));
    }
    told
}

/// Of all rows: what was measured, and how.
pub fn conduct(bench: &Bench) -> Vec<String> {
    let device = bench.device.info();
    let mut told = vec![
        format!(
            "a frame is from the camera set to pixels that the host can read; all rows of a picture \
             size take turns, a frame each a round after one round to warm up; between two rounds the \
             camera turns by {TURN_DEG}°"
        ),
        format!(
            "processor time is that of all threads of this process{}, 'over cores' its median over {} \
             threads at once",
            match device.kind {
                DeviceKind::Cpu => ", the device's among them",
                _ => ", which the device is no part of",
            },
            cores()
        ),
        "samples are those of a frame from the middle of the camera's way, of exact ways the cells that \
         were walked; their rate is over the least time of the cast alone, and sampling alone follows the \
         same camera's rays straight through the volume, one sample a voxel; shares of it are of its rate \
         from a buffer"
            .into(),
        format!(
            "errors are against the double-precision reference in {} pixels drawn at random of the \
             middle frame",
            judged_pixels(bench.effort)
        ),
    ];
    if bench.peer.is_none() {
        told.push(
            "another renderer beside these rows: scripts/peers/setup.sh sets VTK up, and \
             scripts/peers/speed.sh runs this experiment with it"
                .into(),
        );
    }
    told
}
