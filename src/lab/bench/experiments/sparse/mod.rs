//! Rays through some of the pixels: how many, what is lost, what is gained; beside the rays that begin where their
//! neighbours met something.

mod findings;
mod measure;
mod neighbours;
mod row;
mod section;
mod way;

use super::super::papers::LazyDataset;
use super::super::{Bench, Conditions, Experiment, Outcome, Protocol};
use crate::error::Result;
use crate::lab::report::Table;
use crate::volume::PhantomKind;

use measure::{WayRow, measure};
use way::Shown;

pub const EXPERIMENT: Experiment = Experiment {
    name: "sparse",
    about: "rays through every K-th pixel and the refills between them: rays cast, vessel pixels lost, time; beside \
            rays that begin at their neighbours' depth (Belyaev et al. 2018); on the volumes named, or on a vessel \
            phantom",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

fn run(bench: &Bench) -> Result<Outcome> {
    let protocols = match bench.protocol {
        Some(protocol) => vec![protocol],
        None => Protocol::ALL.to_vec(),
    };
    let mut outcome = Outcome::of(Table::new(&row::COLUMNS));
    outcome.conditions = match bench.protocol {
        Some(_) => Conditions::usual(bench),
        // The rows say how they were timed.
        None => Conditions {
            protocol: None,
            repeats: None,
            ..Conditions::usual(bench)
        },
    };
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        for shown in Shown::ALL {
            let mut measured: Vec<(Protocol, Vec<WayRow>)> = Vec::new();
            for &protocol in &protocols {
                let key = format!("{}/{}/{protocol}", volume.name, shown.name());
                let rows = bench.unit(&key, || measure(bench, volume.get()?, shown, protocol))?;
                row::tabulate(&mut outcome.table, &volume.name, shown, protocol, &rows);
                measured.push((protocol, rows));
                bench.so_far(&outcome)?;
            }
            let place = format!("{}, {}", volume.name, shown.name());
            outcome.sections.push(section::section(&place, &measured));
            outcome.findings.extend(findings::of(&place, &measured));
            let failure = findings::failure(&place, &measured);
            outcome.failure = outcome.failure.or(failure);
        }
    }
    outcome
        .findings
        .extend(findings::conditions(bench, &protocols));
    Ok(outcome)
}
