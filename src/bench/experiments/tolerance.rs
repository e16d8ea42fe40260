//! Whether the settings that `--max-error` chooses keep their bounds, and how near they come to the
//! fastest that would: random scenes, each against the whole picture of the reference.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::super::ways::axis;
use super::super::{Bench, Conduct, Effort, Experiment, Outcome, Protocol, random};
use crate::error::Result;
use crate::frame::error::{color_error, depth_error, value_error};
use crate::frame::{Frame, Wanted, percentile};
use crate::measure::interleaved;
use crate::octree::{Leaf, Octree};
use crate::options::{ErrorBound, ErrorMetric, SceneOptions};
use crate::progress::{Silent, Stage};
use crate::reference;
use crate::render::Renderer;
use crate::report::{Point, Scatter, Section, Shown, Table};
use crate::scene::{Mode, Scene};
use crate::subject::Subject;
use crate::tolerance::{CONFIDENCE, Task, candidates, choose};
use crate::volume::Volume;

pub const EXPERIMENT: Experiment = Experiment {
    name: "tolerance",
    about: "whether what --max-error chooses keeps its bound in random scenes, and how near it \
            comes to the fastest setting that does",
    takes_volumes: false,
    counts_rays: false,
    times_frames: false,
    races: false,
    run,
};

const COLUMNS: [(&str, &str, Shown); 11] = [
    ("mode", "mode", Shown::Short),
    ("metric", "metric", Shown::Short),
    ("scenes", "scenes", Shown::Fixed(0)),
    ("met", "said to be kept", Shown::Fixed(0)),
    ("kept", "kept", Shown::Fixed(0)),
    ("within", "within the limit told", Shown::Fixed(0)),
    ("in_vain", "kept though said not to be", Shown::Fixed(0)),
    ("ratio_median", "time to the best, median", Shown::Fixed(2)),
    ("ratio_p95", "p95", Shown::Fixed(2)),
    ("choosing_ms", "choosing ms, median", Shown::Fixed(0)),
    ("reference_rays", "reference rays, mean", Shown::Fixed(0)),
];

/// Scenes of one volume: it is uploaded, and its kernels built, once.
const SCENES_A_VOLUME: u64 = 5;
/// Settings that one rendering shows to be this many times slower than the best are not timed
/// against it.
const HOPELESS: f64 = 1.7;

/// A choice that takes at most so many times the fastest's time is near it.
const NEAR: f64 = 1.3;
/// Of a share that is computed from another.
const ROUNDING: f64 = 1e-9;

/// Of colour differences, so tight that the grid holds every adaptive bound.
const ANY_LIMIT: f64 = 0.0;

fn scenes(effort: Effort) -> u64 {
    match effort {
        Effort::Quick => 40,
        Effort::Usual => 200,
        Effort::Full => 500,
    }
}

/// How one scene went.
#[derive(Serialize, Deserialize)]
struct Trial {
    mode: Mode,
    bound: ErrorBound,
    /// Whether the choice was said to keep the bound, and whether it does.
    met: bool,
    kept: bool,
    /// Whether its error is within the upper limit that was told.
    within: bool,
    /// Time of the chosen setting to that of the fastest that keeps the bound; where both do.
    ratio: Option<f64>,
    choosing_ms: f64,
    rays: u64,
    /// For the user, where the bound is not kept.
    story: String,
}

fn run(bench: &Bench) -> Result<Outcome> {
    run_of(bench, scenes(bench.effort))
}

/// Of so many scenes.
fn run_of(bench: &Bench, count: u64) -> Result<Outcome> {
    let repeats = bench.effort.repeats();
    let mut trials = Vec::new();
    let stage = Stage::begin(bench.progress, "tolerance", count);
    for number in 0..count.div_ceil(SCENES_A_VOLUME) {
        let scenes = number * SCENES_A_VOLUME..((number + 1) * SCENES_A_VOLUME).min(count);
        let key = format!("volume {number}");
        let of_volume: Vec<Trial> = bench.unit(&key, || of_volume(bench, number, scenes))?;
        stage.advance(of_volume.len() as u64);
        trials.extend(of_volume);
        bench.so_far(&outcome(&trials, repeats, &bench.device.info().name))?;
    }
    Ok(outcome(&trials, repeats, &bench.device.info().name))
}

