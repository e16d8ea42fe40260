//! The files a job writes: known to be writable before the work is done.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::batch::FrameNames;
use crate::error::{Error, Result};
use crate::frame::{AnimationFormat, BitDepth, Encoding, Format, Layer};
use crate::options::group::{Keys, group};
use crate::options::rules::{Group, Need, has_needs, unmet};
use crate::options::text_form::readable;
use crate::options::{FilePath, SceneFile};
use crate::output::{check_folder, check_writable};
use crate::scene::{FrameCount, Mode};

group! {
    /// The files that a rendering writes.
    #[command(next_help_heading = "Output")]
    pub struct OutputOptions {
        /// The picture: .png, .jpg, .webp for display, .exr, .npy for measuring
        #[arg(short, long, value_name = "FILE")]
        output: FilePath,

        /// Layers beside the colour, in .exr and .npy: depth, normal, value, steps, nodes, cast, kind,
        /// certificate, coverage, occlusion, occlusion_bound, visibility, thick, coc, separated by commas, or all
        /// that the mode has. In dvr depth, normal and value are means along the ray, weighted as its light is, where the
        /// opacity is at least 0.01. cast is 0 where --sparse filled a pixel; coverage is the share of a pixel's
        /// rays that hit. certificate is for iso alone: 0 proven to miss, 1 proven to hit, 2 undecided; fixed
        /// steps on a device prove nothing: 2 everywhere. occlusion is for iso too: the share of the light from
        /// everywhere that --ao or --ssao finds kept from the hit; occlusion_bound: how far it may be from the
        /// truth at most, by --ao bound=E; and thick: mm behind the hit to the ray's
        /// next crossing of the surface, or to where the volume or a clip plane ends it. visibility is the share
        /// of the first light that --shadows let through to the hit, in dvr a mean like depth. coc is for iso
        /// and dvr: the diameter of the circle of confusion of --dof in pixels, above 0 behind the focal plane
        #[arg(long, value_name = "LIST|all")]
        aov: Layers,

        /// Bits per channel of a .png: 8 or 16 [default: 8]
        #[arg(long, value_name = "8|16", allow_hyphen_values = true)]
        bit_depth: Bits,

        /// Quality of a .jpg, 1 to 100 [default: 92]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        quality: u8,

        /// Write what was rendered and how long it took as JSON
        #[arg(long, value_name = "FILE.json")]
        stats: FilePath,
    }
}

impl OutputOptions {
    /// Takes the output options from a scene file; the files that it names are relative to it.
    pub fn of_file(file: &SceneFile) -> Result<Self> {
        let options = file.group::<Self>()?;
        Ok(Self {
            output: options.output.map(|path| file.named_here(path)),
            stats: options.stats.map(|path| file.named_here(path)),
            ..options
        })
    }

    /// Lays these flags, and this mode among them, over a scene file's options: another picture file
    /// drops what its format cannot hold, another mode the layers that it does not have.
    pub fn over_file(self, mut file: Self, mode: Option<Mode>) -> Self {
        if let Some(mode) = mode {
            file.aov = file.aov.and_then(|layers| layers.limited_to(mode));
        }
        if let Some(FilePath(path)) = &self.output {
            file =
                file.retaining(|option| has_needs(Group::Output, option, |need| holds(path, need)));
        }
        self.over(file)
    }

    /// The file named by `--output`.
    ///
    /// # Errors
    /// None is.
    pub fn path(&self) -> Result<&Path> {
        match &self.output {
            Some(FilePath(path)) => Ok(path),
            None => Err(Error::usage("no picture to write was named")
                .hint("give its file by '--output', or as 'output' in the scene file")),
        }
    }

    /// How a picture of this name and mode is written.
    ///
    /// # Errors
    /// A format that is not known, what it cannot hold, a layer that the mode does not have.
    pub fn encoding(&self, picture: &Path, mode: Mode) -> Result<Encoding> {
        let format = Format::from_path(picture)?;
        let is_met = |need| need != Need::Jpeg || format == Format::Jpeg;
        if let Some((option, _)) = unmet(Group::Output, &self.given(), is_met) {
            return Err(Error::usage(format!("'--{option}' is for .jpg files only")));
        }
        let encoding = Encoding {
            format,
            bit_depth: self.bit_depth.map_or(BitDepth::Eight, |Bits(bits)| bits),
            quality: self.quality.unwrap_or(Encoding::DEFAULT_QUALITY),
            layers: match &self.aov {
                Some(layers) => layers.of_mode(mode)?,
                None => Vec::new(),
            },
        };
        encoding.check()?;
        Ok(encoding)
    }

