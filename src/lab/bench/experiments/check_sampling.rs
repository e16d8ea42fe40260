//! Whether `--check-sampling` is right: random scenes at random steps, its verdicts against the pictures' true errors.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::super::{Bench, Experiment, Outcome, Preset, random_scenes, rng::Rng};
use crate::error::{Error, Result};
use crate::frame::Wanted;
use crate::frame::error::differing_share;
use crate::lab::measure::SamplingCheck;
use crate::lab::report::{Cell, Shown, Table};
use crate::number_text::concise;
use crate::octree::{Leaf, Octree};
use crate::progress::{Silent, Stage};
use crate::reference;
use crate::render::Renderer;
use crate::scene::{Mode, QuadratureMethod, Scene, StepVoxels};
use crate::subject::Subject;
use crate::volume::Volume;

pub const EXPERIMENT: Experiment = Experiment {
    name: "check-sampling",
    about: "whether --check-sampling is right: in random scenes at random steps, how often it finds a step too coarse that \
            the reference shows to be, how often one that is not, and whether the steps that it advises will do",
    takes_volumes: false,
    counts_rays: false,
    times_frames: false,
    takes_peer: false,
    run,
};

const COLUMNS: [(&str, &str, Shown); 9] = [
    ("mode", "mode", Shown::Short),
    ("scenes", "scenes", Shown::Fixed(0)),
    ("coarse", "too coarse", Shown::Fixed(0)),
    ("found", "of them found", Shown::Fixed(0)),
    ("missed", "missed", Shown::Fixed(0)),
    ("fine", "fine enough", Shown::Fixed(0)),
    ("false_alarms", "of them false alarms", Shown::Fixed(0)),
    ("advised", "finer steps advised", Shown::Fixed(0)),
    (
        "advised_coarse",
        "of them still too coarse",
        Shown::Fixed(0),
    ),
];

/// Scenes of one volume: it is uploaded, and its kernels built, once.
const SCENES_A_VOLUME: u64 = 5;

/// The steps, in voxels, from which a scene's is picked.
const STEPS: [f64; 2] = [0.25, 4.0];

/// The share of wrong verdicts beyond which the experiment fails.
const MAX_WRONG: f64 = 0.2;

fn scenes(preset: Preset) -> u64 {
    match preset {
        Preset::Quick => 20,
        Preset::Usual => 200,
        Preset::Full => 1000,
    }
}

/// The verdict on one scene, and the truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Trial {
    mode: Mode,
    /// The share of pixels that two shifts differ in.
    share: f64,
    /// The share of pixels that are visibly not the reference's.
    true_share: f64,
    /// The true share with the finer step that was advised, where one was.
    advised_share: Option<f64>,
}

impl Trial {
    fn alarms(&self) -> bool {
        self.share > SamplingCheck::LIMIT
    }

    /// Whether the verdict would be wrong if an alarm began at another share.
    fn is_wrong_at(&self, limit: f64) -> bool {
        (self.share > limit) != self.is_coarse()
    }

    fn is_coarse(&self) -> bool {
        self.true_share > SamplingCheck::LIMIT
    }
}

fn run(bench: &Bench) -> Result<Outcome> {
    let count = scenes(bench.preset);
    let mut trials = Vec::new();
    let stage = Stage::begin(bench.progress, "scenes", count);
    for number in 0..count.div_ceil(SCENES_A_VOLUME) {
        let scenes = number * SCENES_A_VOLUME..((number + 1) * SCENES_A_VOLUME).min(count);
        let key = format!("volume {number}");
        let of_volume: Vec<Trial> = bench.unit(&key, || trials_of_volume(bench, number, scenes))?;
        stage.advance(of_volume.len() as u64);
        trials.extend(of_volume);
        bench.so_far(&outcome(&trials))?;
    }
    Ok(outcome(&trials))
}

