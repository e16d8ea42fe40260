//! `kernels/pass/light_depths.cl`

use crate::error::Result;
use crate::gpu::{Args, Buffer};
use crate::render::abi::{EmissionCast, KernelEnum, Rays};
use crate::render::resources::{DeviceGradient, DeviceTransfer};

use super::inputs::CastInputs;
use super::run::Run;

/// Where the points of a light's grid are along the rays of the camera in its place.
#[derive(Clone, Copy)]
pub struct GridLayers {
    /// The first layer's distance along the view axis, mm.
    pub nearest_mm: f32,
    /// From one layer to the next.
    pub spacing_mm: f32,
    /// The number of layers, and of points along each edge of one.
    pub side: u32,
    /// The first of the grid's depths among all.
    pub first: u32,
}

/// The optical depths from a light on, at the points of its grid; the run's rays are those of the camera in its place.
pub fn light_depths(
    run: &mut Run,
    inputs: CastInputs,
    transfer: &DeviceTransfer,
    cast: &EmissionCast,
    layers: GridLayers,
    depths: &mut Buffer<f32>,
) -> Result<()> {
    let off = ["SHADED", "NORMALS", "VISIBILITY", "JITTERED"];
    let defines = DeviceGradient::NONE.define(run.defines());
    let defines = (off.iter())
        .fold(defines, |defines, name| defines.with(name, 0))
        .with("RAYS", Rays::Camera.number());
    let (grid, _) = run.picture()?;
    let args: Args = inputs
        .by_cells(run)
        .with(transfer.integrals())
        .with(inputs.clip)
        .value("volume", &inputs.volume.grid)
        .value("rays", grid)
        .value("cast", cast)
        .value("nearest_mm", &layers.nearest_mm)
        .value("spacing_mm", &layers.spacing_mm)
        .value("side", &layers.side)
        .value("first", &layers.first)
        .write("light_depths", depths);
    run.screen("light_depths", defines, args)
}
