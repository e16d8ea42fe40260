//! Whether the settings that `--max-error` chooses keep their bounds, and how near they come to the
//! fastest that do: random scenes, each against the whole picture of the reference.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::super::papers::axis;
use super::super::{Bench, Conditions, Experiment, Outcome, Preset, Protocol, random_scenes};
use crate::error::Result;
use crate::frame::error::{color_error, depth_error, value_error};
use crate::frame::{Frame, Layer, Wanted, percentile};
use crate::lab::measure::interleaved;
use crate::lab::report::{Point, Scatter, Section, Shown, Table};
use crate::lab::tolerance::{CONFIDENCE, Task, candidates, choose};
use crate::octree::{Leaf, Octree};
use crate::options::{ErrorBound, ErrorMetric, SceneOptions};
use crate::progress::{Silent, Stage};
use crate::reference;
use crate::render::Renderer;
use crate::scene::{Mode, Scene};
use crate::subject::Subject;
use crate::volume::Volume;

pub const EXPERIMENT: Experiment = Experiment {
    name: "tolerance",
    about: "whether what --max-error chooses meets its bound in random scenes, and how near it \
            comes to the fastest setting that does",
    takes_volumes: false,
    counts_rays: false,
    times_frames: false,
    takes_peer: false,
    run,
};

const COLUMNS: [(&str, &str, Shown); 11] = [
    ("mode", "mode", Shown::Short),
    ("metric", "metric", Shown::Short),
    ("scenes", "scenes", Shown::Fixed(0)),
    ("met", "reported within bound", Shown::Fixed(0)),
    ("kept", "kept", Shown::Fixed(0)),
    ("within", "within the limit given", Shown::Fixed(0)),
    (
        "in_vain",
        "within bound though reported not",
        Shown::Fixed(0),
    ),
    ("ratio_median", "time to the best, median", Shown::Fixed(2)),
    ("ratio_p95", "p95", Shown::Fixed(2)),
    ("choosing_ms", "choosing ms, median", Shown::Fixed(0)),
    ("reference_rays", "reference rays, mean", Shown::Fixed(0)),
];

/// Scenes of one volume: it is uploaded, and its kernels built, once.
const SCENES_A_VOLUME: u64 = 5;
/// Settings that one rendering shows to be more than this many times slower than the best are not
/// timed against it.
const MAX_SLOWDOWN: f64 = 1.7;

/// A choice that takes at most so many times the fastest's time is near it.
const NEAR: f64 = 1.3;
/// The rounding error of a share that is computed from another.
const ROUNDING: f64 = 1e-9;

/// A limit of colour differences so tight that the grid holds every adaptive bound.
const ANY_LIMIT: f64 = 0.0;

fn scenes(preset: Preset) -> u64 {
    match preset {
        Preset::Quick => 40,
        Preset::Usual => 200,
        Preset::Full => 500,
    }
}

/// The result of one scene.
#[derive(Serialize, Deserialize)]
struct Trial {
    mode: Mode,
    bound: ErrorBound,
    /// Whether the choice was reported to be within the bound; `kept` says whether it is.
    met: bool,
    kept: bool,
    /// Whether the error is within the reported upper limit.
    within: bool,
    /// Time of the chosen setting to that of the fastest that keeps the bound; where both do.
    ratio: Option<f64>,
    choosing_ms: f64,
    rays: u64,
    /// A sentence for the user, if the bound is broken.
    story: String,
}

fn run(bench: &Bench) -> Result<Outcome> {
    run_of(bench, scenes(bench.preset))
}