/// The trials of one random volume.
fn trials_of_volume(bench: &Bench, number: u64, scenes: Range<u64>) -> Result<Vec<Trial>> {
    let (_, volume) = random_scenes::volume(number)?;
    let octree = Octree::build(&volume, Leaf::default(), &Silent)?;
    let mut renderer = Renderer::new(bench.device, &volume, &octree, bench.options)?;
    let subject = random_scenes::subject(&volume);
    scenes
        .map(|number| {
            bench.check_stop()?;
            let scene = scene(number, bench.preset.side_px() / 2, &subject)?;
            trial(&scene, &volume, &mut renderer)
        })
        .collect()
}

/// A random view in a mode, modes in turn, at a random step; of surfaces and extrema half are probed for, of surfaces
/// half refined.
fn scene(number: u64, side_px: u32, subject: &Subject) -> Result<Scene> {
    let mode = Mode::ALL[number as usize % Mode::ALL.len()];
    let mut text = random_scenes::view(number, mode, side_px, subject);
    let mut rng = Rng::new(!number);
    let [finest, coarsest] = STEPS;
    text += &format!("step = {:?}\n", rng.by_magnitude(finest, coarsest));
    if !matches!(mode, Mode::Dvr | Mode::Mean) && rng.one_in(2) {
        text += "probe = 'off'\n";
    }
    if mode == Mode::Iso && rng.one_in(2) {
        text += "refine = 'none'\n";
    }
    if mode == Mode::Dvr {
        let stepped = QuadratureMethod::ALL.into_iter();
        let stepped: Vec<_> = stepped
            .filter(|one| *one != QuadratureMethod::Adaptive)
            .collect();
        let method = stepped[rng.below(stepped.len() as u32) as usize];
        text += &format!("quad = '{method}'\n");
    }
    let resolved = random_scenes::options(&text)?.resolve(subject);
    Ok(resolved
        .map_err(|error| Error::failed(format!("{error}: {text}")))?
        .scene)
}

fn trial(scene: &Scene, volume: &Volume, renderer: &mut Renderer) -> Result<Trial> {
    let check = SamplingCheck::of(renderer, scene)?;
    let reference = reference::render(volume, scene, Wanted::DISPLAY, &Silent)?;
    let mut true_share = |step| {
        let mut scene = scene.clone();
        scene.sampling.step = StepVoxels::new(step)?;
        let frame = renderer.render(&scene, Wanted::DISPLAY)?.frame;
        differing_share(&reference, &frame, SamplingCheck::LEVEL)
    };
    let finer = check.advised_step.filter(|step| *step < check.step);
    Ok(Trial {
        mode: scene.picture.mode(),
        share: check.share,
        true_share: true_share(check.step)?,
        advised_share: finer.map(true_share).transpose()?,
    })
}

/// How many of some trials are what.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Tally {
    scenes: u64,
    coarse: u64,
    found: u64,
    false_alarms: u64,
    advised: u64,
    advised_coarse: u64,
}

impl Tally {
    fn of<'a>(trials: impl Iterator<Item = &'a Trial>) -> Self {
        let mut tally = Self::default();
        for trial in trials {
            let advised = trial.advised_share;
            tally.scenes += 1;
            tally.coarse += u64::from(trial.is_coarse());
            tally.found += u64::from(trial.is_coarse() && trial.alarms());
            tally.false_alarms += u64::from(!trial.is_coarse() && trial.alarms());
            tally.advised += u64::from(advised.is_some());
            let is_coarse = advised.is_some_and(|share| share > SamplingCheck::LIMIT);
            tally.advised_coarse += u64::from(is_coarse);
        }
        tally
    }

    fn missed(&self) -> u64 {
        self.coarse - self.found
    }

    fn fine(&self) -> u64 {
        self.scenes - self.coarse
    }

    fn row(&self, mode: &str) -> Vec<Cell> {
        vec![
            mode.into(),
            self.scenes.into(),
            self.coarse.into(),
            self.found.into(),
            self.missed().into(),
            self.fine().into(),
            self.false_alarms.into(),
            self.advised.into(),
            self.advised_coarse.into(),
        ]
    }
}

