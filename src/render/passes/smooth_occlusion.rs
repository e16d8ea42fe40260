//! `kernels/pass/smooth_occlusion.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::render::resources::{DeviceLayers, Spans};

use super::run::Run;
use super::screen_occlusion::Estimates;

/// The occlusion of each hit of the picture: the mean of the estimates around it that lie near its tangent plane and nearer
/// than the radius. Reads the kind.
pub fn smooth_occlusion(
    run: &mut Run,
    radius_mm: f32,
    spans: &Spans,
    found: &Estimates,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let args = run
        .screen_args()?
        .with(&spans.screen)
        .value("radius_mm", &radius_mm)
        .read("spans", &spans.depths)
        .read("estimate", &found.occlusion)
        .read("tangents", &found.tangents)
        .with(layers.reading(&[Layer::Kind]))
        .with(layers.writing(&[Layer::Occlusion]));
    run.screen("smooth_occlusion", run.defines(), args)
}
