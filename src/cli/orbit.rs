//! `angioray orbit`.

use std::path::{Path, PathBuf};

use crate::batch::{Destination, FrameNames, Shard, ShardChoice, Shot, Written, beside};
use crate::error::{Error, Result};
use crate::frame::{self, Animation, AnimationFormat, Encoding, FrameRate, Reel, Wanted};
use crate::measure::Counts;
use crate::progress::{Progress, Silent};
use crate::render::GradientFigures;
use crate::scene::options::group::group;
use crate::scene::options::plain::readable;
use crate::scene::{AngleDeg, Camera, FilePath, Orbit, OrbitAxis, Resolved, Switch};
use crate::stop;
use crate::tolerance::Cost;

use super::engine::{Caster, Engine};
use super::job::{Job, JobArguments};
use super::outputs;
use super::progress::Bars;
use super::render::gradient_note;
use super::stats::{
    self, DeviceStats, FrameStats, Memory, OrbitFigures, OrbitStats, PassStats, Stats, Times,
    VERSION, VolumeStats,
};
use super::terminal::{message, note};
use super::tolerance::{ToleranceStats, choose};

/// Frames on which a choice by `--max-error` is verified beside the first.
const VERIFIED_BESIDE: u32 = 3;

/// Render a volume from all around: a picture per frame, or an animation
#[derive(clap::Args)]
#[command(override_usage = "angioray orbit VOLUME -o FRAMES --frames N [OPTIONS]")]
#[command(mut_arg("output", |output| output.value_name("FRAMES").help(
    "The frames: pictures by a name with their number's place (frames/%04d.png, .jpg, .webp, .exr, .npy; \
     a folder is made where there is none), or one animation: .gif, .apng (lossless), .mp4 and .webm (by ffmpeg)"
)))]
#[command(after_help = "Example:
  angioray orbit head.nrrd -o head.mp4 --frames 120
  angioray orbit head.nrrd -o frames/%04d.png --frames 360 --mode mip --elevation 20 --axis z
  angioray orbit head.nrrd -o frames/%04d.png --frames 360 --resume
  sbatch --array=0-7 --wrap 'angioray orbit head.nrrd -o frames/%04d.png --frames 360 --shard auto'

Stopped by Ctrl-C or SIGTERM it finishes the frame in work and ends with exit code 75; the same
command with --resume goes on.")]
pub struct OrbitArguments {
    #[command(flatten)]
    orbit: OrbitOptions,

    #[command(flatten)]
    job: JobArguments,
}

group! {
    /// How the camera turns, and which frames are made.
    #[command(next_help_heading = "Orbit")]
    pub struct OrbitOptions {
        /// Number of frames; frame k is turned by k·degrees/N, so that a whole turn closes without
        /// a repeated frame
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        frames: u32,

        /// How far the camera turns in all, right-handed about the axis: about up the eye moves to
        /// the picture's right, as with --azimuth [default: 360]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        degrees: AngleDeg,

        /// What it turns about, through the target: up or right as in the first frame's picture, a
        /// world axis, or a direction in world space; z is the patient's long axis, about which a
        /// C-arm turns [default: up]
        #[arg(long, value_name = "up|right|x|y|z|X,Y,Z", allow_hyphen_values = true)]
        axis: OrbitAxis,

        /// Frames per second of an animation [default: 30]
        #[arg(long, value_name = "F", allow_hyphen_values = true)]
        fps: FrameRate,

        /// Keep frames that are there, whole and of the same scene (.png and .exr tell), and make
        /// the others
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        resume: Switch,

        /// Make every Nth frame only, from frame I on, I from 0 to N-1; auto: as Slurm or MPI says
        #[arg(long, value_name = "I/N|auto", allow_hyphen_values = true)]
        shard: ShardChoice,
    }
}

readable!(FrameRate, ShardChoice);

/// What of an orbit is made, and where it goes: known before the volume is read.
struct Plan {
    frames: u32,
    degrees: f64,
    axis: OrbitAxis,
    resume: bool,
    shard: Shard,
    destination: Destination,
    /// Of the frames; an animation's is that of its pictures.
    encoding: Encoding,
    stats: Option<PathBuf>,
    /// What an error bound chose, as flags.
    chosen: Option<String>,
}

impl OrbitOptions {
    const DEFAULT_DEGREES: f64 = 360.0;

