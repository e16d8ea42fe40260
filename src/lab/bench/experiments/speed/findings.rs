//! The findings: what the rows show, a sentence each.

use super::errors::checked_pixels;
use super::row::{beside, cores, renderer};
use super::timing::{Runner, TURN_DEG, TimedRow};
use crate::gpu::DeviceKind;
use crate::lab::bench::Bench;
use crate::lab::report::figure;

/// The findings of one picture size: what the device can sample, and the ratios to a peer.
pub fn of_rows(place: &str, rows: &[TimedRow]) -> Vec<String> {
    let mut findings = Vec::new();
    let sampling = rows.iter().filter(|row| row.runner == Runner::Sampling);
    let rates: Vec<String> = sampling
        .filter_map(|row| {
            let rate = figure(1e-6 * row.samples_per_s()?);
            Some(format!("{rate} ({})", row.setting))
        })
        .collect();
    if !rates.is_empty() {
        findings.push(format!(
            "{place}: sampling alone, million samples a second: {}",
            rates.join(", ")
        ));
    }
    let ratio = |row: &TimedRow| {
        let (peer, ratios) = beside(row, rows)?;
        let kind = row.kind?.name();
        let cpu = ratios.cpu.map(figure).unwrap_or_else(|| "unknown".into());
        let (wall, setting) = (figure(ratios.wall), &peer.setting);
        let own = &row.setting;
        Some(format!("{cpu} ({wall}) {kind} by {own} beside {setting}"))
    };
    let ratios: Vec<String> = rows.iter().filter_map(ratio).collect();
    let peer = rows
        .iter()
        .find(|row| matches!(row.runner, Runner::Peer(_)));
    if let Some(peer) = peer {
        findings.push(format!(
            "{place}: processor time (wall time) as a multiple of that of {}: {}",
            renderer(peer),
            ratios.join("; ")
        ));
    }
    findings
}

/// The findings of all rows: what was measured, and how.
pub fn conditions(bench: &Bench) -> Vec<String> {
    let device = bench.device.info();
    let mut findings = vec![
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
        "samples are those of a frame from the middle of the camera's path, with exact casting the cells \
         that were visited; their rate is over the minimum time of the cast alone, and sampling alone follows the \
         same camera's rays straight through the volume, one sample a voxel; shares of it are of its rate \
         from a buffer"
            .into(),
        format!(
            "errors are against the double-precision reference in {} pixels drawn at random of the \
             middle frame",
            checked_pixels(bench.preset)
        ),
    ];
    if bench.peer.is_none() {
        findings.push(
            "another renderer beside these rows: scripts/peers/setup.sh sets VTK up, and \
             scripts/peers/speed.sh runs this experiment with it"
                .into(),
        );
    }
    findings
}
