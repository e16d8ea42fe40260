//! `angioray compare`.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;

use crate::compare::{Comparison, Configs, Folder, ModeSettings, Row, printed_table};
use crate::error::{Error, Result};
use crate::measure::{Peer, Truth};
use crate::octree::Octree;
use crate::render::{Options, Renderer};
use crate::scene::options::group::group;
use crate::scene::options::plain::readable;
use crate::scene::{
    ErrorBound, FilePath, Mode, SceneFile, SceneOptions, ToleranceOptions, TransferChoice,
};
use crate::volume::files_of;

use super::compared::{about, report};
use super::engine::{DeviceOptions, Engine};
use super::load::{Loaded, Source, ms_since};
use super::outputs;
use super::progress::Bars;
use super::scene::SceneArgument;
use super::terminal::{message, note, to_stdout};

/// Render modes and settings side by side, judged against the reference and timed
#[derive(clap::Args)]
#[command(override_usage = "angioray compare VOLUME -o DIR [OPTIONS]")]
#[command(after_help = "Example:
  angioray compare head.nrrd -o head
  angioray compare cta.nii.gz -o cta --modes iso,dvr --iso 150 --tf cta --azimuth 30
  angioray compare head.nrrd -o head --modes mip --configs steps.toml --repeats 9
  angioray compare head.nrrd -o head --peer 'target/peers-venv/bin/python scripts/peers/vtk_peer.py'

A file of settings, for --configs:
  [[setting]]
  name = \"coarse\"
  modes = [\"iso\", \"mip\"]
  step = 2
  probe = \"off\"")]
pub struct CompareArguments {
    #[command(flatten)]
    compare: CompareOptions,

    #[command(flatten)]
    options: SceneOptions,

    #[command(flatten)]
    scene: SceneArgument,

    #[command(flatten)]
    tolerance: ToleranceOptions,

    #[command(flatten)]
    device: DeviceOptions,
}

group! {
    /// What is compared, and where it goes.
    #[command(next_help_heading = "Comparison")]
    pub struct CompareOptions {
        /// A folder for report.html, results.json, results.csv, the pictures and their error maps;
        /// made where there is none
        #[arg(short, long, value_name = "DIR")]
        output: FilePath,

        /// The modes, with commas between [default: the one of --mode, else iso,mip,lmip,dvr]
        #[arg(long, value_name = "LIST")]
        modes: Modes,

        /// Compare the settings of this TOML file in place of the built-in ones
        #[arg(long, value_name = "FILE.toml")]
        configs: FilePath,

        /// How often each setting is timed, after one frame to warm up, all in turn [default: 5]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        repeats: u32,

        /// Another renderer to compare with, as a command line that speaks the protocol of
        /// scripts/peers; may be given several times
        #[arg(long, value_name = "COMMAND")]
        peer: Vec<String>,

        /// Where the reference's pictures are kept, so that each is computed once: a folder, or off
        /// [default: angioray in the user's cache folder]
        #[arg(long, value_name = "DIR|off")]
        cache: FilePath,
    }
}

/// Those shown where none are named.
const MODES: [Mode; 4] = [Mode::Iso, Mode::Mip, Mode::Lmip, Mode::Dvr];
const REPEATS: u32 = 5;

