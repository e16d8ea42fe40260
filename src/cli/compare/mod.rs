//! `angioray compare`.

mod checks;
mod options;
mod page;
mod reference_cache;

use std::path::PathBuf;
use std::time::Instant;

use crate::error::{Error, Result};
use crate::lab::compare::{
    Comparison, Configs, Folder, Look, ModeSettings, Preset, Row, printed_table,
};
use crate::lab::measure::Peer;
use crate::octree::Octree;
use crate::options::{Count, ErrorBound, FilePath, SceneOptions, ToleranceOptions};
use crate::progress::{Stage, UNKNOWN_TOTAL};
use crate::render::Renderer;
use crate::scene::Mode;

use super::backend::{Backend, DeviceOptions};
use super::progress::Bars;
use super::scene::SceneArgument;
use super::source::{Loaded, Source, ms_since};
use super::terminal::{lines_to_stdout, message, note};
use options::{CompareOptions, Named};
use page::{about, report};
use reference_cache::reference_cache;

/// Render modes and settings side by side, each with its error against the reference and its time
#[derive(clap::Args)]
#[command(override_usage = "angioray compare VOLUME -o DIR [OPTIONS]")]
#[command(after_help = "Example:
  angioray compare head.nrrd -o head
  angioray compare cta.nii.gz -o cta --modes iso,dvr --iso 150 --tf cta --azimuth 30
  angioray compare head.nrrd -o head --preset lighting --modes iso --iso 150
  angioray compare head.nrrd -o head --modes mip --configs steps.toml --repeats 9
  angioray compare head.nrrd -o head --peer 'target/peers-venv/bin/python scripts/peers/vtk_peer.py'

An option applies to the modes that it belongs to: --iso and --tf can be given together. All modes are seen
from one place: with --fit content, what any of them shows fits their pictures.

The options --sampling, --step, --filter and the like make one more setting, 'as given'; what
--max-error chooses is another. All are compared with the reference of the scene, in linear
interpolation and with central differences.

Stopped by Ctrl-C or SIGTERM it ends at once with exit code 75; the results so far are in the folder, and
the reference's pictures are cached for the next run.

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

/// The modes that are compared if none are named.
const MODES: [Mode; 4] = [Mode::Iso, Mode::Mip, Mode::Lmip, Mode::Dvr];
const REPEATS: u32 = 5;

/// A comparison as flags and scene file request it.
struct Request {
    output: PathBuf,
    compare: CompareOptions,
    options: SceneOptions,
    /// The flags alone, without the volume's properties.
    flags: SceneOptions,
    modes: Vec<Mode>,
    configs: Option<Configs>,
    bound: Option<ErrorBound>,
    device: DeviceOptions,
    scene_file: SceneArgument,
}

impl CompareArguments {
    pub fn run(self) -> Result<()> {
        let request = self.request()?;
        request.check_flags()?;
        let source = Source::of(&request.options.volume)?;
        let mut options = source.stored(request.options.clone());
        // Results and pictures are passed on together: they name the volume, not its place.
        options.volume.volume = Some(FilePath(source.name().to_owned()));
        let Backend::Device {
            device,
            options: use_of_device,
        } = Backend::open(&request.device)?
        else {
            return Err(Error::usage(
                "the reference cannot be compared: it is what others are compared with",
            )
            .hint("choose an OpenCL device: 'angioray devices' lists them"));
        };
        let folder = Folder::new(&request.output)?;
        request.check_inputs(&folder, &source, &options)?;
        let commands = request.compare.peer.as_deref().unwrap_or_default();
        let mut peers = commands
            .iter()
            .map(|command| Peer::start(command))
            .collect::<Result<Vec<Peer>>>()?;

        let bars = Bars::new();
        let mut loaded = source.load(Some(device.info()), &bars)?;
        let modes = request.mode_settings(options, &mut loaded)?;
        load_into(&mut peers, &loaded, &bars)?;
        let began = Instant::now();
        let octree = Octree::build(&loaded.volume, source.leaf, &bars)?;
        let octree_ms = ms_since(began);
        let mut renderer = Renderer::new(&device, &loaded.volume, &octree, use_of_device)?;
        let repeats = request.compare.repeats.map_or(REPEATS, Count::get);
        let comparison = Comparison {
            volume: &loaded.volume,
            subject: loaded.subject,
            reference: reference_cache(request.compare.cache, &loaded.volume)?,
            modes,
            repeats: repeats as usize,
            about: about(&device, &source, &loaded, octree_ms, repeats),
            folder,
            progress: &bars,
        };
        comparison.check(&peers)?;
        message(format_args!("compare on {}", device.info().name));
        let compared = comparison.run(&mut renderer, &mut peers)?;
        let (rows, findings) = (compared.rows.clone(), compared.findings.clone());
        report(&comparison, compared, &device, &source, &peers)
            .write(&comparison.folder.report())?;
        print_results(&comparison.folder, &rows, &findings)
    }

