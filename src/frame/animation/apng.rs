//! Animated PNG: 8-bit RGB, lossless, the metadata as iTXt chunks.

use std::io::Write;
use std::path::Path;

use ::png::{BitDepth, Compression};

use crate::error::Result;
use crate::frame::{Frame, png, quantize};

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
    let failed = |error| png::not_written(path, error);
    let (depth, compression) = (BitDepth::Eight, Compression::Fast);
    let encoder = png::rgb_encoder(out, reel.size, depth, compression, metadata);
    let mut encoder = encoder.map_err(failed)?;
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