impl CompareArguments {
    pub fn run(mut self) -> Result<()> {
        let named = Named::take(&mut self.compare, &mut self.options);
        named.check()?;
        let file = self.scene.open()?;
        let mut compare = CompareOptions::of_file(&file)?;
        let mut options = SceneOptions::of_file(&file)?;
        let of_file = Named::take(&mut compare, &mut options);
        let modes = named.modes().or_else(|| of_file.modes());
        let modes = modes.unwrap_or_else(|| MODES.to_vec());
        let compare = self.compare.over(compare);
        let options = self.options.over(options);
        // Beside settings that are given: the one that it chooses is a contender like the others.
        let bound = self.tolerance.over(file.group()?).max_error;
        let device = self.device.keep_of(file.group()?);
        let device = self.device.over(device);

        let Some(FilePath(output)) = &compare.output else {
            return Err(Error::usage("no folder for the comparison was named")
                .hint("give it by '--output', or as 'output' in the scene file"));
        };
        let repeats = compare.repeats.unwrap_or(REPEATS);
        if repeats == 0 {
            return Err(Error::usage("'--repeats 0' times nothing").hint("give a number from 1 on"));
        }
        let configs = compare.configs.as_ref();
        let configs = configs
            .map(|FilePath(path)| Configs::read(path))
            .transpose()?;
        let source = Source::of(&options.volume)?;
        let Engine::Device { device, work_group } = Engine::open(&device)? else {
            return Err(Error::usage(
                "the reference cannot be compared: it is what others are held against",
            )
            .hint("choose an OpenCL device: 'angioray devices' lists them"));
        };
        let folder = Folder::new(output)?;
        let configs_file = compare
            .configs
            .as_ref()
            .map(|FilePath(path)| path.as_path());
        check_inputs(&folder, &source, &options, self.scene.path(), configs_file)?;
        let commands = compare.peer.as_deref().unwrap_or_default();
        let mut peers = commands
            .iter()
            .map(|command| Peer::start(command))
            .collect::<Result<Vec<Peer>>>()?;

        let bars = Bars::new();
        let loaded = source.load(&bars)?;
        let mut modes = modes
            .into_iter()
            .map(|mode| mode_settings(mode, &options, configs.as_ref(), &loaded))
            .collect::<Result<Vec<ModeSettings>>>()?;
        if let Some(bound) = bound {
            add_bound(&mut modes, bound)?;
        }
        for of_mode in &modes {
            let notes = of_mode.resolved.notes.iter();
            notes.for_each(|sentence| note(format_args!("{}: {sentence}", of_mode.mode)));
        }
        folder.make()?;
        for peer in &mut peers {
            peer.load(&loaded.volume)?;
        }
        let began = Instant::now();
        let octree = Octree::build(&loaded.volume, source.leaf, &bars)?;
        let octree_ms = ms_since(began);
        let options = Options {
            work_group: work_group.map(Into::into),
        };
        let mut renderer = Renderer::new(&device, &loaded.volume, &octree, options)?;
        let truth = match cache_folder(compare.cache) {
            Some(folder) => Truth::kept_in(&folder, &loaded.volume)?,
            None => Truth::uncached(&loaded.volume),
        };
        let comparison = Comparison {
            volume: &loaded.volume,
            subject: loaded.subject,
            truth,
            modes,
            repeats: repeats as usize,
            about: about(&device, &source, &loaded, octree_ms, repeats),
            folder,
            progress: &bars,
        };
        message(format_args!("compare on {}", device.info().name));
        let compared = comparison.run(&mut renderer, &mut peers)?;
        let (rows, findings) = (compared.rows.clone(), compared.findings.clone());
        report(&comparison, compared, &device, &source, &peers)
            .write(&comparison.folder.report())?;
        tell(&comparison.folder, &rows, &findings)
    }
}

impl CompareOptions {
    /// What a scene file says of the comparison; the files that it names are relative to it.
    fn of_file(file: &SceneFile) -> Result<Self> {
        let options = file.group::<Self>()?;
        let named_here = |path: FilePath| file.named_here(path);
        let is_off = |FilePath(path): &FilePath| path.as_os_str() == OFF;
        Ok(Self {
            output: options.output.map(named_here),
            configs: options.configs.map(named_here),
            cache: options.cache.map(|path| {
                if is_off(&path) {
                    path
                } else {
                    file.named_here(path)
                }
            }),
            ..options
        })
    }
}

/// `--modes`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Modes(Vec<Mode>);

impl FromStr for Modes {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let modes = text.split(',').map(str::parse::<Mode>);
        let modes: Vec<Mode> = modes.collect::<Result<_>>()?;
        match modes
            .iter()
            .enumerate()
            .find(|(at, mode)| modes[..*at].contains(mode))
        {
            Some((_, twice)) => Err(Error::usage(format!("'{twice}' is named twice"))),
            None => Ok(Self(modes)),
        }
    }
}

readable!(Modes);

