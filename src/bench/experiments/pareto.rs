//! Speed against error over the grid of settings, and the front of those that nothing beats.

use serde::{Deserialize, Serialize};

use super::super::ways::{TestVolume, axis};
use super::super::{Bench, Conduct, Effort, Experiment, Outcome, Specimen};
use crate::error::Result;
use crate::frame::Frame;
use crate::measure::{
    Times, Tradeoff, Wrongness, family, front, grid, judge, judged_planes, scale_of,
};
use crate::options::Setting;
use crate::reference;
use crate::render::Renderer;
use crate::report::{Point, Scatter, Section, Shown, Table, figure};
use crate::scene::{Mode, Scene};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "pareto",
    about: "time against error of steps, refiners, sampling, traversals, quadratures and filters, \
            and the settings that nothing beats; on the volumes named, or on the vessel phantom",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    races: false,
    run,
};

/// Settings are timed in so many times the usual rounds: many of them are nearly as fast as each
/// other, and the front hangs on which is faster.
const PARTS: usize = 5;
const MODES: [Mode; 3] = [Mode::Iso, Mode::Mip, Mode::Dvr];

const COLUMNS: [(&str, &str, Shown); 11] = [
    ("volume", "volume", Shown::Short),
    ("mode", "mode", Shown::Short),
    ("setting", "setting", Shown::Short),
    ("median_ms", "ms", Shown::Fixed(2)),
    ("min_ms", "least", Shown::Fixed(2)),
    ("error", "error, %", Shown::Percent(4)),
    ("of", "of what", Shown::Short),
    ("color_rmse", "colour rmse, %", Shown::Percent(4)),
    ("samples_per_ray", "samples a ray", Shown::Fixed(1)),
    ("nodes_per_ray", "nodes a ray", Shown::Fixed(1)),
    ("on_front", "on the front", Shown::Short),
];

/// What is kept of a setting's picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Wrong {
    /// In the order of [`Wrongness::of_mode`], unscaled; the first of every mode is a share, or a
    /// colour's of 0 to 1.
    errors: Vec<Option<f64>>,
    samples_per_ray: f64,
    nodes_per_ray: f64,
}

/// A setting, judged and timed.
struct Placed {
    setting: Setting,
    family: String,
    wrong: Wrong,
    median_ms: f64,
    min_ms: f64,
    /// By each of the errors.
    on_front: Vec<bool>,
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conduct = Conduct {
        repeats: Some(PARTS * bench.protocol().frames(bench.effort)),
        ..Conduct::usual(bench)
    };
    for subject in TestVolume::in_one_size(bench, PhantomKind::Vessels) {
        let specimen = subject.specimen()?;
        let octree = bench.octree(specimen)?;
        let mut renderer = bench.renderer(specimen, &octree)?;
        for mode in MODES {
            let placed = place(bench, specimen, mode, &mut renderer)?;
            tabulate(&mut outcome, specimen, mode, &placed);
            bench.so_far(&outcome)?;
        }
    }
    outcome.findings.push(format!(
        "{}; here {PARTS} times as many rounds",
        bench.timed()
    ));
    Ok(outcome)
}

