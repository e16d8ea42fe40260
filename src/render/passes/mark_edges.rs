//! `kernels/pass/mark_edges.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
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
    /// Whether all pixels that are proven to show nothing are unmarked already.
    pub empty_is_known: bool,
}

/// Unmarks in `cast` the pixels to which many rays would show what one did: those beside which nothing else was
/// met and whose mean is estimated to differ by no more than the threshold, a difference of channels, sRGB-encoded; where
/// `empty_is_known`, of those that met something. `coverage` becomes what one ray says of it.
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
        .with("EMPTY_KNOWN", u32::from(seen.empty_is_known))
        .with("COVERAGE", u32::from(coverage.is_some()));
    let args = run
        .screen_args()?
        .value("threshold", &threshold)
        .value("opaque_from", &Emission::LAYERS_FROM)
        .read("color", seen.color)
        .read_some("kind", kind)
        .write("cast", cast)
        .read_some("coverage", coverage.as_deref());
    run.screen("mark_edges", defines, args)
}
