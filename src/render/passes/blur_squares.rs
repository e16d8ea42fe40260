//! `kernels/pass/blur_squares.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::BLURRED_SQUARE;

use super::blur_circles::Discs;
use super::run::Run;

/// Room for what is known of each square of pixels: the greatest radius of its discs, its nearest and its farthest circle, and
/// whether it is uneven.
///
/// # Errors
/// The rays belong to no picture; the device has no room.
pub fn blurred_squares(run: &Run) -> Result<Buffer<[f32; 4]>> {
    let (_, size) = run.picture()?;
    let [across, down] =
        [size.width(), size.height()].map(|pixels| pixels.div_ceil(BLURRED_SQUARE) as usize);
    Buffer::new(run.device, "squares of pixels", across * down)
}

/// How far discs reach in each square of pixels.
pub fn blur_squares(run: &mut Run, discs: &Discs, squares: &mut Buffer<[f32; 4]>) -> Result<()> {
    let args = run.screen_args()?.with(discs).write("squares", squares);
    run.squares("blur_squares", run.scalar_defines(), args, BLURRED_SQUARE)
}
