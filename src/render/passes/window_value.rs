//! `kernels/pass/window_value.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// The grey of each projected value between the `window`'s black and white (stored units). Reads the kind and
/// the value.
pub fn window_value(
    run: &mut Run,
    window: [f32; 2],
    layers: &DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = Args::new()
        .with(&run.rays)
        .value("window", &window)
        .with(layers.reading(&[Layer::Kind, Layer::Value]))
        .write("color", color);
    run.cast("window_value", run.defines(), args)
}