    fn plan(self, job: &Job) -> Result<Plan> {
        let Some(frames) = self.frames else {
            return Err(Error::usage("no number of frames was named")
                .hint("give it by '--frames', such as --frames 120"));
        };
        let shard = self.shard.unwrap_or(ShardChoice::Given(Shard::WHOLE));
        let (shard, told_by) = shard.resolve(|name| std::env::var(name).ok())?;
        if let Some(variable) = told_by {
            note(format_args!("shard {shard} by {variable}"));
        }
        let resume = self.resume.is_some_and(Switch::is_on);
        let path = job.output.path()?;
        let (destination, encoding) = match AnimationFormat::from_path(path) {
            Some(format) => {
                if shard != Shard::WHOLE || resume {
                    let key = if resume { "resume" } else { "shard" };
                    return Err(Error::usage(format!(
                        "{}: an animation is made in one go: '--{key}' does not go with it",
                        path.display()
                    ))
                    .hint("write pictures, such as -o frames/%04d.png, and join them afterwards"));
                }
                // Written from the same plane as a PNG.
                let encoding = job.output.encoding(Path::new("frame.png"))?;
                let animation = Animation {
                    format,
                    rate: self.fps.unwrap_or_default(),
                };
                animation.check()?;
                let path = path.to_owned();
                (Destination::Animation { path, animation }, encoding)
            }
            None => {
                let encoding = job.output.encoding(path)?;
                let names = FrameNames::of(path)?;
                if self.fps.is_some() {
                    return Err(Error::usage(
                        "'--fps' is for animations only: pictures have no rate",
                    ));
                }
                let pictures = Destination::Pictures {
                    names,
                    encoding: encoding.clone(),
                };
                (pictures, encoding)
            }
        };
        if resume && !destination.tells_what_is_there() {
            return Err(Error::usage(format!(
                "{}: such files do not say what scene they are of: '--resume' does not go with them",
                path.display()
            ))
            .hint("write .png or .exr"));
        }
        if job.bound.is_some() && (resume || shard != Shard::WHOLE) {
            let key = if resume { "resume" } else { "shard" };
            return Err(Error::usage(format!(
                "'max-error' and '{key}' exclude each other: each run would choose for itself, and frames would differ"
            ))
            .hint("choose once, by --max-error without it, and repeat the flags that were chosen"));
        }
        let stats = job.output.stats.clone().map(|FilePath(path)| path);
        match &destination {
            Destination::Pictures { names, .. } => {
                outputs::check_sequence(
                    names,
                    shard.frames(frames),
                    &job.inputs,
                    stats.as_deref(),
                )?;
                if let Some(stats) = &stats {
                    outputs::check(stats, &job.inputs)?;
                }
            }
            Destination::Animation { path, .. } => outputs::Files {
                picture: path.clone(),
                encoding: encoding.clone(),
                stats: stats.clone(),
            }
            .check(&job.inputs)?,
        }
        Ok(Plan {
            frames,
            degrees: self.degrees.map_or(Self::DEFAULT_DEGREES, AngleDeg::get),
            axis: self.axis.unwrap_or_default(),
            resume,
            shard,
            destination,
            encoding,
            stats,
            chosen: None,
        })
    }
}

/// What is remembered of a frame.
struct Taken {
    times_ms: Times,
    passes: Vec<PassStats>,
    /// Where statistics are wanted.
    counts: Option<Counts>,
    gradients: Option<GradientFigures>,
    device: DeviceStats,
    device_bytes: u64,
    uploaded_bytes: u64,
}

