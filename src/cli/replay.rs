//! `angioray replay`.

use std::path::{Path, PathBuf};

use crate::VERSION;
use crate::error::{Error, ErrorKind, Result};
use crate::frame::{Format, read_encoding};
use crate::options::group::group;
use crate::options::{FilePath, SceneOptions};
use crate::volume::files_of;

use super::backend::{Backend, DeviceName, DeviceOptions};
use super::carried::Carried;
use super::job::Job;
use super::outputs::{Files, OutputOptions};
use super::progress::Bars;
use super::render::{Drawing, draw};
use super::scene::SceneArgument;
use super::source::{Loaded, Source};
use super::terminal::note;

/// Render a picture again, from the scene that it carries
///
/// The volume is looked for where the picture says, beside the picture, and in the working folder, and
/// must have the content that it had. On the same device the picture is the same, byte for byte; what
/// OUT is encoded with is what IMAGE is, where both have one format and no flag says otherwise.
#[derive(clap::Args)]
#[command(override_usage = "angioray replay IMAGE -o OUT [OPTIONS]")]
#[command(after_help = "Example:
  angioray replay head.png -o again.png
  angioray replay head.png -o again.exr --aov depth,normal --volume archive/head.nrrd
  angioray replay frames/0012.png -o large.png --bit-depth 16 --device reference

'angioray render --scene head.png --size 1024x1024 -o large.png' takes the scene and changes it.")]
pub struct ReplayArguments {
    #[command(flatten)]
    replay: ReplayOptions,

    #[command(flatten)]
    output: OutputOptions,

    #[command(flatten)]
    scene: SceneArgument,

    #[command(flatten)]
    device: DeviceOptions,
}

group! {
    /// The options that name the picture and its volume.
    pub struct ReplayOptions {
        /// The picture: a .png or .exr that render or orbit wrote
        #[arg(value_name = "IMAGE")]
        image: FilePath,

        /// The volume, if it is not where the picture says; its content must be the same
        #[arg(long, value_name = "FILE")]
        volume: FilePath,
    }
}

impl ReplayArguments {
    pub fn run(self) -> Result<()> {
        let file = self.scene.open()?;
        let of_file = file.group::<ReplayOptions>()?;
        let replay = self.replay.over(ReplayOptions {
            image: of_file.image.map(|path| file.named_here(path)),
            volume: of_file.volume.map(|path| file.named_here(path)),
        });
        let Some(FilePath(image)) = replay.image else {
            return Err(Error::usage("no picture was named")
                .hint("give its file as the first argument, or as 'image' in the scene file"));
        };
        let Some(carried) = Carried::of(&image)? else {
            return Err(Error::input(format!(
                "{}: not a picture that carries a scene: neither a .png nor an .exr",
                image.display()
            )));
        };
        let options = SceneOptions::of_whole(&carried.scene_file())?.checked()?;
        let stored = SceneOptions::parse(&carried.scene, "")?.volume.volume;
        let Some(stored) = stored else {
            return Err(Error::input(format!(
                "{}: its scene names no volume",
                image.display()
            )));
        };
        let places = match &replay.volume {
            Some(FilePath(path)) => vec![path.clone()],
            None => carried.scene_file().places(&stored),
        };
        let of_file = OutputOptions::of_file(&file)?;
        let output = self.output.over_file(of_file, Some(options.mode()));
        let files = as_it_was(output.clone().files(options.mode())?, &output, &carried)?;
        let device = self.device.over_file(file.group()?);
        let backend = open(device.clone(), &carried)?;

        let mut inputs = vec![image];
        inputs.extend(self.scene.path().map(Path::to_owned));
        places.iter().for_each(|path| inputs.extend(files_of(path)));
        files.check(&inputs)?;
        let bars = Bars::new();
        let (source, loaded) = found(&places, &options, &carried, &backend, &bars)?;
        let mut options = source.stored(options);
        options.volume.volume = Some(replay.volume.unwrap_or(stored));
        let job = Job {
            options,
            bound: None,
            output,
            device,
            source,
            inputs,
        };
        print_version(&carried);
        draw(Drawing {
            command: "replay",
            job: &job,
            files: &files,
            backend: &backend,
            loaded: &loaded,
            check_sampling: false,
            bars: &bars,
        })
    }
}

/// The files that are written: a picture of the same format as it was, where no flag says otherwise.
fn as_it_was(mut files: Files, output: &OutputOptions, carried: &Carried) -> Result<Files> {
    if files.encoding.format != carried.format {
        return Ok(files);
    }
    let was = read_encoding(&carried.picture)?;
    if output.bit_depth.is_none() {
        files.encoding.bit_depth = was.bit_depth;
    }
    if output.aov.is_none() && carried.format == Format::Exr {
        files.encoding.layers = was.layers;
    }
    Ok(files)
}

/// Opens the requested device, else the one that rendered the picture, if it is here.
fn open(mut device: DeviceOptions, carried: &Carried) -> Result<Backend> {
    if device.device.is_some() {
        return Backend::open(&device);
    }
    let Some(name) = &carried.device else {
        return Backend::open(&device);
    };
    device.device = Some(DeviceName::of(name));
    match Backend::open(&device) {
        Err(error) if error.kind() == ErrorKind::NoDevice => {}
        opened => return opened,
    }
    device.device = None;
    let backend = Backend::open(&device)?;
    note(format_args!(
        "the picture was rendered on {name}, which is not here: on {} it may differ in its last bits",
        backend.device().name
    ));
    Ok(backend)
}

/// The volume that the picture was rendered of: the first of `places` where a volume of the same content
/// is.
///
/// # Errors
/// There is none, or only others (input); the last one cannot be read.
fn found(
    places: &[PathBuf],
    options: &SceneOptions,
    carried: &Carried,
    backend: &Backend,
    bars: &Bars,
) -> Result<(Source, Loaded)> {
    let there: Vec<&PathBuf> = places.iter().filter(|place| place.exists()).collect();
    let shown = |places: &[&PathBuf]| {
        let names = places.iter().map(|place| place.display().to_string());
        names.collect::<Vec<_>>().join(", ")
    };
    if there.is_empty() {
        let places: Vec<&PathBuf> = places.iter().collect();
        return Err(Error::input(format!(
            "{}: its volume was not found; looked for {}",
            carried.picture.display(),
            shown(&places)
        ))
        .hint("give its place with --volume FILE"));
    }
    for (at, place) in there.iter().enumerate() {
        let mut volume = options.volume.clone();
        volume.volume = Some(FilePath(place.to_path_buf()));
        let source = Source::of(&volume)?;
        let loaded = match source.load(backend.device_info(), bars) {
            Err(error) if at + 1 == there.len() => return Err(error),
            Err(_) => continue,
            Ok(loaded) => loaded,
        };
        let Some(content) = &carried.content else {
            note(
                "the picture does not record its volume's content, which is therefore not checked",
            );
            return Ok((source, loaded));
        };
        if *content == loaded.content() {
            return Ok((source, loaded));
        }
    }
    Err(Error::input(format!(
        "{}: not the volume that {} was rendered from: its content differs",
        shown(&there),
        carried.picture.display()
    ))
    .hint("give that file's place with --volume FILE"))
}

/// Says so where another version of the program made the picture.
fn print_version(carried: &Carried) {
    if let Some(version) = carried.version.as_ref().filter(|made| *made != VERSION) {
        note(format_args!(
            "the picture was made by angioray {version}: this is {VERSION}, whose picture may differ"
        ));
    }
}
