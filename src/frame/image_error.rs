//! The errors of the encoders of the `image` crate.

use std::path::Path;

use image::ImageError;

use crate::error::Error;

/// The error of a picture that cannot be encoded into `path`.
pub(super) fn image_failed(path: &Path, error: ImageError) -> Error {
    match error {
        ImageError::IoError(cause) => Error::writing(path, "write", &cause),
        other => Error::resource(format!("{}: cannot write: {other}", path.display())),
    }
}
