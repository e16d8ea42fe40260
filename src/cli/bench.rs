//! `angioray bench`.

use std::path::Path;

use clap::builder::StyledStr;

use crate::error::{Error, ErrorKind, Result};
use crate::gpu::DeviceInfo;
use crate::lab::bench::{
    Bench, Dataset, EXPERIMENTS, Experiment, Outcome, Preset, Protocol, Store,
};
use crate::number_text::concise;
use crate::options::group::{Keys, group};
use crate::options::rules::{Group, Need, unmet};
use crate::options::text_form::one_or_more;
use crate::options::{Count, FilePath, SceneFile, Switch, Threshold, VolumeOptions};
use crate::progress::Progress;
use crate::volume::percentiles;

use super::backend::{Backend, DeviceOptions};
use super::phantom::Seed;
use super::progress::Bars;
use super::repeat::command_line;
use super::scene::SceneArgument;
use super::source::Source;
use super::stopping;
use super::terminal::{lines_to_stdout, message, note};

/// Measure the renderer: speed against error, as a table
#[derive(clap::Args)]
#[command(override_usage = "angioray bench EXPERIMENT [VOLUME...] [OPTIONS]")]
#[command(after_help = after_help())]
pub struct BenchArguments {
    #[command(flatten)]
    bench: BenchOptions,

    #[command(flatten)]
    scene: SceneArgument,

    #[command(flatten)]
    device: DeviceOptions,
}

group! {
    /// The options of a measurement: what is measured, and how thoroughly.
    pub struct BenchOptions {
        /// The experiment's name
        #[arg(value_name = "EXPERIMENT")]
        experiment: String,

        /// Volumes that are measured, in most experiments in place of a phantom; a headerless one
        /// by what its name says, such as head_256x256x256_uint8.raw.gz
        #[arg(value_name = "VOLUME")]
        #[serde(deserialize_with = "one_or_more")]
        volumes: Vec<FilePath>,

        /// The iso value of the volumes: a number, a share of the value range such as
        /// 50%, a percentile of the voxels such as p99.5, or otsu [default: suggested by each one's
        /// histogram]
        #[arg(long, value_name = "VALUE|N%|pN|otsu", allow_hyphen_values = true)]
        iso: Threshold,

        /// How frames are timed: static, the camera where it is; or orbit, once around the volume
        /// in 36 frames (12 with --quick) [default: static; b15 and sparse: both]
        #[arg(long, value_name = "static|orbit")]
        protocol: Protocol,

        /// Rays in the experiment rays, pixels in sparse-rays [default: 10000000; a tenth of it with
        /// --quick, ten times as many with --full]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        rays: Count<u64>,

        /// Decides the volumes and the rays of the experiments rays and sparse-rays [default: 4]
        #[arg(long, value_name = "S", allow_hyphen_values = true)]
        seed: Seed,

        /// Frames of which each mode is timed in the experiment speed [default: as many as take it
        /// about three seconds, 5 to 41]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        frames: Count,

        /// Another renderer to time in the experiment speed, as a command line that speaks the protocol
        /// of scripts/peers/README.md in angioray's source
        #[arg(long, value_name = "COMMAND")]
        peer: String,

        /// A folder for the table as results.csv and results.json, unrounded, and as report.html, with
        /// pictures; created if it does not exist. It fills during the work: the same command resumes
        /// a run that was stopped
        #[arg(short, long, value_name = "DIR")]
        output: FilePath,

        /// Discard what a stopped run has left in the folder
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        restart: Switch,

        /// Pictures of 128 pixels a side, 3 repeats [default: 256, 5 repeats]
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        quick: Switch,

        /// Pictures of 512 pixels a side, 7 repeats
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        full: Switch,
    }
}

/// The experiments, how a run is resumed, examples.
fn after_help() -> StyledStr {
    let mut text = String::from("Experiments:");
    for experiment in EXPERIMENTS {
        text.push_str(&format!("\n  {}: {}", experiment.name, experiment.about));
    }
    text.push_str(
        "

A run with --output that is stopped, by Ctrl-C or SIGTERM, ends with exit code 75; the same command
resumes it.

Example:
  angioray bench vessels
  angioray bench vessels head.nrrd cta.mha -o results --full
  angioray bench pareto head.nrrd -o results --quick
  angioray bench tolerance -o results
  angioray bench sparse head.nrrd -o sparse --quick
  angioray bench speed -o speed --peer 'target/peers-venv/bin/python scripts/peers/vtk_peer.py'
  angioray bench b1 head.nrrd --iso 50% --protocol orbit -o results
  angioray bench traversals head_256x256x256_uint8.raw.gz",
    );
    text.into()
}

