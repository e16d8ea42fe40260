//! Checks before the work begins.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::lab::compare::Folder;
use crate::options::group::Keys;
use crate::options::{ErrorBound, SceneOptions, TransferChoice};
use crate::scene::Mode;
use crate::volume::files_of;

use super::super::outputs;
use super::super::source::Source;

/// Checks that every flag goes with one of the modes.
pub fn meaning(flags: &SceneOptions, modes: &[Mode]) -> Result<()> {
    let given = |options: &SceneOptions| {
        let mut keys = options.picture.given();
        keys.extend(options.sampling.given());
        keys
    };
    let means = |key: &String| {
        let of_mode = |mode: &Mode| given(&flags.of_mode(*mode));
        modes.iter().any(|mode| of_mode(mode).contains(key))
    };
    let given = given(flags);
    let Some(key) = given.iter().find(|key| !means(key)) else {
        return Ok(());
    };
    if let [mode] = modes {
        // One mode says why.
        let mut alone = flags.clone();
        alone.picture.mode = Some(*mode);
        alone.checked()?;
    }
    let modes: Vec<String> = modes.iter().map(Mode::to_string).collect();
    Err(Error::usage(format!(
        "'{key}' cannot be combined with any mode that is compared: {}",
        modes.join(", ")
    ))
    .hint("leave it out, or name another mode in '--modes'"))
}

/// Checks that a bound can choose in one of the modes.
pub fn bound(bound: ErrorBound, modes: &[Mode]) -> Result<()> {
    let checked: Vec<Result<()>> = modes.iter().map(|mode| bound.check(*mode)).collect();
    match checked.iter().any(Result::is_ok) {
        true => Ok(()),
        false => checked.into_iter().collect(),
    }
}

/// Checks that no file of the comparison replaces one that it reads.
pub fn inputs(
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
        outputs::check_spared(&file, &inputs)?;
    }
    Ok(())
}
