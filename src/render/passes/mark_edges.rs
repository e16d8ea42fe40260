//! `kernels/pass/mark_edges.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer, Group};
use crate::render::resources::DeviceLayers;
use crate::scene::Emission;

use super::run::Run;

/// What one ray a pixel saw.
#[derive(Clone, Copy)]
pub struct FirstRays<'a> {
    /// Linear light, premultiplied.
    pub color: &'a Buffer<[f32; 4]>,
    /// The layers, the kind among them where there is one.
    pub layers: &'a DeviceLayers,
    /// A surface's hits.
    pub hits: Option<Hits<'a>>,
}

/// The hits of one ray a pixel.
#[derive(Clone, Copy)]
pub struct Hits<'a> {
    /// The distance of neighbouring rays, mm, at t = 0 and its growth per mm.
    pub footprint: [f32; 2],
    /// t of each hit.
    pub hit_mm: &'a Buffer<f32>,
}

impl Group for Hits<'_> {
    fn add_to(self, args: Args) -> Args {
        args.value("footprint", &self.footprint)
            .read("hit_mm", self.hit_mm)
    }
}

/// Of the pixels that `cast` marks as cast, marks those to be cast next beside which something else was met, or whose mean
/// is estimated to differ by more than the threshold, a difference of channels, sRGB-encoded; the others are to be filled.
/// `coverage` becomes what one ray says of it.
pub fn mark_edges(
    run: &mut Run,
    threshold: f32,
    seen: FirstRays,
    cast: &mut Buffer<u32>,
    coverage: Option<&mut Buffer<f32>>,
) -> Result<()> {
    let kind = seen.layers.layer_counts(Layer::Kind);
    let defines = run
        .defines()
        .with("WITH_KIND", u32::from(kind.is_some()))
        .with("WITH_HITS", u32::from(seen.hits.is_some()))
        .with("COVERAGE", u32::from(coverage.is_some()));
    let args = run
        .screen_args()?
        .value("threshold", &threshold)
        .value("opaque_from", &Emission::LAYERS_FROM)
        .read("color", seen.color)
        .read_some("kind", kind)
        .with(seen.hits)
        .write("cast", cast)
        .read_some("coverage", coverage.as_deref());
    run.screen("mark_edges", defines, args)
}