impl BenchArguments {
    pub fn run(self) -> Result<()> {
        let (options, device) = self.merged()?;
        let experiment = options.experiment()?;
        options.check(experiment)?;
        let preset = options.preset()?;
        if options.output.is_some() {
            stopping::between_parts("unit of work", ErrorKind::Stopped)?;
        } else {
            stopping::at_once("without --output nothing is saved")?;
        }
        let Backend::Device {
            device,
            options: use_of_device,
        } = Backend::open(&device)?
        else {
            return Err(Error::usage(
                "the reference cannot be measured: it is what others are compared with",
            )
            .hint("choose an OpenCL device: 'angioray devices' lists them"));
        };

        let bars = Bars::new();
        let datasets = options.datasets(device.info(), &bars)?;
        let mut bench = Bench {
            experiment,
            command: command_line(),
            device: &device,
            options: use_of_device,
            preset,
            protocol: options.protocol,
            datasets,
            rays: options.rays.map(Count::get),
            seed: options.seed.map(|Seed(seed)| seed),
            frames: options.frames.map(Count::get),
            peer: options.peer.clone(),
            progress: &bars,
            store: None,
        };
        bench.store = options.store(&bench)?;
        let name = options.experiment.as_deref().unwrap_or(experiment.name);
        message(format_args!("bench {name} on {}", device.info().name));
        let outcome = (experiment.run)(&bench)?;
        print_outcome(&outcome)?;
        if let Some(store) = &bench.store {
            for path in store.finish(&bench, &outcome)? {
                message(format_args!("wrote {}", path.display()));
            }
        }
        match outcome.failure {
            Some(sentence) => Err(Error::failed(sentence)),
            None => Ok(()),
        }
    }

    /// Merges the flags with the scene file.
    fn merged(self) -> Result<(BenchOptions, DeviceOptions)> {
        let file = self.scene.open()?;
        let options = self.bench.over_file(BenchOptions::of_file(&file)?);
        Ok((options, self.device.over_file(file.group()?)))
    }
}

fn is_on(switch: Option<Switch>) -> bool {
    switch.is_some_and(Switch::is_on)
}

impl BenchOptions {
    /// Takes the options from a scene file; the files that it names are relative to it.
    fn of_file(file: &SceneFile) -> Result<Self> {
        let options = file.group::<Self>()?;
        let named_here = |volumes: Vec<FilePath>| {
            let volumes = volumes.into_iter();
            volumes.map(|volume| file.named_here(volume)).collect()
        };
        Ok(Self {
            output: options.output.map(|path| file.named_here(path)),
            volumes: options.volumes.map(named_here),
            ..options
        })
    }

    /// Lays these flags over a scene file's options: --quick or --full says all that a file says by both
    /// keys.
    fn over_file(self, mut file: Self) -> Self {
        if is_on(self.quick) || is_on(self.full) {
            (file.quick, file.full) = (None, None);
        }
        self.over(file)
    }

