//! WebP: 8-bit RGB, lossless.

use std::io::Write;
use std::path::Path;

use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::error::Result;

use super::contents::Frame;
use super::encoder_error::encoder_error;
use super::quantize;

pub(super) fn encode(out: &mut impl Write, path: &Path, frame: &Frame) -> Result<()> {
    let (width, height) = (frame.size.width(), frame.size.height());
    WebPEncoder::new_lossless(out)
        .write_image(
            &quantize::rgb8(frame)?,
            width,
            height,
            ExtendedColorType::Rgb8,
        )
        .map_err(|error| encoder_error(path, error))
}
