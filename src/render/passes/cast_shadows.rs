//! `kernels/pass/cast_shadows.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{Shading, SurfaceCast};
use crate::render::resources::{DeviceGradient, DeviceLayers, RaySets};

use super::inputs::CastInputs;
use super::run::Run;

/// How rays go from points of a surface to its lights.
#[derive(Clone, Copy)]
pub struct TowardLights<'a> {
    /// The lights.
    pub shading: &'a Shading,
    /// The directions about the middle of a light.
    pub directions: &'a RaySets,
    /// How far from the surface they begin, in the units of [`covector_scale`](crate::render::abi::covector_scale): mm times
    /// that.
    pub t_min: f32,
}

/// How much of each light reaches each hit, a component a light. Reads the kind and the normal.
pub fn cast_shadows(
    run: &mut Run,
    inputs: CastInputs,
    cast: &SurfaceCast,
    toward: TowardLights,
    hit_mm: &Buffer<f32>,
    layers: &mut DeviceLayers,
    lights_reached: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let defines = run
        .defines()
        .with("CERTIFICATE", 0)
        .with("VISIBILITY", u32::from(layers.has(Layer::Visibility)));
    let args = inputs
        .along_rays(inputs.by_cells(run), run, DeviceGradient::NONE)
        .value("cast", cast)
        .value("shading", toward.shading)
        .with(toward.directions)
        .value("t_min", &toward.t_min)
        .read("hit_mm", hit_mm)
        .with(layers.reading(&[Layer::Kind, Layer::Normal]))
        .write("lights_reached", lights_reached)
        .with(layers.writing(&[Layer::Visibility]));
    run.cast("cast_shadows", defines, args)
}
