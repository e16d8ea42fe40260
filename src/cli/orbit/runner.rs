//! Makes the frames of an orbit, one after another, until all are finished or a stop is requested.

use crate::batch::{Destination, Provenance, Shot, Written, pipelined};
use crate::error::{Error, ErrorKind, Result};
use crate::frame::{Reel, Wanted};
use crate::lab::tolerance::Choice;
use crate::progress::{Progress, Silent};
use crate::scene::{Camera, Orbit, Scene};
use crate::stop;

use super::super::backend::{Backend, Caster};
use super::super::job::Job;
use super::super::progress::Bars;
use super::super::source::Loaded;
use super::super::tolerance::choose;
use super::frame_record::FrameRecord;
use super::frames::Frames;
use super::plan::Plan;

/// Frames on which a choice by `--max-error` is verified beside the first.
const VERIFIED_BESIDE: u32 = 3;

/// Everything that the frames of an orbit depend on.
pub struct OrbitRunner<'a> {
    pub plan: &'a Plan,
    pub job: &'a Job,
    pub backend: &'a Backend,
    pub loaded: &'a Loaded,
    pub from: &'a Provenance,
    pub bars: &'a Bars,
}

/// The frames that were made.
pub struct OrbitOutcome {
    /// The frames, under the setting that was chosen if one was.
    pub frames: Frames,
    pub chosen: Option<Choice>,
    pub written: Vec<Written<FrameRecord>>,
    /// Why the rest was not made.
    pub stopped: Option<Error>,
}

impl OrbitOutcome {
    fn nothing(frames: Frames, stopped: Option<Error>) -> Self {
        Self {
            frames,
            chosen: None,
            written: Vec::new(),
            stopped,
        }
    }
}

