//! `kernels/pass/list_marked.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::LISTED_SQUARE;

use super::run::Run;

/// Lists the pixels that `cast` marks to be cast next and then those in blocks, each square's from where `begins` says, and
/// marks the first as cast.
pub fn list_marked(
    run: &mut Run,
    begins: &Buffer<u32>,
    cast: &mut Buffer<u32>,
    listed: &mut Buffer<[u32; 2]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .read("begins", begins)
        .write("cast", cast)
        .write("listed", listed);
    run.squares("list_marked", run.scalar_defines(), args, LISTED_SQUARE)
}
