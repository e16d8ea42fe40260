//! `kernels/pass/count_marked.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::LISTED_SQUARE;

use super::run::Run;

/// Counts the pixels of each square that `cast` marks to be cast next, and then those that it marks to be interpolated in
/// blocks.
pub fn count_marked(run: &mut Run, cast: &Buffer<u32>, counts: &mut Buffer<u32>) -> Result<()> {
    let args = run
        .screen_args()?
        .read("cast", cast)
        .write("counts", counts);
    run.squares("count_marked", run.scalar_defines(), args, LISTED_SQUARE)
}
