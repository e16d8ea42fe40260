//! `kernels/pass/smooth_occlusion.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::resources::{DeviceLayers, Spans};

use super::run::Run;

/// The occlusion of each hit of the picture: the mean of the estimates around it that lie near its tangent plane and nearer
/// than the radius. Reads the normal and the kind.
pub fn smooth_occlusion(
    run: &mut Run,
    radius_mm: f32,
    spans: &Spans,
    estimate: &Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let args = run
        .screen_args()?
        .with(&spans.screen)
        .value("radius_mm", &radius_mm)
        .read("spans", &spans.depths)
        .read("estimate", estimate)
        .with(layers.reading(&[Layer::Normal, Layer::Kind]))
        .with(layers.writing(&[Layer::Occlusion]));
    run.screen("smooth_occlusion", run.defines(), args)
}
