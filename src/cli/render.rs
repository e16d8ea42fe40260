//! `angioray render`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::Result;
use crate::frame::{self, Wanted};
use crate::measure::Counts;
use crate::render::GradientFigures;
use crate::scene::{FilePath, SceneOptions, TransferChoice};
use crate::volume::files_of;

use super::engine::{DeviceOptions, Engine};
use super::load::{Source, ms_since};
use super::outputs::{OutputOptions, absolute};
use super::progress::Bars;
use super::scene::SceneArgument;
use super::stats::{Memory, Stats, Times, VolumeStats};
use super::terminal::{message, note};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Render a volume to a picture
#[derive(clap::Args)]
#[command(override_usage = "angioray render VOLUME -o FILE [OPTIONS]")]
#[command(after_help = "Example:
  angioray render head.nrrd -o head.png
  angioray render head.nrrd -o head.png --mode mip --view left --zoom 1.5
  angioray render cta.nii.gz -o cta.png --mode dvr --tf cta --shading phong --carm 'LAO 30 CRA 20'
  angioray render head.nrrd -o head.exr --iso 50% --aov all --stats head.json --device reference")]
pub struct RenderArguments {
    #[command(flatten)]
    options: SceneOptions,

    #[command(flatten)]
    scene: SceneArgument,

    #[command(flatten)]
    output: OutputOptions,

    #[command(flatten)]
    device: DeviceOptions,
}

impl RenderArguments {
    pub fn run(self) -> Result<()> {
        let file = self.scene.open()?;
        let options = self.options.over(SceneOptions::of_file(&file)?);
        let transfer_file = options.picture.tf.as_ref().and_then(TransferChoice::file);
        let mut options = options.checked()?;
        let output = OutputOptions::of_file(&file)?;
        let output = self.output.clone().over(self.output.keep_of(output));
        let device = self.device.keep_of(file.group()?);
        let device = self.device.over(device);

        let files = output.files()?;
        let source = Source::of(&options.volume)?;
        let volume_files = files_of(&source.path);
        let inputs = [self.scene.path(), transfer_file.as_deref()];
        let volume_files = volume_files.iter().map(PathBuf::as_path);
        let inputs: Vec<&Path> = inputs.into_iter().flatten().chain(volume_files).collect();
        files.check(&inputs)?;
        // The scene that is stored renders the same volume from wherever it is read, in the same
        // way.
        options.volume.volume = Some(FilePath(absolute(&source.path)));
        options.volume.octree_leaf = Some(source.leaf.edge());
        let engine = Engine::open(&device)?;

        let bars = Bars::new();
        let loaded = source.load(&bars)?;
        let resolved = options.resolve(&loaded.subject)?;
        resolved.notes.iter().for_each(note);
        files.encoding.check_size(resolved.scene.size)?;

        let wanted = Wanted::for_encoding(&files.encoding, files.stats.is_some());
        let prepared = engine.prepare(&loaded.volume, &source, &bars)?;
        let mut caster = engine.caster(&loaded.volume, &prepared)?;
        let rendered = caster.render(&resolved.scene, wanted, &bars)?;

        if let Some(figures) = &rendered.gradients {
            note(gradient_note(figures));
        }
        let began = Instant::now();
        let scene_text = resolved.options.to_toml()?;
        let metadata = [("scene", scene_text.as_str()), ("version", VERSION)];
        frame::write(&files.picture, &rendered.frame, &files.encoding, &metadata)?;
        let times_ms = Times {
            read: loaded.read_ms,
            smooth: loaded.smooth_ms,
            encode: ms_since(began),
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
            volume: VolumeStats::of(&source.path, &loaded.volume, loaded.non_finite),
            device: rendered.device,
            channels: frame::channels(&files.encoding),
            times_ms,
            passes: rendered.passes,
            counts: Counts::of(&rendered.frame, &resolved.scene.picture),
            memory: Memory::now(
                rendered.device_bytes,
                rendered.gradients.map_or(0, |figures| figures.bytes),
                rendered.uploaded_bytes,
            ),
        };
        stats.write(path)
    }
}

/// What precomputed gradients cost and are worth.
fn gradient_note(figures: &GradientFigures) -> String {
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
