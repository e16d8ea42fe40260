//! `kernels/pass/mark_varying_values.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::abi::{KernelEnum, ProjectionCast, ProjectionLoop};

use super::inputs::CastInputs;
use super::mark_uncertain::{Blocks, LANES};
use super::run::Run;

/// Marks in `marks` the pixels to be cast next whose blocks are not proven to have values within `max_error` (stored units) of
/// each other; the corners of the others are too.
pub fn mark_varying_values(
    run: &mut Run,
    which: ProjectionLoop,
    inputs: CastInputs,
    cast: &ProjectionCast,
    blocks: Blocks,
    max_error: f32,
    marks: &mut Buffer<u32>,
) -> Result<()> {
    let (grid, _) = run.picture()?;
    let args = inputs
        .by_ranges(run)
        .with(inputs.clip)
        .value("volume", &inputs.volume.grid)
        .value("rays", grid)
        .with(blocks)
        .value("widest", &blocks.widest)
        .value("max_error", &max_error)
        .value("cast_by", cast)
        .write("cast", marks);
    let defines = run
        .variant
        .defines()
        .with("LANES", LANES)
        .with("PROJECTION", which.number());
    run.squares("mark_varying_values", defines, args, blocks.square_side())
}
