//! `angioray orbit`.

mod frames;
mod making;
mod options;
mod plan;
mod stats;

use crate::batch::Destination;
use crate::error::Result;

use super::engine::Engine;
use super::job::JobArguments;
use super::progress::Bars;
use super::render::{gradient_note, provenance};
use super::stopping;
use super::terminal::{message, note};
use frames::Frames;
use making::{Made, Making};
use options::OrbitOptions;
use plan::Plan;

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

Stopped by Ctrl-C or SIGTERM it finishes the frame in work and ends with exit code 75; a second signal
ends it at once. The same command with --resume makes the rest (where --max-error chose, the flags to give
in its place are shown). The frames of an animation are stored in a folder beside it, such as head.mp4.frames,
until it is whole. Pictures other than .png and .exr stay, but cannot be resumed: then the exit code is 1.")]
pub struct OrbitArguments {
    #[command(flatten)]
    orbit: OrbitOptions,

    #[command(flatten)]
    job: JobArguments,
}

impl OrbitArguments {
    pub fn run(self) -> Result<()> {
        let file = self.job.scene_file()?;
        let options = self.orbit.over(file.group()?);
        let mut job = self.job.over(&file)?;
        let plan = Plan::of(options, &job)?;
        stopping::between_parts("frame", plan.ended_early())?;
        let engine = Engine::open(&job.device)?;

        let bars = Bars::new();
        let loaded = job.source.load(engine.device_info(), &bars)?;
        job.options = loaded.measured(job.options);
        let resolved = job.options.resolve(&loaded.subject)?;
        resolved.notes.iter().for_each(note);
        plan.destination.check_size(resolved.scene.size)?;
        let frames = Frames::new(resolved, &plan)?;

        let making = Making {
            plan: &plan,
            job: &job,
            engine: &engine,
            loaded: &loaded,
            from: &provenance(&loaded, &engine),
            bars: &bars,
        };
        let mine: Vec<u32> = plan.shard.frames(plan.frames.get()).collect();
        let missing = making.missing(&frames, &mine)?;
        let kept = mine.len() - missing.len();
        let made = making.make(frames, &missing)?;
        stats::write(&making, &made, kept)?;
        if let Some(stopped) = made.stopped {
            return Err(stopped);
        }
        tell(&making, &made, kept)
    }
}

/// What was done, in a line.
fn tell(making: &Making<'_>, made: &Made, kept: usize) -> Result<()> {
    let written = &made.written;
    if let Some(figures) = written.first().and_then(|w| w.about.gradients) {
        note(gradient_note(&figures));
    }
    let there = match kept {
        0 => String::new(),
        kept => format!(", {kept} were there"),
    };
    let (Some(one), Some(last)) = (written.first(), written.last()) else {
        match &making.plan.destination {
            Destination::Animation { path, .. } => message(format_args!(
                "wrote {} of {kept} frames that were there",
                path.display()
            )),
            Destination::Pictures { .. } => message(format_args!("nothing to do{there}")),
        }
        return Ok(());
    };
    let files = match &making.plan.destination {
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
    let first = made.frames.first();
    message(format_args!(
        "wrote {files}: {count} frames{there}, {} {}, {:.1} ms each on {}",
        first.scene.picture.mode(),
        first.scene.size,
        render_ms / count as f64,
        making.from.device
    ));
    Ok(())
}