/// The trials of one random volume.
fn of_volume(bench: &Bench, number: u64, scenes: Range<u64>) -> Result<Vec<Trial>> {
    let (name, volume) = random::volume(number)?;
    let octree = Octree::build(&volume, Leaf::default(), &Silent)?;
    let mut renderer = Renderer::new(bench.device, &volume, &octree, bench.options)?;
    let subject = random::subject(&volume);
    scenes
        .map(|scene| Asked::of(scene, &volume, &subject, bench)?.trial(&name, &mut renderer, bench))
        .collect()
}

/// A random scene with a random bound.
struct Asked<'a> {
    number: u64,
    volume: &'a Volume,
    subject: &'a Subject,
    options: SceneOptions,
    mode: Mode,
    bound: ErrorBound,
}

impl<'a> Asked<'a> {
    /// Modes in turn, the metrics of each in turn.
    fn of(number: u64, volume: &'a Volume, subject: &'a Subject, bench: &Bench) -> Result<Self> {
        let mode = Mode::ALL[number as usize % Mode::ALL.len()];
        let mut metrics = ErrorMetric::ALL.to_vec();
        metrics.retain(|metric| metric.is_of(mode));
        let turn = number as usize / Mode::ALL.len();
        // Half as large as other experiments': hundreds of pictures are the reference's.
        let side_px = bench.effort.side_px() / 2 + (number % 5) as u32 * 16;
        let text = random::view(number, mode, side_px, subject);
        Ok(Self {
            number,
            volume,
            subject,
            options: random::options(&text)?,
            mode,
            bound: random::bound(number, metrics[turn % metrics.len()])?,
        })
    }

