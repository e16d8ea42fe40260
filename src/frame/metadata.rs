//! The texts that a picture carries.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use crate::error::{Error, Result};

use super::{Encoding, Format, exr, png};

/// The format of a picture that can carry metadata, recognised by content: PNG or EXR; of any other
/// file nothing.
///
/// # Errors
/// A file that cannot be read.
pub fn carrier(path: &Path) -> Result<Option<Format>> {
    let mut magic = Vec::new();
    // Asked before opening: opening a pipe would wait for its writer.
    let about = fs::metadata(path).map_err(|cause| Error::reading(path, "read", &cause))?;
    if !about.is_file() {
        return Ok(None);
    }
    File::open(path)
        .and_then(|file| file.take(8).read_to_end(&mut magic))
        .map_err(|cause| Error::reading(path, "read", &cause))?;
    Ok(match &magic[..] {
        [0x89, b'P', b'N', b'G', ..] => Some(Format::Png),
        [0x76, 0x2f, 0x31, 0x01, ..] => Some(Format::Exr),
        _ => None,
    })
}

/// How a PNG or an EXR, recognised by content, is written: the bits of the one, the layers of the other.
///
/// # Errors
/// As [`read_metadata`].
pub fn read_encoding(path: &Path) -> Result<Encoding> {
    match carrier(path)? {
        Some(Format::Png) => png::read_encoding(path),
        Some(Format::Exr) => exr::read_encoding(path),
        _ => Err(no_carrier(path)),
    }
}

fn no_carrier(path: &Path) -> Error {
    Error::input(format!(
        "{}: neither a PNG nor an EXR: no other picture carries metadata",
        path.display()
    ))
}

/// The keys and texts in a PNG (tEXt, zTXt, iTXt) or an EXR (string attributes of the first part,
/// sorted by key), recognised by content.
///
/// # Errors
/// A file that cannot be read, is neither, or is damaged.
pub fn read_metadata(path: &Path) -> Result<Vec<(String, String)>> {
    match carrier(path)? {
        Some(Format::Png) => png::read_metadata(path),
        Some(Format::Exr) => exr::read_metadata(path),
        _ => Err(no_carrier(path)),
    }
}