/// The modes that are named: several, or one.
struct Named(Option<Modes>, Option<Mode>);

impl Named {
    /// Takes them out of the options, whose modes are those of a single picture.
    fn take(compare: &mut CompareOptions, options: &mut SceneOptions) -> Self {
        Self(compare.modes.take(), options.picture.mode.take())
    }

    /// # Errors
    /// Usage: both, and not the same.
    fn check(&self) -> Result<()> {
        match self {
            Self(Some(Modes(modes)), Some(mode)) if modes != &[*mode] => Err(Error::usage(
                "'--modes' and '--mode' exclude each other: both say what is compared",
            )
            .hint("leave out '--mode'")),
            _ => Ok(()),
        }
    }

    fn modes(self) -> Option<Vec<Mode>> {
        let Self(several, one) = self;
        let several = several.map(|Modes(modes)| modes);
        several.or_else(|| Some(vec![one?]))
    }
}

/// A mode in its settings: those of the file, or the built-in ones, and what the flags say of how
/// rays are followed as a further one.
fn mode_settings(
    mode: Mode,
    options: &SceneOptions,
    configs: Option<&Configs>,
    loaded: &Loaded,
) -> Result<ModeSettings> {
    let settings = configs.map(|configs| configs.of_mode(mode));
    let mut of_mode = ModeSettings::new(mode, options, settings, &loaded.subject)?;
    of_mode.add_given(options, &loaded.subject)?;
    Ok(of_mode)
}

/// Lets a bound choose a setting in every mode that has its metric.
fn add_bound(modes: &mut [ModeSettings], bound: ErrorBound) -> Result<()> {
    let added: Vec<Result<()>> = modes.iter_mut().map(|mode| mode.add_bound(bound)).collect();
    match added.iter().any(Result::is_ok) {
        true => Ok(()),
        false => added.into_iter().collect(),
    }
}

/// That no file of the comparison replaces one that it reads.
fn check_inputs(
    folder: &Folder,
    source: &Source,
    options: &SceneOptions,
    scene: Option<&Path>,
    configs: Option<&Path>,
) -> Result<()> {
    let transfer = options.picture.tf.as_ref().and_then(TransferChoice::file);
    let volume = files_of(&source.path);
    let others = [scene, configs, transfer.as_deref()].into_iter().flatten();
    let inputs: Vec<&Path> = volume.iter().map(PathBuf::as_path).chain(others).collect();
    for file in [folder.json(), folder.csv(), folder.report()] {
        outputs::check(&file, &inputs)?;
    }
    Ok(())
}

/// Turns the cache off.
const OFF: &str = "off";

/// Where reference pictures are kept: where the user says, else where programs of this system keep
/// what can be made again (XDG Base Directory Specification).
fn cache_folder(asked: Option<FilePath>) -> Option<PathBuf> {
    match asked {
        Some(FilePath(path)) if path.as_os_str() == OFF => None,
        Some(FilePath(path)) => Some(path),
        None => {
            let named = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
            let named = named.filter(|path| path.is_absolute());
            let home = || Some(std::env::home_dir()?.join(".cache"));
            Some(named.or_else(home)?.join("angioray"))
        }
    }
}

/// Says on stdout what came out, where it lies, and what failed.
fn tell(folder: &Folder, rows: &[Row], findings: &[String]) -> Result<()> {
    to_stdout(|out| {
        writeln!(out, "{}", printed_table(rows).markdown())?;
        findings
            .iter()
            .try_for_each(|sentence| writeln!(out, "- {sentence}"))
    })?;
    for path in [folder.report(), folder.json(), folder.csv()] {
        message(format_args!("wrote {}", path.display()));
    }
    let failed: Vec<&Row> = rows.iter().filter(|row| row.failure.is_some()).collect();
    let Some(first) = failed.first() else {
        return Ok(());
    };
    let why = first.failure.as_deref().unwrap_or_default();
    Err(Error::failed(format!(
        "{} of {} settings failed: {}: {}: {why}",
        failed.len(),
        rows.len(),
        first.mode,
        first.title()
    ))
    .hint("the rows of the others are in the results"))
}
