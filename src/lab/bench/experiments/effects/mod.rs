//! Occlusion, shadows and depth of field: the error of each effect against what it costs, over its own settings.

mod effect;
mod findings;
mod measure;
mod row;
mod section;

use super::super::papers::LazyDataset;
use super::super::{Bench, Conditions, Experiment, Outcome, Preset};
use crate::error::Result;
use crate::lab::report::{Section, Table};
use crate::volume::PhantomKind;

use effect::{EFFECTS, Shown};
use measure::{Tried, measure};

pub const EXPERIMENT: Experiment = Experiment {
    name: "effects",
    about: "ambient occlusion, shadows and depth of field over their settings: the error of each against the reference \
            beside its time; on the volumes named, or on a vessel phantom",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// Width and height of the pictures, smaller than other experiments': the reference sends hundreds of rays from each hit or
/// through each pixel.
fn side_px(preset: Preset) -> u32 {
    match preset {
        Preset::Quick => 96,
        Preset::Usual => 192,
        Preset::Full => 384,
    }
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&row::COLUMNS));
    outcome.conditions = Conditions {
        side_px: Some(side_px(bench.preset)),
        ..Conditions::usual(bench)
    };
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        for shown in Shown::ALL {
            let place = format!("{}, {}", volume.name, shown.name());
            let mut section = Section {
                title: place.clone(),
                about: section::ABOUT.into(),
                ..Section::default()
            };
            for effect in EFFECTS.iter().filter(|effect| effect.shown == shown) {
                let key = format!("{place}/{}", effect.name);
                let tried: Vec<Tried> =
                    bench.unit(&key, || measure(bench, volume.get()?, effect))?;
                row::tabulate(
                    &mut outcome.table,
                    &volume.name,
                    (shown, effect.name),
                    &tried,
                );
                section.scatters.push(section::scatter(effect, &tried));
                outcome
                    .findings
                    .extend(findings::of(&place, effect, &tried));
                bench.so_far(&outcome)?;
            }
            outcome.sections.push(section);
        }
    }
    outcome.findings.extend(findings::conditions(bench));
    Ok(outcome)
}
