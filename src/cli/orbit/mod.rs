//! `angioray orbit`.

mod frame_record;
mod frames;
mod options;
mod plan;
mod runner;
mod stats;

use crate::batch::Destination;
use crate::error::Result;

use super::backend::Backend;
use super::job::JobArguments;
use super::progress::Bars;
use super::render::{gradient_note, provenance};
use super::stopping;
use super::terminal::{message, note};
use frames::Frames;
use options::OrbitOptions;
use plan::Plan;
use runner::{OrbitOutcome, OrbitRunner};

/// Render a volume from all around: a picture per frame, or an animation
#[derive(clap::Args)]
#[command(override_usage = "angioray orbit VOLUME -o FRAMES --frames N [OPTIONS]")]
#[command(mut_arg("output", |output| output.value_name("FRAMES").help(
    "The frames: pictures by a name with their number's place (frames/%04d.png, .jpg, .webp, .exr, .npy; \
     the folder is created if it does not exist), or one animation: .gif, .apng (lossless), .mp4 and .webm (by ffmpeg)"
)))]
#[command(after_help = "Example:
  angioray orbit head.nrrd -o head.mp4 --frames 120
  angioray orbit head.nrrd -o frames/%04d.png --frames 360 --mode mip --elevation 20 --axis z
  angioray orbit head.nrrd -o frames/%04d.png --frames 360 --resume
  sbatch --array=0-7 --wrap 'angioray orbit head.nrrd -o frames/%04d.png --frames 360 --shard auto'

Stopped by Ctrl-C or SIGTERM it finishes the current frame and ends with exit code 75; a second signal
ends it at once. The same command with --resume makes the rest (where --max-error chose, the flags to give
in its place are printed). The frames of an animation are saved in a folder beside it, such as head.mp4.frames,
until it is complete. Pictures other than .png and .exr stay, but cannot be resumed: then the exit code is 1.")]
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
        let backend = Backend::open(&job.device)?;

        let bars = Bars::new();
        let mut loaded = job.source.load(backend.device_info(), &bars)?;
        job.options = loaded.measured(job.options);
        loaded.frame(std::slice::from_ref(&job.options))?;
        let resolved = job.options.resolve(&loaded.subject)?;
        resolved.notes.iter().for_each(note);
        plan.destination.check_size(resolved.scene.size)?;
        let frames = Frames::new(resolved, &plan)?;

        let runner = OrbitRunner {
            plan: &plan,
            job: &job,
            backend: &backend,
            loaded: &loaded,
            from: &provenance(&loaded, &backend),
            bars: &bars,
        };
        let mine: Vec<u32> = plan.shard.frames(plan.frames.get()).collect();
        let missing = runner.missing(&frames, &mine)?;
        let existing = mine.len() - missing.len();
        let outcome = runner.make(frames, &missing)?;
        stats::write(&runner, &outcome, existing)?;
        if let Some(stopped) = outcome.stopped {
            return Err(stopped);
        }
        report(&runner, &outcome, existing)
    }
}

/// Reports what was done, in a line.
fn report(runner: &OrbitRunner<'_>, outcome: &OrbitOutcome, existing: usize) -> Result<()> {
    let written = &outcome.written;
    if let Some(figures) = written.first().and_then(|w| w.about.gradients) {
        note(gradient_note(&figures));
    }
    let there = match existing {
        0 => String::new(),
        existing => format!(", {existing} existed"),
    };
    let (Some(one), Some(last)) = (written.first(), written.last()) else {
        match &runner.plan.destination {
            Destination::Animation { path, .. } => message(format_args!(
                "wrote {} of {existing} existing frames",
                path.display()
            )),
            Destination::Pictures { .. } => message(format_args!("nothing to do{there}")),
        }
        return Ok(());
    };
    let files = match &runner.plan.destination {
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
    let first = outcome.frames.first();
    message(format_args!(
        "wrote {files}: {count} frames{there}, {} {}, {:.1} ms each on {}",
        first.scene.picture.mode(),
        first.scene.size,
        render_ms / count as f64,
        runner.from.device
    ));
    Ok(())
}
