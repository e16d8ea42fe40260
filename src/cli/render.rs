//! `angioray render`.

use std::time::Instant;

use crate::VERSION;
use crate::error::Result;
use crate::frame::{self, Wanted};
use crate::measure::Counts;
use crate::render::GradientFigures;
use crate::tolerance::{Cost, ToleranceStats};

use super::engine::Engine;
use super::job::JobArguments;
use super::load::ms_since;
use super::progress::Bars;
use super::stats::{self, Memory, Stats, Times, VolumeStats};
use super::terminal::{message, note};
use super::tolerance::choose;

/// Render a volume to a picture
#[derive(clap::Args)]
#[command(override_usage = "angioray render VOLUME -o FILE [OPTIONS]")]
#[command(after_help = "Example:
  angioray render head.nrrd -o head.png
  angioray render head.nrrd -o head.png --mode mip --view left --zoom 1.5
  angioray render cta.nii.gz -o cta.png --mode dvr --tf cta --shading phong --carm 'LAO 30 CRA 20'
  angioray render head.nrrd -o head.png --mode mip --max-error rmse:0.002
  angioray render head.nrrd -o head.exr --iso 50% --aov all --stats head.json --device reference")]
pub struct RenderArguments {
    #[command(flatten)]
    job: JobArguments,
}

impl RenderArguments {
    pub fn run(self) -> Result<()> {
        let file = self.job.scene_file()?;
        let job = self.job.over(&file)?;
        let files = job.output.files()?;
        files.check(&job.inputs)?;
        let engine = Engine::open(&job.device)?;

        let bars = Bars::new();
        let loaded = job.source.load_for(&engine, &bars)?;
        let mut resolved = job.options.resolve(&loaded.subject)?;
        resolved.notes.iter().for_each(note);
        files.encoding.check_size(resolved.scene.size)?;

        let wanted = Wanted::for_encoding(&files.encoding, files.stats.is_some());
        let prepared = engine.prepare(&loaded.volume, &job.source, &bars)?;
        let mut caster = engine.caster(&loaded.volume, &prepared)?;
        let choice = match job.bound {
            Some(bound) => choose(
                bound,
                &job.options,
                &loaded,
                wanted,
                &[],
                &mut caster,
                &bars,
            )?,
            None => None,
        };
        if let Some(choice) = &choice {
            resolved = choice.resolved.clone();
        }
        let rendered = caster.render(&resolved.scene, wanted, &bars)?;

        if let Some(figures) = &rendered.gradients {
            note(gradient_note(figures));
        }
        let began = Instant::now();
        let scene_text = resolved.options.to_toml()?;
        let metadata = [("scene", scene_text.as_str()), ("version", VERSION)];
        frame::write(&files.picture, &rendered.frame, &files.encoding, &metadata)?;
        let chosen = choice
            .as_ref()
            .map_or(Cost::default(), |choice| choice.cost);
        let times_ms = Times {
            read: loaded.read_ms,
            smooth: loaded.smooth_ms,
            encode: ms_since(began),
            build: rendered.times_ms.build + chosen.build_ms,
            upload: rendered.times_ms.upload + chosen.upload_ms,
            ..rendered.times_ms
        };
        message(format_args!(
            "wrote {}: {} {}, {:.1} ms on {}",
            files.picture.display(),
            resolved.scene.picture.mode(),
            resolved.scene.size,
            times_ms.render,
            rendered.device.name
        ));
        if let Some(undecided) = rendered.frame.undecided() {
            let pixels = rendered.frame.size.pixels();
            message(format_args!(
                "certificate: {undecided} of {pixels} pixels undecided, a share of {:.1e}",
                undecided as f64 / pixels as f64
            ));
        }
        let Some(path) = &files.stats else {
            return Ok(());
        };
        let stats = Stats {
            version: VERSION,
            command: "render",
            scene: &resolved.options,
            volume: VolumeStats::of(&job.source.path, &loaded.volume, loaded.non_finite),
            device: rendered.device,
            channels: frame::channels(&files.encoding),
            times_ms,
            passes: rendered.passes,
            counts: Counts::of(&rendered.frame, &resolved.scene.picture),
            memory: Memory::now(
                rendered.device_bytes,
                rendered.gradients.map_or(0, |figures| figures.bytes),
                rendered.uploaded_bytes + chosen.uploaded_bytes,
            ),
            max_error: choice.as_ref().map(ToleranceStats::of),
        };
        stats::write(&stats, path)
    }
}

/// What precomputed gradients cost and are worth.
pub fn gradient_note(figures: &GradientFigures) -> String {
    let megabytes = figures.bytes as f64 / 1e6;
    let angle = match figures.angle {
        Some(angle) => format!(
            "angle against central differences: mean {:.1}°, p99 {:.1}° (at {} places of strong gradient)",
            angle.mean_deg, angle.p99_deg, angle.places
        ),
        None => "the volume is flat".to_owned(),
    };
    format!("precomputed gradients: {megabytes:.1} MB; {angle}")
}