    /// How the pictures of an animation are made: from the same plane as a PNG of 8 bits.
    ///
    /// # Errors
    /// What an animation cannot hold.
    pub fn encoding_of_animation(&self, mode: Mode) -> Result<Encoding> {
        if self.bit_depth == Some(Bits(BitDepth::Sixteen)) {
            return Err(Error::usage(
                "16 bits per channel (--bit-depth 16) are for .png files only: an animation has 8",
            )
            .hint("write pictures, such as -o frames/%04d.png"));
        }
        self.encoding(Path::new("frame.png"), mode)
    }

    /// Resolves the options to the files that a picture of this mode is written to.
    ///
    /// # Errors
    /// As [`OutputOptions::path`] and [`OutputOptions::encoding`].
    pub fn files(self, mode: Mode) -> Result<Files> {
        let picture = self.path()?.to_owned();
        Ok(Files {
            encoding: self.encoding(&picture, mode)?,
            picture,
            stats: self.stats.map(|FilePath(path)| path),
        })
    }
}

/// Whether a file of this name can hold what an option needs; a name of no known format is refused
/// elsewhere.
fn holds(path: &Path, need: Need) -> bool {
    if AnimationFormat::from_path(path).is_some() {
        return !matches!(need, Need::Layered | Need::Png | Need::Jpeg);
    }
    let Ok(format) = Format::from_path(path) else {
        return true;
    };
    match need {
        Need::Layered => format.carries_layers(),
        Need::Png => format == Format::Png,
        Need::Jpeg => format == Format::Jpeg,
        _ => true,
    }
}

/// The files that a rendering writes.
pub struct Files {
    pub picture: PathBuf,
    pub encoding: Encoding,
    pub stats: Option<PathBuf>,
}

impl Files {
    /// Checks that what is to be written can be, before hours of work, and replaces no input.
    pub fn check(&self, inputs: &[impl AsRef<Path>]) -> Result<()> {
        check(&self.picture, inputs)?;
        let Some(stats) = &self.stats else {
            return Ok(());
        };
        check(stats, inputs)?;
        if place(stats) == place(&self.picture) {
            return Err(Error::usage(format!(
                "{}: the picture and the statistics need a file each",
                stats.display()
            )));
        }
        Ok(())
    }
}

/// Checks that `path` can be written, and is none of the files that the job reads.
pub fn check(path: &Path, inputs: &[impl AsRef<Path>]) -> Result<()> {
    check_spared(path, inputs)?;
    check_writable(path)
}

/// Checks that `path` is none of the files that the job reads.
pub fn check_spared(path: &Path, inputs: &[impl AsRef<Path>]) -> Result<()> {
    if inputs
        .iter()
        .any(|input| place(input.as_ref()) == place(path))
    {
        return Err(Error::usage(format!(
            "{}: this file is read, writing would replace it",
            path.display()
        )));
    }
    Ok(())
}