impl OrbitArguments {
    pub fn run(self) -> Result<()> {
        let file = self.job.scene_file()?;
        let options = self.orbit.over(file.group()?);
        let job = self.job.over(&file)?;
        let mut plan = options.plan(&job)?;
        // Before the device is opened: OpenCL drivers catch signals too, and end the process by their
        // own unless they were there last.
        stop::listen()?;
        let engine = Engine::open(&job.device)?;

        let bars = Bars::new();
        let loaded = job.source.load(&bars)?;
        let resolved = job.options.resolve(&loaded.subject)?;
        resolved.notes.iter().for_each(note);
        plan.destination.check_size(resolved.scene.size)?;
        let mut orbit = Orbit::new(resolved, plan.axis, plan.degrees, plan.frames)?;

        let mine: Vec<u32> = plan.shard.frames(plan.frames).collect();
        let missing = plan.missing(&orbit, &mine, &bars)?;
        let kept = mine.len() - missing.len();
        let mut written = Vec::new();
        let mut chosen = None;
        if !missing.is_empty() {
            plan.destination.make_folder()?;
            let prepared = engine.prepare(&loaded.volume, &job.source, &bars)?;
            let mut caster = engine.caster(&loaded.volume, &prepared)?;
            if let Some(bound) = job.bound {
                let wanted = Wanted::for_encoding(&plan.encoding, plan.stats.is_some());
                let elsewhere = spread(&orbit)?;
                let (options, caster) = (&job.options, &mut caster);
                chosen = choose(bound, options, &loaded, wanted, &elsewhere, caster, &bars)?;
            }
            if let Some(choice) = &chosen {
                let first = choice.resolved.clone();
                orbit = Orbit::new(first, plan.axis, plan.degrees, plan.frames)?;
                plan.chosen = Some(choice.setting.flags());
            }
            written = plan.make(&orbit, &missing, &mut caster, &bars)?;
        }

        let first = orbit.at(0)?;
        plan.tell(&first, kept, &written);
        let (Some(path), Some(last)) = (&plan.stats, written.last()) else {
            return Ok(());
        };
        let choosing = (chosen.as_ref()).map_or(Cost::default(), |choice| choice.cost);
        let memory = Memory::now(
            written
                .iter()
                .map(|w| w.about.device_bytes)
                .max()
                .unwrap_or(0),
            last.about.gradients.map_or(0, |figures| figures.bytes),
            written.iter().map(|w| w.about.uploaded_bytes).sum::<u64>() + choosing.uploaded_bytes,
        );
        let times_ms = times_of_all(&written);
        let times_ms = Times {
            read: loaded.read_ms,
            smooth: loaded.smooth_ms,
            build: times_ms.build + choosing.build_ms,
            upload: times_ms.upload + choosing.upload_ms,
            ..times_ms
        };
        let stats = OrbitStats {
            all: Stats {
                version: VERSION,
                command: "orbit",
                scene: &first.options,
                volume: VolumeStats::of(&job.source.path, &loaded.volume, loaded.non_finite),
                device: last.about.device.clone(),
                channels: frame::channels(&plan.encoding),
                times_ms,
                passes: passes_of_all(&written),
                counts: written.iter().filter_map(|w| w.about.counts).sum(),
                memory,
                max_error: chosen.as_ref().map(ToleranceStats::of),
            },
            orbit: OrbitFigures {
                frames: plan.frames,
                degrees: plan.degrees,
                axis: orbit.axis().to_array(),
                kept,
                shard: plan.shard.to_string(),
            },
            frames: written
                .iter()
                .filter_map(|w| {
                    Some(FrameStats {
                        index: w.index,
                        degrees: orbit.degrees_at(w.index),
                        render_ms: w.about.times_ms.render,
                        read_back_ms: w.about.times_ms.read_back,
                        encode_ms: w.encode_ms,
                        counts: w.about.counts?,
                    })
                })
                .collect(),
        };
        stats::write(&stats, path)
    }
}

impl Plan {
    /// Which frames are still to be made.
    fn missing(&self, orbit: &Orbit, mine: &[u32], bars: &Bars) -> Result<Vec<u32>> {
        if !self.resume {
            return Ok(mine.to_vec());
        }
        bars.begin("looking", mine.len() as u64);
        let mut missing = Vec::new();
        for &index in mine {
            let seen = orbit.at(index)?;
            let scene = seen.options.to_toml()?;
            let metadata = [("scene", scene.as_str()), ("version", VERSION)];
            if !(self.destination).holds(index, seen.scene.size, &metadata) {
                missing.push(index);
            }
            bars.advance(1);
        }
        bars.end();
        Ok(missing)
    }

    /// Renders frames one after another, and encodes each beside the rendering of the next.
    fn make(
        &self,
        orbit: &Orbit,
        missing: &[u32],
        caster: &mut Caster<'_>,
        bars: &Bars,
    ) -> Result<Vec<Written<Taken>>> {
        let first = orbit.at(0)?;
        let scene = first.options.to_toml()?;
        let reel = Reel {
            size: first.scene.size,
            frames: missing.len() as u32,
        };
        let wanted = Wanted::for_encoding(&self.encoding, self.stats.is_some());
        bars.begin("frames", missing.len() as u64);
        let shots = missing.iter().enumerate().map(|(made, &index)| {
            if stop::asked() {
                return Err(self.stopped(made, missing.len()));
            }
            let seen = orbit.at(index)?;
            let rendered = caster.render(&seen.scene, wanted, &Silent);
            // A signal while kernels are built makes LLVM remove the files that it is writing, so
            // that the build fails: that is the stop, not a fault.
            let rendered = rendered.map_err(|failure| match stop::asked() {
                true => self.stopped(made, missing.len()),
                false => failure,
            })?;
            bars.advance(1);
            Ok(Shot {
                index,
                scene: seen.options.to_toml()?,
                about: Taken {
                    times_ms: rendered.times_ms,
                    passes: rendered.passes,
                    counts: (self.stats.as_ref())
                        .map(|_| Counts::of(&rendered.frame, &seen.scene.picture)),
                    gradients: rendered.gradients,
                    device: rendered.device,
                    device_bytes: rendered.device_bytes,
                    uploaded_bytes: rendered.uploaded_bytes,
                },
                frame: rendered.frame,
            })
        });
        let written = beside(shots, |shots| {
            self.destination.write(reel, VERSION, &scene, shots)
        });
        bars.end();
        written
    }

