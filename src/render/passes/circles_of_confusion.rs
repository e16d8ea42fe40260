//! `kernels/pass/circles_of_confusion.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer, Group};
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// How the circles of confusion of a lens grow: of a point at the axial depth z, pixels, by the distance s of the focal
/// plane.
#[derive(Clone, Copy)]
pub struct Circles {
    /// s, mm.
    pub focus_mm: f32,
    /// What they grow by with 1/s − 1/z, in perspective; else 0.
    pub from_inverse: f32,
    /// What they grow by with z − s, of a parallel camera; else 0.
    pub from_depth: f32,
    /// The greatest share by which light is darkened.
    pub darken: f32,
}

impl Group for Circles {
    fn add_to(self, args: Args) -> Args {
        args.value("focus_mm", &self.focus_mm)
            .value("from_inverse", &self.from_inverse)
            .value("from_depth", &self.from_depth)
            .value("darken", &self.darken)
    }
}

/// The circle of confusion of each pixel, and its `color` darkened by it. Reads the depth.
pub fn circles_of_confusion(
    run: &mut Run,
    circles: Circles,
    layers: &mut DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .with(circles)
        .with(layers.reading(&[Layer::Depth]))
        .with(layers.writing(&[Layer::Coc]))
        .write("color", color);
    run.screen("circles_of_confusion", run.defines(), args)
}
