//! `kernels/pass/bound_occlusion.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::SurfaceCast;
use crate::render::resources::{DeviceGradient, DeviceLayers};

use super::inputs::CastInputs;
use super::run::Run;

/// How much is to be known of the light from everywhere that reaches points of a surface.
#[derive(Debug, Clone, Copy)]
pub struct Bounding {
    /// How far it is looked for, in the units of [`covector_scale`](crate::render::abi::covector_scale): mm times that.
    pub t_max: f32,
    /// The share of it that may stay unknown.
    pub unknown: f32,
}

/// The share of the light from everywhere that the surface keeps from each hit, between two bounds. Reads the kind.
pub fn bound_occlusion(
    run: &mut Run,
    inputs: CastInputs,
    cast: &SurfaceCast,
    bounding: Bounding,
    hit_mm: &Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let with_bound = u32::from(layers.has(Layer::OcclusionBound));
    let defines = (run.scalar_defines())
        .with("CERTIFICATE", 0)
        .with("LAYERS", with_bound);
    let args = inputs
        .along_rays(inputs.by_cells(run), run, DeviceGradient::NONE)
        .value("cast", cast)
        .value("t_max", &bounding.t_max)
        .value("unknown_share", &bounding.unknown)
        .read("hit_mm", hit_mm)
        .with(layers.reading(&[Layer::Kind]))
        .with(layers.writing(&[Layer::Occlusion, Layer::OcclusionBound]));
    run.cast_singly("bound_occlusion", defines, args)
}