/// Runs so many scenes.
fn run_of(bench: &Bench, count: u64) -> Result<Outcome> {
    let repeats = bench.preset.repeats();
    let mut trials = Vec::new();
    let stage = Stage::begin(bench.progress, "tolerance", count);
    for number in 0..count.div_ceil(SCENES_A_VOLUME) {
        let scenes = number * SCENES_A_VOLUME..((number + 1) * SCENES_A_VOLUME).min(count);
        let key = format!("volume {number}");
        let of_volume: Vec<Trial> = bench.unit(&key, || trials_of_volume(bench, number, scenes))?;
        stage.advance(of_volume.len() as u64);
        trials.extend(of_volume);
        bench.so_far(&outcome(&trials, repeats, &bench.device.info().name))?;
    }
    Ok(outcome(&trials, repeats, &bench.device.info().name))
}

/// The trials of one random volume.
fn trials_of_volume(bench: &Bench, number: u64, scenes: Range<u64>) -> Result<Vec<Trial>> {
    let (name, volume) = random_scenes::volume(number)?;
    let octree = Octree::build(&volume, Leaf::default(), &Silent)?;
    let mut renderer = Renderer::new(bench.device, &volume, &octree, bench.options)?;
    let subject = random_scenes::subject(&volume);
    scenes
        .map(|scene| {
            Request::of(scene, &volume, &subject, bench)?.trial(&name, &mut renderer, bench)
        })
        .collect()
}

/// A random scene with a random bound.
struct Request<'a> {
    number: u64,
    volume: &'a Volume,
    subject: &'a Subject,
    options: SceneOptions,
    mode: Mode,
    bound: ErrorBound,
}

impl<'a> Request<'a> {
    /// Modes in turn, the metrics of each in turn.
    fn of(number: u64, volume: &'a Volume, subject: &'a Subject, bench: &Bench) -> Result<Self> {
        let mode = Mode::ALL[number as usize % Mode::ALL.len()];
        let mut metrics = ErrorMetric::ALL.to_vec();
        metrics.retain(|metric| metric.is_of(mode));
        let turn = number as usize / Mode::ALL.len();
        // Half as large as other experiments': hundreds of pictures are the reference's.
        let side_px = bench.preset.side_px() / 2 + (number % 5) as u32 * 16;
        let text = random_scenes::view(number, mode, side_px, subject);
        Ok(Self {
            number,
            volume,
            subject,
            options: random_scenes::options(&text)?,
            mode,
            bound: random_scenes::bound(number, metrics[turn % metrics.len()])?,
        })
    }

    fn trial(&self, name: &str, renderer: &mut Renderer, bench: &Bench) -> Result<Trial> {
        bench.check_stop()?;
        let task = Task {
            volume: self.volume,
            subject: self.subject,
            options: &self.options,
            bound: self.bound,
            wanted: Wanted::DISPLAY,
            seed: self.number,
            elsewhere: &[],
        };
        let choice = choose(&task, renderer, &Silent)?;
        let chosen = &choice.resolved.scene;
        let wanted = wanted(self.bound.metric());
        let reference = reference::render(self.volume, chosen, wanted, &Silent)?;
        let figure = self.figure_of(chosen, &reference, renderer)?;
        let kept = self.bound.is_met_by(figure);
        let timed = self.timed(&reference, renderer, bench)?;
        let ratio = match choice.met && kept && !timed.is_empty() {
            true => Some(ratio(chosen, &timed, renderer, bench)?),
            false => None,
        };
        Ok(Trial {
            mode: self.mode,
            bound: self.bound,
            met: choice.met,
            kept,
            within: match self.bound.metric() {
                ErrorMetric::Psnr => figure >= choice.upper,
                _ => figure <= choice.upper,
            },
            ratio,
            choosing_ms: choice.cost.ms,
            rays: choice.cost.rays,
            story: format!(
                "scene {} ({name}, {}, {}): {} is off by {figure:.3e}, estimated {:.3e} and at most {:.3e}",
                self.number,
                self.mode,
                self.bound,
                choice.setting.flags(),
                choice.estimate,
                choice.upper
            ),
        })
    }

