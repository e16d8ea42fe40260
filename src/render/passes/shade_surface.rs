//! `kernels/pass/shade_surface.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::abi::Shading;
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// The `color` of each hit: where `shaded`, by the normal, else the base colour. Reads the kind.
pub fn shade_surface(
    run: &mut Run,
    shading: &Shading,
    shaded: bool,
    layers: &DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let defines = run.defines().with("SHADED", u32::from(shaded));
    let normal: &[Layer] = if shaded { &[Layer::Normal] } else { &[] };
    let args = Args::new()
        .with(&run.rays)
        .value("shading", shading)
        .with(layers.reading(&[Layer::Kind]))
        .with(layers.reading(normal))
        .write("color", color);
    run.cast("shade_surface", defines, args)
}
