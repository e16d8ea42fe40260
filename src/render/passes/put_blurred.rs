//! `kernels/pass/put_blurred.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::run::Run;

/// Puts what was gathered in the place of a `color`, in the squares of pixels that discs reach of what is seen, or of what that
/// hides.
pub fn put_blurred(
    run: &mut Run,
    reaches: &Buffer<[f32; 4]>,
    reaches_behind: Option<&Buffer<[f32; 4]>>,
    blurred: &Buffer<[f32; 4]>,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .read("reaches", reaches)
        .read_some("reaches_behind", reaches_behind)
        .read("blurred", blurred)
        .write("color", color);
    let hidden = u32::from(reaches_behind.is_some());
    run.screen("put_blurred", run.defines().with("HIDDEN", hidden), args)
}
