//! The page about a run: its findings, its plots and pictures, its table.

use std::path::Path;

use crate::VERSION;
use crate::error::{Error, Result};
use crate::lab::report::{Gallery, Picture, Report, Section};

use super::{Bench, Conditions, Illustration, Outcome};

/// The page about a run whose pictures lie as files in `folder`.
///
/// # Errors
/// A picture that cannot be read.
pub fn report(bench: &Bench, outcome: &Outcome, folder: &Path) -> Result<Report> {
    let mut sections = outcome.sections.clone();
    let files = Illustration::files(&outcome.pictures);
    for (illustration, file) in outcome.pictures.iter().zip(files) {
        let path = folder.join(file);
        let png = std::fs::read(&path).map_err(|cause| Error::reading(&path, "read", &cause))?;
        let picture = Picture {
            label: illustration.label.clone(),
            caption: illustration.caption.clone(),
            png,
            error_map: None,
        };
        let place = sections
            .iter()
            .position(|one| one.title == illustration.section);
        let place = place.unwrap_or_else(|| {
            sections.push(Section {
                title: illustration.section.clone(),
                ..Section::default()
            });
            sections.len() - 1
        });
        let gallery = sections[place].gallery.get_or_insert_with(Gallery::default);
        gallery.pictures.push(picture);
    }
    sections.push(Section {
        title: "All figures".into(),
        table: Some(outcome.table.clone()),
        ..Section::default()
    });
    let mut findings = outcome.findings.clone();
    findings.extend(outcome.failure.clone());
    Ok(Report {
        title: format!("angioray bench {}", bench.experiment.name),
        summary: format!("What was measured: {}.", bench.experiment.about),
        facts: facts(bench, outcome.conditions),
        command: bench.command.clone(),
        findings,
        sections,
    })
}

fn facts(bench: &Bench, conditions: Conditions) -> Vec<(String, String)> {
    let device = bench.device.info();
    let volumes = bench.datasets.iter().map(|dataset| {
        let (dims, kind) = (dataset.volume.dims(), dataset.volume.voxels().voxel_type());
        let iso = crate::number_text::concise(dataset.iso);
        format!("{} ({dims} {}, iso {iso})", dataset.name, kind.name())
    });
    let volumes = match bench.datasets.is_empty() {
        true => "phantoms".to_owned(),
        false => volumes.collect::<Vec<_>>().join(", "),
    };
    let mut facts = vec![
        ("volumes", volumes),
        ("preset", bench.preset.name().to_owned()),
    ];
    if let Some(side_px) = conditions.side_px {
        facts.push(("pictures", format!("{side_px}x{side_px} pixels")));
    }
    if let Some(protocol) = conditions.protocol {
        facts.push(("protocol", protocol.to_string()));
    }
    if let Some(repeats) = conditions.repeats {
        facts.push(("repeats", repeats.to_string()));
    }
    facts.extend([
        ("device", device.name.clone()),
        ("platform", device.platform.clone()),
        ("driver", device.driver.clone()),
        ("version", VERSION.to_owned()),
    ]);
    let facts = facts.into_iter();
    facts
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}