/// A row for each mode, and one for all.
fn outcome(trials: &[Trial]) -> Outcome {
    let mut table = Table::new(&COLUMNS);
    for mode in Mode::ALL {
        let of_mode = Tally::of(trials.iter().filter(|trial| trial.mode == mode));
        if of_mode.scenes > 0 {
            table.push(of_mode.row(mode.name()));
        }
    }
    let all = Tally::of(trials.iter());
    table.push(all.row("all"));
    let percent = |count: u64, of: u64| 100.0 * count as f64 / of.max(1) as f64;
    let limit = 100.0 * SamplingCheck::LIMIT;
    let findings = vec![
        format!(
            "of {} scenes whose step is too coarse (more than {limit} % of the pixels off by more than 1/255) {:.0} % \
             are found; of {} that are fine enough {:.0} % are false alarms",
            all.coarse,
            percent(all.found, all.coarse),
            all.fine(),
            percent(all.false_alarms, all.fine())
        ),
        format!(
            "{:.0} % of {} finer steps advised are too coarse still",
            percent(all.advised_coarse, all.advised),
            all.advised
        ),
        format!(
            "verdicts that would be wrong if an alarm began at another share: {}",
            other_limits(trials)
        ),
    ];
    Outcome {
        failure: failure(&all),
        findings,
        ..Outcome::of(table)
    }
}

/// The wrong verdicts by the share at which an alarm begins.
fn other_limits(trials: &[Trial]) -> String {
    let at = |times: &f64| {
        let limit = times * SamplingCheck::LIMIT;
        let wrong = trials.iter().filter(|trial| trial.is_wrong_at(limit));
        format!("{} at {} %", wrong.count(), concise(100.0 * limit))
    };
    let limits = [0.25, 0.5, 1.0, 2.0, 4.0];
    limits.iter().map(at).collect::<Vec<_>>().join(", ")
}

fn failure(all: &Tally) -> Option<String> {
    if all.coarse == 0 || all.fine() == 0 {
        return Some("every step is of one kind: nothing was tried".into());
    }
    let wrong = all.missed() + all.false_alarms;
    (wrong as f64 > MAX_WRONG * all.scenes as f64).then(|| {
        format!(
            "{wrong} of {} verdicts are wrong: more than {:.0} %",
            all.scenes,
            100.0 * MAX_WRONG
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missed_and_what_is_alarmed_in_vain_is_counted() {
        let trial = |share, true_share| Trial {
            mode: Mode::Mip,
            share,
            true_share,
            advised_share: Some(share),
        };
        let right = [trial(0.5, 0.5), trial(0.0, 0.0), trial(0.3, 0.2)];
        assert_eq!(outcome(&right).failure, None);
        let findings = outcome(&right).findings.join("\n");
        assert!(
            findings.contains("0 at 1 %, 0 at 2 %, 0 at 4 %"),
            "{findings}"
        );
        let missed = outcome(&[right.as_slice(), &[trial(0.0, 0.5)]].concat());
        let row = missed.table.json()[1].clone();
        assert_eq!((&row["coarse"], &row["found"]), (&3.0.into(), &2.0.into()));
        assert_eq!(row["missed"], 1.0);
        assert!(missed.failure.is_some());
        let in_vain = outcome(&[right.as_slice(), &[trial(0.5, 0.0)]].concat());
        assert_eq!(in_vain.table.json()[1]["false_alarms"], 1.0);
        assert!(in_vain.failure.is_some());
        // Where nothing is too coarse, or everything, no verdict means anything.
        assert!(outcome(&right[..1]).failure.is_some());
        assert!(outcome(&right[1..2]).failure.is_some());
    }
}
