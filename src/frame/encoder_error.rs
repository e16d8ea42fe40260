//! Failures of image encoders as errors.

use std::path::Path;

use image::ImageError;

use crate::error::Error;

/// The error of a picture at `path` that could not be encoded.
pub(super) fn encoder_error(path: &Path, error: ImageError) -> Error {
    match error {
        ImageError::IoError(cause) => Error::writing(path, "write", &cause),
        other => Error::resource(format!("{}: cannot write: {other}", path.display())),
    }
}
