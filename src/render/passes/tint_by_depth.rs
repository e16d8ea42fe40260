//! `kernels/pass/tint_by_depth.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::abi::KernelEnum;
use crate::render::resources::DeviceLayers;
use crate::scene::{DepthCues, Ramp};

use super::run::Run;

/// The `color` of what rays show, tinted and faded by its depth. Reads the depth, and the normal where tints are confined to
/// the rim of things.
pub fn tint_by_depth(
    run: &mut Run,
    cues: &DepthCues,
    layers: &DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let (range, colors) = (cues.range, cues.chromadepth);
    let rim = cues.rim().map(|power| power.get() as f32);
    let normal: &[Layer] = if rim.is_some() { &[Layer::Normal] } else { &[] };
    let per_mm = 1.0 / (range.far_mm() - range.near_mm());
    let tint = colors.map_or(0.0, |colors| colors.strength.get() as f32);
    let ramp = colors.map_or(Ramp::default(), |colors| colors.ramp);
    let steps = colors.and_then(|colors| colors.steps);
    let args = Args::new()
        .with(&run.rays)
        .value("near_mm", &(range.near_mm() as f32))
        .value("per_mm", &(per_mm as f32))
        .value("fog", &(cues.fog.get() as f32))
        .value("tint", &tint)
        .value("ramp", &ramp.number())
        .value("steps", &steps.map_or(0, |steps| steps.get()));
    let args = match &rim {
        Some(rim) => args.value("rim", rim),
        None => args,
    };
    let args = args
        .with(layers.reading(normal))
        .with(layers.reading(&[Layer::Depth]))
        .write("color", color);
    let defines = run.defines().with("RIM", u32::from(rim.is_some()));
    run.cast("tint_by_depth", defines, args)
}
