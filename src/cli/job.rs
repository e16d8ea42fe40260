//! What every command that renders is given: the scene, the files, the device.

use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::options::{ErrorBound, SceneFile, SceneOptions, ToleranceOptions, TransferChoice};
use crate::volume::files_of;

use super::backend::DeviceOptions;
use super::outputs::OutputOptions;
use super::scene::SceneArgument;
use super::source::Source;

#[derive(clap::Args)]
pub struct JobArguments {
    #[command(flatten)]
    options: SceneOptions,

    #[command(flatten)]
    tolerance: ToleranceOptions,

    #[command(flatten)]
    scene: SceneArgument,

    #[command(flatten)]
    output: OutputOptions,

    #[command(flatten)]
    device: DeviceOptions,
}

/// Flags over the scene file, checked as far as can be without reading the volume.
pub struct Job {
    /// The options of the scene as pictures store them ([`Source::stored`]).
    pub options: SceneOptions,
    /// Decides how rays are followed, where there is one.
    pub bound: Option<ErrorBound>,
    pub output: OutputOptions,
    pub device: DeviceOptions,
    pub source: Source,
    /// Every file that is read.
    pub inputs: Vec<PathBuf>,
}

impl JobArguments {
    /// The scene file named, or one that says nothing.
    pub fn scene_file(&self) -> Result<SceneFile> {
        self.scene.open()
    }

    /// Lays these flags over a scene file's options.
    ///
    /// # Errors
    /// Options that contradict each other or an error bound, a transfer function that cannot be read, no volume.
    pub fn over(self, file: &SceneFile) -> Result<Job> {
        let mut of_file = SceneOptions::of_file(file)?;
        let tolerance = self.tolerance;
        let tolerance = tolerance.over_file(file.group()?, &self.options, &mut of_file);
        let flag_mode = self.options.picture.mode;
        let options = self.options.over(of_file);
        let transfer_file = options.picture.tf.as_ref().and_then(TransferChoice::file);
        let options = options.checked()?;
        tolerance.check(&options)?;
        let output = OutputOptions::of_file(file)?;
        let output = self.output.over_file(output, flag_mode);
        let device = self.device.over_file(file.group()?);

        let source = Source::of(&options.volume)?;
        let scene_file = self.scene.path().map(Path::to_owned);
        let mut inputs: Vec<PathBuf> = scene_file.into_iter().chain(transfer_file).collect();
        inputs.extend(files_of(&source.path));
        Ok(Job {
            options: source.stored(options),
            bound: tolerance.max_error,
            output,
            device,
            source,
            inputs,
        })
    }
}
