//! `kernels/pass/surface_normal.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::resources::{DeviceGradient, DeviceLayers};

use super::inputs::CastInputs;
use super::run::Run;

/// The unit world-space normal where each ray hit, toward lower values; zero elsewhere. Reads the kind.
pub fn surface_normal(
    run: &mut Run,
    inputs: CastInputs,
    gradient: DeviceGradient,
    hit_mm: &Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let defines = gradient.define(run.defines());
    let voxels = gradient.reads_voxels().then_some(run.voxels);
    let args = Args::new().with(gradient).with(voxels);
    let args = inputs
        .along_rays(args, run, DeviceGradient::NONE)
        .read("hit_mm", hit_mm)
        .with(layers.reading(&[Layer::Kind]))
        .with(layers.writing(&[Layer::Normal]));
    run.cast("surface_normal", defines, args)
}
