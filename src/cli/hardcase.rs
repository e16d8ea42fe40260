//! `angioray phantom hardcase:NAME`.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::lab::hardcases::{HardCase, HardScene};
use crate::output::write_atomically;

use super::outputs;
use super::terminal::{message, note};

/// The prefix of a hard case's name.
const PREFIX: &str = "hardcase:";

/// The name behind it, where the text names a hard case.
pub fn name(text: &str) -> Option<&str> {
    let (prefix, name) = text.split_at_checked(PREFIX.len())?;
    prefix.eq_ignore_ascii_case(PREFIX).then_some(name)
}

/// One of a case's volumes.
#[derive(Debug, Clone, Copy)]
pub struct Chosen {
    pub case: &'static HardCase,
    pub member: usize,
}

impl PartialEq for Chosen {
    fn eq(&self, other: &Self) -> bool {
        self.case.name == other.case.name && self.member == other.member
    }
}

/// Writes the volume to `output` and its scenes beside it: to `X.toml` where there is one, else
/// each to `X.SCENE.toml`. `inputs` are not to be overwritten.
///
/// # Errors
/// A file cannot be written.
pub fn write(chosen: Chosen, output: &Path, gzip: bool, inputs: &[&Path]) -> Result<()> {
    let Chosen { case, member } = chosen;
    let made = case.volume(member)?;
    let scenes = case.scenes(&made.volume);
    let files: Vec<PathBuf> = match &scenes[..] {
        [_] => vec![output.with_extension("toml")],
        several => several
            .iter()
            .map(|scene| output.with_extension(format!("{}.toml", scene.name)))
            .collect(),
    };
    for file in &files {
        outputs::check(file, inputs)?;
    }
    made.volume.notes().iter().for_each(note);
    made.write(output, gzip)?;
    message(format_args!(
        "wrote {}: {} {}; {}",
        output.display(),
        made.volume.dims(),
        made.volume.voxels().voxel_type(),
        case.answer
    ));
    for (file, HardScene { toml, .. }) in files.iter().zip(&scenes) {
        write_atomically(file, |out| {
            use std::io::Write;
            out.write_all(toml.as_bytes())
                .map_err(|cause| Error::writing(file, "write the scene", &cause))
        })?;
    }
    if let Some(first) = files.first() {
        let more = match files.len() {
            1 => String::new(),
            n => format!(" and {} more scenes", n - 1),
        };
        message(format_args!(
            "wrote {}{more}: angioray render {} --scene {} -o FILE",
            first.display(),
            output.display(),
            first.display()
        ));
    }
    Ok(())
}

/// The cases by name, each with its sentence: the end of the help.
pub fn help() -> String {
    let mut text = String::from(
        "Hard cases (hardcase:NAME), volumes on which renderers fail; each also writes its scenes, \
         FILE.toml or FILE.SCENE.toml:\n",
    );
    for case in HardCase::all() {
        let members = match case.members {
            [] => String::new(),
            members => format!(" Add .MEMBER: {}.", members.join(", ")),
        };
        text.push_str(&format!(
            "  {}\n          {}{members}\n",
            case.name, case.about
        ));
    }
    text
}
