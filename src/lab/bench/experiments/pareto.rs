//! Speed against error over the grid of settings, and their Pareto front.

use serde::{Deserialize, Serialize};

use super::super::papers::{LazyDataset, axis};
use super::super::{Bench, Conditions, Dataset, Experiment, Outcome, Preset};
use crate::error::Result;
use crate::frame::Frame;
use crate::lab::measure::{
    RankingMetric, Times, Tradeoff, error_scale, evaluate, evaluated_planes, front, grid,
    method_label,
};
use crate::lab::report::{Point, Scatter, Section, Shown, Table, figure};
use crate::options::Setting;
use crate::reference;
use crate::render::Renderer;
use crate::scene::{Mode, Scene};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "pareto",
    about: "time against error of steps, refiners, sampling, traversals, quadratures and filters, \
            and the settings that none dominates; on the volumes named, or on the vessel phantom",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// Settings are timed in so many times the usual rounds: many of them are nearly as fast as each
/// other, and the front depends on which is faster.
const PARTS: usize = 5;
const MODES: [Mode; 3] = [Mode::Iso, Mode::Mip, Mode::Dvr];

const COLUMNS: [(&str, &str, Shown); 11] = [
    ("volume", "volume", Shown::Short),
    ("mode", "mode", Shown::Short),
    ("setting", "setting", Shown::Short),
    ("median_ms", "ms", Shown::Fixed(2)),
    ("min_ms", "min", Shown::Fixed(2)),
    ("error", "error, %", Shown::Percent(4)),
    ("of", "of what", Shown::Short),
    ("color_rmse", "colour rmse, %", Shown::Percent(4)),
    ("samples_per_ray", "samples a ray", Shown::Fixed(1)),
    ("nodes_per_ray", "nodes a ray", Shown::Fixed(1)),
    ("on_front", "on the front", Shown::Short),
];

/// The errors and counters of a setting's picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct PictureError {
    /// The errors in the order of [`RankingMetric::of_mode`], unscaled; the first of every mode is a
    /// share, or a colour's of 0 to 1.
    errors: Vec<Option<f64>>,
    samples_per_ray: f64,
    nodes_per_ray: f64,
}

/// A setting, evaluated and timed.
struct Placed {
    setting: Setting,
    family: String,
    error: PictureError,
    median_ms: f64,
    min_ms: f64,
    /// Whether the setting is on the front, for each of the errors.
    on_front: Vec<bool>,
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conditions = Conditions {
        repeats: Some(PARTS * bench.protocol().frames(bench.preset)),
        ..Conditions::usual(bench)
    };
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let dataset = volume.get()?;
        let octree = bench.octree(dataset)?;
        let mut renderer = bench.renderer(dataset, &octree)?;
        for mode in MODES {
            let placed = place(bench, dataset, mode, &mut renderer)?;
            tabulate(&mut outcome, dataset, mode, &placed);
            bench.so_far(&outcome)?;
        }
    }
    outcome.findings.push(format!(
        "{}; here {PARTS} times as many rounds",
        bench.timed()
    ));
    Ok(outcome)
}

/// A mode's settings, each evaluated against the reference, all timed in turn.
fn place(
    bench: &Bench,
    dataset: &Dataset,
    mode: Mode,
    renderer: &mut Renderer,
) -> Result<Vec<Placed>> {
    let settings = grid(mode, bench.preset == Preset::Full)?;
    let view = view(dataset, mode);
    let side_px = bench.preset.side_px();
    let scenes: Vec<Scene> = settings
        .iter()
        .map(|setting| dataset.scene_by(side_px, &view, setting))
        .collect::<Result<_>>()?;
    let key = |part: &str| format!("{}: {mode}: {part}", dataset.name);
    let errors: Vec<PictureError> = bench.unit(&key("errors"), || {
        let scene = dataset.scene(side_px, &view)?;
        let wanted = evaluated_planes(&scene);
        let reference = reference::render(&dataset.volume, &scene, wanted, bench.progress)?;
        let scenes = scenes.iter();
        scenes
            .map(|scene| error(dataset, mode, renderer, scene, &reference))
            .collect()
    })?;
    let mut times: Vec<Times> = Vec::new();
    for part in 0..PARTS {
        let part = key(&format!("times {part}"));
        let rounds: Vec<Times> = bench.unit(&part, || bench.times(renderer, &scenes))?;
        times = match times.is_empty() {
            true => rounds,
            false => times
                .into_iter()
                .zip(rounds)
                .map(|(a, b)| a.and(b))
                .collect(),
        };
    }
    let placed = settings.into_iter().zip(&scenes).zip(errors).zip(&times);
    let mut placed: Vec<Placed> = placed
        .map(|(((setting, scene), error), times)| Placed {
            family: method_label(scene),
            median_ms: times.median_ms(),
            min_ms: times.min_ms(),
            on_front: Vec::new(),
            setting,
            error,
        })
        .collect();
    for at in 0..RankingMetric::of_mode(mode).len() {
        // What has no error, such as the depth's where nothing is hit, beats nothing.
        let has_error = |one: &Placed| one.error.errors[at].is_some_and(f64::is_finite);
        let tradeoffs: Vec<Tradeoff> = placed
            .iter()
            .filter(|one| has_error(one))
            .filter_map(|one| {
                Some(Tradeoff {
                    time: one.median_ms,
                    error: one.error.errors[at]?,
                })
            })
            .collect();
        let mut on_front = front(&tradeoffs).into_iter();
        for one in &mut placed {
            let is_on_front = has_error(one) && on_front.next().unwrap_or(false);
            one.on_front.push(is_on_front);
        }
    }
    Ok(placed)
}