    /// The figure of a scene's whole picture.
    fn figure_of(&self, scene: &Scene, reference: &Frame, renderer: &mut Renderer) -> Result<f64> {
        let metric = self.bound.metric();
        let rendering = renderer.render(scene, wanted(metric))?;
        figure(metric, reference, &rendering.frame, self.volume)
    }

    /// The settings that keep the bound, but those far slower than the fastest of them.
    fn timed(
        &self,
        reference: &Frame,
        renderer: &mut Renderer,
        bench: &Bench,
    ) -> Result<Vec<Scene>> {
        let mut retaining = Vec::new();
        for setting in candidates(self.mode, ANY_LIMIT, true)?.concat() {
            bench.check_stop()?;
            let options = setting.over(&self.options).checked()?;
            let scene = options.resolve(self.subject)?.scene;
            let figure = self.figure_of(&scene, reference, renderer)?;
            if self.bound.is_met_by(figure) {
                let ms = renderer.render(&scene, Wanted::DISPLAY)?.render_ms;
                retaining.push((scene, ms));
            }
        }
        let times = retaining.iter().map(|(_, ms)| *ms);
        let fastest = times.fold(f64::INFINITY, f64::min);
        retaining.retain(|(_, ms)| *ms <= MAX_SLOWDOWN * fastest);
        Ok(retaining.into_iter().map(|(scene, _)| scene).collect())
    }
}

/// The time of the chosen setting to that of the fastest of others, all timed in turn.
fn ratio(chosen: &Scene, others: &[Scene], renderer: &mut Renderer, bench: &Bench) -> Result<f64> {
    let timed: Vec<&Scene> = std::iter::once(chosen).chain(others).collect();
    let times = interleaved(&timed, bench.preset.repeats(), |scene| {
        bench.check_stop()?;
        Ok(renderer.render(scene, Wanted::DISPLAY)?.render_ms)
    })?;
    let best = times[1..].iter().map(|times| times.min_ms());
    Ok(times[0].min_ms() / best.fold(f64::INFINITY, f64::min))
}

/// The planes that a metric compares.
fn wanted(metric: ErrorMetric) -> Wanted {
    match metric {
        ErrorMetric::Depth | ErrorMetric::Missed => Wanted::NONE.with([Layer::Depth]),
        ErrorMetric::Value => Wanted::NONE.with([Layer::Value]),
        ErrorMetric::Rmse | ErrorMetric::Max | ErrorMetric::P99 | ErrorMetric::Psnr => {
            Wanted::DISPLAY
        }
    }
}

/// A metric's figure of whole pictures.
fn figure(metric: ErrorMetric, reference: &Frame, frame: &Frame, volume: &Volume) -> Result<f64> {
    Ok(match metric {
        ErrorMetric::Rmse => color_error(reference, frame)?.rmse,
        ErrorMetric::Max => color_error(reference, frame)?.max,
        ErrorMetric::P99 => color_error(reference, frame)?.p99,
        ErrorMetric::Psnr => color_error(reference, frame)?.psnr_db,
        ErrorMetric::Depth | ErrorMetric::Missed => {
            let error = depth_error(reference, frame, volume.geometry().smallest_spacing_mm())?;
            let off = error.missed + error.extra;
            match (metric, error.reference_hits) {
                (ErrorMetric::Depth, _) if off > 0 => f64::INFINITY,
                (ErrorMetric::Depth, _) => error.max.unwrap_or(0.0),
                (_, 0) if off > 0 => f64::INFINITY,
                (_, 0) => 0.0,
                (_, hits) => off as f64 / hits as f64,
            }
        }
        ErrorMetric::Value => {
            let error = value_error(reference, frame, volume.range().width())?;
            if error.missed + error.extra > 0 {
                f64::INFINITY
            } else {
                error.max.unwrap_or(0.0)
            }
        }
    })
}

