//! `kernels/pass/list_marked.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::LISTED_SQUARE;

use super::run::Run;

/// Lists the pixels that are marked in `cast` to be cast next, each square's from where `begins` says, and
/// marks them as cast.
pub fn list_marked(
    run: &mut Run,
    begins: &Buffer<u32>,
    cast: &mut Buffer<u32>,
    listed: &mut Buffer<u32>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .read("begins", begins)
        .write("cast", cast)
        .write("listed", listed);
    run.squares("list_marked", run.scalar_defines(), args, LISTED_SQUARE)
}
