//! Animated PNG: 8-bit RGB, lossless, the metadata as iTXt chunks.

use std::io::Write;
use std::path::Path;

use ::png::{ColorType, Compression, Encoder, EncodingError, SrgbRenderingIntent};

use crate::error::{Error, Result};
use crate::frame::{Frame, quantize};

use super::{FrameRate, Reel};

/// Frames last this many of the 1/100 s that a rate's whole number counts in.
const HUNDRED_SECONDS: u16 = 100;

pub(super) fn encode(
    out: &mut impl Write,
    path: &Path,
    rate: FrameRate,
    reel: Reel,
    metadata: &[(&str, &str)],
    frames: &mut dyn Iterator<Item = Result<Frame>>,
) -> Result<()> {
    let failed = |error: EncodingError| match error {
        EncodingError::IoError(cause) => Error::io(path, "write", &cause),
        other => Error::failed(format!("{}: cannot write: {other}", path.display())),
    };
    let mut encoder = Encoder::new(out, reel.size.width(), reel.size.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    for (key, text) in metadata {
        encoder
            .add_itxt_chunk((*key).to_owned(), (*text).to_owned())
            .map_err(failed)?;
    }
    encoder.set_animated(reel.frames, 0).map_err(failed)?;
    encoder
        .set_frame_delay(HUNDRED_SECONDS, rate.per_100_s())
        .map_err(failed)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    for frame in frames {
        let rgb = quantize::rgb8(&frame?)?;
        writer.write_image_data(&rgb).map_err(failed)?;
    }
    writer.finish().map_err(failed)
}
