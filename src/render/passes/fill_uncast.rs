//! `kernels/pass/fill_uncast.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{Filling, KernelEnum};
use crate::render::resources::{DeviceLayers, Spans};
use crate::scene::Emission;

use super::run::Run;

/// How pixels are filled that were not cast.
#[derive(Debug, Clone, Copy)]
pub struct Fill {
    /// What they are filled with.
    pub filling: Filling,
    /// The spacing of the grid, where they lie on one, in pixels.
    pub spacing: u32,
    /// Whether they are to have normals.
    pub with_normals: bool,
}

/// The layers of what a ray meets.
const OF_POINTS: [Layer; 7] = [
    Layer::Kind,
    Layer::Depth,
    Layer::Value,
    Layer::Occlusion,
    Layer::OcclusionBound,
    Layer::Visibility,
    Layer::Thick,
];

/// Fills the pixels that were not cast: the colour and the spans, where they are given, and the layers.
pub fn fill_uncast(
    run: &mut Run,
    fill: Fill,
    cast: &Buffer<u32>,
    color: Option<&mut Buffer<[f32; 4]>>,
    spans: Option<&mut Spans>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let with_normals = fill.with_normals && layers.has(Layer::Normal);
    let normals: &[Layer] = if with_normals { &[Layer::Normal] } else { &[] };
    let has = |layer| u32::from(layers.has(layer));
    let defines = run
        .defines()
        .with("FILLING", fill.filling.number())
        .with("WITH_COLOR", u32::from(color.is_some()))
        .with("WITH_KIND", has(Layer::Kind))
        .with("WITH_DEPTH", has(Layer::Depth))
        .with("WITH_VALUE", has(Layer::Value))
        .with("WITH_OCCLUSION", has(Layer::Occlusion))
        .with("WITH_OCCLUSION_BOUND", has(Layer::OcclusionBound))
        .with("WITH_VISIBILITY", has(Layer::Visibility))
        .with("WITH_THICK", has(Layer::Thick))
        .with("WITH_SPANS", u32::from(spans.is_some()))
        .with("WITH_NORMAL", u32::from(with_normals))
        .with("COUNTERS", has(Layer::Steps))
        .with("CERTIFICATE", has(Layer::Certificate));
    let args = run
        .screen_args()?
        .value("spacing", &fill.spacing)
        .value("opaque_from", &Emission::LAYERS_FROM)
        .read("cast", cast)
        .read_some("color", color.as_deref())
        .with(layers.writing(&OF_POINTS))
        .read_some("spans", spans.as_ref().map(|spans| &spans.depths))
        .with(layers.writing(normals))
        .with(layers.writing(&[Layer::Steps, Layer::Nodes, Layer::Certificate]));
    run.screen("fill_uncast", defines, args)
}
