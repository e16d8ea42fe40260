//! `kernels/pass/behind_surface.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{BLURRED_SQUARE, SurfaceCast};
use crate::render::resources::{DeviceGradient, DeviceLayers};

use super::inputs::CastInputs;
use super::run::Run;

/// What hides behind the first hits of rays.
#[derive(Clone, Copy)]
pub struct Hiding<'a> {
    /// What reaches each square of pixels.
    pub reaches: &'a Buffer<[f32; 4]>,
    /// How far behind a crossing the ray is followed on, mm.
    pub after_mm: f32,
    /// t of the first hits.
    pub hit_mm: &'a Buffer<f32>,
}

/// Finds what each ray meets behind the exit of the first vessel, where something uneven is near.
pub fn behind_surface(
    run: &mut Run,
    inputs: CastInputs,
    cast: &SurfaceCast,
    hiding: Hiding,
    hidden_mm: &mut Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let (_, size) = run.picture()?;
    let defines = run.defines().with("CERTIFICATE", 0);
    let args = inputs
        .along_rays(inputs.by_cells(run), run, DeviceGradient::NONE)
        .value("cast", cast)
        .value("squares_across", &size.width().div_ceil(BLURRED_SQUARE))
        .value("after_mm", &hiding.after_mm)
        .read("reaches", hiding.reaches)
        .read("hit_mm", hiding.hit_mm)
        .write("hidden_mm", hidden_mm)
        .with(layers.writing(&[Layer::Kind, Layer::Depth]));
    run.cast("behind_surface", defines, args)
}
