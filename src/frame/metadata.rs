//! The texts that a picture carries.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

use super::{exr, png};

/// The keys and texts in a PNG (tEXt, zTXt, iTXt) or an EXR (string attributes of the first part,
/// sorted by key), recognised by content.
///
/// # Errors
/// A file that cannot be read, is neither, or is damaged.
pub fn read_metadata(path: &Path) -> Result<Vec<(String, String)>> {
    let mut magic = Vec::new();
    // Asked before opening: opening a pipe would wait for its writer.
    let about = fs::metadata(path).map_err(|cause| Error::reading(path, "read", &cause))?;
    if !about.is_file() {
        return Err(Error::input(format!(
            "{}: not a regular file: no picture is read from it",
            path.display()
        )));
    }
    File::open(path)
        .and_then(|file| file.take(8).read_to_end(&mut magic))
        .map_err(|cause| Error::reading(path, "read", &cause))?;
    if magic.starts_with(b"\x89PNG") {
        png::read_metadata(path)
    } else if magic.starts_with(b"\x76\x2f\x31\x01") {
        exr::read_metadata(path)
    } else {
        Err(Error::input(format!(
            "{}: neither a PNG nor an EXR: no other picture carries metadata",
            path.display()
        )))
    }
}
