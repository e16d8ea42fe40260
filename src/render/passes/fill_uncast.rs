//! `kernels/pass/fill_uncast.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::resources::DeviceLayers;
use crate::scene::Emission;

use super::run::Run;

/// What a sparsely cast picture's pixels are filled with that were not cast.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filling {
    /// What a ray leaves that meets nothing.
    Empty,
    /// What is interpolated between the corners of blocks so many pixels wide.
    Blocks(u32),
}

/// Fills the pixels that were not cast: the colour, where it is given, and the layers.
pub fn fill_uncast(
    run: &mut Run,
    filling: Filling,
    cast: &Buffer<u32>,
    color: Option<&mut Buffer<[f32; 4]>>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let spacing = match filling {
        Filling::Empty => 1,
        Filling::Blocks(spacing) => spacing,
    };
    let has = |layer| u32::from(layers.has(layer));
    let defines = run
        .defines()
        .with("EMPTY", u32::from(filling == Filling::Empty))
        .with("WITH_COLOR", u32::from(color.is_some()))
        .with("WITH_KIND", has(Layer::Kind))
        .with("WITH_DEPTH", has(Layer::Depth))
        .with("WITH_VALUE", has(Layer::Value))
        .with("WITH_NORMAL", has(Layer::Normal))
        .with("COUNTERS", has(Layer::Steps))
        .with("CERTIFICATE", has(Layer::Certificate));
    let args = run
        .screen_args()?
        .value("spacing", &spacing)
        .value("opaque_from", &Emission::LAYERS_FROM)
        .read("cast", cast)
        .read_some("color", color.as_deref())
        .with(layers.writing(&[
            Layer::Kind,
            Layer::Depth,
            Layer::Value,
            Layer::Normal,
            Layer::Steps,
            Layer::Nodes,
            Layer::Certificate,
        ]));
    run.screen("fill_uncast", defines, args)
}
