//! `kernels/pass/mark_grid.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::run::Run;

/// Gives the pixels of a grid, `spacing` pixels apart, a `mark` in `cast`, and marks all others to be filled.
pub fn mark_grid(run: &mut Run, spacing: u32, mark: u32, cast: &mut Buffer<u32>) -> Result<()> {
    let args = run
        .screen_args()?
        .value("spacing", &spacing)
        .value("mark", &mark)
        .write("cast", cast);
    run.screen("mark_grid", run.defines(), args)
}
