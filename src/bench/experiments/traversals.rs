//! The ways through the octree as rivals: the same pictures, at what cost.

use serde::{Deserialize, Serialize};

use super::super::ways::{TestVolume, axis};
use super::super::{Bench, Conduct, Experiment, Outcome, Specimen};
use crate::error::Result;
use crate::frame::{Frame, Wanted};
use crate::measure::{Counts, Times};
use crate::render::Renderer;
use crate::report::{Point, Scatter, Section, Shown, Table};
use crate::scene::{SamplingMethod, Scene, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "traversals",
    about: "times and counters of the ways through the octree, which must all give the same bytes; \
            on the volumes named, or on the vessel phantom",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    races: false,
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
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conduct = Conduct::usual(bench);
    // Of every picture, the logarithms of its ratios to the rival.
    let mut logs = [0.0; Traverse::ALL.len()];
    for subject in TestVolume::in_one_size(bench, PhantomKind::Vessels) {
        let specimen = subject.specimen()?;
        let mut points = Vec::new();
        let octree = bench.octree(specimen)?;
        let mut renderer = bench.renderer(specimen, &octree)?;
        for (name, scene) in pictures(specimen, bench.effort.side_px())? {
            let found = bench.unit(&format!("{}/{name}", specimen.name), || {
                measure(bench, &mut renderer, &scene)
            })?;
            let rival = &found[place(RIVAL)].times;
            for (log, one) in logs.iter_mut().zip(&found) {
                *log += one.times.over(rival).ln();
            }
            let fastest = fastest(found.iter().map(|one| one.times.min_ms()));
            outcome.findings.push(format!(
                "{}, {name}: {fastest} is the fastest",
                specimen.name
            ));
            if !tabulate(&mut outcome.table, specimen, name, &found) {
                outcome.failure = Some(format!(
                    "{}, {name}: the traversals give different pictures",
                    specimen.name
                ));
            }
            points.extend(plotted(name, &found));
            bench.so_far(&outcome)?;
        }
        outcome.sections.push(Section {
            title: specimen.name.clone(),
            about: "The pictures are the same whatever the traversal.".into(),
            scatters: vec![Scatter {
                title: "Time against nodes visited".into(),
                x: axis("time", "ms"),
                y: axis("nodes a ray", ""),
                points,
            }],
            ..Section::default()
        });
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

/// One traversal of one picture.
#[derive(Serialize, Deserialize)]
struct Found {
    times: Times,
    nodes_per_ray: f64,
    samples_per_ray: f64,
    /// Whether the picture is the rival's.
    same: bool,
}

/// In the order of [`Traverse::ALL`].
fn measure(bench: &Bench, renderer: &mut Renderer, scene: &Scene) -> Result<Vec<Found>> {
    let scenes = Traverse::ALL.map(|traverse| by(scene, traverse));
    let frames: Vec<Frame> = scenes
        .iter()
        .map(|scene| Ok(renderer.render(scene, Wanted::ALL)?.frame))
        .collect::<Result<_>>()?;
    let times = bench.times(renderer, &scenes)?;
    let found = frames.iter().zip(times).map(|(frame, times)| {
        let counts = Counts::of(frame, &scene.picture);
        Found {
            times,
            nodes_per_ray: counts.nodes_per_ray(),
            samples_per_ray: counts.samples_per_ray(),
            same: frame.shows_the_same(&frames[place(RIVAL)]),
        }
    });
    Ok(found.collect())
}

/// A picture's traversals as points of a plot.
fn plotted<'a>(picture: &'a str, found: &'a [Found]) -> impl Iterator<Item = Point> + 'a {
    let found = Traverse::ALL.iter().zip(found);
    found.map(move |(traverse, one)| Point {
        label: format!("{picture}, {traverse}"),
        group: picture.to_owned(),
        x: one.times.median_ms(),
        y: one.nodes_per_ray,
        ..Point::default()
    })
}

/// Appends a picture's rows; gives whether all traversals made the same.
fn tabulate(table: &mut Table, specimen: &Specimen, picture: &str, found: &[Found]) -> bool {
    let rival = &found[place(RIVAL)].times;
    for (traverse, one) in Traverse::ALL.iter().zip(found) {
        table.push(vec![
            specimen.name.as_str().into(),
            picture.into(),
            traverse.to_string().into(),
            one.times.min_ms().into(),
            one.times.median_ms().into(),
            one.times.over(rival).into(),
            one.nodes_per_ray.into(),
            one.samples_per_ray.into(),
            if one.same { "yes" } else { "no" }.into(),
        ]);
    }
    found.iter().all(|one| one.same)
}