    /// Merges the flags with the scene file.
    fn request(mut self) -> Result<Request> {
        let named = Named::take(&mut self.compare, &mut self.options);
        named.check()?;
        let file = self.scene.open()?;
        let mut compare = CompareOptions::of_file(&file)?;
        let mut options = SceneOptions::of_file(&file)?;
        let of_file = Named::take(&mut compare, &mut options);
        let modes = named.modes().or_else(|| of_file.modes());
        let compare = self.compare.over(compare);
        let options = self.options.clone().over(options);
        // Beside settings that are given: the one that it chooses is a candidate like the others.
        let bound = self.tolerance.over(file.group()?).max_error;
        let device = self.device.over_file(file.group()?);
        let Some(FilePath(output)) = compare.output.clone() else {
            return Err(Error::usage("no folder for the comparison was named")
                .hint("give it with '--output', or as 'output' in the scene file"));
        };
        let configs = compare.configs.as_ref();
        let configs = configs
            .map(|FilePath(path)| Configs::read(path))
            .transpose()?;
        let of_configs = || configs.as_ref().and_then(Configs::modes);
        let of_preset = || Some(compare.preset?.modes().to_vec());
        let modes = modes.or_else(of_configs).or_else(of_preset);
        let modes = modes.unwrap_or(MODES.to_vec());
        Ok(Request {
            output,
            compare,
            options,
            flags: self.options,
            modes,
            configs,
            bound,
            device,
            scene_file: self.scene,
        })
    }
}

impl Request {
    fn check_flags(&self) -> Result<()> {
        if let Some(preset) = self.compare.preset {
            self.modes.iter().try_for_each(|&mode| preset.check(mode))?;
        }
        checks::meaning(&self.flags, &self.modes)?;
        match self.bound {
            Some(bound) => checks::bound(bound, &self.modes),
            None => Ok(()),
        }
    }

    fn check_inputs(&self, folder: &Folder, source: &Source, options: &SceneOptions) -> Result<()> {
        let configs = self.compare.configs.as_ref();
        let configs = configs.map(|FilePath(path)| path.as_path());
        checks::inputs(folder, source, options, self.scene_file.path(), configs)
    }

    /// Each mode in each look.
    fn seen(&self) -> Vec<(Mode, Option<Look>)> {
        let looks = self.compare.preset.map(Preset::looks);
        let looks = looks.map_or(vec![None], |looks| looks.map(Some).to_vec());
        let in_looks = |&mode: &Mode| looks.iter().map(move |&look| (mode, look));
        self.modes.iter().flat_map(in_looks).collect()
    }

    /// The modes in their settings, all seen from one place, about which the user is notified.
    fn mode_settings(
        &self,
        options: SceneOptions,
        loaded: &mut Loaded,
    ) -> Result<Vec<ModeSettings>> {
        let options = loaded.measured(options);
        let seen = self.seen();
        let shown = seen.iter();
        let shown = shown.map(|&(mode, look)| ModeSettings::seen(mode, look, &options));
        loaded.frame(&shown.collect::<Result<Vec<_>>>()?)?;
        let seen = seen.into_iter();
        let mut modes = seen
            .map(|seen| mode_settings(seen, &options, self.configs.as_ref(), loaded))
            .collect::<Result<Vec<ModeSettings>>>()?;
        if let Some(bound) = self.bound {
            add_bound(&mut modes, bound);
        }
        for of_mode in &modes {
            let notes = of_mode.resolved.notes.iter();
            notes.for_each(|sentence| note(format_args!("{}: {sentence}", of_mode.name())));
        }
        Ok(modes)
    }
}

/// Gives the peers the volume.
fn load_into(peers: &mut [Peer], loaded: &Loaded, bars: &Bars) -> Result<()> {
    for peer in peers {
        let name = format!("{} loads the volume", peer.name());
        let _stage = Stage::begin(bars, &name, UNKNOWN_TOTAL);
        peer.load(&loaded.volume)?;
    }
    Ok(())
}

/// A mode in its settings: those of the file, or the built-in ones, and what the flags say of how
/// rays are followed as a further one.
fn mode_settings(
    (mode, look): (Mode, Option<Look>),
    options: &SceneOptions,
    configs: Option<&Configs>,
    loaded: &Loaded,
) -> Result<ModeSettings> {
    let settings = configs.map(|configs| configs.of_mode(mode));
    let mut of_mode = ModeSettings::new((mode, look), options, settings, &loaded.subject)?;
    of_mode.add_given(options, &loaded.subject)?;
    Ok(of_mode)
}

/// Lets a bound choose a setting in every mode that has its metric, and notes the others.
fn add_bound(modes: &mut [ModeSettings], bound: ErrorBound) {
    for of_mode in modes {
        if of_mode.add_bound(bound).is_err() {
            note(format_args!(
                "{}: max-error {bound} has no meaning there, nothing is chosen",
                of_mode.name()
            ));
        }
    }
}

/// Prints the results, where their files are, and what failed.
fn print_results(folder: &Folder, rows: &[Row], findings: &[String]) -> Result<()> {
    lines_to_stdout(|out| {
        let table = printed_table(rows).markdown();
        table.iter().try_for_each(|line| out.line(line))?;
        out.line("")?;
        let mut findings = findings.iter();
        findings.try_for_each(|sentence| out.line(format_args!("- {sentence}")))
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
