//! `kernels/pass/interpolate_hits.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// Where the rays of pixels hit that `marks` says to interpolate: between the hits at the corners of their blocks. The
/// surface's value there is `iso`, stored units.
pub fn interpolate_hits(
    run: &mut Run,
    iso: f32,
    marks: &Buffer<u32>,
    hit_mm: &mut Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let has = |layer| u32::from(layers.has(layer));
    let defines = run
        .defines()
        .with("LAYERS", has(Layer::Depth))
        .with("CERTIFICATE", has(Layer::Certificate))
        .with("COUNTERS", has(Layer::Steps));
    let args = run
        .screen_args()?
        .value("iso", &iso)
        .read("cast", marks)
        .write("hit_mm", hit_mm)
        .with(layers.writing(&[
            Layer::Kind,
            Layer::Depth,
            Layer::Value,
            Layer::Certificate,
            Layer::Steps,
            Layer::Nodes,
        ]));
    run.screen("interpolate_hits", defines, args)
}
