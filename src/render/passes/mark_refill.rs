//! `kernels/pass/mark_refill.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::differ::{Compared, Differs};
use super::run::Run;

/// Marks the blocks `spacing` pixels wide whose corners differ to be cast next, and where it `floods` those
/// whose edges do, where they were cast with a neighbouring block.
pub fn mark_refill(
    run: &mut Run,
    spacing: u32,
    floods: bool,
    differs: Differs,
    compared: Compared,
    cast: &mut Buffer<u32>,
) -> Result<()> {
    let defines = run.scalar_defines().with("FLOOD", u32::from(floods));
    let args = run
        .screen_args()?
        .value("spacing", &spacing)
        .value("threshold", &differs.threshold)
        .value("footprint", &differs.footprint)
        .with(compared)
        .write("cast", cast);
    run.squares("mark_refill", compared.define(defines), args, spacing)
}
