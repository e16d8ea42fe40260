//! `kernels/pass/mark_exceeding.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{KernelEnum, ProjectionCast, ProjectionLoop};
use crate::render::resources::DeviceLayers;

use super::inputs::CastInputs;
use super::mark_uncertain::{Blocks, LANES};
use super::run::Run;

/// A projection whose pixels have had one ray.
pub struct FirstValues<'a> {
    /// What it finds.
    pub which: ProjectionLoop,
    /// The cast's numbers.
    pub cast: &'a ProjectionCast,
    /// Kind and value of every pixel.
    pub layers: &'a DeviceLayers,
}

/// Marks in `marks` the pixels to be cast next that may hold what exceeds their value by more than `tolerance` (stored
/// units), the others as cast.
pub fn mark_exceeding(
    run: &mut Run,
    inputs: CastInputs,
    seen: &FirstValues,
    tolerance: f32,
    marks: &mut Buffer<u32>,
) -> Result<()> {
    /// A pixel's rays pass it within half a pixel of its centre.
    const MARGIN: f32 = 0.5;
    let (grid, _) = run.picture()?;
    let args = inputs
        .by_ranges(run)
        .value("volume", &inputs.volume.grid)
        .value("rays", grid)
        .with(Blocks::PIXELS)
        .value("margin", &MARGIN)
        .value("tolerance", &tolerance)
        .value("cast_by", seen.cast)
        .with(seen.layers.reading(&[Layer::Kind, Layer::Value]))
        .write("cast", marks);
    let defines = run
        .variant
        .defines()
        .with("LANES", LANES)
        .with("PROJECTION", seen.which.number());
    let side = Blocks::PIXELS.square_side();
    run.squares("mark_exceeding", defines, args, side)
}
