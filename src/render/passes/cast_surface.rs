//! `kernels/pass/cast_surface.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::SurfaceCast;
use crate::render::resources::{DeviceGradient, DeviceLayers};
use crate::scene::Reconstruction;

use super::inputs::CastInputs;
use super::run::Run;

/// The first point of each ray where Φ − iso changes sign: `hit_mm` from the base plane, its kind, depth (mm
/// from the eye) and value (stored units). By `recon` samples on the way are the field's or the nearest voxels'.
pub fn cast_surface(
    run: &mut Run,
    inputs: CastInputs,
    cast: &SurfaceCast,
    recon: Reconstruction,
    hit_mm: &mut Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let has = |layer| u32::from(layers.has(layer));
    let defines = inputs
        .define_steps(run.defines())
        .with("LAYERS", has(Layer::Depth))
        .with(
            "NEAREST_MARCH",
            u32::from(recon == Reconstruction::Adaptive),
        )
        .with("COUNTERS", has(Layer::Steps));
    let args = inputs.along_rays(inputs.by_cells(run), run, DeviceGradient::NONE);
    let args = inputs
        .by_steps(args, cast)
        .write("hit_mm", hit_mm)
        .with(layers.writing(&[
            Layer::Kind,
            Layer::Depth,
            Layer::Value,
            Layer::Steps,
            Layer::Nodes,
        ]));
    run.cast("cast_surface", defines, args)
}
