//! Where the reference's pictures are cached.

use crate::error::Result;
use crate::kept;
use crate::measure::Truth;
use crate::options::FilePath;
use crate::volume::Volume;

use super::super::terminal::note;
use super::options::OFF;

/// Reference pictures, cached where the user says, else in the user's cache folder, as far as there can be
/// one: to work without it costs nothing but time.
pub fn truth(asked: Option<FilePath>, volume: &Volume) -> Result<Truth<'_>> {
    match asked {
        Some(FilePath(path)) if path.as_os_str().eq_ignore_ascii_case(OFF) => {
            Ok(Truth::uncached(volume))
        }
        Some(FilePath(path)) => Truth::kept_in(&path, volume)
            .map_err(|error| error.hint("name another folder, or write '--cache off'")),
        None => {
            let Some(folder) = kept::users_folder() else {
                return Ok(Truth::uncached(volume));
            };
            Ok(Truth::kept_in(&folder, volume).unwrap_or_else(|error| {
                note(format_args!(
                    "the reference's pictures are not cached: {error}"
                ));
                Truth::uncached(volume)
            }))
        }
    }
}
