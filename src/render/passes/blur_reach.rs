//! `kernels/pass/blur_reach.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::BLURRED_SQUARE;

use super::run::Run;

/// What reaches each square of pixels from the `squares` around, no disc being wider than `reach_px` to a side; and whether
/// anything uneven is that near.
pub fn blur_reach(
    run: &mut Run,
    reach_px: f32,
    squares: &Buffer<[f32; 4]>,
    reaches: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .value("reach_px", &reach_px)
        .read("squares", squares)
        .write("reaches", reaches);
    run.squares("blur_reach", run.scalar_defines(), args, BLURRED_SQUARE)
}
