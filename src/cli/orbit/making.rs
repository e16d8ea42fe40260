//! The frames of an orbit, one after another, until they are all there or it is to stop.

use crate::batch::{Destination, Provenance, Shot, Written, beside};
use crate::error::{Error, ErrorKind, Result};
use crate::frame::{Reel, Wanted};
use crate::progress::{Progress, Silent};
use crate::scene::{Camera, Orbit, Scene};
use crate::stop;
use crate::tolerance::Choice;

use super::super::engine::{Caster, Engine};
use super::super::job::Job;
use super::super::load::Loaded;
use super::super::progress::Bars;
use super::super::tolerance::choose;
use super::frames::Frames;
use super::plan::Plan;
use super::stats::Taken;

/// Frames on which a choice by `--max-error` is verified beside the first.
const VERIFIED_BESIDE: u32 = 3;

/// What an orbit is made of.
pub struct Making<'a> {
    pub plan: &'a Plan,
    pub job: &'a Job,
    pub engine: &'a Engine,
    pub loaded: &'a Loaded,
    pub from: &'a Provenance,
    pub bars: &'a Bars,
}

/// What was made of it.
pub struct Made {
    /// Under the setting that was chosen, where one was.
    pub frames: Frames,
    pub chosen: Option<Choice>,
    pub written: Vec<Written<Taken>>,
    /// Why the rest is not.
    pub stopped: Option<Error>,
}

impl Made {
    fn nothing(frames: Frames, stopped: Option<Error>) -> Self {
        Self {
            frames,
            chosen: None,
            written: Vec::new(),
            stopped,
        }
    }
}

impl Making<'_> {
    /// Which of this process's frames are still to be made.
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
            let is_there = !stop::asked()
                && (self.plan.destination).holds(index, seen.scene.size, &scene, self.from);
            if !is_there {
                missing.push(index);
            }
            self.bars.advance(1);
        }
        self.bars.end();
        Ok(missing)
    }

    /// Makes these frames.
    ///
    /// # Errors
    /// Anything but a stop between two pictures, which is part of what was made.
    pub fn make(&self, mut frames: Frames, missing: &[u32]) -> Result<Made> {
        if missing.is_empty() {
            let nothing = Made::nothing(frames, None);
            self.join(&nothing.frames)?;
            return Ok(nothing);
        }
        let check = |chosen| self.check_stop(chosen, 0, missing.len());
        if let Err(stopped) = check(None) {
            return Ok(Made::nothing(frames, Some(stopped)));
        }
        self.plan.destination.make_folder()?;
        let (loaded, bars) = (self.loaded, self.bars);
        let prepared = self
            .engine
            .prepare(&loaded.volume, &self.job.source, bars)?;
        let mut caster = self.engine.caster(&loaded.volume, &prepared)?;
        let chosen = match stop::over_failure(self.choose(&frames, &mut caster), || check(None)) {
            Err(stopped) if stopped.kind() == ErrorKind::Stopped => {
                return Ok(Made::nothing(frames, Some(stopped)));
            }
            chosen => chosen?,
        };
        if let Some(choice) = &chosen {
            frames = Frames::new(choice.resolved.clone(), self.plan)?;
        }
        let (written, stopped) = self.write(&frames, missing, chosen.as_ref(), &mut caster)?;
        Ok(Made {
            frames,
            chosen,
            written,
            stopped,
        })
    }

    /// Writes an animation all of whose frames exist.
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

    /// What an error bound chooses, where there is one.
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
    /// that are there when it is stopped stay; an animation without its end is an error, its frames being
    /// kept.
    fn write(
        &self,
        frames: &Frames,
        missing: &[u32],
        chosen: Option<&Choice>,
        caster: &mut Caster<'_>,
    ) -> Result<(Vec<Written<Taken>>, Option<Error>)> {
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
            let (about, frame) = Taken::of(rendered, &seen.scene.picture, self.plan);
            Ok(Shot {
                index,
                scene,
                about,
                frame,
            })
        };
        let shots = (missing.iter().enumerate()).map_while(|(made, &index)| {
            match (shot(made, index), destination) {
                (Err(error), Destination::Pictures { .. }) if stop::asked() => {
                    stopped = Some(error);
                    None
                }
                (shot, _) => Some(shot),
            }
        });
        let written = beside(shots, |shots| {
            destination.write(reel, self.from, &scene, shots)
        });
        self.bars.end();
        Ok((written?, stopped))
    }

    /// # Errors
    /// It is to stop, `made` of `of` frames being made.
    fn check_stop(&self, chosen: Option<&Choice>, made: usize, of: usize) -> Result<()> {
        if !stop::asked() {
            return Ok(());
        }
        let mut stopped = format!("stopped early: {made} of {of} frames are finished");
        if let Destination::Animation { path, kept, .. } = &self.plan.destination {
            let path = path.display();
            stopped = match kept {
                Some(kept) => format!(
                    "{stopped}, in {}; {path} is written when all are",
                    kept.folder().display()
                ),
                None => format!("{stopped}, and {path} holds none of them"),
            };
        }
        if self.plan.ended_early() != ErrorKind::Stopped {
            return Err(Error::failed(stopped)
                .hint("--resume makes the rest of .png, .exr and animation files only"));
        }
        Err(Error::stopped(stopped).hint(match (self.job.bound, chosen) {
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

/// Where the camera is on frames spread over the orbit by the golden ratio: no two of them opposite
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
