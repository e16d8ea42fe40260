//! `kernels/pass/ambient_occlusion.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::SurfaceCast;
use crate::render::resources::{DeviceGradient, DeviceLayers, RaySets};

use super::inputs::CastInputs;
use super::run::Run;

/// How rays leave points of a surface.
#[derive(Clone, Copy)]
pub struct Leaving<'a> {
    /// Their directions.
    pub directions: &'a RaySets,
    /// How far from the surface they begin and end, in the units of [`covector_scale`](crate::render::abi::covector_scale):
    /// mm times that.
    pub t: [f32; 2],
}

/// The share of the light from everywhere that the surface keeps from each hit. Reads the kind.
pub fn ambient_occlusion(
    run: &mut Run,
    inputs: CastInputs,
    cast: &SurfaceCast,
    leaving: Leaving,
    hit_mm: &Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let defines = run.defines().with("CERTIFICATE", 0);
    let args = inputs
        .along_rays(inputs.by_cells(run), run, DeviceGradient::NONE)
        .value("cast", cast)
        .with(leaving.directions)
        .value("t_min", &leaving.t[0])
        .value("t_max", &leaving.t[1])
        .read("hit_mm", hit_mm)
        .with(layers.reading(&[Layer::Kind]))
        .with(layers.writing(&[Layer::Occlusion]));
    run.cast("ambient_occlusion", defines, args)
}
