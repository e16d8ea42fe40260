//! `kernels/pass/screen_occlusion.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::resources::{DeviceLayers, Sections, Spans};

use super::inputs::CastInputs;
use super::run::Run;

/// The surroundings of points that occlude them.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// The sections in which they are looked at.
    pub sections: &'a Sections,
    /// How far away they end, mm.
    pub radius_mm: f32,
}

/// Estimates the share of the light from everywhere that the surface keeps from each hit of the picture. Reads the kind.
pub fn screen_occlusion(
    run: &mut Run,
    inputs: CastInputs,
    iso: f32,
    around: Surroundings,
    seen: (&Spans, &Buffer<f32>, &DeviceLayers),
    estimate: &mut Buffer<f32>,
) -> Result<()> {
    let (spans, hit_mm, layers) = seen;
    let args = Args::new()
        .with(run.voxels)
        .value("volume", &inputs.volume.grid);
    let (grid, _) = run.picture()?;
    let args = args
        .value("rays", grid)
        .value("iso", &iso)
        .with(&spans.screen)
        .value("forward", &spans.screen.forward)
        .value("radius_mm", &around.radius_mm)
        .with(around.sections)
        .read("hit_mm", hit_mm)
        .with(layers.reading(&[Layer::Kind]))
        .read("spans", &spans.depths)
        .write("estimate", estimate);
    run.screen("screen_occlusion", run.defines(), args)
}
