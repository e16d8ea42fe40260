//! `kernels/pass/mark_uncertain.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::inputs::CastInputs;
use super::run::Run;

/// Pixels along the edge of the largest blocks that are tested, at most.
const MAX_BLOCK: u32 = 32;

/// Lanes of a work-item: the corners of a block, twice.
const LANES: u32 = 8;

/// The blocks of pixels that are tested for whether they show nothing.
#[derive(Debug, Clone, Copy)]
pub struct Blocks {
    /// The width of the smallest, in pixels.
    pub spacing: u32,
    /// How far a pixel's rays pass from its centre at most along either axis, in pixels.
    pub margin: f32,
}

/// Marks in `cast` the pixels whose blocks are not proven to show nothing of the surface at `iso` (stored units), to
/// be cast next, and the others to be filled.
pub fn mark_uncertain(
    run: &mut Run,
    inputs: CastInputs,
    blocks: Blocks,
    iso: f32,
    cast: &mut Buffer<u32>,
) -> Result<()> {
    let Blocks { spacing, margin } = blocks;
    let levels = (MAX_BLOCK / spacing).ilog2();
    let (grid, _) = run.picture()?;
    let args = inputs
        .by_cells(run)
        .value("volume", &inputs.volume.grid)
        .value("rays", grid)
        .value("spacing", &spacing)
        .value("block_levels", &levels)
        .value("margin", &margin)
        .value("iso", &iso)
        .write("cast", cast);
    let defines = run.variant.defines().with("LANES", LANES);
    run.squares("mark_uncertain", defines, args, spacing << levels)
}
