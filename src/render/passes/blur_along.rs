//! `kernels/pass/blur_along.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::run::Run;

/// Blurs a `color` along its rows, or its columns, by a Gaussian of this standard deviation.
pub fn blur_along(
    run: &mut Run,
    columns: bool,
    deviation_px: f32,
    color: &Buffer<[f32; 4]>,
    blurred: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .value("columns", &u32::from(columns))
        .value("deviation_px", &deviation_px)
        .read("color", color)
        .write("blurred", blurred);
    run.screen("blur_along", run.defines(), args)
}