/// The outcome of trials whose settings were timed in so many repeats on `device`.
fn outcome(trials: &[Trial], repeats: usize, device: &str) -> Outcome {
    let met = trials.iter().filter(|trial| trial.met);
    let broken = met.clone().filter(|trial| !trial.kept).count();
    let met = met.count();
    let max_broken = (1.0 - CONFIDENCE) * met as f64;
    let mut findings = findings(trials, met, broken);
    findings.push(format!(
        "times are the minimum of {repeats} repeats in turn, on {device}"
    ));
    Outcome {
        findings,
        conditions: Conditions {
            // Every scene has a size of its own.
            side_px: None,
            protocol: Some(Protocol::Static),
            repeats: Some(repeats),
        },
        sections: vec![section(trials)],
        failure: (broken as f64 > max_broken * (1.0 + ROUNDING)).then(|| {
            format!(
                "{broken} of {met} choices break the bound that they were reported to meet: more than {:.0} %",
                100.0 * (1.0 - CONFIDENCE)
            )
        }),
        ..Outcome::of(table(trials))
    }
}

/// A row for each metric of each mode.
fn table(trials: &[Trial]) -> Table {
    let mut table = Table::new(&COLUMNS);
    let of_mode = |mode| ErrorMetric::ALL.map(|metric| (mode, metric));
    for key in Mode::ALL.into_iter().flat_map(of_mode) {
        let of: Vec<&Trial> = trials
            .iter()
            .filter(|trial| (trial.mode, trial.bound.metric()) == key)
            .collect();
        if of.is_empty() {
            continue;
        }
        let count = |is: fn(&Trial) -> bool| of.iter().filter(|trial| is(trial)).count() as u64;
        let ratios = || {
            of.iter()
                .filter_map(|trial| trial.ratio)
                .collect::<Vec<_>>()
        };
        let mut choosing: Vec<f64> = of.iter().map(|trial| trial.choosing_ms).collect();
        let rays = of.iter().map(|trial| trial.rays as f64).sum::<f64>();
        let (mode, metric) = key;
        table.push(vec![
            mode.to_string().into(),
            metric.name().into(),
            (of.len() as u64).into(),
            count(|trial| trial.met).into(),
            count(|trial| trial.met && trial.kept).into(),
            count(|trial| trial.within).into(),
            count(|trial| !trial.met && trial.kept).into(),
            percentile(&mut ratios(), 50).into(),
            percentile(&mut ratios(), 95).into(),
            percentile(&mut choosing, 50).into(),
            (rays / of.len() as f64).into(),
        ]);
    }
    table
}

/// The findings of the trials: `met` of them are reported to be within the bound, of which `broken` are
/// not.
fn findings(trials: &[Trial], met: usize, broken: usize) -> Vec<String> {
    let kept = met - broken;
    let share = kept as f64 / met.max(1) as f64;
    let mut findings = vec![format!(
        "of {} random scenes {met} have a setting that is reported to meet the bound; in {kept} of \
             them ({:.1} %) the whole picture of the reference agrees",
        trials.len(),
        100.0 * share
    )];
    let mut ratios: Vec<f64> = trials.iter().filter_map(|trial| trial.ratio).collect();
    let near = ratios.iter().filter(|ratio| **ratio <= NEAR).count();
    if let (Some(median), Some(p95)) = (percentile(&mut ratios, 50), percentile(&mut ratios, 95)) {
        findings.push(format!(
            "the chosen setting takes {median:.2} (median) and {p95:.2} (p95) times as long as the \
             fastest that keeps the bound, and at most {NEAR} times in {:.1} % of {} scenes; the \
             fastest is that of the settings among which it was chosen: one that is none of them may \
             be faster",
            100.0 * near as f64 / ratios.len() as f64,
            ratios.len()
        ));
    }
    let outside: Vec<&Trial> = trials.iter().filter(|trial| !trial.within).collect();
    findings.push(format!(
        "the error is within the limit given, which {:.0} of 100 should be, in {:.1} %",
        100.0 * CONFIDENCE,
        100.0 - 100.0 * outside.len() as f64 / trials.len().max(1) as f64
    ));
    findings.extend(outside.iter().map(|trial| trial.story.clone()));
    findings
}

