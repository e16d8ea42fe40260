//! The options of `compare` beside the scene.

use std::str::FromStr;

use crate::error::{Error, Result};
use crate::lab::compare::Preset;
use crate::options::group::group;
use crate::options::text_form::{one_or_more, readable};
use crate::options::{Count, FilePath, SceneFile, SceneOptions};
use crate::scene::Mode;

group! {
    /// The options of a comparison: what is compared, and where the results go.
    #[command(next_help_heading = "Comparison")]
    pub struct CompareOptions {
        /// A folder for report.html, results.json, results.csv, the pictures and their error maps;
        /// created if it does not exist
        #[arg(short, long, value_name = "DIR")]
        output: FilePath,

        /// The modes, separated by commas [default: the one of --mode, else iso,mip,lmip,dvr]
        #[arg(long, value_name = "LIST")]
        modes: Modes,

        /// Compare what is shown, too: lighting shows each mode unlit, lit, and lit with shadows, each
        /// beside its own reference
        #[arg(long, value_name = "lighting", allow_hyphen_values = true)]
        preset: Preset,

        /// Compare the settings of this TOML file in place of the built-in ones
        #[arg(long, value_name = "FILE.toml")]
        configs: FilePath,

        /// How often each setting is timed, after one frame to warm up, all in turn [default: 5]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        repeats: Count,

        /// Another renderer to compare with, as a command line that speaks the protocol of
        /// scripts/peers/README.md in angioray's source; may be given several times
        #[arg(long, value_name = "COMMAND")]
        #[serde(deserialize_with = "one_or_more")]
        peer: Vec<String>,

        /// Where the reference's pictures are cached, so that each is computed once: a folder, or off
        /// [default: angioray in the user's cache folder]
        #[arg(long, value_name = "DIR|off")]
        cache: FilePath,
    }
}

/// Turns the cache off.
pub const OFF: &str = "off";

impl CompareOptions {
    /// The options that a scene file gives; the files that it names are relative to it.
    pub fn of_file(file: &SceneFile) -> Result<Self> {
        let options = file.group::<Self>()?;
        let named_here = |path: FilePath| file.named_here(path);
        let is_off = |FilePath(path): &FilePath| path.as_os_str().eq_ignore_ascii_case(OFF);
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

/// The modes given by `--modes`.
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

readable!(Modes, Preset);

/// The modes that are named: several, or one.
pub struct Named(Option<Modes>, Option<Mode>);

impl Named {
    /// Takes them out of the options, whose modes are those of a single picture.
    pub fn take(compare: &mut CompareOptions, options: &mut SceneOptions) -> Self {
        Self(compare.modes.take(), options.picture.mode.take())
    }

    /// Checks that these two options do not contradict each other.
    ///
    /// # Errors
    /// Usage: both, and not the same.
    pub fn check(&self) -> Result<()> {
        match self {
            Self(Some(Modes(modes)), Some(mode)) if modes != &[*mode] => Err(Error::usage(
                "'--modes' and '--mode' cannot be combined: both say what is compared",
            )
            .hint("leave out '--mode'")),
            _ => Ok(()),
        }
    }

    /// The modes in the order in which they are named; `None` if none is.
    pub fn modes(self) -> Option<Vec<Mode>> {
        let Self(several, one) = self;
        let several = several.map(|Modes(modes)| modes);
        several.or_else(|| Some(vec![one?]))
    }
}
