//! A frame into a file.

use std::path::Path;

use crate::error::{Error, Result};
use crate::output::write_atomically;

use super::channel::channels_of;
use super::contents::Frame;
use super::format::{Encoding, Format};
use super::{exr, jpeg, npy, png, webp};

/// Writes a picture, whole or not at all. `metadata` are keys and texts; PNG keeps them as iTXt
/// chunks and EXR as string attributes ([`super::read_metadata`] reads both), the other formats
/// have no place for them.
///
/// # Errors
/// An [`Encoding`] that its format cannot do, a picture larger than it holds (usage); a frame without a plane that it needs or
/// with planes of wrong length; a path that cannot be written.
pub fn write(
    path: &Path,
    frame: &Frame,
    encoding: &Encoding,
    metadata: &[(&str, &str)],
) -> Result<()> {
    encoding.check()?;
    encoding
        .check_size(frame.size)
        .map_err(|e| e.at(path.display()))?;
    frame.check()?;
    write_atomically(path, |out| match encoding.format {
        Format::Png => png::encode(out, path, frame, encoding.bit_depth, metadata),
        Format::Jpeg => jpeg::encode(out, path, frame, encoding.quality),
        Format::WebP => webp::encode(out, path, frame),
        Format::Exr => exr::encode(
            out,
            path,
            frame.size,
            channels_of(frame, encoding)?,
            metadata,
        ),
        Format::Npy => npy::encode(out, frame.size, &channels_of(frame, encoding)?)
            .map_err(|cause| Error::writing(path, "write", &cause)),
    })
}

impl Frame {
    /// Saves the picture in the format of the path's extension, whole or not at all: as displayed into PNG, JPEG
    /// and WebP; as linear light with all its layers into EXR and NPY. [`write()`] has options.
    ///
    /// # Errors
    /// An extension that names no format (usage); a format for display, and a frame without its display plane;
    /// a path that cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let mut encoding = Encoding::new(Format::from_path(path)?);
        if encoding.format.carries_layers() {
            encoding.layers = self.layers.iter().map(|(layer, _)| layer).collect();
        }
        write(path, self, &encoding, &[])
    }
}
