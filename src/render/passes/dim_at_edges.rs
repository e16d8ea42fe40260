//! `kernels/pass/dim_at_edges.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::resources::DeviceLayers;
use crate::scene::{DepthCues, Share, WidthPx};

use super::run::Run;

/// The `color` of the pixels, dimmed by halos and contours. Reads the depth.
pub fn dim_at_edges(
    run: &mut Run,
    cues: &DepthCues,
    layers: &DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let drawn = |edge: Option<(Share, WidthPx)>| {
        edge.map_or((0.0, 1), |(strength, width)| {
            (strength.get() as f32, width.get())
        })
    };
    let (halo, halo_px) = drawn(cues.halo);
    let (contour, contour_px) = drawn(cues.contour);
    let per_mm = 1.0 / (cues.range.far_mm() - cues.range.near_mm());
    let args = run
        .screen_args()?
        .value("per_mm", &(per_mm as f32))
        .value("halo", &halo)
        .value("halo_px", &halo_px)
        .value("contour", &contour)
        .value("contour_px", &contour_px)
        .with(layers.reading(&[Layer::Depth]))
        .write("color", color);
    run.screen("dim_at_edges", run.defines(), args)
}