    fn experiment(&self) -> Result<&'static Experiment> {
        let Some(name) = &self.experiment else {
            let names: Vec<&str> = EXPERIMENTS.iter().map(|one| one.name).collect();
            return Err(Error::usage("no experiment was named")
                .hint(format!("write one of {}", names.join(", "))));
        };
        Experiment::named(name)
    }

    fn volumes(&self) -> &[FilePath] {
        self.volumes.as_deref().unwrap_or_default()
    }

    /// Checks that every option has an effect in the experiment.
    ///
    /// # Errors
    /// Usage: one has none.
    fn check(&self, experiment: &Experiment) -> Result<()> {
        let name = experiment.name;
        let has_volumes = !self.volumes().is_empty();
        if has_volumes && !experiment.takes_volumes {
            return Err(Error::usage(format!(
                "the experiment '{name}' takes no volumes: it makes its own"
            )));
        }
        let is_met = |need| match need {
            Need::AimedRays => experiment.counts_rays,
            Need::TimedFrames => experiment.times_frames,
            Need::Rounds => experiment.takes_peer,
            Need::Volumes => has_volumes,
            // To forget nothing needs no folder.
            Need::ResultsFolder => self.output.is_some() || !is_on(self.restart),
            _ => true,
        };
        let Some((option, need)) = unmet(Group::Bench, &self.given(), is_met) else {
            return Ok(());
        };
        Err(match need {
            Need::TimedFrames => Error::usage(format!(
                "'--{option}' has no effect in the experiment '{name}', which times no frames, or moves the camera by itself"
            )),
            Need::Volumes => Error::usage(format!("'--{option}' has no effect without a volume"))
                .hint("name the volumes that it is meant for"),
            Need::ResultsFolder => {
                Error::usage(format!("'--{option}' has no effect without '--output'"))
            }
            _ => Error::usage(format!(
                "'--{option}' has no effect in the experiment '{name}'"
            )),
        })
    }

    /// How thoroughly to measure.
    ///
    /// # Errors
    /// Usage: both --quick and --full.
    fn preset(&self) -> Result<Preset> {
        match (is_on(self.quick), is_on(self.full)) {
            (true, true) => {
                Err(Error::usage("'quick' and 'full' cannot be combined")
                    .hint("choose one of them"))
            }
            (true, false) => Ok(Preset::Quick),
            (false, true) => Ok(Preset::Full),
            (false, false) => Ok(Preset::default()),
        }
    }

    /// The volumes that are named, each under a name of its own.
    fn datasets(&self, device: &DeviceInfo, progress: &dyn Progress) -> Result<Vec<Dataset>> {
        let mut datasets: Vec<Dataset> = Vec::new();
        for FilePath(path) in self.volumes() {
            let mut dataset = dataset(path, self.iso, device, progress)?;
            dataset.check()?;
            dataset.name = free_name(&dataset.name, |name| {
                datasets.iter().any(|other| other.name == name)
            });
            datasets.push(dataset);
        }
        Ok(datasets)
    }

    /// The folder of results, where one is named.
    fn store(&self, bench: &Bench) -> Result<Option<Store>> {
        let Some(FilePath(folder)) = &self.output else {
            return Ok(None);
        };
        let store = Store::in_folder(folder, &bench.run()?, is_on(self.restart))?;
        if store.known_units() > 0 {
            note(format_args!(
                "resumed: {} units of work were measured before",
                store.known_units()
            ));
        }
        Ok(Some(store))
    }
}

/// Prints the table and the findings.
fn print_outcome(outcome: &Outcome) -> Result<()> {
    lines_to_stdout(|out| {
        let table = outcome.table.markdown();
        table.iter().try_for_each(|line| out.line(line))?;
        out.line("")?;
        let mut findings = outcome.findings.iter();
        findings.try_for_each(|sentence| out.line(format_args!("- {sentence}")))
    })
}

/// A volume file, its iso value the user's or the one that the histogram suggests.
fn dataset(
    path: &Path,
    iso: Option<Threshold>,
    device: &DeviceInfo,
    progress: &dyn Progress,
) -> Result<Dataset> {
    let source = Source::of(&VolumeOptions {
        volume: Some(FilePath(path.to_owned())),
        ..VolumeOptions::default()
    })?;
    let loaded = source.load(Some(device), progress)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let percentile = iso.and_then(Threshold::percentile);
    let given = match (percentile, iso) {
        (Some(percent), _) => percentiles(&loaded.volume, &[percent]).first().copied(),
        (None, iso) => iso.map(|iso| iso.resolve(&loaded.subject)).transpose()?,
    };
    let range = loaded.volume.range();
    if let Some(given) = given
        && !(range.min..=range.max).contains(&given)
    {
        return Err(Error::usage(format!(
            "'--iso {}' lies outside the values of {}, {} to {}: there is no surface",
            concise(given),
            path.display(),
            concise(range.min),
            concise(range.max)
        ))
        .hint("name a value between them, or a share of the value range such as 50%"));
    }
    let dataset = Dataset {
        // Without the extension.
        name: name.split('.').next().unwrap_or_default().to_owned(),
        volume: loaded.volume,
        iso: given.unwrap_or(loaded.subject.suggested_iso),
    };
    if !matches!(iso, Some(Threshold::Value(_))) {
        let by = match iso {
            Some(iso) => iso.to_string(),
            None => "suggested by the histogram".to_owned(),
        };
        note(format_args!(
            "{}: iso = {}, {by}",
            dataset.name,
            concise(dataset.iso)
        ));
    }
    Ok(dataset)
}

/// The name, numbered from 2 on where it is taken.
fn free_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let mut free = name.to_owned();
    let mut number = 1;
    while is_taken(&free) {
        number += 1;
        free = format!("{name} ({number})");
    }
    free
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_names_are_numbered_until_one_is_free() {
        let mut names: Vec<String> = Vec::new();
        for name in ["head", "head (1)", "head", "head (3)", "head", "head (2)"] {
            let name = free_name(name, |other| names.iter().any(|taken| taken == other));
            names.push(name);
        }
        let expected = [
            "head",
            "head (1)",
            "head (2)",
            "head (3)",
            "head (4)",
            "head (2) (2)",
        ];
        assert_eq!(names, expected);
    }
}