/// The plot of the cost of choosing against how near the choice comes to the fastest.
fn section(trials: &[Trial]) -> Section {
    let points = trials.iter().filter_map(|trial| {
        Some(Point {
            label: trial.bound.to_string(),
            group: trial.mode.to_string(),
            x: trial.choosing_ms,
            y: trial.ratio?,
            details: vec![("reference rays".into(), trial.rays.to_string())],
            ..Point::default()
        })
    });
    Section {
        title: "Choosing".into(),
        scatters: vec![Scatter {
            title: "Time to choose against how near the choice is".into(),
            x: axis("choosing", "ms"),
            y: axis("time of the chosen setting to that of the fastest", ""),
            points: points.collect(),
        }],
        ..Section::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scenes of which all but the first few keep their bounds, one in four nearly twice as slow as
    /// the fastest.
    fn trials(count: usize, broken: usize) -> Vec<Trial> {
        let trial = |number: usize| Trial {
            mode: Mode::Dvr,
            bound: ErrorBound::new(ErrorMetric::Rmse, 0.01).unwrap(),
            met: true,
            kept: number >= broken,
            within: number >= broken,
            ratio: Some(if number % 4 == 3 { 1.9 } else { 1.1 }),
            choosing_ms: 7.0,
            rays: 640,
            story: format!("scene {number} is off"),
        };
        (0..count).map(trial).collect()
    }

    #[test]
    fn more_broken_bounds_than_were_promised_are_the_failure() {
        let of = |trials: &[Trial]| outcome(trials, 3, "a device");
        for (broken, fails) in [(0, false), (1, false), (2, true)] {
            let outcome = of(&trials(100, broken));
            assert_eq!(outcome.failure.is_some(), fails, "{broken}");
            let rows = outcome.table.json();
            assert_eq!(rows[0]["met"], 100.0);
            assert_eq!(rows[0]["kept"], 100.0 - broken as f64);
            let findings = outcome.findings.join("\n");
            assert!(findings.contains("in 75.0 % of 100 scenes"), "{findings}");
            assert_eq!(findings.matches("is off").count(), broken, "{findings}");
            assert_eq!(outcome.sections[0].scatters[0].points.len(), 100);
        }
        let failure = of(&trials(100, 2)).failure.unwrap();
        assert!(failure.starts_with("2 of 100 choices"), "{failure}");
        assert!(failure.ends_with("more than 1 %"), "{failure}");

        // Where nothing was reported within bound, nothing is broken.
        let mut unmet = trials(3, 0);
        for trial in &mut unmet {
            (trial.met, trial.ratio) = (false, None);
        }
        let outcome = of(&unmet);
        assert_eq!(outcome.failure, None);
        let findings = outcome.findings.join("\n");
        assert!(!findings.contains("NaN"), "{findings}");
        assert_eq!(of(&[]).failure, None);
    }

    #[test]
    fn every_random_scene_makes_sense() {
        for number in 0..120 {
            let mode = Mode::ALL[number as usize % Mode::ALL.len()];
            let (_, volume) = random_scenes::volume(number % 8).unwrap();
            let subject = random_scenes::subject(&volume);
            let text = random_scenes::view(number, mode, 64, &subject);
            let options = random_scenes::options(&text).unwrap();
            assert_eq!(options.mode(), mode);
            options.resolve(&subject).unwrap();
            for metric in ErrorMetric::ALL {
                random_scenes::bound(number, metric).unwrap();
            }
            // The same number gives the same scene, another another.
            assert_eq!(text, random_scenes::view(number, mode, 64, &subject));
            assert_ne!(text, random_scenes::view(number + 1, mode, 64, &subject));
        }
    }
}
