//! `kernels/pass/exact_surface.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::SurfaceCast;
use crate::render::resources::{DeviceGradient, DeviceLayers};

use super::inputs::CastInputs;
use super::run::Run;

/// Finds the first surface along every ray by solving every cell, with what is proven of each ray;
/// compare [`cast_surface`](super::cast_surface::cast_surface).
pub fn exact_surface(
    run: &mut Run,
    inputs: CastInputs,
    cast: &SurfaceCast,
    hit_mm: &mut Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let has = |layer| u32::from(layers.has(layer));
    let defines = run
        .defines()
        .with("LAYERS", has(Layer::Depth))
        .with("CERTIFICATE", has(Layer::Certificate))
        .with("COUNTERS", has(Layer::Steps));
    let args = inputs
        .along_rays(inputs.by_cells(run), run, DeviceGradient::NONE)
        .value("cast", cast)
        .write("hit_mm", hit_mm)
        .with(layers.writing(&[
            Layer::Kind,
            Layer::Depth,
            Layer::Value,
            Layer::Certificate,
            Layer::Steps,
            Layer::Nodes,
        ]));
    run.cast("exact_surface", defines, args)
}
