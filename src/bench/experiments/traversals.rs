//! The ways through the octree as rivals: the same pictures, at what cost.

use super::super::compare::same_picture;
use super::super::{Bench, Experiment, Outcome, Specimen};
use crate::error::Result;
use crate::frame::{Frame, Wanted};
use crate::measure::Times;
use crate::report::{Shown, Table};
use crate::scene::{SamplingMethod, Scene, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "traversals",
    about: "times and counters of the ways through the octree, which must all give the same bytes; \
            on the volumes named, or on the vessel phantom",
    takes_volumes: true,
    counts_rays: false,
    run,
};

/// What the others are held against.
const RIVAL: Traverse = Traverse::Uniform;

const COLUMNS: [(&str, &str, Shown); 9] = [
    ("volume", "volume", Shown::Short),
    ("picture", "picture", Shown::Short),
    ("traverse", "traversal", Shown::Short),
    ("min_ms", "ms, least", Shown::Fixed(2)),
    ("median_ms", "median", Shown::Fixed(2)),
    ("ratio", "to uniform", Shown::Fixed(3)),
    ("nodes_per_ray", "nodes a ray", Shown::Fixed(1)),
    ("samples_per_ray", "samples a ray", Shown::Fixed(1)),
    ("same_bytes", "same bytes", Shown::Short),
];

fn run(bench: &Bench) -> Result<Outcome> {
    let phantom;
    let specimens = if bench.specimens.is_empty() {
        phantom = [Specimen::phantom(PhantomKind::Vessels)?];
        &phantom
    } else {
        bench.specimens.as_slice()
    };
    let mut outcome = Outcome {
        table: Table::new(&COLUMNS),
        findings: Vec::new(),
        failure: None,
    };
    // Of every picture, the logarithms of its ratios to the rival.
    let mut logs = [0.0; Traverse::ALL.len()];
    for specimen in specimens {
        let octree = bench.octree(specimen)?;
        let mut renderer = bench.renderer(specimen, &octree)?;
        for (name, scene) in pictures(specimen, bench.effort.side_px())? {
            let scenes = Traverse::ALL.map(|traverse| by(&scene, traverse));
            let frames: Vec<Frame> = scenes
                .iter()
                .map(|scene| Ok(renderer.render(scene, Wanted::ALL)?.frame))
                .collect::<Result<_>>()?;
            let times = bench.times(&mut renderer, &scenes)?;
            for (log, times_of) in logs.iter_mut().zip(&times) {
                *log += times_of.over(&times[place(RIVAL)]).ln();
            }
            let fastest = fastest(times.iter().map(Times::min_ms));
            outcome.findings.push(format!(
                "{}, {name}: {fastest} is the fastest",
                specimen.name
            ));
            if !tabulate(&mut outcome.table, specimen, name, &frames, &times) {
                outcome.failure = Some(format!(
                    "{}, {name}: the traversals give different pictures",
                    specimen.name
                ));
            }
        }
    }
    outcome.findings.push(format!(
        "{} is the fastest of all, by the mean of the ratios",
        fastest(logs)
    ));
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn place(traverse: Traverse) -> usize {
    let found = Traverse::ALL.iter().position(|other| *other == traverse);
    found.unwrap_or(0)
}

/// Of figures in the order of [`Traverse::ALL`], whose is least.
fn fastest(figures: impl IntoIterator<Item = f64>) -> Traverse {
    let figures = Traverse::ALL.into_iter().zip(figures);
    let least = figures.min_by(|(_, a), (_, b)| a.total_cmp(b));
    least.map_or(RIVAL, |(traverse, _)| traverse)
}

fn by(scene: &Scene, traverse: Traverse) -> Scene {
    let mut scene = scene.clone();
    scene.sampling.traverse = traverse;
    scene
}

/// Every kind of cast: exact and at the default steps, and emission under its default rule.
fn pictures(specimen: &Specimen, side_px: u32) -> Result<[(&'static str, Scene); 5]> {
    let sampled = |mut scene: Scene, method| {
        scene.sampling.method = method;
        scene
    };
    let surface = specimen.surface(side_px)?;
    let maximum = specimen.maximum(side_px)?;
    Ok([
        (
            "iso, exact",
            sampled(surface.clone(), SamplingMethod::Exact),
        ),
        ("iso, fixed", sampled(surface, SamplingMethod::Fixed)),
        (
            "mip, exact",
            sampled(maximum.clone(), SamplingMethod::Exact),
        ),
        ("mip, fixed", sampled(maximum, SamplingMethod::Fixed)),
        ("dvr", specimen.emission(side_px)?),
    ])
}

/// Appends a picture's rows; gives whether all traversals made the same.
fn tabulate(
    table: &mut Table,
    specimen: &Specimen,
    picture: &str,
    frames: &[Frame],
    times: &[Times],
) -> bool {
    let rival = place(RIVAL);
    let mut all_same = true;
    for ((traverse, frame), times_of) in Traverse::ALL.iter().zip(frames).zip(times) {
        let rays = frame.size.pixels() as f64;
        let a_ray = |counts: &Option<Vec<u32>>| {
            let counts = counts.iter().flatten();
            counts.map(|&n| f64::from(n)).sum::<f64>() / rays
        };
        let same = same_picture(frame, &frames[rival]);
        all_same &= same;
        table.push(vec![
            specimen.name.as_str().into(),
            picture.into(),
            traverse.to_string().into(),
            times_of.min_ms().into(),
            times_of.median_ms().into(),
            times_of.over(&times[rival]).into(),
            a_ray(&frame.nodes).into(),
            a_ray(&frame.steps).into(),
            if same { "yes" } else { "no" }.into(),
        ]);
    }
    all_same
}
