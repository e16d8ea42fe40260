//! `kernels/pass/tone_curve.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::Tone;

use super::run::Run;

/// Converts linear light `color` to the sRGB-encoded, opaque `display`.
pub fn tone_curve(
    run: &mut Run,
    tone: &Tone,
    color: &Buffer<[f32; 4]>,
    display: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .value("tone", tone)
        .read("color", color)
        .write("display", display);
    run.screen("tone_curve", run.defines(), args)
}