    fn trial(&self, name: &str, renderer: &mut Renderer, bench: &Bench) -> Result<Trial> {
        bench.check_stop()?;
        let shown = Wanted::DISPLAY;
        let task = Task {
            volume: self.volume,
            subject: self.subject,
            options: &self.options,
            bound: self.bound,
            wanted: shown,
            seed: self.number,
            elsewhere: &[],
        };
        let choice = choose(&task, renderer, &Silent)?;
        let chosen = &choice.resolved.scene;
        let wanted = wanted(self.bound.metric());
        let truth = reference::render(self.volume, chosen, wanted, &Silent)?;
        let mut keeping = Vec::new();
        let kept_by = |renderer: &mut Renderer, scene: &Scene| -> Result<(bool, f64)> {
            let rendering = renderer.render(scene, wanted)?;
            let figure = figure(self.bound.metric(), &truth, &rendering.frame, self.volume)?;
            Ok((self.bound.is_met_by(figure), figure))
        };
        let (kept, figure) = kept_by(renderer, chosen)?;
        for setting in candidates(self.mode, ANY_LIMIT)?.concat() {
            bench.check_stop()?;
            let options = setting.over(&self.options).checked()?;
            let scene = options.resolve(self.subject)?.scene;
            if kept_by(renderer, &scene)?.0 {
                let ms = renderer.render(&scene, shown)?.render_ms;
                keeping.push((scene, ms));
            }
        }
        let fastest = keeping
            .iter()
            .map(|(_, ms)| *ms)
            .fold(f64::INFINITY, f64::min);
        let mut timed = vec![chosen];
        let hopeful = keeping.iter().filter(|(_, ms)| *ms <= HOPELESS * fastest);
        timed.extend(hopeful.map(|(scene, _)| scene));
        let ratio = if choice.met && kept && timed.len() > 1 {
            let times = interleaved(&timed, bench.effort.repeats(), |scene| {
                bench.check_stop()?;
                Ok(renderer.render(scene, shown)?.render_ms)
            })?;
            let best = times[1..].iter().map(|times| times.min_ms());
            Some(times[0].min_ms() / best.fold(f64::INFINITY, f64::min))
        } else {
            None
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
}

/// The planes that a metric compares.
fn wanted(metric: ErrorMetric) -> Wanted {
    let geometry = matches!(metric, ErrorMetric::Depth | ErrorMetric::Missed);
    Wanted {
        display: !geometry && metric != ErrorMetric::Value,
        depth: geometry,
        value: metric == ErrorMetric::Value,
        ..Wanted::default()
    }
}

/// A metric's figure of whole pictures.
fn figure(metric: ErrorMetric, truth: &Frame, frame: &Frame, volume: &Volume) -> Result<f64> {
    Ok(match metric {
        ErrorMetric::Rmse => color_error(truth, frame)?.rmse,
        ErrorMetric::Max => color_error(truth, frame)?.max,
        ErrorMetric::P99 => color_error(truth, frame)?.p99,
        ErrorMetric::Psnr => color_error(truth, frame)?.psnr_db,
        ErrorMetric::Depth | ErrorMetric::Missed => {
            let error = depth_error(truth, frame, volume.geometry().smallest_spacing_mm())?;
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
            let error = value_error(truth, frame, volume.range().width())?;
            if error.missed + error.extra > 0 {
                f64::INFINITY
            } else {
                error.max.unwrap_or(0.0)
            }
        }
    })
}

/// Of trials whose settings were timed in so many repeats on `device`.
fn outcome(trials: &[Trial], repeats: usize, device: &str) -> Outcome {
    let mut table = Table::new(&COLUMNS);
    for mode in Mode::ALL {
        for metric in ErrorMetric::ALL {
            let of: Vec<&Trial> = trials
                .iter()
                .filter(|trial| (trial.mode, trial.bound.metric()) == (mode, metric))
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
    }
    let met = trials.iter().filter(|trial| trial.met);
    let broken: Vec<&Trial> = met.clone().filter(|trial| !trial.kept).collect();
    let met = met.count();
    let kept = met - broken.len();
    let share = kept as f64 / met.max(1) as f64;
    let most_broken = (1.0 - CONFIDENCE) * met as f64;
    let mut ratios: Vec<f64> = trials.iter().filter_map(|trial| trial.ratio).collect();
    let mut findings = vec![format!(
        "of {} random scenes {met} have a setting that is said to keep the bound; in {kept} of \
             them ({:.1} %) the whole picture of the reference agrees",
        trials.len(),
        100.0 * share
    )];
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
        "the error is within the limit told, which {:.0} of 100 should be, in {:.1} %",
        100.0 * CONFIDENCE,
        100.0 - 100.0 * outside.len() as f64 / trials.len().max(1) as f64
    ));
    findings.extend(outside.iter().map(|trial| trial.story.clone()));
    findings.push(format!(
        "times are the least of {repeats} repeats in turn, on {device}"
    ));
    Outcome {
        findings,
        conduct: Conduct {
            // Every scene has a size of its own.
            side_px: None,
            protocol: Some(Protocol::Static),
            repeats: Some(repeats),
        },
        sections: vec![section(trials)],
        failure: (broken.len() as f64 > most_broken * (1.0 + ROUNDING)).then(|| {
            format!(
                "{} of {met} choices break the bound that they were said to keep: more than {:.0} %",
                broken.len(),
                100.0 * (1.0 - CONFIDENCE)
            )
        }),
        ..Outcome::of(table)
    }
}

/// What choosing costs, against how near the choice comes to the fastest.
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
            let told = outcome.findings.join("\n");
            assert!(told.contains("in 75.0 % of 100 scenes"), "{told}");
            assert_eq!(told.matches("is off").count(), broken, "{told}");
            assert_eq!(outcome.sections[0].scatters[0].points.len(), 100);
        }
        let failure = of(&trials(100, 2)).failure.unwrap();
        assert!(failure.starts_with("2 of 100 choices"), "{failure}");
        assert!(failure.ends_with("more than 1 %"), "{failure}");

        // Where nothing was said to be kept, nothing is broken.
        let mut unmet = trials(3, 0);
        for trial in &mut unmet {
            (trial.met, trial.ratio) = (false, None);
        }
        let outcome = of(&unmet);
        assert_eq!(outcome.failure, None);
        let told = outcome.findings.join("\n");
        assert!(!told.contains("NaN"), "{told}");
        assert_eq!(of(&[]).failure, None);
    }

    #[test]
    fn every_random_scene_makes_sense() {
        for number in 0..120 {
            let mode = Mode::ALL[number as usize % Mode::ALL.len()];
            let (_, volume) = random::volume(number % 8).unwrap();
            let subject = random::subject(&volume);
            let text = random::view(number, mode, 64, &subject);
            let options = random::options(&text).unwrap();
            assert_eq!(options.mode(), mode);
            options.resolve(&subject).unwrap();
            for metric in ErrorMetric::ALL {
                random::bound(number, metric).unwrap();
            }
            // The same number gives the same scene, another another.
            assert_eq!(text, random::view(number, mode, 64, &subject));
            assert_ne!(text, random::view(number + 1, mode, 64, &subject));
        }
    }
}
