//! The adversarial test at any length: rays aimed where a cast loses surfaces.

use super::super::aimed::{self, Aim, Report, Tally};
use super::super::{Bench, Experiment, Outcome, Preset};
use crate::error::Result;
use crate::lab::report::{Cell, Shown, Table};
use crate::render::RayCaster;

pub const EXPERIMENT: Experiment = Experiment {
    name: "rays",
    about: "rays aimed at edges, corners, faces and tangents of random cells, every answer of the \
            exact cast checked by the reference; fails where one is wrong",
    takes_volumes: false,
    counts_rays: true,
    times_frames: false,
    takes_peer: false,
    run,
};

/// The seed of the volumes and the rays, unless the user chose another.
const SEED: u64 = 4;

const COLUMNS: [(&str, &str, Shown); 10] = [
    ("aim", "aimed at", Shown::Short),
    ("rays", "rays", Shown::Fixed(0)),
    ("hits", "hits", Shown::Fixed(0)),
    ("missed", "missed", Shown::Fixed(0)),
    ("extra", "extra", Shown::Fixed(0)),
    ("displaced", "displaced", Shown::Fixed(0)),
    ("wrongly_proven", "wrongly proven", Shown::Fixed(0)),
    ("borderline", "borderline", Shown::Fixed(0)),
    ("undecided", "undecided", Shown::Fixed(0)),
    ("most_apart_voxels", "depth max, voxels", Shown::Short),
];

fn count(bench: &Bench) -> u64 {
    bench.rays.unwrap_or(match bench.preset {
        Preset::Quick => 1_000_000,
        Preset::Usual => 10_000_000,
        Preset::Full => 100_000_000,
    })
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut report = Report::default();
    let seed = bench.seed.unwrap_or(SEED);
    let mut caster = RayCaster::new(bench.device, bench.options.lanes);
    bench.progress.begin("aimed rays", count(bench));
    for (number, rays) in aimed::targets(count(bench)) {
        let at_target = bench.unit(&format!("target {number}"), || {
            aimed::at_target(&mut caster, seed, number, rays)
        })?;
        report = report.and(at_target);
        bench.progress.advance(rays);
        bench.so_far(&outcome(&report))?;
    }
    bench.progress.end();
    Ok(outcome(&report))
}

fn outcome(report: &Report) -> Outcome {
    let total = report.total();
    let mut table = Table::new(&COLUMNS);
    let named = Aim::ALL.into_iter().map(Aim::name).zip(report.tallies);
    for (aim, tally) in named.chain([("all", total)]) {
        table.push(row(aim, &tally));
    }
    let mut findings = vec![format!(
        "{} of {} rays wrong; {} borderline: the reference itself answers so a hair beside them",
        total.wrong(),
        total.rays,
        total.borderline
    )];
    findings.extend(report.wrong.iter().cloned());
    let failure = (total.wrong() > 0).then(|| {
        format!(
            "{} of {} rays were answered wrong",
            total.wrong(),
            total.rays
        )
    });
    Outcome {
        findings,
        failure,
        ..Outcome::of(table)
    }
}

fn row(aim: &str, tally: &Tally) -> Vec<Cell> {
    vec![
        aim.into(),
        tally.rays.into(),
        tally.hits.into(),
        tally.missed.into(),
        tally.extra.into(),
        tally.displaced.into(),
        tally.wrongly_proven.into(),
        tally.borderline.into(),
        tally.undecided.into(),
        tally.max_apart.into(),
    ]
}
