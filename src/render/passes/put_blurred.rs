//! `kernels/pass/put_blurred.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::run::Run;

/// Puts what was gathered in the place of a `color`, where `reaches` says that anything is blurred.
pub fn put_blurred(
    run: &mut Run,
    reaches: &Buffer<[f32; 4]>,
    blurred: &Buffer<[f32; 4]>,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .read("reaches", reaches)
        .read("blurred", blurred)
        .write("color", color);
    run.screen("put_blurred", run.defines(), args)
}
