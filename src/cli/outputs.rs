//! The files a job writes: known to be writable before the work is done.

use std::fs;
use std::path::Path;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::frame::Layer;

/// That `path` can become a file: its folder is there, it is no folder itself, and it is none of
/// the files that the job reads.
pub fn check(path: &Path, inputs: &[&Path]) -> Result<()> {
    let place = || path.display();
    if path.is_dir() {
        return Err(
            Error::failed(format!("{}: this is a folder", place())).hint("name a file in it")
        );
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(Error::failed(format!(
            "{}: there is no folder {} to write to",
            place(),
            folder.display()
        ))
        .hint("make the folder first"));
    }
    let same = |input: &&&Path| match (fs::canonicalize(path), fs::canonicalize(input)) {
        (Ok(output), Ok(input)) => output == input,
        _ => false,
    };
    match inputs.iter().find(same) {
        Some(_) => Err(Error::usage(format!(
            "{}: this file is read, writing would replace it",
            place()
        ))),
        None => Ok(()),
    }
}

/// `--aov`: layers by name, or all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layers(pub Vec<Layer>);

impl FromStr for Layers {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "all" {
            return Ok(Self(Layer::ALL.to_vec()));
        }
        let layers = text.split(',').map(|name| {
            let found = Layer::ALL.into_iter().find(|layer| layer.name() == name);
            found.ok_or_else(|| {
                let names = Layer::ALL.map(Layer::name).join(", ");
                Error::usage(format!(
                    "'{name}' is no layer: write all, or some of {names} with commas between"
                ))
            })
        });
        layers.collect::<Result<Vec<_>>>().map(Self)
    }
}
