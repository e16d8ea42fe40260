//! What of an orbit is made, and where it goes: known before the volume is read.

use std::path::{Path, PathBuf};

use crate::batch::{Destination, FinishedFrames, FrameNames, Shard, ShardChoice};
use crate::error::{Error, ErrorKind, Result};
use crate::frame::{Animation, AnimationFormat, Encoding, Format};
use crate::options::group::Keys;
use crate::options::rules::{Group, Need, unmet};
use crate::options::{AngleDeg, FilePath, Switch};
use crate::output::becomes_file;
use crate::scene::{FrameCount, OrbitAxis};

use super::super::job::Job;
use super::super::outputs;
use super::super::terminal::note;
use super::options::OrbitOptions;

/// An orbit as flags and scene file request it.
pub struct Plan {
    pub frames: FrameCount,
    /// The angle by which the camera turns in all, degrees.
    pub degrees: f64,
    pub axis: OrbitAxis,
    pub resume: bool,
    pub shard: Shard,
    pub destination: Destination,
    /// The encoding of the frames; for an animation, that of its pictures.
    pub encoding: Encoding,
    pub stats: Option<PathBuf>,
}

impl Plan {
    const DEFAULT_DEGREES: f64 = 360.0;

    /// Checks the options and plans the orbit.
    ///
    /// # Errors
    /// Options that are missing or contradict each other, files that cannot be written or are read.
    pub fn of(options: OrbitOptions, job: &Job) -> Result<Self> {
        let Some(frames) = options.frames else {
            return Err(Error::usage("no number of frames was given")
                .hint("give it with '--frames', such as --frames 120"));
        };
        let resume = options.resume.is_some_and(Switch::is_on);
        let (shard, given_by) = (options.shard)
            .unwrap_or(ShardChoice::Given(Shard::WHOLE))
            .resolve(|name| std::env::var(name).ok())?;
        if let Some(variables) = given_by {
            note(format_args!("shard {shard} by {variables}"));
        }
        let (destination, encoding) = destination(&options, job)?;
        let stats = job.output.stats.as_ref().map(|FilePath(path)| path);
        let stats = stats.map(|path| match options.shard {
            Some(_) => stats_of_shard(path, shard),
            None => Ok(path.clone()),
        });
        let plan = Self {
            frames,
            degrees: options.degrees.map_or(Self::DEFAULT_DEGREES, AngleDeg::get),
            axis: options.axis.unwrap_or_default(),
            resume,
            shard,
            destination,
            encoding,
            stats: stats.transpose()?,
        };
        plan.check_part(job)?;
        plan.check_files(&job.inputs)?;
        Ok(plan)
    }

    /// How a run ends that is stopped before its end: whether it can be resumed.
    pub fn ended_early(&self) -> ErrorKind {
        match self.destination.recognises_finished() {
            true => ErrorKind::Stopped,
            false => ErrorKind::Failed,
        }
    }

    /// Checks that a shard, which makes only a part of the frames, fits the other options.
    fn check_part(&self, job: &Job) -> Result<()> {
        let key = match (self.resume, self.shard) {
            (true, _) => "resume",
            (false, Shard::WHOLE) => return Ok(()),
            (false, _) => "shard",
        };
        match &self.destination {
            Destination::Animation { path, .. } if self.shard != Shard::WHOLE => {
                return Err(Error::usage(format!(
                    "{}: an animation is one file: '--shard' cannot be combined with it",
                    path.display()
                ))
                .hint("write pictures, such as -o frames/%04d.png, and join them afterwards"));
            }
            _ if self.resume && !self.destination.recognises_finished() => {
                return Err(Error::usage(format!(
                    "{}: such files do not record their scene, so '--resume' cannot be used with them",
                    job.output.path()?.display()
                ))
                .hint("write .png, .exr or an animation"));
            }
            _ => {}
        }
        if job.bound.is_some() {
            return Err(Error::usage(format!(
                "'max-error' and '{key}' cannot be combined: each run would choose for itself, and frames would differ"
            ))
            .hint("choose once, by --max-error without it, and repeat the flags that were chosen"));
        }
        Ok(())
    }

    fn check_files(&self, inputs: &[PathBuf]) -> Result<()> {
        match &self.destination {
            Destination::Pictures { names, .. } => {
                let stats = self.stats.as_deref();
                outputs::check_sequence(names, self.frames, inputs, stats)?;
                stats.map_or(Ok(()), |stats| outputs::check(stats, inputs))
            }
            Destination::Animation { path, finished, .. } => {
                if let Some(finished) = finished {
                    let stats = self.stats.as_deref();
                    outputs::check_sequence(finished.names(), self.frames, inputs, stats)?;
                }
                outputs::Files {
                    picture: path.clone(),
                    encoding: self.encoding.clone(),
                    stats: self.stats.clone(),
                }
                .check(inputs)
            }
        }
    }
}

/// Where the frames go, and how each is encoded.
fn destination(options: &OrbitOptions, job: &Job) -> Result<(Destination, Encoding)> {
    let path = job.output.path()?;
    let Some(format) = AnimationFormat::from_path(path) else {
        Format::from_path(path).map_err(|error| {
            error.hint(
                "use one of .png .exr .jpg .webp .npy with %04d in the name, or .gif .apng .mp4 .webm",
            )
        })?;
        let encoding = job.output.encoding(path, job.options.mode())?;
        let names = FrameNames::of(path)?;
        let unmet = unmet(Group::Orbit, &options.given(), |need| {
            need != Need::Animation
        });
        if let Some((option, _)) = unmet {
            return Err(Error::usage(format!(
                "'--{option}' is for animations only: pictures have no rate"
            )));
        }
        let pictures = Destination::Pictures {
            names,
            encoding: encoding.clone(),
        };
        return Ok((pictures, encoding));
    };
    let encoding = job.output.encoding_of_animation(job.options.mode())?;
    let animation = Animation {
        format,
        rate: options.fps.unwrap_or_default(),
    };
    animation.check()?;
    let finished = becomes_file(path).then(|| FinishedFrames::of(path));
    let animation = Destination::Animation {
        path: path.to_owned(),
        animation,
        finished: finished.transpose()?,
    };
    Ok((animation, encoding))
}

/// The statistics of a shard, whose processes all have the same flags.
fn stats_of_shard(path: &Path, shard: Shard) -> Result<PathBuf> {
    match FrameNames::of(path) {
        Ok(names) => Ok(names.path(shard.index())),
        Err(_) if shard == Shard::WHOLE => Ok(path.to_owned()),
        Err(_) => Err(Error::usage(format!(
            "{}: every shard would write its statistics there",
            path.display()
        ))
        .hint("write the shard's number as %d in the file's name, such as stats-%d.json")),
    }
}
