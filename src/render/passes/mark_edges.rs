//! `kernels/pass/mark_edges.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::scene::Emission;

use super::differ::{Differs, Seen};
use super::run::Run;

/// Unmarks in `cast` the pixels to which many rays would show what one did: those that differ from none around
/// them, and met something or, where `empty_is_known`, nothing. `coverage` becomes what one ray says of it.
pub fn mark_edges(
    run: &mut Run,
    differs: Differs,
    empty_is_known: bool,
    seen: Seen,
    cast: &mut Buffer<u32>,
    coverage: Option<&mut Buffer<f32>>,
) -> Result<()> {
    let defines = seen
        .define(run.defines())
        .with("EMPTY_KNOWN", u32::from(empty_is_known))
        .with("COVERAGE", u32::from(coverage.is_some()));
    let args = run
        .screen_args()?
        .value("threshold", &differs.threshold)
        .value("footprint", &differs.footprint)
        .value("opaque_from", &Emission::LAYERS_FROM)
        .with(seen)
        .write("cast", cast)
        .read_some("coverage", coverage.as_deref());
    run.screen("mark_edges", defines, args)
}