/// The absolute path of a file, independent of the working folder. A symbolic link keeps its own name: a
/// raw file's layout, and which files belong to a header, may lie in it.
fn absolute(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default();
    match fs::canonicalize(folder(path)) {
        Ok(folder) => folder.join(name),
        Err(_) => path.to_owned(),
    }
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Checks that no file of a sequence of so many frames replaces one that the job reads or that `stats`
/// writes, and that the files can be written, their folder being created if it does not exist.
pub fn check_sequence(
    names: &FrameNames,
    frames: FrameCount,
    inputs: &[impl AsRef<Path>],
    stats: Option<&Path>,
) -> Result<()> {
    let inputs = inputs.iter().map(AsRef::as_ref);
    let others: Vec<PathBuf> = inputs.chain(stats).map(place).collect();
    // Those in the folder by their names, those behind a link of a frame's name by where it leads.
    let folder_place = place(folder(&names.path(0)));
    let here = others
        .iter()
        .filter(|other| folder(other) == folder_place)
        .cloned();
    let links = links_in(&folder_place)
        .into_iter()
        .filter(|link| others.contains(&place(link)));
    let taken = here
        .chain(links)
        .filter_map(|path| names.frame(path.file_name()?))
        .find(|&frame| frame < frames.get());
    if let Some(frame) = taken {
        return Err(Error::usage(format!(
            "{}: this file is read, or is where the statistics go: writing frame {frame} would replace it",
            names.path(frame).display()
        )));
    }
    check_folder(folder(&names.path(0)))
}

/// The symbolic links in a folder; none where there is no folder.
fn links_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_symlink()))
        .map(|entry| entry.path())
        .collect()
}

/// The canonical path of a file, or its absolute path if it does not exist yet.
fn place(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| absolute(path))
}

/// `--aov`: layers by name, or all that the mode has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Layers {
    All,
    Named(Vec<Layer>),
}

impl Layers {
    /// Why pictures of a mode do not have a layer; `None`: they do.
    fn missing(layer: Layer, mode: Mode) -> Option<&'static str> {
        match layer {
            Layer::Certificate if mode != Mode::Iso => {
                Some("only a surface is proven to be hit or missed")
            }
            Layer::Occlusion | Layer::OcclusionBound if mode != Mode::Iso => {
                Some("only a surface keeps light from itself")
            }
            Layer::Visibility if !mode.is_lit() => Some("a projection has no light"),
            Layer::Thick if mode != Mode::Iso => Some("only a surface has an inside"),
            Layer::Coc if !mode.is_lit() => Some("a projection has no depth to focus on"),
            _ => None,
        }
    }

    /// Whether pictures of a mode have the layer.
    fn is_of(layer: Layer, mode: Mode) -> bool {
        Self::missing(layer, mode).is_none()
    }

    /// The layers of a picture of this mode.
    ///
    /// # Errors
    /// Usage: one that is named, and that the mode does not have.
    fn of_mode(&self, mode: Mode) -> Result<Vec<Layer>> {
        match self {
            Self::All => {
                let layers = Layer::ALL.into_iter();
                Ok(layers.filter(|layer| Self::is_of(*layer, mode)).collect())
            }
            Self::Named(layers) => match layers.iter().find(|layer| !Self::is_of(**layer, mode)) {
                None => Ok(layers.clone()),
                Some(stray) => Err(Error::usage(format!(
                    "the layer '{}' cannot be combined with mode '{mode}': {}",
                    stray.name(),
                    Self::missing(*stray, mode).unwrap_or_default()
                ))
                .hint("leave it out, or write all for every layer that the mode has")),
            },
        }
    }

    /// Removes the layers that the mode does not have; `None` if none is left.
    fn limited_to(self, mode: Mode) -> Option<Self> {
        match self {
            Self::All => Some(Self::All),
            Self::Named(mut layers) => {
                layers.retain(|layer| Self::is_of(*layer, mode));
                (!layers.is_empty()).then_some(Self::Named(layers))
            }
        }
    }
}

impl FromStr for Layers {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.eq_ignore_ascii_case("all") {
            return Ok(Self::All);
        }
        let layers = text.split(',').map(|name| {
            let is_it = |layer: &Layer| layer.name().eq_ignore_ascii_case(name.trim());
            Layer::ALL.into_iter().find(is_it).ok_or_else(|| {
                let names = Layer::ALL.map(Layer::name).join(", ");
                Error::usage(format!(
                    "'{name}' is not a layer: write all, or some of {names} separated by commas"
                ))
            })
        });
        layers.collect::<Result<Vec<_>>>().map(Self::Named)
    }
}

/// The bits per channel, as given by `--bit-depth`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bits(BitDepth);

impl FromStr for Bits {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "8" => Ok(Self(BitDepth::Eight)),
            "16" => Ok(Self(BitDepth::Sixteen)),
            _ => Err(Error::usage("a .png has 8 or 16 bits per channel")),
        }
    }
}

readable!(Layers, Bits);