/// The picture of a mode, as the text of a scene file: the dataset's surface, unshaded; the whole value
/// range; or emission and absorption that rises from the iso value to a half of a voxel's path.
fn view(dataset: &Dataset, mode: Mode) -> String {
    let (iso, range) = (dataset.iso, dataset.volume.range());
    match mode {
        Mode::Iso => format!("mode = 'iso'\niso = {iso:?}\nshading = 'none'\n"),
        Mode::Dvr => {
            let length_mm = dataset.volume.geometry().smallest_spacing_mm();
            let max = range.max.max(iso);
            format!(
                "mode = 'dvr'\n[tf]\nunit_length_mm = {length_mm:?}\n\
                 points = [[{iso:?}, 0.95, 0.8, 0.67, 0.0], [{max:?}, 0.95, 0.8, 0.67, 0.5]]\n"
            )
        }
        other => format!(
            "mode = '{other}'\nwindow = [{:?}, {:?}]\n",
            range.min, range.max
        ),
    }
}

fn error(
    dataset: &Dataset,
    mode: Mode,
    renderer: &mut Renderer,
    scene: &Scene,
    reference: &Frame,
) -> Result<PictureError> {
    let evaluation = evaluate(renderer, scene, reference, error_scale(&dataset.volume))?;
    let metrics = RankingMetric::of_mode(mode).iter();
    Ok(PictureError {
        errors: metrics
            .map(|metric| metric.unscaled(&evaluation.figures))
            .collect(),
        samples_per_ray: evaluation.counts.samples_per_ray(),
        nodes_per_ray: evaluation.counts.nodes_per_ray(),
    })
}

/// A mode's rows, its plot, and its front in a sentence.
fn tabulate(outcome: &mut Outcome, dataset: &Dataset, mode: Mode, placed: &[Placed]) {
    let metrics = RankingMetric::of_mode(mode);
    let color = metrics.iter().position(|metric| metric.key == "color_rmse");
    for one in placed {
        let row = vec![
            dataset.name.as_str().into(),
            mode.to_string().into(),
            one.setting.name().into(),
            one.median_ms.into(),
            one.min_ms.into(),
            one.error.errors[0].into(),
            metrics[0].title.into(),
            color.and_then(|at| one.error.errors[at]).into(),
            one.error.samples_per_ray.into(),
            one.error.nodes_per_ray.into(),
            if one.on_front[0] { "yes" } else { "" }.into(),
        ];
        if one.on_front[0] {
            outcome.table.push_on_front(row);
        } else {
            outcome.table.push(row);
        }
    }
    outcome.sections.push(Section {
        title: format!("{}, {mode}", dataset.name),
        about: format!("{} settings.", placed.len()),
        scatters: (0..metrics.len())
            .map(|at| scatter(mode, at, placed))
            .collect(),
        ..Section::default()
    });
    let mut front: Vec<&Placed> = placed.iter().filter(|one| one.on_front[0]).collect();
    front.sort_by(|a, b| a.median_ms.total_cmp(&b.median_ms));
    let front = front.iter().map(|one| {
        let error = one.error.errors[0].map(|error| metrics[0].scale * error);
        let error = error.map_or("none".into(), figure);
        format!(
            "{} ({} ms, {error})",
            one.setting.name(),
            figure(one.median_ms)
        )
    });
    outcome.findings.push(format!(
        "{}, {mode}: the front of time against {} ({}), of {} settings: {}",
        dataset.name,
        metrics[0].title,
        metrics[0].unit,
        placed.len(),
        front.collect::<Vec<_>>().join(", ")
    ));
}

/// The scatter plot of the error at this place of [`RankingMetric::of_mode`].
fn scatter(mode: Mode, at: usize, placed: &[Placed]) -> Scatter {
    let metric = &RankingMetric::of_mode(mode)[at];
    let point = |one: &Placed| {
        Some(Point {
            label: one.setting.name().to_owned(),
            group: one.family.clone(),
            x: one.median_ms,
            y: metric.scale * one.error.errors[at]?,
            on_front: one.on_front[at],
            details: vec![("flags".into(), one.setting.flags())],
        })
    };
    Scatter {
        title: format!("Time against {}", metric.title),
        x: axis("passes of a frame", "ms"),
        y: axis(metric.title, metric.unit),
        points: placed.iter().filter_map(point).collect(),
    }
}
