//! `kernels/pass/exact_projection.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::render::abi::{KernelEnum, ProjectionCast, ProjectionLoop};
use crate::render::resources::{DeviceGradient, DeviceLayers};

use super::inputs::CastInputs;
use super::run::Run;

/// Projects along every ray, from every cell that matters instead of from samples; compare
/// [`cast_maximum`](super::cast_maximum::cast_maximum).
pub fn exact_projection(
    run: &mut Run,
    which: ProjectionLoop,
    inputs: CastInputs,
    cast: &ProjectionCast,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let has = |layer| u32::from(layers.has(layer));
    let defines = run
        .defines()
        .with("PROJECTION", which.number())
        .with("LAYERS", has(Layer::Depth))
        .with("COUNTERS", has(Layer::Steps));
    let args = inputs
        .along_rays(inputs.by_ranges(run), run, DeviceGradient::NONE)
        .value("cast", cast)
        .with(layers.writing(&[
            Layer::Kind,
            Layer::Value,
            Layer::Depth,
            Layer::Steps,
            Layer::Nodes,
        ]));
    run.cast("exact_projection", defines, args)
}
