//! `kernels/pass/cast_maximum.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::render::abi::{KernelEnum, ProjectionCast, ProjectionLoop};
use crate::render::resources::{DeviceGradient, DeviceLayers};

use super::inputs::CastInputs;
use super::run::Run;

/// One value per ray in stored units, `kind` where the ray meets the volume, and the depth (mm from the eye)
/// at which the value was found.
pub fn cast_maximum(
    run: &mut Run,
    which: ProjectionLoop,
    inputs: CastInputs,
    cast: &ProjectionCast,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let has = |layer| u32::from(layers.has(layer));
    let defines = inputs
        .define_steps(run.defines())
        .with("PROJECTION", which.number())
        .with("LAYERS", has(Layer::Depth))
        .with("COUNTERS", has(Layer::Steps));
    let args = inputs.along_rays(inputs.by_ranges(run), run, DeviceGradient::NONE);
    let args = inputs.by_steps(args, cast).with(layers.writing(&[
        Layer::Kind,
        Layer::Value,
        Layer::Depth,
        Layer::Steps,
        Layer::Nodes,
    ]));
    run.cast("cast_maximum", defines, args)
}