impl OrbitRunner<'_> {
    /// The frames, of those of this process, that are not finished yet.
    pub fn missing(&self, frames: &Frames, mine: &[u32]) -> Result<Vec<u32>> {
        if !self.plan.resume {
            return Ok(mine.to_vec());
        }
        self.bars.begin("looking", mine.len() as u64);
        let mut missing = Vec::new();
        for &index in mine {
            let seen = frames.at(index);
            let scene = seen.options.to_toml()?;
            // After a stop nothing is made, so that it does not matter which.
            let is_there = !stop::requested()
                && (self.plan.destination).holds(index, seen.scene.size, &scene, self.from);
            if !is_there {
                missing.push(index);
            }
            self.bars.advance(1);
        }
        self.bars.end();
        Ok(missing)
    }

    /// Makes the missing frames.
    ///
    /// # Errors
    /// Anything but a stop between two pictures, which is part of what was made.
    pub fn make(&self, mut frames: Frames, missing: &[u32]) -> Result<OrbitOutcome> {
        if missing.is_empty() {
            let nothing = OrbitOutcome::nothing(frames, None);
            self.join(&nothing.frames)?;
            return Ok(nothing);
        }
        let check = |chosen| self.check_stop(chosen, 0, missing.len());
        if let Err(stopped) = check(None) {
            return Ok(OrbitOutcome::nothing(frames, Some(stopped)));
        }
        self.plan.destination.make_folder()?;
        let (loaded, bars) = (self.loaded, self.bars);
        let prepared = self
            .backend
            .prepare(&loaded.volume, &self.job.source, bars)?;
        let mut caster = self.backend.caster(&loaded.volume, &prepared)?;
        let chosen = match stop::over_failure(self.choose(&frames, &mut caster), || check(None)) {
            Err(stopped) if stopped.kind() == ErrorKind::Stopped => {
                return Ok(OrbitOutcome::nothing(frames, Some(stopped)));
            }
            chosen => chosen?,
        };
        if let Some(choice) = &chosen {
            frames = Frames::new(choice.resolved.clone(), self.plan)?;
        }
        let (written, stopped) = self.write(&frames, missing, chosen.as_ref(), &mut caster)?;
        Ok(OrbitOutcome {
            frames,
            chosen,
            written,
            stopped,
        })
    }

    /// Writes an animation all of whose frames are finished.
    fn join(&self, frames: &Frames) -> Result<()> {
        let destination = &self.plan.destination;
        if let Destination::Animation { .. } = destination {
            let first = frames.first();
            let scene = first.options.to_toml()?;
            let none = &mut std::iter::empty::<Result<Shot<()>>>();
            destination.write(self.reel(&first.scene), self.from, &scene, none)?;
        }
        Ok(())
    }

    /// All frames, by the scene of the first.
    fn reel(&self, first: &Scene) -> Reel {
        Reel {
            size: first.size,
            frames: self.plan.frames.get(),
        }
    }

    /// Chooses a setting for the error bound, if there is one.
    fn choose(&self, frames: &Frames, caster: &mut Caster<'_>) -> Result<Option<Choice>> {
        let Some(bound) = self.job.bound else {
            return Ok(None);
        };
        let (options, wanted) = (&self.job.options, self.wanted());
        let elsewhere = spread(&frames.orbit);
        choose(
            bound,
            options,
            self.loaded,
            wanted,
            &elsewhere,
            caster,
            self.bars,
        )
    }

    fn wanted(&self) -> Wanted {
        Wanted::for_encoding(&self.plan.encoding, self.plan.stats.is_some())
    }

    /// Renders frames one after another, and encodes each beside the rendering of the next. Pictures
    /// that are finished when it is stopped stay; an animation without its end is an error, its frames
    /// being saved.
    fn write(
        &self,
        frames: &Frames,
        missing: &[u32],
        chosen: Option<&Choice>,
        caster: &mut Caster<'_>,
    ) -> Result<(Vec<Written<FrameRecord>>, Option<Error>)> {
        let first = frames.first();
        let scene = first.options.to_toml()?;
        let reel = self.reel(&first.scene);
        let wanted = self.wanted();
        let destination = &self.plan.destination;
        let mut stopped = None;
        self.bars.begin("frames", missing.len() as u64);
        let mut shot = |made: usize, index: u32| {
            let check = || self.check_stop(chosen, made, missing.len());
            check()?;
            let seen = frames.at(index);
            let rendered = caster.render(&seen.scene, wanted, &Silent);
            let rendered = stop::over_failure(rendered, check)?;
            self.bars.advance(1);
            let scene = seen.options.to_toml()?;
            let (about, frame) = FrameRecord::of(rendered, &seen.scene.picture, self.plan);
            Ok(Shot {
                index,
                scene,
                about,
                frame,
            })
        };
        let shots = (missing.iter().enumerate()).map_while(|(made, &index)| {
            match (shot(made, index), destination) {
                (Err(error), Destination::Pictures { .. }) if stop::requested() => {
                    stopped = Some(error);
                    None
                }
                (shot, _) => Some(shot),
            }
        });
        let written = pipelined(shots, |shots| {
            destination.write(reel, self.from, &scene, shots)
        });
        self.bars.end();
        Ok((written?, stopped))
    }

    /// Checks whether a stop is requested.
    ///
    /// # Errors
    /// It is, `made` of `of` frames being finished.
    fn check_stop(&self, chosen: Option<&Choice>, made: usize, of: usize) -> Result<()> {
        if !stop::requested() {
            return Ok(());
        }
        let mut report = format!("stopped early: {made} of {of} frames are finished");
        if let Destination::Animation { path, finished, .. } = &self.plan.destination {
            let path = path.display();
            report = match finished {
                Some(frames) => format!(
                    "{report} and saved in {}; {path} is written when all are",
                    frames.folder().display()
                ),
                None => format!("{report}, and none of them is in {path}"),
            };
        }
        if self.plan.ended_early() != ErrorKind::Stopped {
            return Err(Error::failed(report)
                .hint("--resume makes the rest of .png, .exr and animation files only"));
        }
        Err(Error::stopped(report).hint(match (self.job.bound, chosen) {
            (None, _) => "run the same command with --resume for the rest".to_owned(),
            (Some(_), Some(choice)) => format!(
                "run the same command with --resume, and with {} instead of --max-error, for the rest",
                choice.setting.flags()
            ),
            (Some(_), None) if made == 0 => "run the same command again".to_owned(),
            (Some(_), None) => {
                "run the same command with --resume, without --max-error, for the rest".to_owned()
            }
        }))
    }
}

/// The cameras of frames spread over the orbit by the golden ratio: no two of them opposite
/// each other, where projections are mirror images.
fn spread(orbit: &Orbit) -> Vec<Camera> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let frames = f64::from(orbit.frames());
    let at = |k: u32| (frames * (f64::from(k) * GOLDEN).fract()) as u32;
    let mut spread: Vec<u32> = (1..=VERIFIED_BESIDE).map(at).collect();
    spread.sort_unstable();
    spread.dedup();
    let frames = spread.into_iter().filter(|&frame| frame != 0);
    frames.map(|frame| orbit.camera(frame)).collect()
}
