//! `kernels/pass/tone_curve.cl`

use crate::error::Result;
use crate::gpu::{Buffer, input, output, value};
use crate::render::abi::{RayGrid, Tone};

use super::Run;

/// From linear light `color` to sRGB-encoded, opaque `display`.
pub fn tone_curve(
    run: &mut Run,
    rays: &RayGrid,
    tone: &Tone,
    color: &Buffer<[f32; 4]>,
    display: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let variant = run.variant;
    let defines = variant.defines().with("LANES", variant.lanes);
    let pass = run.built.pass("tone_curve", defines, || {
        vec![
            value::<RayGrid>("rays"),
            value::<Tone>("tone"),
            input::<[f32; 4]>("color"),
            output::<[f32; 4]>("display"),
        ]
    })?;
    pass.launch(run.device)
        .value(rays)
        .value(tone)
        .input(color)
        .output(display)
        .run(run.size, run.work_group, run.timings)
}
