//! What a comparison reports beside its rows: volume, device, how it was measured.

use serde_json::json;

use crate::VERSION;
use crate::gpu::Device;
use crate::lab::compare::{Compared, Comparison};
use crate::lab::measure::Peer;
use crate::lab::report::Report;

use super::super::repeat::command_line;
use super::super::source::{Loaded, Source};
use super::super::stats::{DeviceStats, VolumeStats};

/// The part of the results beside their rows.
pub fn about(
    device: &Device,
    source: &Source,
    loaded: &Loaded,
    octree_ms: f64,
    repeats: u32,
) -> serde_json::Value {
    json!({
        "version": VERSION,
        "command": "compare",
        "command_line": command_line(),
        "volume": VolumeStats::of(source.name(), &loaded.volume, loaded.non_finite),
        "device": DeviceStats::from(device.info()),
        "repeats": repeats,
        "times_ms": {
            "read": loaded.read_ms,
            "smooth": loaded.smooth_ms,
            "octree": octree_ms,
        },
    })
}

/// The page around the modes' sections.
pub fn report(
    comparison: &Comparison,
    compared: Compared,
    device: &Device,
    source: &Source,
    peers: &[Peer],
) -> Report {
    let volume = comparison.volume;
    let name = source.name().display();
    let [nx, ny, nz] = volume.dims().array();
    let spacing = volume.geometry().spacing_mm();
    let info = device.info();
    let mut facts = vec![
        ("Volume", name.to_string()),
        (
            "Voxels",
            format!(
                "{nx} × {ny} × {nz}, {}",
                volume.voxels().voxel_type().name()
            ),
        ),
        (
            "Spacing",
            format!("{:.4} × {:.4} × {:.4} mm", spacing.x, spacing.y, spacing.z),
        ),
        ("Device", info.name.clone()),
        ("Driver", format!("{}, {}", info.platform, info.driver)),
        ("Program", format!("angioray {VERSION}")),
        (
            "Protocol",
            format!(
                "one frame to warm up, then {} in turn; medians",
                comparison.repeats
            ),
        ),
    ];
    if let Some(size) = comparison
        .modes
        .first()
        .map(|mode| mode.resolved.scene.size)
    {
        facts.insert(3, ("Pictures", format!("{size} pixels")));
    }
    for peer in peers {
        let text = format!("{}, {}", peer.version(), peer.device());
        facts.push(("Compared with", format!("{} {text}", peer.name())));
    }
    Report {
        title: format!("{name}: speed against error"),
        summary: "Every picture here was drawn by several methods and compared with a reference that \
            solves the picture by its definition, in double precision. Points further down are \
            nearer to the reference, points further left are faster; the line joins the settings that \
            are worth their time: nothing more accurate is as fast."
            .into(),
        facts: facts
            .into_iter()
            .map(|(name, value)| (name.to_owned(), value))
            .collect(),
        command: command_line(),
        findings: compared.findings,
        sections: compared.sections,
    }
}
