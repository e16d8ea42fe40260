//! `angioray orbit`.

mod making;
mod options;
mod plan;
mod stats;

use crate::VERSION;
use crate::batch::{Destination, Provenance};
use crate::error::Result;
use crate::scene::Orbit;
use crate::stop;

use super::engine::Engine;
use super::job::JobArguments;
use super::progress::Bars;
use super::render::gradient_note;
use super::terminal::{message, note};
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

Stopped by Ctrl-C or SIGTERM it finishes the frame in work; a second one ends it at once. Frames that
are .png or .exr can be gone on with: it ends with exit code 75, and the same command with --resume
goes on (where --max-error chose, with the flags that are told then in its place). Other pictures stay
too, but cannot be gone on with, and an animation is not written: it ends with exit code 1.")]
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
        let job = self.job.over(&file)?;
        let plan = Plan::of(options, &job)?;
        // Before the device is opened: OpenCL drivers catch signals too, and end the process by their
        // own unless they were there last.
        stop::listen_for(plan.ended_early())?;
        let engine = Engine::open(&job.device)?;

        let bars = Bars::new();
        let loaded = job.source.load_for(&engine, &bars)?;
        let resolved = job.options.resolve(&loaded.subject)?;
        resolved.notes.iter().for_each(note);
        plan.destination.check_size(resolved.scene.size)?;
        let orbit = Orbit::new(resolved, plan.axis, plan.degrees, plan.frames)?;

        let making = Making {
            plan: &plan,
            job: &job,
            engine: &engine,
            loaded: &loaded,
            from: &Provenance {
                version: VERSION,
                content: loaded.volume.content_hash().to_hex().to_string(),
                device: engine.device().name,
            },
            bars: &bars,
        };
        let mine: Vec<u32> = plan.shard.frames(plan.frames.get()).collect();
        let missing = making.missing(&orbit, &mine)?;
        let kept = mine.len() - missing.len();
        let made = making.make(orbit, &missing)?;
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
        message(format_args!("nothing to do{there}"));
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
    let first = made.orbit.at(0)?;
    message(format_args!(
        "wrote {files}: {count} frames{there}, {} {}, {:.1} ms each on {}",
        first.scene.picture.mode(),
        first.scene.size,
        render_ms / count as f64,
        making.from.device
    ));
    Ok(())
}
