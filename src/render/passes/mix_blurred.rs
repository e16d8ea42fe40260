//! `kernels/pass/mix_blurred.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// Mixes a `color` with a blurred one, all of it from circles of confusion of `widest_px` on. Reads the circles.
pub fn mix_blurred(
    run: &mut Run,
    widest_px: f32,
    layers: &DeviceLayers,
    blurred: &Buffer<[f32; 4]>,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .value("widest_px", &widest_px)
        .with(layers.reading(&[Layer::Coc]))
        .read("blurred", blurred)
        .write("color", color);
    run.screen("mix_blurred", run.defines(), args)
}
