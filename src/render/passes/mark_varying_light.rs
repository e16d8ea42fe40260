//! `kernels/pass/mark_varying_light.cl`

use crate::error::{Error, Result};
use crate::gpu::Buffer;

use super::inputs::CastInputs;
use super::mark_uncertain::{Blocks, LANES};
use super::run::Run;

/// What is asked of a medium's blocks.
pub struct MediumBlocks {
    /// The blocks.
    pub blocks: Blocks,
    /// How much the linear light of a channel, or the opacity, may differ in a block.
    pub max_error: f32,
    /// The length that absorption is measured in, mm.
    pub unit_length_mm: f32,
    /// What shading makes of a colour.
    pub reflects: Reflects,
}

/// What shading makes of a colour at least and at most: red, green, blue, linear light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflects {
    /// The least factor of the colour.
    pub least: [f32; 4],
    /// The greatest factor of the colour.
    pub most: [f32; 4],
    /// The most that is added to that.
    pub added: [f32; 4],
}

impl Reflects {
    /// What is not shaded shows its colour.
    pub const UNSHADED: Self = Self {
        least: [1.0, 1.0, 1.0, 0.0],
        most: [1.0, 1.0, 1.0, 0.0],
        added: [0.0; 4],
    };
}

/// Marks in `marks` the pixels to be cast next whose blocks are not proven to have light and opacity within the error; the
/// corners of the others are too.
///
/// # Errors
/// As [`Run::squares`]; the occupancy has no bounds of light.
pub fn mark_varying_light(
    run: &mut Run,
    inputs: CastInputs,
    asked: &MediumBlocks,
    marks: &mut Buffer<u32>,
) -> Result<()> {
    let leaf_light = inputs.occupancy.leaf_light.as_ref();
    let none = || Error::failed("the bounds of leaves' light were not asked for");
    let (grid, _) = run.picture()?;
    let args = inputs
        .nodes_and_cells()
        .read("leaf_light", leaf_light.ok_or_else(none)?)
        .with(inputs.clip)
        .value("volume", &inputs.volume.grid)
        .value("rays", grid)
        .with(asked.blocks)
        .value("widest", &asked.blocks.widest)
        .value("max_error", &asked.max_error)
        .value("unit_length_mm", &asked.unit_length_mm)
        .value("reflects_least", &asked.reflects.least)
        .value("reflects_most", &asked.reflects.most)
        .value("reflects_added", &asked.reflects.added)
        .write("cast", marks);
    let defines = run.variant.defines().with("LANES", LANES);
    let side = asked.blocks.square_side();
    run.squares("mark_varying_light", defines, args, side)
}