    fn stopped(&self, made: usize, of: usize) -> Error {
        match &self.destination {
            Destination::Animation { path, .. } => Error::failed(format!(
                "stopped at frame {made} of {of}: {} was not written",
                path.display()
            ))
            .hint("pictures, such as -o frames/%04d.png, can be gone on with after a stop"),
            Destination::Pictures { .. } if self.destination.tells_what_is_there() => {
                Error::stopped(format!("stopped early: {made} of {of} frames are made")).hint(
                    match &self.chosen {
                        None => "the same command with --resume goes on".to_owned(),
                        Some(flags) => {
                            format!("--resume goes on, with {flags} instead of --max-error")
                        }
                    },
                )
            }
            Destination::Pictures { .. } => {
                Error::failed(format!("stopped early: {made} of {of} frames are made"))
                    .hint("only .png and .exr can be gone on with, by --resume")
            }
        }
    }

    /// What was done, in a line.
    fn tell(&self, first: &Resolved, kept: usize, written: &[Written<Taken>]) {
        if let Some(figures) = written.first().and_then(|w| w.about.gradients) {
            note(gradient_note(&figures));
        }
        let there = match kept {
            0 => String::new(),
            kept => format!(", {kept} were there"),
        };
        let (Some(one), Some(last)) = (written.first(), written.last()) else {
            message(format_args!("nothing to do{there}"));
            return;
        };
        let files = match &self.destination {
            Destination::Animation { path, .. } => path.display().to_string(),
            Destination::Pictures { names, .. } if one.index == last.index => {
                names.path(one.index).display().to_string()
            }
            Destination::Pictures { names, .. } => format!(
                "{} to {}",
                names.path(one.index).display(),
                names.path(last.index).display()
            ),
        };
        let count = written.len();
        let render_ms: f64 = written.iter().map(|w| w.about.times_ms.render).sum();
        message(format_args!(
            "wrote {files}: {count} frames{there}, {} {}, {:.1} ms each on {}",
            first.scene.picture.mode(),
            first.scene.size,
            render_ms / count as f64,
            last.about.device.name
        ));
    }
}

/// Where the camera is on frames spread over the orbit by the golden ratio: no two of them opposite
/// each other, where projections are mirror images.
fn spread(orbit: &Orbit) -> Result<Vec<Camera>> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let frames = f64::from(orbit.frames());
    let at = |k: u32| (frames * (f64::from(k) * GOLDEN).fract()) as u32;
    let mut spread: Vec<u32> = (1..=VERIFIED_BESIDE).map(at).collect();
    spread.sort_unstable();
    spread.dedup();
    let frames = spread.into_iter().filter(|&frame| frame != 0);
    frames
        .map(|frame| Ok(orbit.at(frame)?.scene.camera))
        .collect()
}

/// Sums over the frames; what was done once for all is counted once.
fn times_of_all(written: &[Written<Taken>]) -> Times {
    let sum = |of: fn(&Times) -> f64| written.iter().map(|w| of(&w.about.times_ms)).sum();
    let once = |of: fn(&Times) -> f64| written.first().map_or(0.0, |w| of(&w.about.times_ms));
    Times {
        octree: once(|times| times.octree),
        gradient: once(|times| times.gradient),
        classify: sum(|times| times.classify),
        build: sum(|times| times.build),
        upload: sum(|times| times.upload),
        render: sum(|times| times.render),
        read_back: sum(|times| times.read_back),
        encode: written.iter().map(|w| w.encode_ms).sum(),
        ..Times::default()
    }
}

/// Every pass's sum over the frames, in the order in which they first ran.
fn passes_of_all(written: &[Written<Taken>]) -> Vec<PassStats> {
    let mut sums: Vec<PassStats> = Vec::new();
    for pass in written.iter().flat_map(|w| &w.about.passes) {
        match sums.iter_mut().find(|sum| sum.name == pass.name) {
            Some(sum) => sum.ms += pass.ms,
            None => sums.push(pass.clone()),
        }
    }
    sums
}