/// A mode's settings, each judged against the reference, all timed in turn.
fn place(
    bench: &Bench,
    specimen: &Specimen,
    mode: Mode,
    renderer: &mut Renderer,
) -> Result<Vec<Placed>> {
    let settings = grid(mode, bench.effort == Effort::Full)?;
    let seen = seen(specimen, mode);
    let side_px = bench.effort.side_px();
    let scenes: Vec<Scene> = settings
        .iter()
        .map(|setting| specimen.scene_by(side_px, &seen, setting))
        .collect::<Result<_>>()?;
    let key = |part: &str| format!("{}: {mode}: {part}", specimen.name);
    let wrongs: Vec<Wrong> = bench.unit(&key("errors"), || {
        let scene = specimen.scene(side_px, &seen)?;
        let wanted = judged_planes(&scene.picture);
        let truth = reference::render(&specimen.volume, &scene, wanted, bench.progress)?;
        let scenes = scenes.iter();
        scenes
            .map(|scene| wrong(specimen, mode, renderer, scene, &truth))
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
    let placed = settings.into_iter().zip(&scenes).zip(wrongs).zip(&times);
    let mut placed: Vec<Placed> = placed
        .map(|(((setting, scene), wrong), times)| Placed {
            family: family(scene),
            median_ms: times.median_ms(),
            min_ms: times.min_ms(),
            on_front: Vec::new(),
            setting,
            wrong,
        })
        .collect();
    for at in 0..Wrongness::of_mode(mode).len() {
        // What has no error, such as the depth's where nothing is hit, beats nothing.
        let judged = |one: &Placed| one.wrong.errors[at].is_some_and(f64::is_finite);
        let tradeoffs: Vec<Tradeoff> = placed
            .iter()
            .filter(|one| judged(one))
            .filter_map(|one| {
                Some(Tradeoff {
                    time: one.median_ms,
                    error: one.wrong.errors[at]?,
                })
            })
            .collect();
        let mut on_front = front(&tradeoffs).into_iter();
        for one in &mut placed {
            let is_on_front = judged(one) && on_front.next().unwrap_or(false);
            one.on_front.push(is_on_front);
        }
    }
    Ok(placed)
}

/// What is seen in a mode, as the text of a scene file: the specimen's surface, unshaded; the whole
/// value range; emission and absorption that rises from the iso value to a half of a voxel's path.
fn seen(specimen: &Specimen, mode: Mode) -> String {
    let (iso, range) = (specimen.iso, specimen.volume.range());
    match mode {
        Mode::Iso => format!("mode = 'iso'\niso = {iso:?}\nshading = 'none'\n"),
        Mode::Dvr => {
            let length_mm = specimen.volume.geometry().smallest_spacing_mm();
            let most = range.max.max(iso);
            format!(
                "mode = 'dvr'\n[tf]\nunit_length_mm = {length_mm:?}\n\
                 points = [[{iso:?}, 0.95, 0.8, 0.67, 0.0], [{most:?}, 0.95, 0.8, 0.67, 0.5]]\n"
            )
        }
        other => format!(
            "mode = '{other}'\nwindow = [{:?}, {:?}]\n",
            range.min, range.max
        ),
    }
}

fn wrong(
    specimen: &Specimen,
    mode: Mode,
    renderer: &mut Renderer,
    scene: &Scene,
    truth: &Frame,
) -> Result<Wrong> {
    let judged = judge(renderer, scene, truth, scale_of(&specimen.volume))?;
    let kinds = Wrongness::of_mode(mode).iter();
    Ok(Wrong {
        errors: kinds.map(|kind| kind.unscaled(&judged.figures)).collect(),
        samples_per_ray: judged.counts.samples_per_ray(),
        nodes_per_ray: judged.counts.nodes_per_ray(),
    })
}

/// A mode's rows, its plot, and its front in a sentence.
fn tabulate(outcome: &mut Outcome, specimen: &Specimen, mode: Mode, placed: &[Placed]) {
    let kinds = Wrongness::of_mode(mode);
    let color = kinds.iter().position(|kind| kind.key == "color_rmse");
    for one in placed {
        let row = vec![
            specimen.name.as_str().into(),
            mode.to_string().into(),
            one.setting.name().into(),
            one.median_ms.into(),
            one.min_ms.into(),
            one.wrong.errors[0].into(),
            kinds[0].title.into(),
            color.and_then(|at| one.wrong.errors[at]).into(),
            one.wrong.samples_per_ray.into(),
            one.wrong.nodes_per_ray.into(),
            if one.on_front[0] { "yes" } else { "" }.into(),
        ];
        if one.on_front[0] {
            outcome.table.push_on_front(row);
        } else {
            outcome.table.push(row);
        }
    }
    outcome.sections.push(Section {
        title: format!("{}, {mode}", specimen.name),
        about: format!("{} settings.", placed.len()),
        scatters: (0..kinds.len())
            .map(|at| scatter(mode, at, placed))
            .collect(),
        ..Section::default()
    });
    let mut front: Vec<&Placed> = placed.iter().filter(|one| one.on_front[0]).collect();
    front.sort_by(|a, b| a.median_ms.total_cmp(&b.median_ms));
    let front = front.iter().map(|one| {
        let error = one.wrong.errors[0].map(|error| kinds[0].scale * error);
        let error = error.map_or("none".into(), figure);
        format!(
            "{} ({} ms, {error})",
            one.setting.name(),
            figure(one.median_ms)
        )
    });
    outcome.findings.push(format!(
        "{}, {mode}: the front of time against {} ({}), of {} settings: {}",
        specimen.name,
        kinds[0].title,
        kinds[0].unit,
        placed.len(),
        front.collect::<Vec<_>>().join(", ")
    ));
}

/// Of the error that is so many-th in [`Wrongness::of_mode`].
fn scatter(mode: Mode, at: usize, placed: &[Placed]) -> Scatter {
    let kind = &Wrongness::of_mode(mode)[at];
    let point = |one: &Placed| {
        Some(Point {
            label: one.setting.name().to_owned(),
            group: one.family.clone(),
            x: one.median_ms,
            y: kind.scale * one.wrong.errors[at]?,
            on_front: one.on_front[at],
            details: vec![("flags".into(), one.setting.flags())],
        })
    };
    Scatter {
        title: format!("Time against {}", kind.title),
        x: axis("passes of a frame", "ms"),
        y: axis(kind.title, kind.unit),
        points: placed.iter().filter_map(point).collect(),
    }
}
