//! Where the reference's pictures are cached.

use crate::cache;
use crate::error::Result;
use crate::lab::measure::ReferenceCache;
use crate::options::FilePath;
use crate::volume::Volume;

use super::super::terminal::note;
use super::options::OFF;

/// Reference pictures, cached where the user says, else in the user's cache folder where there can be
/// one: without it they are computed again, which costs nothing but time.
pub fn reference_cache(wanted: Option<FilePath>, volume: &Volume) -> Result<ReferenceCache<'_>> {
    match wanted {
        Some(FilePath(path)) if path.as_os_str().eq_ignore_ascii_case(OFF) => {
            Ok(ReferenceCache::uncached(volume))
        }
        Some(FilePath(path)) => ReferenceCache::in_folder(&path, volume)
            .map_err(|error| error.hint("name another folder, or write '--cache off'")),
        None => {
            let Some(folder) = cache::user_folder() else {
                return Ok(ReferenceCache::uncached(volume));
            };
            Ok(
                ReferenceCache::in_folder(&folder, volume).unwrap_or_else(|error| {
                    note(format_args!(
                        "the reference's pictures are not cached: {error}"
                    ));
                    ReferenceCache::uncached(volume)
                }),
            )
        }
    }
}
