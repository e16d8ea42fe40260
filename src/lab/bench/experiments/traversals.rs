//! The traversals of the octree beside each other: the same pictures, at what cost.

use serde::{Deserialize, Serialize};

use super::super::papers::{LazyDataset, axis};
use super::super::{Bench, Conditions, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::frame::{Frame, Wanted};
use crate::lab::measure::{Counts, Times};
use crate::lab::report::{Point, Scatter, Section, Shown, Table};
use crate::render::Renderer;
use crate::scene::{SamplingMethod, Scene, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "traversals",
    about: "times and counters of the traversals of the octree, which must all give the same bytes; \
            on the volumes named, or on the vessel phantom",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The traversal that the others are compared with.
const BASELINE: Traverse = Traverse::Uniform;

const COLUMNS: [(&str, &str, Shown); 9] = [
    ("volume", "volume", Shown::Short),
    ("picture", "picture", Shown::Short),
    ("traverse", "traversal", Shown::Short),
    ("min_ms", "ms, min", Shown::Fixed(2)),
    ("median_ms", "median", Shown::Fixed(2)),
    ("ratio", "to uniform", Shown::Fixed(3)),
    ("nodes_per_ray", "nodes a ray", Shown::Fixed(1)),
    ("samples_per_ray", "samples a ray", Shown::Fixed(1)),
    ("same_bytes", "same bytes", Shown::Short),
];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conditions = Conditions::usual(bench);
    // Of every picture, the logarithms of its ratios to the baseline.
    let mut logs = [0.0; Traverse::ALL.len()];
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let dataset = volume.get()?;
        let mut points = Vec::new();
        let octree = bench.octree(dataset)?;
        let mut renderer = bench.renderer(dataset, &octree)?;
        for (name, scene) in pictures(dataset, bench.preset.side_px())? {
            let measured = bench.unit(&format!("{}/{name}", dataset.name), || {
                measure(bench, &mut renderer, &scene)
            })?;
            let baseline = &measured[index_of(BASELINE)].times;
            for (log, one) in logs.iter_mut().zip(&measured) {
                *log += one.times.over(baseline).ln();
            }
            let fastest = fastest(measured.iter().map(|one| one.times.min_ms()));
            outcome.findings.push(format!(
                "{}, {name}: {fastest} is the fastest",
                dataset.name
            ));
            if !tabulate(&mut outcome.table, dataset, name, &measured) {
                outcome.failure = Some(format!(
                    "{}, {name}: the traversals give different pictures",
                    dataset.name
                ));
            }
            points.extend(plotted(name, &measured));
            bench.so_far(&outcome)?;
        }
        outcome.sections.push(Section {
            title: dataset.name.clone(),
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

fn index_of(traverse: Traverse) -> usize {
    let found = Traverse::ALL.iter().position(|other| *other == traverse);
    found.unwrap_or(0)
}

/// The traversal of the smallest of figures in the order of [`Traverse::ALL`].
fn fastest(figures: impl IntoIterator<Item = f64>) -> Traverse {
    let figures = Traverse::ALL.into_iter().zip(figures);
    let smallest = figures.min_by(|(_, a), (_, b)| a.total_cmp(b));
    smallest.map_or(BASELINE, |(traverse, _)| traverse)
}

fn by(scene: &Scene, traverse: Traverse) -> Scene {
    let mut scene = scene.clone();
    scene.sampling.traverse = traverse;
    scene
}

/// Every kind of cast: exact and at the default steps, and emission under its default rule.
fn pictures(dataset: &Dataset, side_px: u32) -> Result<[(&'static str, Scene); 5]> {
    let sampled = |mut scene: Scene, method| {
        scene.sampling.method = method;
        scene
    };
    let surface = dataset.surface(side_px)?;
    let maximum = dataset.maximum(side_px)?;
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
        ("dvr", dataset.emission(side_px)?),
    ])
}

/// One traversal of one picture.
#[derive(Serialize, Deserialize)]
struct Measurement {
    times: Times,
    nodes_per_ray: f64,
    samples_per_ray: f64,
    /// Whether the picture equals the baseline's.
    same: bool,
}

/// Measures the traversals in the order of [`Traverse::ALL`].
fn measure(bench: &Bench, renderer: &mut Renderer, scene: &Scene) -> Result<Vec<Measurement>> {
    let scenes = Traverse::ALL.map(|traverse| by(scene, traverse));
    let frames: Vec<Frame> = scenes
        .iter()
        .map(|scene| Ok(renderer.render(scene, Wanted::ALL)?.frame))
        .collect::<Result<_>>()?;
    let times = bench.times(renderer, &scenes)?;
    let measured = frames.iter().zip(times).map(|(frame, times)| {
        let counts = Counts::of(frame, &scene.picture, frame.size.pixels() as u64);
        Measurement {
            times,
            nodes_per_ray: counts.nodes_per_ray(),
            samples_per_ray: counts.samples_per_ray(),
            same: frame.bit_equal(&frames[index_of(BASELINE)]),
        }
    });
    Ok(measured.collect())
}

/// A picture's traversals as points of a plot.
fn plotted<'a>(picture: &'a str, measured: &'a [Measurement]) -> impl Iterator<Item = Point> + 'a {
    let measured = Traverse::ALL.iter().zip(measured);
    measured.map(move |(traverse, one)| Point {
        label: format!("{picture}, {traverse}"),
        group: picture.to_owned(),
        x: one.times.median_ms(),
        y: one.nodes_per_ray,
        ..Point::default()
    })
}

/// Appends a picture's rows; returns whether all traversals made the same picture.
fn tabulate(table: &mut Table, dataset: &Dataset, picture: &str, measured: &[Measurement]) -> bool {
    let baseline = &measured[index_of(BASELINE)].times;
    for (traverse, one) in Traverse::ALL.iter().zip(measured) {
        table.push(vec![
            dataset.name.as_str().into(),
            picture.into(),
            traverse.to_string().into(),
            one.times.min_ms().into(),
            one.times.median_ms().into(),
            one.times.over(baseline).into(),
            one.nodes_per_ray.into(),
            one.samples_per_ray.into(),
            if one.same { "yes" } else { "no" }.into(),
        ]);
    }
    measured.iter().all(|one| one.same)
}
