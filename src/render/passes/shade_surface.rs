//! `kernels/pass/shade_surface.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::abi::Shading;
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// The `color` of each hit: where the hits are given, by the normal there, else the base colour. Reads the kind.
pub fn shade_surface(
    run: &mut Run,
    shading: &Shading,
    hit_mm: Option<&Buffer<f32>>,
    layers: &DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let is_shaded = hit_mm.is_some();
    let defines = run.defines().with("SHADED", u32::from(is_shaded));
    let normal: &[Layer] = if is_shaded { &[Layer::Normal] } else { &[] };
    let args = Args::new()
        .with(&run.rays)
        .value("shading", shading)
        .read_some("hit_mm", hit_mm)
        .with(layers.reading(&[Layer::Kind]))
        .with(layers.reading(normal))
        .write("color", color);
    run.cast("shade_surface", defines, args)
}
