//! Where the reference's pictures are kept.

use std::path::PathBuf;

use crate::error::Result;
use crate::measure::Truth;
use crate::scene::FilePath;
use crate::volume::Volume;

use super::super::terminal::note;
use super::options::OFF;

/// Reference pictures, kept where the user says, else in the user's cache folder, as far as there can be
/// one: to work without it costs nothing but time.
pub fn truth(asked: Option<FilePath>, volume: &Volume) -> Result<Truth<'_>> {
    match asked {
        Some(FilePath(path)) if path.as_os_str() == OFF => Ok(Truth::uncached(volume)),
        Some(FilePath(path)) => Truth::kept_in(&path, volume)
            .map_err(|error| error.hint("name another folder, or write '--cache off'")),
        None => {
            let Some(folder) = cache_folder() else {
                return Ok(Truth::uncached(volume));
            };
            Ok(Truth::kept_in(&folder, volume).unwrap_or_else(|error| {
                note(format_args!(
                    "the reference's pictures are not kept: {error}"
                ));
                Truth::uncached(volume)
            }))
        }
    }
}

/// Where programs of this system keep what can be made again (XDG Base Directory Specification).
fn cache_folder() -> Option<PathBuf> {
    let named = std::env::var_os("XDG_CACHE_HOME").map(PathBuf::from);
    let named = named.filter(|path| path.is_absolute());
    let home = || Some(std::env::home_dir()?.join(".cache"));
    Some(named.or_else(home)?.join("angioray"))
}
